//! Tests of a mechanism's magnitude in the backward elimination: too uncertain; different in another regime, on one leg or on half of
//! the data; physically impossible.

use nalgebra::DVector;

use super::baseline::Baseline;
use super::evidence::Problem;
use super::fitted::{Fitted, weighted_squares};
use super::iteration::Iteration;
use super::regimes;
use super::replacements::in_place_of;
use super::subset_search::MARGIN;

/// Change of a mechanism's size from regime to regime, relative to it, from which on it is another mechanism; less may
/// be due to what the model leaves out.
const LEAST_CHANGE: f64 = 0.1;

/// Standard errors by which a mechanism must show on each leg where it is named on both: 95 %, one-sided.
const SHOWN_ON_A_LEG: f64 = 1.645;

/// Standard errors by which one leg must show a mechanism that the other does not, nothing else being wrong: another law of that leg is
/// mistaken for it only if the effects have a correlation of 0.99. They differ by `sqrt(1 - 0.99^2)`, which three standard errors show.
const SHOWN_BY_ONE_LEG: f64 = 21.0;

/// Standard errors by which the sizes on the halves of the data, or on the legs, must differ: 1 in 400 by chance, the few that are
/// named being tested.
const SURELY_APART: f64 = 3.0;

/// Parts of the record on which a size is asked for: what comes for a tenth of the time fills half of one.
const PARTS_OF_TIME: usize = 6;

/// The probability of sizes that vary as much by chance: that of [`SURELY_APART`] standard errors.
const CHANCE_OF_PARTS: f64 = 1.0 / 400.0;

/// Standard errors by which a size must lie beyond those that nature has: 95 %, one-sided.
const BEYOND_NATURE: f64 = 1.645;

/// Smallest log-likelihood excess for such a change, beyond the cost of the search over covariates: a factor of 4.
const LEAST_EXCESS: f64 = 3.0;

/// Factor on the required certainty of a mechanism beside one that explains more, so that each half of the data knows it as well as the
/// whole knows a single one: a small error of the larger mechanism may look like another mechanism.
const BESIDE_ANOTHER: f64 = std::f64::consts::SQRT_2;

