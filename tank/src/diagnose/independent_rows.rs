//! The rows of one coefficient beside its model, independent and of the standard deviation of their own noise: what a further effect is
//! tested in by ordinary least squares. Knows rows and a fit; no mechanisms.

use glidepolar_inference::{Evidence, Outcome, Quantity};
use nalgebra::{DMatrix, DVector};

use super::problem::TankProblem;

/// The rows of one coefficient.
pub struct IndependentRows<'a> {
    problem: &'a TankProblem<'a>,
    evidence: &'a Evidence,
    /// The coefficient.
    pub quantity: &'a Quantity,
    sd: DVector<f64>,
    /// What a unit of each parameter changes: the baseline's, then those of what was named.
    pub model: DMatrix<f64>,
    /// What the fit leaves.
    pub residual: DVector<f64>,
}

impl<'a> IndependentRows<'a> {
    /// The rows of the coefficient `k` in what a diagnosis leaves; `evidence` is that at its fit.
    pub fn new(outcome: &Outcome, problem: &'a TankProblem<'a>, evidence: &'a Evidence, k: usize) -> Self {
        let quantity = &evidence.quantities[k];
        let sd = DVector::from_column_slice(&problem.own_sd(&outcome.after.sd)[quantity.rows.clone()]);
        let residual = evidence.residual.rows(quantity.rows.start, sd.len()).component_div(&sd);
        let mut rows = IndependentRows { problem, evidence, quantity, sd, model: DMatrix::zeros(0, 0), residual };
        let named = outcome.fitted.iter().map(|member| &evidence.candidates[*member]);
        let parts: Vec<DMatrix<f64>> =
            std::iter::once(&evidence.baseline).chain(named).map(|columns| rows.scaled(columns)).collect();
        rows.model = DMatrix::from_columns(&parts.iter().flat_map(|part| part.column_iter()).collect::<Vec<_>>());
        rows
    }

    /// What these columns, one row for each run in the order of the problem, change in the rows.
    pub fn of_runs(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(self.evidence.residual.len(), columns.ncols());
        all.rows_mut(self.quantity.rows.start, columns.nrows()).copy_from(columns);
        self.problem.make_independent(&mut all);
        self.scaled(&all)
    }

    /// The standard deviation of the noise of a run, root mean square.
    pub fn noise(&self) -> f64 {
        (self.sd.norm_squared() / self.sd.len() as f64).sqrt()
    }

    /// The same by the runs' own records alone, over it.
    pub fn stated_share(&self) -> f64 {
        let stated = &self.evidence.stated_sd[self.quantity.rows.clone()];
        stated.iter().map(|sd| sd * sd).sum::<f64>().sqrt() / self.sd.norm()
    }

    fn scaled(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let mut rows = columns.rows(self.quantity.rows.start, self.sd.len()).into_owned();
        rows.row_iter_mut().zip(&self.sd).for_each(|(mut row, sd)| row /= *sd);
        rows
    }
}
