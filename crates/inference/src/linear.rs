//! Ordinary linear least squares with a few columns, and two covariances of its result.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector};

/// Columns are dependent where the least eigenvalue of their products, scaled to one length, is smaller than this.
const MIN_EIGENVALUE: f64 = 1e-8;

/// A linear fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Linear {
    /// The coefficients.
    pub values: DVector<f64>,
    /// Measured less fitted.
    pub residual: DVector<f64>,
    design: DMatrix<f64>,
    /// `(X^T X)^-1`.
    inverse: DMatrix<f64>,
}

impl Linear {
    /// Fits the columns of a design to what was measured; none where there are not more rows than columns, or where the
    /// columns depend on each other.
    pub fn fit(design: DMatrix<f64>, measured: &DVector<f64>) -> Option<Self> {
        let (n, k) = design.shape();
        let normal = design.tr_mul(&design);
        // Columns scaled to one length, so that a unit decides nothing.
        let scale = normal.diagonal().map(f64::sqrt);
        if n <= k || scale.iter().any(|s| *s <= 0.0 || !s.is_finite()) {
            return None;
        }
        let scaled = DMatrix::from_fn(k, k, |i, j| normal[(i, j)] / (scale[i] * scale[j]));
        if scaled.symmetric_eigenvalues().min() < MIN_EIGENVALUE {
            return None;
        }
        let inverse = normal.cholesky()?.inverse();
        let values = &inverse * design.tr_mul(measured);
        let residual = measured - &design * &values;
        Some(Linear { values, residual, design, inverse })
    }

    /// Root of the mean square residual.
    pub fn rms(&self) -> f64 {
        (self.residual.norm_squared() / self.residual.len() as f64).sqrt()
    }

    /// Covariance for independent residuals of one variance, which is estimated from them.
    pub fn covariance(&self) -> DMatrix<f64> {
        let (n, k) = self.design.shape();
        &self.inverse * (self.residual.norm_squared() / (n - k) as f64)
    }

    /// Covariance for residuals that belong together within clusters: the sandwich of Liang and Zeger (1986) with the
    /// factor `G / (G - 1) (n - 1) / (n - k)` for few clusters.
    pub fn cluster_covariance(&self, clusters: &[u32]) -> DMatrix<f64> {
        let (n, k) = self.design.shape();
        let names: BTreeSet<u32> = clusters.iter().copied().collect();
        let mut meat = DMatrix::zeros(k, k);
        for name in &names {
            let mut score = DVector::zeros(k);
            for i in (0..n).filter(|i| clusters[*i] == *name) {
                score += self.design.row(i).transpose() * self.residual[i];
            }
            meat += &score * score.transpose();
        }
        let g = names.len() as f64;
        let few = g / (g - 1.0) * (n as f64 - 1.0) / (n - k) as f64;
        &self.inverse * meat * &self.inverse * few
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line through points whose slope, intercept and errors are those of the textbook's closed form.
    #[test]
    fn a_line_has_the_errors_of_the_closed_form() {
        let x = [1.0, 2.0, 3.0, 4.0, 5.0];
        let y = DVector::from_row_slice(&[1.1, 1.9, 3.2, 3.9, 5.1]);
        let fit = Linear::fit(DMatrix::from_fn(5, 2, |i, j| if j == 0 { 1.0 } else { x[i] }), &y).unwrap();
        let (mean_x, mean_y, sxx) = (3.0, y.mean(), 10.0);
        let slope = x.iter().zip(&y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum::<f64>() / sxx;
        let variance = fit.residual.norm_squared() / 3.0;
        assert!((fit.values[1] - slope).abs() < 1e-12 && (fit.values[0] - (mean_y - slope * mean_x)).abs() < 1e-12);
        let covariance = fit.covariance();
        assert!((covariance[(1, 1)] - variance / sxx).abs() < 1e-12);
        assert!((covariance[(0, 0)] - variance * (0.2 + mean_x * mean_x / sxx)).abs() < 1e-12);
        // With every row its own cluster, the sandwich of White with the factor n / (n - k).
        let by_row: f64 = x.iter().zip(&fit.residual).map(|(x, r)| ((x - mean_x) * r).powi(2)).sum();
        let clustered = fit.cluster_covariance(&[0, 1, 2, 3, 4]);
        assert!((clustered[(1, 1)] - 5.0 / 3.0 * by_row / (sxx * sxx)).abs() < 1e-12);
    }

    #[test]
    fn columns_that_depend_on_each_other_have_no_fit() {
        let y = DVector::from_row_slice(&[1.0, 2.0, 3.0]);
        assert!(Linear::fit(DMatrix::from_row_slice(3, 2, &[1.0, 1e6, 2.0, 2e6, 3.0, 3e6]), &y).is_none());
        assert!(Linear::fit(DMatrix::from_row_slice(3, 2, &[0.0, 1.0, 0.0, 2.0, 0.0, 4.0]), &y).is_none());
        assert!(Linear::fit(DMatrix::identity(3, 3), &y).is_none());
    }
}
