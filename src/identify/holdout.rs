//! Held-out errors: the fit repeated without every other dive, and judged on the dives that it did not see.

use super::data::Dive;
use super::joint::{IdentifyError, Question, fit};
use super::residuals::{Score, ScoreSums, residuals};

/// Least number of dives for two halves that can each be fitted.
const LEAST_DIVES: usize = 4;

/// The score on held-out dives, both halves taken together; nothing with fewer than four dives.
///
/// # Errors
/// As [`fit`].
pub fn hold_out(question: &Question, dives: &[Dive]) -> Result<Option<Score>, IdentifyError> {
    if dives.len() < LEAST_DIVES {
        return Ok(None);
    }
    let half = |held: usize| -> Vec<Dive> {
        dives.iter().enumerate().filter(|(i, _)| i % 2 == held).map(|(_, dive)| dive.clone()).collect()
    };
    let mut sums = ScoreSums::default();
    for held in [0, 1] {
        let fitted = fit(question, &mut half(1 - held))?;
        for dive in half(held) {
            sums.add(&dive.observations, &residuals(&fitted.parameters, &dive.observations));
        }
    }
    Ok(Some(sums.score()))
}
