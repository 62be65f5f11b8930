//! A fit of the baseline with some mechanisms, and its noise: steps of Gauss and Newton, a first mechanism found in full,
//! what is left of data that were held out. Names nothing.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::clusters::clusters;
use super::covariance::{inverse_symmetric, jackknife_beside};
use super::evidence::{Candidate, Evidence, Point, Problem, names};
use super::findings::HalfSize;
use super::gram::Gram;
use super::holdout::{self, least_squares};
use super::outcome::Stage;
use super::score::{SIGNIFICANT, chance, longest_correlation_s, whiten, whiten_with_prior};
use crate::noise::{self, Lasting, Noise};

/// Steps of Gauss and Newton to one fit.
const MAX_FIT_STEPS: usize = 12;

/// Times that a quicker problem's steps come first.
const MAX_QUICK_ROUNDS: usize = 4;

/// Fall of the weighted sum of squares that ends a fit.
const LEAST_FALL: f64 = 1e-3;

/// Alternations of fit and noise.
const MAX_NOISE_ROUNDS: usize = 4;

/// Other points from which a baseline is fitted, those first that leave least as they are.
const MOST_STARTS: usize = 3;

/// Versions of one mechanism whose traces are kept out of the noise.
const MAX_VERSIONS_IN_NOISE: usize = 3;

/// Part of what a mechanism fitted alone must explain that it explains at first, while all of the misfit counts as noise.
const PROMISING: f64 = 0.1;

/// Difference of the logarithm of the held-out likelihood within which two single mechanisms are as good as each other.
const SAME: f64 = 1.0;

/// Standard errors from having no effect at which half of the data shows a mechanism: 95 %.
const FOUND_AT: f64 = 2.0;

