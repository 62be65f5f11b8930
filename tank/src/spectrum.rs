//! Shape of the noise at low frequencies, shared over all records of a campaign.
//!
//! A record of ten or twenty seconds shows the density at the lowest frequencies by a few squares only. Its level may be
//! its own, its shape is the rig's: `S(f) = white + (1 - white)/(1 + (f/corner)^2)`, noise of first order above a white
//! floor, by the greatest likelihood of all records' squares together (Whittle 1953, Arkiv foer Matematik 2, 423-434).
//! With the shape known every square counts for the level, and the variance of a mean over T follows from the
//! autocovariance of the first-order part, `2 sigma^2 tau/T (1 - tau/T (1 - exp(-T/tau)))`, whether T is long beside
//! tau or not. Knows records; no channel's meaning.

use nalgebra::Matrix3;

use crate::series::Mean3;

/// Squares that enter: those below this frequency, so many at least and at most. Carriages are uneven from some 0.15 Hz on.
const BELOW_HZ: f64 = 0.15;
const FEWEST: usize = 4;
/// Shares of the white floor that are tried.
const FLOORS: [f64; 6] = [0.0, 0.03, 0.1, 0.25, 0.5, 1.0];
/// Corners that are tried: time constants of 8 s to 0.1 s \[Hz\]. A slower process is a drift of the record's zero.
const CORNERS_HZ: [f64; 8] = [0.02, 0.035, 0.06, 0.1, 0.2, 0.4, 0.8, 1.6];
/// Fewest records from which a shape is estimated; below, it is flat.
const FEWEST_RECORDS: usize = 6;

/// Density against frequency, 1 at frequency zero.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Shape {
    floor: f64,
    corner_hz: f64,
}

const FLAT: Shape = Shape { floor: 1.0, corner_hz: 1.0 };

impl Shape {
    fn at(&self, hz: f64) -> f64 {
        self.floor + (1.0 - self.floor) / (1.0 + (hz / self.corner_hz).powi(2))
    }

    /// Variance of a mean, times its length, over the density at frequency zero.
    fn of_mean(&self, duration_s: f64) -> f64 {
        let lengths = duration_s * std::f64::consts::TAU * self.corner_hz;
        self.floor + (1.0 - self.floor) * (1.0 - (1.0 - (-lengths).exp()) / lengths)
    }
}

/// Gives every record the covariance of its mean by its own level and the shape that all of them share.
pub fn share(records: &mut [&mut Mean3]) {
    let shapes = [0, 1, 2].map(|channel| {
        let squares: Vec<(f64, Vec<f64>)> = records
            .iter()
            .map(|record| {
                let used = count(record.duration_s);
                (record.duration_s, record.transforms[..used].iter().map(|t| t[channel].powi(2)).collect())
            })
            .collect();
        fit(&squares)
    });
    for record in records {
        let used = count(record.duration_s);
        let of_mean = shapes.map(|shape| shape.of_mean(record.duration_s).sqrt());
        let mut covariance = Matrix3::zeros();
        for (j, transform) in record.transforms[..used].iter().enumerate() {
            let hz = frequency(j, record.duration_s);
            let scaled = transform.map_with_location(|i, _, value| value * of_mean[i] / shapes[i].at(hz).sqrt());
            covariance += scaled * scaled.transpose();
        }
        record.covariance = covariance / (used * record.samples) as f64;
        record.dof = used as f64;
    }
}

fn frequency(j: usize, duration_s: f64) -> f64 {
    (j + 1) as f64 / (2.0 * duration_s)
}

fn count(duration_s: f64) -> usize {
    ((2.0 * BELOW_HZ * duration_s).round() as usize).clamp(FEWEST, crate::series::TRANSFORMS)
}

/// The shape of greatest likelihood, every record's own level being the best for it.
fn fit(records: &[(f64, Vec<f64>)]) -> Shape {
    if records.len() < FEWEST_RECORDS {
        return FLAT;
    }
    let misfit = |shape: &Shape| -> f64 {
        records
            .iter()
            .map(|(duration_s, squares)| {
                let densities: Vec<f64> = (0..squares.len()).map(|j| shape.at(frequency(j, *duration_s))).collect();
                let level = squares.iter().zip(&densities).map(|(square, density)| square / density).sum::<f64>();
                squares.len() as f64 * level.max(f64::MIN_POSITIVE).ln() + densities.iter().map(|d| d.ln()).sum::<f64>()
            })
            .sum()
    };
    let tried = FLOORS[..5].iter().flat_map(|floor| CORNERS_HZ.map(|corner_hz| Shape { floor: *floor, corner_hz }));
    let best = tried.map(|shape| (misfit(&shape), shape)).min_by(|a, b| a.0.total_cmp(&b.0));
    // Two numbers more must be worth their cost (Akaike 1974); the likelihood is that of squares on one degree of freedom.
    match best {
        Some((left, shape)) if 0.5 * left < 0.5 * misfit(&FLAT) - 2.0 => shape,
        _ => FLAT,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    /// Records of 8 s of first-order noise of 2 s above a white floor: their means scatter as the shared shape says,
    /// where the lowest two squares of each alone say half of it.
    #[test]
    fn means_of_short_records_scatter_as_the_shared_shape_says() {
        let mut rng = rand::rngs::StdRng::seed_from_u64(3);
        for (tau_s, white) in [(2.0, 0.05), (0.4, 0.15), (1e-3, 0.1)] {
            let (n, interval_s, records) = (400, 0.02, 300);
            let kept = f64::exp(-interval_s / tau_s);
            let mut found: Vec<Mean3> = (0..records)
                .map(|_| {
                    let mut slow: f64 = rng.sample(StandardNormal);
                    let samples: Vec<f64> = (0..n)
                        .map(|_| {
                            slow = kept * slow + (1.0 - kept * kept).sqrt() * rng.sample::<f64, _>(StandardNormal);
                            0.12 * slow + white * rng.sample::<f64, _>(StandardNormal)
                        })
                        .collect();
                    Mean3::new([&samples, &samples, &samples], interval_s)
                })
                .collect();
            share(&mut found.iter_mut().collect::<Vec<_>>());
            let stated = found.iter().map(|mean| mean.covariance[(0, 0)]).sum::<f64>() / f64::from(records);
            let sample_variance = found.iter().map(|mean| mean.mean[0].powi(2)).sum::<f64>() / f64::from(records);
            assert!((0.75..1.35).contains(&(stated / sample_variance)), "tau {tau_s}: {stated} {sample_variance}");
        }
    }
}
