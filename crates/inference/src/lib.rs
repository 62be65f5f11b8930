//! Diagnosis: what the model gets wrong, why, the extension, the gain. One engine for the tank and the sea.
//!
//! - [`evidence`]: what the engine is given: residuals and sensitivities at a point, by a [`Problem`].
//! - [`crate::noise`]: what is left when the model is right, so that correlated residuals count for as little as they tell;
//!   [`restricted_likelihood`]: how large it is; `noise_of_fit`: what is set aside for it.
//! - [`score`], [`subset_search`]: what each set of mechanisms explains, and which set is worth its cost.
//! - [`smooth`]: curves of unknown cause that run in the same search; where one wins, no mechanism is named.
//! - `clusters`: a test by the scatter between legs or runs, beside that by the model of noise.
//! - [`relevance`]: which misfit is large enough to act on.
//! - [`holdout`]: the gain on data that no fit saw.
//! - [`engine`]: the four answers in their order, with what it is made of: a fit, the points from which it begins, how well it is
//!   known, backward elimination, one iteration of the search, versions of one mechanism, the report.

mod alone;
mod alternatives;
mod backward_elimination;
mod baseline;
mod change_point;
mod clusters;
pub mod covariance;
pub mod decorrelation;
pub mod engine;
pub mod estimate;
pub mod evidence;
pub mod findings;
mod fitted;
pub mod gram;
pub mod holdout;
mod iteration;
pub mod level_shift;
mod magnitude_tests;
mod marginal_likelihood;
mod multistart;
pub mod noise;
mod noise_of_fit;
pub mod order;
pub mod outcome;
mod partly;
pub mod regimes;
pub mod regression;
pub mod relevance;
mod relevance_tests;
mod replacements;
mod report;
pub mod restricted_likelihood;
pub mod score;
pub mod smooth;
pub mod specification_test;
mod steps;
pub mod subset_search;
mod uncertainty;
mod unnamed;

pub use engine::{diagnose, diagnose_in_full};
pub use evidence::{Candidate, Covariate, Evidence, Headline, Point, Problem, Quantity, Version};
pub use findings::{
    Alternative, Cause, Check, Checked, Diagnosis, Empirical, Gain, HalfSize, Judged, Left, Rejected, Unexplained,
    Verdict, Why, Wrong,
};
pub use outcome::{Outcome, Stage, gains};
pub use relevance::Relevance;
pub use unnamed::{Offered, Unnamed, best_unnamed, fitted_again};

#[cfg(test)]
mod tests;
