//! Starting points of the fits of a strongly nonlinear model: other starts of the baseline where it contradicts the prior, a nonlinear
//! refit of each mechanism alone, and the start of a set of mechanisms. Does not decide which mechanism is named.

use std::cmp::Ordering;

use rayon::prelude::*;

use super::evidence::{Evidence, Point, Problem, Quantity};
use super::fitted::{Fitted, MAX_NOISE_ROUNDS, belief_squares, believing, deviance, weighted_squares};
use super::holdout;
use super::iteration::Iteration;
use super::score::{SIGNIFICANT, chance};
use crate::noise::{self, Noise};

/// Largest number of further starts of the baseline, those with the smallest objective first.
const MOST_STARTS: usize = 3;

/// Share of the required fall of the objective that a mechanism must reach in the first rounds, while all of the misfit counts as noise; and
/// of what another one explains that its first step must promise.
const PROMISING: f64 = 0.1;

/// Sizes from which one mechanism is fitted, in prior standard deviations from neutral: beside a bent polar the minimum of a late clock is
/// narrower than its prior.
const USUAL_SIZES: [f64; 8] = [-1.0, -0.75, -0.5, -0.25, 0.25, 0.5, 0.75, 1.0];

/// Difference of the held-out log-likelihood within which two single mechanisms are equivalent.
const SAME: f64 = 1.0;

impl Fitted {
    /// Fits the baseline alone. A fit that contradicts the prior may have ended in a local minimum: then it is repeated from other
    /// starting points, and the one with the smallest objective is returned.
    pub(super) fn baseline(problem: &impl Problem) -> Self {
        let from = |start: Point| Fitted::converged(problem, start, Vec::new());
        let first = from(problem.start());
        if first.agrees_with_prior() {
            return first;
        }
        let start_of =
            |point: Point| (objective(&believing(problem, problem.evidence_of(&point, &[]), &point, &[])), point);
        let mut starts: Vec<(f64, Point)> = problem.other_starts().into_iter().map(start_of).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let others = starts.into_iter().take(MOST_STARTS).map(|(_, point)| from(point));
        let left = |fitted: &Fitted| objective(&fitted.evidence);
        others.fold(first, |best, other| if left(&other) < left(&best) { other } else { best })
    }

    /// Returns whether the fitted parameters, taken together, agree with the prior.
    fn agrees_with_prior(&self) -> bool {
        self.probability_by_prior() >= SIGNIFICANT
    }

    /// Returns the probability that parameters drawn from the prior lie at least as far from its mean as the fitted ones.
    pub(super) fn probability_by_prior(&self) -> f64 {
        let prior = &self.evidence.prior;
        if prior.is_empty() { 1.0 } else { chance(belief_squares(&self.evidence), prior.len()) }
    }

