//! Refines the grid of a time that is selected and not fitted: the time of a step of drag or net mass, time constants of creep, late
//! expansion and carried water. The engine selects a grid point; a finer grid about it and about its rivals follows. Knows the problem and the engine.

use super::{SeaProblem, jumps};
use crate::diagnose::findings::Verdict;
use crate::diagnose::{Outcome, Problem, engine};

/// Mechanisms with a time constant on a grid.
const WITH_A_CONSTANT: [&str; 3] = ["hull_creep", "late_expansion", "carried_water"];

/// Largest number of refinements: the grid of a time constant then has a factor of 2^(1/16), 4 %.
const MOST_ROUNDS: usize = 2;

/// Diagnoses a problem, and again on a finer grid where a mechanism with a gridded time was found.
pub(super) fn diagnose(problem: SeaProblem) -> (SeaProblem, Outcome) {
    let outcome = engine::diagnose_in_full(&problem);
    let found = problem.without_inertia_if_better(&outcome).unwrap_or((problem, outcome));
    jumps::MECHANISMS
        .into_iter()
        .chain(WITH_A_CONSTANT)
        .fold(found, |(problem, outcome), mechanism| refined(problem, outcome, mechanism))
}

/// Returns the diagnosis with a finer grid for one mechanism, refined again while one grid point covers the whole interval of the time.
///
/// A grid point may be too far from the true time for one magnitude to fit everywhere. Where a misfit remains, a rejected mechanism is
/// therefore refined as well, and counts if it is then named. A step is always refined, since its first grid lies between legs.
fn refined(mut problem: SeaProblem, mut outcome: Outcome, mechanism: &str) -> (SeaProblem, Outcome) {
    for _ in 0..MOST_ROUNDS {
        let is_version = |member: &usize| problem.candidates()[*member].name == mechanism;
        let named = outcome.named.iter().copied().find(is_version);
        let is_left = matches!(outcome.diagnosis.verdict, Verdict::Unexplained | Verdict::PartlyExplained);
        let refused = || outcome.refused.iter().rev().copied().find(is_version);
        let found = named.or_else(|| refused().filter(|_| is_left || jumps::MECHANISMS.contains(&mechanism)));
        let Some(found) = found else { break };
        // Those that the data do not tell from it have a time of their own: on a coarse grid they would seem to explain less.
        let place = outcome.named.iter().position(|member| *member == found);
        let with_rivals: Vec<usize> =
            place.iter().flat_map(|place| &outcome.groups[*place]).chain([&found]).copied().collect();
        let Some(finer) = problem.with_versions_about(&with_rivals) else { break };
        let again = engine::diagnose_in_full(&finer);
        let names_it = again.named.iter().find(|member| finer.candidates()[**member].name == mechanism);
        let covers_all = names_it.is_some_and(|member| cell_covers_interval(&finer, *member, &again));
        if named.is_none() && names_it.is_none() {
            break;
        }
        (problem, outcome) = (finer, again);
        if !covers_all {
            break;
        }
    }
    (problem, outcome)
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
