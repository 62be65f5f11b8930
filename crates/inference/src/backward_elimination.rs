//! Backward elimination in its order: mechanisms that do not predict held-out data, that chance explains, whose magnitude is implausible
//! (`magnitude_tests`), that make another quantity worse, that are irrelevant (`relevance_tests`).

use rayon::prelude::*;

use super::baseline::Baseline;
use super::evidence::{Headline, Problem, Quantity, names};
use super::findings::Why;
use super::fitted::Fitted;
use super::holdout;
use super::iteration::Iteration;
use super::subset_search::MARGIN;

/// By how much a quantity must be worse on data held out, at least, for what made it worse to be refused \[%\]: the fit of a
/// true cause, too, trades a little of one quantity for another.
pub(super) const LEAST_SPOILT_PERCENT: f64 = 2.0;

/// Standard errors by which the variation of a mechanism alone, its mean set aside, must show it: 95 %.
const OWN_EVIDENCE: f64 = 2.0;

/// Standard errors by which a curve must predict better than what is named: 95 %, one-sided.
const BEATEN: f64 = 1.645;

impl Fitted {
    /// Drops everything that does not deserve its name; returns with what a refuted size goes. Once one has gone the others
    /// have other sizes, and may have been there for its sake alone: they are asked again, until all that are left stand.
    pub(super) fn eliminate_backward(
        &mut self,
        problem: &impl Problem,
        baseline: &Baseline,
        dropped: &mut Vec<(usize, Why)>,
    ) -> Option<String> {
        let mut refuted = None;
        loop {
            let before = self.included.len();
            let mut note = |fitted: &Fitted, had: &[usize], why: Why| {
                let gone = had.iter().filter(|member| !fitted.included.contains(member));
                dropped.extend(gone.map(|member| (*member, why)));
                fitted.included.clone()
            };
            let had = self.included.clone();
            self.drop_what_does_not_predict(problem, baseline);
            let had = note(self, &had, Why::PredictsNoBetter);
            self.drop_what_chance_explains(problem, baseline);
            let had = note(self, &had, Why::ByChance);
            self.drop_what_is_hardly_known(problem, baseline);
            let had = note(self, &had, Why::HardlyKnown);
            refuted = refuted.or(self.drop_what_needs_other_sizes(problem, baseline));
            self.drop_what_differs_on_halves(problem, baseline);
            self.drop_what_one_leg_shows(problem, baseline);
            let had = note(self, &had, Why::SizeVaries);
            self.drop_what_cannot_be(problem, baseline);
            let had = note(self, &had, Why::SizeImpossible);
            self.drop_what_is_untested(problem, baseline);
            let had = note(self, &had, Why::Equivalent);
            self.drop_what_spoils(problem, baseline);
            let had = note(self, &had, Why::SpoilsQuantity);
            self.take_levels_for_what_they_are(problem);
            let had = note(self, &had, Why::Equivalent);
            self.drop_what_is_irrelevant(problem, baseline);
            let had = note(self, &had, Why::PredictsNoBetter);
            refuted = refuted.or(self.drop_what_a_curve_beats(problem, baseline));
            note(self, &had, Why::PredictsNoBetter);
            if self.included.len() == before {
                return refuted;
            }
        }
    }

    /// A mechanism that fits and does not predict is none: the one of least use goes, until all that are left predict. Where all of them
    /// together predict no better than the baseline, the one without which the others predict best goes: what is spurious may spoil what
    /// a true one predicts.
    pub(super) fn drop_what_does_not_predict(&mut self, problem: &impl Problem, baseline: &Baseline) {
        while !self.included.is_empty() {
            let with = self.held_out();
            let advantage_over =
                |other: &Fitted| holdout::advantage(&self.evidence, &self.noises, &other.held_out(), &with);
            let is_useless_together = advantage_over(baseline) < problem.least_advantage();
            let without = |place: usize| {
                let other = self.without(problem, baseline, place);
                (advantage_over(&other), other)
            };
            let others: Vec<(f64, Fitted)> = (0..self.included.len()).into_par_iter().map(without).collect();
            let useless = others
                .into_iter()
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .filter(|(advantage, _)| is_useless_together || *advantage < problem.least_advantage());
            match useless {
                Some((_, other)) => *self = other,
                None => return,
            }
        }
    }

