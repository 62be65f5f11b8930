//! Other sets of mechanisms that these data cannot tell from the named one.
//!
//! What could stand in the place of one mechanism alone stands beside it in the report. Two or more may be exchanged
//! together as well: a reader who knows more of the glider than the log says may know which set it was.

use super::change_point;
use super::evidence::Problem;
use super::findings::Alternative;
use super::fitted::Fitted;
use super::iteration::Iteration;
use super::replacements::Replacement;
use super::subset_search::MARGIN;

/// Most sets that are reported.
const MOST_SETS: usize = 3;

/// Most sets that are held against data that were held out.
const MOST_TRIED: usize = 12;

/// The sets that explain as much as the named one, within the margin of a replacement, and predict no worse; the best first,
/// of those that differ by one member the best alone. `groups` is what could stand in the place of each named one.
pub(super) fn alternatives(
    problem: &impl Problem,
    extended: &Fitted,
    iteration: &Iteration<'_>,
    groups: &[&[Replacement]],
) -> Vec<Vec<Alternative>> {
    // What could stand in the place of a single mechanism has a size of its own; any two explain more than one.
    if let (&[_], [group]) = (extended.included.as_slice(), groups) {
        return group.iter().take(MOST_SETS).map(|rival| alone(problem, rival)).collect();
    }
    if extended.included.len() < 2 {
        return Vec::new();
    }
    let search = iteration.search();
    let apart = |a: &[usize], b: &[usize]| a.iter().filter(|member| !has_family(iteration, b, **member)).count();
    let mut reported: Vec<Vec<usize>> = Vec::new();
    let mut tried = 0;
    for choice in search.within(search.criterion(&extended.included) + MARGIN, extended.included.len() + 1) {
        let is_new = reported.iter().chain([&extended.included]).all(|known| apart(&choice.members, known) >= 2);
        if !is_new || !is_possible(problem, iteration, &choice.members) {
            continue;
        }
        tried += 1;
        if iteration.advantage(&choice.members, &extended.included) > -problem.least_advantage() {
            reported.push(choice.members);
        }
        if reported.len() == MOST_SETS || tried == MOST_TRIED {
            break;
        }
    }
    reported.iter().map(|members| sizes(problem, iteration, members)).collect()
}

/// A mechanism alone, with its size.
fn alone(problem: &impl Problem, rival: &Replacement) -> Vec<Alternative> {
    let Replacement { candidate, fitted } = rival;
    let iteration = Iteration::new(problem.candidates(), fitted);
    let stage = fitted.stage(fitted.held_out());
    let parameters = change_point::with_scatter(problem, fitted, &iteration, 0, &stage);
    vec![Alternative { cause: problem.candidates()[*candidate].name.to_owned(), parameters }]
}

fn has_family(iteration: &Iteration<'_>, members: &[usize], member: usize) -> bool {
    members.iter().any(|other| iteration.regressors[*other].family == iteration.regressors[member].family)
}

fn is_possible(problem: &impl Problem, iteration: &Iteration<'_>, members: &[usize]) -> bool {
    let point = iteration.point_of(members, problem);
    let cannot_be = |member: &usize| problem.candidates()[*member].cannot_be(point.candidates[*member][0]);
    !members.iter().any(cannot_be)
}

/// The members of a set with their sizes, by the slopes at the named one.
fn sizes(problem: &impl Problem, iteration: &Iteration<'_>, members: &[usize]) -> Vec<Alternative> {
    let point = iteration.point_of(members, problem);
    let of = |(place, member): (usize, &usize)| Alternative {
        cause: problem.candidates()[*member].name.to_owned(),
        parameters: change_point::estimates(problem, iteration, members, place, &point),
    };
    members.iter().enumerate().map(of).collect()
}
