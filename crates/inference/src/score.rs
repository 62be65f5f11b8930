//! How much each set of candidates explains beyond the baseline, by generalised least squares.
//!
//! With rows whitened and the baseline projected out, all that any set's fit needs is the small matrix of products of
//! the candidates' columns with each other and with the residuals. So every set of candidates can be tried.

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::clusters::{chance_by_clusters, clusters_of};
use super::covariance::unit_columns;
use super::evidence::Evidence;
use crate::noise::{self, Noise, orthonormal};
use crate::regression::f_p_value;

/// A column whose part outside the baseline is smaller than this, relative to the whole, is seen as baseline alone.
const UNIDENTIFIABLE: f64 = 1e-4;

/// Products of whitened columns outside the baseline.
#[derive(Debug, Clone)]
pub struct Score {
    gram: DMatrix<f64>,
    moments: DVector<f64>,
    /// Size of each column before projection, by which it was divided.
    sizes: Vec<f64>,
    /// Share of each column that the baseline cannot imitate.
    remaining: Vec<f64>,
    /// Whitened columns: baseline, candidates, residual, with the rows of the prior below.
    whitened: DMatrix<f64>,
    n_baseline: usize,
    /// Steps of the baseline's parameters that imitate a unit of each column best, and those that fit the residual best.
    absorbed: DMatrix<f64>,
    /// The cluster of each row.
    clusters: Vec<usize>,
    /// Independent numbers to which the rows amount.
    pub effective_rows: f64,
}

/// A set's fit: how much it explains, its values and their covariance.
#[derive(Debug, Clone)]
pub struct ScoreFit {
    /// Fall of the sum of squares, in units of the noise.
    pub gain: f64,
    /// Step of each parameter from the point of linearisation.
    pub step: DVector<f64>,
    /// Covariance of the steps, the baseline's uncertainty in it.
    pub covariance: DMatrix<f64>,
}

/// Columns whitened, with a row for each belief about the baseline below them. The first columns must be those of the
/// baseline parameters; `target` is the column that they are fitted to.
pub fn whiten_with_prior(evidence: &Evidence, noises: &[Noise], columns: &DMatrix<f64>, target: usize) -> DMatrix<f64> {
    let n = columns.nrows();
    let mut whitened = columns.clone();
    whiten(evidence, noises, &mut whitened);
    let mut all = whitened.resize_vertically(n + evidence.prior.len(), 0.0);
    for (j, (belief, sd)) in evidence.prior.iter().enumerate() {
        all[(n + j, j)] = sd.recip();
        all[(n + j, target)] = belief / sd;
    }
    all
}

/// Whitens every column of each quantity by its noise; returns the logarithm of the determinant of the covariance.
pub fn whiten(evidence: &Evidence, noises: &[Noise], columns: &mut DMatrix<f64>) -> f64 {
    let mut log_determinant = 0.0;
    for (quantity, noise) in evidence.quantities.iter().zip(noises) {
        let rows = quantity.rows.clone();
        let mut part = columns.rows(rows.start, rows.len()).into_owned();
        log_determinant += noise::whiten(evidence.series(quantity), noise, &mut part);
        columns.rows_mut(rows.start, rows.len()).copy_from(&part);
    }
    log_determinant
}

impl ScoreFit {
    /// Standard error of a step.
    pub fn se(&self, i: usize) -> f64 {
        self.covariance[(i, i)].max(0.0).sqrt()
    }
}

