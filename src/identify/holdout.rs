//! Held-out errors: the fit repeated without every other dive, and judged on the dives that it did not see.

use super::data::Dive;
use super::joint::{IdentifyError, Question, fit};
use super::residuals::{Score, ScoreSums};

/// Least number of dives for two halves that can each be fitted.
const LEAST_DIVES: usize = 4;

/// The fit of every other dive, judged on those between, and the other way round.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// Errors on the dives that a fit did not see, both halves taken together.
    pub score: Score,
    /// What the halves say of each free parameter, by the row of [`PARAMETERS`](crate::dynamics::PARAMETERS).
    pub halves: Vec<(usize, [f64; 2])>,
}

/// Both halves of the dives fitted apart; nothing with fewer than four dives.
///
/// # Errors
/// As [`fit`].
pub fn hold_out(question: &Question, dives: &[Dive]) -> Result<Option<HeldOut>, IdentifyError> {
    if dives.len() < LEAST_DIVES {
        return Ok(None);
    }
    let half = |held: usize| -> Vec<Dive> {
        dives.iter().enumerate().filter(|(i, _)| i % 2 == held).map(|(_, dive)| dive.clone()).collect()
    };
    let mut sums = ScoreSums::default();
    let mut halves: Vec<(usize, [f64; 2])> = question.free.iter().map(|&row| (row, [f64::NAN; 2])).collect();
    for held in [0, 1] {
        let fitted = fit(question, &mut half(1 - held))?;
        halves.iter_mut().for_each(|(row, values)| values[1 - held] = fitted.value(*row));
        for dive in half(held) {
            sums.add(&dive.observations, &dive.residuals(&fitted.parameters));
        }
    }
    Ok(Some(HeldOut { score: sums.score(), halves }))
}
