//! What a vehicle states of the errors of its own polar: a polar from a tank or from other dives is known to that, and what a
//! fitted one would take up, a cause can explain. A log may contradict it. Knows no mechanism.

use glidepolar_inference::score::chance;
use nalgebra::{DMatrix, DVector};

use super::SeaProblem;
use crate::diagnose::{Problem, engine};
use crate::vehicle::Vehicle;

/// The coefficients of a polar as the model names them.
pub(super) const POLAR: [&str; 3] = ["a_per_rad", "b", "c_per_rad2"];

/// Probability by chance below which a log contradicts the polar that its vehicle states.
const CONTRADICTED: f64 = 0.01;

/// Said where a log does.
pub(super) const WARNING: &str = "the log contradicts the polar that the vehicle states, with the errors under [uncertainty]: they are not used, and the polar is fitted as one of its design may be";

/// The standard errors of `a`, `b` and `c` that a vehicle states, over their values; none where it states none.
pub(super) fn errors(vehicle: &Vehicle) -> [Option<f64>; 3] {
    POLAR.map(|name| {
        let name = format!("hydro.{name}");
        let (se, value) = (vehicle.uncertainty.get(&name)?, vehicle.get(&name)?);
        (*se > 0.0 && value != 0.0).then(|| se / value.abs())
    })
}

/// Whether the polar that a log shows without them contradicts these stated errors: by the differences of the logarithms, with the
/// covariance of the fit and of what is stated. `free` is the problem without them.
pub(super) fn is_contradicted(free: &SeaProblem, stated: [Option<f64>; 3]) -> bool {
    let start = free.start().baseline;
    let places: Vec<(usize, f64)> = POLAR
        .iter()
        .zip(stated)
        .filter_map(|(name, se)| Some((free.baseline().iter().position(|(known, _)| known == name)?, se?)))
        .filter(|(place, _)| start[*place] > 0.0)
        .collect();
    if places.is_empty() {
        return false;
    }
    let (stage, _) = engine::baseline(free);
    let fitted = &stage.point.baseline;
    let difference = DVector::from_iterator(places.len(), places.iter().map(|(at, _)| (fitted[*at] / start[*at]).ln()));
    let covariance = DMatrix::from_fn(places.len(), places.len(), |i, j| {
        let ((at_i, se), (at_j, _)) = (places[i], places[j]);
        let of_fit = stage.covariance[(at_i, at_j)] / (fitted[at_i] * fitted[at_j]);
        if i == j { of_fit + se * se } else { of_fit }
    });
    let Some(cholesky) = covariance.cholesky() else { return true };
    chance(difference.dot(&cholesky.solve(&difference)), places.len()) < CONTRADICTED
}
