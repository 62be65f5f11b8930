//! The gain on data that no fit saw: whole glides or runs held out, predicted by a fit to the others.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng, rngs::StdRng};

use super::covariance::unit_columns;
use super::evidence::{Evidence, Quantity};
use super::relevance::ONE_SIDED;
use super::score::{whiten, whiten_with_prior};
use crate::noise::Noise;

/// In how many parts the blocks are split; each is held out once.
const FOLDS: usize = 4;

/// Resampled sets of blocks for the interval of a gain.
const RESAMPLES: usize = 400;

/// Predicts every row from a fit to the other parts, and returns what is left of it.
///
/// `columns` are the sensitivities of the model that is fitted, `target` what they are fitted to. Rows of one block
/// stay together, and so do neighbouring blocks: a part is every fourth pair of them.
pub fn residuals(evidence: &Evidence, noises: &[Noise], columns: &DMatrix<f64>, target: &DVector<f64>) -> DVector<f64> {
    let mut left = target.clone();
    for fold in 0..FOLDS {
        let is_out = |row: usize| (evidence.block[row] / 2) % FOLDS == fold;
        let kept: Vec<usize> = (0..target.len()).filter(|row| !is_out(*row)).collect();
        if kept.len() == target.len() || kept.len() <= columns.ncols() {
            continue;
        }
        let part = subset(evidence, &kept);
        let mut all = DMatrix::zeros(kept.len(), columns.ncols() + 1);
        for (i, row) in kept.iter().enumerate() {
            all.view_mut((i, 0), (1, columns.ncols())).copy_from(&columns.row(*row));
            all[(i, columns.ncols())] = target[*row];
        }
        let all = whiten_with_prior(&part, noises, &all, columns.ncols());
        let solution = least_squares(&all);
        for row in (0..target.len()).filter(|row| is_out(*row)) {
            left[row] = target[row] - (columns.row(row) * &solution)[0];
        }
    }
    left
}

/// The fit of these columns to the rows for which `keep` is true, with its covariance; none where they are too few.
pub fn on_part(
    evidence: &Evidence,
    noises: &[Noise],
    columns: &DMatrix<f64>,
    keep: impl Fn(usize) -> bool,
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let k = columns.ncols();
    let kept: Vec<usize> = (0..evidence.residual.len()).filter(|row| keep(*row)).collect();
    if kept.len() <= k {
        return None;
    }
    let part = subset(evidence, &kept);
    let mut all = DMatrix::zeros(kept.len(), k + 1);
    for (i, row) in kept.iter().enumerate() {
        all.view_mut((i, 0), (1, k)).copy_from(&columns.row(*row));
        all[(i, k)] = evidence.residual[*row];
    }
    let all = whiten_with_prior(&part, noises, &all, k);
    let (design, sizes) = unit_columns(&all, k);
    let inverse = design.tr_mul(&design).pseudo_inverse(1e-12).ok()?;
    let covariance = DMatrix::from_fn(k, k, |i, j| inverse[(i, j)] / (sizes[i] * sizes[j]));
    Some((least_squares(&all), covariance))
}

/// Whether any quantity is left with more by enough to act on: its rms in the first of two is the larger by more than its limit, in
/// quadrature.
pub fn leaves_relevantly_more(evidence: &Evidence, limits: &[f64], left: [&DVector<f64>; 2]) -> bool {
    with_relevantly_more(evidence, limits, left).next().is_some()
}

/// The same for certain: by more than chance makes of the difference between blocks once in twenty.
pub fn surely_leaves_relevantly_more(evidence: &Evidence, limits: &[f64], [more, less]: [&DVector<f64>; 2]) -> bool {
    let difference = |row: usize| (evidence.block[row], more[row].powi(2) - less[row].powi(2));
    let mut quantities = with_relevantly_more(evidence, limits, [more, less]);
    quantities.any(|quantity| standard_errors_of_mean(quantity.rows.clone().map(difference)) > ONE_SIDED)
}

/// The quantities of which the first leaves relevantly more.
fn with_relevantly_more<'a>(
    evidence: &'a Evidence,
    limits: &'a [f64],
    [more, less]: [&'a DVector<f64>; 2],
) -> impl Iterator<Item = &'a Quantity> {
    let is_more = move |(quantity, limit): &(&Quantity, &f64)| {
        let square = |left: &DVector<f64>| rms(left, quantity.rows.clone()).powi(2);
        square(more) - square(less) > limit.powi(2)
    };
    evidence.quantities.iter().zip(limits).filter(is_more).map(|(quantity, _)| quantity)
}

