//! Uncertainty of fitted parameters: covariance by the noise model, by the scatter between clusters and by shared errors; estimates on
//! each half of the data.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::clusters::clusters_of;
use super::covariance::{inverse_symmetric, jackknife_beside};
use super::evidence::{Candidate, Problem};
use super::findings::HalfSize;
use super::fitted::Fitted;
use super::gram::Gram;
use super::holdout;
use super::outcome::Stage;
use super::score::{whiten, whiten_with_prior};

/// Standard errors from having no effect at which half of the data shows a mechanism: 95 %.
const FOUND_AT: f64 = 2.0;

/// Covariances of one fit.
pub(super) struct Covariances {
    /// By the model of the noise.
    pub(super) by_model: DMatrix<f64>,
    /// By the scatter between clusters of rows.
    pub(super) by_clusters: DMatrix<f64>,
    /// The number of clusters.
    pub(super) clusters: usize,
    /// Standard error of each parameter by the errors that all rows share.
    pub(super) by_shared: DVector<f64>,
}

impl Fitted {
    pub(super) fn stage(&self, held_out: DVector<f64>) -> Stage {
        let Covariances { by_model, by_clusters, clusters, by_shared } = self.covariances();
        Stage {
            point: self.point.clone(),
            residual: self.evidence.column_as_read(&self.evidence.residual),
            held_out: self.evidence.column_as_read(&held_out),
            sd: self.evidence.sd_as_read(self.sd()),
            covariance: by_model,
            covariance_by_clusters: by_clusters,
            clusters,
            se_by_shared: by_shared,
        }
    }

    /// Covariances of what was fitted: the baseline's parameters, then those of each included candidate.
    pub(super) fn covariances(&self) -> Covariances {
        let columns = self.columns();
        let k = columns.ncols();
        let mut all = columns.insert_column(k, 0.0);
        all.column_mut(k).copy_from(&self.evidence.residual);
        let all = whiten_with_prior(&self.evidence, &self.noises, &all, k);
        let design = all.columns(0, k);
        // Parameters have units of their own: unscaled, the singular values of their products may not converge.
        let by_model = inverse_symmetric(&design.tr_mul(&design));
        let (mut prior, mut by_cluster) = (Gram::new(k), BTreeMap::new());
        let cluster = clusters_of(&self.evidence, &self.noises);
        for row in 0..all.nrows() {
            let gram = match cluster.get(row) {
                Some(cluster) => by_cluster.entry(*cluster).or_insert_with(|| Gram::new(k)),
                None => &mut prior,
            };
            gram.add_row(&all.row(row).iter().copied().collect::<Vec<_>>());
        }
        let by_cluster: Vec<Gram> = by_cluster.into_values().collect();
        let by_shared = self.moved_by_shared(&design.into_owned(), &by_model);
        Covariances {
            by_model,
            by_clusters: jackknife_beside(&prior, &by_cluster),
            clusters: by_cluster.len(),
            by_shared,
        }
    }

    /// How far each fitted parameter moves by one standard error of the errors that all rows share.
    fn moved_by_shared(&self, design: &DMatrix<f64>, by_model: &DMatrix<f64>) -> DVector<f64> {
        let mut shared = self.evidence.shared.clone();
        whiten(&self.evidence, &self.noises, &mut shared);
        let rows = shared.nrows();
        let moved = by_model * design.rows(0, rows).tr_mul(&shared);
        DVector::from_fn(moved.nrows(), |i, _| moved.row(i).norm())
    }

    /// The place of an included mechanism's first parameter among all that are fitted.
    pub(super) fn first_parameter(&self, candidates: &[Candidate], place: usize) -> usize {
        let others = self.included[..place].iter().map(|other| candidates[*other].prior_sd.len());
        self.evidence.baseline.ncols() + others.sum::<usize>()
    }

    /// The first parameter of an included mechanism, fitted to each half of the data alone.
    pub(super) fn halves(&self, problem: &impl Problem, place: usize) -> Vec<HalfSize> {
        let candidates = problem.candidates();
        let member = self.included[place];
        let first = self.first_parameter(candidates, place);
        let (value, neutral) = (self.point.candidates[member][0], candidates[member].neutral[0]);
        let first_half = self.first_half();
        let columns = self.columns();
        let of = |half: &'static str| {
            let keep = |row: usize| first_half[row] == (half == "first");
            let (step, covariance) = holdout::on_part(&self.evidence, &self.noises, &columns, keep)?;
            let (value_here, se) = (value + step[first], covariance[(first, first)].max(0.0).sqrt());
            let departs = (value_here - neutral) * (value - neutral).signum();
            // A column that no row of a half feels says nothing, however sure the belief about it is.
            let felt = (0..columns.nrows()).any(|row| keep(row) && columns[(row, first)] != 0.0);
            Some(HalfSize { half, value: value_here, se, found: felt && departs > FOUND_AT * se })
        };
        ["first", "second"].into_iter().filter_map(of).collect()
    }

    /// Which rows are of the first half of the data: whole blocks, by the time at which they begin.
    pub(super) fn first_half(&self) -> Vec<bool> {
        self.parts_of_time(2).into_iter().map(|part| part == 0).collect()
    }

    /// Of which part of the data each row is, of so many with as many blocks each: whole blocks, by the time at which they begin.
    pub(super) fn parts_of_time(&self, parts: usize) -> Vec<usize> {
        let mut begins: BTreeMap<usize, f64> = BTreeMap::new();
        for (block, time_s) in self.evidence.block.iter().zip(&self.evidence.time_s) {
            let begin = begins.entry(*block).or_insert(*time_s);
            *begin = begin.min(*time_s);
        }
        let mut times: Vec<f64> = begins.values().copied().collect();
        times.sort_by(f64::total_cmp);
        let part_of = |block: &usize| {
            let before = times.partition_point(|time_s| *time_s < begins[block]);
            (1..parts).filter(|part| before >= times.len() * part / parts).count()
        };
        self.evidence.block.iter().map(part_of).collect()
    }
}
