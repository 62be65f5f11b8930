//! Mechanisms that could stand in the place of a named one: each is fitted in full in its place, and belongs to the group
//! where it predicts data that were held out no worse by one standard error, or no worse by anything that counts: with much
//! data the model's own small errors decide between laws that are nearly one. So does a law that one half of the data prefers: what
//! parts the two is then something else. So does one whose likelihood is nearly as large: of a few glides held-out errors have
//! standard errors that are hardly known themselves.

use nalgebra::DVector;
use rayon::prelude::*;

use super::baseline::Baseline;
use super::evidence::{Candidate, Problem};
use super::fitted::{Fitted, weighted_squares};
use super::holdout;
use super::iteration::Iteration;
use super::marginal_likelihood::twice_log_bayes_factor;
use super::subset_search::MARGIN;

/// How much worse by the slopes a mechanism may be and still be fitted in full: where the model is nonlinear the slopes at the
/// named one say little of the others.
pub(super) const REFITTED_WITHIN: f64 = 3.0 * MARGIN;

/// Most mechanisms that are fitted in full in the place of one.
const MOST_REFITTED: usize = 8;

/// The same where a named mechanism explains much, as a share of what it explains. Judgement: where the named one is large, slopes at it are
/// off by tens of per cent for a rival.
pub(super) const REFITTED_SHARE: f64 = 0.2;

/// Share of the squared error that the named one removes which a rival may leave: a fifth of the effect itself, as a size may change
/// from regime to regime and still be one.
const NEARLY_EQUAL: f64 = 0.04;

/// The same of a rival that predicts one half of the data better: what may stay unexplained beside a name.
const EQUAL_ON_A_HALF: f64 = 0.1;

/// Standard errors by which a rival may predict worse and still count as equal.
const EQUAL: f64 = 1.0;

/// Whether laws of which slopes elsewhere say nothing are asked in the place of a member.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Far {
    /// They are.
    Asked,
    /// They were, in the place of what was found before.
    AskedBefore,
}

/// A mechanism that could stand in the place of a named one, in its best version.
pub(super) struct Replacement {
    pub(super) candidate: usize,
    /// The set with it in that place, fitted in full.
    pub(super) fitted: Fitted,
}

/// What could stand in the place of a member, the best by the slopes first. `without` is what is left of held-out rows without the
/// member, `gain` what it explains in units of the noise.
pub(super) fn replacements(
    problem: &impl Problem,
    (baseline, extended): (&Baseline, &Fitted),
    iteration: &Iteration<'_>,
    place: usize,
    without: &DVector<f64>,
    gain: f64,
) -> Vec<Replacement> {
    let is_equal = equal_to(problem, extended, without);
    let refitted = refitted(problem, (baseline, extended), iteration, place, gain).into_par_iter();
    refitted.filter(|rival| is_equal(&rival.fitted) || is_nearly_as_likely(extended, &rival.fitted)).collect()
}

/// The sets with a refused member exchanged that predict held-out data as well as the set with it, the best first.
///
/// A law that resembles the true one may be found before it, and be refused by what only the true one does.
pub(super) fn in_place_of(problem: &impl Problem, baseline: &Baseline, refused: &Fitted, place: usize) -> Vec<Fitted> {
    let iteration = Iteration::new(problem.candidates(), refused);
    let gain = iteration.search().gain_of(&refused.included, place);
    let without = refused.without(problem, baseline, place).held_out();
    let is_equal = equal_to(problem, refused, &without);
    let refitted = refitted(problem, (baseline, refused), &iteration, place, gain).into_iter();
    let mut equal: Vec<Fitted> = refitted.map(|rival| rival.fitted).filter(is_equal).collect();
    equal.sort_by(|a, b| a.held_out_misfit().total_cmp(&b.held_out_misfit()));
    equal
}