impl Score {
    /// The products for these columns, side by side in the order in which sets will name them; `prior` is what is believed of
    /// the step of each beforehand with its standard deviation, infinite where nothing is.
    pub fn new(
        evidence: &Evidence,
        noises: &[Noise],
        baseline: &DMatrix<f64>,
        columns: &DMatrix<f64>,
        prior: &[(f64, f64)],
    ) -> Score {
        let n = evidence.residual.len();
        let (nb, nc) = (baseline.ncols(), columns.ncols());
        let mut all = DMatrix::zeros(n, nb + nc + 1);
        all.columns_mut(0, nb).copy_from(baseline);
        all.columns_mut(nb, nc).copy_from(columns);
        all.column_mut(nb + nc).copy_from(&evidence.residual);
        let all = whiten_with_prior(evidence, noises, &all, nb + nc);

        let absorbed = absorbed(&all, nb, nc + 1);
        let q = orthonormal(all.columns(0, nb).into_owned());
        let mut rest = all.columns(nb, nc + 1).into_owned();
        let sizes: Vec<f64> = (0..nc).map(|j| rest.column(j).norm().max(f64::MIN_POSITIVE)).collect();
        for (j, size) in sizes.iter().enumerate() {
            rest.column_mut(j).scale_mut(size.recip());
        }
        // Twice is enough to lose what rounding leaves of the baseline.
        for _ in 0..2 {
            let inside = q.transpose() * &rest;
            rest -= &q * inside;
        }
        let remaining = (0..nc).map(|j| rest.column(j).norm()).collect();
        let candidates = rest.columns(0, nc);
        let mut gram = candidates.transpose() * candidates;
        let mut moments = candidates.transpose() * rest.column(nc);
        for (j, (believed, sd)) in prior.iter().enumerate() {
            // What no row feels at this point stays where it is.
            if sizes[j] > f64::MIN_POSITIVE {
                let weight = (sizes[j] * sd).powi(-2);
                gram[(j, j)] += weight;
                moments[j] += weight * sizes[j] * believed;
            } else {
                gram[(j, j)] = 1.0;
            }
        }
        Score {
            gram,
            moments,
            sizes,
            remaining,
            whitened: all,
            n_baseline: nb,
            absorbed,
            clusters: clusters_of(evidence, noises),
            effective_rows: effective_rows(evidence, noises),
        }
    }

    /// Probability that chance alone brings an effect of the `tested` columns beside those of the `others`, by the scatter
    /// between clusters. The effect is `magnified` where the likelihood says that it explains more than these columns show.
    pub fn chance_by_clusters(&self, others: &[usize], tested: &[usize], magnified: f64) -> f64 {
        let target = self.whitened.ncols() - 1;
        let columns = (0..self.n_baseline)
            .chain(others.iter().chain(tested).map(|column| self.n_baseline + column))
            .chain([target]);
        let columns = self.whitened.select_columns(&columns.collect::<Vec<_>>());
        chance_by_clusters(&columns, &self.clusters, tested.len(), magnified)
    }

    /// The sum of squares that a fit of these columns leaves in each cluster.
    pub fn squares_by_cluster(&self, set: &[usize]) -> Vec<f64> {
        let (_, left) = self.fitted_to(set);
        let mut squares = BTreeMap::new();
        for (cluster, value) in self.clusters.iter().zip(left.iter()) {
            *squares.entry(*cluster).or_insert(0.0) += value * value;
        }
        squares.into_values().collect()
    }

    /// Probability that chance alone brings an effect of the `tested` columns beside those of the `others`, by what these rows scatter
    /// by beside both: the F test of one mean square against the other. A noise that was estimated without the tested columns holds
    /// what they explain, and of few rows no effect is then improbable, however large. No mean square is smaller than the `least`.
    pub fn chance_by_rows(&self, others: &[usize], tested: &[usize], rows: Range<usize>, least: f64) -> f64 {
        // What a set leaves of the rows, and how many of their degrees of freedom it takes.
        let left_beside = |set: &[usize]| {
            let (basis, left) = self.fitted_to(set);
            let taken = basis.rows(rows.start, rows.len()).norm_squared();
            (left.rows(rows.start, rows.len()).norm_squared(), taken)
        };
        let (before, taken_before) = left_beside(others);
        let (after, taken) = left_beside(&others.iter().chain(tested).copied().collect::<Vec<_>>());
        let (df, free) = (taken - taken_before, rows.len() as f64 - taken);
        if df <= 0.0 || free < 1.0 {
            return 1.0;
        }
        f_p_value((before - after) / df / (after / free).max(least), df, free)
    }

    /// An orthonormal basis of these columns and the baseline's, and what their fit leaves of the residual.
    fn fitted_to(&self, set: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
        let columns = (0..self.n_baseline).chain(set.iter().map(|column| self.n_baseline + column));
        let basis = orthonormal(self.whitened.select_columns(&columns.collect::<Vec<_>>()));
        let residual = self.whitened.column(self.whitened.ncols() - 1);
        let left = residual - &basis * basis.tr_mul(&residual);
        (basis, left)
    }

    /// Steps of the baseline's parameters that imitate a unit of this column best.
    pub fn absorbed(&self, column: usize) -> DVector<f64> {
        self.absorbed.column(column).into_owned()
    }

    /// Steps of the baseline's parameters that fit the residual best.
    pub fn baseline_step(&self) -> DVector<f64> {
        self.absorbed.column(self.absorbed.ncols() - 1).into_owned()
    }