    /// Fits each mechanism alone and in full, by ordinary least squares, and returns the one that predicts held-out data best. Far from the
    /// truth a linearisation misleads. Where this fit and all trials contradict the prior, the trials are repeated from the prior mean:
    /// the missing mechanism may have moved the baseline into a local minimum.
    pub(super) fn nonlinear_refit(&self, problem: &impl Problem) -> Option<Fitted> {
        if !problem.is_strongly_nonlinear() {
            return None;
        }
        let plain = plain_noises(&self.evidence);
        // Fall of the objective where the sum of squares of the quantity with the fewest rows is halved.
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
            let trial_of = |i: usize| {
                let evidence = believing(first, here.clone(), &start, &[i]);
                let mut trial = Fitted {
                    point: start.clone(),
                    included: vec![i],
                    evidence,
                    noises: plain.clone(),
                    lasting: self.lasting,
                };
                // At first all of the misfit counts as noise, and the prior has too much weight. The noise is estimated again from the
                // residuals until the objective no longer falls, or this mechanism clearly explains almost nothing.
                for _ in 0..MAX_NOISE_ROUNDS {
                    if trial.take_steps(first) < 1e-2 || objective(&trial.evidence) > before - PROMISING * half {
                        break;
                    }
                    trial.noises = plain_noises(&trial.evidence);
                }
                let size = trial.point.candidates[i][0];
                let is_possible = trial.is_possible(candidates) && !candidates[i].is_impossible(size);
                is_possible.then(|| {
                    trial.evaluate_all(first);
                    (objective(&trial.evidence), trial)
                })
            };
            let tried = (0..candidates.len()).into_par_iter().filter(|i| candidates[*i].version.is_none());
            trials.par_extend(tried.filter_map(trial_of));
        }
        // A trial must halve the sum of squares of one quantity, or the linearisation is as good. The best trials are compared on held-out
        // data.
        let halves_one = |trial: &Fitted| {
            let rms = |fitted: &Fitted, rows| holdout::rms(&fitted.evidence.residual, rows);
            let mut quantities = self.evidence.quantities.iter();
            quantities.any(|one| rms(trial, one.rows.clone()).powi(2) <= 0.5 * rms(self, one.rows.clone()).powi(2))
        };
        trials.retain(|(left, trial)| *left <= before && halves_one(trial));
        let least = trials.iter().map(|trial| trial.0).min_by(f64::total_cmp)?;
        // The evidence of a trial is that of the quicker problem, of which no fall in the problem itself may be counted.
        let converged = trials.into_par_iter().filter(|(left, _)| *left <= least + half).map(|(_, trial)| {
            let converged = Fitted::converged(problem, trial.point, trial.included);
            (converged.held_out_misfit(), converged)
        });
        let converged: Vec<(f64, Fitted)> = converged.collect();
        let least = converged.iter().map(|(left, _)| *left).min_by(f64::total_cmp)?;
        // Of equivalent trials the one with the fewest parameters is taken, then the first in the catalogue, which has the more frequent
        // mechanisms first.
        let as_good = converged.into_iter().filter(|(left, _)| *left < least + SAME).map(|(_, trial)| trial);
        as_good.min_by_key(|trial| {
            let parameters: usize = trial.included.iter().map(|i| candidates[*i].neutral.len()).sum();
            (parameters, trial.included.clone())
        })
    }

    /// Fits another set of members. In a strongly nonlinear model the linearised magnitudes may be far off. The fit starts at the point
    /// with the smallest objective among four: magnitudes linearised or as in this fit, with new members at neutral; baseline as
    /// in this fit or at the prior mean. `iteration` is that of this fit.
    pub(super) fn with_members(
        &self,
        problem: &impl Problem,
        iteration: &Iteration<'_>,
        members: Vec<usize>,
    ) -> Fitted {
        let linearised = iteration.point_of(&members, problem);
        let mut start = linearised.clone();
        if problem.is_strongly_nonlinear() {
            let mut current = self.point.clone();
            for (i, candidate) in problem.candidates().iter().enumerate().filter(|(i, _)| !members.contains(i)) {
                current.candidates[i].clone_from(&candidate.neutral);
            }
            let at_prior = |point: &Point| Point { baseline: problem.start().baseline, ..point.clone() };
            let starts = [at_prior(&linearised), at_prior(&current), linearised, current];
            let is_held = |member: &usize| problem.is_held_in_first_search(*member);
            let is_any_held = members.iter().chain(&self.included).any(is_held);
            let quicker = (!is_any_held).then(|| problem.for_first_search(&self.point)).flatten();
            start = likeliest(quicker.as_ref().unwrap_or(problem), starts, &members).unwrap_or(start);
        }
        Fitted::converged(problem, start, members)
    }

    /// Fits one mechanism beside this set from each of its starts; the likeliest stands. `iteration` is that of this fit.
    pub(super) fn with_one(&self, problem: &impl Problem, iteration: &Iteration<'_>, member: usize) -> Fitted {
        let members = self.members_with(member);
        let starts = self.starts_of_one(problem, iteration, member).into_iter();
        let fitted = starts.map(|start| Fitted::converged(problem, start, members.clone()));
        fitted.reduce(likelier).expect("one start at least")
    }

    /// The same in the place of a mechanism that another fit has beside this set, from that start alone that leads lowest with the noise of
    /// that fit. None where no first step promises a share of what that fit explains.
    pub(super) fn with_one_beside(
        &self,
        problem: &impl Problem,
        iteration: &Iteration<'_>,
        member: usize,
        other: &Fitted,
    ) -> Option<Fitted> {
        let members = self.members_with(member);
        let squares = |fitted: &Fitted| weighted_squares(&fitted.evidence, &other.noises);
        let most = squares(self) - PROMISING * (squares(self) - squares(other));
        let trial_at = |point: Point| {
            let evidence = believing(problem, problem.evidence_of(&point, &members), &point, &members);
            let (noises, lasting) = (other.noises.clone(), self.lasting);
            Fitted { point, included: members.clone(), evidence, noises, lasting }
        };
        let starts = self.starts_of_one(problem, iteration, member).into_iter().map(trial_at);
        let promising = starts.filter(|trial| trial.squares_after_a_step() < most);
        let descended = promising.map(|mut trial| {
            trial.take_steps(problem);
            trial
        });
        let lowest = descended.min_by(|a, b| squares(a).total_cmp(&squares(b)))?;
        Some(Fitted::converged(problem, lowest.point, members))
    }

    /// Where a fit of one mechanism beside this set may begin: at its linearised magnitude, and at the best of some usual ones on either side
    /// of neutral where the objective is smaller there; where the baseline contradicts what is believed, also at the best of these beside the
    /// baseline as it is believed. What is late has minima between which slopes do not tell.
    fn starts_of_one(&self, problem: &impl Problem, iteration: &Iteration<'_>, member: usize) -> Vec<Point> {
        let candidate = &problem.candidates()[member];
        let members = self.members_with(member);
        let usual = |about: &Point| {
            let with_size = |of_prior: f64| {
                let mut point = about.clone();
                point.candidates[member].clone_from(&candidate.neutral);
                point.candidates[member][0] += of_prior * candidate.prior_sd[0];
                point
            };
            let is_possible = |point: &Point| !candidate.is_impossible(point.candidates[member][0]);
            USUAL_SIZES.map(with_size).into_iter().filter(is_possible)
        };
        let linearised = iteration.point_of(&members, problem);
        let here = likeliest(problem, usual(&self.point).chain([linearised.clone()]), &members);
        let here = here.filter(|point| point.candidates[member] != linearised.candidates[member]);
        let as_believed = || Point { baseline: problem.start().baseline, ..self.point.clone() };
        let there = if self.agrees_with_prior() { None } else { likeliest(problem, usual(&as_believed()), &members) };
        [here, there, Some(linearised)].into_iter().flatten().collect()
    }

    fn members_with(&self, member: usize) -> Vec<usize> {
        let mut members = self.included.clone();
        members.push(member);
        members.sort_unstable();
        members
    }

    /// Returns the sets that contain the mechanism found by the nonlinear refit and predict no worse than this one, best first: that
    /// mechanism alone where this set is no larger, and this set with it in the place of each member.
    pub(super) fn rivals(&self, single: &Fitted, problem: &impl Problem) -> Vec<Fitted> {
        if self.included.iter().any(|member| single.included.contains(member)) {
            return Vec::new();
        }
        let exchanged = (0..self.included.len()).into_par_iter().filter(|_| self.included.len() > 1).map(|place| {
            let mut point = single.point.clone();
            let mut members = single.included.clone();
            for other in self.included.iter().enumerate().filter(|(i, _)| *i != place).map(|(_, other)| *other) {
                point.candidates[other].clone_from(&self.point.candidates[other]);
                members.push(other);
            }
            members.sort_unstable();
            Fitted::converged(problem, point, members)
        });
        let here = self.held_out();
        let is_no_worse = |rival: &Fitted| {
            holdout::advantage(&self.evidence, &self.noises, &rival.held_out(), &here) < problem.least_advantage()
        };
        let mut rivals: Vec<(f64, Fitted)> = exchanged
            .collect::<Vec<Fitted>>()
            .into_iter()
            .filter(|rival| rival.is_possible(problem.candidates()) && is_no_worse(rival))
            .chain(single.predicts_as_well_as(self).then(|| single.clone()))
            .map(|rival| (rival.held_out_misfit(), rival))
            .collect();
        rivals.sort_by(|a, b| a.0.total_cmp(&b.0));
        rivals.into_iter().map(|(_, rival)| rival).collect()
    }

    /// Returns whether it may stand in the place of another set: one of as many members if it is as likely, one of fewer if it predicts
    /// held-out data as well.
    pub(super) fn predicts_as_well_as(&self, other: &Fitted) -> bool {
        match self.included.len().cmp(&other.included.len()) {
            _ if self.included == other.included => false,
            Ordering::Less => false,
            Ordering::Equal => self.deviance_above(other) <= 0.0,
            Ordering::Greater => self.held_out_misfit() <= other.held_out_misfit(),
        }
    }

    /// Returns by how much it is less likely than another set: minus twice the logarithm of the ratio of likelihoods, each set with
    /// that noise of the two under which it is the likelier.
    pub(super) fn deviance_above(&self, other: &Fitted) -> f64 {
        let least = |fitted: &Fitted| {
            let under = |noises: &[Noise]| deviance(&fitted.evidence, noises);
            under(&self.noises).min(under(&other.noises))
        };
        least(self) - least(other)
    }
}

