//! Dead reckoning: where a glider went, by the speed that its polar gives and the heading that it read; and, where fixes
//! exist, the current between them.
//!
//! The speed is that of the steady glide at the pitch, ballast and density of each sample. East and north are summed by
//! the trapezoidal rule; where no steady glide balances (in a turn, at the surface) the glider is taken to stand still in
//! the water. What is left between two fixes is the water's doing:
//! ```text
//! current = (way between the fixes - way reckoned) / time between the fixes
//! ```
//! a mean over depth weighted by the time spent there, the drift at the surface in it. Errors: every figure of the
//! vehicle's `[uncertainty]` (of the speed, along the way) and one of the compass (across it), both taken as the same
//! through a dive and independent from dive to dive. Knows no files.

pub mod comparison;
mod earth;
pub mod plausibility;

use crate::dynamics::{Parameters, Surroundings};
use crate::glide::{Attitude, at_pitch};

pub use earth::{Fix, displacement_m};

/// One moment of a log, as dead reckoning needs it. NaN where something is missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time \[s\].
    pub time_s: f64,
    /// Number of the dive.
    pub dive: u32,
    /// Depth \[m\].
    pub depth_m: f64,
    /// Pitch as it was read \[rad\].
    pub pitch_rad: f64,
    /// Magnetic heading \[rad\].
    pub heading_rad: f64,
    /// Ballast volume \[m3\].
    pub ballast_m3: f64,
    /// In-situ density \[kg/m3\].
    pub density_kg_m3: f64,
    /// Temperature \[degC\].
    pub temperature_C: f64,
}

/// How to reckon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackSettings {
    /// True less magnetic heading, positive to the east \[rad\].
    pub declination_rad: f64,
    /// Standard error of the heading, the same through a dive \[rad\].
    pub heading_error_rad: f64,
    /// Standard error of the speed beyond that of the vehicle's figures, relative, the same through a dive.
    pub speed_error: f64,
    /// Above this depth the glider floats \[m\].
    pub surface_m: f64,
    /// A longer gap between two samples is not bridged \[s\].
    pub longest_gap_s: f64,
}

impl Default for TrackSettings {
    fn default() -> Self {
        let heading_error_rad = 3f64.to_radians();
        TrackSettings {
            declination_rad: 0.0,
            heading_error_rad,
            speed_error: 0.0,
            surface_m: 2.0,
            longest_gap_s: 300.0,
        }
    }
}

/// One moment of a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Time \[s\].
    pub time_s: f64,
    /// Number of the dive.
    pub dive: u32,
    /// Depth \[m\].
    pub depth_m: f64,
    /// Speed through the water by the polar; NaN where no glide balances \[m/s\].
    pub speed_m_s: f64,
    /// East of the start, through the water \[m\].
    pub east_m: f64,
    /// North of the start, through the water \[m\].
    pub north_m: f64,
}

/// One dive of a track.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct DiveTrack {
    /// Its number.
    pub dive: u32,
    /// Time of its first sample \[s\].
    pub start_s: f64,
    /// Time of its last sample \[s\].
    pub end_s: f64,
    /// Way east through the water \[m\].
    pub east_m: f64,
    /// Way north through the water \[m\].
    pub north_m: f64,
    /// Standard error of the way east \[m\].
    pub east_se_m: f64,
    /// Standard error of the way north \[m\].
    pub north_se_m: f64,
    /// Samples without a glide that balances.
    pub without_glide: usize,
    /// Time in gaps that were not bridged \[s\].
    pub gaps_s: f64,
    /// Mean current between the fixes before and after.
    pub current: Option<Current>,
}

impl DiveTrack {
    /// Its duration without the gaps \[s\].
    pub fn recorded_s(&self) -> f64 {
        self.end_s - self.start_s - self.gaps_s
    }
}

