//! Mechanisms that could stand in the place of a named one: each is fitted in full in its place, and belongs to the group
//! where it predicts data that were held out no worse by one standard error, or no worse by anything that counts: with much
//! data the model's own small errors decide between laws that are nearly one.

use nalgebra::DVector;

use super::evidence::Problem;
use super::fitted::{Fitted, expected_rms};
use super::holdout;
use super::iteration::Iteration;
use super::subset_search::MARGIN;

/// How much worse by the slopes a mechanism may be and still be fitted in full: where the model is nonlinear the slopes at the
/// named one say little of the others.
const REFITTED_WITHIN: f64 = 3.0 * MARGIN;

/// Most mechanisms that are fitted in full in the place of one.
const MOST_REFITTED: usize = 8;

/// The same where a named mechanism explains much, as a share of what it explains.
const REFITTED_SHARE: f64 = 0.05;

/// Share of the squared error that the named one removes which a rival may leave: a tenth of the effect itself, what the model
/// leaves out.
const NEARLY_EQUAL: f64 = 0.01;

/// Standard errors by which a rival may predict worse and still count as equal.
const EQUAL: f64 = 1.0;

/// The names of the mechanisms that could stand in the place of a member, the best by the slopes first. `without` is what is
/// left of held-out rows without the member, `gain` what it explains in units of the noise.
pub(super) fn replacements(
    problem: &impl Problem,
    extended: &Fitted,
    iteration: &Iteration<'_>,
    place: usize,
    without: &DVector<f64>,
    gain: f64,
) -> Vec<String> {
    let candidates = problem.candidates();
    let named = extended.held_out();
    let limits = extended.limits(problem);
    let refitted_within = REFITTED_WITHIN.max(REFITTED_SHARE * gain);
    let mut tried: Vec<&str> = vec![candidates[extended.included[place]].name];
    let mut found = Vec::new();
    for other in iteration.search().replacements(&extended.included, place, refitted_within) {
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
        if !rival.is_possible(candidates) || !rival.included.iter().all(exists) {
            continue;
        }
        let left = rival.held_out();
        if holdout::advantage(&extended.evidence, &extended.noises, &left, &named) < EQUAL
            || is_nearly_equal(extended, &limits, [without, &named, &left])
        {
            found.push(name.to_owned());
        }
    }
    found
}

/// Whether what a rival leaves beyond what the named one leaves is a small part of what that removes, and too little to act on
/// in every quantity. In this order: without the named one, with it, with the rival.
fn is_nearly_equal(extended: &Fitted, limits: &[f64], [without, named, rival]: [&DVector<f64>; 3]) -> bool {
    let (mut removed, mut left) = (0.0, 0.0);
    for (i, quantity) in extended.evidence.quantities.iter().enumerate() {
        let square = |values: &DVector<f64>| holdout::rms(values, quantity.rows.clone()).powi(2);
        let worse = square(rival) - square(named);
        if worse > limits[i].powi(2) {
            return false;
        }
        let rows = quantity.rows.len() as f64 / expected_rms(&extended.evidence, &extended.noises, i).powi(2);
        removed += rows * (square(without) - square(named));
        left += rows * worse;
    }
    left < NEARLY_EQUAL * removed
}
