//! Rows that err together made independent: errors of zeros, tare and calibration that runs share, and the angle to which a
//! run is set, which moves its lift, drag and moment alike.
//!
//! With the covariance of a run's own errors `D` (a 3 x 3 block each) and one standard error of each shared error in a column
//! of `Z`, the rows' covariance is `D + Z Z'`. Rows are multiplied by the symmetric inverse root of `I + W W'`,
//! `W = D^-1/2 Z`, which is `I - U diag(1 - 1/sqrt(1 + s^2)) U'` for `W = U s V'`. Of all roots the symmetric one leaves
//! every row nearest to what it was (Kessy, Lewin and Strimmer 2018, The American Statistician 72, 309-314), so that a row
//! still is its run's. Shared errors are considered, not estimated: they cost no degrees of freedom. Knows rows; no physics.

use nalgebra::{DMatrix, Matrix3, Vector3};

/// What takes the rows' correlation away.
#[derive(Debug, Clone)]
pub struct Decorrelation {
    /// For each run the symmetric inverse root of its rows' correlation.
    blocks: Vec<Matrix3<f64>>,
    /// Orthonormal directions of the shared errors, rows by directions.
    directions: DMatrix<f64>,
    /// Share of a row's part along each direction that goes.
    shrinkage: Vec<f64>,
    /// Standard deviation of each row: quantity after quantity, each with all runs.
    sd: Vec<f64>,
}

/// What errs in one run.
#[derive(Debug, Clone)]
pub struct RunErrors {
    /// Standard deviations of CL, CD, CM from within the run.
    pub own_sd: [f64; 3],
    /// Effect of one standard error of its setting.
    pub setting: Vector3<f64>,
    /// Effect of one standard error of each shared error, the same errors in every run: CL, CD, CM by errors.
    pub shared: DMatrix<f64>,
}

/// Directions in which shared errors are smaller than this beside the rows' own make no difference.
const SMALL: f64 = 1e-4;

impl Decorrelation {
    /// For runs in the order of their rows.
    pub fn new(runs: &[RunErrors]) -> Decorrelation {
        let n = runs.len();
        let sd: Vec<Vector3<f64>> =
            runs.iter().map(|run| Vector3::from_fn(|k, _| run.own_sd[k].hypot(run.setting[k]))).collect();
        let blocks: Vec<Matrix3<f64>> = runs
            .iter()
            .zip(&sd)
            .map(|(run, sd)| {
                let correlation =
                    Matrix3::from_fn(
                        |i, j| {
                            if i == j { 1.0 } else { run.setting[i] * run.setting[j] / (sd[i] * sd[j]) }
                        },
                    );
                let eigen = correlation.symmetric_eigen();
                let roots = Matrix3::from_diagonal(&eigen.eigenvalues.map(|value| 1.0 / value.max(1e-6).sqrt()));
                eigen.eigenvectors * roots * eigen.eigenvectors.transpose()
            })
            .collect();
        let errors = runs.first().map_or(0, |run| run.shared.ncols());
        let mut scaled = DMatrix::zeros(3 * n, errors);
        for (i, run) in runs.iter().enumerate() {
            for j in 0..errors {
                let effect = Vector3::from_fn(|k, _| run.shared[(k, j)] / sd[i][k]);
                let effect = blocks[i] * effect;
                (0..3).for_each(|k| scaled[(k * n + i, j)] = effect[k]);
            }
        }
        let sd_of_rows = (0..3).flat_map(|k| sd.iter().map(move |sd| sd[k])).collect();
        if errors == 0 {
            return Decorrelation { blocks, directions: scaled, shrinkage: Vec::new(), sd: sd_of_rows };
        }
        let eigen = (scaled.transpose() * &scaled).symmetric_eigen();
        let kept: Vec<usize> = (0..errors).filter(|j| eigen.eigenvalues[*j] > SMALL * SMALL).collect();
        let mut directions = scaled * eigen.eigenvectors.select_columns(&kept);
        for (mut column, j) in directions.column_iter_mut().zip(&kept) {
            column.unscale_mut(eigen.eigenvalues[*j].sqrt());
        }
        let shrinkage = kept.iter().map(|j| 1.0 - 1.0 / (1.0 + eigen.eigenvalues[*j]).sqrt()).collect();
        Decorrelation { blocks, directions, shrinkage, sd: sd_of_rows }
    }

    /// Standard deviation of each row once it is independent: that of its run's own errors.
    pub fn sd(&self) -> &[f64] {
        &self.sd
    }

    /// Makes the rows of these columns independent, each in its own unit still.
    pub fn apply(&self, columns: &mut DMatrix<f64>) {
        let n = self.blocks.len();
        for mut column in columns.column_iter_mut() {
            for (i, block) in self.blocks.iter().enumerate() {
                let own = block * Vector3::from_fn(|k, _| column[k * n + i] / self.sd[k * n + i]);
                (0..3).for_each(|k| column[k * n + i] = own[k]);
            }
        }
        let mut along = self.directions.tr_mul(columns);
        for (mut row, shrinkage) in along.row_iter_mut().zip(&self.shrinkage) {
            row *= *shrinkage;
        }
        *columns -= &self.directions * along;
        for mut column in columns.column_iter_mut() {
            for (value, sd) in column.iter_mut().zip(&self.sd) {
                *value *= sd;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The covariance written out, taken from both sides, leaves the rows' own variances and nothing between rows.
    #[test]
    fn the_covariance_of_the_rows_becomes_diagonal() {
        let n = 5;
        let runs: Vec<RunErrors> = (0..n)
            .map(|i| RunErrors {
                own_sd: [1.0, 0.5, 2.0 + i as f64],
                setting: Vector3::new(0.8, -0.1 * i as f64, 1.5),
                shared: DMatrix::from_fn(3, 4, |k, j| ((3 * i + k) as f64 * 0.7 + j as f64 * 1.3).sin() * 3.0),
            })
            .collect();
        let mut covariance = DMatrix::zeros(3 * n, 3 * n);
        for (i, one) in runs.iter().enumerate() {
            for (j, other) in runs.iter().enumerate() {
                for k in 0..3 {
                    for l in 0..3 {
                        let shared = (one.shared.row(k) * other.shared.row(l).transpose())[(0, 0)];
                        let own = if i == j { one.setting[k] * one.setting[l] } else { 0.0 };
                        let within = if i == j && k == l { one.own_sd[k].powi(2) } else { 0.0 };
                        covariance[(k * n + i, l * n + j)] = shared + own + within;
                    }
                }
            }
        }
        let decorrelation = Decorrelation::new(&runs);
        decorrelation.apply(&mut covariance);
        let mut covariance = covariance.transpose();
        decorrelation.apply(&mut covariance);
        for i in 0..3 * n {
            for j in 0..3 * n {
                let expected = if i == j { decorrelation.sd()[i].powi(2) } else { 0.0 };
                assert!((covariance[(i, j)] - expected).abs() < 1e-9, "{i} {j}: {}", covariance[(i, j)]);
            }
        }
    }
}
