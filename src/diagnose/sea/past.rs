//! The samples of a log in the order of time, and quantities that follow them late.
//!
//! Knows observations; no mechanism, no bin.

use crate::log::{DBAR_PA, Observation};

/// A change of the ballast volume beyond this is a move of the engine \[m3\]: above the noise of a reading, below any stroke.
pub const MOVED_M3: f64 = 5e-6;

/// The samples of a log in the order of time; what was not measured is as before.
#[derive(Debug)]
pub struct Past {
    /// Time \[s\].
    pub time_s: Vec<f64>,
    /// Gauge pressure \[Pa\].
    pub pressure_Pa: Vec<f64>,
    /// Density in situ \[kg/m3\].
    pub density_kg_m3: Vec<f64>,
    /// Temperature \[degC\].
    pub temperature_C: Vec<f64>,
    /// Time since the ballast volume last changed \[s\].
    pub stopped_s: Vec<f64>,
    /// The largest pressure since the last ascent ended \[Pa\].
    pub turn_Pa: Vec<f64>,
    /// Whether the glider goes down.
    pub descends: Vec<bool>,
}

impl Past {
    /// From the samples of a log.
    pub fn new(samples: &[Observation]) -> Past {
        let kept = |of: fn(&Observation) -> f64| {
            let first = samples.iter().map(of).find(|value| value.is_finite()).unwrap_or(0.0);
            let mut last = first;
            let held = samples.iter().map(|o| {
                let value = of(o);
                if value.is_finite() {
                    last = value;
                }
                last
            });
            held.collect::<Vec<f64>>()
        };
        let time_s = kept(|o| o.time_s);
        let pressure_Pa = kept(|o| o.pressure_dbar * DBAR_PA);
        let ballast_m3 = kept(|o| o.ballast_m3);
        let descends: Vec<bool> = samples.iter().map(Observation::descends).collect();
        let (mut stopped_s, mut turn_Pa) = (Vec::new(), Vec::new());
        let first = |values: &[f64]| values.first().copied().unwrap_or(0.0);
        let (mut stands_m3, mut readings, mut since_s, mut turn) = (first(&ballast_m3), 0.0, first(&time_s), 0.0f64);
        for i in 0..samples.len() {
            if (ballast_m3[i] - stands_m3).abs() > MOVED_M3 {
                // It came to rest at some time since the sample before.
                (stands_m3, readings, since_s) = (ballast_m3[i], 0.0, 0.5 * (time_s[i - 1] + time_s[i]));
            }
            // The last reading of a move may be short of where the engine stands, so all readings since then say it together.
            readings += 1.0;
            stands_m3 += (ballast_m3[i] - stands_m3) / readings;
            stopped_s.push(time_s[i] - since_s);
            if descends[i] && i > 0 && !descends[i - 1] {
                turn = 0.0;
            }
            turn = turn.max(pressure_Pa[i]);
            turn_Pa.push(turn);
        }
        Past {
            pressure_Pa,
            density_kg_m3: kept(|o| o.density_kg_m3),
            temperature_C: kept(|o| o.temperature_C),
            time_s,
            stopped_s,
            turn_Pa,
            descends,
        }
    }

    /// Mean slope of a quantity that is known at the samples, on straight lines between them, over a span of time.
    pub fn slope_of(&self, values: &[f64], [from_s, to_s]: &[f64; 2]) -> f64 {
        let time_s = &self.time_s;
        let at = |t: f64| {
            let next = time_s.partition_point(|time| *time < t).clamp(1, time_s.len() - 1);
            let (t0, t1) = (time_s[next - 1], time_s[next]);
            let share = if t1 > t0 { ((t - t0) / (t1 - t0)).clamp(0.0, 1.0) } else { 0.0 };
            values[next - 1] + share * (values[next] - values[next - 1])
        };
        (at(*to_s) - at(*from_s)) / (to_s - from_s)
    }
}

/// A quantity that follows another with a time constant, from equality at the beginning; exact where that one goes along
/// straight lines between samples.
pub fn lagged(time_s: &[f64], values: &[f64], constant_s: f64) -> Vec<f64> {
    lagged_by(time_s, values, |_| constant_s)
}

/// The same with a time constant for the step to each sample.
pub fn lagged_by(time_s: &[f64], values: &[f64], constant_s: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut late = values.first().copied().unwrap_or(0.0);
    let mut found = Vec::with_capacity(values.len());
    for i in 0..values.len() {
        if i > 0 {
            let (step, from, to) = (time_s[i] - time_s[i - 1], values[i - 1], values[i]);
            let constant_s = constant_s(i);
            if step > 0.0 {
                let left = if constant_s > 0.0 { (-step / constant_s).exp() } else { 0.0 };
                let behind = constant_s * (to - from) / step;
                late = (to - behind) + (late - (from - behind)) * left;
            }
        }
        found.push(late);
    }
    found
}

/// The integral over time of a quantity that goes along straight lines between samples.
pub fn integral(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut found = Vec::with_capacity(values.len());
    for i in 0..values.len() {
        if i > 0 {
            sum += 0.5 * (values[i - 1] + values[i]) * (time_s[i] - time_s[i - 1]);
        }
        found.push(sum);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::sea::steady_log;
    use crate::vehicle::Vehicle;

    /// The last reading of a move is 4.3 cm3 short of where the engine stands: noise of 1 cm3 later is no second move.
    #[test]
    fn noise_about_where_an_engine_stands_is_no_move() {
        let ballast_cc = |i: usize| match i {
            0..10 => -150.0,
            10 => 224.8,
            20 => 230.0,
            _ => 229.1,
        };
        let leg = steady_log::log(&Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters());
        let sample = |i: usize| Observation { time_s: 3.0 * i as f64, ballast_m3: 1e-6 * ballast_cc(i), ..leg[i] };
        let past = Past::new(&(0..40).map(sample).collect::<Vec<_>>());
        // It came to rest between samples 9 and 10, as far as is known half-way.
        assert_eq!((past.stopped_s[9], past.stopped_s[10], past.stopped_s[39]), (27.0, 1.5, 88.5));
    }
}