/// A fit of the baseline and the included candidates.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    pub(super) point: Point,
    pub(super) included: Vec<usize>,
    pub(super) evidence: Evidence,
    pub(super) noises: Vec<Noise>,
}

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
    pub(super) fn new(problem: &impl Problem, point: Point, included: Vec<usize>) -> Self {
        let evidence = believing(problem, problem.evidence(&point), &point, &included);
        let noises = noises(problem, &evidence, &included);
        Fitted { point, included, evidence, noises }
    }

    /// The baseline alone, fitted. A fit that contradicts the prior may have ended in a local minimum: then it is repeated from other
    /// points, and the one with the smallest objective is returned.
    pub(super) fn baseline(problem: &impl Problem) -> Self {
        let from = |start: Point| {
            let mut baseline = Fitted::new(problem, start, Vec::new());
            baseline.converge(problem);
            baseline
        };
        let first = from(problem.start());
        if first.agrees_with_prior() {
            return first;
        }
        let start_of = |point: Point| (objective(&believing(problem, problem.evidence(&point), &point, &[])), point);
        let mut starts: Vec<(f64, Point)> = problem.other_starts().into_iter().map(start_of).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let others = starts.into_iter().take(MOST_STARTS).map(|(_, point)| from(point));
        let left = |fitted: &Fitted| objective(&fitted.evidence);
        others.fold(first, |best, other| if left(&other) < left(&best) { other } else { best })
    }

    /// Whether the fitted parameters, taken together, agree with the prior.
    fn agrees_with_prior(&self) -> bool {
        let prior = &self.evidence.prior;
        prior.is_empty() || chance(belief_squares(&self.evidence), prior.len()) >= SIGNIFICANT
    }

    /// The fit and its noise, each with the other as it is, until the sum of squares no longer falls.
    pub(super) fn converge(&mut self, problem: &impl Problem) {
        let mut quicker = None;
        for _ in 0..MAX_NOISE_ROUNDS {
            let moved = self.descend_about(problem, &mut quicker);
            self.noises = noises(problem, &self.evidence, &self.included);
            if moved < 1e-2 {
                return;
            }
        }
    }

    /// Gauss and Newton's steps, until the weighted sum of squares no longer falls; returns by how much it fell.
    pub(super) fn descend(&mut self, problem: &impl Problem) -> f64 {
        self.descend_about(problem, &mut None)
    }

    /// The same. Where there is a quicker problem about a point, its steps come first, and what it holds fixed is computed again after
    /// them, so that the minimum is that of the problem itself. `quicker` is the one about this point, if known, before and after.
    fn descend_about<P: Problem>(&mut self, problem: &P, quicker: &mut Option<P>) -> f64 {
        let mut fallen = 0.0;
        for _ in 0..MAX_QUICK_ROUNDS {
            *quicker = quicker.take().or_else(|| problem.for_first_search(&self.point));
            let Some(about_here) = quicker else { break };
            let mut trial = self.clone();
            if trial.step(about_here) < LEAST_FALL {
                break;
            }
            // At the point about which it was made a quicker problem equals the problem itself.
            let Some(about_there) = problem.for_first_search(&trial.point) else { break };
            trial.evidence = believing(problem, about_there.evidence(&trial.point), &trial.point, &trial.included);
            let fall =
                weighted_squares(&self.evidence, &self.noises) - weighted_squares(&trial.evidence, &trial.noises);
            // No fall: what was held fixed matters here.
            if fall < LEAST_FALL {
                break;
            }
            (*self, *quicker) = (trial, Some(about_there));
            fallen += fall;
        }
        let by_problem = self.step(problem);
        if by_problem > 0.0 {
            *quicker = None;
        }
        fallen + by_problem
    }

    /// Gauss and Newton's steps, shortened where a whole one makes things worse; returns by how much the weighted sum of
    /// squares fell.
    fn step(&mut self, problem: &impl Problem) -> f64 {
        let mut fallen = 0.0;
        for _ in 0..MAX_FIT_STEPS {
            let columns = self.columns();
            let step = solve(&self.evidence, &self.noises, &columns, &self.evidence.residual);
            if self.predicted_fall(&columns, &step) < LEAST_FALL {
                break;
            }
            let before = weighted_squares(&self.evidence, &self.noises);
            let mut fall = 0.0;
            for shortening in [1.0, 0.5, 0.25, 0.1, 0.03] {
                let point = self.moved(problem, &(&step * shortening));
                if !problem.admits(&point) {
                    continue;
                }
                let evidence = believing(problem, problem.evidence(&point), &point, &self.included);
                let after = weighted_squares(&evidence, &self.noises);
                if after < before {
                    (self.point, self.evidence, fall) = (point, evidence, before - after);
                    break;
                }
            }
            fallen += fall;
            if fall < LEAST_FALL {
                break;
            }
        }
        fallen
    }

    /// By how much a step lets the weighted sum of squares fall where the model is linear.
    fn predicted_fall(&self, columns: &DMatrix<f64>, step: &DVector<f64>) -> f64 {
        let k = columns.ncols();
        let mut all = DMatrix::zeros(columns.nrows(), k + 1);
        all.columns_mut(0, k).copy_from(columns);
        all.column_mut(k).copy_from(&self.evidence.residual);
        let all = whiten_with_prior(&self.evidence, &self.noises, &all, k);
        let target = all.column(k);
        target.norm_squared() - (target - all.columns(0, k) * step).norm_squared()
    }

    /// Far from the truth the model bends, and its slopes mislead: there each mechanism is fitted in full, alone, by plain
    /// least squares, and the one that leaves least is the place to start from. Where this fit and all of those contradict the
    /// prior, they are made again from what is believed: what is missing may have bent the baseline so far that no step leads back.
    pub(super) fn nonlinear_refit(&self, problem: &impl Problem) -> Option<Fitted> {
        if !problem.bends() {
            return None;
        }
        let plain = plain_noises(&self.evidence);
        // By how much the objective falls where the squares of the quantity with the fewest rows are halved.
        let fewest_rows = self.evidence.quantities.iter().map(|quantity| quantity.rows.len()).min()?;
        let half = 0.5 * std::f64::consts::LN_2 * fewest_rows as f64;
        let before = objective(&self.evidence);
        let candidates = problem.candidates();
        let mut trials: Vec<(f64, Fitted)> = Vec::new();
        for (again, start) in [self.point.clone(), problem.start()].into_iter().enumerate() {
            if again > 0 && (self.agrees_with_prior() || trials.iter().any(|(_, trial)| trial.agrees_with_prior())) {
                break;
            }
            let quicker = problem.for_first_search(&start);
            let first = quicker.as_ref().unwrap_or(problem);
            let here = first.evidence(&start);
            for (i, _) in candidates.iter().enumerate().filter(|(_, candidate)| candidate.version.is_none()) {
                let evidence = believing(first, here.clone(), &start, &[i]);
                let mut trial = Fitted { point: start.clone(), included: vec![i], evidence, noises: plain.clone() };
                // At first all of the misfit counts as noise, beside which beliefs about sizes weigh too much: once more with
                // what is left, until no more goes, or it is clear that this mechanism explains next to nothing.
                for _ in 0..MAX_NOISE_ROUNDS {
                    if trial.descend(first) < 1e-2 || objective(&trial.evidence) > before - PROMISING * half {
                        break;
                    }
                    trial.noises = plain_noises(&trial.evidence);
                }
                let size = trial.point.candidates[i][0];
                if trial.is_possible(candidates) && !candidates[i].is_impossible(size) {
                    trials.push((objective(&trial.evidence), trial));
                }
            }
        }
        // Half of the squares of one quantity at least, or the slopes are as good a guide. What is left by the best ones is judged
        // where they were not fitted.
        let halves_one = |trial: &Fitted| {
            let rms = |fitted: &Fitted, rows| holdout::rms(&fitted.evidence.residual, rows);
            let mut quantities = self.evidence.quantities.iter();
            quantities.any(|one| rms(trial, one.rows.clone()).powi(2) <= 0.5 * rms(self, one.rows.clone()).powi(2))
        };
        trials.retain(|(left, trial)| *left <= before && halves_one(trial));
        let least = trials.iter().map(|trial| trial.0).min_by(f64::total_cmp)?;
        let converged = trials.into_iter().filter(|(left, _)| *left <= least + half).map(|(_, mut trial)| {
            trial.noises = noises(problem, &trial.evidence, &trial.included);
            trial.converge(problem);
            (trial.held_out_misfit(), trial)
        });
        let converged: Vec<(f64, Fitted)> = converged.collect();
        let least = converged.iter().map(|(left, _)| *left).min_by(f64::total_cmp)?;
        // Where two are as good as each other the one with fewer parameters is, and of those the catalogue's order decides: the
        // commoner stands first.
        let as_good = converged.into_iter().filter(|(left, _)| *left < least + SAME).map(|(_, trial)| trial);
        as_good.min_by_key(|trial| {
            let parameters: usize = trial.included.iter().map(|i| candidates[*i].neutral.len()).sum();
            (parameters, trial.included.clone())
        })
    }

    /// Less the logarithm of the likelihood of data that were held out, up to a constant.
    pub(super) fn held_out_misfit(&self) -> f64 {
        let left = self.held_out();
        let of = |quantity: &super::evidence::Quantity| {
            quantity.rows.len() as f64 * holdout::rms(&left, quantity.rows.clone()).ln()
        };
        self.evidence.quantities.iter().map(of).sum()
    }

    /// Sets that hold the one mechanism found in full and predict no worse than this one, best first: that one alone where
    /// this set has no more, and this set with that one in the place of each of its own.
    pub(super) fn rivals(&self, single: &Fitted, problem: &impl Problem) -> Vec<Fitted> {
        if self.included.iter().any(|member| single.included.contains(member)) {
            return Vec::new();
        }
        let exchanged = (0..self.included.len()).filter(|_| self.included.len() > 1).map(|place| {
            let mut point = single.point.clone();
            let mut members = single.included.clone();
            for other in self.included.iter().enumerate().filter(|(i, _)| *i != place).map(|(_, other)| *other) {
                point.candidates[other].clone_from(&self.point.candidates[other]);
                members.push(other);
            }
            members.sort_unstable();
            let mut rival = Fitted::new(problem, point, members);
            rival.converge(problem);
            rival
        });
        let here = self.held_out();
        let is_no_worse = |rival: &Fitted| {
            holdout::advantage(&self.evidence, &self.noises, &rival.held_out(), &here) < problem.least_advantage()
        };
        let mut rivals: Vec<(f64, Fitted)> = exchanged
            .filter(|rival| rival.is_possible(problem.candidates()) && is_no_worse(rival))
            .chain(single.predicts_as_well_as(self).then(|| single.clone()))
            .map(|rival| (rival.held_out_misfit(), rival))
            .collect();
        rivals.sort_by(|a, b| a.0.total_cmp(&b.0));
        rivals.into_iter().map(|(_, rival)| rival).collect()
    }

    /// Whether it is no larger than another set and leaves no more of the data that were held out.
    pub(super) fn predicts_as_well_as(&self, other: &Fitted) -> bool {
        self.included != other.included
            && self.included.len() >= other.included.len()
            && self.held_out_misfit() <= other.held_out_misfit()
    }

    /// Whether every included parameter lies where physics allows it.
    pub(super) fn is_possible(&self, candidates: &[Candidate]) -> bool {
        self.included.iter().all(|member| {
            let values = self.point.candidates[*member].iter();
            values.zip(&candidates[*member].bounds).all(|(value, (low, high))| (low..=high).contains(&value))
        })
    }

    pub(super) fn columns(&self) -> DMatrix<f64> {
        let parts: Vec<&DMatrix<f64>> = std::iter::once(&self.evidence.baseline)
            .chain(self.included.iter().map(|member| &self.evidence.candidates[*member]))
            .collect();
        side_by_side(self.evidence.residual.len(), &parts)
    }

    pub(super) fn moved(&self, problem: &impl Problem, step: &DVector<f64>) -> Point {
        let mut point = self.point.clone();
        let mut steps = step.iter();
        for (place, (value, step)) in point.baseline.iter_mut().zip(&mut steps).enumerate() {
            *value = problem.stepped(place, *value, *step);
        }
        for member in &self.included {
            for (value, step) in point.candidates[*member].iter_mut().zip(&mut steps) {
                *value += step;
            }
        }
        debug_assert_eq!(problem.baseline().len(), point.baseline.len());
        point
    }

    /// Residuals as the baseline would leave them at this point: the included candidates' share put back.
    pub(super) fn without_candidates(&self, candidates: &[Candidate]) -> DVector<f64> {
        let mut residual = self.evidence.residual.clone();
        for member in &self.included {
            let (values, neutral) = (&self.point.candidates[*member], &candidates[*member].neutral);
            let offset = DVector::from_iterator(values.len(), values.iter().zip(neutral).map(|(v, n)| v - n));
            residual += &self.evidence.candidates[*member] * offset;
        }
        residual
    }

    /// Standard deviation of the noise of each row.
    pub(super) fn sd(&self) -> Vec<f64> {
        let mut sd = vec![0.0; self.evidence.residual.len()];
        for (quantity, noise) in self.evidence.quantities.iter().zip(&self.noises) {
            quantity.rows.clone().for_each(|row| sd[row] = noise.sd(self.evidence.stated_sd[row]));
        }
        sd
    }

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
        let cluster = clusters(&self.evidence.block, &self.evidence.time_s, longest_correlation_s(&self.noises));
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
        let mut begins: BTreeMap<usize, f64> = BTreeMap::new();
        for (block, time_s) in self.evidence.block.iter().zip(&self.evidence.time_s) {
            let begin = begins.entry(*block).or_insert(*time_s);
            *begin = begin.min(*time_s);
        }
        let mut times: Vec<f64> = begins.values().copied().collect();
        times.sort_by(f64::total_cmp);
        let middle = times.get(times.len() / 2).copied().unwrap_or(f64::INFINITY);
        self.evidence.block.iter().map(|block| begins[block] < middle).collect()
    }

    /// The size above which a misfit of each quantity is worth acting on.
    pub(super) fn limits(&self, problem: &impl Problem) -> Vec<f64> {
        let quantities = self.evidence.quantities.iter().enumerate();
        let of = |(i, quantity)| problem.relevance(quantity, expected_rms(&self.evidence, &self.noises, i));
        quantities.map(of).collect()
    }

    /// What is left of each row when its block was held out.
    pub(super) fn held_out(&self) -> DVector<f64> {
        holdout::residuals(&self.evidence, &self.noises, &self.columns(), &self.evidence.residual)
    }
}

