//! One sample of a flight, as the glider's instruments read it, on the leg to which it belongs.

/// Pascal in a decibar.
pub const DBAR_PA: f64 = 1e4;

/// One sample, or the mean of a leg. What was not measured is NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Time since the start of the log \[s\].
    pub time_s: f64,
    /// Gauge pressure \[dbar\].
    pub pressure_dbar: f64,
    /// Its rate of change \[dbar/s\].
    pub pressure_rate_dbar_s: f64,
    /// Water temperature \[degC\].
    pub temperature_C: f64,
    /// In-situ density \[kg/m3\], as recorded where it was.
    pub density_kg_m3: f64,
    /// Density by TEOS-10 from the recorded salinity or conductivity, temperature and pressure \[kg/m3\].
    pub teos10_density_kg_m3: f64,
    /// The same water at p = 0 \[kg/m3\].
    pub teos10_surface_density_kg_m3: f64,
    /// Pitch \[rad\].
    pub pitch_rad: f64,
    /// Roll \[rad\].
    pub roll_rad: f64,
    /// Rudder angle \[rad\].
    pub rudder_rad: f64,
    /// Angle of the roll mass, to starboard positive \[rad\].
    pub roll_mass_rad: f64,
    /// Heading \[rad\].
    pub heading_rad: f64,
    /// Ballast volume \[m3\].
    pub ballast_m3: f64,
    /// Battery position, positive forward \[m\].
    pub battery_forward_m: f64,
    /// Downward velocity from the pressure \[m/s\].
    pub sink_m_s: f64,
    /// Its standard error from the noise of the pressure \[m/s\].
    pub sink_se_m_s: f64,
    /// Between which times, counted from this sample's, it is a mean \[s\]; a microsecond is enough, and a long log has many.
    pub sink_window_s: [f32; 2],
    /// Rate of change of the downward velocity \[m/s2\].
    pub sink_rate_m_s2: f64,
    /// Measured speed through the water \[m/s\].
    pub speed_m_s: f64,
    /// Change of the horizontal water velocity along the heading that the glider meets on its path, by the log's own
    /// current \[m/s2\].
    pub water_met_m_s2: f64,
    /// Which leg, counted from 0; odd and even say nothing.
    pub leg: u32,
    /// Which dive: a descent and the ascent after it.
    pub dive: u32,
    /// Which unbroken stretch of samples: legs that follow one another without a gap share it.
    pub stretch: u32,
    /// Whether the log says that a motor moves.
    pub motor_moving: bool,
    /// Time since the last move of a motor ended, zero during a move; NaN where the log has no times of moves \[s\].
    pub since_move_s: f64,
    /// Whether a steady glide can be expected: away from turns, surface and moving motors.
    pub steady: bool,
}

impl Observation {
    /// Whether the glider descends on this leg, by its pitch.
    pub fn descends(&self) -> bool {
        self.pitch_rad < 0.0
    }

    /// What `of` makes of each measured quantity, on this one's leg and dive.
    pub fn with(&self, of: impl Fn(fn(&Observation) -> f64) -> f64) -> Observation {
        Observation {
            time_s: of(|o| o.time_s),
            pressure_dbar: of(|o| o.pressure_dbar),
            pressure_rate_dbar_s: of(|o| o.pressure_rate_dbar_s),
            temperature_C: of(|o| o.temperature_C),
            density_kg_m3: of(|o| o.density_kg_m3),
            teos10_density_kg_m3: of(|o| o.teos10_density_kg_m3),
            teos10_surface_density_kg_m3: of(|o| o.teos10_surface_density_kg_m3),
            pitch_rad: of(|o| o.pitch_rad),
            roll_rad: of(|o| o.roll_rad),
            rudder_rad: of(|o| o.rudder_rad),
            roll_mass_rad: of(|o| o.roll_mass_rad),
            heading_rad: of(|o| o.heading_rad),
            ballast_m3: of(|o| o.ballast_m3),
            battery_forward_m: of(|o| o.battery_forward_m),
            sink_m_s: of(|o| o.sink_m_s),
            sink_se_m_s: of(|o| o.sink_se_m_s),
            sink_window_s: [of(|o| o.sink_window_s[0].into()) as f32, of(|o| o.sink_window_s[1].into()) as f32],
            sink_rate_m_s2: of(|o| o.sink_rate_m_s2),
            speed_m_s: of(|o| o.speed_m_s),
            water_met_m_s2: of(|o| o.water_met_m_s2),
            ..*self
        }
    }
}
