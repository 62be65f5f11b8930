//! Tests of relevance in the backward elimination: mechanisms whose effect is too small to act on, or that cancel each other.

use nalgebra::DVector;
use rayon::prelude::*;

use super::baseline::Baseline;
use super::evidence::{Problem, Quantity};
use super::fitted::{Fitted, weighted};
use super::holdout;
use super::iteration::Iteration;
use super::score::{CLEARLY_WRONG, SIGNIFICANT};

/// Share of what several mechanisms explain that one of them must explain alone. Of two that do not oppose each other one explains a half, at
/// least; with a half of that they mostly cancel.
const OPPOSED: f64 = 0.25;

impl Fitted {
    /// Drops mechanisms whose effect on every quantity is below the limit of relevance, the smallest first.
    pub(super) fn drop_what_is_irrelevant(&mut self, problem: &impl Problem, baseline: &Baseline) {
        while !self.included.is_empty() {
            let limits = self.limits(problem);
            let smallest = if problem.judges_largest() {
                self.smallest_by_slopes(problem, baseline, &limits)
            } else {
                self.smallest_by_what_is_missed(problem, baseline, &limits)
            };
            match smallest {
                Some(other) => *self = other,
                None => break,
            }
        }
        self.drop_what_only_undoes_each_other(problem, baseline);
    }

