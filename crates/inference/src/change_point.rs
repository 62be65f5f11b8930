//! Versions of one mechanism: a jump of the drag may have been at this time or at that one, of which one is taken.
//!
//! All of them run in the search, so the data have said what each explains. A version stands for a range of the value in which
//! versions differ: between two stretches of glide nothing tells when the drag jumped. Its probability goes by that range, every
//! time of a jump being as likely beforehand, and every logarithm of a time constant (of a scale nothing is known by which one unit
//! of it would be preferred: Jeffreys 1946):
//! ```text
//! onset            p_v ~ (high_v - low_v)      exp(-D_v),     D_v = (gain_best - gain_v) / 2
//! time constant    p_v ~ ln(high_v / low_v)    exp(-L_v),     L_v = min(D_v, 2 D_v^2 / V_v)
//! ```
//! where `V_v` is the variance of `D_v` by its scatter between clusters. With the right noise `V_v` is `2 D_v` near the best version, and
//! `L_v` is `D_v`. Where clusters scatter more, the likelihood is too sharp by the factor `V_v / (2 D_v)`, by which `L_v` divides it (a
//! composite likelihood: Pauli, Racugno, Ventura 2011). What tells one time of a jump from another lies in the cluster of that time
//! alone, which has no scatter. Of these is made the interval of that value, and what not knowing it adds to the uncertainty of the
//! mechanism's size.

use std::collections::BTreeMap;

use super::evidence::{Candidate, Point, Problem, Version};
use super::fitted::Fitted;
use super::iteration::Iteration;
use super::outcome::Stage;
use crate::estimate::Estimate;

/// The parameters of one member of a set by their names, at a point of the fit; the errors are those of the slopes there.
pub(super) fn estimates(
    problem: &impl Problem,
    iteration: &Iteration<'_>,
    members: &[usize],
    place: usize,
    point: &Point,
) -> BTreeMap<String, Estimate> {
    let candidate = &problem.candidates()[members[place]];
    let (rivals, taken) = rivals(problem.candidates(), iteration, members, place);
    let values = candidate.parameters.iter().zip(&point.candidates[members[place]]);
    let fitted = values.enumerate().map(|(i, ((name, unit), value))| {
        let apart = |r: &Rival| r.value[i] - rivals[taken].value[i];
        let variance: f64 = rivals.iter().map(|r| r.probability * (r.se[i].powi(2) + apart(r).powi(2))).sum();
        ((*name).to_owned(), Estimate::normal(*value, variance.sqrt(), unit))
    });
    let version = candidate.version.as_ref().map(|here| {
        let ranges: Vec<(f64, [f64; 2])> =
            rivals.iter().filter_map(|r| Some((r.probability, r.version?.between))).collect();
        (here.name.to_owned(), if here.is_onset { of_ranges(here, &ranges) } else { of_ratios(here, &ranges) })
    });
    fitted.chain(version).collect()
}

/// The parameters of an included mechanism, with errors that allow for the scatter between glides or runs.
pub(super) fn with_scatter(
    problem: &impl Problem,
    fitted: &Fitted,
    iteration: &Iteration<'_>,
    place: usize,
    stage: &Stage,
) -> BTreeMap<String, Estimate> {
    let candidates = problem.candidates();
    let first = fitted.first_parameter(candidates, place);
    let mut parameters = estimates(problem, iteration, &fitted.included, place, &fitted.point);
    for (i, (name, _)) in candidates[fitted.included[place]].parameters.iter().enumerate() {
        if let Some(size) = parameters.get_mut(*name) {
            *size = stage.with_scatter(size, first + i);
        }
    }
    parameters
}

/// A version beside the others.
struct Rival<'a> {
    probability: f64,
    value: Vec<f64>,
    se: Vec<f64>,
    version: Option<&'a Version>,
}