    /// Whether a column shows at all beside the baseline.
    pub fn is_identifiable(&self, column: usize) -> bool {
        self.remaining[column] > UNIDENTIFIABLE
    }

    /// Share of a column that the baseline cannot imitate.
    pub fn remaining(&self, column: usize) -> f64 {
        self.remaining[column]
    }

    /// The fit of these columns together; directions that the data do not see take no part.
    pub fn fit(&self, set: &[usize]) -> ScoreFit {
        let Solved { inverse, step, gain, .. } = self.solve(set);
        let k = set.len();
        let scale = |i: usize| self.sizes[set[i]].recip();
        ScoreFit {
            gain,
            step: DVector::from_fn(k, |i, _| step[i] * scale(i)),
            covariance: DMatrix::from_fn(k, k, |i, j| inverse[(i, j)] * scale(i) * scale(j)),
        }
    }

    /// The fit of these columns in units of their own sizes.
    pub fn solve(&self, set: &[usize]) -> Solved {
        let k = set.len();
        let gram = DMatrix::from_fn(k, k, |i, j| self.gram[(set[i], set[j])]);
        let moments = DVector::from_fn(k, |i, _| self.moments[set[i]]);
        let inverse = inverse_where_identifiable(gram);
        let step = &inverse * &moments;
        Solved { gain: step.dot(&moments), set: set.to_vec(), inverse, step }
    }

    /// Returns the gain with one more column, from the fit of the others: that of [`Score::fit`] without factorising anew. Writes
    /// the steps from the point of linearisation to `steps`, the new column's last. None where a direction is not identifiable:
    /// then only the whole fit will do.
    pub fn gain_with(&self, others: &Solved, column: usize, steps: &mut Vec<f64>) -> Option<f64> {
        let set = &others.set;
        let product = |i: usize| self.gram[(set[i], column)];
        let k = set.len();
        steps.clear();
        steps.extend((0..k).map(|i| (0..k).map(|j| others.inverse[(i, j)] * product(j)).sum::<f64>()));
        let inside: f64 = steps.iter().enumerate().map(|(i, step)| step * product(i)).sum();
        let outside = self.gram[(column, column)] - inside;
        // The trace of the inverse of all together, by blocks.
        let trace = others.inverse.trace() + (1.0 + steps.iter().map(|step| step * step).sum::<f64>()) / outside;
        if !(outside > 0.0 && trace * UNIDENTIFIABLE * UNIDENTIFIABLE < 1.0) {
            return None;
        }
        let moment = self.moments[column] - (0..k).map(|i| product(i) * others.step[i]).sum::<f64>();
        let step = moment / outside;
        for (i, absorbed) in steps.iter_mut().enumerate() {
            *absorbed = (others.step[i] - *absorbed * step) / self.sizes[set[i]];
        }
        steps.push(step / self.sizes[column]);
        Some(others.gain + moment * step)
    }
}

/// A fit of some columns in units of their own sizes.
#[derive(Debug, Clone)]
pub struct Solved {
    set: Vec<usize>,
    inverse: DMatrix<f64>,
    step: DVector<f64>,
    gain: f64,
}

/// Inverse of the Gram matrix of unit columns in the directions that the data see; zero in the others.
fn inverse_where_identifiable(gram: DMatrix<f64>) -> DMatrix<f64> {
    let least = UNIDENTIFIABLE * UNIDENTIFIABLE;
    // The smallest eigenvalue is no less than one over the trace of the inverse: most sets need no eigenvectors, which take
    // longer.
    let inverse = gram.clone().cholesky().map(|cholesky| cholesky.inverse());
    if let Some(inverse) = inverse.filter(|inverse| inverse.trace() * least < 1.0) {
        return inverse;
    }
    let eigen = gram.symmetric_eigen();
    let mut inverse = DMatrix::zeros(eigen.eigenvalues.len(), eigen.eigenvalues.len());
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > least {
            inverse += vector * vector.transpose() / *value;
        }
    }
    inverse
}

/// Steps of the first `nb` columns by which they imitate each of the next `nc` best, by least squares.
fn absorbed(all: &DMatrix<f64>, nb: usize, nc: usize) -> DMatrix<f64> {
    let (design, sizes) = unit_columns(all, nb);
    let inverse = design.tr_mul(&design).pseudo_inverse(1e-10).unwrap_or_else(|_| DMatrix::zeros(nb, nb));
    let mut steps = inverse * design.tr_mul(&all.columns(nb, nc));
    sizes.iter().enumerate().for_each(|(j, size)| steps.row_mut(j).unscale_mut(*size));
    steps
}

