//! Channels that ran into the end of their range, or never left their place.

use std::path::Path;

use glidepolar_input::{InputError, Place};

use crate::campaign::{Kind, Run};
use crate::history::History;

/// The balance's columns.
pub const NAMES: [&str; 3] = ["AF_N", "SF_N", "YM_N_m"];
/// Successive samples at the very same extreme value that no free reading shows.
const STUCK_SAMPLES: usize = 5;
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
            if length >= STUCK_SAMPLES && is_fine(channel) {
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

/// Whether the channel resolves its noise: a constant channel, or one of a few steps, is no sign of clipping.
pub fn is_fine(channel: &[f64]) -> bool {
    let mut values: Vec<u64> = channel.iter().step_by((channel.len() / 512).max(1)).map(|x| x.to_bits()).collect();
    values.sort_unstable();
    values.dedup();
    values.len() >= DISTINCT
}
