//! The pitch behind the pitch that is read, as far as its neighbours know it: regression calibration.
//!
//! The model flies the pitch that is read. Its error enters the predicted velocities, and a curve in the same pitch: with
//! `E[error | pitch read]` not zero, noise alone makes structure (errors in variables; Fuller 1987, Carroll et al. 2006).
//! The best linear prediction of the true pitch from all readings has an error that is uncorrelated with it (Berkson), which
//! makes no structure. It is the smoother of
//!
//! ```text
//! d theta = rate dt + sqrt(q0) dW0        d rate = sqrt(q1) dW1        read_i = theta(t_i) + sqrt(r) e_i
//! ```
//!
//! on each stretch of a leg, with r, q0, q1 of greatest likelihood over the whole log: a pitch that is controlled from
//! sample to sample stays as it was read, one that hunts slowly under noise is smoothed over minutes.
//!
//! A vertical velocity from the pressure is a mean over some time, and the pitch is taken as its mean over the same time
//! ([`Observation::sink_window_s`]): read at moments, a pitch that hunts in six samples would lead to a velocity 15 % larger than
//! the one measured, by `1 - sin x / x` with `x = 2 pi step / period`. Between two samples the path is the cubic through both
//! pitches with both rates, which is the expectation where the rate is a random walk.
//!
//! Knows the readings of one instrument; no vehicle.

use crate::log::Observation;

/// A step longer than this, and than this many median ones, begins a new stretch \[s\]: what the control did in it is unknown.
const GAP_S: f64 = 60.0;
const GAP_STEPS: f64 = 3.0;

/// Noise of a reading that no instrument is better than, by its variance \[rad2\]: a thousandth of a degree.
const LEAST_VARIANCE: f64 = 3e-10;

/// Ratios of the processes' variances to the reading's that are tried first, in units of the median step.
const FIRST_RATIOS: [f64; 6] = [0.0, 1e-4, 1e-2, 1.0, 1e2, 1e4];

/// Fewest readings from which three variances are estimated.
const LEAST_READINGS: usize = 50;

/// The noise of a reading and the processes behind the pitch, as a log shows them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoother {
    ratios: Ratios,
    /// Variance of the error of a reading \[rad2\].
    pub read_variance: f64,
}

impl Smoother {
    /// Of greatest likelihood over the whole log; none where it has too few readings.
    pub fn new(observations: &[Observation]) -> Option<Smoother> {
        let stretches = stretches(observations);
        let step_s = median_step_s(observations, &stretches);
        if observations.len() < LEAST_READINGS || step_s <= 0.0 {
            return None;
        }
        let (time_s, read) = readings(observations);
        let series: Vec<(&[f64], &[f64])> =
            stretches.iter().map(|range| (&time_s[range.clone()], &read[range.clone()])).collect();
        let (ratios, variance) = most_likely(&series, step_s);
        Some(Smoother { ratios, read_variance: variance.max(LEAST_VARIANCE) })
    }

    /// Puts the smoothed pitch, as a mean over the time of the vertical velocity and as much before
    /// as `follows_s` says of each sample, in the place of the one read; returns the variance of its error in each sample \[rad2\].
    pub fn smooth(&self, observations: &mut [Observation], follows_s: &[f64]) -> Vec<f64> {
        let (time_s, read) = readings(observations);
        let mut errors = vec![0.0; observations.len()];
        for range in stretches(observations) {
            let time_s = &time_s[range.clone()];
            let found = smoothed(time_s, &read[range.clone()], self.ratios);
            let path = Path::new(time_s, &found);
            for (k, i) in range.enumerate() {
                observations[i].pitch_rad =
                    path.mean(k, observations[i].sink_window_s.map(|at| f64::from(at) - follows_s[i]));
                errors[i] = found[k].variance * self.read_variance;
            }
        }
        errors
    }
}

/// Times and pitches.
fn readings(observations: &[Observation]) -> (Vec<f64>, Vec<f64>) {
    observations.iter().map(|o| (o.time_s, o.pitch_rad)).unzip()
}

/// Variance of the error of a bin's mean pitch. The smoother's errors last as long as it looks around: their mean is no
/// better than they are; nor is it worse than the mean of the readings.
pub fn variance_of_mean(smoothed: &[f64], read_variance: f64) -> f64 {
    let n = smoothed.len().max(1) as f64;
    (smoothed.iter().sum::<f64>() / n).min(read_variance / n)
}

