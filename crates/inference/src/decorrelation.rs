//! Rows that err together made independent: errors that runs share, and what moves the three quantities of a run together, as
//! the angle to which it is set does lift, drag and moment.
//!
//! With the covariance of a run's own errors `D` (a 3 x 3 block each) and one standard error of each shared error in a column
//! of `Z`, the rows' covariance is `D + Z Z'`. Rows are multiplied by the symmetric inverse root of `I + W W'`,
//! `W = D^-1/2 Z`, which is `I - U diag(1 - 1/sqrt(1 + s^2)) U'` for `W = U s V'`. Of all roots the symmetric one leaves
//! every row nearest to what it was (Kessy, Lewin and Strimmer 2018, The American Statistician 72, 309-314), so that a row
//! still is its run's. A change that is alike in all runs becomes small, as what a shared error may be: how large it is in the readings is asked
//! of the rows with their correlation back. Shared errors are considered, not estimated: they cost no degrees of freedom. Knows
//! rows; no physics.

use nalgebra::{DMatrix, Matrix3, Vector3};

/// What takes the rows' correlation away.
#[derive(Debug, Clone)]
pub struct Decorrelation {
    /// For each run the symmetric inverse root of its rows' correlation, and the root.
    blocks: Vec<[Matrix3<f64>; 2]>,
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
    /// Standard deviations of its three quantities from within the run.
    pub own_sd: [f64; 3],
    /// Effect of one standard error of its setting.
    pub setting: Vector3<f64>,
    /// Effect of one standard error of each shared error, the same errors in every run: quantities by errors.
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
        let blocks: Vec<[Matrix3<f64>; 2]> = runs
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
                let roots = eigen.eigenvalues.map(|value| value.max(1e-6).sqrt());
                [roots.map(f64::recip), roots]
                    .map(|roots| eigen.eigenvectors * Matrix3::from_diagonal(&roots) * eigen.eigenvectors.transpose())
            })
            .collect();
        let errors = runs.first().map_or(0, |run| run.shared.ncols());
        let mut scaled = DMatrix::zeros(3 * n, errors);
        for (i, run) in runs.iter().enumerate() {
            for j in 0..errors {
                let effect = Vector3::from_fn(|k, _| run.shared[(k, j)] / sd[i][k]);
                let effect = blocks[i][0] * effect;
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

    /// Standard deviation of what each row shares with other runs; with [`Decorrelation::sd`], in quadrature, it is that of the reading.
    pub fn shared_sd(&self) -> Vec<f64> {
        let n = self.blocks.len();
        // In units of noise `W = U s V'`, and 1 - shrinkage = 1/sqrt(1 + s^2).
        let sizes = self.shrinkage.iter().map(|shrinkage| (1.0 - shrinkage).powi(-2) - 1.0);
        let mut shared = self.directions.columns(0, self.shrinkage.len()).into_owned();
        self.by_runs(&mut shared, 1);
        for (mut column, size) in shared.column_iter_mut().zip(sizes) {
            column *= size.sqrt();
        }
        (0..3 * n).map(|row| self.sd[row] * shared.row(row).norm()).collect()
    }

    /// Makes the rows of these columns independent, each in its own unit still.
    pub fn apply(&self, columns: &mut DMatrix<f64>) {
        self.in_units_of_noise(columns, |columns| {
            self.by_runs(columns, 0);
            self.along_directions(columns, |shrinkage| -shrinkage);
        });
    }

    /// Gives independent rows their correlation back: the inverse of [`Decorrelation::apply`].
    pub fn undo(&self, columns: &mut DMatrix<f64>) {
        self.in_units_of_noise(columns, |columns| {
            self.along_directions(columns, |shrinkage| shrinkage / (1.0 - shrinkage));
            self.by_runs(columns, 1);
        });
    }

    fn in_units_of_noise(&self, columns: &mut DMatrix<f64>, change: impl Fn(&mut DMatrix<f64>)) {
        let scale = |columns: &mut DMatrix<f64>, by: fn(f64, f64) -> f64| {
            for mut column in columns.column_iter_mut() {
                column.iter_mut().zip(&self.sd).for_each(|(value, sd)| *value = by(*value, *sd));
            }
        };
        scale(columns, |value, sd| value / sd);
        change(columns);
        scale(columns, |value, sd| value * sd);
    }

    fn by_runs(&self, columns: &mut DMatrix<f64>, root: usize) {
        let n = self.blocks.len();
        for mut column in columns.column_iter_mut() {
            for (i, block) in self.blocks.iter().enumerate() {
                let own = block[root] * Vector3::from_fn(|k, _| column[k * n + i]);
                (0..3).for_each(|k| column[k * n + i] = own[k]);
            }
        }
    }

    /// Adds this share of each direction's part.
    fn along_directions(&self, columns: &mut DMatrix<f64>, share: fn(f64) -> f64) {
        let mut along = self.directions.tr_mul(columns);
        for (mut row, shrinkage) in along.row_iter_mut().zip(&self.shrinkage) {
            row *= share(*shrinkage);
        }
        *columns += &self.directions * along;
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
        let before = covariance.clone();
        decorrelation.apply(&mut covariance);
        let mut back = covariance.clone();
        decorrelation.undo(&mut back);
        assert!((back - &before).amax() < 1e-9 * before.amax());
        for (row, shared_sd) in decorrelation.shared_sd().into_iter().enumerate() {
            assert!((shared_sd.hypot(decorrelation.sd()[row]) - before[(row, row)].sqrt()).abs() < 1e-9);
        }
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