/// The evidence with what is believed of the included candidates beside what is believed of the baseline.
pub(super) fn believing(problem: &impl Problem, mut evidence: Evidence, point: &Point, included: &[usize]) -> Evidence {
    for member in included {
        let candidate = &problem.candidates()[*member];
        let values = point.candidates[*member].iter().zip(&candidate.neutral);
        let prior = candidate.prior_at(&point.candidates[*member]);
        for ((value, neutral), (believed, sd)) in values.zip(prior) {
            evidence.prior.push((neutral + believed - value, sd));
        }
    }
    evidence
}

/// White noise as large as what is left.
pub(super) fn plain_noises(evidence: &Evidence) -> Vec<Noise> {
    let of = |quantity: &super::evidence::Quantity| {
        let stated: f64 = quantity.rows.clone().map(|row| evidence.stated_sd[row].powi(2)).sum();
        let misfit: f64 = quantity.rows.clone().map(|row| evidence.residual[row].powi(2)).sum();
        Noise { white: misfit / stated.max(f64::MIN_POSITIVE), ..noise::WHITE }
    };
    evidence.quantities.iter().map(of).collect()
}

/// The noise of each quantity, everything that any candidate could explain set aside where there are rows to spare. Of
/// the versions of one mechanism a few stand for all: many jumps together would take all that is slow out of the noise.
pub(super) fn noises(problem: &impl Problem, evidence: &Evidence, included: &[usize]) -> Vec<Noise> {
    let candidates = problem.candidates();
    let mut parts: Vec<&DMatrix<f64>> = vec![&evidence.baseline];
    parts.extend(included.iter().map(|member| &evidence.candidates[*member]));
    let few = side_by_side(evidence.residual.len(), &parts);
    for name in names(candidates) {
        let versions: Vec<usize> = (0..candidates.len()).filter(|i| candidates[*i].name == name).collect();
        let every = versions.len().div_ceil(MAX_VERSIONS_IN_NOISE);
        let chosen = versions.iter().skip(every / 2).step_by(every).filter(|i| !included.contains(i));
        parts.extend(chosen.map(|i| &evidence.candidates[*i]));
    }
    let many = side_by_side(evidence.residual.len(), &parts);
    evidence
        .quantities
        .iter()
        .map(|quantity| {
            let rows = quantity.rows.clone();
            let reaching = many.column_iter().filter(|column| column.rows(rows.start, rows.len()).amax() > 0.0).count();
            let spare = rows.len() as f64 > problem.rows_per_column() * reaching as f64;
            let explained = if spare { &many } else { &few };
            let residual = evidence.residual.rows(rows.start, rows.len()).into_owned();
            noise::estimate(
                evidence.series(quantity),
                Lasting::MinutesAndHours,
                problem.stated_variance_known_to(),
                &residual,
                &explained.rows(rows.start, rows.len()).into_owned(),
            )
        })
        .collect()
}

