//! A level that is another one from some run on: a trip wire that comes off, weed that stays, a model that takes in water.
//!
//! A smooth curve in the order of runs follows a step badly, and what it leaves counts as noise. So a step at each place in the order of
//! runs, of one hull or of the campaign, is held against no step: the F test of one more parameter by what both leave, times the number
//! of steps that are tried (Bonferroni). Of its size the least that 95 % allow must be relevant.
//!
//! Knows rows and the order of runs; no mechanisms.

use glidepolar_inference::noise::orthonormal;
use glidepolar_inference::regression::f_p_value;
use glidepolar_inference::relevance::ONE_SIDED;
use glidepolar_inference::score::CLEARLY_WRONG;
use glidepolar_inference::{Outcome, Problem, Wrong, holdout};
use nalgebra::{DMatrix, DVector};

use super::data::Data;
use super::independent_rows::IndependentRows;
use super::problem::TankProblem;

/// Runs on either side of a step: fewer are runs of their own.
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
    let tests = (steps.len() * evidence.quantities.len()) as f64;
    let of = |k: usize| {
        let rows = IndependentRows::new(outcome, problem, &evidence, k);
        let found = Step::clearest(&rows.model, &rows.of_runs(&columns), &rows.residual, rows.stated_share().powi(2))?;
        let p_value = (tests * found.p_value).min(1.0);
        let noise = rows.noise() * found.mean_square.sqrt();
        let limit = problem.relevance(rows.quantity, noise);
        (p_value < CLEARLY_WRONG && found.least_size() * rows.noise() > limit).then(|| Wrong {
            quantity: rows.quantity.name.to_owned(),
            regime: "run order".to_owned(),
            rms: holdout::rms(&outcome.after.residual, rows.quantity.rows.clone()),
            expected_rms: noise,
            size: found.size * rows.noise(),
            relevant_above: limit,
            p_value,
        })
    };
    (0..evidence.quantities.len()).filter_map(of).collect()
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

/// A step beside a model.
struct Step {
    /// Root mean square of what it changes beside the model, and its standard error.
    size: f64,
    se: f64,
    /// Mean square of what it leaves.
    mean_square: f64,
    p_value: f64,
}

impl Step {
    /// The step that explains most of the residuals of a fit; none without rows to spare. Its mean square is no less than the `least`.
    fn clearest(model: &DMatrix<f64>, steps: &DMatrix<f64>, residual: &DVector<f64>, least: f64) -> Option<Step> {
        let basis = orthonormal(model.clone());
        let free = residual.len().checked_sub(basis.ncols() + 1).filter(|free| *free > 0)? as f64;
        let residual = residual - &basis * basis.tr_mul(residual);
        let beside = steps - &basis * basis.tr_mul(steps);
        let squares = residual.norm_squared();
        let explained = |step: nalgebra::DVectorView<'_, f64>| {
            let size = step.norm_squared();
            // A step that the model has as well changes nothing beside it.
            if size > f64::EPSILON * residual.len() as f64 { step.dot(&residual).powi(2) / size } else { 0.0 }
        };
        let most = beside.column_iter().map(explained).fold(0.0, f64::max);
        let mean_square = ((squares - most) / free).max(least);
        let n = residual.len() as f64;
        (most > 0.0).then(|| Step {
            size: ((most - mean_square).max(0.0) / n).sqrt(),
            se: (mean_square / n).sqrt(),
            mean_square,
            p_value: f_p_value(most / mean_square, 1.0, free),
        })
    }

    fn least_size(&self) -> f64 {
        self.size - ONE_SIDED * self.se
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two means against one: Student's t of two samples, by hand. 1, 3 and 7, 9: difference 6, pooled variance 2, t^2 = 36/2 = 18 on 2.
    #[test]
    fn a_step_beside_a_mean_is_the_test_of_two_means() {
        let model = DMatrix::from_element(4, 1, 1.0);
        let steps = DMatrix::from_column_slice(4, 1, &[0.0, 0.0, 1.0, 1.0]);
        let values = DVector::from_column_slice(&[1.0, 3.0, 7.0, 9.0]);
        let found = Step::clearest(&model, &steps, &values, 0.0).expect("rows to spare");
        assert!((found.mean_square - 2.0).abs() < 1e-12);
        // P(|t| > s) on two degrees of freedom is 1 - s / sqrt(2 + s^2).
        let expected = 1.0 - (18.0f64 / 20.0).sqrt();
        assert!((found.p_value - expected).abs() < 1e-9, "{} against {expected}", found.p_value);
        assert!(Step::clearest(&model, &steps, &values, 18.0).expect("rows").p_value > 0.2, "no better than stated");
    }
}
