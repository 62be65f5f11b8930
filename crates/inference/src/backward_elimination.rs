//! What goes out of a fit again: mechanisms that do not predict, that chance explains, that need another size in another
//! regime, or one that nature does not have, that spoil what another quantity tells.

use nalgebra::DVector;

use super::evidence::{Headline, Problem, Quantity, names};
use super::findings::Why;
use super::fitted::{Fitted, weighted_squares};
use super::holdout;
use super::iteration::Iteration;
use super::regimes;
use super::replacements::in_place_of;
use super::subset_search::MARGIN;

/// Change of a mechanism's size from regime to regime, relative to it, from which on it is another mechanism; less may
/// be due to what the model leaves out.
const LEAST_CHANGE: f64 = 0.1;

/// Standard errors by which a mechanism must show on each leg where it is named on both: 95 %, one-sided.
const SHOWN_ON_A_LEG: f64 = 1.645;

/// By how much a quantity must be worse on data held out, at least, for what made it worse to be refused \[%\]: the fit of a
/// true cause, too, trades a little of one quantity for another.
const LEAST_SPOILT_PERCENT: f64 = 2.0;

/// Standard errors by which the sizes on the halves of the data, or on the legs, must differ: 1 in 400 by chance, the few that are
/// named being asked.
const SURELY_APART: f64 = 3.0;

/// Standard errors by which a size must lie beyond those that nature has: 95 %, one-sided.
const BEYOND_NATURE: f64 = 1.645;

/// Standard errors by which the variation of a mechanism alone, its mean set aside, must show it: 95 %.
const OWN_EVIDENCE: f64 = 2.0;

/// Standard errors by which a curve must predict better than what is named: 95 %, one-sided.
const BEATEN: f64 = 1.645;

/// Least evidence for such a change, beyond the cost of having looked for it everywhere: a factor of 4.
const LEAST_EXCESS: f64 = 3.0;

/// How much better the size of a mechanism must be known that stands beside one which explains more: on each half of the data as well
/// as a single one on the whole. What the larger law does not quite say, another small law may seem to.
const BESIDE_ANOTHER: f64 = std::f64::consts::SQRT_2;

