//! Versions of one mechanism: a jump of the drag may have been at this time or at that one, of which one is taken.
//!
//! All of them run in the search, so the data have said what each explains. A version stands for a range of the value in which
//! versions differ (between two stretches of glide nothing tells when the drag jumped), and with every value as likely
//! beforehand, its probability is
//! ```text
//! p_v ~ (high_v - low_v) exp(gain_v / 2)
//! ```
//! Of these is made the interval of that value, and what not knowing it adds to the uncertainty of the mechanism's size.

use std::collections::BTreeMap;

use super::evidence::{Candidate, Point, Problem, Version};
use super::iteration::Iteration;
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
        (here.name.to_owned(), of_ranges(here, &ranges))
    });
    fitted.chain(version).collect()
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
    let mut found: Vec<Rival<'a>> = Vec::new();
    for &version in &versions {
        let mut set = members.to_vec();
        set[place] = version;
        let fit = iteration.score.fit(&search.columns(&set));
        let neutral = &candidates[version].neutral;
        gains.push(fit.gain);
        found.push(Rival {
            probability: candidates[version].version.as_ref().map_or(1.0, |v| v.between[1] - v.between[0]),
            value: neutral.iter().enumerate().map(|(i, neutral)| neutral + fit.step[first + i]).collect(),
            se: (0..neutral.len()).map(|i| fit.se(first + i)).collect(),
            version: candidates[version].version.as_ref(),
        });
    }
    let most = gains.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    found.iter_mut().zip(&gains).for_each(|(rival, gain)| rival.probability *= (0.5 * (gain - most)).exp());
    let sum: f64 = found.iter().map(|rival| rival.probability).sum();
    found.iter_mut().for_each(|rival| rival.probability /= sum.max(f64::MIN_POSITIVE));
    (found, versions.iter().position(|version| *version == member).unwrap_or(0))
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

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(value: f64) -> Version {
        Version { name: "step_time_s", value, is_onset: true, between: [value - 1.0, value + 1.0], unit: "s" }
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
