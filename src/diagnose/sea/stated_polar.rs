//! What a vehicle states of the errors of its own polar: a polar from a tank or from other dives is known to that, and what a
//! fitted one would take up, a cause can explain. A log may contradict it. Knows no mechanism.

use glidepolar_inference::score::chance;
use nalgebra::{DMatrix, DVector};

use super::SeaProblem;
use crate::diagnose::{Point, Problem, engine};
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
    let (stage, _) = engine::baseline(free);
    let known = known(free, &stage.point, stated);
    let covariance = DMatrix::from_fn(known.len(), known.len(), |i, j| {
        let of_fit = stage.covariance[(known[i].place, known[j].place)] / (known[i].fitted * known[j].fitted);
        if i == j { of_fit + known[i].se.powi(2) } else { of_fit }
    });
    let difference = DVector::from_iterator(known.len(), known.iter().map(|one| one.difference));
    let Some(cholesky) = covariance.cholesky() else { return true };
    !known.is_empty() && chance(difference.dot(&cholesky.solve(&difference)), known.len()) < CONTRADICTED
}

/// Whether the polar that was fitted beside what was found lies within these stated errors.
pub(super) fn stays_within(problem: &SeaProblem, point: &Point, stated: [Option<f64>; 3]) -> bool {
    let known = known(problem, point, stated);
    let squares: f64 = known.iter().map(|one| (one.difference / one.se).powi(2)).sum();
    known.is_empty() || chance(squares, known.len()) >= CONTRADICTED
}

/// Whether the baseline at this point has a polar or a current that, without the stated errors, the prior excludes as well.
pub(super) fn is_implausible(free: &SeaProblem, point: &Point) -> bool {
    let prior = free.evidence(point).prior;
    let squares: f64 = prior[..free.baseline().len()].iter().map(|(belief, sd)| (belief / sd).powi(2)).sum();
    chance(squares, free.baseline().len()) < CONTRADICTED
}

/// A coefficient of which an error is stated.
struct Known {
    /// Its place in the baseline.
    place: usize,
    fitted: f64,
    /// The logarithm of the fitted over the stated value, and the standard error of the stated one.
    difference: f64,
    se: f64,
}

fn known(problem: &SeaProblem, point: &Point, stated: [Option<f64>; 3]) -> Vec<Known> {
    let start = problem.start().baseline;
    let of = |(name, se): (&&str, Option<f64>)| {
        let place = problem.baseline().iter().position(|(known, _)| known == name)?;
        let (value, fitted) = (start[place], point.baseline[place]);
        Some(Known { place, fitted, difference: (fitted / value).ln(), se: se? }).filter(|_| value > 0.0)
    };
    POLAR.iter().zip(stated).filter_map(of).collect()
}
