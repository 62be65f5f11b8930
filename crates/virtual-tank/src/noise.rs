//! What disturbs a run: vibration of carriage and strut, slow and white noise of the channels, an uneven carriage,
//! coarse position sensors. Every level in one table, stated in the truth.

use serde::{Deserialize, Serialize};

use super::random::Stream;

/// Levels of everything random within a run; triples are AF N, SF N, YM N m. Forces under way belong to 2 m/s with a
/// model; slow and white noise under way grow with speed squared, vibration with speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NoiseLevels {
    /// Time constant of the slow (first-order autoregressive) noise, s.
    pub slow_time_constant_s: f64,
    /// Standard deviation of the slow noise at rest.
    pub slow_at_rest: [f64; 3],
    /// Standard deviation of the slow noise added under way.
    pub slow_under_way: [f64; 3],
    /// Standard deviation of the white noise, per sample.
    pub white: [f64; 3],
    /// Lines of the vibration, Hz; every run's own lie within 3 per cent.
    pub vibration_hz: [f64; 3],
    /// Amplitude of every vibration line.
    pub vibration: [f64; 3],
    /// Everything under way, strut alone, as a share of the same with a model.
    pub strut_alone_share: f64,
    /// Lines of the carriage's unevenness, Hz.
    pub unevenness_hz: [f64; 3],
    /// Amplitude of every line as a share of the speed.
    pub unevenness: f64,
    /// Standard deviation of the set speed as a share of it, per run; the speed column shows it.
    pub speed_setting: f64,
    /// Standard deviation of the yaw setting, deg, per run; the yaw column does not show it.
    pub yaw_setting_deg: f64,
    /// Standard deviations of the speed, yaw and sway columns, per sample: m/s, deg, m.
    pub sensors: [f64; 3],
    /// Standard deviation of noise whose density goes with one over the frequency, from 70 s to 0.05 s.
    pub flicker: [f64; 3],
    /// Share of the white noise's samples that scatter four times as far as the others.
    pub contamination: f64,
    /// Standard deviation of what every run's readings are off as a whole, zero runs included.
    pub repeatability: [f64; 3],
    /// Steps in which readings are written; none where zero.
    pub resolution: [f64; 3],
}

impl NoiseLevels {
    /// A good towing tank, everything random multiplied by `scale`.
    pub(super) fn good_tank(scale: f64) -> Self {
        let scaled = |levels: [f64; 3]| levels.map(|level| level * scale);
        Self {
            slow_time_constant_s: 0.8,
            slow_at_rest: scaled([0.02, 0.03, 0.015]),
            slow_under_way: scaled([0.08, 0.12, 0.05]),
            white: scaled([0.04, 0.06, 0.03]),
            vibration_hz: [3.1, 7.4, 13.6],
            vibration: scaled([0.4, 0.7, 0.3]),
            strut_alone_share: 0.4,
            unevenness_hz: [0.17, 0.43, 0.95],
            unevenness: 0.0006 * scale,
            speed_setting: 0.001 * scale,
            yaw_setting_deg: 0.02 * scale,
            sensors: scaled([0.001, 0.003, 0.0001]),
            flicker: [0.0; 3],
            contamination: 0.0,
            repeatability: [0.0; 3],
            resolution: [0.0; 3],
        }
    }
}

/// The disturbances of one run, sample by sample.
pub(super) struct Disturbance<'a> {
    levels: &'a NoiseLevels,
    memory: f64,
    innovation: f64,
    slow: [f64; 3],
    vibration: [[Line; 3]; 3],
    unevenness: [Line; 3],
    flicker: [[f64; FLICKER_S.len()]; 3],
    flicker_memory: [f64; FLICKER_S.len()],
    offset: [f64; 3],
}

/// Time constants whose first-order processes together have a density of one over the frequency, s.
const FLICKER_S: [f64; 5] = [0.05, 0.3, 2.0, 12.0, 70.0];
/// How much further the wide samples scatter.
const WIDE: f64 = 4.0;

/// A sine that is stepped instead of evaluated.
#[derive(Debug, Clone, Copy)]
struct Line {
    sine: f64,
    cosine: f64,
    step: (f64, f64),
    omega: f64,
}

impl<'a> Disturbance<'a> {
    pub(super) fn new(levels: &'a NoiseLevels, interval_s: f64, stream: &mut Stream) -> Self {
        let memory = (-interval_s / levels.slow_time_constant_s).exp();
        let slow = [0; 3].map(|_| stream.normal());
        let frequencies = levels.vibration_hz.map(|hz| hz * (1.0 + 0.03 * stream.between(-1.0, 1.0)));
        // A line above half the sampling rate is kept out by the filter before the converter.
        let mut vibration = [0; 3].map(|_| frequencies.map(|hz| Line::new(hz, interval_s, stream)));
        for (line, hz) in vibration.iter_mut().flat_map(|lines| lines.iter_mut().zip(frequencies)) {
            if hz > 0.45 / interval_s {
                (line.sine, line.cosine) = (0.0, 0.0);
            }
        }
        let unevenness =
            levels.unevenness_hz.map(|hz| Line::new(hz * (1.0 + 0.1 * stream.between(-1.0, 1.0)), interval_s, stream));
        let flicker = if levels.flicker == [0.0; 3] {
            [[0.0; 5]; 3]
        } else {
            [[0.0; 5]; 3].map(|row| row.map(|_: f64| stream.normal()))
        };
        let offset = if levels.repeatability == [0.0; 3] {
            [0.0; 3]
        } else {
            levels.repeatability.map(|sd| sd * stream.normal())
        };
        Self {
            levels,
            memory,
            innovation: (1.0 - memory * memory).sqrt(),
            slow,
            vibration,
            unevenness,
            flicker,
            flicker_memory: FLICKER_S.map(|s| (-interval_s / s).exp()),
            offset,
        }
    }

