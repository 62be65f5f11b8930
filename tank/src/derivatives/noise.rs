//! The noise of oscillating runs against frequency. Runs at one speed shake and drift alike: the densities that all of
//! them show beside their harmonics go through one smooth curve, since a single record tells its own noise poorly.

use nalgebra::{DMatrix, DVector};

/// Density of noise against speed and frequency.
#[derive(Debug, Clone)]
pub(super) struct Spectrum {
    curves: Vec<Curve>,
}

/// `ln density` as a polynomial in `ln frequency`, for runs at one speed.
#[derive(Debug, Clone)]
struct Curve {
    speed_m_s: f64,
    parameters: DVector<f64>,
    /// Range of `ln frequency` beyond which the curve goes on level.
    range: (f64, f64),
}

/// Densities that each parameter of a curve takes at least.
const POINTS_PER_PARAMETER: usize = 10;
const MOST_PARAMETERS: usize = 4;
const ITERATIONS: usize = 30;

impl Spectrum {
    /// Through densities as (speed of the run, frequency, density), each of two degrees of freedom.
    pub(super) fn fit(points: &[(f64, f64, f64)]) -> Spectrum {
        let mut speeds: Vec<f64> = points.iter().map(|p| p.0).collect();
        speeds.sort_by(f64::total_cmp);
        speeds.dedup();
        let curve = |speed_m_s: f64| {
            let at = points.iter().filter(|p| p.0 == speed_m_s && p.2 > 0.0).map(|p| (p.1.ln(), p.2));
            Curve::through(speed_m_s, &at.collect::<Vec<_>>())
        };
        Spectrum { curves: speeds.into_iter().map(curve).collect() }
    }

    /// Density at a frequency for runs at a speed; zero where nothing is known of it.
    pub(super) fn density(&self, speed_m_s: f64, hz: f64) -> f64 {
        let curve = self.curves.iter().find(|curve| curve.speed_m_s == speed_m_s);
        curve.map_or(0.0, |curve| curve.at(hz.ln()))
    }
}

impl Curve {
    /// Most likely curve where a density scatters about it like a mean square (a gamma distribution with logarithmic link,
    /// whose weights are all alike: McCullagh and Nelder, Generalized Linear Models, 8.3).
    fn through(speed_m_s: f64, points: &[(f64, f64)]) -> Curve {
        let mean = points.iter().map(|p| p.1).sum::<f64>() / points.len().max(1) as f64;
        let low = points.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
        let size = if high > low { (points.len() / POINTS_PER_PARAMETER).clamp(1, MOST_PARAMETERS) } else { 1 };
        let mut curve = Curve { speed_m_s, parameters: DVector::zeros(size), range: (low, high) };
        if points.is_empty() {
            curve.parameters[0] = f64::NEG_INFINITY;
            return curve;
        }
        curve.parameters[0] = mean.ln();
        let design = DMatrix::from_fn(points.len(), size, |i, j| curve.basis(points[i].0, j));
        let Some(inverse) = glidepolar_inference::covariance::inverse_if_independent(&(design.transpose() * &design))
        else {
            return curve;
        };
        let gain = inverse * design.transpose();
        for _ in 0..ITERATIONS {
            let fitted = &design * &curve.parameters;
            let step = DVector::from_fn(points.len(), |i, _| points[i].1 / fitted[i].exp() - 1.0);
            // A single large density must not throw the curve off before it has converged.
            curve.parameters += &gain * step.map(|s: f64| s.min(5.0));
        }
        curve
    }

    fn basis(&self, log_hz: f64, power: usize) -> f64 {
        let (low, high) = self.range;
        let centred = if high > low { 2.0 * (log_hz.clamp(low, high) - low) / (high - low) - 1.0 } else { 0.0 };
        centred.powi(power as i32)
    }

    fn at(&self, log_hz: f64) -> f64 {
        (0..self.parameters.len()).map(|j| self.parameters[j] * self.basis(log_hz, j)).sum::<f64>().exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    /// First-order noise of 0.8 s: density 1/(1 + (f/0.2 Hz)^2), estimated from squares that scatter by as much as themselves.
    #[test]
    fn the_density_of_first_order_noise_is_found() {
        let mut rng = rand::rngs::StdRng::seed_from_u64(4);
        let truth = |hz: f64| 3.0 / (1.0 + (hz / 0.2).powi(2));
        let frequencies = [0.05, 0.08, 0.12, 0.15, 0.24, 0.28, 0.36, 0.48, 0.56, 0.7, 0.85, 0.95];
        let mut ratios = [0.0; 3];
        for _ in 0..50 {
            let mut points = Vec::new();
            for hz in frequencies.repeat(8) {
                let [a, b]: [f64; 2] = [0; 2].map(|_| rng.sample(StandardNormal));
                points.push((2.0, hz, 0.5 * truth(hz) * (a * a + b * b)));
            }
            let spectrum = Spectrum::fit(&points);
            for (ratio, hz) in ratios.iter_mut().zip([0.1, 0.3, 0.9]) {
                *ratio += spectrum.density(2.0, hz) / truth(hz) / 50.0;
            }
        }
        assert!(ratios.iter().all(|ratio| (0.93..1.07).contains(ratio)), "{ratios:?}");
    }

    #[test]
    fn few_densities_give_their_mean_and_none_give_nothing() {
        let spectrum = Spectrum::fit(&[(2.0, 0.1, 1.0), (2.0, 0.2, 3.0)]);
        assert!((spectrum.density(2.0, 0.15) - 2.0).abs() < 1e-9);
        assert_eq!(spectrum.density(1.0, 0.15), 0.0);
    }
}
