//! What the errors of held parameters do to those that are fitted.
//!
//! What the data do not identify is held, at a value from outside that has an error of its own. The fitted parameters `t` answer
//! to it: with `J_t` and `J_p` the slopes of the residuals by the fitted and the held ones, the minimum moves by
//! ```text
//! m = dt/dp s = -(J_t^T J_t)^-1 J_t^T J_p s,        cov(t) = cov of the dives + sum of m m^T
//! ```
//! for one standard error `s` (Gauss and Newton's slopes). The held value itself learns nothing from the data: it was held
//! because the model is wrong by more than what they would say of it. Knows no vehicle file and no pins.

use nalgebra::{DMatrix, DVector};

use super::blocks::Blocks;
use super::considered::{Considered, Propagated};
use super::evaluate::MOST_FREE;
use super::joint::JointFit;
use glidepolar_inference::covariance::inverse_symmetric;
use glidepolar_inference::gram::Gram;

/// A move by less than this share of a parameter's own standard error is rounding.
const NOT_FELT: f64 = 1e-6;

/// Propagates the errors of fixed parameters to the standard errors of a fit. A row that was free is not fixed; an error that these
/// samples do not feel is left out.
pub(super) fn propagate(fit: &mut JointFit, samples: &mut dyn Blocks, considered: &[Considered]) {
    let mut held: Vec<usize> = considered.iter().flat_map(|one| &one.along).map(|&(row, _)| row).collect();
    held.sort_unstable();
    held.dedup();
    held.retain(|row| !fit.free.contains(row));
    if fit.free.is_empty() || held.is_empty() {
        return;
    }
    let slopes = slopes(fit, samples, &held);
    fit.propagated = considered
        .iter()
        .filter_map(|one| {
            let along: Vec<(usize, f64)> =
                one.along.iter().copied().filter(|(row, by)| held.contains(row) && *by != 0.0).collect();
            let column = |row| slopes.column(held.binary_search(&row).unwrap_or(0));
            let moves = along.iter().fold(DVector::zeros(fit.free.len()), |sum, &(row, by)| sum + column(row) * by);
            let felt =
                moves.iter().zip(fit.covariance.diagonal().iter()).any(|(by, own)| by.abs() > NOT_FELT * own.sqrt());
            felt.then(|| Propagated {
                considered: Considered { along, ..one.clone() },
                moves: moves.iter().copied().collect(),
            })
        })
        .collect();
}

/// How the free parameters answer to each of these rows, one column a row.
fn slopes(fit: &JointFit, samples: &mut dyn Blocks, held: &[usize]) -> DMatrix<f64> {
    let n = fit.free.len();
    let mut slopes = DMatrix::zeros(n, held.len());
    for (part, at) in held.chunks(MOST_FREE - n).zip((0..).step_by(MOST_FREE - n)) {
        let rows: Vec<usize> = fit.free.iter().chain(part).copied().collect();
        let mut grams = vec![Gram::new(rows.len()); samples.count()];
        samples.evaluate(&fit.parameters, &rows, fit.weights, &mut grams, 1);
        let normal = Gram::sum(rows.len(), &grams).normal_matrix();
        let own = inverse_symmetric(&normal.view((0, 0), (n, n)).into_owned());
        slopes.view_mut((0, at), (n, part.len())).copy_from(&-(own * normal.view((0, n), (n, part.len()))));
    }
    slopes
}

/// The errors of a fit as those of parameters considered in the next, correlated as they are: one for each principal direction of the scatter
/// between dives, one for each thing that it held, and one for the model.
pub(super) fn considered_of(fit: &JointFit) -> Vec<Considered> {
    let n = fit.free.len();
    // Scaled to a unit diagonal: the parameters' units differ by ten orders of magnitude.
    let scale = DVector::from_fn(n, |i, _| fit.covariance[(i, i)].max(0.0).sqrt());
    let correlation = glidepolar_inference::covariance::correlation(&fit.covariance);
    let mut considered = Vec::new();
    if n > 0 && correlation.iter().chain(scale.iter()).all(|value| value.is_finite()) {
        let eigen = correlation.symmetric_eigen();
        for k in 0..n {
            let root = eigen.eigenvalues[k].max(0.0).sqrt();
            let along = (0..n).map(|i| (fit.free[i], root * scale[i] * eigen.eigenvectors[(i, k)])).collect();
            considered.push(Considered { name: "polar".to_owned(), along });
        }
    }
    considered.extend(fit.propagated.iter().map(|propagated| propagated.whole(&fit.free)));
    if !fit.model_error.is_empty() {
        let along = fit.free.iter().copied().zip(fit.model_error.iter().copied()).collect();
        considered.push(Considered { name: "model".to_owned(), along });
    }
    considered
}

#[cfg(test)]
mod tests {
    use super::super::tests::{glider, sample};
    use super::super::{Question, Request, Trim, by_dive, fit, identify};
    use super::*;
    use crate::dynamics::parameter_index;