    /// What chance could have brought, being one of so many that were tried, goes as well: the least likely last.
    pub(super) fn drop_what_chance_explains(&mut self, problem: &impl Problem, baseline: &Baseline) {
        let candidates = problem.candidates();
        let n_names = names(candidates).len() as f64;
        while !self.included.is_empty() {
            let iteration = Iteration::new(candidates, self);
            let p_value = |place: usize| {
                let mut fewer = self.included.clone();
                let tested = fewer.remove(place);
                let by_slopes = n_names * iteration.chance(&fewer, &[tested]);
                if by_slopes <= problem.most_chance() {
                    return by_slopes;
                }
                // Without the member the polar may end far from here, where the slopes taken here say little.
                let rise = self.rise_without(problem, baseline, place);
                by_slopes.min(n_names * iteration.chance_of_rise(rise, &fewer, &[tested]))
            };
            let worst = (0..self.included.len())
                .map(|place| (p_value(place), place))
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .filter(|(p_value, _)| *p_value > problem.most_chance());
            match worst {
                Some((_, place)) => *self = self.without(problem, baseline, place),
                None => return,
            }
        }
    }

    /// A law that these data could not contradict has no name of its own.
    pub(super) fn drop_what_is_untested(&mut self, problem: &impl Problem, baseline: &Baseline) {
        while let Some(place) = self.included.iter().position(|member| !problem.is_tested(*member)) {
            *self = self.without(problem, baseline, place);
        }
    }

    /// What improves one quantity and spoils another did not happen, nor what for certain leaves more of the quantity of which its
    /// gain is reported: it goes, the worst spoiler first. So does what changes the predictions of that quantity by enough to act on, and
    /// leaves more of it: what it changes there did not show.
    pub(super) fn drop_what_spoils(&mut self, problem: &impl Problem, baseline: &Baseline) {
        let is_headline = |quantity: usize| problem.headline() == Headline::First && quantity == 0;
        let most = |quantity: usize| if is_headline(quantity) { 0.0 } else { LEAST_SPOILT_PERCENT };
        while self.evidence.quantities.len() > 1 && !self.included.is_empty() {
            let with = self.held_out();
            let limits = self.limits(problem);
            let iteration = Iteration::new(problem.candidates(), self);
            let changes_enough = |place: usize, quantity: usize| {
                let mut others = self.included.clone();
                let member = others.remove(place);
                iteration.changes(&others, &[member])[quantity] > limits[quantity]
            };
            // By how much a quantity is worse without being traded, at the least as far as these data tell [%].
            let spoils = |place: usize, other: &Fitted| -> f64 {
                let before = other.held_out();
                let least = |(i, quantity): (usize, &Quantity)| {
                    let rows = || quantity.rows.clone();
                    let [rms_before, rms_with] = [&before, &with].map(|left| holdout::rms(left, rows()));
                    if is_headline(i) && rms_with > rms_before && changes_enough(place, i) {
                        return -holdout::reduction_percent(rms_before, rms_with);
                    }
                    -holdout::reduction_interval(&self.evidence.block, rows(), &before, &with)[1] - most(i)
                };
                self.evidence.quantities.iter().enumerate().map(least).fold(f64::NEG_INFINITY, f64::max)
            };
            let without = |place: usize| {
                let other = self.without(problem, baseline, place);
                (spoils(place, &other), other)
            };
            let others: Vec<(f64, Fitted)> = (0..self.included.len()).into_par_iter().map(without).collect();
            let worst = others
                .into_iter()
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .filter(|(spoilt_percent, _)| *spoilt_percent > 0.0);
            match worst {
                Some((_, other)) => *self = other,
                None => return,
            }
        }
    }

