//! Standard errors that allow for correlated residuals: blocks of rows (dives, runs), not rows, are the independent unit.
//!
//! The water's own motion makes residuals of one dive belong together for tens of minutes. The delete-one-dive
//! jackknife asks how much the estimate moves when a whole dive is left out (one Gauss-Newton step from the full fit,
//! which the dives' own matrices allow without another pass over the samples):
//! ```text
//! delta_k = (H - H_k)^-1 g_k,     V = (K - 1)/K sum_k (delta_k - mean)(delta_k - mean)^T
//! ```
//! `H = J^T J` of all dives, `H_k` and `g_k = J_k^T r_k` of dive `k`. It needs no model of the correlation, is right for
//! any within dives, and with few dives errs on the wide side. Its degrees of freedom are those of the dives, `K - 1`.

use nalgebra::{DMatrix, DVector, Dyn, SymmetricEigen};

use super::gram::Gram;

/// Covariance of the free parameters by the delete-one-dive jackknife; infinite with fewer than two dives.
pub fn jackknife(n: usize, grams: &[Gram]) -> DMatrix<f64> {
    let dives: Vec<&Gram> = grams.iter().filter(|gram| gram.rows > 0).collect();
    let count = dives.len() as f64;
    if dives.len() < 2 {
        return DMatrix::from_element(n, n, f64::INFINITY);
    }
    let whole = Gram::sum(n, dives.iter().copied()).normal_matrix();
    let moves: Vec<DVector<f64>> =
        dives.iter().map(|dive| solve_symmetric(&(&whole - dive.normal_matrix()), &dive.gradient())).collect();
    let mean = moves.iter().fold(DVector::zeros(n), |sum, delta| sum + delta) / count;
    let mut covariance = DMatrix::zeros(n, n);
    for delta in &moves {
        let away = delta - &mean;
        covariance += &away * away.transpose();
    }
    covariance * ((count - 1.0) / count)
}

/// Covariance as if the weighted residuals were independent of unit variance: `H^-1`.
pub fn model_covariance(n: usize, grams: &[Gram]) -> DMatrix<f64> {
    inverse_symmetric(&Gram::sum(n, grams).normal_matrix())
}

/// Correlations of a covariance.
pub fn correlation(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| {
        let scale = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
        if i == j {
            1.0
        } else if scale > 0.0 {
            covariance[(i, j)] / scale
        } else {
            0.0
        }
    })
}

/// Condition number of `J` with its columns scaled to one length: how much a small change of the data can turn into
/// a change of the parameters, whatever their units.
pub fn condition_number(normal: &DMatrix<f64>) -> f64 {
    let eigen = scaled(normal).0.symmetric_eigenvalues();
    let (least, most) = eigen.iter().fold((f64::INFINITY, 0.0f64), |(low, high), &v| (low.min(v), high.max(v)));
    if eigen.is_empty() { 1.0 } else { (most / least.max(most * 1e-16)).sqrt() }
}

/// `A^-1 b` for a symmetric positive matrix of any scaling; directions that it does not see stay where they are.
pub fn solve_symmetric(matrix: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    inverse_symmetric(matrix) * right
}

/// The inverse of a symmetric positive matrix, by eigenvalues of the matrix scaled to a unit diagonal. A direction that
/// it sees less than rounding does is left out.
pub fn inverse_symmetric(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    inverse_symmetric_above(matrix, ROUNDING)
}

/// The same where a direction is left out whose eigenvalue is below this share of the largest.
pub fn inverse_symmetric_above(matrix: &DMatrix<f64>, share: f64) -> DMatrix<f64> {
    let directions = Directions::new(matrix);
    directions.inverse(|value| if value > directions.most * share { value.recip() } else { 0.0 })
}

/// The same with such a direction taken for one that is seen as little as rounding allows: what bounds an error must be large
/// along it.
pub fn inverse_symmetric_at_least(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let directions = Directions::new(matrix);
    directions.inverse(|value| value.max(directions.most * ROUNDING).recip())
}

/// The inverse where the columns are independent: none where one is zero, or an eigenvalue below 1e-10.
pub fn inverse_if_independent(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    if matrix.diagonal().iter().any(|value| !(*value > 0.0 && value.is_finite())) {
        return None;
    }
    let directions = Directions::new(matrix);
    (directions.eigen.eigenvalues.min() >= INDEPENDENT).then(|| directions.inverse(f64::recip))
}

/// Share of the largest eigenvalue that is rounding.
const ROUNDING: f64 = 1e-13;

/// Least eigenvalue of products of columns of one length that are independent.
const INDEPENDENT: f64 = 1e-10;

/// A symmetric matrix scaled to a unit diagonal, by its eigenvectors.
struct Directions {
    eigen: SymmetricEigen<f64, Dyn>,
    scale: Vec<f64>,
    /// The largest eigenvalue.
    most: f64,
}

impl Directions {
    fn new(matrix: &DMatrix<f64>) -> Self {
        let (scaled, scale) = scaled(matrix);
        let eigen = scaled.symmetric_eigen();
        let most = eigen.eigenvalues.iter().fold(0.0f64, |most, &v| most.max(v)).max(f64::MIN_POSITIVE);
        Directions { eigen, scale, most }
    }

    /// The inverse by that of each eigenvalue.
    fn inverse(&self, invert: impl Fn(f64) -> f64) -> DMatrix<f64> {
        let n = self.scale.len();
        let mut inverse = DMatrix::zeros(n, n);
        for (k, &value) in self.eigen.eigenvalues.iter().enumerate() {
            let vector = self.eigen.eigenvectors.column(k);
            inverse += vector * vector.transpose() * invert(value);
        }
        DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (self.scale[i] * self.scale[j]))
    }
}

fn scaled(matrix: &DMatrix<f64>) -> (DMatrix<f64>, Vec<f64>) {
    let n = matrix.nrows();
    let scale: Vec<f64> =
        (0..n).map(|i| matrix[(i, i)].max(0.0).sqrt()).map(|s| if s > 0.0 { s } else { 1.0 }).collect();
    (DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / (scale[i] * scale[j])), scale)
}
