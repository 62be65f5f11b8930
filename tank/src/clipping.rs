//! Channels that ran into the end of their range, or never left their place.

use std::path::Path;

use glidepolar_input::{InputError, Place};

use crate::campaign::{Kind, Run};
use crate::history::History;

/// The balance's columns.
pub const NAMES: [&str; 3] = ["AF_N", "SF_N", "YM_N_m"];
/// So many successive samples at the very same extreme value at least are a sign of a clipped channel.
const STUCK_SAMPLES: usize = 5;
/// The probability of so long a stretch below which it did not come by chance. A campaign of 1000 runs has 6000 limits: one
/// sound run in 17 campaigns is refused.
const BY_CHANCE: f64 = 1e-5;
/// No balance reads more, in N or N m.
const LARGEST: f64 = 1e9;
/// So many distinct values a free reading has at least; fewer, and the recorder is merely coarse.
const DISTINCT: usize = 24;

/// Looks for channels whose largest or smallest value stands still, or is none that a balance reads.
///
/// # Errors
/// Where one does, with the line where it begins.
pub fn check(history: &History, file: &Path) -> Result<(), InputError> {
    for (channel, name) in history.channels().into_iter().zip(NAMES) {
        let high = channel.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let low = channel.iter().copied().fold(f64::INFINITY, f64::min);
        if high > LARGEST || low < -LARGEST {
            let at = channel.iter().position(|x| x.abs() > LARGEST).unwrap_or(0);
            let problem = format!("{name} is {:e}, expected a reading of a balance, within {LARGEST:e}", channel[at]);
            return Err(InputError::new(Place::line(file, at + 2), problem));
        }
        for limit in [high, low] {
            let Some((at, length)) = longest_at(channel, limit) else { continue };
            if is_clipped(channel, [low, high], length) {
                // The header is line 1.
                let place = Place::line(file, at + 2);
                let problem = format!("{name} stands at {limit} for {length} samples: the channel is clipped");
                return Err(InputError::new(place, problem).help("repeat the run in a wider range of the balance"));
            }
        }
    }
    Ok(())
}

/// Looks for channels that show one value from rest to rest, where the run must load them.
///
/// # Errors
/// Where one does.
pub fn check_alive(history: &History, run: &Run) -> Result<(), InputError> {
    let askew = run.yaw_deg.abs() > 0.5 || matches!(run.kind, Kind::Sway | Kind::Yaw | Kind::Arc);
    for (channel, (values, name)) in history.channels().into_iter().zip(NAMES).enumerate() {
        let is_loaded = run.kind != Kind::Zero && (channel == 0 || askew);
        if is_loaded && values.iter().all(|x| *x == values[0]) {
            let problem = format!("{name} is {} in every row of a run under way: the channel is dead", values[0]);
            return Err(InputError::new(Place::file(&run.file), problem)
                .help("is it connected, and was the right column exported?"));
        }
    }
    Ok(())
}

/// The longest unbroken stretch at a value.
fn longest_at(channel: &[f64], value: f64) -> Option<(usize, usize)> {
    let (mut best, mut length) = ((0, 0), 0);
    for (i, x) in channel.iter().enumerate() {
        length = if *x == value { length + 1 } else { 0 };
        if length > best.1 {
            best = (i + 1 - length, length);
        }
    }
    (best.1 > 0).then_some(best)
}

/// Whether a stretch of `length` equal samples at one of the limits is longer than chance makes it.
fn is_clipped(channel: &[f64], limits: [f64; 2], length: usize) -> bool {
    length >= STUCK_SAMPLES && is_fine(channel) && stretch_by_chance(channel, limits, length) < BY_CHANCE
}

/// Expected number of stretches of `length` equal samples at an extreme of a free reading: each sample repeats the one before
/// as often as it does away from the limits, which a quiet channel on a coarse recorder does often.
fn stretch_by_chance(channel: &[f64], limits: [f64; 2], length: usize) -> f64 {
    let free = |pair: &&[f64]| pair.iter().all(|value| !limits.contains(value));
    let pairs = channel.windows(2).filter(free);
    let (all, equal) =
        pairs.fold((0usize, 0usize), |(all, equal), pair| (all + 1, equal + usize::from(pair[0] == pair[1])));
    // One more of each: a share that was never seen is not zero.
    let repeats = (equal + 1) as f64 / (all + 2) as f64;
    channel.len() as f64 * repeats.powi(length as i32 - 1)
}

/// Whether the channel resolves its noise: a constant channel, or one of a few steps, is no sign of clipping.
pub fn is_fine(channel: &[f64]) -> bool {
    let mut values: Vec<u64> = channel.iter().step_by((channel.len() / 512).max(1)).map(|x| x.to_bits()).collect();
    values.sort_unstable();
    values.dedup();
    values.len() >= DISTINCT
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ramp to a steady load with a deterministic ripple, as a recorder of this resolution writes it.
    fn recorded(ripple_n: f64, step_n: f64) -> Vec<f64> {
        let at = |i: usize| {
            let time_s = i as f64 / 100.0;
            let load = 2.0 * (time_s / 5.0).min(1.0) + ripple_n * ((7.3 * time_s).sin() + (31.7 * time_s).cos());
            (load / step_n).round() * step_n
        };
        (0..3000).map(at).collect()
    }

    fn stands_too_long(channel: &[f64]) -> bool {
        let high = channel.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let low = channel.iter().copied().fold(f64::INFINITY, f64::min);
        let (_, length) = longest_at(channel, high).expect("a sample at its own maximum");
        is_clipped(channel, [low, high], length)
    }

    #[test]
    fn a_quiet_channel_on_a_coarse_recorder_is_not_clipped() {
        let quiet = recorded(0.01, 0.01);
        assert!(is_fine(&quiet), "the ramp alone has as many values as a free reading");
        assert!(!stands_too_long(&quiet));
    }

    #[test]
    fn a_channel_cut_off_at_its_range_is_clipped() {
        let cut: Vec<f64> = recorded(0.1, 1e-4).into_iter().map(|x| x.min(2.02)).collect();
        assert!(stands_too_long(&cut));
    }
}