    /// What goes with temperature or pressure has a mean, and the mean is an offset. A mechanism whose variation alone says
    /// nothing of its size is that offset in disguise, and gives its place to it.
    pub(super) fn take_levels_for_what_they_are(&mut self, problem: &impl Problem) {
        for place in 0..self.included.len() {
            let member = self.included[place];
            let Some(level) = problem.level_of(member).filter(|level| !self.included.contains(level)) else { continue };
            let iteration = Iteration::new(problem.candidates(), self);
            let search = iteration.search();
            let with: Vec<usize> = self.included.iter().copied().chain([level]).collect();
            let fit = iteration.score.fit(&search.columns(&with));
            let column = search.columns(&with[..place]).len();
            let has_own_evidence = fit.step[column].abs() > OWN_EVIDENCE * fit.se(column);
            let mut exchanged = self.included.clone();
            exchanged[place] = level;
            exchanged.sort_unstable();
            let is_as_good = search.criterion(&exchanged) <= search.criterion(&self.included) + MARGIN;
            if has_own_evidence || !is_as_good {
                continue;
            }
            let other = Fitted::converged(problem, iteration.point_of(&exchanged, problem), exchanged);
            if other.is_possible(problem.candidates()) {
                *self = other;
                return;
            }
        }
    }

    /// A law that is the right one predicts better than a curve that only resembles it. Where the best curve alone predicts
    /// held-out data better than the named mechanisms for certain, and explains more by the part that may stay unexplained beside
    /// a name, these resemble something unknown: they go, and what the curve runs along is returned. A curve that predicts better
    /// for certain by next to nothing has only taken up what no law explains. So has one beside the mean of a quantity that removes nearly
    /// all of a gross misfit: against noise that lasts a mean counts little, and a curve in what little is left much.
    pub(super) fn drop_what_a_curve_beats(&mut self, problem: &impl Problem, baseline: &Baseline) -> Option<String> {
        if !problem.has_regimes() || self.included.is_empty() {
            return None;
        }
        let iteration = Iteration::new(problem.candidates(), self);
        let curve = iteration.most_explaining_curve()?;
        let search = iteration.search();
        let (by_names, by_curve) = (search.gain(&self.included), search.gain(&[curve]));
        let explains_more = by_curve - by_names > problem.part_unexplained() * by_names;
        if !explains_more || iteration.advantage(&[curve], &self.included) < BEATEN {
            return None;
        }
        let is_mean = self.included.iter().all(|member| problem.is_mean_of_a_quantity(*member));
        if is_mean && self.removes_nearly_all(baseline) {
            return None;
        }
        let covariate = iteration.curve_name(curve).map(str::to_owned);
        *self = Fitted::clone(baseline);
        covariate
    }

    /// Only what is worth more than so much of the criterion stays.
    pub(super) fn drop_what_is_weak(&mut self, problem: &impl Problem, baseline: &Baseline, needed: f64) {
        while !self.included.is_empty() {
            let iteration = Iteration::new(problem.candidates(), self);
            let search = iteration.search();
            let here = search.criterion(&self.included);
            let worth = |place: usize| {
                let mut fewer = self.included.clone();
                fewer.remove(place);
                search.criterion(&fewer) - here
            };
            let weakest = (0..self.included.len()).min_by(|a, b| worth(*a).total_cmp(&worth(*b)));
            let Some(place) = weakest.filter(|place| worth(*place) < needed) else {
                return;
            };
            *self = self.without(problem, baseline, place);
        }
    }

    /// The fit of the same set less one member.
    pub(super) fn without(&self, problem: &impl Problem, baseline: &Baseline, place: usize) -> Fitted {
        let mut fewer = self.included.clone();
        let gone = fewer.remove(place);
        if fewer.is_empty() {
            return Fitted::clone(baseline);
        }
        let mut point = self.point.clone();
        point.candidates[gone].clone_from(&problem.candidates()[gone].neutral);
        baseline.converged(problem, point, fewer)
    }
}