/// The versions that could stand in a member's place, and which of them is the member itself.
fn rivals<'a>(
    candidates: &'a [Candidate],
    iteration: &Iteration<'_>,
    members: &[usize],
    place: usize,
) -> (Vec<Rival<'a>>, usize) {
    let (member, search) = (members[place], iteration.search());
    let is_version = |i: usize| candidates[i].name == candidates[member].name && candidates[i].version.is_some();
    let versions: Vec<usize> = match candidates[member].version {
        Some(_) => (0..candidates.len()).filter(|i| is_version(*i)).collect(),
        None => vec![member],
    };
    let first: usize = members[..place].iter().map(|other| candidates[*other].parameters.len()).sum();
    let mut gains: Vec<f64> = Vec::new();
    let mut left: Vec<Vec<f64>> = Vec::new();
    let is_scale = candidates[member].version.is_some_and(|version| !version.is_onset);
    let mut found: Vec<Rival<'a>> = Vec::new();
    for &version in &versions {
        let mut set = members.to_vec();
        set[place] = version;
        let fit = iteration.score.fit(&search.columns(&set));
        let neutral = &candidates[version].neutral;
        gains.push(fit.gain);
        if is_scale {
            left.push(iteration.score.squares_by_cluster(&search.columns(&set)));
        }
        found.push(Rival {
            probability: candidates[version].version.as_ref().map_or(1.0, beforehand),
            value: neutral.iter().enumerate().map(|(i, neutral)| neutral + fit.step[first + i]).collect(),
            se: (0..neutral.len()).map(|i| fit.se(first + i)).collect(),
            version: candidates[version].version.as_ref(),
        });
    }
    let best = (0..gains.len()).max_by(|a, b| gains[*a].total_cmp(&gains[*b])).unwrap_or(0);
    for (i, rival) in found.iter_mut().enumerate() {
        let by_model = 0.5 * (gains[best] - gains[i]);
        let less = if is_scale { less_likely(by_model, [&left[best], &left[i]]) } else { by_model };
        rival.probability *= (-less).exp();
    }
    let sum: f64 = found.iter().map(|rival| rival.probability).sum();
    found.iter_mut().for_each(|rival| rival.probability /= sum.max(f64::MIN_POSITIVE));
    (found, versions.iter().position(|version| *version == member).unwrap_or(0))
}

/// How probable a version is before the data, beside the others of its mechanism.
fn beforehand(version: &Version) -> f64 {
    let [low, high] = version.between;
    if version.is_onset { high - low } else { (high / low).ln() }
}

/// By how much the logarithm of the likelihood of a version is below that of the best, by what it is below it by the model of the noise
/// and the squares that each of the two leaves in each cluster.
fn less_likely(by_model: f64, [best, other]: [&[f64]; 2]) -> f64 {
    let n = best.len() as f64;
    let differences = || other.iter().zip(best).map(|(other, best)| 0.5 * (other - best));
    let mean = differences().sum::<f64>() / n;
    let variance = differences().map(|difference| (difference - mean).powi(2)).sum::<f64>() * n / (n - 1.0);
    if n > 1.0 && variance > 0.0 { by_model.min(2.0 * by_model.powi(2) / variance) } else { by_model }
}

