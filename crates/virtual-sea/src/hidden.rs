//! The sizes of all hidden effects of a log, and what they see of the glider: its flow and the instant. What they do stands in
//! [`crate::effects`] and [`crate::outside`].

use crate::catalogue::Drawn;
use crate::ocean::Water;
use crate::vehicle::Vehicle;

/// The standard atmosphere, Pa.
pub(crate) const ATMOSPHERE_PA: f64 = 101_325.0;
/// Period of the principal lunar tide, s.
pub(crate) const TIDE_S: f64 = 12.4206 * 3600.0;

macro_rules! hidden {
    ($($field:ident = $name:literal, $neutral:expr;)*) => {
        /// The effects of one log, every one that is absent at its neutral value.
        #[derive(Debug, Clone, PartialEq)]
        pub struct Hidden {
            pub(crate) density_at_zero_pressure: bool,
            pub(crate) about: About,
            $(pub(crate) $field: f64,)*
        }

        impl Hidden {
            /// Nothing hidden: the vehicle is what its file says.
            pub fn nothing(vehicle: &Vehicle) -> Self {
                let neutral = |value: fn(&Vehicle) -> f64| value(vehicle);
                Self { density_at_zero_pressure: false, about: About::default(), $($field: neutral($neutral),)* }
            }

            fn slot(&mut self, parameter: &str) -> Option<&mut f64> {
                match parameter {
                    $($name => Some(&mut self.$field),)*
                    _ => None,
                }
            }
        }
    };
}

hidden! {
    ballast_offset_kg = "ballast_offset_kg", |_| 0.0;
    leak_kg_per_hour = "leak_kg_per_hour", |_| 0.0;
    compressibility_per_pa = "hull_compressibility_per_Pa", |vehicle| vehicle.compressibility_per_pa;
    thermal_expansion_per_k = "hull_thermal_expansion_per_K", |vehicle| vehicle.thermal_expansion_per_k;
    trapped_air_cc = "trapped_air_cc", |_| 0.0;
    ballast_scale = "ballast_scale", |_| 1.0;
    pitch_offset_rad = "pitch_offset_rad", |_| 0.0;
    pitch_scale = "pitch_scale", |_| 1.0;
    pressure_scale = "pressure_scale", |_| 1.0;
    pressure_lag_s = "pressure_lag_s", |_| 0.0;
    drag_growth_per_day = "drag_growth_per_day", |_| 0.0;
    drag_step = "drag_step", |_| 0.0;
    step_time_s = "step_time_s", |_| f64::INFINITY;
    lost_or_caught_kg = "net_mass_step_kg", |_| 0.0;
    lost_or_caught_at_s = "net_mass_step_time_s", |_| f64::INFINITY;
    drag_exponent = "drag_exponent", |_| 0.0;
    nonlinear_lift_per_rad2 = "nonlinear_lift_per_rad2", |_| 0.0;
    climb_dive_drag_ratio = "climb_dive_drag_ratio", |_| 1.0;
    roll_drag_per_rad2 = "roll_drag_per_rad2", |_| 0.0;
    rudder_drag_per_rad2 = "rudder_drag_per_rad2", |_| 0.0;
    vertical_current_m_s = "vertical_current_m_s", |_| 0.0;
    density_bias_kg_m3 = "density_bias_kg_m3", |_| 0.0;
    climb_dive_lift_ratio = "climb_dive_lift_ratio", |_| 1.0;
    hull_creep_per_pa = "hull_creep_per_Pa", |_| 0.0;
    creep_time_s = "creep_time_s", |_| 0.0;
    late_expansion_per_k = "late_expansion_per_K", |_| 0.0;
    expansion_time_s = "expansion_time_s", |_| 0.0;
    carried_water_m3 = "carried_water_m3", |_| 0.0;
    exchange_time_s = "exchange_time_s", |_| 0.0;
    leakback_cc_per_hour = "pump_leakback_cc_per_hour", |_| 0.0;
    salinity_drift_per_day = "salinity_drift_per_day", |_| 0.0;
    thermal_lag_s = "thermal_lag_s", |_| 0.0;
    clock_offset_s = "clock_offset_s", |_| 0.0;
    pressure_hysteresis = "pressure_hysteresis", |_| 0.0;
    stall_angle_rad = "stall_angle_rad", |_| f64::INFINITY;
    compass_pitch_rad = "pitch_error_rad", |_| 0.0;
    backlash_m = "backlash_m", |_| 0.0;
    patch_drag = "patch_drag", |_| 0.0;
    regrowth_s = "regrowth_s", |_| f64::INFINITY;
    tidal_velocity_m_s = "tidal_velocity_m_s", |_| 0.0;
    tidal_phase_rad = "tidal_phase_rad", |_| 0.0;
    reading_per_k = "reading_per_K", |_| 0.0;
    layer_velocity_m_s = "layer_velocity_m_s", |_| 0.0;
    layer_top_m = "layer_top_m", |_| 0.0;
    layer_bottom_m = "layer_bottom_m", |_| 0.0;
    lift_loss_per_pa = "lift_loss_per_Pa", |_| 0.0;
    friction_n = "friction_N", |_| 0.0;
    line_drag_per_100m = "line_drag_per_100m", |_| 0.0;
    burped_air_cc = "burped_air_cc", |_| 0.0;
    engine_backlash_cc = "engine_backlash_cc", |_| 0.0;
    missing_cc_per_100dbar = "missing_cc_per_100dbar", |_| 0.0;
    foam_cc = "foam_cc", |_| 0.0;
    mud_kg = "mud_kg", |_| 0.0;
    lift_lost = "lift_lost", |_| 0.0;
    lift_lost_from_s = "lift_lost_from_s", |_| f64::INFINITY;
    swarm_drag = "swarm_drag", |_| 0.0;
    swarm_top_m = "swarm_top_m", |_| 0.0;
    swarm_bottom_m = "swarm_bottom_m", |_| 0.0;
    internal_tide_m_s = "internal_tide_m_s", |_| 0.0;
    internal_tide_phase_rad = "internal_tide_phase_rad", |_| 0.0;
    zero_dbar_per_k = "zero_dbar_per_K", |_| 0.0;
    flushing_s = "flushing_s", |_| 0.0;
    pitch_step_rad = "pitch_step_rad", |_| 0.0;
    clock_jitter = "clock_jitter", |_| 0.0;
    speed_lag_s = "speed_lag_s", |_| 0.0;
    speed_scale = "speed_scale", |_| 1.0;
    pitch_rad_per_k = "pitch_rad_per_K", |_| 0.0;
    static_list_rad = "static_list_rad", |_| 0.0;
    rudder_offset_rad = "rudder_offset_rad", |_| 0.0;
    roll_mass_offset_rad = "roll_mass_offset_rad", |_| 0.0;
    roll_offset_rad = "roll_offset_rad", |_| 0.0;
    pitch_per_roll = "pitch_per_roll", |_| 0.0;
    pod_m3 = "yaw_asymmetry_m3", |_| 0.0;
}