/// Solution of a least-squares problem whose right side is the last column; directions that no row sees stay zero.
pub fn least_squares(all: &DMatrix<f64>) -> DVector<f64> {
    LeastSquares::new(all).solution(0.0)
}

/// A least-squares problem in the directions of its curvature, its columns of unit length, for solutions that are damped more or less.
pub struct LeastSquares {
    /// Lengths of the columns.
    sizes: Vec<f64>,
    directions: DMatrix<f64>,
    /// Curvature of half the sum of squares along each direction, and its slope.
    curvatures: DVector<f64>,
    slopes: DVector<f64>,
}

impl LeastSquares {
    /// The problem whose right side is the last column.
    pub fn new(all: &DMatrix<f64>) -> Self {
        let k = all.ncols() - 1;
        let (design, sizes) = unit_columns(all, k);
        let eigen = (design.transpose() * &design).symmetric_eigen();
        let slopes = eigen.eigenvectors.tr_mul(&(design.transpose() * all.column(k)));
        LeastSquares { sizes, directions: eigen.eigenvectors, curvatures: eigen.eigenvalues, slopes }
    }

    /// The solution with so much added to the curvature along every single column, which is 1 (Marquardt 1963, J. Soc. Ind. Appl. Math. 11,
    /// 431). Directions that no row sees stay zero.
    pub fn solution(&self, damping: f64) -> DVector<f64> {
        let solution = &self.directions * self.along_directions(damping);
        DVector::from_fn(self.sizes.len(), |j, _| solution[j] / self.sizes[j])
    }

    /// By how much that solution lets the sum of squares fall.
    pub fn fall(&self, damping: f64) -> f64 {
        let steps = self.along_directions(damping);
        let of = |i: usize| steps[i] * (2.0 * self.slopes[i] - self.curvatures[i] * steps[i]);
        (0..steps.len()).map(of).sum()
    }

    /// The smallest curvature along a direction that the rows see.
    pub fn least_curvature(&self) -> f64 {
        let seen = self.curvatures.iter().copied().filter(|curvature| *curvature > self.unseen());
        seen.min_by(f64::total_cmp).unwrap_or(1.0)
    }

    fn along_directions(&self, damping: f64) -> DVector<f64> {
        let unseen = self.unseen();
        let step = |curvature: f64, slope: f64| if curvature > unseen { slope / (curvature + damping) } else { 0.0 };
        self.curvatures.zip_map(&self.slopes, step)
    }

    fn unseen(&self) -> f64 {
        1e-10 * self.curvatures.max()
    }
}

/// The rows of an evidence that a fit may see.
fn subset(evidence: &Evidence, kept: &[usize]) -> Evidence {
    let mut part = Evidence {
        quantities: Vec::new(),
        time_s: kept.iter().map(|row| evidence.time_s[*row]).collect(),
        stated_sd: kept.iter().map(|row| evidence.stated_sd[*row]).collect(),
        block: Vec::new(),
        leg: Vec::new(),
        place: if evidence.place.is_empty() {
            Vec::new()
        } else {
            kept.iter().map(|row| evidence.place[*row]).collect()
        },
        residual: DVector::zeros(0),
        baseline: DMatrix::zeros(0, 0),
        baseline_without: None,
        prior: evidence.prior.clone(),
        candidates: Vec::new(),
        shared: DMatrix::zeros(kept.len(), 0),
        covariates: Vec::new(),
        decorrelation: None,
    };
    let mut start = 0;
    for quantity in &evidence.quantities {
        let n = kept.iter().filter(|row| quantity.rows.contains(row)).count();
        part.quantities.push(super::evidence::Quantity { rows: start..start + n, ..quantity.clone() });
        start += n;
    }
    part
}

/// Root mean square of these rows.
pub fn rms(values: &DVector<f64>, rows: impl IntoIterator<Item = usize>) -> f64 {
    let (sum, n) = rows.into_iter().fold((0.0, 0), |(sum, n), row| (sum + values[row] * values[row], n + 1));
    (sum / f64::from(n.max(1))).sqrt()
}