fn stretches(observations: &[Observation]) -> Vec<std::ops::Range<usize>> {
    let steps = observations.windows(2).filter(|pair| pair[0].leg == pair[1].leg);
    let mut steps: Vec<f64> = steps.map(|pair| pair[1].time_s - pair[0].time_s).collect();
    let gap_s = if steps.is_empty() { GAP_S } else { GAP_S.max(GAP_STEPS * crate::log::median(&mut steps)) };
    let mut found = Vec::new();
    let mut start = 0;
    for end in 1..=observations.len() {
        let ends = observations.get(end).is_none_or(|next| {
            let here = &observations[end - 1];
            next.leg != here.leg || next.time_s - here.time_s > gap_s || next.time_s <= here.time_s
        });
        if ends {
            found.push(start..end);
            start = end;
        }
    }
    found
}

fn median_step_s(observations: &[Observation], stretches: &[std::ops::Range<usize>]) -> f64 {
    let mut steps: Vec<f64> = stretches
        .iter()
        .flat_map(|range| observations[range.clone()].windows(2).map(|pair| pair[1].time_s - pair[0].time_s))
        .collect();
    if steps.is_empty() { 0.0 } else { crate::log::median(&mut steps) }
}

/// Variances per second, in units of that of a reading.
type Ratios = [f64; 2];

/// The ratios of greatest likelihood, and the variance of a reading.
fn most_likely(series: &[(&[f64], &[f64])], step_s: f64) -> (Ratios, f64) {
    // In units of what each process does in a median step.
    let per_s = |ratios: [f64; 2]| [ratios[0] / step_s, ratios[1] / step_s.powi(3)];
    let at = |ratios: [f64; 2]| likelihood(series, per_s(ratios));
    let mut best = ([0.0, 0.0], f64::NEG_INFINITY, 0.0);
    let attempt = |ratios: [f64; 2], best: &mut ([f64; 2], f64, f64)| {
        let (likelihood, variance) = at(ratios);
        if likelihood > best.1 {
            *best = (ratios, likelihood, variance);
        }
    };
    for q0 in FIRST_RATIOS {
        for q1 in FIRST_RATIOS {
            attempt([q0, q1], &mut best);
        }
    }
    for factor in [10.0, 3.0, 1.5] {
        for _ in 0..3 {
            let before = best.1;
            for i in 0..2 {
                for factor in [factor, 1.0 / factor] {
                    let mut ratios = best.0;
                    ratios[i] *= factor;
                    if ratios[i] > 0.0 {
                        attempt(ratios, &mut best);
                    }
                }
            }
            if best.1 <= before {
                break;
            }
        }
    }
    (per_s(best.0), best.2)
}

/// A state of the filter: pitch and its rate, with their covariance in units of a reading's variance.
#[derive(Clone, Copy)]
struct State {
    mean: [f64; 2],
    cov: [f64; 3],
}

/// What is known before a stretch, in the same unit: as good as nothing.
const UNKNOWN: f64 = 1e8;

impl State {
    fn begin(step_s: f64, first: f64) -> State {
        State { mean: [first, 0.0], cov: [UNKNOWN, 0.0, UNKNOWN / (step_s * step_s)] }
    }

    fn predicted(&self, step_s: f64, [q0, q1]: Ratios) -> State {
        let [a, b, d] = self.cov;
        let h = step_s;
        State {
            mean: [self.mean[0] + h * self.mean[1], self.mean[1]],
            cov: [
                a + 2.0 * h * b + h * h * d + q0 * h + q1 * h.powi(3) / 3.0,
                b + h * d + q1 * h * h / 2.0,
                d + q1 * h,
            ],
        }
    }

    /// The state after a reading, with its innovation and the innovation's variance.
    fn updated(&self, read: f64) -> (State, f64, f64) {
        let [a, b, d] = self.cov;
        let (innovation, variance) = (read - self.mean[0], a + 1.0);
        let (k0, k1) = (a / variance, b / variance);
        let after = State {
            mean: [self.mean[0] + k0 * innovation, self.mean[1] + k1 * innovation],
            cov: [a / variance, b / variance, d - k1 * b],
        };
        (after, innovation, variance)
    }
}

/// Logarithm of the likelihood with the reading's variance at its best, and that variance.
fn likelihood(series: &[(&[f64], &[f64])], ratios: Ratios) -> (f64, f64) {
    let (mut n, mut squares, mut log_determinant) = (0.0, 0.0, 0.0);
    for (time_s, read) in series.iter().filter(|(time_s, _)| time_s.len() > 2) {
        let mut state = State::begin(time_s[1] - time_s[0], read[0]);
        for i in 0..time_s.len() {
            if i > 0 {
                state = state.predicted(time_s[i] - time_s[i - 1], ratios);
            }
            let (after, innovation, variance) = state.updated(read[i]);
            state = after;
            // Two readings say where the stretch begins.
            if i >= 2 {
                n += 1.0;
                squares += innovation * innovation / variance;
                log_determinant += variance.ln();
            }
        }
    }
    if n < 1.0 {
        return (f64::NEG_INFINITY, 0.0);
    }
    let variance = (squares / n).max(1e-20);
    (-0.5 * (n * variance.ln() + log_determinant), variance)
}