/// What effects outside the catalogue count from: the conditions in which the glider was ballasted and its instruments adjusted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct About {
    /// Temperature at which the instruments read right, degrees Celsius.
    pub temperature_c: f64,
    /// Sine of the heading at which the pitch is read right.
    pub sine_of_heading: f64,
    /// What of the net mass that these effects add was ballasted away, kg.
    pub net_mass_kg: f64,
}

impl Default for About {
    fn default() -> Self {
        Self { temperature_c: 10.0, sine_of_heading: 0.0, net_mass_kg: 0.0 }
    }
}

/// How the glider meets the water, as far as drag and lift depend on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flow {
    /// Time since the first row, s.
    pub time_s: f64,
    /// Angle of attack, rad.
    pub angle_rad: f64,
    /// Density of the water, kg/m3.
    pub density_kg_m3: f64,
    /// Dynamic pressure, Pa.
    pub dynamic_pressure_pa: f64,
    /// Whether the glider rises through the water.
    pub rising: bool,
    /// Roll, rad.
    pub roll_rad: f64,
    /// Rudder, rad.
    pub rudder_rad: f64,
    /// Depth, m.
    pub depth_m: f64,
}

impl Hidden {
    /// The drawn effects on a vehicle.
    pub fn new(drawn: &[Drawn], vehicle: &Vehicle) -> Self {
        let mut hidden = Self::nothing(vehicle);
        for effect in drawn {
            hidden.density_at_zero_pressure |= effect.effect.name == "density_at_zero_pressure";
            for &(parameter, value) in &effect.parameters {
                if let Some(slot) = hidden.slot(parameter) {
                    *slot = value;
                }
            }
        }
        hidden
    }
}

/// The truth at the start of one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    /// Time since the start, s.
    pub time_s: f64,
    /// Number of the dive.
    pub dive: u32,
    /// Depth, m.
    pub depth_m: f64,
    /// Downward speed over ground, m/s.
    pub sinking_m_s: f64,
    /// Downward speed of the water, m/s.
    pub water_sinking_m_s: f64,
    /// Speed through the water, m/s.
    pub speed_m_s: f64,
    /// Angle of attack, rad.
    pub angle_rad: f64,
    /// Pitch, rad.
    pub pitch_rad: f64,
    /// Roll, rad.
    pub roll_rad: f64,
    /// Heading, rad.
    pub heading_rad: f64,
    /// Rudder, rad.
    pub rudder_rad: f64,
    /// Reading of the rudder, rad.
    pub rudder_reading_rad: f64,
    /// Reading of the roll mass, rad; missing where there is none.
    pub roll_mass_rad: f64,
    /// Count of the buoyancy engine, cc; times a hidden scale it is the true ballast volume.
    pub engine_cc: f64,
    /// Reading of the moving mass, m.
    pub moving_mass_m: f64,
    /// Gauge pressure, Pa.
    pub pressure_pa: f64,
    /// Water at the glider.
    pub water: Water,
    /// True net mass, kg, + = heavy.
    pub net_mass_kg: f64,
    /// What of it effects outside the catalogue add before any of it is ballasted away, kg.
    pub outside_kg: f64,
}

/// 0 below, 1 above, over some units about zero.
pub(crate) fn smooth_step(x: f64) -> f64 {
    0.5 * (1.0 + x.tanh())
}
