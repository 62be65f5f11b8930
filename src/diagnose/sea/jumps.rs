//! The times at which something may have been lost or caught.
//!
//! Between legs first: few enough to be tried beside everything else. Around the one that is found, between any two bins: what
//! is caught on the way down jumps in the middle of a leg. Knows bins alone.

use crate::identify::{Bin, median_step_s};

/// Mechanisms that come at one time, each tried at the same ones.
pub const MECHANISMS: [&str; 2] = ["drag_step", "net_mass_step"];

/// Most jumps between legs that are tried.
const MOST_BETWEEN_LEGS: usize = 30;

/// Legs before the first jump: what drag and net mass were before it has to be known.
const LEGS_BEFORE: usize = 2;

/// A time at which something may have been lost or caught.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// The time \[s\].
    pub time_s: f64,
    /// From the latter half of the bin before it to the middle of the bin after it \[s\]: no row tells one time in there from
    /// another, the glider taking half a minute to change its speed.
    pub between_s: [f64; 2],
}

impl Jump {
    /// The jumps between legs, evenly chosen where there are many.
    pub fn between_legs(bins: &[Bin]) -> Vec<Jump> {
        let turns = turns(bins);
        let every = turns.len().div_ceil(MOST_BETWEEN_LEGS).max(1);
        turns.into_iter().skip(LEGS_BEFORE).step_by(every).collect()
    }

    /// These jumps, and those between any two bins from the one before a time to the one after it, a descent and an ascent
    /// at least lying before each.
    pub fn between_bins(bins: &[Bin], coarse: &[Jump], time_s: f64) -> Vec<Jump> {
        let before = coarse.iter().rev().map(|jump| jump.time_s).find(|other| *other < time_s);
        let after = coarse.iter().map(|jump| jump.time_s).find(|other| *other > time_s);
        let first = turns(bins).get(LEGS_BEFORE - 1).map_or(f64::INFINITY, |turn| turn.time_s);
        let (before, after) = (before.unwrap_or(first), after.unwrap_or(f64::INFINITY));
        let is_far = |jump: &&Jump| jump.time_s <= before || jump.time_s >= after;
        let near = all(bins).filter(|jump| !is_far(&jump));
        let mut jumps: Vec<Jump> = near.chain(coarse.iter().filter(is_far).copied()).collect();
        jumps.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        jumps
    }
}

/// The jumps between any two legs.
fn turns(bins: &[Bin]) -> Vec<Jump> {
    let pairs = bins.windows(2).zip(all(bins));
    pairs.filter(|(pair, _)| pair[0].mean.leg != pair[1].mean.leg).map(|(_, jump)| jump).collect()
}

/// The jumps between any two bins.
fn all(bins: &[Bin]) -> impl Iterator<Item = Jump> {
    let half_a_bin_s = 0.5 * median_step_s(bins.iter().map(|bin| &bin.mean));
    bins.windows(2).map(move |pair| {
        let [before_s, after_s] = [0, 1].map(|i| pair[i].mean.time_s);
        Jump { time_s: 0.5 * (before_s + after_s), between_s: [before_s - half_a_bin_s, after_s] }
    })
}

#[cfg(test)]
mod tests {
    use super::super::steady_log::log;
    use super::super::{DiagnosisSettings, SeaProblem};
    use super::*;
    use crate::diagnose::Problem;
    use crate::vehicle::Vehicle;

    fn problem() -> SeaProblem {
        let parameters = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        SeaProblem::new(&log(&parameters), &parameters, DiagnosisSettings::default()).expect("enough bins")
    }

    /// The candidates of a mechanism with their times.
    fn versions(problem: &SeaProblem, mechanism: &str) -> impl Iterator<Item = (usize, f64)> {
        let of_name = problem.candidates().iter().enumerate().filter(move |(_, candidate)| candidate.name == mechanism);
        of_name.map(|(c, candidate)| (c, candidate.version.expect("a time").value))
    }

    #[test]
    fn the_column_of_every_time_is_the_change_of_what_is_read_with_the_size() {
        // What the inertia adds is no part of any slope.
        let problem = problem();
        let mut problem = SeaProblem { parts: problem.parts.without_inertia(), ..problem };
        problem.baseline.pop();
        let start = problem.start();
        let before = problem.evidence(&start);
        for (mechanism, size) in MECHANISMS.into_iter().zip([1e-3, 1e-4]) {
            let times: Vec<(usize, f64)> = versions(&problem, mechanism).collect();
            assert_eq!(times.len(), problem.tried.jumps.len(), "{mechanism}");
            for (c, at_s) in times {
                let mut point = start.clone();
                point.candidates[c][0] += size;
                let change = &before.residual - problem.evidence(&point).residual;
                let column = before.candidates[c].column(0) * size;
                let (most, off) = (column.amax(), (&change - &column).amax());
                assert!(most > 1e-5 && off < 0.002 * most, "{mechanism} at {at_s} s: {off} of {most} m/s");
                let is_still = |row: usize| before.time_s[row] >= at_s || column[row] == 0.0;
                assert!((0..column.len()).all(is_still), "{mechanism} at {at_s} s acts before it");
            }
        }
    }

    /// What may have come at another time by another mechanism is looked for as closely, about both times.
    #[test]
    fn rivals_with_times_of_their_own_are_both_refined() {
        let problem = problem();
        let first = versions(&problem, MECHANISMS[0]).next().expect("a time");
        let last = versions(&problem, MECHANISMS[1]).last().expect("a time");
        let finer = problem.with_versions_about(&[first.0, last.0]).expect("times between");
        for (mechanism, (_, at_s)) in MECHANISMS.iter().flat_map(|name| [(name, first), (name, last)]) {
            let near = |problem: &SeaProblem| {
                versions(problem, mechanism).filter(|(_, other_s)| (other_s - at_s).abs() < 800.0).count()
            };
            assert!(near(&finer) > near(&problem) + 5, "{mechanism} about {at_s} s: {}", near(&finer));
        }
    }
}
