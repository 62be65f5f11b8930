//! Means of correlated readings: a standard error that carriage vibration and slow drifts do not make too small.
//!
//! The variance of a mean is the spectral density at frequency zero over the length of the record. It is estimated from
//! the lowest cosine transforms of the record (Lazarus, Lewis, Stock and Watson 2018, J. Business & Economic Statistics
//! 36, 541-559: equal-weighted cosines): vibration at higher frequencies stays out of it, slow drifts stay in. The effective
//! number of samples is the variance of the samples over that of their mean. Knows no quantity.

use glidepolar_inference::order;
use nalgebra::{Matrix3, Vector3};

/// Lowest cosine transforms of a record that are kept.
pub const TRANSFORMS: usize = 6;
/// Most cosines that are used, and fewest.
const MOST: usize = TRANSFORMS;
const FEWEST: usize = 2;
/// Cosines below this frequency are used, below which the noise of balances is taken for flat \[Hz\].
const FLAT_BELOW_HZ: f64 = 0.08;

/// Mean of three channels with the covariance of the means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean3 {
    /// Means.
    pub mean: Vector3<f64>,
    /// Covariance of the means.
    pub covariance: Matrix3<f64>,
    /// Its degrees of freedom.
    pub dof: f64,
    /// Variance of the samples.
    pub sample_variance: Vector3<f64>,
    /// The lowest cosine transforms: their squares estimate the density, times the sampling rate, at j/(2 T).
    pub transforms: [Vector3<f64>; TRANSFORMS],
    /// Length of the record \[s\].
    pub duration_s: f64,
    /// Its samples.
    pub samples: usize,
}

impl Mean3 {
    /// Of three channels of equal length, sampled at this interval.
    pub fn new(channels: [&[f64]; 3], interval_s: f64) -> Mean3 {
        let n = channels[0].len();
        let mean = Vector3::from(channels.map(|c| c.iter().sum::<f64>() / n as f64));
        let mut covariance = Matrix3::zeros();
        // The j-th cosine has the frequency j/(2 T).
        let count = (2.0 * FLAT_BELOW_HZ * n as f64 * interval_s).round() as usize;
        let count = count.clamp(FEWEST, MOST);
        let transforms = cosines(channels);
        for transform in &transforms[..count] {
            covariance += transform * transform.transpose();
        }
        let sample_variance = Vector3::from_fn(|i, _| {
            channels[i].iter().map(|x| (x - mean[i]).powi(2)).sum::<f64>() / (n - 1).max(1) as f64
        });
        Mean3 {
            mean,
            covariance: covariance / (count * n) as f64,
            dof: count as f64,
            sample_variance,
            transforms,
            duration_s: n as f64 * interval_s,
            samples: n,
        }
    }

    /// Effective number of samples of a channel. Where a resonance dominates it is larger than their number, and not held
    /// there: successive samples then err to opposite sides, and their mean is better known than that of as many
    /// independent ones. The variance of the samples bounds that of their mean only where these are not anticorrelated.
    pub fn effective_samples(&self, channel: usize) -> f64 {
        self.sample_variance[channel] / self.covariance[(channel, channel)]
    }
}

/// The lowest cosine transforms, scaled so that their squares estimate the spectral density at zero (times the interval).
fn cosines(channels: [&[f64]; 3]) -> [Vector3<f64>; MOST] {
    let n = channels[0].len();
    let step = std::f64::consts::PI / n as f64;
    let mut transforms = [Vector3::zeros(); MOST];
    // cos(j (i + 1/2) pi/n) by the recurrence of Chebyshev.
    let [first, second, third] = channels;
    for (i, ((a, b), c)) in first.iter().zip(second).zip(third).enumerate() {
        let x = Vector3::new(*a, *b, *c);
        let first = ((i as f64 + 0.5) * step).cos();
        let (mut before, mut now) = (1.0, first);
        for transform in &mut transforms {
            *transform += x * now;
            (before, now) = (now, 2.0 * first * now - before);
        }
    }
    transforms.map(|transform| transform * (2.0 / n as f64).sqrt())
}

