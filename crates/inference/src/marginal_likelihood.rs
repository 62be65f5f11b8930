//! Bayes factors between two sets that differ by one mechanism. Decides nothing.

use nalgebra::DVector;

use super::fitted::Fitted;
use super::iteration::Iteration;

/// Returns twice the natural logarithm of the Bayes factor of a fitted set against one with another mechanism in the place of a member:
/// the ratio of their likelihoods, each integrated over the prior of its mechanism. A selected time costs what its selection says.
pub(super) fn twice_log_bayes_factor(
    iteration: &Iteration<'_>,
    place: usize,
    (rival, mechanism): (&Fitted, usize),
) -> f64 {
    let place_in_rival = rival.included.iter().position(|member| *member == mechanism).expect("it is in its set");
    let of_rival = Iteration::new(iteration.candidates, rival);
    let cost = |of: &Iteration<'_>, place: usize| cost_of_parameters(of, place) + cost_of_time(of, place);
    rival.deviance_above(iteration.fitted) + cost(&of_rival, place_in_rival) - cost(iteration, place)
}

/// Returns twice the logarithm of the width of a mechanism's prior over that of its posterior (Laplace's method; Kass and Raftery 1995,
/// J. Am. Stat. Assoc. 90, 773, their equation 5): minus the logarithm of the determinant of its covariance in units of the prior's widths.
/// The posterior of what is fitted beside it has the same width beside each rival, as far as the model is linear.
fn cost_of_parameters(iteration: &Iteration<'_>, place: usize) -> f64 {
    let (included, search) = (&iteration.fitted.included, iteration.search());
    let widths = DVector::from_vec(iteration.candidates[included[place]].prior_widths());
    let first = search.columns(&included[..place]).len();
    let fit = iteration.score.fit(&search.columns(included));
    let covariance = fit.covariance.view((first, first), (widths.len(), widths.len()));
    -covariance.component_div(&(&widths * widths.transpose())).determinant().max(f64::MIN_POSITIVE).ln()
}

/// What the selection of a time costs; nothing where there is none.
pub(super) fn cost_of_time(iteration: &Iteration<'_>, place: usize) -> f64 {
    let (candidates, included) = (iteration.candidates, &iteration.fitted.included);
    let (search, member) = (iteration.search(), included[place]);
    let Some(version) = candidates[member].version else { return 0.0 };
    let scale = |value: f64| if version.is_onset { value } else { value.ln() };
    let of_version = |i: usize| {
        let candidate = &candidates[i];
        let value = candidate.version.filter(|_| candidate.name == candidates[member].name)?.value;
        let mut set = included.clone();
        set[place] = i;
        Some((scale(value), search.criterion(&set)))
    };
    let mut versions: Vec<(f64, f64)> = (0..candidates.len()).filter_map(of_version).collect();
    versions.sort_by(|a, b| a.0.total_cmp(&b.0));
    let values: Vec<f64> = versions.iter().map(|(value, _)| *value).collect();
    let shares = shares_of_nearest(&values);
    let here = search.criterion(included);
    let likelihood = |((_, criterion), share): (&(f64, f64), &f64)| share * (-0.5 * (criterion - here)).exp();
    let mean: f64 = versions.iter().zip(&shares).map(likelihood).sum();
    // Where the slopes ask this one for a size that physics forbids they say nothing of the others.
    if mean.is_normal() { -2.0 * mean.ln() } else { 2.0 * (versions.len() as f64).ln() }
}

/// The share of the range of sorted values that is nearest to each; the first and the last one stand for as much on either side.
fn shares_of_nearest(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    if n < 2 {
        return vec![1.0; n];
    }
    let gap = |i: usize| values[i + 1] - values[i];
    let width = |i: usize| 0.5 * (gap(i.saturating_sub(1).min(n - 2)) + gap(i.min(n - 2)));
    let widths: Vec<f64> = (0..n).map(width).collect();
    let all: f64 = widths.iter().sum();
    widths.iter().map(|width| width / all).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_value_has_the_share_of_the_range_that_is_nearest_to_it() {
        assert_eq!(shares_of_nearest(&[3.0]), [1.0]);
        // From -1 to 1, 2.5, 5.5 and 10.5: half-way to the next, and as far beyond the ends.
        let shares = shares_of_nearest(&[0.0, 2.0, 3.0, 8.0]);
        let expected = [2.0, 1.5, 3.0, 5.0].map(|width| width / 11.5);
        assert!(shares.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{shares:?}");
    }
}
