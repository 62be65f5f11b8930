//! Time constants of mechanisms that go by the past: each one is a version of its mechanism. Knows no data.

use crate::diagnose::evidence::Version;

/// Time constants that are tried \[s\]: a factor of two apart (the late part of one differs from that of another half as long by a
/// fifth at most). About the one that was found the next ones are closer.
const CREEP_TIMES_S: [f64; 5] = [3600.0, 7200.0, 14_400.0, 28_800.0, 57_600.0];
const EXCHANGE_TIMES_S: [f64; 5] = [600.0, 1200.0, 2400.0, 4800.0, 9600.0];
const EXPANSION_TIMES_S: [f64; 5] = [300.0, 600.0, 1200.0, 2400.0, 4800.0];

/// Factor between neighbours of these lists.
const RATIO: f64 = 2.0;

/// Closer time constants on each side of one that was found: as many as reach half way to its neighbours.
const CLOSER: i32 = 2;

/// Time constants about one that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closer {
    about_s: f64,
    /// Factor between neighbours.
    ratio: f64,
}

impl Closer {
    /// About this version, so close that they reach half way to its neighbours.
    pub fn about(version: &Version) -> Closer {
        let [low, high] = version.between;
        Closer { about_s: version.value, ratio: (high / low).powf(0.5 / f64::from(CLOSER)) }
    }

    fn times_s(self) -> impl Iterator<Item = f64> {
        (-CLOSER..=CLOSER).map(move |step| self.about_s * self.ratio.powi(step))
    }
}

/// The versions of a mechanism of the past: its time constants, closer about one that was found, or one without any.
pub fn versions(mechanism: &str, closer: Option<Closer>) -> Vec<Option<Version>> {
    let (name, times) = match mechanism {
        "hull_creep" => ("creep_time_s", CREEP_TIMES_S),
        "late_expansion" => ("expansion_time_s", EXPANSION_TIMES_S),
        "carried_water" => ("exchange_time_s", EXCHANGE_TIMES_S),
        _ => return vec![None],
    };
    let version = |value: f64, ratio: f64| {
        let between = [value / ratio.sqrt(), value * ratio.sqrt()];
        Some(Version { name, value, is_onset: false, between, unit: "s" })
    };
    let is_far = |time_s: &f64| closer.is_none_or(|closer| (time_s / closer.about_s).ln().abs() > 0.5 * RATIO.ln());
    let far = times.into_iter().filter(is_far).map(|time_s| version(time_s, RATIO));
    let near = closer.into_iter().flat_map(|closer| closer.times_s().map(move |time_s| version(time_s, closer.ratio)));
    let mut found: Vec<Option<Version>> = far.chain(near).collect();
    found.sort_by(|a, b| a.map(|a| a.value).partial_cmp(&b.map(|b| b.value)).expect("times are finite"));
    found
}