/// Slope of a channel over its record in units of its standard error: the first cosine against the others. Student's t on
/// five degrees of freedom where the record is stationary.
pub fn trend_t(channel: &[f64]) -> f64 {
    let transforms = cosines([channel, channel, channel]).map(|t| t[0]);
    let others = transforms[1..].iter().map(|t| t * t).sum::<f64>() / (MOST - 1) as f64;
    if others > 0.0 { -transforms[0] / others.sqrt() } else { 0.0 }
}

/// Means of successive blocks of `size` samples; an incomplete last block is left out.
pub fn block_means(channel: &[f64], size: usize) -> Vec<f64> {
    channel.chunks_exact(size.max(1)).map(|block| block.iter().sum::<f64>() / block.len() as f64).collect()
}

/// How many different values there are, where two that are the same count once.
pub fn distinct(values: impl Iterator<Item = f64>, same: impl Fn(f64, f64) -> bool) -> usize {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup_by(|a, b| same(*a, *b));
    sorted.len()
}

/// Median; not a number where there are no values.
pub fn median(values: &[f64]) -> f64 {
    order::median(&mut values.to_vec())
}

/// Standard deviation from the median absolute deviation, as for a normal distribution.
pub fn robust_sd(values: &[f64]) -> f64 {
    let centre = median(values);
    let deviations: Vec<f64> = values.iter().map(|v| (v - centre).abs()).collect();
    1.4826 * median(&deviations)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    /// White noise has the standard error of the textbook; first-order noise the one of its long-run variance
    /// `sigma^2 (1 + phi)/(1 - phi)/n`, vibration on top or not.
    #[test]
    fn standard_errors_are_those_of_correlated_noise() {
        let mut rng = rand::rngs::StdRng::seed_from_u64(5);
        for (phi, vibration) in [(0.0, 0.0), (0.9, 0.0), (0.9, 3.0)] {
            let (n, repeats) = (1250, 400);
            let mut found = 0.0;
            for _ in 0..repeats {
                let mut state = 0.0;
                let samples: Vec<f64> = (0..n)
                    .map(|i| {
                        let noise: f64 = rng.sample(StandardNormal);
                        state = phi * state + noise;
                        state + vibration * (i as f64 * 0.37).sin()
                    })
                    .collect();
                found += Mean3::new([&samples, &samples, &samples], 0.02).covariance[(0, 0)];
            }
            let expected = 1.0 / (1.0 - phi) / (1.0 - phi) / n as f64;
            let ratio = found / repeats as f64 / expected;
            assert!((0.9..1.1).contains(&ratio), "phi {phi}, vibration {vibration}: {ratio}");
        }
    }

    /// A strut that rings at 4 Hz makes the samples scatter, and their mean hardly: its standard error is that of the means of
    /// repeated records, many times smaller than the one of as many independent samples.
    #[test]
    fn a_ringing_strut_leaves_the_mean_well_known() {
        let mut rng = rand::rngs::StdRng::seed_from_u64(7);
        let (n, repeats, interval_s) = (1250, 400, 0.02);
        let (frequency, decay) = (std::f64::consts::TAU * 4.0 * interval_s, 0.98);
        let (mut variance, mut means, mut effective) = (0.0, Vec::new(), 0.0);
        for _ in 0..repeats {
            let (mut now, mut before) = (0.0, 0.0);
            let ringing = (0..n + 500).map(|_| {
                let next = 2.0 * decay * f64::cos(frequency) * now - decay * decay * before;
                (before, now) = (now, next + rng.sample::<f64, _>(StandardNormal));
                now
            });
            let samples: Vec<f64> = ringing.skip(500).collect();
            let found = Mean3::new([&samples, &samples, &samples], interval_s);
            variance += found.covariance[(0, 0)] / f64::from(repeats);
            effective += found.effective_samples(0) / f64::from(repeats);
            means.push(found.mean[0]);
        }
        let sample_variance = means.iter().map(|mean| mean * mean).sum::<f64>() / f64::from(repeats);
        assert!((0.8..1.25).contains(&(variance / sample_variance)), "{variance} {sample_variance}");
        assert!(effective > 5.0 * n as f64, "{effective}");
    }

    #[test]
    fn a_slope_is_found_and_its_sign_is_right() {
        let mut rng = rand::rngs::StdRng::seed_from_u64(6);
        let samples: Vec<f64> = (0..1000).map(|i| 0.01 * f64::from(i) + rng.sample::<f64, _>(StandardNormal)).collect();
        assert!(trend_t(&samples) > 10.0);
    }
}