/// The smoothed pitch at a reading, its rate, and the variance of the pitch's error in units of a reading's.
#[derive(Clone, Copy)]
struct Smoothed {
    pitch_rad: f64,
    rate_rad_s: f64,
    variance: f64,
}

impl Smoothed {
    fn of(state: &State) -> Smoothed {
        Smoothed { pitch_rad: state.mean[0], rate_rad_s: state.mean[1], variance: state.cov[0].max(0.0) }
    }
}

/// Smoothed values of a stretch (Rauch, Tung and Striebel 1965).
fn smoothed(time_s: &[f64], read: &[f64], ratios: Ratios) -> Vec<Smoothed> {
    if read.len() < 3 {
        return read.iter().map(|read| Smoothed { pitch_rad: *read, rate_rad_s: 0.0, variance: 1.0 }).collect();
    }
    let mut predicted = Vec::with_capacity(read.len());
    let mut filtered: Vec<State> = Vec::with_capacity(read.len());
    let mut state = State::begin(time_s[1] - time_s[0], read[0]);
    for i in 0..read.len() {
        if i > 0 {
            state = state.predicted(time_s[i] - time_s[i - 1], ratios);
        }
        predicted.push(state);
        state = state.updated(read[i]).0;
        filtered.push(state);
    }
    let mut later = filtered[read.len() - 1];
    let mut found = vec![Smoothed::of(&later)];
    for i in (0..read.len() - 1).rev() {
        let (here, next) = (filtered[i], predicted[i + 1]);
        let h = time_s[i + 1] - time_s[i];
        let ([a, b, d], [na, nb, nd]) = (here.cov, next.cov);
        // Gain C = P F' N^-1.
        let determinant = na * nd - nb * nb;
        if determinant <= 0.0 {
            later = here;
        } else {
            let (p00, p01, p10, p11) = (a + h * b, b, b + h * d, d);
            let c00 = (p00 * nd - p01 * nb) / determinant;
            let c01 = (p01 * na - p00 * nb) / determinant;
            let c10 = (p10 * nd - p11 * nb) / determinant;
            let c11 = (p11 * na - p10 * nb) / determinant;
            let (m0, m1) = (later.mean[0] - next.mean[0], later.mean[1] - next.mean[1]);
            let (e0, e1, e2) = (later.cov[0] - na, later.cov[1] - nb, later.cov[2] - nd);
            let mean = [here.mean[0] + c00 * m0 + c01 * m1, here.mean[1] + c10 * m0 + c11 * m1];
            let cov = [
                a + c00 * c00 * e0 + 2.0 * c00 * c01 * e1 + c01 * c01 * e2,
                b + c00 * c10 * e0 + (c00 * c11 + c01 * c10) * e1 + c01 * c11 * e2,
                d + c10 * c10 * e0 + 2.0 * c10 * c11 * e1 + c11 * c11 * e2,
            ];
            later = State { mean, cov };
        }
        found.push(Smoothed::of(&later));
    }
    found.reverse();
    found
}

/// The smoothed path of a stretch and its integral from the first reading.
struct Path<'a> {
    time_s: &'a [f64],
    at: &'a [Smoothed],
    integral: Vec<f64>,
}

impl<'a> Path<'a> {
    fn new(time_s: &'a [f64], at: &'a [Smoothed]) -> Self {
        let mut path = Path { time_s, at, integral: vec![0.0; at.len()] };
        for i in 1..at.len() {
            path.integral[i] = path.integral[i - 1] + path.since_reading(i - 1, 1.0);
        }
        path
    }

    /// Mean of the path over a window counted from reading `i`; where the path does not reach as far, the pitch at its middle.
    fn mean(&self, i: usize, [from_s, to_s]: [f64; 2]) -> f64 {
        let here = &self.at[i];
        let (from, to) = (self.time_s[i] + from_s, self.time_s[i] + to_s);
        if to <= from || from < self.time_s[0] || to > self.time_s[self.time_s.len() - 1] {
            return here.pitch_rad + 0.5 * (from_s + to_s) * here.rate_rad_s;
        }
        (self.integral_to(to) - self.integral_to(from)) / (to - from)
    }

    fn integral_to(&self, time_s: f64) -> f64 {
        let i = self.time_s.partition_point(|t| *t <= time_s).clamp(1, self.time_s.len() - 1) - 1;
        let share = (time_s - self.time_s[i]) / (self.time_s[i + 1] - self.time_s[i]);
        self.integral[i] + self.since_reading(i, share)
    }

