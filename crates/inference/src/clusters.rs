//! Whether an effect is the same in cluster after cluster: a test that needs no model of the noise.
//!
//! A model of noise can be wrong where it matters: water that moves for as long as a leg lasts, instruments that drift to rest.
//! So beside the test by the model of noise stands one by the scatter between legs or runs. The estimate is made again
//! without each cluster in turn (delete-one-cluster jackknife, the CR3 of Bell and McCaffrey 2002),
//!
//! ```text
//! V = (G - 1)/G sum_g (b_(g) - b)(b_(g) - b)'      T2 = b' V^-1 b      F = T2 (G - k) / (k (G - 1))  ~  F(k, G - k)
//! ```
//!
//! with G clusters and k tested columns, as Hotelling's T2 of G independent vectors. Where the noise is as modelled it is
//! somewhat conservative. Knows whitened columns and clusters.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::evidence::Evidence;
use crate::noise::{Noise, longest_correlation_s, orthonormal};

/// Clusters into which few long blocks are divided and many short ones put together: with fewer the quantiles of F reject next
/// to nothing, with more a cluster lasts no longer than what makes its rows err together.
const ENOUGH_CLUSTERS: usize = 24;

/// Correlation times of the noise that a part of a block must last for the parts to count as independent: after the
/// whitening what correlation is left beyond e^-2 is small.
const CORRELATION_TIMES: f64 = 2.0;

/// Returns the cluster of each row under this noise.
///
/// Rows that were made independent have no neighbours that err together: each block is a cluster. Were neighbours put together,
/// an effect that the runs at one speed alone show would lie in one cluster, and without that cluster there is no estimate of it.
pub fn clusters_of(evidence: &Evidence, noises: &[Noise]) -> Vec<usize> {
    match evidence.decorrelation {
        Some(_) => evidence.block.clone(),
        None => clusters(&evidence.block, &evidence.time_s, longest_correlation_s(noises)),
    }
}

/// Which cluster each row belongs to: its block; where blocks are few and long an equal part of it, where they are many some
/// neighbours together, since what lasts longer than a block makes neighbours err together.
fn clusters(block: &[usize], time_s: &[f64], longest_correlation_s: f64) -> Vec<usize> {
    let mut spans: std::collections::BTreeMap<usize, (f64, f64)> = std::collections::BTreeMap::new();
    for (block, time_s) in block.iter().zip(time_s) {
        let span = spans.entry(*block).or_insert((*time_s, *time_s));
        *span = (span.0.min(*time_s), span.1.max(*time_s));
    }
    let wanted = ENOUGH_CLUSTERS.div_ceil(spans.len().max(1));
    let together = (spans.len() / ENOUGH_CLUSTERS).max(1);
    let places: std::collections::BTreeMap<usize, usize> =
        spans.keys().enumerate().map(|(place, block)| (*block, place / together)).collect();
    let parts_of = |(low, high): (f64, f64)| {
        let most = ((high - low) / (CORRELATION_TIMES * longest_correlation_s).max(f64::MIN_POSITIVE)).floor();
        (most.min(wanted as f64) as usize).max(1)
    };
    let row = |(block, time_s): (&usize, &f64)| {
        let (low, high) = spans[block];
        let parts = parts_of((low, high));
        let place = if high > low { (time_s - low) / (high - low) * parts as f64 } else { 0.0 };
        places[block] * wanted + (place as usize).min(parts - 1)
    };
    block.iter().zip(time_s).map(row).collect()
}

/// Probability that chance alone brings such an effect of the last `tested` of these columns. `all` are whitened columns,
/// the target behind them, with the rows of the prior below those of the data; `clusters` are those of the data's rows. The effect
/// is `magnified` where the likelihood says that it explains more than by these columns; its scatter counts as it is by them.
pub fn chance_by_clusters(all: &DMatrix<f64>, clusters: &[usize], tested: usize, magnified: f64) -> f64 {
    if tested == 0 {
        return 1.0;
    }
    let (all, tested) = independent_directions(all, tested);
    let k = all.ncols() - 1;
    if tested == 0 {
        return 1.0;
    }
    let whole = all.tr_mul(&all);
    let mut of_cluster: std::collections::BTreeMap<usize, DMatrix<f64>> = std::collections::BTreeMap::new();
    for (row, cluster) in clusters.iter().enumerate() {
        let values = all.row(row);
        let products = of_cluster.entry(*cluster).or_insert_with(|| DMatrix::zeros(k + 1, k + 1));
        products.ger(1.0, &values.transpose(), &values.transpose(), 1.0);
    }
    let estimate = |products: &DMatrix<f64>| -> Option<DVector<f64>> {
        let gram = products.view((0, 0), (k, k)).into_owned();
        let moments = products.view((0, k), (k, 1)).into_owned().column(0).into_owned();
        // Only where a cluster alone determines a column is there no inverse.
        let solution = match gram.clone().cholesky() {
            Some(root) => root.solve(&moments),
            None => gram.pseudo_inverse(1e-10).ok()? * moments,
        };
        Some(solution.rows(k - tested, tested).into_owned())
    };
    let n = of_cluster.len() as f64;
    let free = n - tested as f64;
    if free < 1.0 {
        return 1.0;
    }
    let Some(here) = estimate(&whole) else { return 1.0 };
    let mut between = DMatrix::zeros(tested, tested);
    for products in of_cluster.values() {
        let Some(without) = estimate(&(&whole - products)) else { return 1.0 };
        let apart = without - &here;
        between.ger((n - 1.0) / n, &apart, &apart, 1.0);
    }
    let Some(inverse) = between.cholesky() else { return 1.0 };
    let square = magnified * here.dot(&inverse.solve(&here));
    let f = square * free / (tested as f64 * (n - 1.0));
    FisherSnedecor::new(tested as f64, free).map_or(1.0, |distribution| distribution.sf(f.max(0.0)))
}

