//! A level that is another one from some run on: a trip wire that comes off, weed that stays, a model that takes in water.
//!
//! A step at each place in the order of runs, of one hull or of the campaign, is held against no step, in each coefficient. Of its size
//! the least that 95 % allow must be relevant.
//!
//! Knows rows and the order of runs; no mechanisms.

use glidepolar_inference::level_shift::LevelShift;
use glidepolar_inference::score::CLEARLY_WRONG;
use glidepolar_inference::{Outcome, Problem, Wrong, holdout};
use nalgebra::{DMatrix, DVector};

use super::data::Data;
use super::independent_rows::IndependentRows;
use super::problem::TankProblem;

/// What such a misfit goes with.
pub const RUN_ORDER: &str = "run order";

/// Fewest runs on either side of a step: with fewer, single runs that went wrong would look like one.
const LEAST_RUNS: usize = 3;

/// The coefficients whose level is another one from some run on, by a relevant size.
pub fn misfits(outcome: &Outcome, data: &Data, problem: &TankProblem<'_>) -> Vec<Wrong> {
    if !data.is_raw {
        return Vec::new();
    }
    let evidence = problem.evidence(&outcome.after.point);
    let steps = steps(data, problem.order());
    if steps.is_empty() {
        return Vec::new();
    }
    let columns = DMatrix::from_columns(&steps);
    let quantities = evidence.quantities.len();
    let of = |k: usize| {
        let rows = IndependentRows::new(outcome, problem, &evidence, k);
        let stated = rows.stated_share().powi(2);
        let found = LevelShift::clearest(&rows.model, &rows.of_runs(&columns), &rows.residual, stated)?;
        let p_value = (quantities as f64 * found.p_value).min(1.0);
        let noise = rows.noise() * found.mean_square.sqrt();
        let limit = problem.relevance(rows.quantity, noise);
        (p_value < CLEARLY_WRONG && found.least_size() * rows.noise() > limit).then(|| Wrong {
            quantity: rows.quantity.name.to_owned(),
            regime: RUN_ORDER.to_owned(),
            rms: holdout::rms(&outcome.after.residual, rows.quantity.rows.clone()),
            expected_rms: noise,
            size: found.size * rows.noise(),
            relevant_above: limit,
            p_value,
        })
    };
    (0..quantities).filter_map(of).collect()
}

/// For each step the runs from it on: of the campaign, and of each hull where there are several.
fn steps(data: &Data, order: &[usize]) -> Vec<DVector<f64>> {
    let hulls = data.hulls.len();
    let parts = std::iter::once(None).chain((0..hulls).filter(|_| hulls > 1).map(Some));
    parts
        .flat_map(|part| {
            let is_in = |run: usize| part.is_none_or(|hull| data.runs[run].hull == hull);
            let places: Vec<usize> = (0..order.len()).filter(|place| is_in(order[*place])).collect();
            let last = places.len().saturating_sub(LEAST_RUNS) + 1;
            (LEAST_RUNS..last.max(LEAST_RUNS))
                .map(|from| {
                    let mut step = DVector::zeros(order.len());
                    places[from..].iter().for_each(|place| step[*place] = 1.0);
                    step
                })
                .collect::<Vec<_>>()
        })
        .collect()
}