/// A depth-averaged current.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Current {
    /// To the east \[m/s\].
    pub east_m_s: f64,
    /// To the north \[m/s\].
    pub north_m_s: f64,
    /// Standard error to the east, by the way reckoned and by both fixes \[m/s\].
    pub east_se_m_s: f64,
    /// To the north \[m/s\].
    pub north_se_m_s: f64,
    /// Time from fix to fix \[s\].
    pub duration_s: f64,
}

impl Current {
    /// Its speed \[m/s\].
    pub fn speed_m_s(&self) -> f64 {
        self.east_m_s.hypot(self.north_m_s)
    }
}

/// A track through the water.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Track {
    /// Moment by moment, one for each sample.
    pub points: Vec<Point>,
    /// Dive by dive.
    pub dives: Vec<DiveTrack>,
}

/// Reckons the track of a log in order of time. `moved`: the parameters with one uncertain figure after the other moved
/// by its standard error.
pub fn reckon(
    parameters: &Parameters<f64>,
    moved: &[Parameters<f64>],
    samples: &[Sample],
    settings: &TrackSettings,
) -> Track {
    let mut track = Track::default();
    let mut before: Option<(Sample, [f64; 2])> = None;
    let mut sums: Vec<[f64; 2]> = Vec::new();
    let mut last_moved: Vec<[f64; 2]> = Vec::new();
    for sample in samples {
        if track.dives.last().is_none_or(|dive| dive.dive != sample.dive) {
            finish(&mut track, &sums, settings);
            before = None;
            sums = vec![[0.0; 2]; moved.len()];
            track.dives.push(DiveTrack {
                dive: sample.dive,
                start_s: sample.time_s,
                end_s: sample.time_s,
                east_m: 0.0,
                north_m: 0.0,
                east_se_m: 0.0,
                north_se_m: 0.0,
                without_glide: 0,
                gaps_s: 0.0,
                current: None,
            });
        }
        let (speed_m_s, velocity) = through_water(parameters, sample, settings);
        let velocities: Vec<[f64; 2]> = moved.iter().map(|p| through_water(p, sample, settings).1).collect();
        let start = track.points.last().map_or([0.0; 2], |point| [point.east_m, point.north_m]);
        let mut step = [0.0; 2];
        if let (Some(dive), Some((earlier, earlier_velocity))) = (track.dives.last_mut(), before) {
            let duration = sample.time_s - earlier.time_s;
            if duration > settings.longest_gap_s {
                dive.gaps_s += duration;
            } else {
                step = trapezoid(earlier_velocity, velocity, duration);
                for (sum, (a, b)) in sums.iter_mut().zip(last_moved.iter().zip(&velocities)) {
                    let more = trapezoid(*a, *b, duration);
                    *sum = [sum[0] + more[0], sum[1] + more[1]];
                }
            }
            dive.end_s = sample.time_s;
            dive.east_m += step[0];
            dive.north_m += step[1];
            dive.without_glide += usize::from(speed_m_s.is_nan() && sample.depth_m > settings.surface_m);
        }
        track.points.push(Point {
            time_s: sample.time_s,
            dive: sample.dive,
            depth_m: sample.depth_m,
            speed_m_s,
            east_m: start[0] + step[0],
            north_m: start[1] + step[1],
        });
        before = Some((*sample, velocity));
        last_moved = velocities;
    }
    finish(&mut track, &sums, settings);
    track
}

/// Standard errors of the dive that has ended.
fn finish(track: &mut Track, sums: &[[f64; 2]], settings: &TrackSettings) {
    let Some(dive) = track.dives.last_mut() else {
        return;
    };
    let (east, north) = (dive.east_m, dive.north_m);
    let of = |i: usize, way: f64, across: f64| {
        let figures: f64 = sums.iter().map(|sum| (sum[i] - way).powi(2)).sum();
        let speed = (settings.speed_error * way).powi(2);
        let compass = (settings.heading_error_rad * across).powi(2);
        (figures + speed + compass).sqrt()
    };
    (dive.east_se_m, dive.north_se_m) = (of(0, east, north), of(1, north, east));
}