impl Fitted {
    /// Drops everything that does not deserve its name; returns with what a refuted size goes. Once one has gone the others
    /// have other sizes, and may have been there for its sake alone: they are asked again, until all that are left stand.
    pub(super) fn eliminate_backward(
        &mut self,
        problem: &impl Problem,
        baseline: &Fitted,
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

    /// A mechanism that fits and does not predict is none: the one of least use goes, until all that are left predict.
    pub(super) fn drop_what_does_not_predict(&mut self, problem: &impl Problem, baseline: &Fitted) {
        while !self.included.is_empty() {
            let with = self.held_out();
            let advantage_over =
                |other: &Fitted| holdout::advantage(&self.evidence, &self.noises, &other.held_out(), &with);
            if advantage_over(baseline) < problem.least_advantage() {
                *self = baseline.clone();
                return;
            }
            let useless = (0..self.included.len())
                .map(|place| self.without(problem, baseline, place))
                .map(|other| (advantage_over(&other), other))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .filter(|(advantage, _)| *advantage < problem.least_advantage());
            match useless {
                Some((_, other)) => *self = other,
                None => return,
            }
        }
    }

    /// What chance could have brought, being one of so many that were tried, goes as well: the least likely last.
    pub(super) fn drop_what_chance_explains(&mut self, problem: &impl Problem, baseline: &Fitted) {
        let candidates = problem.candidates();
        let n_names = names(candidates).len() as f64;
        while !self.included.is_empty() {
            let iteration = Iteration::new(candidates, self);
            let p_value = |place: usize| {
                let mut fewer = self.included.clone();
                let tested = fewer.remove(place);
                n_names * iteration.chance(&fewer, &[tested])
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

    /// A law whose size is hardly known, by the noise or by the scatter between clusters, resembles too many others to be named.
    ///
    /// Far from neutral the model may be flat along a size that the data exclude at neutral: the polar follows a scale of the pitch. There
    /// the root of the likelihood ratio counts, which for a linear model is the size in its standard errors.
    pub(super) fn drop_what_is_hardly_known(&mut self, problem: &impl Problem, baseline: &Fitted) {
        while !self.included.is_empty() {
            let iteration = Iteration::new(problem.candidates(), self);
            let fit = iteration.score.fit(&iteration.search().columns(&self.included));
            let first_column = |place: usize| -> usize {
                self.included[..place].iter().map(|member| iteration.regressors[*member].columns.len()).sum()
            };
            let covariances = self.covariances();
            let n_baseline = self.evidence.baseline.ncols();
            // A standard error by so many clusters is itself uncertain; it counts as the larger where it is so for certain.
            let certain = 1.0 + 2.0 / (2.0 * covariances.clusters.max(2) as f64 - 2.0).sqrt();
            let known_by_clusters = |place: usize| {
                let column = first_column(place);
                let row = n_baseline + column;
                fit.step[column].abs() * certain / covariances.by_clusters[(row, row)].max(0.0).sqrt()
            };
            let known_by_slopes = |place: usize| {
                let column = first_column(place);
                (fit.step[column].abs() / fit.se(column)).min(known_by_clusters(place))
            };
            let search = iteration.search();
            let without = |place: usize| {
                let mut fewer = self.included.clone();
                fewer.remove(place);
                search.gain(&fewer)
            };
            let largest = (0..self.included.len()).min_by(|a, b| without(*a).total_cmp(&without(*b)));
            let asked = |place: usize| {
                problem.least_known(self.included[place]) * if Some(place) == largest { 1.0 } else { BESIDE_ANOTHER }
            };
            let known = |place: usize| {
                let by_slopes = known_by_slopes(place);
                if by_slopes >= asked(place) {
                    return by_slopes;
                }
                let by_likelihood = self.rise_without(problem, baseline, place).max(0.0).sqrt();
                by_slopes.max(by_likelihood.min(known_by_clusters(place)))
            };
            let hardly = (0..self.included.len())
                .map(|place| (known(place), place))
                .filter(|(known, place)| *known < asked(*place));
            match hardly.min_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((_, place)) => *self = self.without(problem, baseline, place),
                None => return,
            }
        }
    }

    /// By how much the weighted sum of squares rises where a member is left out and all else is fitted again, the noise being the same.
    fn rise_without(&self, problem: &impl Problem, baseline: &Fitted, place: usize) -> f64 {
        let mut other = self.without(problem, baseline, place);
        other.noises.clone_from(&self.noises);
        other.descend(problem);
        weighted_squares(&other.evidence, &other.noises) - weighted_squares(&self.evidence, &self.noises)
    }

    /// A mechanism that needs another size in another regime is another one: it goes, and what its size goes with is
    /// returned.
    pub(super) fn drop_what_needs_other_sizes(&mut self, problem: &impl Problem, baseline: &Fitted) -> Option<String> {
        let mut refuted = None;
        while problem.has_regimes() && !self.included.is_empty() {
            let included = self.regimes_included(problem);
            let found = regimes::misfits(&self.evidence, &self.noises, &included);
            let differs = |misfit: &regimes::Misfit| {
                let member = self.included[misfit.place];
                let size = self.point.candidates[member][0] - problem.candidates()[member].neutral[0];
                let mut others = self.included.clone();
                others.remove(misfit.place);
                let iteration = Iteration::new(problem.candidates(), self);
                let search = iteration.search();
                let worth = search.criterion(&others) - search.criterion(&self.included);
                let share = misfit.change.abs() / size.abs();
                // A column that the baseline nearly takes up may change by much and leave next to nothing: what counts then is the
                // share of the effect that one size leaves, which is the square of the change where nothing takes it up.
                let large = problem.large_change(member);
                let remainder = if problem.baseline_takes_up_changes() { large.powi(2) } else { 0.0 };
                let is_beyond = |part: f64| misfit.excess > LEAST_EXCESS.max(part * worth);
                is_beyond(problem.part_unexplained()) && share > LEAST_CHANGE || is_beyond(remainder) && share > large
            };
            let Some(worst) = found.into_iter().find(differs) else {
                break;
            };
            *self = self.without(problem, baseline, worst.place);
            refuted.get_or_insert(worst.with);
            // Something unknown is there, and may bring along a bit of many a mechanism: the others need more evidence of
            // their own than it has.
            self.drop_what_is_weak(problem, baseline, MARGIN.max(worst.excess));
        }
        refuted
    }

    /// A mechanism that may be absent on one of two legs may as well be something else on the other one: it goes, and so does
    /// one whose sizes on the legs differ for certain and by more than may stay unexplained. A mechanism with an onset is
    /// known by the data before it, and may be uncertain on one leg.
    pub(super) fn drop_what_one_leg_shows(&mut self, problem: &impl Problem, baseline: &Fitted) {
        while problem.needs_both_legs() {
            let included = self.regimes_included(problem);
            let is_of_one_leg = |place: &usize| {
                let version = problem.candidates()[self.included[*place]].version;
                let shown =
                    if version.is_some_and(|version| version.is_onset) { f64::NEG_INFINITY } else { SHOWN_ON_A_LEG };
                regimes::on_each_leg(&self.evidence, &self.noises, &included, *place)
                    .is_some_and(|legs| legs.disagree(shown, SURELY_APART, problem.part_unexplained()))
            };
            let Some(place) = (0..self.included.len()).find(is_of_one_leg) else { return };
            *self = self.without(problem, baseline, place);
        }
    }

    fn regimes_included(&self, problem: &impl Problem) -> Vec<regimes::Included<'_>> {
        let of = |member: &usize| {
            let (values, neutral) = (&self.point.candidates[*member], &problem.candidates()[*member].neutral);
            let sizes = DVector::from_iterator(values.len(), values.iter().zip(neutral).map(|(v, n)| v - n));
            regimes::Included { columns: &self.evidence.candidates[*member], sizes }
        };
        self.included.iter().map(of).collect()
    }

    /// A mechanism whose size differs between the halves of the data for certain, and by more than may stay unexplained, is another
    /// one.
    pub(super) fn drop_what_differs_on_halves(&mut self, problem: &impl Problem, baseline: &Fitted) {
        let differs = |fitted: &Fitted, place: usize| {
            let member = fitted.included[place];
            let candidate = &problem.candidates()[member];
            // What began at one time is not the same before and after it.
            candidate.version.is_none_or(|version| !version.is_onset)
                && match fitted.halves(problem, place).as_slice() {
                    [a, b] => {
                        let size = [a, b].map(|half| half.value - candidate.neutral[0]);
                        let halves =
                            regimes::OnParts { size, variance: [a, b].map(|half| half.se.powi(2)), covariance: 0.0 };
                        halves.differ(SURELY_APART, problem.part_unexplained())
                    }
                    _ => false,
                }
        };
        while problem.has_regimes() {
            let Some(place) = (0..self.included.len()).find(|place| differs(self, *place)) else { return };
            *self = self.without(problem, baseline, place);
        }
    }

    /// What needs a size that nature does not have is something else that resembles it: it goes, whatever takes its place not
    /// being asked for. So does a mechanism of unusual size that is not the only explanation.
    pub(super) fn drop_what_cannot_be(&mut self, problem: &impl Problem, baseline: &Fitted) {
        let cannot_be = |fitted: &Fitted, place: usize| {
            let member = fitted.included[place];
            let (candidate, values) = (&problem.candidates()[member], &fitted.point.candidates[member]);
            candidate.is_impossible(values[0]) && fitted.is_impossible_for_certain(problem, place)
                || !problem.exists(member, values)
                || candidate.is_unusual(values[0]) && !fitted.is_the_only_explanation(problem, baseline, place)
        };
        while let Some(place) = (0..self.included.len()).find(|place| cannot_be(self, *place)) {
            *self = self.without(problem, baseline, place);
        }
    }

    /// Whether a size lies further beyond those that nature has than its error explains.
    fn is_impossible_for_certain(&self, problem: &impl Problem, place: usize) -> bool {
        let candidates = problem.candidates();
        let member = self.included[place];
        let ([low, high], value) = (candidates[member].possible, self.point.candidates[member][0]);
        let row = self.first_parameter(candidates, place);
        (low - value).max(value - high) > BEYOND_NATURE * self.covariances().by_model[(row, row)].max(0.0).sqrt()
    }

    /// Whether no mechanism of a usual size predicts as well in the place of this one, no other has an unusual size too, and no relevant
    /// misfit is left: an unusual size is accepted only of a mechanism that explains all of the misfit. A size that another channel
    /// shows is not contradicted.
    fn is_the_only_explanation(&self, problem: &impl Problem, baseline: &Fitted, place: usize) -> bool {
        let candidates = problem.candidates();
        let iteration = Iteration::new(candidates, self);
        let is_unusual = |member: &&usize| candidates[**member].is_unusual(self.point.candidates[**member][0]);
        candidates[self.included[place]].shown.is_none()
            && self.included.iter().filter(is_unusual).count() == 1
            && !iteration.is_anything_wrong(&self.included, &self.limits(problem))
            && in_place_of(problem, baseline, self, place).is_empty()
    }

    /// A law that these data could not contradict has no name of its own.
    pub(super) fn drop_what_is_untested(&mut self, problem: &impl Problem, baseline: &Fitted) {
        while let Some(place) = self.included.iter().position(|member| !problem.is_tested(*member)) {
            *self = self.without(problem, baseline, place);
        }
    }

    /// What improves one quantity and spoils another did not happen, nor what for certain leaves more of the quantity of which its
    /// gain is reported: it goes, the worst spoiler first.
    pub(super) fn drop_what_spoils(&mut self, problem: &impl Problem, baseline: &Fitted) {
        let most = |quantity: usize| match problem.headline() {
            Headline::First if quantity == 0 => 0.0,
            _ => LEAST_SPOILT_PERCENT,
        };
        while self.evidence.quantities.len() > 1 && !self.included.is_empty() {
            let with = self.held_out();
            // By how much a quantity is worse for it at the least, as far as these data tell, beyond what may be traded [%].
            let spoils = |other: &Fitted| -> f64 {
                let before = other.held_out();
                let least = |(place, quantity): (usize, &Quantity)| {
                    let rows = quantity.rows.clone();
                    -holdout::reduction_interval(&self.evidence.block, rows, &before, &with)[1] - most(place)
                };
                self.evidence.quantities.iter().enumerate().map(least).fold(f64::NEG_INFINITY, f64::max)
            };
            let worst = (0..self.included.len())
                .map(|place| self.without(problem, baseline, place))
                .map(|other| (spoils(&other), other))
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
            let column: usize = with[..place].iter().map(|i| iteration.regressors[*i].columns.len()).sum();
            let has_own_evidence = fit.step[column].abs() > OWN_EVIDENCE * fit.se(column);
            let mut exchanged = self.included.clone();
            exchanged[place] = level;
            exchanged.sort_unstable();
            let is_as_good = search.criterion(&exchanged) <= search.criterion(&self.included) + MARGIN;
            if has_own_evidence || !is_as_good {
                continue;
            }
            let mut other = Fitted::new(problem, iteration.point_of(&exchanged, problem), exchanged);
            other.converge(problem);
            if other.is_possible(problem.candidates()) {
                *self = other;
                return;
            }
        }
    }

    /// A law that is the right one predicts better than a curve that only resembles it. Where the best curve alone predicts
    /// held-out data better than the named mechanisms for certain, and explains more by the part that may stay unexplained beside
    /// a name, these resemble something unknown: they go, and what the curve runs along is returned. A curve that predicts better
    /// for certain by next to nothing has only taken up what no law explains.
    pub(super) fn drop_what_a_curve_beats(&mut self, problem: &impl Problem, baseline: &Fitted) -> Option<String> {
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
        let covariate = iteration.curve_name(curve).map(str::to_owned);
        *self = baseline.clone();
        covariate
    }

    /// What changes no quantity by enough to act on goes, the smallest first.
    pub(super) fn drop_what_is_irrelevant(&mut self, problem: &impl Problem, baseline: &Fitted) {
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
    /// good is no error of the predictions.
    fn smallest_by_what_is_missed(&self, problem: &impl Problem, baseline: &Fitted, limits: &[f64]) -> Option<Fitted> {
        let iteration = Iteration::new(problem.candidates(), self);
        let here = self.evidence.column_as_read(&self.held_out());
        let missed = |place: usize| {
            let other = self.without(problem, baseline, place);
            let there = self.evidence.column_as_read(&other.held_out());
            let quantities = self.evidence.quantities.iter().zip(limits);
            let of_quantity = |(quantity, limit): (&Quantity, &f64)| {
                let rows = iteration.rows_of(self.included[place], quantity);
                let square = |held_out: &DVector<f64>| holdout::rms(held_out, rows.iter().copied()).powi(2);
                (square(&there) - square(&here)) / limit.powi(2)
            };
            (quantities.map(of_quantity).fold(0.0, f64::max), other)
        };
        let missed = (0..self.included.len()).map(missed);
        missed.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(share, _)| *share <= 1.0).map(|(_, other)| other)
    }

    /// The fit without the member whose largest effect on a row is below every limit, if the others then leave no more by as much.
    fn smallest_by_slopes(&self, problem: &impl Problem, baseline: &Fitted, limits: &[f64]) -> Option<Fitted> {
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

    /// Several that change much beside each other and little beside the baseline, each alone and all together, undo each other: what
    /// they leave of the misfit was never worth acting on.
    fn drop_what_only_undoes_each_other(&mut self, problem: &impl Problem, baseline: &Fitted) {
        if self.included.len() < 2 {
            return;
        }
        // By the slopes at the baseline: theirs here, far from it, mislead.
        let iteration = Iteration::new(problem.candidates(), baseline);
        let limits = self.limits(problem);
        let is_relevant = |sizes: Vec<f64>| sizes.iter().zip(&limits).any(|(size, limit)| size > limit);
        let any_alone = self.included.iter().any(|member| is_relevant(iteration.size_where_it_acts(&[], *member)));
        let together = self.leaves_less_than(baseline, &limits);
        if !any_alone && !together {
            *self = baseline.clone();
        }
    }

    /// Whether the rms of what is left falls by more than the limit of a quantity, in quadrature, from another fit to this one.
    fn leaves_less_than(&self, other: &Fitted, limits: &[f64]) -> bool {
        let [there, here] = [other, self].map(|fitted| fitted.evidence.column_as_read(&fitted.evidence.residual));
        let quantities = self.evidence.quantities.iter().zip(limits);
        quantities.into_iter().any(|(quantity, limit)| {
            let square = |left: &DVector<f64>| holdout::rms(left, quantity.rows.clone()).powi(2);
            square(&there) - square(&here) > limit.powi(2)
        })
    }

    /// Only what is worth more than so much of the criterion stays.
    pub(super) fn drop_what_is_weak(&mut self, problem: &impl Problem, baseline: &Fitted, needed: f64) {
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
    pub(super) fn without(&self, problem: &impl Problem, baseline: &Fitted, place: usize) -> Fitted {
        let mut fewer = self.included.clone();
        let gone = fewer.remove(place);
        if fewer.is_empty() {
            return baseline.clone();
        }
        let mut point = self.point.clone();
        point.candidates[gone].clone_from(&problem.candidates()[gone].neutral);
        let mut other = Fitted::new(problem, point, fewer);
        other.converge(problem);
        other
    }
}
