//! What the preparation of a log goes by.

/// What the preparation goes by.
#[derive(Debug, Clone, PartialEq)]
pub struct PreparationSettings {
    /// Density where the log gives none \[kg/m3\].
    pub density_kg_m3: Option<f64>,
    /// Acceleration of gravity \[m/s2\].
    pub gravity_m_s2: f64,
    /// Whether the hull expands with temperature: then a sample without one is no steady glide to be compared, where others have one.
    pub needs_temperature: bool,
    /// Half window of the filter for vertical velocity \[s\].
    pub half_window_s: f64,
    /// Least height of a leg \[dbar\].
    pub least_leg_dbar: f64,
    /// Pressure above which the glider is taken to be at the surface \[dbar\].
    pub surface_dbar: f64,
    /// Time after a turn, the pitching into the leg, or a move of the ballast, from which the glide is steady \[s\]: some
    /// time constants of the surge, `m/(rho A CD V)`, which is 10 to 25 s.
    pub after_turn_s: f64,
    /// Time before a turn up to which it is \[s\].
    pub before_turn_s: f64,
    /// Time around a move of a motor that is left out \[s\].
    pub motor_margin_s: f64,
    /// Longest gap in a slow channel over which a straight line is drawn \[s\]; four sampling intervals where that is more.
    pub longest_fill_s: f64,
    /// Longest time between two samples of one stretch \[s\]; ten sampling intervals where that is more.
    pub longest_gap_s: f64,
}

impl Default for PreparationSettings {
    fn default() -> Self {
        PreparationSettings {
            density_kg_m3: None,
            gravity_m_s2: 9.81,
            needs_temperature: false,
            half_window_s: 4.0,
            least_leg_dbar: 4.0,
            surface_dbar: 5.0,
            after_turn_s: 90.0,
            before_turn_s: 8.0,
            motor_margin_s: 6.0,
            longest_fill_s: 120.0,
            longest_gap_s: 60.0,
        }
    }
}
