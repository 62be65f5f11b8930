//! Runs at one setting against the model: where their means miss it by more than they scatter about each other.
//!
//! The engine estimates the noise from what no curve explains. Where runs are few a misfit of no simple shape is taken for noise.
//! Repeats know better: they scatter by the noise alone (Draper and Smith, Applied Regression Analysis, 2.1). Rows are made
//! independent first, since the runs of one zero err together; the test is then that of ordinary least squares, of the model against one
//! mean for each setting. Of the misfit's size the least that 95 % allow must be relevant.
//!
//! Knows rows and their settings; no mechanisms.

use glidepolar_inference::noise::orthonormal;
use glidepolar_inference::regression::f_p_value;
use glidepolar_inference::relevance::ONE_SIDED;
use glidepolar_inference::score::CLEARLY_WRONG;
use glidepolar_inference::{Outcome, Problem, Wrong, holdout};
use nalgebra::{DMatrix, DVector};

use super::data::Data;
use super::independent_rows::IndependentRows;
use super::problem::TankProblem;
use crate::sweep::NAMES;

/// The quantities whose means miss the model with what was named, by a relevant size.
pub fn misfits(outcome: &Outcome, data: &Data, problem: &TankProblem<'_>) -> Vec<Wrong> {
    let evidence = problem.evidence(&outcome.after.point);
    let settings = settings(data, problem.order());
    let of = |k: usize| misfit(outcome, &IndependentRows::new(outcome, problem, &evidence, k), &settings, problem);
    (0..evidence.quantities.len()).filter_map(of).collect()
}

fn misfit(
    outcome: &Outcome,
    rows: &IndependentRows<'_>,
    settings: &[usize],
    problem: &TankProblem<'_>,
) -> Option<Wrong> {
    let mut means = DMatrix::zeros(settings.len(), settings.iter().max()? + 1);
    settings.iter().enumerate().for_each(|(i, setting)| means[(i, *setting)] = 1.0);

    let test = LackOfFit::new(&rows.model, &rows.of_runs(&means), &rows.residual)?;
    let p_value = (NAMES.len() as f64 * test.p_value).min(1.0);
    // In units of the noise of a run; of the coefficient by the noise of the readings.
    let noise = rows.noise() * test.repeat_square.sqrt();
    let limit = problem.relevance(rows.quantity, noise);
    (p_value < CLEARLY_WRONG && test.least_size() * noise > limit).then(|| Wrong {
        quantity: rows.quantity.name.to_owned(),
        regime: "settings, by their repeats".to_owned(),
        rms: holdout::rms(&outcome.after.residual, rows.quantity.rows.clone()),
        expected_rms: noise,
        size: test.size() * noise,
        relevant_above: limit,
        p_value,
    })
}

/// Whether any setting was towed more than once.
pub fn are_made(data: &Data, order: &[usize]) -> bool {
    settings(data, order).iter().max().is_some_and(|last| last + 1 < order.len())
}

/// For each run in this order the number of its setting: hull, angle and speed that were asked for.
fn settings(data: &Data, order: &[usize]) -> Vec<usize> {
    let key = |run: usize| {
        let run = &data.runs[run];
        let speed = run.point.nominal_speed_m_s.map(f64::to_bits);
        (run.hull, run.point.nominal_yaw_deg.to_bits(), speed)
    };
    let mut known = std::collections::BTreeMap::new();
    order
        .iter()
        .map(|run| {
            let next = known.len();
            *known.entry(key(*run)).or_insert(next)
        })
        .collect()
}

/// A model against one mean for each setting.
struct LackOfFit {
    rows: usize,
    misfit_dof: f64,
    /// Ratio of the mean squares.
    ratio: f64,
    /// Mean square of the repeats about their means.
    repeat_square: f64,
    p_value: f64,
}