/// The value of a version that was taken, with the 95 % interval and the scatter about it of a mixture of even
/// distributions, each with its probability.
fn of_ranges(taken: &Version, ranges: &[(f64, [f64; 2])]) -> Estimate {
    let about = |[low, high]: [f64; 2]| {
        // Mean square distance of an even distribution from the value.
        ((high - taken.value).powi(3) - (low - taken.value).powi(3)) / (3.0 * (high - low).max(f64::MIN_POSITIVE))
    };
    let variance: f64 = ranges.iter().map(|(probability, range)| probability * about(*range)).sum();
    let below = |x: f64| -> f64 {
        let share = |[low, high]: [f64; 2]| ((x - low) / (high - low).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        ranges.iter().map(|(probability, range)| probability * share(*range)).sum()
    };
    let mut ends: Vec<f64> = ranges.iter().flat_map(|(_, range)| *range).collect();
    ends.sort_by(f64::total_cmp);
    // Between two ends the distribution function is a straight line.
    let quantile = |share: f64| {
        let after = ends.partition_point(|end| below(*end) < share).clamp(1, ends.len() - 1);
        let (low, high) = (ends[after - 1], ends[after]);
        let (below_low, below_high) = (below(low), below(high));
        low + (high - low) * ((share - below_low) / (below_high - below_low).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
    };
    let ci95 = [quantile(0.025).min(taken.value), quantile(0.975).max(taken.value)];
    Estimate { value: taken.value, se: variance.max(0.0).sqrt(), ci95, unit: taken.unit.to_owned() }
}

/// The same of a time constant: the distributions are even in its logarithm.
fn of_ratios(taken: &Version, ranges: &[(f64, [f64; 2])]) -> Estimate {
    let taken_ln = Version { value: taken.value.ln(), between: taken.between.map(f64::ln), ..*taken };
    let ranges_ln: Vec<(f64, [f64; 2])> =
        ranges.iter().map(|(probability, range)| (*probability, range.map(f64::ln))).collect();
    let found = of_ranges(&taken_ln, &ranges_ln);
    Estimate { value: taken.value, se: taken.value * found.se, ci95: found.ci95.map(f64::exp), ..found }
}

#[cfg(test)]
mod tests {
    use statrs::distribution::ContinuousCDF;

    use super::*;

    fn taken(value: f64) -> Version {
        Version { name: "step_time_s", value, is_onset: true, between: [value - 1.0, value + 1.0], unit: "s" }
    }

    /// Clusters of independent normal rows of unit variance with a mean of 0.1: the likelihood of the mean zero is below the best by half
    /// of n mean^2 by the model, and by as much by the clusters. Rows that come in fives of one value are a fifth as many.
    #[test]
    fn a_likelihood_is_as_sharp_as_its_clusters_say() {
        // Quantiles of the normal distribution in an order without a pattern.
        let normal = statrs::distribution::Normal::standard();
        let quantile = |i: usize| normal.inverse_cdf(((i * 377) % 1000) as f64 / 1000.0 + 0.0005);
        let lost = |rows: &dyn Fn(usize) -> f64| {
            let rows: Vec<f64> = (0..1000).map(|i| 0.1 + rows(i)).collect();
            let mean = rows.iter().sum::<f64>() / 1000.0;
            let left = |about: f64| -> Vec<f64> {
                rows.chunks(20).map(|rows| rows.iter().map(|row| (row - about).powi(2)).sum()).collect()
            };
            let by_model = 0.5 * 1000.0 * mean * mean;
            less_likely(by_model, [&left(mean), &left(0.0)]) / by_model
        };
        let alone = lost(&quantile);
        let in_fives = lost(&|i| quantile(i / 5 * 5));
        assert!((0.6..=1.0).contains(&alone), "{alone}");
        assert!((0.12..0.35).contains(&in_fives), "{in_fives}");
    }

    #[test]
    fn one_range_gives_an_even_distribution() {
        let found = of_ranges(&taken(5.0), &[(1.0, [0.0, 10.0])]);
        assert!((found.se - 10.0 / 12f64.sqrt()).abs() < 1e-12, "{found:?}");
        assert!((found.ci95[0] - 0.25).abs() < 1e-12 && (found.ci95[1] - 9.75).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn ranges_apart_widen_the_interval_by_their_probability() {
        let found = of_ranges(&taken(5.0), &[(0.9, [4.0, 6.0]), (0.1, [20.0, 30.0])]);
        // A fortieth lies beyond 27.5, a quarter of the far range's tenth.
        assert!((found.ci95[1] - 27.5).abs() < 1e-12, "{found:?}");
        assert!((found.ci95[0] - (4.0 + 2.0 * 0.025 / 0.9)).abs() < 1e-12, "{found:?}");
        let variance = 0.9 / 3.0 + 0.1 * (25f64.powi(3) - 15f64.powi(3)) / 30.0;
        assert!((found.se - variance.sqrt()).abs() < 1e-9, "{found:?}");
    }
}
