//! The reliability ratio of the pitch within legs.
//!
//! The smoother (`attitude`) removes errors of the pitch that are independent from reading to reading. An error that is correlated over
//! a minute remains: it looks like a pitch that hunts, and only the velocities, which do not follow it, identify it. The glider
//! has a share of each deviation from the leg's mean pitch, the reliability ratio of errors in variables (Fuller 1987, section
//! 1.1): 1 where the pitch is what was read, 0 where all of the deviation is error. It is a parameter of the baseline. A slope
//! along the pitch within legs, which such an error makes too small, is then no evidence of a law; what the means of the legs say stays.
//!
//! Knows bins; no vehicle.

use crate::identify::Bin;

/// Its name in the baseline, and its unit.
pub const PITCH_RELIABILITY: (&str, &str) = ("pitch_reliability", "1");

/// Error of one reading of an attitude sensor's pitch that varies in time, root mean square \[rad\]: 0.05 deg, the repeatability that PNI
/// states for the TCM3 (TCM3 and TCM5 user manual, table of specifications), the Slocum's. Its accuracy of 0.2 deg
/// includes what is constant and what goes with the pitch, which is an offset or a scale.
const REPEATABILITY_RAD: f64 = 0.05 * std::f64::consts::PI / 180.0;

/// The prior of the ratio about 1, of Cauchy's form: instruments differ, and a few err by many times the usual. That is the form that
/// Gelman (2006, Bayesian Analysis 1, 515) gives a variance whose size is known roughly.
#[derive(Debug, Clone, Copy)]
pub struct Prior {
    half_width: f64,
}

impl Prior {
    /// Half of all ratios differ from 1 by less than the share of a usual error in the mean square of the deviations. The usual error is
    /// independent from reading to reading, and the mean over a bin has what is left of it; what lasts longer is the tail.
    /// Where the pitch deviates by no more than that error, all of it may be error.
    pub fn new(bins: &[Bin]) -> Prior {
        let deviations_rad = deviations_rad(bins);
        let n = bins.len().max(1) as f64;
        let mean_square = deviations_rad.iter().map(|d| d * d).sum::<f64>() / n;
        let of_error = REPEATABILITY_RAD.powi(2) * bins.iter().map(|bin| 1.0 / bin.samples as f64).sum::<f64>() / n;
        Prior { half_width: (of_error / mean_square).min(1.0) }
    }

    /// Gives the residual and its slope at this ratio: the belief less the value, and a standard deviation. Its square is twice the
    /// fall of the logarithm of the density, `2 ln(1 + x^2)` with `x` in half widths.
    pub fn at(&self, reliability: f64) -> (f64, f64) {
        let x = (1.0 - reliability) / self.half_width;
        let residual = (2.0 * (x * x).ln_1p()).sqrt();
        // The slope of the residual; at 1 it is sqrt(2).
        let slope = if residual > 0.0 { 2.0 * x.abs() / ((1.0 + x * x) * residual) } else { std::f64::consts::SQRT_2 };
        let sd = self.half_width / slope;
        (residual.copysign(x) * sd, sd)
    }
}

/// Pitch of each bin less the mean of its leg \[rad\].
pub fn deviations_rad(bins: &[Bin]) -> Vec<f64> {
    let legs = bins.chunk_by(|a, b| a.mean.leg == b.mean.leg);
    legs.flat_map(|leg| {
        let samples: usize = leg.iter().map(|bin| bin.samples).sum();
        let mean_rad = leg.iter().map(|bin| bin.mean.pitch_rad * bin.samples as f64).sum::<f64>() / samples as f64;
        leg.iter().map(move |bin| bin.mean.pitch_rad - mean_rad)
    })
    .collect()
}

