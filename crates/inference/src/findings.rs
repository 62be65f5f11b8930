//! The four answers of a diagnosis, in the form in which they are written down (`glidepolar.diagnosis/1`).

use std::collections::BTreeMap;

use serde::Serialize;

use crate::estimate::Estimate;

/// What a diagnosis says in a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing is wrong beyond what the measurement explains.
    None,
    /// Named mechanisms explain what is wrong.
    Explained,
    /// Named mechanisms explain a part.
    PartlyExplained,
    /// Something is wrong and no known mechanism fits.
    Unexplained,
}

impl Verdict {
    /// The verdict where causes are named or not, and something is left unexplained or not.
    pub fn new(is_named: bool, is_left: bool) -> Verdict {
        match (is_named, is_left) {
            (false, false) => Verdict::None,
            (true, false) => Verdict::Explained,
            (true, true) => Verdict::PartlyExplained,
            (false, true) => Verdict::Unexplained,
        }
    }
}

/// What came out of one check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Checked {
    /// As it should be.
    Consistent,
    /// Wrong, and corrected before anything was fitted.
    Corrected,
    /// Wrong: nothing can be diagnosed with it.
    Wrong,
    /// The data lack what the check needs.
    NotChecked,
}

/// One check of the data against themselves, before anything is fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// What was held against what.
    pub check: &'static str,
    /// What came out.
    pub outcome: Checked,
    /// In a sentence.
    pub says: String,
}

/// A quantity that the baseline misses, and where.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Wrong {
    /// The quantity.
    pub quantity: String,
    /// Where or with what the misfit goes.
    pub regime: String,
    /// Root mean square of the residuals.
    pub rms: f64,
    /// What the measurement alone would leave.
    pub expected_rms: f64,
    /// Root mean square of the fitted misfit, the share of the noise removed.
    pub size: f64,
    /// What it must exceed to be worth acting on.
    pub relevant_above: f64,
    /// Probability of such a misfit by chance, corrected for the number of tests.
    pub p_value: f64,
}

impl Wrong {
    /// The regime of a misfit that only the effect of this cause shows.
    pub fn regime_of(cause: &str) -> String {
        format!("the effect of {}", cause.replace('_', " "))
    }
}

/// The largest dependence of a quantity that remains beside the named causes, whether it is worth acting on or not.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Left {
    /// The quantity.
    pub quantity: String,
    /// The covariate on which what is left depends most clearly.
    pub depends_on: String,
    /// Root mean square of that dependence, the share of the noise removed.
    pub size: f64,
    /// What it must exceed to be worth acting on.
    pub relevant_above: f64,
    /// Probability of such a dependence by chance, corrected for the number of tests.
    pub p_value: f64,
    /// Whether it counts as unexplained, and if not why.
    pub judged: Judged,
}

/// Whether a dependence that remains counts as unexplained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Judged {
    /// It is clear, large enough to act on and predicts held-out data: it is unexplained.
    Relevant,
    /// It is not worth acting on.
    NotRelevant,
    /// It is as large as what logs with nothing wrong show now and then, which no model of the noise excludes.
    ByChance,
    /// It is clear, and the interval of its size reaches below what is worth acting on.
    SizeUncertain,
    /// A curve along it predicts held-out data no better.
    PredictsNoBetter,
}

/// A named mechanism with its evidence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cause {
    /// The mechanism.
    pub cause: String,
    /// Its parameters.
    pub parameters: BTreeMap<String, Estimate>,
    /// Probability of such a gain by chance, corrected for the number of mechanisms.
    pub p_value: f64,
    /// Fall of the Bayesian information criterion.
    pub delta_bic: f64,
    /// The quantity of the errors below.
    pub quantity: String,
    /// Error on held-out data without it.
    pub holdout_rms_before: f64,
    /// Error on held-out data with it.
    pub holdout_rms_after: f64,
    /// Its size on each half of the data; empty where it was not fitted.
    pub stability: Vec<HalfSize>,
    /// Mechanisms that these data cannot tell from it.
    pub indistinguishable_from: Vec<String>,
    /// Natural logarithm of the Bayes factor of one of them in its place against it: the ratio of their likelihoods, each integrated over the
    /// prior of its mechanism; of those that were fitted in full.
    pub log_likelihood_ratio: BTreeMap<String, f64>,
}

/// A mechanism of a set that could stand in the place of the named one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Alternative {
    /// The mechanism.
    pub cause: String,
    /// Its parameters, as the set asks for them.
    pub parameters: BTreeMap<String, Estimate>,
}