/// The sets with one member exchanged that are likelier than this one and predict held-out data no worse by one standard error nor by
/// anything that counts, each fitted in full, the likeliest first. The slopes at a wrong law may keep it before the true one. The
/// likelihood alone may take a slow misfit for noise. A time that was selected from all data has seen what is held out: one without such a
/// time need not predict as well, and one with it must leave no more at all, unless the evidence for it is strong.
pub(super) fn likelier(problem: &impl Problem, baseline: &Baseline, present: &Fitted, far: Far) -> Vec<Fitted> {
    let candidates = problem.candidates();
    let iteration = Iteration::new(candidates, present);
    let (named, limits) = (present.held_out(), present.limits(problem));
    let has_version = |member: usize| candidates[member].version.is_some();
    let of_place = |place: usize| {
        let gain = iteration.search().gain_of(&present.included, place);
        let less_likely =
            |rival: Replacement| (twice_log_bayes_factor(&iteration, place, (&rival.fitted, rival.candidate)), rival);
        let is_likelier = |(less_likely, rival): &(f64, Replacement)| {
            let advantage = || holdout::advantage(&present.evidence, &present.noises, &rival.fitted.held_out(), &named);
            let predicts_as_well = || match (has_version(present.included[place]), has_version(rival.candidate)) {
                (true, false) => true,
                (false, true) if *less_likely > -MARGIN => rival.fitted.held_out_misfit() <= present.held_out_misfit(),
                _ => advantage() < EQUAL,
            };
            *less_likely < 0.0
                && !holdout::surely_leaves_relevantly_more(
                    &present.evidence,
                    &limits,
                    [&rival.fitted.held_out(), &named],
                )
                && predicts_as_well()
        };
        let refitted = refitted(problem, (baseline, present), &iteration, place, gain).into_par_iter();
        let of_far = match far {
            Far::Asked => far_from_linear(problem, baseline, present, place),
            Far::AskedBefore => Vec::new(),
        };
        refitted.chain(of_far).map(less_likely).filter(is_likelier).collect::<Vec<_>>()
    };
    let places = (0..present.included.len()).into_par_iter();
    let mut likelier: Vec<(f64, Replacement)> = places.flat_map(of_place).collect();
    likelier.sort_by(|a, b| a.0.total_cmp(&b.0));
    likelier.into_iter().map(|(_, rival)| rival.fitted).collect()
}

/// Whether a rival is equal to the set with a member, `without` being what is left of held-out rows without that member.
fn equal_to<'a, P: Problem>(
    problem: &P,
    extended: &'a Fitted,
    without: &'a DVector<f64>,
) -> impl Fn(&Fitted) -> bool + use<'a, P> {
    let named = extended.held_out();
    let limits = extended.limits(problem);
    move |rival: &Fitted| {
        let left = rival.held_out();
        holdout::advantage(&extended.evidence, &extended.noises, &left, &named) < EQUAL
            || is_nearly_equal(extended, &limits, [without, &named, &left])
    }
}

/// The set with one member exchanged for each mechanism that comes near by the slopes, fitted in full, with that candidate; not
/// where a size lies beyond those that nature has by more than its error explains. `gain` is what the member explains in units of the noise.
fn refitted(
    problem: &impl Problem,
    (baseline, extended): (&Baseline, &Fitted),
    iteration: &Iteration<'_>,
    place: usize,
    gain: f64,
) -> Vec<Replacement> {
    let candidates = problem.candidates();
    let refitted_within = REFITTED_WITHIN.max(REFITTED_SHARE * gain);
    let others = iteration.search().replacements(&extended.included, place, refitted_within);
    // Of the versions of a mechanism the best by the slopes stands for all.
    let mut others = first_versions(candidates, others, Some(candidates[extended.included[place]].name));
    others.truncate(MOST_REFITTED);
    let refit = |other: usize| {
        let mut members = extended.included.clone();
        members[place] = other;
        members.sort_unstable();
        let rival = baseline.converged(problem, iteration.point_of(&members, problem), members);
        exists(problem, &rival).then_some(Replacement { candidate: other, fitted: rival })
    };
    others.into_par_iter().filter_map(refit).collect()
}

