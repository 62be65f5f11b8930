//! What a log says of the causes of turning, and the limits for it.

use std::collections::BTreeMap;

use glidepolar_inference::estimate::Estimate;

/// Probability by chance, corrected for the number of questions, above which nothing is named: the diagnosis' own limit.
pub const MOST_CHANCE: f64 = 0.01;

/// Roll at rest from which a list is worth acting on \[rad\]: attitude sensors are mounted within about a degree, and a list of
/// 2.5 deg adds less than 1 % of drag to the built-in gliders.
pub const RELEVANT_ROLL_RAD: f64 = 0.044;

/// Curvature of the path from which an asymmetry in yaw is worth acting on \[rad/m\]: 15 deg, a usual dead band of a heading
/// control, within five minutes at 0.3 m/s.
pub const RELEVANT_YAW_RAD_M: f64 = 0.003;

/// The quantities of the readings.
pub const TURN_RATE: &str = "turn_rate";
/// See [`TURN_RATE`].
pub const ROLL: &str = "roll";
/// See [`TURN_RATE`]: nothing is named by the pitch alone.
pub(super) const PITCH: &str = "pitch";

/// A cause that is named.
#[derive(Debug, Clone)]
pub struct LateralCause {
    /// Name of the mechanism.
    pub cause: &'static str,
    /// Its parameters; the size has the name of the vehicle file's figure where there is one.
    pub parameters: BTreeMap<String, Estimate>,
    /// Probability by chance of a size like this one.
    pub p_value: f64,
    /// Fall of the Bayesian information criterion, a dive and leg being one observation.
    pub delta_bic: f64,
    /// Quantity of the errors: [`TURN_RATE`] \[rad/s\] or [`ROLL`] \[rad\].
    pub quantity: &'static str,
    /// Error on held-out dives without it.
    pub holdout_rms_before: f64,
    /// Error on held-out dives with it.
    pub holdout_rms_after: f64,
    /// By how many per cent it falls.
    pub reduction_percent: Estimate,
    /// Scatter about the fitted model with it.
    pub expected_rms: f64,
    /// Root mean square of what it does to the quantity.
    pub size: f64,
    /// The limit of relevance in the quantity.
    pub relevant_above: f64,
    /// Its size on the first and second half of the dives, with standard errors; empty where half of them is too few.
    pub halves: Vec<(f64, f64)>,
    /// Mechanisms that the log cannot separate from it.
    pub indistinguishable_from: Vec<&'static str>,
}

/// A mechanism that is not named, with its probability by chance and a sentence.
#[derive(Debug, Clone)]
pub struct LateralRejected {
    /// Name of the mechanism.
    pub cause: &'static str,
    /// Probability by chance; none where the log cannot show it.
    pub p_value: Option<f64>,
    /// Whether held-out dives speak against it.
    pub predicts_no_better: bool,
    /// The reason.
    pub remark: String,
}

/// What a log says of the causes of turning.
#[derive(Debug, Clone)]
pub struct LateralDiagnosis {
    /// Steady stretches.
    pub stretches: usize,
    /// Named mechanisms, the clearest first.
    pub causes: Vec<LateralCause>,
    /// Roll at rest \[rad\] and curvature \[rad/m\] with standard errors, named or not.
    pub sizes: [Option<[f64; 2]>; 2],
    /// The others.
    pub rejected: Vec<LateralRejected>,
    /// Turn rate per roll on a straight course over turn rate per rudder: the rudder that holds a rolled glider straight.
    pub rudder_per_roll: Option<f64>,
    /// The stretches before and after the named causes; empty where nothing is named.
    pub modelled: Vec<ModelledStretch>,
}

/// A steady stretch: roll \[rad\] and turn rate \[rad/s\] as measured and as modelled.
#[derive(Debug, Clone, Copy)]
pub struct ModelledStretch {
    /// Whether the glider descends.
    pub descends: bool,
    /// Roll and turn rate by the log.
    pub measured: [f64; 2],
    /// The same by the model fitted without the named causes.
    pub before: [f64; 2],
    /// The same by the model fitted with them.
    pub after: [f64; 2],
}

/// Adds mechanisms that are not named, with the reason.
pub(super) fn reject(
    found: &mut LateralDiagnosis,
    causes: &[&'static str],
    p_value: Option<f64>,
    predicts_no_better: bool,
    remark: &str,
) {
    found.rejected.extend(causes.iter().map(|cause| LateralRejected {
        cause,
        p_value,
        predicts_no_better,
        remark: remark.to_owned(),
    }));
}