    /// The fit without the member whose loss the others make good best, once all are fitted again: no held-out reading would be missed by
    /// more than the limit of its quantity, in quadrature and over the rows in which it acts. Its own size says less: what a polar makes
    /// good is no error of the predictions. A member whose loss the others make good with parameters that the prior excludes is not lost:
    /// in a log with little noise a current of metres per second can do what a ballast offset does.
    fn smallest_by_what_is_missed(
        &self,
        problem: &impl Problem,
        baseline: &Baseline,
        limits: &[f64],
    ) -> Option<Fitted> {
        let iteration = Iteration::new(problem.candidates(), self);
        let here = self.evidence.column_as_read(&self.held_out());
        let missed = |place: usize| {
            let other = self.without(problem, baseline, place);
            let there = self.evidence.column_as_read(&other.held_out());
            if self.probability_by_prior() >= SIGNIFICANT && other.probability_by_prior() < CLEARLY_WRONG {
                return (f64::INFINITY, other);
            }
            let missed = self.missed(&iteration, self.included[place], [&here, &there]);
            (missed.iter().zip(limits).map(|(size, limit)| size / limit).fold(0.0, f64::max), other)
        };
        let missed: Vec<(f64, Fitted)> = (0..self.included.len()).into_par_iter().map(missed).collect();
        missed.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(share, _)| *share <= 1.0).map(|(_, other)| other)
    }

    /// The fit without the member whose largest effect on a row is below every limit, if the others then leave no more by as much.
    fn smallest_by_slopes(&self, problem: &impl Problem, baseline: &Baseline, limits: &[f64]) -> Option<Fitted> {
        let iteration = Iteration::new(problem.candidates(), self);
        // The largest effect of one member in units of the limit of its quantity.
        let worth = |place: usize| {
            let mut fewer = self.included.clone();
            let member = fewer.remove(place);
            let sizes = iteration.largest(&fewer, &[member]);
            sizes.iter().zip(limits).map(|(size, limit)| size / limit).fold(0.0, f64::max)
        };
        let mut small: Vec<(f64, usize)> =
            (0..self.included.len()).map(|place| (worth(place), place)).filter(|(worth, _)| *worth <= 1.0).collect();
        small.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Far from the fit the slopes mislead: what the others make of the data without it decides.
        let mut fitted_again = small.into_iter().map(|(_, place)| self.without(problem, baseline, place));
        fitted_again.find(|other| !self.leaves_less_than(other, limits))
    }

    /// Drops mechanisms that cancel each other: neither one alone nor all together are relevant beside the baseline, or no one alone explains
    /// a fair share of what all of them do. One unknown law that large opposite effects imitate is more frequent than independent faults
    /// that happen to cancel.
    fn drop_what_only_undoes_each_other(&mut self, problem: &impl Problem, baseline: &Baseline) {
        if self.included.len() < 2 {
            return;
        }
        // By the slopes at the baseline: theirs here, far from it, mislead.
        let iteration = Iteration::new(problem.candidates(), baseline);
        let limits = self.limits(problem);
        let is_relevant = |sizes: Vec<f64>| sizes.iter().zip(&limits).any(|(size, limit)| size > limit);
        let any_alone = || self.included.iter().any(|member| is_relevant(iteration.size_where_it_acts(&[], *member)));
        let together = || self.leaves_less_than(baseline, &limits);
        let left_by = |fitted: &Fitted| weighted(&fitted.evidence, &self.noises, &fitted.evidence.residual);
        let (by_none, by_all) = (left_by(baseline), left_by(self));
        let explains_a_share =
            |place: usize| by_none - left_by(&self.alone(problem, place)) > OPPOSED * (by_none - by_all);
        if !(any_alone() || together()) || !(0..self.included.len()).any(explains_a_share) {
            *self = Fitted::clone(baseline);
        }
    }

    /// The fit of one member alone.
    fn alone(&self, problem: &impl Problem, place: usize) -> Fitted {
        let member = self.included[place];
        let mut point = self.point.clone();
        for other in self.included.iter().filter(|other| **other != member) {
            point.candidates[*other].clone_from(&problem.candidates()[*other].neutral);
        }
        let mut alone = Fitted::new(problem, point, vec![member]);
        alone.converge(problem);
        alone
    }

    /// Whether the rms of what is left falls by more than the limit of a quantity, in quadrature, from another fit to this one.
    fn leaves_less_than(&self, other: &Fitted, limits: &[f64]) -> bool {
        let [there, here] = [other, self].map(|fitted| fitted.evidence.column_as_read(&fitted.evidence.residual));
        holdout::leaves_relevantly_more(&self.evidence, limits, [&there, &here])
    }

    /// By how much held-out readings of each quantity are missed more in the second of two fits, as read: in quadrature, zero where they are
    /// missed less. Over the rows in which a member acts or over all of them, whichever is more: what accumulates is missed most where it
    /// does not act yet, since the baseline has its mean.
    pub(super) fn missed(&self, iteration: &Iteration<'_>, member: usize, held_out: [&DVector<f64>; 2]) -> Vec<f64> {
        let over = |rows: Vec<usize>| {
            let [here, there] = held_out.map(|held_out| holdout::rms(held_out, rows.iter().copied()).powi(2));
            (there - here).max(0.0).sqrt()
        };
        let of_quantity =
            |quantity: &Quantity| over(iteration.rows_of(member, quantity)).max(over(quantity.rows.clone().collect()));
        self.evidence.quantities.iter().map(of_quantity).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::Toy;
    use super::*;

    /// A leak acts on the last nine tenths of the record by a tenth or more of its largest effect. What the first tenth is missed by more
    /// without it counts too.
    #[test]
    fn what_is_missed_before_a_mechanism_acts_counts() {
        let toy = Toy::new(1, |_, _| 0.0);
        let leak = toy.candidates().iter().position(|candidate| candidate.name == "leak").expect("a candidate");
        let fitted = Fitted::new(&toy, toy.start(), vec![leak]);
        let iteration = Iteration::new(toy.candidates(), &fitted);
        let acts_on = iteration.rows_of(leak, &fitted.evidence.quantities[0]);
        let n = fitted.evidence.residual.len();
        let with = DVector::from_element(n, 1.0);
        let without = DVector::from_fn(n, |row, _| if acts_on.contains(&row) { 1.0 } else { 3.0 });
        let missed = fitted.missed(&iteration, leak, [&with, &without])[0];
        // Squares of 9 for 1 in a tenth of the rows.
        assert!((0.08..0.12).contains(&(1.0 - acts_on.len() as f64 / n as f64)), "{}", acts_on.len());
        assert!((missed - 0.8_f64.sqrt()).abs() < 0.05, "{missed}");
    }
}