    /// Forces beside those of water and inertia, at `speed_share` of 2 m/s: AF, SF, YM. Advances by one sample.
    #[inline]
    pub(super) fn forces(&mut self, speed_share: f64, model_share: f64, stream: &mut Stream) -> [f64; 3] {
        let levels = self.levels;
        let flow = speed_share * speed_share * model_share;
        let mut forces = [0.0; 3];
        for (i, force) in forces.iter_mut().enumerate() {
            self.slow[i] = self.memory * self.slow[i] + self.innovation * stream.normal();
            let shaking: f64 = self.vibration[i].iter_mut().map(Line::next).sum();
            let white =
                if levels.contamination > 0.0 { contaminated(levels.contamination, stream) } else { stream.normal() };
            *force = (levels.slow_at_rest[i] + levels.slow_under_way[i] * flow) * self.slow[i]
                + levels.white[i] * white
                + levels.vibration[i] * speed_share * model_share * shaking
                + self.offset[i];
            if levels.flicker[i] > 0.0 {
                *force += levels.flicker[i] * self.flicker(i, stream);
            }
        }
        forces
    }

    /// Noise of unit variance whose density goes with one over the frequency. Advances by one sample.
    fn flicker(&mut self, channel: usize, stream: &mut Stream) -> f64 {
        let processes = &mut self.flicker[channel];
        for (state, memory) in processes.iter_mut().zip(&self.flicker_memory) {
            *state = memory * *state + (1.0 - memory * memory).sqrt() * stream.normal();
        }
        processes.iter().sum::<f64>() / (FLICKER_S.len() as f64).sqrt()
    }

    /// The carriage's unevenness as a share of its speed, and the rate of that share. Advances by one sample.
    #[inline]
    pub(super) fn unevenness(&mut self) -> (f64, f64) {
        let mut sum = (0.0, 0.0);
        for line in &mut self.unevenness {
            sum.1 += line.omega * line.cosine;
            sum.0 += line.next();
        }
        (self.levels.unevenness * sum.0, self.levels.unevenness * sum.1)
    }
}

/// Unit variance, a share of the samples wide.
fn contaminated(share: f64, stream: &mut Stream) -> f64 {
    let wide = if stream.between(0.0, 1.0) < share { WIDE } else { 1.0 };
    wide * stream.normal() / (1.0 + share * (WIDE * WIDE - 1.0)).sqrt()
}

impl Line {
    fn new(hz: f64, interval_s: f64, stream: &mut Stream) -> Self {
        let omega = std::f64::consts::TAU * hz;
        let (sine, cosine) = stream.between(0.0, std::f64::consts::TAU).sin_cos();
        Self { sine, cosine, step: (omega * interval_s).sin_cos(), omega }
    }

    #[inline]
    fn next(&mut self) -> f64 {
        let now = self.sine;
        let (ds, dc) = self.step;
        (self.sine, self.cosine) = (self.sine * dc + self.cosine * ds, self.cosine * dc - self.sine * ds);
        now
    }
}

#[cfg(test)]
mod tests {
    use super::super::random::Purpose;
    use super::*;

    /// The slow noise has its standard deviation and its time constant whatever the sampling rate.
    #[test]
    fn slow_noise_has_its_level_and_time_constant() {
        let mut levels = NoiseLevels::good_tank(1.0);
        levels.white = [0.0; 3];
        levels.vibration = [0.0; 3];
        for interval_s in [0.02, 0.1] {
            let mut stream = Stream::new(1, Purpose::Run(0));
            let mut disturbance = Disturbance::new(&levels, interval_s, &mut stream);
            let forces: Vec<f64> = (0..400_000).map(|_| disturbance.forces(1.0, 1.0, &mut stream)[1]).collect();
            let covariance = |lag: usize| {
                forces.iter().zip(&forces[lag..]).map(|(a, b)| a * b).sum::<f64>() / (forces.len() - lag) as f64
            };
            let lag = (0.8 / interval_s) as usize;
            assert!((covariance(0).sqrt() - 0.15).abs() < 0.006, "{}", covariance(0).sqrt());
            assert!(
                (covariance(lag) / covariance(0) - (-1.0f64).exp()).abs() < 0.06,
                "{}",
                covariance(lag) / covariance(0)
            );
        }
    }

    /// A stepped line is the sine it stands for.
    #[test]
    fn lines_are_sines() {
        let mut line = Line::new(7.4, 0.01, &mut Stream::new(5, Purpose::Run(1)));
        let phase = line.sine.atan2(line.cosine);
        for i in 0..5000 {
            let expected = (phase + std::f64::consts::TAU * 7.4 * 0.01 * f64::from(i)).sin();
            assert!((line.next() - expected).abs() < 1e-9);
        }
    }
}