/// How sure it is that a model predicts better than another: the mean over blocks of the fall in squared error, over its standard
/// error. Errors are whitened: what rows of a block miss together, as where the water sinks, counts once and not for each row.
pub fn advantage(evidence: &Evidence, noises: &[Noise], without: &DVector<f64>, with: &DVector<f64>) -> f64 {
    let mut left = DMatrix::from_columns(&[without.clone(), with.clone()]);
    whiten(evidence, noises, &mut left);
    let rows = evidence.quantities.iter().flat_map(|quantity| quantity.rows.clone());
    standard_errors_of_mean(rows.map(|row| (evidence.block[row], left[(row, 0)].powi(2) - left[(row, 1)].powi(2))))
}

/// The mean over blocks of a sum over the rows of each, in its standard errors; 0 where it has none.
fn standard_errors_of_mean(of_rows: impl Iterator<Item = (usize, f64)>) -> f64 {
    let mut blocks: Vec<(usize, f64)> = Vec::new();
    for (block, value) in of_rows {
        match blocks.iter_mut().find(|(known, _)| *known == block) {
            Some((_, sum)) => *sum += value,
            None => blocks.push((block, value)),
        }
    }
    let n = blocks.len() as f64;
    let mean = blocks.iter().map(|(_, value)| value).sum::<f64>() / n;
    let variance = blocks.iter().map(|(_, value)| (value - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    let se = (variance / n).sqrt();
    if se > 0.0 { mean / se } else { 0.0 }
}

/// 95 % interval of the reduction of the root mean square \[%\], by resampling whole blocks.
pub fn reduction_interval(
    block: &[usize],
    rows: impl IntoIterator<Item = usize>,
    before: &DVector<f64>,
    after: &DVector<f64>,
) -> [f64; 2] {
    let mut blocks: Vec<(usize, f64, f64)> = Vec::new();
    for row in rows {
        let block = block[row];
        let (b, a) = (before[row] * before[row], after[row] * after[row]);
        match blocks.iter_mut().find(|(known, _, _)| *known == block) {
            Some((_, sum_b, sum_a)) => (*sum_b, *sum_a) = (*sum_b + b, *sum_a + a),
            None => blocks.push((block, b, a)),
        }
    }
    if blocks.is_empty() {
        return [0.0, 0.0];
    }
    // The same data must give the same interval.
    let mut rng = StdRng::seed_from_u64(0x6c1d_e901);
    let mut reductions: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let (mut sum_b, mut sum_a) = (0.0, 0.0);
            for _ in 0..blocks.len() {
                let (_, b, a) = blocks[rng.random_range(0..blocks.len())];
                (sum_b, sum_a) = (sum_b + b, sum_a + a);
            }
            reduction_percent(sum_b.sqrt(), sum_a.sqrt())
        })
        .collect();
    reductions.sort_by(f64::total_cmp);
    [reductions[RESAMPLES * 25 / 1000], reductions[RESAMPLES * 975 / 1000]]
}

/// Reduction from one error to another \[%\].
pub fn reduction_percent(before: f64, after: f64) -> f64 {
    if before > 0.0 { 100.0 * (1.0 - after / before) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::evidence::Problem;
    use super::super::tests::Toy;
    use super::*;

    /// Rows are missed by 1 on average, and by 1.12 with as much more in each block: 0.5 in quadrature. The same in one of 28 blocks is one
    /// standard error.
    #[test]
    fn what_one_block_misses_more_is_not_certain() {
        let toy = Toy::new(1, |_, _| 0.0);
        let evidence = toy.evidence(&toy.start());
        let n = evidence.residual.len();
        let less = DVector::from_element(n, 1.0);
        let everywhere = DVector::from_fn(n, |row, _| (1.25 + 0.01 * (row % 7) as f64).sqrt());
        let in_one = DVector::from_fn(n, |row, _| if evidence.block[row] == 3 { 8.0_f64.sqrt() } else { 1.0 });
        for (more, is_certain) in [(&everywhere, true), (&in_one, false)] {
            assert!(leaves_relevantly_more(&evidence, &[0.45], [more, &less]));
            assert_eq!(surely_leaves_relevantly_more(&evidence, &[0.45], [more, &less]), is_certain);
        }
        assert!(!surely_leaves_relevantly_more(&evidence, &[0.6], [&everywhere, &less]));
    }
}
