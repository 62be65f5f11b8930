//! What is true in a virtual tank: `truth.toml`, beside the campaign, for tests and for people. A reduction never reads it.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::balance::{DayZero, Strut};
use super::effects::HiddenEffect;
use super::hull::{DynamicDerivatives, LiveMass, StaticCoefficients};
use super::motion::Kind;
use super::noise::NoiseLevels;

/// Marks a folder as a virtual tank's.
pub const SCHEMA: &str = "glidepolar.virtual-tank/1";

/// Everything that was decided before the first reading was taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// [`SCHEMA`].
    pub schema: String,
    /// Always true: nothing in the folder was measured.
    pub synthetic: bool,
    /// Seed of the campaign.
    pub seed: u64,
    /// Scale of everything random within and between runs; 1 is a good tank.
    pub noise: f64,
    /// Total of the runs' files, bytes.
    pub data_bytes: u64,
    /// Digest of the campaign's files as they were written, to tell whether anybody edited them since.
    #[serde(default)]
    pub digest: String,
    /// Changes per unit of length to diameter ratio; exact, since a, b, c, d are straight lines in it.
    pub trend: Trend,
    /// Levels of the noise.
    pub noise_levels: NoiseLevels,
    /// The balance.
    pub balance: BalanceTruth,
    /// What is hidden.
    #[serde(rename = "effect", default)]
    pub effects: Vec<HiddenEffect>,
    /// The hulls.
    #[serde(rename = "hull")]
    pub hulls: Vec<HullTruth>,
    /// The runs, in the order in which they were made.
    #[serde(rename = "run")]
    pub runs: Vec<RunTruth>,
}

/// Slopes of the coefficients against length to diameter ratio.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs, reason = "the coefficients' own symbols")]
pub struct Trend {
    pub a_per_ldr: f64,
    pub b_per_ldr: f64,
    pub c_per_ldr: f64,
    pub d_per_ldr: f64,
}

/// Strut and balance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BalanceTruth {
    /// Force = matrix (reading - zero), as in the manifest; hidden cross-talk comes on top.
    pub interaction: [[f64; 3]; 3],
    /// The strut's forces.
    pub strut: Strut,
    /// Even drift of the zeros, day by day.
    #[serde(rename = "day")]
    pub days: Vec<DayZero>,
}

/// One hull.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HullTruth {
    /// Id as in the manifest.
    pub id: String,
    /// Length to diameter ratio.
    pub ldr: f64,
    /// a, b, c, d.
    #[serde(flatten)]
    pub coefficients: StaticCoefficients,
    /// Mass below the balance, as in the manifest.
    #[serde(flatten)]
    pub live: LiveMass,
    /// Derivatives about the centre of buoyancy.
    pub dynamic: DynamicDerivatives,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunTruth {
    /// Id as in `runs.csv`.
    pub id: String,
    /// Kind as in `runs.csv`.
    pub kind: Kind,
    /// Begin of the steady or fully periodic part, s.
    pub steady_from_s: f64,
    /// Its end, s.
    pub steady_to_s: f64,
    /// True temperature of the water.
    pub temperature_c: f64,
    /// True yaw less recorded yaw: this run's own random error, without any hidden misalignment.
    pub yaw_setting_error_deg: f64,
    /// True speed over set speed: this run's own random error, without any hidden scale.
    pub speed_setting_ratio: f64,
    /// What the channels show without load at the run's begin (AF N, SF N, YM N m), before any shift under way.
    pub zero: [f64; 3],
    /// Time since the run before, s.
    pub wait_s: f64,
}

impl Truth {
    /// Reads `truth.toml` of a campaign folder; none if there is none or it is not a virtual tank's.
    pub fn read(campaign: &Path) -> Option<Self> {
        let text = std::fs::read_to_string(campaign.join("truth.toml")).ok()?;
        let truth: Self = toml::from_str(&text).ok()?;
        (truth.schema == SCHEMA).then_some(truth)
    }
}
