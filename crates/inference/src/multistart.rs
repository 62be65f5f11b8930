//! Where a fit begins: the baseline from other points where it contradicts what is believed, and each mechanism fitted in full,
//! alone, where the model bends, with the sets that hold the one found so. Names nothing.

use super::evidence::{Evidence, Point, Problem, Quantity};
use super::fitted::{Fitted, belief_squares, believing, noises};
use super::holdout;
use super::iteration::Iteration;
use super::score::{SIGNIFICANT, chance};
use crate::noise::{self, Noise};

/// Alternations of a mechanism's fit and its noise, at most.
const MAX_TRIAL_ROUNDS: usize = 4;

/// Other points from which a baseline is fitted, those first that leave least as they are.
const MOST_STARTS: usize = 3;

/// Part of what a mechanism fitted alone must explain that it explains at first, while all of the misfit counts as noise.
const PROMISING: f64 = 0.1;

/// Difference of the logarithm of the held-out likelihood within which two single mechanisms are as good as each other.
const SAME: f64 = 1.0;

impl Fitted {
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
                for _ in 0..MAX_TRIAL_ROUNDS {
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

    /// Other members fitted from here. Where the model bends, the sizes that the slopes give may lie far off: the fit begins at the best
    /// of several points, with these sizes or those of here, what is new at neutral, and with the baseline of here or the believed one.
    pub(super) fn with_members(&self, problem: &impl Problem, members: Vec<usize>) -> Fitted {
        let by_slopes = Iteration::new(problem.candidates(), self).point_of(&members, problem);
        let mut start = by_slopes.clone();
        if problem.bends() {
            let mut as_here = self.point.clone();
            for (i, candidate) in problem.candidates().iter().enumerate().filter(|(i, _)| !members.contains(i)) {
                as_here.candidates[i].clone_from(&candidate.neutral);
            }
            let believed = |point: &Point| Point { baseline: problem.start().baseline, ..point.clone() };
            let starts = [believed(&by_slopes), believed(&as_here), by_slopes, as_here];
            let of = |point: Point| (objective(&believing(problem, problem.evidence(&point), &point, &members)), point);
            let best =
                starts.into_iter().filter(|point| problem.admits(point)).map(of).min_by(|a, b| a.0.total_cmp(&b.0));
            start = best.map_or(start, |(_, point)| point);
        }
        let mut fitted = Fitted::new(problem, start, members);
        fitted.converge(problem);
        fitted
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
}

/// White noise as large as what is left.
fn plain_noises(evidence: &Evidence) -> Vec<Noise> {
    let of = |quantity: &Quantity| {
        let stated: f64 = quantity.rows.clone().map(|row| evidence.stated_sd[row].powi(2)).sum();
        let misfit: f64 = quantity.rows.clone().map(|row| evidence.residual[row].powi(2)).sum();
        Noise { white: misfit / stated.max(f64::MIN_POSITIVE), ..noise::WHITE }
    };
    evidence.quantities.iter().map(of).collect()
}

/// Less the logarithm of the likelihood of what is left with white noise of any size, and of the beliefs, up to a constant.
fn objective(evidence: &Evidence) -> f64 {
    let of =
        |quantity: &Quantity| quantity.rows.len() as f64 * holdout::rms(&evidence.residual, quantity.rows.clone()).ln();
    evidence.quantities.iter().map(of).sum::<f64>() + 0.5 * belief_squares(evidence)
}