impl Fitted {
    /// A law whose size is hardly known, by the noise or by the scatter between clusters, resembles too many others to be named.
    ///
    /// Far from neutral the model may be flat along a size that the data exclude at neutral: the polar follows a scale of the pitch. There
    /// the root of the likelihood ratio counts, which for a linear model is the size in its standard errors.
    pub(super) fn drop_what_is_hardly_known(&mut self, problem: &impl Problem, baseline: &Baseline) {
        while !self.included.is_empty() {
            let iteration = Iteration::new(problem.candidates(), self);
            let fit = iteration.score.fit(&iteration.search().columns(&self.included));
            let first_column = |place: usize| iteration.search().columns(&self.included[..place]).len();
            let covariances = self.covariances();
            let n_baseline = self.evidence.baseline.ncols();
            // A standard error by so many clusters is itself uncertain; it counts as the larger where it is so for certain.
            let certain = 1.0 + 2.0 / (2.0 * covariances.clusters.max(2) as f64 - 2.0).sqrt();
            let known_by_clusters = |place: usize| {
                let column = first_column(place);
                let row = n_baseline + column;
                fit.step[column].abs() * certain / covariances.by_clusters[(row, row)].max(0.0).sqrt()
            };
            let known_by_model = |place: usize| {
                let column = first_column(place);
                fit.step[column].abs() / fit.se(column)
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
                let by_model = known_by_model(place);
                let by_slopes = by_model.min(known_by_clusters(place));
                if by_slopes >= asked(place) {
                    return by_slopes;
                }
                // The scatter between clusters counts as it does by the slopes.
                let by_likelihood = self.rise_without(problem, baseline, place).max(0.0).sqrt();
                by_slopes.max(by_likelihood * by_slopes / by_model)
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
    pub(super) fn rise_without(&self, problem: &impl Problem, baseline: &Baseline, place: usize) -> f64 {
        let mut other = self.without(problem, baseline, place);
        other.noises.clone_from(&self.noises);
        other.descend(problem);
        weighted_squares(&other.evidence, &other.noises) - weighted_squares(&self.evidence, &self.noises)
    }

    /// A mechanism that needs another size in another regime is another one: it goes, and what its size goes with is
    /// returned.
    pub(super) fn drop_what_needs_other_sizes(
        &mut self,
        problem: &impl Problem,
        baseline: &Baseline,
    ) -> Option<String> {
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

    /// A mechanism that may be absent on one of two legs may as well be something else on the other one: it goes, unless that leg shows it
    /// too clearly for another law that resembles it. So does one whose sizes on the legs differ for certain and by more than may stay
    /// unexplained. A mechanism with an onset is known by the data before it, and may be uncertain on one leg.
    pub(super) fn drop_what_one_leg_shows(&mut self, problem: &impl Problem, baseline: &Baseline) {
        while problem.needs_both_legs() {
            let included = self.regimes_included(problem);
            let is_of_one_leg = |place: &usize| {
                let version = problem.candidates()[self.included[*place]].version;
                let shown =
                    if version.is_some_and(|version| version.is_onset) { f64::NEG_INFINITY } else { SHOWN_ON_A_LEG };
                let legs = regimes::on_each_leg(&self.evidence, &self.noises, &included, *place);
                let disagree = |legs: &regimes::OnParts, magnified: f64| {
                    let part = problem.part_unexplained();
                    let is_shown_by_one =
                        || magnified * legs.best_known() >= SHOWN_BY_ONE_LEG && !legs.differ(SURELY_APART, part);
                    legs.disagree(shown / magnified, SURELY_APART, part)
                        && (!is_shown_by_one() || self.misses_something(problem))
                };
                // By the slopes at this magnitude the polar may compensate for the mechanism, and yet not for all of it.
                let rise_over_slopes = |legs: &regimes::OnParts| {
                    (self.rise_without(problem, baseline, *place) / legs.explained()).max(1.0).sqrt()
                };
                legs.as_ref().is_some_and(|legs| disagree(legs, 1.0) && disagree(legs, rise_over_slopes(legs)))
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

    /// A mechanism whose size differs between the halves of the data, or from part to part of the record, for certain and by more than may
    /// stay unexplained is another one.
    pub(super) fn drop_what_differs_on_halves(&mut self, problem: &impl Problem, baseline: &Baseline) {
        let parts = self.parts_of_time(PARTS_OF_TIME);
        let varies = |fitted: &Fitted, place: usize| {
            let included = fitted.regimes_included(problem);
            regimes::over_time(&fitted.evidence, &fitted.noises, &included, place, &parts)
                .is_some_and(|over_time| over_time.varies(CHANCE_OF_PARTS, problem.part_unexplained()))
        };
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
                || problem.has_record_over_time()
                    && candidate.version.is_none_or(|version| !version.is_onset)
                    && varies(fitted, place)
        };
        while problem.has_regimes() {
            let Some(place) = (0..self.included.len()).find(|place| differs(self, *place)) else { return };
            *self = self.without(problem, baseline, place);
        }
    }

    /// What needs a size that nature does not have is something else that resembles it: it goes, whatever takes its place not
    /// being asked for. So does a mechanism of unusual size that is not the only explanation.
    pub(super) fn drop_what_cannot_be(&mut self, problem: &impl Problem, baseline: &Baseline) {
        let cannot_be = |fitted: &Fitted, place: usize| {
            let member = fitted.included[place];
            let (candidate, values) = (&problem.candidates()[member], &fitted.point.candidates[member]);
            fitted.is_impossible_for_certain(problem, place)
                || !problem.exists(member, values)
                || candidate.is_unusual(values[0]) && !fitted.is_the_only_explanation(problem, baseline, place)
        };
        while let Some(place) = (0..self.included.len()).find(|place| cannot_be(self, *place)) {
            *self = self.without(problem, baseline, place);
        }
    }

    /// Whether a size lies further beyond those that nature has than its error explains.
    pub(super) fn is_impossible_for_certain(&self, problem: &impl Problem, place: usize) -> bool {
        let candidates = problem.candidates();
        let member = self.included[place];
        let ([low, high], value) = (candidates[member].possible, self.point.candidates[member][0]);
        let row = self.first_parameter(candidates, place);
        (low - value).max(value - high) > BEYOND_NATURE * self.covariances().by_model[(row, row)].max(0.0).sqrt()
    }

    /// Whether no mechanism of a usual size predicts as well in the place of this one, no other has an unusual size too, and no relevant
    /// misfit is left: an unusual size is accepted only of a mechanism that explains all of the misfit. A size that another channel
    /// shows is not contradicted.
    fn is_the_only_explanation(&self, problem: &impl Problem, baseline: &Baseline, place: usize) -> bool {
        let candidates = problem.candidates();
        let iteration = Iteration::new(candidates, self);
        let is_unusual = |member: &&usize| candidates[**member].is_unusual(self.point.candidates[**member][0]);
        candidates[self.included[place]].shown.is_none()
            && self.included.iter().filter(is_unusual).count() == 1
            && !iteration.is_anything_wrong(&self.included, &self.limits(problem))
            && in_place_of(problem, baseline, self, place).is_empty()
    }
}