fn trapezoid(a: [f64; 2], b: [f64; 2], duration_s: f64) -> [f64; 2] {
    [0.5 * (a[0] + b[0]) * duration_s, 0.5 * (a[1] + b[1]) * duration_s]
}

/// Speed, and velocity east and north, through the water; NaN and nothing where no glide balances.
fn through_water(p: &Parameters<f64>, sample: &Sample, settings: &TrackSettings) -> (f64, [f64; 2]) {
    if !(sample.depth_m > settings.surface_m && sample.heading_rad.is_finite() && sample.pitch_rad.is_finite()) {
        return (f64::NAN, [0.0; 2]);
    }
    let water = Surroundings {
        density_kg_m3: sample.density_kg_m3,
        pressure_Pa: p.true_density_kg_m3(sample.density_kg_m3) * p.gravity_m_s2 * sample.depth_m,
        temperature_C: if sample.temperature_C.is_finite() { sample.temperature_C } else { p.reference_temperature_C },
        time_s: 0.0,
    };
    let attitude = Attitude {
        pitch_rad: p.pitch_scale * sample.pitch_rad + p.pitch_offset_rad,
        net_mass_kg: p.net_mass_kg(sample.ballast_m3, &water),
    };
    match at_pitch(p, &water, attitude) {
        Ok(glide) => {
            let (sin, cos) = (sample.heading_rad + settings.declination_rad).sin_cos();
            let along = glide.horizontal_velocity_m_s;
            (glide.speed_m_s, [along * sin, along * cos])
        }
        Err(_) => (f64::NAN, [0.0; 2]),
    }
}

impl Track {
    /// Sets the current of each dive that lies between two fixes: the last one not later than its first sample, and the
    /// first one not earlier than its last, with no other dive between them. Fixes in order of time; `fix_error_m` is the
    /// standard error of one of them on either axis.
    pub fn set_currents(&mut self, fixes: &[Fix], fix_error_m: f64) {
        let gaps = self.long_gaps();
        let ends: Vec<(f64, f64)> = self.dives.iter().map(|dive| (dive.start_s, dive.end_s)).collect();
        for (i, dive) in self.dives.iter_mut().enumerate() {
            let before = fixes.iter().rev().find(|fix| fix.time_s <= dive.start_s + FIX_GRACE_S);
            let after = fixes.iter().find(|fix| fix.time_s >= dive.end_s - FIX_GRACE_S);
            let (Some(before), Some(after)) = (before, after) else {
                continue;
            };
            let alone = |j: usize| {
                let (start, end) = ends[j];
                end <= before.time_s + FIX_GRACE_S || start >= after.time_s - FIX_GRACE_S
            };
            let duration_s = after.time_s - before.time_s;
            let is_interrupted = is_across(&gaps, before.time_s, after.time_s);
            if duration_s <= 0.0 || is_interrupted || !(0..ends.len()).filter(|j| *j != i).all(alone) {
                continue;
            }
            let way = displacement_m(before, after);
            let with_fixes = |way_se_m: f64| way_se_m.hypot(std::f64::consts::SQRT_2 * fix_error_m);
            dive.current = Some(Current {
                east_m_s: (way[0] - dive.east_m) / duration_s,
                north_m_s: (way[1] - dive.north_m) / duration_s,
                east_se_m_s: with_fixes(dive.east_se_m) / duration_s,
                north_se_m_s: with_fixes(dive.north_se_m) / duration_s,
                duration_s,
            });
        }
    }
}