/// Whether nature has all sizes of a set, as far as their errors tell.
fn exists(problem: &impl Problem, fitted: &Fitted) -> bool {
    let candidates = problem.candidates();
    let cannot_be = |place: usize| {
        let member = fitted.included[place];
        candidates[member].is_unusual(fitted.point.candidates[member][0])
            || fitted.is_impossible_for_certain(problem, place)
    };
    fitted.is_possible(candidates) && !(0..fitted.included.len()).any(cannot_be)
}

/// The set with one member exchanged for each mechanism of which the slopes elsewhere say nothing, that member itself among them: each
/// fitted from several sizes of it on, the lowest in full.
fn far_from_linear(problem: &impl Problem, baseline: &Baseline, present: &Fitted, place: usize) -> Vec<Replacement> {
    let is_another_member =
        |candidate: &usize| present.included.contains(candidate) && *candidate != present.included[place];
    let is_asked = |candidate: &usize| problem.is_strongly_nonlinear_in(*candidate) && !is_another_member(candidate);
    let asked: Vec<usize> = (0..problem.candidates().len()).filter(is_asked).collect();
    if asked.is_empty() {
        return Vec::new();
    }
    let without = present.without(problem, baseline, place);
    let iteration = Iteration::new(problem.candidates(), &without);
    let fitted = |candidate: usize| {
        let fitted = without.with_one_beside(problem, &iteration, candidate, present)?;
        exists(problem, &fitted).then_some(Replacement { candidate, fitted })
    };
    asked.into_par_iter().filter_map(fitted).collect()
}

/// The first version of each mechanism in this order, but for those of one name.
pub(super) fn first_versions(candidates: &[Candidate], ordered: Vec<usize>, but: Option<&str>) -> Vec<usize> {
    let mut names: Vec<&str> = but.into_iter().collect();
    let is_first = |member: &usize| {
        let name = candidates[*member].name;
        let is_first = !names.contains(&name);
        names.extend(is_first.then_some(name));
        is_first
    };
    ordered.into_iter().filter(is_first).collect()
}

/// Whether twice the logarithm of the ratio of likelihoods is no strong evidence for the named one against a rival: below 6 (Kass and
/// Raftery 1995, J. Am. Stat. Assoc. 90, 773).
fn is_nearly_as_likely(named: &Fitted, rival: &Fitted) -> bool {
    let squares = |fitted: &Fitted| weighted_squares(&fitted.evidence, &named.noises);
    squares(rival) - squares(named) < MARGIN
}

/// Whether what a rival leaves beyond what the named one leaves is a small part of what that removes: too little to act on in every
/// quantity, or less than nothing on one half of the data. In this order: without the named one, with it, with the rival.
fn is_nearly_equal(extended: &Fitted, limits: &[f64], [without, named, rival]: [&DVector<f64>; 3]) -> bool {
    let first_half = extended.first_half();
    let (mut removed, mut worse_on) = (0.0, [0.0; 2]);
    for (i, quantity) in extended.evidence.quantities.iter().enumerate() {
        let variance = extended.expected_rms(&extended.noises, i).powi(2);
        for row in quantity.rows.clone() {
            let worse = rival[row].powi(2) - named[row].powi(2);
            worse_on[usize::from(first_half[row])] += worse / variance;
            removed += (without[row].powi(2) - named[row].powi(2)) / variance;
        }
    }
    let left = worse_on[0] + worse_on[1];
    let is_preferred_by_a_half = worse_on.iter().any(|worse| *worse < 0.0);
    !holdout::leaves_relevantly_more(&extended.evidence, limits, [rival, named]) && left < NEARLY_EQUAL * removed
        || is_preferred_by_a_half && left < EQUAL_ON_A_HALF * removed
}
