//! What a diagnosis hands on: what it says, and the figures that it rests on. Decides nothing.

use nalgebra::{DMatrix, DVector};

use super::evidence::{Evidence, Point, Quantity};
use super::findings::{Diagnosis, Gain};
use super::holdout;
use crate::estimate::Estimate;

/// A diagnosis with the figures that it rests on, for tables and drawings.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What is said.
    pub diagnosis: Diagnosis,
    /// The baseline alone.
    pub before: Stage,
    /// With what was named.
    pub after: Stage,
    /// The candidates of the fit in the order of the fit.
    pub fitted: Vec<usize>,
    /// The candidates that were named, strongest first, by their place in [`Problem::candidates`](super::evidence::Problem::candidates).
    pub named: Vec<usize>,
    /// For each of them the candidates that these data do not tell from it, each mechanism in its best version.
    pub groups: Vec<Vec<usize>>,
    /// The candidates that were found and refused again, in the order in which they went.
    pub refused: Vec<usize>,
    /// Measured less modelled by a model without it, fitted without the row's block.
    pub without: Vec<DVector<f64>>,
    /// Evidence of each one: fall of the sum of squares, in units of the noise, when it is added last.
    pub gains: Vec<f64>,
}

/// The model at one stage of a diagnosis.
#[derive(Debug, Clone)]
pub struct Stage {
    /// Its parameters.
    pub point: Point,
    /// Measured less modelled, row by row.
    pub residual: DVector<f64>,
    /// The same for a model that was fitted without the row's block.
    pub held_out: DVector<f64>,
    /// Standard deviation of each row's noise.
    pub sd: Vec<f64>,
    /// Covariance of what was fitted: the baseline's parameters, then those of each candidate in [`Outcome::fitted`].
    pub covariance: DMatrix<f64>,
    /// The same by the scatter between clusters of rows that are independent of each other (delete-one-cluster jackknife): right
    /// where the rows of a cluster err together.
    pub covariance_by_clusters: DMatrix<f64>,
    /// The number of these clusters.
    pub clusters: usize,
    /// Standard error of each parameter by the errors that all rows share.
    pub se_by_shared: DVector<f64>,
}

impl Stage {
    /// An estimate of the fitted parameter in a column, whose error by the model of the noise (and what else is known of it)
    /// is given: the error by the scatter between clusters stands in its place where that is larger, and that of what all rows
    /// share comes on top.
    pub fn with_scatter(&self, by_model: &Estimate, column: usize) -> Estimate {
        let by_clusters = self.covariance_by_clusters[(column, column)].max(0.0).sqrt();
        let alone = if by_clusters <= by_model.se {
            by_model.clone()
        } else {
            Estimate::student(by_model.value, by_clusters, self.clusters as f64 - 1.0, &by_model.unit)
        };
        let grown = (1.0 + (self.se_by_shared[column] / alone.se).powi(2)).sqrt();
        if alone.se == 0.0 || !grown.is_finite() {
            return alone;
        }
        Estimate {
            se: alone.se * grown,
            ci95: alone.ci95.map(|end| alone.value + (end - alone.value) * grown),
            ..alone
        }
    }
}

/// The gain from one set of held-out residuals to another, for each quantity, in the readings.
pub fn gains(evidence: &Evidence, before: &DVector<f64>, after: &DVector<f64>) -> Vec<Gain> {
    let (before, after) = (&evidence.column_as_read(before), &evidence.column_as_read(after));
    let of = |quantity: &Quantity| {
        let (b, a) = (holdout::rms(before, quantity.rows.clone()), holdout::rms(after, quantity.rows.clone()));
        Gain {
            quantity: quantity.name.to_owned(),
            holdout_rms_before: b,
            holdout_rms_after: a,
            reduction_percent: holdout::reduction_percent(b, a),
            ci95: holdout::reduction_interval(&evidence.block, quantity.rows.clone(), before, after),
        }
    };
    evidence.quantities.iter().map(of).collect()
}