impl LackOfFit {
    /// Of independent rows of one variance and the residuals of their fit; none without repeats, or where the model has a mean for
    /// each setting.
    ///
    /// Angles and speeds differ a little between repeats. What the model makes of that is in the residuals already, so the scatter of
    /// repeats is that of their residuals about the mean of their setting, and costs the repeats no degree of freedom.
    fn new(model: &DMatrix<f64>, means: &DMatrix<f64>, residual: &DVector<f64>) -> Option<LackOfFit> {
        let rows = residual.len();
        let beside = |columns: &DMatrix<f64>| -> (DVector<f64>, usize) {
            let basis = orthonormal(columns.clone());
            (residual - &basis * basis.tr_mul(residual), basis.ncols())
        };
        let (beside_model, of_model) = beside(model);
        let (beside_means, of_means) = beside(means);
        let repeat_dof = rows - of_means;
        let misfit_dof = of_means.saturating_sub(of_model);
        if misfit_dof == 0 || repeat_dof == 0 {
            return None;
        }
        let [misfit_dof, repeat_dof] = [misfit_dof, repeat_dof].map(|dof| dof as f64);
        let repeat_square = beside_means.norm_squared() / repeat_dof;
        let misfit = (beside_model.norm_squared() - beside_means.norm_squared()).max(0.0);
        let ratio = misfit / misfit_dof / repeat_square;
        let p_value = f_p_value(ratio, misfit_dof, repeat_dof);
        Some(LackOfFit { rows, misfit_dof, ratio, repeat_square, p_value })
    }

    /// Rms of the misfit over the rows in units of the repeats' scatter, the share of the noise removed.
    fn size(&self) -> f64 {
        (self.excess().max(0.0) / self.rows as f64).sqrt()
    }

    /// The same less what chance may have added: the excess has about the variance of a noncentral chi-square, `2 (dof + 2 excess)`.
    fn least_size(&self) -> f64 {
        let excess = self.excess().max(0.0);
        let least = excess - ONE_SIDED * (2.0 * (self.misfit_dof + 2.0 * excess)).sqrt();
        (least.max(0.0) / self.rows as f64).sqrt()
    }

    fn excess(&self) -> f64 {
        (self.ratio - 1.0) * self.misfit_dof
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A textbook's figures: Draper and Smith's steps by hand. Straight line through (1; 1, 3), (2; 2, 4), (3; 8, 10).
    #[test]
    fn a_straight_line_against_the_means_of_its_repeats() {
        let x = [1.0, 1.0, 2.0, 2.0, 3.0, 3.0];
        let y = DVector::from_row_slice(&[1.0, 3.0, 2.0, 4.0, 8.0, 10.0]);
        let model = DMatrix::from_fn(6, 2, |i, j| if j == 0 { 1.0 } else { x[i] });
        let means = DMatrix::from_fn(6, 3, |i, j| f64::from(u8::from(i / 2 == j)));
        let test = LackOfFit::new(&model, &means, &y).expect("repeats");
        // Means 2, 3, 9; line -7/3 + 3.5 x has 7/6, 14/3, 49/6: misfit 2 (25/36 + 100/36 + 25/36) = 25/3; pure error 6 on 3.
        assert!((test.repeat_square - 2.0).abs() < 1e-12);
        assert!((test.ratio - 25.0 / 6.0).abs() < 1e-12, "{}", test.ratio);
        // F on 1 and 3: t on 3 squared, P(|t| > s) = 1 - 2/pi (atan(u) + u/(1 + u^2)), u = s/sqrt 3.
        let u = (test.ratio / 3.0).sqrt();
        let expected = 1.0 - 2.0 / std::f64::consts::PI * (u.atan() + u / (1.0 + u * u));
        assert!((test.p_value - expected).abs() < 1e-9, "{} against {expected}", test.p_value);
        assert!(LackOfFit::new(&means, &means, &y).is_none());
    }
    /// Angles differ a little from repeat to repeat. They take up no degree of freedom of the repeats, and a law with more terms none
    /// either.
    #[test]
    fn repeats_at_nearly_one_angle_keep_their_degrees_of_freedom() {
        let angle = |i: usize| (i / 2) as f64 + 1e-3 * (i % 2) as f64;
        let model = DMatrix::from_fn(10, 4, |i, j| angle(i).powi(j as i32 + 1));
        let means = DMatrix::from_fn(10, 5, |i, j| f64::from(u8::from(i / 2 == j)));
        // Repeats are 2e-3 apart; one setting is off by 1.
        let y = DVector::from_fn(10, |i, _| f64::from(u8::from(i / 2 == 0)) + 1e-3 * (1.0 - 2.0 * (i % 2) as f64));
        let test = LackOfFit::new(&model, &means, &y).expect("repeats");
        assert!((test.repeat_square - 10.0 * 1e-6 / 5.0).abs() < 1e-12 && test.misfit_dof == 1.0);
        assert!(test.p_value < 1e-6, "{}", test.p_value);
    }
}