/// To how many independent rows these rows amount: what the mean of them all is worth.
fn effective_rows(evidence: &Evidence, noises: &[Noise]) -> f64 {
    let n = evidence.residual.len();
    let mut ones = DMatrix::from_element(n, 1, 1.0);
    whiten(evidence, noises, &mut ones);
    let mut effective = 0.0;
    for (quantity, noise) in evidence.quantities.iter().zip(noises) {
        let rows = quantity.rows.clone();
        let information: f64 = rows.clone().map(|row| ones[row] * ones[row]).sum();
        let variance: f64 = rows.clone().map(|row| noise.sd(evidence.stated_sd[row]).powi(2)).sum::<f64>();
        effective += information * variance / rows.len().max(1) as f64;
    }
    effective.clamp(2.0, n as f64)
}

/// Probability below which an unnamed curve refutes a mechanism.
pub(crate) const SIGNIFICANT: f64 = 0.01;

/// Probability below which a misfit is called one where nothing explains it. Of 299 worlds with nothing hidden (virtual-sea, seeds
/// 61800 to 62099) 3 have a probability below 0.01, 1 below 0.001 and none below 1e-4. Worlds of other generators have more: no
/// model of the noise holds further out.
pub const CLEARLY_WRONG: f64 = 1e-4;

/// Probability that chance alone explains this much.
pub fn chance(gain: f64, df: usize) -> f64 {
    ChiSquared::new(df as f64).map_or(1.0, |distribution| distribution.sf(gain.max(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    /// Six columns of which the last is the first but for 1e-6 of itself, and what they are fitted to.
    fn example() -> (DMatrix<f64>, DVector<f64>) {
        let mut rng = StdRng::seed_from_u64(3);
        let mut columns = DMatrix::from_fn(50, 6, |_, j| (j + 1) as f64 * rng.random_range(-1.0..1.0));
        let nearly = columns.column(0) + 1e-6 * columns.column(5);
        columns.set_column(5, &nearly);
        let target = DVector::from_fn(50, |i, _| columns[(i, 1)] - columns[(i, 3)] + rng.random_range(-1.0..1.0));
        (columns, target)
    }

    fn score_of(columns: &DMatrix<f64>, target: &DVector<f64>) -> Score {
        let (unit, sizes) = unit_columns(columns, columns.ncols());
        Score {
            gram: unit.tr_mul(&unit),
            moments: unit.tr_mul(target),
            sizes,
            remaining: vec![1.0; columns.ncols()],
            whitened: DMatrix::zeros(0, 0),
            n_baseline: 0,
            absorbed: DMatrix::zeros(0, 0),
            clusters: Vec::new(),
            effective_rows: 50.0,
        }
    }

    #[test]
    fn a_column_beside_others_gains_what_a_fit_of_all_does() {
        let (columns, target) = example();
        let score = score_of(&columns, &target);
        let (others, mut steps) = (score.solve(&[3, 0, 4]), Vec::new());
        let gain = score.gain_with(&others, 1, &mut steps).expect("a column of its own");

        let fit = score.fit(&[3, 0, 4, 1]);
        assert!((gain - fit.gain).abs() < 1e-9 * gain, "{gain} {}", fit.gain);
        let all = columns.select_columns(&[3, 0, 4, 1]);
        let solution = all.svd(true, true).solve(&target, 0.0).expect("the steps");
        for (i, step) in steps.iter().enumerate() {
            assert!((step - solution[i]).abs() < 1e-9, "{steps:?} {solution}");
            assert!((fit.step[i] - solution[i]).abs() < 1e-9, "{} {solution}", fit.step);
        }
    }

    #[test]
    fn a_direction_that_no_row_sees_takes_no_part() {
        let (columns, target) = example();
        let score = score_of(&columns, &target);
        assert!(score.gain_with(&score.solve(&[2, 0]), 5, &mut Vec::new()).is_none());
        let (both, one) = (score.fit(&[0, 5]), score.fit(&[0]));
        assert!((both.gain - one.gain).abs() < 1e-4 * one.gain, "{} {}", both.gain, one.gain);
        assert!(both.step.iter().all(|step| step.abs() < one.step[0].abs()), "{} {}", both.step, one.step);
    }
}
