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
    pub rig: RigFaults,
    pub flipped: [bool; 3],
}

/// Faults of rig, model and water that no mechanism of a reduction describes; none unless hidden.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct RigFaults {
    /// Relative error of the carriage's measured speed, a standard deviation from run to run.
    pub speed_slip: f64,
    /// Share that YM gains about one speed \[1, m/s\].
    pub resonance: Option<(f64, f64)>,
    pub torn_strip: Option<TornStrip>,
    /// CD gained about 1 m/s late in the day, where the water has settled in layers.
    pub dead_water_cd: f64,
    /// Share of a hull's programme at which so many runs are written down with the other sign of yaw.
    pub flipped_block: Option<(f64, usize)>,
    pub seiche: Option<Seiche>,
    /// Moment and side force of a cable that the yaw table twists, per degree, whatever the speed \[N m, N\].
    pub cable_per_deg: (f64, f64),
    /// Yaw by which the table slips at one run of a hull, and when, as shares of hulls and of runs \[deg, 1, 1\].
    pub yaw_slip: Option<(f64, f64, f64)>,
    pub touching: Option<Touching>,
    /// Free play of the yaw table \[deg\].
    pub backlash_deg: f64,
    /// Twist of the strut \[rad/(N m)\].
    pub twist_rad_per_N_m: f64,
    /// CD of air on the hull at the begin of a day, and its time constant \[1, h\].
    pub air: Option<(f64, f64)>,
}

/// A strip of sand that trips the boundary layer, torn off one hull: there the flow stays laminar below one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TornStrip {
    pub drag_saved: f64,
    pub speed_m_s: f64,
    pub hull_fraction: f64,
    /// The side that lost more of it.
    pub side: f64,
}

/// A standing wave of the tank that the run before started.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seiche {
    /// Current over the speed of the run before.
    pub ratio: f64,
    pub period_s: f64,
    pub decay_s: f64,
}

/// The model touches something beyond one angle on one side and hands it a share of its load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Touching {
    pub share: f64,
    pub onset_rad: f64,
    pub side: f64,
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
            rig: RigFaults::default(),
            flipped: [false; 3],
        }
    }
}