/// A bin with the pitch that the glider had, where it was read to deviate by so much from its leg's.
pub fn with_pitch_of_glider(bin: &Bin, deviation_rad: f64, reliability: f64) -> Bin {
    let mut found = *bin;
    found.mean.pitch_rad += (reliability - 1.0) * deviation_rad;
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::sea::{DiagnosisSettings, SeaProblem, history};
    use crate::diagnose::{Problem, engine};
    use crate::vehicle::Vehicle;
    use rand::{RngExt, SeedableRng, rngs::StdRng};
    use rand_distr::StandardNormal;

    fn place(problem: &SeaProblem) -> usize {
        problem.baseline().iter().position(|known| *known == PITCH_RELIABILITY).expect("a parameter of the baseline")
    }

    /// The square of the residual is what Cauchy's density says, and its slope is that between two neighbours.
    #[test]
    fn the_prior_is_cauchys() {
        let prior = Prior { half_width: 0.05 };
        let residual = |reliability: f64| prior.at(reliability).0 / prior.at(reliability).1;
        for reliability in [1.4, 1.02, 1.0 + 1e-9, 0.97, 0.6, 0.0] {
            let x: f64 = (1.0 - reliability) / 0.05;
            assert!((residual(reliability).powi(2) - 2.0 * (1.0 + x * x).ln()).abs() < 1e-9);
            let between = (residual(reliability + 1e-6) - residual(reliability - 1e-6)) / 2e-6;
            let slope = -1.0 / prior.at(reliability).1;
            assert!((between / slope - 1.0).abs() < 1e-3, "{between} against {slope}");
        }
        assert_eq!(prior.at(1.0).0, 0.0);
    }

    /// A pitch that deviates by 0.3 deg, read with independent errors of 0.05 deg, eight readings to the bin: the prior is as wide as
    /// the ratio of the means over the bins differs from 1.
    #[test]
    fn the_prior_is_as_wide_as_a_usual_error_makes_the_ratio_differ() {
        let parameters = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        let log = history::tests::log(&parameters);
        let one = crate::identify::bins(&log, usize::MAX, 1)[0];
        let mut rng = StdRng::seed_from_u64(3);
        let (mut along, mut squares) = (0.0, 0.0);
        let bins: Vec<Bin> = (0..20_000)
            .map(|i| {
                let of_glider = 0.3f64.to_radians() * 2_f64.sqrt() * (f64::from(i) * 0.1).sin();
                let errors = (0..8).map(|_| 0.05f64.to_radians() * rng.sample::<f64, _>(StandardNormal));
                let read = of_glider + errors.sum::<f64>() / 8.0;
                along += of_glider * read;
                squares += read * read;
                let mut bin = Bin { samples: 8, ..one };
                (bin.mean.pitch_rad, bin.mean.leg) = (read, 0);
                bin
            })
            .collect();
        let (half_width, differs) = (Prior::new(&bins).half_width, 1.0 - along / squares);
        assert!((half_width / differs - 1.0).abs() < 0.2, "{half_width} and {differs}");
        let alike = |pitch_rad: f64| {
            let mut bin = Bin { samples: 1, ..one };
            bin.mean.pitch_rad = pitch_rad;
            bin
        };
        assert_eq!(Prior::new(&[alike(5e-4), alike(-5e-4)]).half_width, 1.0);
        assert_eq!(Prior::new(&[alike(0.1), alike(0.1)]).half_width, 1.0);
    }

    #[test]
    fn the_column_is_the_change_of_what_is_read() {
        let parameters = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        let log = history::tests::log(&parameters);
        let problem = SeaProblem::new(&log, &parameters, DiagnosisSettings::default()).expect("enough bins");
        let mut point = problem.start();
        let before = problem.evidence(&point);
        point.baseline[place(&problem)] -= 0.1;
        let change = &before.residual - problem.evidence(&point).residual;
        let column = before.baseline.column(place(&problem)) * -0.1;
        let (most, off) = (column.amax(), (&change - &column).amax());
        assert!(most > 1e-4 && off < 0.03 * most, "{off} of {most} m/s");
    }

    /// A pitch that hunts by a degree, read with errors of its period and of another phase on each leg: the fit finds the share of the
    /// deviations that the glider had, which here is known.
    #[test]
    fn errors_that_last_are_told_from_a_pitch_that_hunts() {
        let parameters = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        let log = history::tests::log(&parameters);
        let problem_of =
            |log: &[_]| SeaProblem::new(log, &parameters, DiagnosisSettings::default()).expect("enough bins");
        let fitted = |problem: &SeaProblem| engine::baseline(problem).0.point.baseline[place(problem)];
        let exact = problem_of(&log);
        assert!((fitted(&exact) - 1.0).abs() < 0.02, "{}", fitted(&exact));

        let mut read = log.clone();
        for o in &mut read {
            let phase = 2.4 * f64::from(o.leg);
            o.pitch_rad += 0.014 * (o.time_s / 90.0 + phase).sin();
        }
        let problem = problem_of(&read);
        let (of_glider, as_read) = (deviations_rad(&exact.bins), deviations_rad(&problem.bins));
        assert_eq!(of_glider.len(), as_read.len());
        let along: f64 = of_glider.iter().zip(&as_read).map(|(a, b)| a * b).sum();
        let expected = along / as_read.iter().map(|b| b * b).sum::<f64>();
        let found = fitted(&problem);
        assert!(expected < 0.8 && (found - expected).abs() < 0.1, "{found} against {expected}");
    }
}
