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

/// Half width of the prior about 1, of Cauchy's form: most instruments read the pitch that the glider has, and a few do not at all. By
/// simulation: a quarter of it and four times it give the same table of confusions within two logs in eighty (the evidence of the
/// diagnosis, seeds 81000 to 81003).
const HALF_WIDTH: f64 = 0.05;

/// The prior at this ratio, as a residual and its slope: the belief less the value, and a standard deviation. Its square is twice the fall of
/// the logarithm of Cauchy's density, `2 ln(1 + x^2)` with `x` in half widths. A normal prior as narrow would exclude what a
/// few instruments do; one as wide would let a law that lacks the slope along the pitch have the slope for nothing.
pub fn prior(reliability: f64) -> (f64, f64) {
    let x = (1.0 - reliability) / HALF_WIDTH;
    let residual = (2.0 * (x * x).ln_1p()).sqrt();
    // The slope of the residual; at 1 it is sqrt(2).
    let slope = if residual > 0.0 { 2.0 * x.abs() / ((1.0 + x * x) * residual) } else { std::f64::consts::SQRT_2 };
    let sd = HALF_WIDTH / slope;
    (residual.copysign(x) * sd, sd)
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
    use crate::diagnose::sea::{DiagnosisSettings, SeaProblem, steady_log};
    use crate::diagnose::{Problem, engine};
    use crate::vehicle::Vehicle;

    fn place(problem: &SeaProblem) -> usize {
        problem.baseline().iter().position(|known| *known == PITCH_RELIABILITY).expect("a parameter of the baseline")
    }

    /// The square of the residual is what Cauchy's density says, and its slope is that between two neighbours.
    #[test]
    fn the_prior_is_cauchys() {
        let residual = |reliability: f64| prior(reliability).0 / prior(reliability).1;
        for reliability in [1.4, 1.02, 1.0 + 1e-9, 0.97, 0.6, 0.0] {
            let x: f64 = (1.0 - reliability) / 0.05;
            assert!((residual(reliability).powi(2) - 2.0 * (1.0 + x * x).ln()).abs() < 1e-9);
            let between = (residual(reliability + 1e-6) - residual(reliability - 1e-6)) / 2e-6;
            let slope = -1.0 / prior(reliability).1;
            assert!((between / slope - 1.0).abs() < 1e-3, "{between} against {slope}");
        }
        assert_eq!(prior(1.0).0, 0.0);
    }

    #[test]
    fn the_column_is_the_change_of_what_is_read() {
        let parameters = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        let log = steady_log::log(&parameters);
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
        let log = steady_log::log(&parameters);
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
