//! What a vehicle states of the errors of its own polar: a polar from a tank or from other dives is known to that, and what a
//! fitted one would take up, a cause can explain. A log may contradict it. Knows no mechanism.

use glidepolar_inference::score::chance;

use super::SeaProblem;
use crate::diagnose::engine::{self, Believed};
use crate::diagnose::{Point, Problem};
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

/// Shares of the stated errors with which the polar is fitted to find the one nearest to the log within the errors themselves.
const SHARES: [f64; 4] = [0.5, 0.25, 0.125, 0.0625];

/// Whether a log contradicts the polar of `stated`, believed with these errors; `free` is the same problem without them.
///
/// It does where it fits so much worse that chance is no explanation, and where every polar within the errors predicts something else
/// than the free one, by enough to act on. The steady glide itself is off by some tenths of a millimetre per second, for which no
/// polar is to blame. Lift and induced drag may be known together and neither alone, so that no covariance of `free` says how far its
/// polar is from the stated one.
pub(super) fn is_contradicted(free: &SeaProblem, stated: &SeaProblem, errors: [Option<f64>; 3]) -> bool {
    let known = known(stated, &stated.start(), errors).len();
    let is_unlikely = |believed: &Believed| chance(believed.deviance.max(0.0), known) < CONTRADICTED;
    if !engine::believed(free, std::slice::from_ref(stated)).iter().any(is_unlikely) {
        return false;
    }
    let believed_more = SHARES.map(|share| free.with_polar_errors(errors.map(|se| Some(share * se?))));
    let nearest = engine::believed(free, &believed_more);
    let nearest = nearest.iter().find(|believed| stays_within(stated, &believed.point, errors));
    nearest.is_none_or(|believed| believed.differs)
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
    /// The logarithm of the fitted over the stated value, and the standard error of the stated one.
    difference: f64,
    se: f64,
}

fn known(problem: &SeaProblem, point: &Point, stated: [Option<f64>; 3]) -> Vec<Known> {
    let start = problem.start().baseline;
    let of = |(name, se): (&&str, Option<f64>)| {
        let place = problem.baseline().iter().position(|(known, _)| known == name)?;
        let (value, fitted) = (start[place], point.baseline[place]);
        Some(Known { difference: (fitted / value).ln(), se: se? }).filter(|_| value > 0.0)
    };
    POLAR.iter().zip(stated).filter_map(of).collect()
}