impl Track {
    /// The mean current between each two fixes that follow one another, whatever dives lie between: what is left of the
    /// way between the fixes when the way reckoned between their times is taken off. For positions in the middle of dives,
    /// and for surfacings that several dives share. `fix_error_m` as in [`Track::set_currents`].
    pub fn drifts(&self, fixes: &[Fix], fix_error_m: f64) -> Vec<Drift> {
        let (Some(first), Some(last)) = (self.points.first(), self.points.last()) else { return Vec::new() };
        let covered = |time_s: f64| time_s >= first.time_s - FIX_GRACE_S && time_s <= last.time_s + FIX_GRACE_S;
        let gaps = self.long_gaps();
        fixes
            .windows(2)
            .filter(|pair| pair[1].time_s > pair[0].time_s && covered(pair[0].time_s) && covered(pair[1].time_s))
            .filter(|pair| !is_across(&gaps, pair[0].time_s, pair[1].time_s))
            .map(|pair| {
                let (start_s, end_s) = (pair[0].time_s, pair[1].time_s);
                let ([e0, n0], [e1, n1]) = (self.place_m(start_s), self.place_m(end_s));
                let reckoned_m = [e1 - e0, n1 - n0];
                let way_m = displacement_m(&pair[0], &pair[1]);
                let duration_s = end_s - start_s;
                // The error of a dive is the same all through it: a part of the dive has that part of the error.
                let mut variance = [2.0 * fix_error_m * fix_error_m; 2];
                for dive in &self.dives {
                    let common_s = dive.end_s.min(end_s) - dive.start_s.max(start_s);
                    if common_s > 0.0 && dive.end_s > dive.start_s {
                        let share = common_s / (dive.end_s - dive.start_s);
                        variance[0] += (share * dive.east_se_m).powi(2);
                        variance[1] += (share * dive.north_se_m).powi(2);
                    }
                }
                Drift {
                    start_s,
                    end_s,
                    reckoned_east_m: reckoned_m[0],
                    reckoned_north_m: reckoned_m[1],
                    current: Current {
                        east_m_s: (way_m[0] - reckoned_m[0]) / duration_s,
                        north_m_s: (way_m[1] - reckoned_m[1]) / duration_s,
                        east_se_m_s: variance[0].sqrt() / duration_s,
                        north_se_m_s: variance[1].sqrt() / duration_s,
                        duration_s,
                    },
                }
            })
            .collect()
    }

    /// From when to when the log has no rows for so long that what the glider did meanwhile is not known.
    pub fn long_gaps(&self) -> Vec<[f64; 2]> {
        let steps = self.points.windows(2).map(|pair| [pair[0].time_s, pair[1].time_s]);
        steps.filter(|[from_s, to_s]| to_s - from_s > INTERRUPTED_S).collect()
    }

    /// Where the glider was at a time, between two samples by a straight line.
    fn place_m(&self, time_s: f64) -> [f64; 2] {
        let after = self.points.partition_point(|point| point.time_s <= time_s);
        let (Some(a), b) = (self.points.get(after.saturating_sub(1)), self.points.get(after)) else { return [0.0; 2] };
        let Some(b) = b.filter(|b| after > 0 && b.time_s > a.time_s) else { return [a.east_m, a.north_m] };
        let share = (time_s - a.time_s) / (b.time_s - a.time_s);
        [a.east_m + share * (b.east_m - a.east_m), a.north_m + share * (b.north_m - a.north_m)]
    }
}

/// The current between two fixes.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Drift {
    /// Time of the first fix \[s\].
    pub start_s: f64,
    /// Time of the second \[s\].
    pub end_s: f64,
    /// Way through the water meanwhile, to the east \[m\].
    pub reckoned_east_m: f64,
    /// To the north \[m\].
    pub reckoned_north_m: f64,
    /// The current.
    pub current: Current,
}

/// Whether one of the gaps lies between two times, in part or as a whole.
fn is_across(gaps: &[[f64; 2]], from_s: f64, to_s: f64) -> bool {
    gaps.iter().any(|gap| gap[0] < to_s && gap[1] > from_s)
}

/// A record without rows for longer is interrupted: a glider that flies surfaces and writes more often than once a day \[s\].
const INTERRUPTED_S: f64 = 86_400.0;

/// A fix this much inside a dive still belongs to its end: clocks of fix and log differ \[s\].
const FIX_GRACE_S: f64 = 60.0;

#[cfg(test)]
mod tests;
