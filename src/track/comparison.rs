//! Currents found against currents that somebody else found from the same fixes: how far apart, and how much of that one
//! error of the compass and one of the speed would make. Knows no files.

use serde::Serialize;

use super::{DiveTrack, Drift};

/// A current that the table of fixes has beside a fix: time of the fix, east, north.
pub type Stored = (f64, f64, f64);

/// Currents found against currents stored beside the fixes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// How many.
    pub dives: usize,
    /// Found less stored, to the east \[m/s\].
    pub mean_difference_east_m_s: f64,
    /// To the north \[m/s\].
    pub mean_difference_north_m_s: f64,
    /// Root mean square of the differences \[m/s\].
    pub rms_difference_m_s: f64,
    /// Turn of the reckoned ways, positive to the east, that would bring both closest together.
    pub turn_deg: f64,
    /// Factor on the reckoned ways that would, together with the turn.
    pub factor: f64,
    /// What would be left \[m/s\].
    pub rms_left_m_s: f64,
}

/// A way reckoned, as a mean velocity, and the current found less the current stored.
pub type Pair = ([f64; 2], [f64; 2]);

/// Dive by dive.
pub fn by_dive(dives: &[DiveTrack], stored: &[Stored]) -> Vec<Pair> {
    let near = |dive: &DiveTrack| {
        stored.iter().filter(|(time, ..)| *time <= dive.start_s + 60.0).max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let pair = |dive: &DiveTrack| {
        let (current, (_, east, north)) = (dive.current?, near(dive)?);
        let mean = [dive.east_m / current.duration_s, dive.north_m / current.duration_s];
        Some((mean, [current.east_m_s - east, current.north_m_s - north]))
    };
    dives.iter().filter_map(pair).collect()
}

/// From the middle of one dive to that of the next: half of both dives' stored currents.
pub fn by_drift(drifts: &[Drift], stored: &[Stored]) -> Vec<Pair> {
    let at = |time_s: f64| stored.iter().find(|(time, ..)| *time == time_s);
    let pair = |drift: &Drift| {
        let ((_, e0, n0), (_, e1, n1)) = (at(drift.start_s)?, at(drift.end_s)?);
        let current = drift.current;
        let mean = [drift.reckoned_east_m / current.duration_s, drift.reckoned_north_m / current.duration_s];
        Some((mean, [current.east_m_s - 0.5 * (e0 + e1), current.north_m_s - 0.5 * (n0 + n1)]))
    };
    drifts.iter().filter_map(pair).collect()
}

impl Comparison {
    /// The difference of two currents from the same fixes is that of the two reckoned ways, over time. How much of it
    /// is one compass error and one error of speed: a turn and a factor of the ways, by least squares.
    pub fn new(pairs: &[Pair]) -> Option<Self> {
        if pairs.len() < 2 {
            return None;
        }
        let n = pairs.len() as f64;
        // The stored currents' own ways are ours plus the difference; (c, s) turns and stretches ours into theirs.
        let (mut power, mut cosine, mut sine) = (0.0, 0.0, 0.0);
        for ([e, north], [de, dn]) in pairs {
            let (te, tn) = (e + de, north + dn);
            power += e * e + north * north;
            cosine += e * te + north * tn;
            sine += te * north - tn * e;
        }
        let (c, s) = (cosine / power, sine / power);
        let left = |[e, north]: [f64; 2], [de, dn]: [f64; 2]| {
            (e + de - c * e - s * north).powi(2) + (north + dn - c * north + s * e).powi(2)
        };
        let mean = |of: &dyn Fn(&Pair) -> f64| pairs.iter().map(of).sum::<f64>() / n;
        Some(Comparison {
            dives: pairs.len(),
            mean_difference_east_m_s: mean(&|(_, d)| d[0]),
            mean_difference_north_m_s: mean(&|(_, d)| d[1]),
            rms_difference_m_s: mean(&|(_, d)| d[0] * d[0] + d[1] * d[1]).sqrt(),
            turn_deg: s.atan2(c).to_degrees(),
            factor: c.hypot(s),
            rms_left_m_s: mean(&|(way, d)| left(*way, *d)).sqrt(),
        })
    }

    /// The same in words.
    pub fn sentence(&self) -> String {
        format!(
            "Against the stored currents of {} dives: mean difference {:+.3} m/s east, {:+.3} north, rms {:.3}; a turn of \
             the ways by {:+.1} deg and a factor {:.3} would leave {:.3} m/s.",
            self.dives,
            self.mean_difference_east_m_s,
            self.mean_difference_north_m_s,
            self.rms_difference_m_s,
            self.turn_deg,
            self.factor,
            self.rms_left_m_s
        )
    }
}
