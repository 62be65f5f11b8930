//! Refines the grid of a time that is selected and not fitted: the time of a step of drag or net mass, time constants of creep, late
//! expansion and carried water. The engine selects a grid point; a finer grid about it and about its rivals follows. Knows the problem and the engine.

use super::{SeaProblem, jumps, with_inertia};
use crate::diagnose::engine::Start;
use crate::diagnose::evidence::{Point, Version};
use crate::diagnose::findings::Verdict;
use crate::diagnose::{Outcome, Problem, engine};

/// Mechanisms with a time constant on a grid.
const WITH_A_CONSTANT: [&str; 3] = ["hull_creep", "late_expansion", "carried_water"];

/// Largest number of refinements: the grid of a time constant then has a factor of 2^(1/16), 4 %.
const MOST_ROUNDS: usize = 2;

/// Diagnoses a problem, and again on a finer grid where a mechanism with a gridded time was found.
pub(super) fn diagnose(problem: SeaProblem) -> (SeaProblem, Outcome) {
    let (problem, outcome) = with_inertia::diagnose(problem);
    let (problem, outcome) = refined_where_named(problem, outcome);
    match refined_where_refused(&problem, &outcome) {
        Some((finer, again)) => refined_where_named(finer, again),
        None => (problem, outcome),
    }
}

/// Returns the diagnosis with a finer grid for each named mechanism, refined again while one grid point covers the whole interval of
/// the time.
fn refined_where_named(mut problem: SeaProblem, mut outcome: Outcome) -> (SeaProblem, Outcome) {
    for mechanism in with_a_gridded_time() {
        for _ in 0..MOST_ROUNDS {
            let Some(place) = named(&problem, &outcome, mechanism) else { break };
            // Those that the data do not tell from it have a time of their own: on a coarse grid they would seem to explain less.
            let with_rivals: Vec<usize> =
                outcome.groups[place].iter().chain([&outcome.named[place]]).copied().collect();
            let Some(finer) = problem.with_versions_about(&with_rivals) else { break };
            let again = engine::diagnose_again(&finer, &outcome, || finer.start_at(&problem, &outcome));
            let covers_all = named(&finer, &again, mechanism)
                .is_some_and(|place| cell_covers_interval(&finer, again.named[place], &again));
            (problem, outcome) = (finer, again);
            if !covers_all {
                break;
            }
        }
    }
    (problem, outcome)
}

/// Returns the diagnosis with a finer grid for all refused mechanisms at once, if one of them is then named.
///
/// A grid point may be too far from the true time for one magnitude to fit everywhere. Where a misfit remains, rejected mechanisms are
/// therefore refined as well. A step is always asked, since its first grid lies between legs, and refined if then the slopes choose it.
fn refined_where_refused(problem: &SeaProblem, outcome: &Outcome) -> Option<(SeaProblem, Outcome)> {
    let is_left = matches!(outcome.diagnosis.verdict, Verdict::Unexplained | Verdict::PartlyExplained);
    let refused = |mechanism: &str| {
        let is_version = |member: &usize| problem.candidates()[*member].name == mechanism;
        outcome.refused.iter().rev().copied().find(is_version)
    };
    let asked = with_a_gridded_time()
        .filter(|mechanism| is_left || jumps::MECHANISMS.contains(mechanism))
        .filter(|mechanism| named(problem, outcome, mechanism).is_none());
    let asked: Vec<(&str, usize)> = asked.filter_map(|mechanism| Some((mechanism, refused(mechanism)?))).collect();
    let members: Vec<usize> = asked.iter().map(|(_, member)| *member).collect();
    let finer = problem.with_versions_about(&members)?;
    let is_asked = |member: &usize| asked.iter().any(|(mechanism, _)| finer.candidates()[*member].name == *mechanism);
    if !is_left && !engine::chosen_by_slopes(&finer, finer.start_at(problem, outcome)).iter().any(is_asked) {
        return None;
    }
    let again = engine::diagnose_in_full(&finer);
    let is_named = asked.iter().any(|(mechanism, _)| named(&finer, &again, mechanism).is_some());
    is_named.then_some((finer, again))
}

impl SeaProblem {
    /// What was found with other versions, each by the nearest of this problem's.
    fn start_at(&self, coarser: &SeaProblem, found: &Outcome) -> Start {
        let neutral = |point: &Point| Point { baseline: point.baseline.clone(), ..self.start() };
        let mut point = neutral(&found.after.point);
        let nearest = |member: usize| {
            let wanted = &coarser.candidates[member];
            let same = (0..self.candidates.len()).filter(|i| self.candidates[*i].name == wanted.name);
            let value = |version: Option<Version>| version.map_or(0.0, |version| version.value);
            let apart = |i: &usize| (value(self.candidates[*i].version) - value(wanted.version)).abs();
            same.min_by(|a, b| apart(a).total_cmp(&apart(b))).expect("finer versions of every mechanism")
        };
        let mut included: Vec<usize> = found.fitted.iter().map(|member| nearest(*member)).collect();
        for (member, there) in found.fitted.iter().zip(&included) {
            point.candidates[*there].clone_from(&found.after.point.candidates[*member]);
        }
        included.sort_unstable();
        Start { baseline: neutral(&found.before.point), point, included }
    }
}

/// Returns the mechanisms with a time that is selected from a grid.
fn with_a_gridded_time() -> impl Iterator<Item = &'static str> {
    jumps::MECHANISMS.into_iter().chain(WITH_A_CONSTANT)
}

/// Returns the place of a mechanism among those that are named.
fn named(problem: &SeaProblem, outcome: &Outcome, mechanism: &str) -> Option<usize> {
    outcome.named.iter().position(|member| problem.candidates()[*member].name == mechanism)
}

/// Returns whether the 95 % interval of the time lies within the cell of the selected grid point.
fn cell_covers_interval(problem: &SeaProblem, member: usize, outcome: &Outcome) -> bool {
    let candidate = &problem.candidates()[member];
    let cause = outcome.diagnosis.causes.iter().find(|cause| cause.cause == candidate.name);
    candidate.version.zip(cause).is_some_and(|(version, cause)| {
        let [low, high] = cause.parameters[version.name].ci95;
        version.between[0] <= low && high <= version.between[1]
    })
}