/// A mechanism that was tried and not named.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rejected {
    /// The mechanism.
    pub cause: String,
    /// Probability of its gain by chance; none where the data cannot show it.
    pub p_value: Option<f64>,
    /// Error on held-out data with it.
    pub holdout_rms_after: Option<f64>,
    /// Why it was not named.
    pub why: Why,
    /// The same in a sentence.
    pub remark: String,
}

/// Why a mechanism was not named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Why {
    /// It fits, and does not predict held-out data better, or not by enough to act on.
    PredictsNoBetter,
    /// It needs another size in another regime, or on the other half of the data.
    SizeVaries,
    /// It needs a size that nature does not have.
    SizeImpossible,
    /// It makes another quantity worse on held-out data.
    SpoilsQuantity,
    /// It explains no more than chance would.
    ByChance,
    /// These data cannot separate it from a named mechanism or from the baseline's own parameters.
    Equivalent,
    /// Its size is known to so few standard errors that another law might do as well.
    #[serde(rename = "equivalent")]
    HardlyKnown,
}

/// The size of a mechanism on one half of the data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HalfSize {
    /// `first` or `second`, in the order of time.
    pub half: &'static str,
    /// Its first parameter, fitted to this half alone.
    pub value: f64,
    /// Its standard error.
    pub se: f64,
    /// Whether this half alone shows it: two standard errors from having no effect, towards the same side as the whole.
    pub found: bool,
}

/// Structure that no mechanism explains.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unexplained {
    /// The quantity of which most is left, in units of its noise.
    pub quantity: String,
    /// Root mean square of what is left of it.
    pub rms: f64,
    /// What it goes with.
    pub depends_on: Vec<String>,
}

/// A table without a cause that the extension carries, because it predicts: a value at each point, straight lines between.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Empirical {
    /// What it changes: `drag`, `lift` (shares of them) or `net_mass_kg`.
    pub acts_on: &'static str,
    /// What it goes by.
    pub against: &'static str,
    /// Its points.
    pub at: Vec<f64>,
    /// Its values there.
    pub values: Vec<f64>,
    /// What it gains beside the named causes, of the quantity that gains most.
    pub gain: Gain,
}

/// Error before and after on data that no fit saw.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gain {
    /// The quantity.
    pub quantity: String,
    /// Without the causes.
    pub holdout_rms_before: f64,
    /// With them.
    pub holdout_rms_after: f64,
    /// Reduction in per cent.
    pub reduction_percent: f64,
    /// Its 95 % interval.
    pub ci95: [f64; 2],
}

/// A diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnosis {
    /// `glidepolar.diagnosis/1`.
    pub schema: &'static str,
    /// In a word.
    pub verdict: Verdict,
    /// The data against themselves: units, signs, time base, density. Empty where no such check was made.
    pub consistency: Vec<Check>,
    /// What the reader must know before believing the rest.
    pub warnings: Vec<String>,
    /// Where the baseline misses the data.
    pub wrong: Vec<Wrong>,
    /// The named mechanisms, strongest first.
    pub causes: Vec<Cause>,
    /// Sets of two and more that these data cannot tell from the named one; those that differ from it by one mechanism stand
    /// beside that one.
    pub alternatives: Vec<Vec<Alternative>>,
    /// Ballast offset against a baseline that was assumed to be neutral, not weighed: how the glider was trimmed.
    pub trim: Option<Estimate>,
    /// Where a log has its own current: the share of the predicted effect of its shear that the readings show, 1 by Newton's law.
    pub shear_share: Option<Estimate>,
    /// The others.
    pub rejected: Vec<Rejected>,
    /// For each quantity the clearest dependence that is left beside the causes, with its size and whether that is relevant.
    pub left: Vec<Left>,
    /// What is left unexplained.
    pub unexplained: Option<Unexplained>,
    /// The table that the extension carries for it, where one predicts.
    pub empirical: Option<Empirical>,
    /// What the extension gains on one quantity.
    pub gain: Gain,
    /// The same for every quantity.
    pub gains: Vec<Gain>,
    /// The file with the extended model, where one was written.
    pub extended: Option<String>,
}

impl Diagnosis {
    /// Says that this is left unexplained beside the causes.
    pub fn leave_unexplained(&mut self, unexplained: Unexplained) {
        self.verdict = Verdict::new(!self.causes.is_empty(), true);
        self.unexplained = Some(unexplained);
    }
}