/// Share of a unit column outside the others below which it is the others'.
const UNIDENTIFIABLE: f64 = 1e-4;

/// The columns in units of their own length, the tested ones as the directions that the others cannot imitate, with the
/// number of these.
fn independent_directions(all: &DMatrix<f64>, tested: usize) -> (DMatrix<f64>, usize) {
    let k = all.ncols() - 1;
    let mut all = all.clone();
    for j in 0..k {
        let size = all.column(j).norm();
        if size > 0.0 {
            all.column_mut(j).unscale_mut(size);
        }
    }
    let others = k - tested;
    let q = orthonormal(all.columns(0, others).into_owned());
    let own = all.columns(others, tested).into_owned();
    let mut rest = own.clone();
    rest -= &q * q.tr_mul(&own);
    let eigen = rest.tr_mul(&rest).symmetric_eigen();
    let kept: Vec<usize> = (0..tested).filter(|i| eigen.eigenvalues[*i] > UNIDENTIFIABLE * UNIDENTIFIABLE).collect();
    let directions = own * eigen.eigenvectors.select_columns(&kept);
    let mut columns = DMatrix::zeros(all.nrows(), others + kept.len() + 1);
    columns.columns_mut(0, others).copy_from(&all.columns(0, others));
    columns.columns_mut(others, kept.len()).copy_from(&directions);
    columns.column_mut(others + kept.len()).copy_from(&all.column(k));
    (columns, kept.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::StdRng};
    use rand_distr::StandardNormal;

    /// Rows of one cluster share an error that the test does not know.
    fn data(seed: u64, effect: f64) -> (DMatrix<f64>, Vec<usize>) {
        let mut rng = StdRng::seed_from_u64(seed);
        let mut normal = move || rng.sample::<f64, _>(StandardNormal);
        let (groups, rows) = (24, 20);
        let clusters: Vec<usize> = (0..groups * rows).map(|row| row / rows).collect();
        let mut all = DMatrix::zeros(groups * rows, 4);
        for group in 0..groups {
            let (common, a, b) = (normal(), normal(), normal());
            for row in group * rows..(group + 1) * rows {
                let (x, z) = (a + 0.3 * normal(), b + 0.3 * normal());
                all.set_row(
                    row,
                    &nalgebra::RowDVector::from_row_slice(&[1.0, x, z, effect * z + common + 0.3 * normal()]),
                );
            }
        }
        (all, clusters)
    }

    #[test]
    fn the_level_holds_where_the_rows_of_a_cluster_err_together() {
        let rejected = |effect, seeds: std::ops::Range<u64>| {
            seeds
                .filter(|seed| {
                    let (all, clusters) = data(*seed, effect);
                    chance_by_clusters(&all, &clusters, 2, 1.0) < 0.05
                })
                .count()
        };
        let false_alarms = rejected(0.0, 0..400);
        // 20 of 400 expected; 99.9 % of the binomial distribution lies below 36.
        assert!(false_alarms <= 36, "{false_alarms} of 400");
        assert!(rejected(1.0, 1000..1040) >= 30);
    }

    #[test]
    fn long_blocks_are_divided_and_short_ones_are_not() {
        let block: Vec<usize> = (0..600).map(|row| row / 100).collect();
        let time_s: Vec<f64> = (0..600).map(|row| 60.0 * f64::from(row)).collect();
        let count = |correlation_s| {
            let mut found = clusters(&block, &time_s, correlation_s);
            found.dedup();
            found.len()
        };
        assert_eq!(count(300.0), 24);
        assert_eq!(count(3000.0), 6);
    }
}
