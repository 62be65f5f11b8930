//! Effects hidden in a campaign: asked for by name, drawn from the seed, handed to the parts that they act on.

use serde::{Deserialize, Serialize};

/// An effect asked for: its name in the [catalogue](super::CATALOGUE) and, if given, its size in the catalogue's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct EffectRequest {
    /// Name as in the catalogue.
    pub name: String,
    /// Size; drawn from the seed when absent.
    pub size: Option<f64>,
}

/// An effect as it was hidden in a campaign.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HiddenEffect {
    /// Name as in the catalogue.
    pub name: String,
    /// Name of the size.
    pub parameter: String,
    /// Unit of the size; empty for ratios.
    pub unit: String,
    /// Size.
    pub value: f64,
    /// What the size means, with its sign.
    pub meaning: String,
    /// What else was drawn: channel, day, side.
    pub detail: String,
}

/// The three channels of the balance, in the order of every force triple here: AF, SF, YM.
pub(super) const CHANNELS: [&str; 3] = ["AF", "SF", "YM"];

/// Every effect, neutral unless hidden.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hidden {
    pub crossflow_per_rad2: f64,
    pub yaw_misalignment_deg: f64,
    /// AF in N, SF in N, YM in N m.
    pub shift_under_way: [f64; 3],
    pub af_from_sf: f64,
    pub moment_centre_error_m: f64,
    pub speed_scale: f64,
    pub warm_up: Option<WarmUp>,
    pub untared_strut_n: Option<f64>,
    pub drag_exponent: f64,
    pub wrong_temperature: Option<WrongTemperature>,
    pub asymmetry_ratio: f64,
    pub wave_hump_cd: f64,
    pub gyre: Option<Gyre>,
    pub bubble: Option<Bubble>,
    pub residual_current: f64,
    pub weed: Option<Weed>,
    pub vibration: Option<RectifiedVibration>,
    pub blockage_section_ratio: f64,
    pub wall: Option<Wall>,
    pub strut_interference_per_rad2: f64,
    pub hysteresis_share: f64,
    pub softening_per_n: f64,
    pub lock_in: Option<Transition>,
    pub stall: Option<Bubble>,
    pub transition: Option<Transition>,
    pub flipped: [bool; 3],
}

/// A zero that runs away after the morning's switching-on and settles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WarmUp {
    pub channel: usize,
    pub rate_per_hour: f64,
    pub time_constant_h: f64,
}

/// A temperature wrongly entered for one day; `day_fraction` of the days with models in the water go before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WrongTemperature {
    pub error_c: f64,
    pub day_fraction: f64,
}

/// A slow transverse circulation of the tank's water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gyre {
    pub current_m_s: f64,
    pub period_s: f64,
    pub phase_rad: f64,
}

/// Loss of lift beyond one angle on one side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bubble {
    pub lift_loss: f64,
    pub onset_rad: f64,
    pub side: f64,
}

/// Something caught on the model from one run of a hull's programme on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Weed {
    pub drag_coefficient: f64,
    pub hull_fraction: f64,
    pub run_fraction: f64,
}

/// Vibration of the carriage that the balance turns into a mean side force; it comes and goes with the angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RectifiedVibration {
    pub side_force_n: f64,
    pub period_rad: f64,
    pub phase_rad: f64,
}

/// A wall that draws the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wall {
    pub side_force: f64,
    /// Of its centre ahead of the centre of buoyancy, overall lengths.
    pub arm_lengths: f64,
}

/// A boundary layer that stays laminar further aft below one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transition {
    pub drag_saved: f64,
    pub speed_m_s: f64,
}

impl Default for Hidden {
    fn default() -> Self {
        Self {
            crossflow_per_rad2: 0.0,
            yaw_misalignment_deg: 0.0,
            shift_under_way: [0.0; 3],
            af_from_sf: 0.0,
            moment_centre_error_m: 0.0,
            speed_scale: 1.0,
            warm_up: None,
            untared_strut_n: None,
            drag_exponent: 0.0,
            wrong_temperature: None,
            asymmetry_ratio: 1.0,
            wave_hump_cd: 0.0,
            gyre: None,
            bubble: None,
            residual_current: 0.0,
            weed: None,
            vibration: None,
            blockage_section_ratio: 0.0,
            wall: None,
            strut_interference_per_rad2: 0.0,
            hysteresis_share: 0.0,
            softening_per_n: 0.0,
            lock_in: None,
            stall: None,
            transition: None,
            flipped: [false; 3],
        }
    }
}
