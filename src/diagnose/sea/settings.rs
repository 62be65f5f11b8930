//! What is asked of a diagnosis at sea, and why there may be none.

use super::MIN_BINS;
use crate::diagnose::Relevance;
use crate::diagnose::findings::{Check, Checked};

/// What is fitted to which data.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagnosisSettings {
    /// Whether measured speed is used where there is any.
    pub use_speed: bool,
    /// What is done about the lift slope.
    pub lift: Lift,
    /// Standard errors of `a`, `b` and `c` as the vehicle states them, over their values; none where it states none.
    pub polar_se: [Option<f64>; 3],
    /// Whether the trim was assumed, not stated: then it is fitted as part of the baseline, whatever mechanisms are tried.
    pub trim_is_assumed: bool,
    /// Whether the samples' temperature is only suggested by their density: then the hull's expansion is part of the baseline.
    pub temperature_is_suggested: bool,
    /// Which misfit is worth acting on.
    pub relevance: Relevance,
    /// Most bins; the bins are as long as that needs.
    pub max_bins: usize,
}

impl Default for DiagnosisSettings {
    fn default() -> Self {
        DiagnosisSettings {
            use_speed: true,
            lift: Lift::Fitted,
            polar_se: [None; 3],
            trim_is_assumed: false,
            temperature_is_suggested: false,
            relevance: Relevance::default(),
            max_bins: 900,
        }
    }
}

/// What is done about the lift slope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lift {
    /// It is fitted. Without measured speed the data hardly see it, and the belief in the vehicle's value decides.
    Fitted,
    /// It is fitted, the vehicle's value being known from outside with this standard error \[1/rad\].
    Known {
        /// The standard error.
        se_per_rad: f64,
    },
    /// It is held at the vehicle's value.
    Held,
}

/// Why there is no diagnosis.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SeaError {
    /// Too little steady glide in the log, whatever the vehicle.
    #[error(
        "too little steady glide: {found} stretches, at least {MIN_BINS} are needed; {steady} of its {samples} samples are steady glide, away from the surface, from turns and from moves of a motor, with pitch, ballast volume and density"
    )]
    TooShort {
        /// Stretches.
        found: usize,
        /// Samples of steady glide with all that is needed.
        steady: usize,
        /// All samples.
        samples: usize,
    },
    /// Too little that the vehicle could glide.
    #[error(
        "only {found} stretches of steady glide fit the vehicle, at least {MIN_BINS} are needed; check that the vehicle's mass and volume are this glider's (`--trim neutral` takes it as neutral at ballast zero)"
    )]
    TooFew {
        /// Bins that remained.
        found: usize,
    },
    /// The log contradicts itself.
    #[error("the log contradicts itself: {}", wrong(.0))]
    Inconsistent(Vec<Check>),
}

fn wrong(checks: &[Check]) -> String {
    let wrong = checks.iter().filter(|check| check.outcome == Checked::Wrong);
    wrong.map(|check| format!("{}: {}", check.check, check.says)).collect::<Vec<_>>().join("; ")
}
