//! Where a sign changes inside an accepted step.

use super::System;
use super::method::{Method, Stretch};

/// Width to which an event is located \[s\].
pub const EVENT_WIDTH_S: f64 = 1e-9;

/// The longest time between two looks at the events \[s\]: a boundary that is crossed and crossed back inside a long step
/// shows between its ends.
const LOOK_S: f64 = 10.0;

/// The part of an accepted step in which a sign changes first, if one does.
pub fn first_change<S: System<N, F, E>, M: Method<S, N, F, E>, const N: usize, const F: usize, const E: usize>(
    stretch: &Stretch<'_, S, N>,
    method: &mut M,
    (begun_s, reached_s): (f64, f64),
    (before, after): (&[f64; E], &[f64; E]),
) -> Option<(f64, f64)> {
    let parts = ((reached_s - begun_s) / LOOK_S).ceil().max(1.0);
    let part_s = (reached_s - begun_s) / parts;
    let mut from_s = begun_s;
    for look in 1..parts as u32 {
        let time_s = begun_s + part_s * f64::from(look);
        let there = method.inside(time_s).map(|scaled| stretch.indicators(time_s, &scaled));
        if there.is_some_and(|there| sign_changes(before, &there).contains(&true)) {
            return Some((from_s, time_s));
        }
        from_s = time_s;
    }
    sign_changes(before, after).contains(&true).then_some((from_s, reached_s))
}

/// Where the first sign changes between two times inside an accepted step, by bisection on the dense output.
pub fn locate<S: System<N, F, E>, M: Method<S, N, F, E>, const N: usize, const F: usize, const E: usize>(
    stretch: &Stretch<'_, S, N>,
    method: &mut M,
    (mut low, mut high): (f64, f64),
    before: &[f64; E],
) -> (f64, [bool; E]) {
    let mut changes_at = |time: f64| {
        let scaled = method.inside(time);
        scaled.map_or([false; E], |scaled| sign_changes(before, &stretch.indicators(time, &scaled)))
    };
    let mut changed = changes_at(high);
    while high - low > EVENT_WIDTH_S.max(1e-14 * high.abs()) {
        let middle = 0.5 * (low + high);
        let there = changes_at(middle);
        if there.contains(&true) {
            (high, changed) = (middle, there);
        } else {
            low = middle;
        }
    }
    (high, changed)
}

/// Which signs differ.
pub fn sign_changes<const E: usize>(before: &[f64; E], after: &[f64; E]) -> [bool; E] {
    std::array::from_fn(|i| (before[i] >= 0.0) != (after[i] >= 0.0))
}