    #[test]
    fn b_answers_to_a_held_lift_slope_as_the_closed_form_says() {
        // One pitch, no c, vertical velocity alone. From w^2 = W sin^3 gamma/(rho/2 A b) and b = a alpha tan gamma with
        // gamma = pitch + alpha follows, for a larger by the share e,
        //     d alpha = -e/(1/alpha + 2/sin 2 gamma - 3 cot gamma),     db/b = 3 cot gamma d alpha.
        let (_, mut truth) = glider();
        truth.c_per_rad2 = 0.0;
        let all: Vec<_> = (0..6u32)
            .flat_map(|dive| (0..4).map(move |i| (dive, f64::from(dive * 1000 + i * 10))))
            .map(|(dive, time_s)| sample(&truth, -27.0, 0.3, dive, time_s))
            .collect();
        let mut dives = by_dive(&all);
        let question = Question { use_speed: false, ..Question::new(truth, &["b"]).unwrap() };
        let mut found = fit(&question, &mut dives).unwrap();
        let row = parameter_index("a_per_rad").unwrap();
        let one = Considered { name: "a".into(), along: vec![(row, 0.1 * truth.a_per_rad)] };
        propagate(&mut found, &mut &mut dives[..], &[one]);

        let gamma = 27f64.to_radians();
        let alpha = gamma - all[0].pitch_rad.abs();
        let change = -0.1 / (1.0 / alpha + 2.0 / (2.0 * gamma).sin() - 3.0 / gamma.tan());
        let expected = 3.0 / gamma.tan() * change * truth.b;
        let propagated = found.propagated[0].moves[0];
        assert!((propagated / expected - 1.0).abs() < 1e-6, "{propagated} against {expected}");
        // Nothing scatters here: but for the bound of the model's own error, which is small, all of it is what was carried.
        let of_model = found.covariance[(0, 0)];
        let carried = (found.se(0).powi(2) - of_model).sqrt();
        assert!((carried / expected.abs() - 1.0).abs() < 1e-6, "{carried} against {expected}");
        assert!(of_model.sqrt() < 0.1 * expected.abs(), "{}", of_model.sqrt());
    }

    #[test]
    fn what_a_vehicle_states_with_an_error_widens_the_others() {
        let (mut vehicle, truth) = glider();
        let mut all = Vec::new();
        for dive in 0..8u32 {
            for (side, sign) in [(0, -1.0), (1, 1.0)] {
                for i in 0..6u32 {
                    let path = sign * (24.0 + 2.5 * f64::from(dive % 4) + 0.3 * f64::from(i));
                    let mut o = sample(
                        &truth,
                        path,
                        0.27 + 0.01 * f64::from(i),
                        dive,
                        f64::from(dive * 1000 + side * 500 + i * 10),
                    );
                    // Something that scatters from dive to dive.
                    o.sink_m_s += 1e-3 * f64::from(dive % 3);
                    o.speed_m_s = f64::NAN;
                    all.push(o);
                }
            }
        }
        let request = Request { trim: Trim::Vehicle, free: Vec::new(), pin: Vec::new(), unsteady: None };
        vehicle.is_builtin = false;
        let mut se = Vec::new();
        for error in [1.0, 2.0] {
            vehicle.set("uncertainty.hydro.a_per_rad", error).unwrap();
            vehicle.set("uncertainty.hull.compressibility_per_Pa", 1e-10).unwrap();
            let found = identify(&vehicle, &all, &request).unwrap();
            let i = found.fit.position("b").unwrap();
            let pin = &found.pinned["a"];
            assert!((pin.se.unwrap() - error).abs() < 1e-12, "{:?}", pin.se);
            let scatter = found.fit.covariance[(i, i)];
            let hull = &found.pinned["hull_compressibility_per_Pa"].moves;
            // All at one pressure: the offset takes back the water that a softer hull no longer displaces.
            let displaced_kg = truth.displaced_mass_kg * all[0].density_kg_m3 / truth.reference_density_kg_m3;
            let expected = -displaced_kg * 1e-10 * 4e5;
            assert!((hull["ballast_offset_kg"] / expected - 1.0).abs() < 1e-3, "{hull:?} against {expected}");
            let moves = found.pinned.values().filter_map(|pin| pin.moves.get("b"));
            let whole = (scatter + moves.map(|by| by * by).sum::<f64>()).sqrt();
            assert!(scatter > 0.0);
            assert!((found.fit.se(i) / whole - 1.0).abs() < 1e-9);
            se.push(pin.moves["b"]);
            let report = found.report(&vehicle, String::new(), Vec::new());
            let held = report.parameters["a"].as_ref().unwrap();
            assert!((held.ci95[1] - held.value - 1.96 * error).abs() < 1e-3, "{held:?}");
        }
        assert!((se[1] / se[0] - 2.0).abs() < 1e-9);
    }
}