pub(super) fn solve(
    evidence: &Evidence,
    noises: &[Noise],
    columns: &DMatrix<f64>,
    target: &DVector<f64>,
) -> DVector<f64> {
    let k = columns.ncols();
    let mut all = DMatrix::zeros(target.len(), k + 1);
    all.columns_mut(0, k).copy_from(columns);
    all.column_mut(k).copy_from(target);
    least_squares(&whiten_with_prior(evidence, noises, &all, k))
}

pub(super) fn weighted_squares(evidence: &Evidence, noises: &[Noise]) -> f64 {
    weighted(evidence, noises, &evidence.residual)
}

pub(super) fn weighted(evidence: &Evidence, noises: &[Noise], values: &DVector<f64>) -> f64 {
    let mut column = DMatrix::from_column_slice(values.len(), 1, values.as_slice());
    whiten(evidence, noises, &mut column);
    column.norm_squared() + belief_squares(evidence)
}

/// Less the logarithm of the likelihood of what is left with white noise of any size, and of the beliefs, up to a constant.
fn objective(evidence: &Evidence) -> f64 {
    let of = |quantity: &super::evidence::Quantity| {
        quantity.rows.len() as f64 * holdout::rms(&evidence.residual, quantity.rows.clone()).ln()
    };
    evidence.quantities.iter().map(of).sum::<f64>() + 0.5 * belief_squares(evidence)
}

/// Squares of how far the parameters are from what is believed, in units of its standard deviations.
fn belief_squares(evidence: &Evidence) -> f64 {
    evidence.prior.iter().map(|(belief, sd)| (belief / sd).powi(2)).sum()
}

pub(super) fn side_by_side(rows: usize, parts: &[&DMatrix<f64>]) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(rows, parts.iter().map(|part| part.ncols()).sum());
    let mut column = 0;
    for part in parts {
        all.columns_mut(column, part.ncols()).copy_from(part);
        column += part.ncols();
    }
    all
}

pub(super) fn expected_rms(evidence: &Evidence, noises: &[Noise], quantity: usize) -> f64 {
    let rows = evidence.quantities[quantity].rows.clone();
    let n = rows.len().max(1) as f64;
    (rows.map(|row| noises[quantity].sd(evidence.stated_sd[row]).powi(2)).sum::<f64>() / n).sqrt()
}