    /// Integral of the cubic from reading `i` over a share of the time to the next.
    fn since_reading(&self, i: usize, u: f64) -> f64 {
        let (a, b, h) = (&self.at[i], &self.at[i + 1], self.time_s[i + 1] - self.time_s[i]);
        let (u2, u3, u4) = (u * u, u.powi(3), u.powi(4));
        let pitches = (u - u3 + u4 / 2.0) * a.pitch_rad + (u3 - u4 / 2.0) * b.pitch_rad;
        let rates = (u2 / 2.0 - 2.0 * u3 / 3.0 + u4 / 4.0) * a.rate_rad_s + (u4 / 4.0 - u3 / 3.0) * b.rate_rad_s;
        h * (pitches + h * rates)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::StdRng};
    use rand_distr::StandardNormal;

    /// Eight legs of two hundred readings, eight seconds apart, of a pitch that hunts.
    fn readings(amplitude: f64, period_s: f64, noise: f64) -> (Vec<f64>, Vec<(f64, f64)>) {
        let mut rng = StdRng::seed_from_u64(5);
        let of = |i: usize| amplitude * (std::f64::consts::TAU * 8.0 * i as f64 / period_s).sin() - 0.4;
        (0..1600).map(|i| (of(i), (8.0 * i as f64, of(i) + noise * rng.sample::<f64, _>(StandardNormal)))).unzip()
    }

    fn rms(errors: impl Iterator<Item = f64>) -> f64 {
        let (n, sum) = errors.fold((0.0, 0.0), |(n, sum), e| (n + 1.0, sum + e * e));
        (sum / n).sqrt()
    }

    fn through(amplitude: f64, period_s: f64, noise: f64) -> (f64, f64, f64) {
        let (truth, read) = readings(amplitude, period_s, noise);
        let (time_s, read): (Vec<f64>, Vec<f64>) = read.into_iter().unzip();
        let series: Vec<(&[f64], &[f64])> = time_s.chunks(200).zip(read.chunks(200)).collect();
        let (ratios, variance) = most_likely(&series, 8.0);
        let found: Vec<Smoothed> = series.iter().flat_map(|(time_s, read)| smoothed(time_s, read, ratios)).collect();
        let error = rms(found.iter().zip(&truth).map(|(found, truth)| found.pitch_rad - truth));
        // Covariance of the error with the smoothed value, relative to the variance of the value within the legs.
        let mean = found.iter().map(|found| found.pitch_rad).sum::<f64>() / 1600.0;
        let (mut with, mut of) = (0.0, 0.0);
        for (found, truth) in found.iter().zip(&truth) {
            with += (found.pitch_rad - truth) * (found.pitch_rad - mean);
            of += (found.pitch_rad - mean).powi(2);
        }
        assert!((with / of).abs() < 0.05, "the error goes with the value by {}", with / of);
        (error, variance.sqrt(), rms(found.iter().map(|found| (found.variance * variance).sqrt())))
    }

    #[test]
    fn a_slow_pitch_under_noise_is_smoothed_and_its_error_known() {
        let (error, noise, stated) = through(0.012, 1080.0, 0.004);
        assert!((noise / 0.004 - 1.0).abs() < 0.1, "{noise}");
        assert!(error < 0.0014 && (stated / error - 1.0).abs() < 0.4, "{error} {stated}");
    }

    #[test]
    fn a_pitch_that_is_read_well_stays_as_read() {
        let (error, ..) = through(0.02, 120.0, 1e-4);
        assert!(error < 1.2e-4, "{error}");
    }

    /// The mean of a sine over `+-h` is `sin x / x` of it, `x = omega h`; an irregular window has its mean at its middle.
    #[test]
    fn a_hunting_pitch_is_the_mean_over_the_time_of_the_velocity() {
        let (period_s, step_s) = (133.0, 20.0);
        let omega = std::f64::consts::TAU / period_s;
        let time_s: Vec<f64> = (0..60).map(|i| step_s * f64::from(i)).collect();
        let at: Vec<Smoothed> = time_s
            .iter()
            .map(|t| Smoothed { pitch_rad: (omega * t).sin(), rate_rad_s: omega * (omega * t).cos(), variance: 0.0 })
            .collect();
        let path = Path::new(&time_s, &at);
        for (from_s, to_s) in [(-20.0, 20.0), (-7.0, 31.0), (-3.0, 5.0)] {
            let (middle, half) = (0.5 * (from_s + to_s), 0.5 * (to_s - from_s));
            let x: f64 = omega * half;
            for i in [3, 17, 40] {
                let expected = (omega * (time_s[i] + middle)).sin() * x.sin() / x;
                let found = path.mean(i, [from_s, to_s]);
                assert!((found - expected).abs() < 2e-3, "{found} against {expected} over {from_s} to {to_s} s");
            }
        }
        // Beyond the path there is no mean: the first reading stays as it is.
        assert_eq!(path.mean(0, [-20.0, 20.0]), at[0].pitch_rad);
    }
}