/// Returns the likelier of two fits, the first of equal ones.
fn likelier(a: Fitted, b: Fitted) -> Fitted {
    if b.deviance_above(&a) < 0.0 { b } else { a }
}

/// Returns the point with the smallest objective of those that a problem admits.
fn likeliest(problem: &impl Problem, starts: impl IntoIterator<Item = Point>, members: &[usize]) -> Option<Point> {
    // The objective needs no slopes along the members.
    let evidence = |point: &Point| believing(problem, problem.evidence_of(point, &[]), point, members);
    let admitted = starts.into_iter().filter(|point| problem.admits(point));
    let of = |point: Point| (objective(&evidence(&point)), point);
    admitted.map(of).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, point)| point)
}

/// Returns white noise with the variance of the residuals.
fn plain_noises(evidence: &Evidence) -> Vec<Noise> {
    let of = |quantity: &Quantity| {
        let stated: f64 = quantity.rows.clone().map(|row| evidence.stated_sd[row].powi(2)).sum();
        let misfit: f64 = quantity.rows.clone().map(|row| evidence.residual[row].powi(2)).sum();
        Noise { white: misfit / stated.max(f64::MIN_POSITIVE), ..noise::WHITE }
    };
    evidence.quantities.iter().map(of).collect()
}

/// Returns the negative log-likelihood of residuals and prior, with the white noise that fits best, up to a constant.
fn objective(evidence: &Evidence) -> f64 {
    let of =
        |quantity: &Quantity| quantity.rows.len() as f64 * holdout::rms(&evidence.residual, quantity.rows.clone()).ln();
    evidence.quantities.iter().map(of).sum::<f64>() + 0.5 * belief_squares(evidence)
}
