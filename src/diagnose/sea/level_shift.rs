//! Dives on which the glider is faster, or slower, on both legs than on the others: fouled for some days and clean again, a wing lost,
//! something caught that falls off.
//!
//! Vertical motion of the water has one sign on a descent and the ascent after it, a drag or a lift has two. So half the difference of
//! both legs' misfits knows little of water that moves for longer than a dive, in which a slow noise would hide such a change. Each run
//! of dives is held against the others.
//!
//! Knows what a diagnosis leaves of the vertical velocity; no mechanisms.

use glidepolar_inference::level_shift::LevelShift;
use nalgebra::{DMatrix, DVector};

use super::VERTICAL_VELOCITY;
use crate::diagnose::findings::{Judged, Left, Unexplained, Verdict, Wrong};
use crate::diagnose::score::CLEARLY_WRONG;
use crate::diagnose::{Evidence, Outcome, Problem, holdout};

/// Dives in a run, and dives beside it: one alone is an accident.
const LEAST_DIVES: usize = 2;

/// Most parts of a log, of a dive each or of several one after the other, among which runs are looked for.
const MOST_PARTS: usize = 60;

/// The covariate along which it is reported.
const BY: &str = "time";

/// Where some dives tell of such a change, adds it to what was said: a verdict `none` becomes `unexplained`.
pub(super) fn add(outcome: &mut Outcome, problem: &impl Problem) {
    if outcome.diagnosis.unexplained.is_some() {
        return;
    }
    let Some(wrong) = misfit(outcome, problem, &problem.evidence(&outcome.after.point)) else { return };
    let diagnosis = &mut outcome.diagnosis;
    diagnosis.verdict = if diagnosis.causes.is_empty() { Verdict::Unexplained } else { Verdict::PartlyExplained };
    diagnosis.unexplained =
        Some(Unexplained { quantity: VERTICAL_VELOCITY.to_owned(), rms: wrong.rms, depends_on: vec![BY.to_owned()] });
    diagnosis.left.retain(|left| left.quantity != VERTICAL_VELOCITY);
    diagnosis.left.insert(
        0,
        Left {
            quantity: VERTICAL_VELOCITY.to_owned(),
            depends_on: BY.to_owned(),
            size: wrong.size,
            relevant_above: wrong.relevant_above,
            p_value: wrong.p_value,
            judged: Judged::Relevant,
        },
    );
    diagnosis.wrong.push(wrong);
}

fn misfit(outcome: &Outcome, problem: &impl Problem, evidence: &Evidence) -> Option<Wrong> {
    let quantity = evidence.quantities.iter().find(|quantity| quantity.name == VERTICAL_VELOCITY)?;
    let dives = of_dives(evidence, &outcome.after.residual, quantity.rows.clone());
    let together = dives.chunks(dives.len().div_ceil(MOST_PARTS).max(1));
    let dives =
        DVector::from_iterator(together.len(), together.map(|dives| dives.iter().sum::<f64>() / dives.len() as f64));
    let mean = DMatrix::from_element(dives.len(), 1, 1.0);
    let found = LevelShift::clearest(&mean, &runs(dives.len())?, &dives, 0.0)?;
    let sd = &outcome.after.sd[quantity.rows.clone()];
    let scatter = (sd.iter().map(|sd| sd * sd).sum::<f64>() / sd.len() as f64).sqrt();
    let limit = problem.relevance(quantity, scatter);
    (found.p_value < CLEARLY_WRONG && found.least_size() > limit).then(|| Wrong {
        quantity: quantity.name.to_owned(),
        regime: BY.to_owned(),
        rms: holdout::rms(&outcome.after.residual, quantity.rows.clone()),
        expected_rms: scatter,
        size: found.size,
        relevant_above: limit,
        p_value: found.p_value,
    })
}

/// Half the difference of the mean misfits of each descent and the ascent after it, in the order of time.
fn of_dives(evidence: &Evidence, residual: &DVector<f64>, rows: std::ops::Range<usize>) -> Vec<f64> {
    // Rows of one leg stand together: its number, its direction, the mean.
    let mut legs: Vec<(usize, f64, f64)> = Vec::new();
    let places: Vec<usize> = rows.collect();
    for leg in places.chunk_by(|a, b| evidence.block[*a] == evidence.block[*b]) {
        let mean = leg.iter().map(|row| residual[*row]).sum::<f64>() / leg.len() as f64;
        legs.push((evidence.block[leg[0]], evidence.leg[leg[0]], mean));
    }
    let is_dive = |pair: &&[(usize, f64, f64)]| pair[1].0 == pair[0].0 + 1 && pair[0].1 > 0.0 && pair[1].1 < 0.0;
    legs.windows(2).filter(is_dive).map(|pair| 0.5 * (pair[0].2 - pair[1].2)).collect()
}

/// Every run of dives that leaves enough of them inside and outside, a column each; none with too few dives.
fn runs(dives: usize) -> Option<DMatrix<f64>> {
    let is_enough = |first: usize, end: usize| {
        let inside = end.saturating_sub(first);
        inside >= LEAST_DIVES && dives - inside >= LEAST_DIVES
    };
    // A run at the beginning is the one behind it the other way round.
    let all = (1..dives).flat_map(|first| (first..=dives).map(move |end| (first, end)));
    let columns: Vec<DVector<f64>> = all
        .filter(|(first, end)| is_enough(*first, *end))
        .map(|(first, end)| DVector::from_fn(dives, |dive, _| if (first..end).contains(&dive) { 1.0 } else { 0.0 }))
        .collect();
    (!columns.is_empty()).then(|| DMatrix::from_columns(&columns))
}
