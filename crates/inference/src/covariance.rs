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

use nalgebra::{DMatrix, DVector};

use super::gram::Gram;

/// Covariance of the free parameters by the delete-one-dive jackknife; infinite with fewer than two dives.
pub fn jackknife(n: usize, grams: &[Gram]) -> DMatrix<f64> {
    jackknife_beside(&Gram::new(n), grams)
}

/// The same where rows belong to no dive and are never left out: prior knowledge.
pub fn jackknife_beside(prior: &Gram, grams: &[Gram]) -> DMatrix<f64> {
    let n = prior.n;
    let dives: Vec<&Gram> = grams.iter().filter(|gram| gram.rows > 0).collect();
    let count = dives.len() as f64;
    if dives.len() < 2 {
        return DMatrix::from_element(n, n, f64::INFINITY);
    }
    let whole = Gram::sum(n, dives.iter().copied().chain([prior])).normal_matrix();
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
    // Nothing is fitted where all is held.
    if normal.is_empty() {
        return 1.0;
    }
    let eigen = scaled(normal).0.symmetric_eigenvalues();
    let (least, most) = eigen.iter().fold((f64::INFINITY, 0.0f64), |(low, high), &v| (low.min(v), high.max(v)));
    (most / least.max(most * 1e-16)).sqrt()
}

/// `A^-1 b` for a symmetric positive matrix of any scaling; directions that it does not see stay where they are.
pub fn solve_symmetric(matrix: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    inverse_symmetric(matrix) * right
}

/// The first `k` columns, each in units of its length, and the lengths: normal equations are then as well conditioned as
/// units can make them.
pub fn unit_columns(all: &DMatrix<f64>, k: usize) -> (DMatrix<f64>, Vec<f64>) {
    let mut columns = all.columns(0, k).into_owned();
    let lengths: Vec<f64> = columns.column_iter().map(|column| column.norm().max(f64::MIN_POSITIVE)).collect();
    lengths.iter().enumerate().for_each(|(j, length)| columns.column_mut(j).unscale_mut(*length));
    (columns, lengths)
}

/// All of these columns in one matrix of so many rows.
pub(super) fn side_by_side(rows: usize, parts: &[&DMatrix<f64>]) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(rows, parts.iter().map(|part| part.ncols()).sum());
    let mut column = 0;
    for part in parts {
        all.columns_mut(column, part.ncols()).copy_from(part);
        column += part.ncols();
    }
    all
}

/// Inverse of a symmetric matrix; none if its columns, scaled alike, are not independent.
pub fn inverse_if_independent(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let scale = matrix.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { f64::NAN });
    if scale.iter().any(|s| !s.is_finite()) {
        return None;
    }
    let diagonal = DMatrix::from_diagonal(&scale);
    let decomposition = (&diagonal * matrix * &diagonal).symmetric_eigen();
    if decomposition.eigenvalues.min() < 1e-10 {
        return None;
    }
    let inverse = DMatrix::from_diagonal(&decomposition.eigenvalues.map(|e| 1.0 / e));
    let vectors = &decomposition.eigenvectors;
    Some(&diagonal * vectors * inverse * vectors.transpose() * &diagonal)
}

/// The inverse of a symmetric positive matrix, by eigenvalues of the matrix scaled to a unit diagonal. A direction that
/// it sees less than rounding does is left out.
pub fn inverse_symmetric(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    inverse(matrix, |value, least| if value > least { value.recip() } else { 0.0 })
}

/// The same with such a direction taken for one that is seen as little as rounding allows: what bounds an error must be large
/// along it.
pub fn inverse_symmetric_at_least(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    inverse(matrix, |value, least| value.max(least).recip())
}

/// By the inverse of each eigenvalue, given beside the least that is more than rounding.
fn inverse(matrix: &DMatrix<f64>, invert: impl Fn(f64, f64) -> f64) -> DMatrix<f64> {
    let n = matrix.nrows();
    // Nothing is fitted where all is held; an empty matrix has no eigenvalues to ask for.
    if n == 0 {
        return matrix.clone();
    }
    let (scaled, scale) = scaled(matrix);
    let eigen = scaled.symmetric_eigen();
    let most = eigen.eigenvalues.iter().fold(0.0f64, |most, &v| most.max(v)).max(f64::MIN_POSITIVE);
    let mut inverse = DMatrix::zeros(n, n);
    for (k, &value) in eigen.eigenvalues.iter().enumerate() {
        let vector = eigen.eigenvectors.column(k);
        inverse += vector * vector.transpose() * invert(value, most * 1e-13);
    }
    DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (scale[i] * scale[j]))
}

fn scaled(matrix: &DMatrix<f64>) -> (DMatrix<f64>, Vec<f64>) {
    let n = matrix.nrows();
    let scale: Vec<f64> =
        (0..n).map(|i| matrix[(i, i)].max(0.0).sqrt()).map(|s| if s > 0.0 { s } else { 1.0 }).collect();
    (DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / (scale[i] * scale[j])), scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Everything held leaves an empty matrix, which has no eigenvalues to ask for.
    #[test]
    fn nothing_fitted_is_no_error() {
        let nothing = DMatrix::zeros(0, 0);
        assert_eq!((inverse_symmetric(&nothing).nrows(), condition_number(&nothing)), (0, 1.0));
        assert_eq!(jackknife(0, &[Gram::new(0), Gram::new(0)]).nrows(), 0);
    }
}
