//! The unsteady fit of a whole log, and how it does beside the steady one where the glider turns.

use serde::Serialize;

use super::joint::{IdentifyError, JointFit, Question, refine};
use super::residuals::{Residual, Score, ScoreSums, residuals};
use super::unsteady::{Passage, passages};
use crate::dynamics::Parameters;
use crate::log::Observation;

/// What the unsteady mode goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unsteady {
    /// Pressure above which samples do not count: waves \[dbar\].
    pub from_dbar: f64,
    /// Half window of the filter that made the vertical velocity \[s\].
    pub half_window_s: f64,
}

/// Parameters that a steady glide does not show at all.
pub const UNSTEADY_ONLY: [&str; 3] = ["added_mass_1_kg", "added_mass_3_kg", "moving_mass_height_m"];

/// The unsteady fit.
#[derive(Debug, Clone)]
pub struct Inflections {
    /// The fit.
    pub fit: JointFit,
    /// The dives as flown.
    pub passages: Vec<Passage>,
    /// All samples below the waves, inflections included.
    pub score: Score,
    /// The same on dives that the fit did not see.
    pub held_out: Option<Score>,
    /// Beside the steady fit.
    pub comparison: Comparison,
}

/// Steady and unsteady on one set of samples, inflections included; a steady glide does not exist at all of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Comparison {
    /// Pressure below which samples count \[dbar\].
    pub from_dbar: f64,
    /// The unsteady fit on all samples.
    pub unsteady: Score,
    /// The unsteady fit where a steady glide exists.
    pub unsteady_where_steady_exists: Score,
    /// The steady fit where a steady glide exists.
    pub steady: Score,
    /// The unsteady fit on the samples that the steady one uses, of dives that it did not see.
    pub unsteady_at_steady_samples_holdout: Option<Score>,
}

/// Fits the question again on dives flown through time, from what the steady fit found.
///
/// # Errors
/// As [`super::fit`].
pub fn inflections(
    question: &Question,
    steady: &Parameters<f64>,
    observations: &[Observation],
    unsteady: &Unsteady,
) -> Result<Inflections, IdentifyError> {
    let mut passages = passages(observations, unsteady.from_dbar, unsteady.half_window_s);
    let question = Question { baseline: *steady, several_starts: false, ..question.clone() };
    let fit = refine(&question, &mut passages)?;
    let (mut all, mut common, mut of_steady) = (ScoreSums::default(), ScoreSums::default(), ScoreSums::default());
    for passage in &passages {
        let flown = passage.residuals(&fit.parameters);
        let mut gliding = residuals(steady, &passage.observations);
        let mut both = flown.clone();
        for (i, counts) in passage.counts.iter().enumerate() {
            if !counts || !gliding[i].sink_m_s.is_finite() || !both[i].sink_m_s.is_finite() {
                (gliding[i], both[i]) = (Residual::NONE, Residual::NONE);
            }
        }
        all.add_stretch(&flown);
        common.add_stretch(&both);
        of_steady.add_stretch(&gliding);
    }
    let comparison = Comparison {
        from_dbar: unsteady.from_dbar,
        unsteady: all.score(),
        unsteady_where_steady_exists: common.score(),
        steady: of_steady.score(),
        unsteady_at_steady_samples_holdout: None,
    };
    let (held_out, of_steady_samples) = match held_out(&question, &fit.parameters, &passages)? {
        Some((all, steady)) => (Some(all), Some(steady)),
        None => (None, None),
    };
    let comparison = Comparison { unsteady_at_steady_samples_holdout: of_steady_samples, ..comparison };
    Ok(Inflections { fit, score: all.score(), passages, held_out, comparison })
}

/// The score on dives that the fit did not see: of all samples, and of the steady ones.
fn held_out(
    question: &Question,
    best: &Parameters<f64>,
    passages: &[Passage],
) -> Result<Option<(Score, Score)>, IdentifyError> {
    if passages.len() < 4 {
        return Ok(None);
    }
    let question = Question { baseline: *best, ..question.clone() };
    let (mut all, mut steady) = (ScoreSums::default(), ScoreSums::default());
    for held in [0, 1] {
        let half = |side: usize| passages.iter().enumerate().filter(move |(i, _)| i % 2 == side).map(|(_, p)| p);
        let mut trained: Vec<Passage> = half(1 - held).cloned().collect();
        let fitted = refine(&question, &mut trained)?;
        for passage in half(held) {
            let found = passage.residuals(&fitted.parameters);
            all.add_stretch(&found);
            let (rows, found): (Vec<Observation>, Vec<Residual>) =
                passage.observations.iter().zip(&found).filter(|(o, _)| o.steady).unzip();
            steady.add(&rows, &found);
        }
    }
    Ok(Some((all.score(), steady.score())))
}
