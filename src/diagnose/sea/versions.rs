//! Mechanisms with a time that is chosen and not fitted: the engine chooses among versions, and here they are made closer about the one
//! that was found. Knows the problem and the engine.

use super::SeaProblem;
use crate::diagnose::findings::Verdict;
use crate::diagnose::{Outcome, Problem, engine};

/// The mechanisms.
const WITH_VERSIONS: [&str; 3] = [JUMP, "hull_creep", "carried_water"];

const JUMP: &str = "drag_step";

/// Times that versions are made closer: a time constant is then known to a factor of 2^(1/16), 4 %.
const MOST_ROUNDS: usize = 2;

/// Diagnoses a problem; once more, where the drag jumped or the hull or the water that is carried took its time, with that time looked
/// for more closely.
pub(super) fn in_full(problem: SeaProblem) -> (SeaProblem, Outcome) {
    let outcome = engine::diagnose_in_full(&problem);
    let found = problem.without_inertia_if_better(&outcome).unwrap_or((problem, outcome));
    WITH_VERSIONS.into_iter().fold(found, |(problem, outcome), mechanism| more_closely(problem, outcome, mechanism))
}

/// A diagnosis with the versions of a mechanism closer about the one that was found, and closer again while one of them holds all of the
/// time's interval.
///
/// A version may lie too far from the truth for one size everywhere: where something is left unexplained a refused one, too, is looked
/// for more closely, and counts if it then keeps its name. So is a jump of the drag in any case, being between legs at first.
fn more_closely(mut problem: SeaProblem, mut outcome: Outcome, mechanism: &str) -> (SeaProblem, Outcome) {
    for _ in 0..MOST_ROUNDS {
        let is_version = |member: &usize| problem.candidates()[*member].name == mechanism;
        let named = outcome.named.iter().copied().find(is_version);
        let is_left = matches!(outcome.diagnosis.verdict, Verdict::Unexplained | Verdict::PartlyExplained);
        let refused = || outcome.refused.iter().rev().copied().find(is_version);
        let found = named.or_else(|| refused().filter(|_| is_left || mechanism == JUMP));
        let Some(finer) = found.and_then(|found| problem.with_versions_about(found)) else { break };
        let again = engine::diagnose_in_full(&finer);
        let names_it = again.named.iter().find(|member| finer.candidates()[**member].name == mechanism);
        let holds_all = names_it.is_some_and(|member| version_holds_interval(&finer, *member, &again));
        if named.is_none() && names_it.is_none() {
            break;
        }
        (problem, outcome) = (finer, again);
        if !holds_all {
            break;
        }
    }
    (problem, outcome)
}

/// Whether the 95 % interval of the value in which versions differ lies within the range of the one that was taken.
fn version_holds_interval(problem: &SeaProblem, member: usize, outcome: &Outcome) -> bool {
    let candidate = &problem.candidates()[member];
    let cause = outcome.diagnosis.causes.iter().find(|cause| cause.cause == candidate.name);
    candidate.version.zip(cause).is_some_and(|(version, cause)| {
        let [low, high] = cause.parameters[version.name].ci95;
        version.between[0] <= low && high <= version.between[1]
    })
}
