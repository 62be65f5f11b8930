//! The times at which the drag may have jumped.
//!
//! Between legs first: few enough to be tried beside everything else. Around the one that is found, between any two bins: what
//! is caught on the way down jumps in the middle of a leg. Knows bins alone.

use crate::identify::{Bin, median_step_s};

/// Most jumps between legs that are tried.
const MOST_BETWEEN_LEGS: usize = 30;

/// Legs before the first jump: what the drag was before it has to be known.
const LEGS_BEFORE: usize = 2;

/// A time at which the drag may have jumped.
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
