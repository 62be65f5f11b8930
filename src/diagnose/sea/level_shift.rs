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
use crate::diagnose::findings::{Judged, Left, Unexplained, Wrong};
use crate::diagnose::score::CLEARLY_WRONG;
use crate::diagnose::{Evidence, Outcome, Problem, holdout};

/// Dives in a run, and dives beside it: one alone is an accident.
const LEAST_DIVES: usize = 2;

/// Most parts of a log, of a dive each or of several one after the other, among which runs are looked for.
const MOST_PARTS: usize = 60;

/// Where some dives tell of such a change, adds it to what was said: a verdict `none` becomes `unexplained`.
pub(super) fn add(outcome: &mut Outcome, problem: &impl Problem) {
    if outcome.diagnosis.unexplained.is_some() {
        return;
    }
    let Some(wrong) = misfit(outcome, problem, &problem.evidence(&outcome.after.point)) else { return };
    let diagnosis = &mut outcome.diagnosis;
    diagnosis.leave_unexplained(Unexplained {
        quantity: wrong.quantity.clone(),
        rms: wrong.rms,
        depends_on: vec![wrong.regime.clone()],
    });
    diagnosis.left.retain(|left| left.quantity != wrong.quantity);
    let left = Left {
        quantity: wrong.quantity.clone(),
        depends_on: wrong.regime.clone(),
        size: wrong.size,
        relevant_above: wrong.relevant_above,
        p_value: wrong.p_value,
        judged: Judged::Relevant,
    };
    diagnosis.left.insert(0, left);
    diagnosis.wrong.push(wrong);
}

fn misfit(outcome: &Outcome, problem: &impl Problem, evidence: &Evidence) -> Option<Wrong> {
    let quantity = evidence.quantities.iter().find(|quantity| quantity.name == VERTICAL_VELOCITY)?;
    let rows = quantity.rows.clone();
    let residual = &outcome.after.residual.as_slice()[rows.clone()];
    let found = clearest(&of_dives(&evidence.block[rows.clone()], &evidence.leg[rows.clone()], residual))?;
    let sd = &outcome.after.sd[rows.clone()];
    let scatter = (sd.iter().map(|sd| sd * sd).sum::<f64>() / sd.len() as f64).sqrt();
    let limit = problem.relevance(quantity, scatter);
    (found.p_value < CLEARLY_WRONG && found.least_size() > limit).then(|| Wrong {
        quantity: quantity.name.to_owned(),
        regime: "time".to_owned(),
        rms: holdout::rms(&outcome.after.residual, rows),
        expected_rms: scatter,
        size: found.size,
        relevant_above: limit,
        p_value: found.p_value,
    })
}

/// Half the difference of the mean misfits of each descent and the ascent after it, in the order of time: `block` is the number of each
/// row's leg, `leg` positive on descents.
fn of_dives(block: &[usize], leg: &[f64], residual: &[f64]) -> Vec<f64> {
    let mut first = 0;
    let legs: Vec<(usize, f64, f64)> = block
        .chunk_by(|a, b| a == b)
        .map(|rows| {
            let own = first..first + rows.len();
            first = own.end;
            (rows[0], leg[own.start], residual[own].iter().sum::<f64>() / rows.len() as f64)
        })
        .collect();
    let is_dive = |pair: &&[(usize, f64, f64)]| pair[1].0 == pair[0].0 + 1 && pair[0].1 > 0.0 && pair[1].1 < 0.0;
    legs.windows(2).filter(is_dive).map(|pair| 0.5 * (pair[0].2 - pair[1].2)).collect()
}

/// The run of dives that differs most clearly from the others; none with too few dives.
fn clearest(dives: &[f64]) -> Option<LevelShift> {
    let together = dives.chunks(dives.len().div_ceil(MOST_PARTS).max(1));
    let parts: Vec<f64> = together.map(|dives| dives.iter().sum::<f64>() / dives.len() as f64).collect();
    let mean = DMatrix::from_element(parts.len(), 1, 1.0);
    LevelShift::clearest(&mean, &runs(parts.len())?, &DVector::from_vec(parts), 0.0)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Sixteen dives of five rows a leg in water that sinks and rises within five dives by 10 mm/s, and with scatter of 1 mm/s; on some
    /// of them the glider is slower by so much.
    fn of_log(slower_m_s: f64) -> Vec<f64> {
        let row = |i: usize| (i / 5, if (i / 5).is_multiple_of(2) { 1.0 } else { -1.0 });
        let residual = |i: usize| {
            let (block, leg) = row(i);
            let water = 0.01 * (std::f64::consts::TAU * i as f64 / 50.0).sin();
            let scatter = 1e-3 * (12.9898 * i as f64).sin();
            water + scatter + if (8..14).contains(&(block / 2)) { leg * slower_m_s } else { 0.0 }
        };
        let rows = 0..160;
        let (block, leg): (Vec<usize>, Vec<f64>) = rows.clone().map(row).unzip();
        of_dives(&block, &leg, &rows.map(residual).collect::<Vec<f64>>())
    }

    #[test]
    fn dives_that_are_slower_on_both_legs_stand_out_of_moving_water() {
        let clear = clearest(&of_log(0.01)).expect("dives");
        assert!(clear.p_value < CLEARLY_WRONG, "{clear:?}");
        // 0.01 on six of sixteen dives is 0.01 sqrt(6/16 10/16) about their mean.
        assert!((clear.size - 0.00484).abs() < 1e-3, "{clear:?}");
        let nothing = clearest(&of_log(0.0)).expect("dives");
        assert!(nothing.p_value > 0.01, "{nothing:?}");
        assert_eq!(clearest(&[0.0, 1.0, 2.0]), None, "two against one");
    }

    #[test]
    fn a_dive_is_a_descent_and_the_ascent_after_it() {
        let found = of_dives(&[0, 0, 1, 2, 4, 5], &[1.0, 1.0, -1.0, 1.0, 1.0, -1.0], &[1.0, 3.0, 0.5, 9.0, 4.0, 2.0]);
        assert_eq!(found, [0.75, 1.0]);
    }
}
