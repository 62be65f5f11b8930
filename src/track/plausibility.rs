//! What cannot be: currents that no sea has, which come from fixes or times that are wrong; and times without a record, which are
//! no part of a dive. In words, for whoever reads the track. Knows no files.

use super::{DiveTrack, Drift};
use crate::log::shown_time;

/// Nearly all currents at the surface of the ocean are slower, and below it they are slower still; the Gulf Stream, among
/// the fastest, has about 2.5 m/s at most at its surface \[m/s\].
const STRONGEST_M_S: f64 = 2.0;

/// Fixes that follow one another sooner are of one surfacing: between them the glider drifts, and a current is no mean over
/// depth \[s\].
const SHORTEST_DIVE_S: f64 = 300.0;

/// Names the strongest of the currents between fixes, or else of the dives, where it is stronger than nearly all of the ocean.
pub fn too_strong(drifts: &[Drift], dives: &[DiveTrack]) -> Option<String> {
    let of_drift = |drift: &Drift| {
        let place = format!("between the fixes at {} and {}", shown_time(drift.start_s), shown_time(drift.end_s));
        (drift.current.speed_m_s(), place)
    };
    let of_dive = |dive: &DiveTrack| Some((dive.current?.speed_m_s(), format!("of dive {}", dive.dive)));
    let mut all: Vec<(f64, String)> =
        drifts.iter().filter(|drift| drift.current.duration_s > SHORTEST_DIVE_S).map(of_drift).collect();
    if all.is_empty() {
        all = dives.iter().filter_map(of_dive).collect();
    }
    let strong: Vec<&(f64, String)> = all.iter().filter(|(speed, _)| *speed > STRONGEST_M_S).collect();
    let (speed, place) = strong.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "{} of {} currents exceed {STRONGEST_M_S} m/s, the largest, {speed:.2} m/s, {place}: nearly all ocean surface \
         currents are slower, and the Gulf Stream has about 2.5 m/s at most; is a fix wrong or older than its time, or is \
         part of the log missing?",
        strong.len(),
        all.len()
    ))
}

/// A gap of the log in words.
pub fn long_gap([from_s, to_s]: [f64; 2]) -> String {
    format!(
        "the log has no rows from {} to {}, {}: that time is in no duration here, and no current is given across it",
        shown_time(from_s),
        shown_time(to_s),
        shown_duration(to_s - from_s)
    )
}

/// A length of time in words.
pub fn shown_duration(duration_s: f64) -> String {
    match duration_s {
        ..7200.0 => format!("{:.0} min", duration_s / 60.0),
        ..172_800.0 => format!("{:.1} h", duration_s / 3600.0),
        _ => format!("{:.1} days", duration_s / 86_400.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::Current;

    fn drift(start_s: f64, duration_s: f64, east_m_s: f64) -> Drift {
        let current = Current { east_m_s, north_m_s: 0.0, east_se_m_s: 0.01, north_se_m_s: 0.01, duration_s };
        Drift { start_s, end_s: start_s + duration_s, reckoned_east_m: 0.0, reckoned_north_m: 0.0, current }
    }

    #[test]
    fn a_current_that_hardly_any_sea_has_is_named_with_its_time() {
        let start_s = 1_681_836_597.0;
        assert_eq!(too_strong(&[drift(start_s, 7200.0, 1.9)], &[]), None);
        // Two fixes of one surfacing a few seconds apart: their own error makes any speed.
        assert_eq!(too_strong(&[drift(start_s, 20.0, 5.0)], &[]), None);
        let found = too_strong(&[drift(start_s, 7200.0, -2.4), drift(start_s + 7200.0, 7200.0, 0.1)], &[]);
        let found = found.expect("2.4 m/s");
        for expected in ["1 of 2 currents", "2.40 m/s", "2023-04-18 16:49:57 UTC", "Gulf Stream"] {
            assert!(found.contains(expected), "{found}");
        }
    }
}
