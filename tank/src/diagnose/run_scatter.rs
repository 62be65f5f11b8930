//! How much the runs scatter about the model beside what their own records and settings allow. Few runs without repeats cannot
//! separate a model that is wrong from settings that are not reproduced: both are noise to the search for causes. The reader
//! is warned where that noise is relevant. Knows what a fit leaves; no mechanisms.

use glidepolar_inference::score::CLEARLY_WRONG;
use glidepolar_inference::{Outcome, Problem};
use statrs::distribution::{ContinuousCDF, Normal};

use super::data::Data;
use super::problem::{RECORDS_KNOWN_TO, TankProblem};
use super::repeats;
use crate::series::median;

/// Median of the absolute value of a standard normal variable.
const MEDIAN_OF_NORMAL: f64 = 0.6745;

/// A warning for each coefficient whose runs scatter by a relevant size and by more than their records allow; none where something is
/// unexplained, which says so already.
pub fn warnings(outcome: &Outcome, data: &Data, problem: &TankProblem<'_>) -> Vec<String> {
    if !data.is_raw || outcome.diagnosis.unexplained.is_some() {
        return Vec::new();
    }
    let advice = if repeats::are_made(data, problem.order()) {
        "repeats scatter as well"
    } else {
        "repeats at one setting would separate the two"
    };
    let evidence = problem.evidence(&outcome.after.point);
    let of = |quantity: &glidepolar_inference::Quantity| {
        // Of independent rows: an error that runs share, as of a strut, is no scatter. Of the middle run: one of which hardly
        // anything is known says nothing of the others.
        let left: Vec<f64> = quantity.rows.clone().map(|row| evidence.residual[row].abs()).collect();
        let scatter = median(&left) / MEDIAN_OF_NORMAL;
        let allowed = median(&evidence.stated_sd[quantity.rows.clone()]);
        let is_relevant = scatter > problem.relevance(quantity, 0.0);
        (is_relevant && probability(scatter / allowed, quantity.rows.len()) < CLEARLY_WRONG).then(|| {
            format!(
                "{} scatters by {scatter:.2e} from run to run, where the runs' own records allow {allowed:.1e}: angles or speeds are not reproduced, or something that differs between runs is at work; {advice}",
                quantity.name
            )
        })
    };
    evidence.quantities.iter().filter_map(of).collect()
}

/// Probability that so many runs scatter by chance at least this many times what their records allow: a variance from `n` runs is known to
/// `sqrt(2/n)` in its logarithm, that of the records to [`RECORDS_KNOWN_TO`].
fn probability(ratio: f64, runs: usize) -> f64 {
    let sd = RECORDS_KNOWN_TO.hypot((2.0 / runs as f64).sqrt());
    Normal::new(0.0, sd).map_or(1.0, |normal| normal.sf(2.0 * ratio.ln()))
}

#[cfg(test)]
mod tests {
    use super::probability;

    #[test]
    fn a_scatter_must_exceed_the_records_by_what_both_are_uncertain_by() {
        // Fifty runs: ln of a variance is known to hypot(0.5, 0.2) = 0.5385; 3.719 of these are a factor of e in the scatter.
        let at_limit = (3.719f64 * 0.5385 / 2.0).exp();
        assert!((probability(at_limit, 50) - 1e-4).abs() < 1e-6);
        assert!(probability(1.0, 50) == 0.5 && probability(3.0, 12) > 1e-4 && probability(3.0, 200) < 1e-4);
    }
}
