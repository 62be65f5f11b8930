//! Refines the grid of a time that is selected and not fitted: the time of a step of drag or net mass, time constants of creep, late
//! expansion and carried water. The engine selects a grid point; a finer grid about it and about its rivals follows. Knows the problem and the engine.

use super::{SeaProblem, jumps, with_inertia};
use crate::diagnose::engine::Start;
use crate::diagnose::estimate::Estimate;
use crate::diagnose::evidence::{Point, Version};
use crate::diagnose::findings::Verdict;
use crate::diagnose::{Outcome, Problem, engine};

/// Mechanisms with a time constant on a grid.
const WITH_A_CONSTANT: [&str; 3] = ["hull_creep", "late_expansion", "carried_water"];

/// Largest number of refinements: the grid of a time constant then has a factor of 2^(1/16), 4 %.
const MOST_ROUNDS: usize = 2;

/// Largest number of searches on finer grids: a finer grid may name another mechanism, which has a grid of its own.
const MOST_SEARCHES: usize = 2;

/// Diagnoses a problem, and again on a finer grid where a mechanism with a gridded time was found.
pub(super) fn diagnose(problem: SeaProblem) -> (SeaProblem, Outcome) {
    let (problem, outcome) = with_inertia::diagnose(problem);
    let (problem, outcome) = refined_where_named(problem, outcome);
    match refined_where_refused(&problem, &outcome) {
        Some((finer, again)) => refined_where_named(finer, again),
        None => (problem, outcome),
    }
}

/// Returns the diagnosis with a finer grid for every named mechanism; once more where that names one whose grid is not refined.
fn refined_where_named(mut problem: SeaProblem, mut outcome: Outcome) -> (SeaProblem, Outcome) {
    let mut refined = Vec::new();
    for _ in 0..MOST_SEARCHES {
        let fresh: Vec<&str> = with_a_gridded_time()
            .filter(|mechanism| !refined.contains(mechanism) && named(&problem, &outcome, mechanism).is_some())
            .collect();
        let Some((finer, start)) = finer_about(&problem, &outcome, &fresh) else { break };
        outcome = engine::diagnose_again(&finer, &outcome, || start);
        problem = finer;
        refined.extend(fresh);
    }
    (problem, outcome)
}

/// Returns the problem with a finer grid about these named mechanisms and the others of their groups, and what was found on it: refined
/// again while one grid point covers the whole interval of a time. None where no finer grid is known.
fn finer_about(problem: &SeaProblem, outcome: &Outcome, mechanisms: &[&str]) -> Option<(SeaProblem, Start)> {
    // Those that the data do not tell from it have a time of their own: on a coarse grid they would seem to explain less.
    let with_rivals = |mechanism: &&str| {
        let place = named(problem, outcome, mechanism)?;
        Some(outcome.groups[place].iter().chain([&outcome.named[place]]).copied())
    };
    let about: Vec<usize> = mechanisms.iter().filter_map(with_rivals).flatten().collect();
    let mut finer = problem.with_versions_about(&about)?;
    let mut start = finer.start_at(problem, outcome);
    for round in 1.. {
        let (there, times) = engine::in_likeliest_versions(&finer, start);
        start = there;
        let is_covered = |(member, time): (&usize, Option<Estimate>)| {
            let candidate = &finer.candidates()[*member];
            let is_one = mechanisms.contains(&candidate.name) && covers(candidate.version?, &time?);
            is_one.then_some(*member)
        };
        let covered: Vec<usize> = start.included.iter().zip(times).filter_map(is_covered).collect();
        if round == MOST_ROUNDS {
            break;
        }
        let Some(closer) = finer.with_versions_about(&covered) else { break };
        start = closer.in_nearest_versions(&finer, start);
        finer = closer;
    }
    Some((finer, start))
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
        let [baseline, point] = [&found.before, &found.after].map(|stage| stage.point.clone());
        self.in_nearest_versions(coarser, Start { baseline, point, included: found.fitted.clone() })
    }

    /// The same start with other versions.
    fn in_nearest_versions(&self, coarser: &SeaProblem, start: Start) -> Start {
        let neutral = |point: &Point| Point { baseline: point.baseline.clone(), ..self.start() };
        let mut point = neutral(&start.point);
        let nearest = |member: usize| {
            let wanted = &coarser.candidates[member];
            let same = (0..self.candidates.len()).filter(|i| self.candidates[*i].name == wanted.name);
            let value = |version: Option<Version>| version.map_or(0.0, |version| version.value);
            let apart = |i: &usize| (value(self.candidates[*i].version) - value(wanted.version)).abs();
            same.min_by(|a, b| apart(a).total_cmp(&apart(b))).expect("finer versions of every mechanism")
        };
        let mut included: Vec<usize> = start.included.iter().map(|member| nearest(*member)).collect();
        for (member, there) in start.included.iter().zip(&included) {
            point.candidates[*there].clone_from(&start.point.candidates[*member]);
        }
        included.sort_unstable();
        Start { baseline: neutral(&start.baseline), point, included }
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

/// Returns whether the 95 % interval of a time lies within the cell of its grid point.
fn covers(version: Version, time: &Estimate) -> bool {
    let [low, high] = time.ci95;
    version.between[0] <= low && high <= version.between[1]
}
