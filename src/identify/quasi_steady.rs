//! Whether the dives follow a glider without inertia better than one with it.
//!
//! A real glider has inertia. A log that was simulated from steady glides has none, and a fit with it would take the lag of the speed in a
//! thermocline, or while the pump runs, for drag. Knows a fit and its dives.

use super::data::Dive;
use super::evaluate::evaluate;
use super::joint::{IdentifyError, JointFit, Question, fit};
use glidepolar_inference::estimate::student_975;
use glidepolar_inference::gram::Gram;
use glidepolar_inference::relevance::SHARE_OF_SCATTER;

/// Dives without which no comparison is made: of fewer the scatter is hardly known.
const LEAST_DIVES: usize = 4;

/// The warning for such a log.
pub(super) const WARNING: &str = "the log follows a glide without inertia better than one with it, as a log that was simulated from steady glides does: it is fitted without";

/// Fits the dives, and takes them for those of a glider without inertia from then on where they follow one better for certain.
///
/// # Errors
/// As [`fit`].
pub(super) fn fit_with_inertia_or_without(
    question: &Question,
    dives: &mut Vec<Dive>,
) -> Result<JointFit, IdentifyError> {
    let fitted = fit(question, dives)?;
    let Some((steady, found)) = without_inertia_if_better(question, &fitted, dives) else { return Ok(fitted) };
    *dives = steady;
    Ok(found)
}

/// The dives without inertia and their fit, where the squares fall for certain, 97.5 % by what single dives gain, by what is worth
/// acting on: a tenth of the scatter in quadrature.
fn without_inertia_if_better(question: &Question, fitted: &JointFit, dives: &[Dive]) -> Option<(Vec<Dive>, JointFit)> {
    if dives.len() < LEAST_DIVES || dives.iter().any(Dive::is_quasi_steady) {
        return None;
    }
    let mut steady: Vec<Dive> = dives.iter().map(|dive| dive.clone().without_inertia()).collect();
    let nearby = Question { baseline: fitted.parameters, several_starts: false, ..question.clone() };
    let found = fit(&nearby, &mut steady).ok()?;
    let mut grams = vec![Gram::new(found.free.len()); steady.len()];
    evaluate(&found.parameters, &found.free, fitted.weights, &mut steady, &mut grams, 1);
    let gains: Vec<f64> = fitted
        .grams
        .iter()
        .zip(&grams)
        .map(|(with, without)| with.sum_of_squares() - without.sum_of_squares())
        .collect();
    let n = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / n;
    let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let certain = n * (mean - student_975(n - 1.0) * (variance / n).sqrt());
    let all: f64 = fitted.grams.iter().map(Gram::sum_of_squares).sum();
    (certain > SHARE_OF_SCATTER * SHARE_OF_SCATTER * all).then_some((steady, found))
}

#[cfg(test)]
mod tests {
    use super::super::inertia::tests::leg;
    use super::super::model::surroundings;
    use super::super::tests::{glider, sample};
    use super::super::{Identification, Request, Trim, identify};
    use super::*;
    use crate::dynamics::Parameters;
    use crate::log::Observation;

    /// Net mass over that of a steady glide at 0.3 m/s while a pump runs through most of a leg.
    fn pumped(time_s: f64) -> f64 {
        (1.0 + time_s / 300.0).min(2.5)
    }

    /// Twelve dives of such a leg down and the same one up, in water that moves by some mm/s.
    fn flown(p: &Parameters<f64>, down: &[Observation]) -> Identification {
        let mut all = Vec::new();
        for (i, up) in (0..24u32).map(|i| (i, i % 2 == 1)) {
            let moves_m_s = 4e-3 * f64::from(i * 37 % 23) / 11.0 - 4e-3;
            for o in down {
                let mut o = Observation { time_s: o.time_s + 1000.0 * f64::from(i), leg: i, dive: i / 2, ..*o };
                if up {
                    let net_kg = p.net_mass_kg(o.ballast_m3, &surroundings(p, &o));
                    o.ballast_m3 += 2.0 * net_kg / p.true_density_kg_m3(o.density_kg_m3);
                    (o.pitch_rad, o.sink_m_s) = (-o.pitch_rad, -o.sink_m_s);
                }
                o.sink_m_s += moves_m_s * (o.time_s / 200.0).sin();
                all.push(o);
            }
        }
        let (mut vehicle, _) = glider();
        // At one path angle the speeds do not tell these.
        for (key, value) in [("hydro.a_per_rad", p.a_per_rad), ("hydro.c_per_rad2", p.c_per_rad2)] {
            vehicle.set(key, value).expect("a key of a vehicle");
        }
        identify(&vehicle, &all, &Request { trim: Trim::Vehicle, free: Vec::new(), pin: Vec::new(), unsteady: None })
            .expect("a polar")
    }

    fn b_of(found: &Identification) -> f64 {
        found.fit.parameters.b
    }

    #[test]
    fn a_log_of_steady_glides_is_fitted_without_inertia_and_a_flight_with_it() {
        let (_, p) = glider();
        let by_newton: Vec<Observation> = leg(&p, 5.0, 1.0, pumped).into_iter().map(|(o, _)| o).collect();
        let steady: Vec<Observation> = by_newton
            .iter()
            .map(|o| {
                let glide = sample(&p, -27.0, 0.3 * pumped(o.time_s).sqrt(), 0, o.time_s);
                Observation { pitch_rad: glide.pitch_rad, sink_m_s: glide.sink_m_s, speed_m_s: glide.speed_m_s, ..*o }
            })
            .collect();
        for (down, is_quasi_steady) in [(&by_newton, false), (&steady, true)] {
            let found = flown(&p, down);
            assert_eq!(found.dives.iter().all(Dive::is_quasi_steady), is_quasi_steady);
            assert_eq!(found.warnings.iter().any(|text| text == WARNING), is_quasi_steady, "{:?}", found.warnings);
            assert!((b_of(&found) / p.b - 1.0).abs() < 0.01, "b {} for {}", b_of(&found), p.b);
        }
    }
}
