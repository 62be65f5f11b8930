//! A sweep's points as a regression on functions of the angle. Knows no model.

use nalgebra::{DMatrix, DVector};

use crate::sweep::Sweep;
use glidepolar_inference::regression::{Problem, Scatter};

/// Functions of the angle in radians, one per parameter.
pub type Basis = &'static [fn(f64) -> f64];

/// How the points of a sweep are weighted: by their own errors and the scatter between runs where these are known.
pub fn scatter(sweep: &Sweep) -> Scatter {
    if sweep.has_errors() { Scatter::BetweenRuns } else { Scatter::Equal }
}

/// The regression of one coefficient (0 CL, 1 CD, 2 CM) on functions of the angle.
pub fn problem(sweep: &Sweep, rows: &[usize], coefficient: usize, basis: Basis) -> Problem {
    let alpha: Vec<f64> = rows.iter().map(|i| sweep.points[*i].alpha_rad()).collect();
    Problem {
        design: DMatrix::from_fn(rows.len(), basis.len(), |i, j| basis[j](alpha[i])),
        observed: DVector::from_iterator(rows.len(), rows.iter().map(|i| sweep.points[*i].coefficients[coefficient])),
        variance: DVector::from_iterator(rows.len(), rows.iter().map(|i| sweep.points[*i].se[coefficient].powi(2))),
        shared: sweep.shared_for(rows, coefficient),
    }
}
