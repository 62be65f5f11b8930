//! Mechanisms that could stand in the place of a named one: each is fitted in full in its place, and belongs to the group
//! where it predicts data that were held out no worse by one standard error.

use super::evidence::Problem;
use super::fitted::Fitted;
use super::holdout;
use super::iteration::Iteration;
use super::subset_search::MARGIN;

/// How much worse by the slopes a mechanism may be and still be fitted in full: where the model is nonlinear the slopes at the
/// named one say little of the others.
const REFITTED_WITHIN: f64 = 3.0 * MARGIN;

/// Most mechanisms that are fitted in full in the place of one.
const MOST_REFITTED: usize = 8;

/// Standard errors by which a rival may predict worse and still count as equal.
const EQUAL: f64 = 1.0;

/// The names of the mechanisms that could stand in the place of a member, the best by the slopes first.
pub(super) fn replacements(
    problem: &impl Problem,
    extended: &Fitted,
    iteration: &Iteration<'_>,
    place: usize,
) -> Vec<String> {
    let candidates = problem.candidates();
    let named = extended.held_out();
    let mut tried: Vec<&str> = vec![candidates[extended.included[place]].name];
    let mut found = Vec::new();
    for other in iteration.search().replacements(&extended.included, place, REFITTED_WITHIN) {
        let name = candidates[other].name;
        // Of the versions of a mechanism the best by the slopes stands for all.
        if tried.contains(&name) {
            continue;
        }
        if tried.len() > MOST_REFITTED {
            break;
        }
        tried.push(name);
        let mut members = extended.included.clone();
        members[place] = other;
        members.sort_unstable();
        let mut rival = Fitted::new(problem, iteration.point_of(&members, problem), members);
        rival.converge(problem);
        let exists = |member: &usize| {
            !candidates[*member].cannot_be(rival.point.candidates[*member][0], problem.most_prior_sds())
        };
        if rival.is_possible(candidates)
            && rival.included.iter().all(exists)
            && holdout::advantage(&extended.evidence, &extended.noises, &rival.held_out(), &named) < EQUAL
        {
            found.push(name.to_owned());
        }
    }
    found
}
