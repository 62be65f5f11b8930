//! The slopes of lift and moment at zero drift, from every point of a sweep: what a manoeuvring engineer calls Yv and Nv.
//!
//! A derivative belongs to zero drift, while the straight lines of [`crate::fits`] are the best ones over a range: where the
//! lift is curved, as that of every long hull, the two differ by as much as half. Here the coefficient is an odd series in
//! the sway velocity `v/V = sin(alpha)` to the fifth order (Abkowitz 1964, Lectures on ship hydrodynamics, HyL-5), less
//! where points are too few. The order is not chosen by what it leaves: a curve too slight to be seen point by point still
//! moves the slope by more than its error, and an interval after a choice holds less than it says (92.7 % in place of 95 %).

use glidepolar_hull::hull_tests::Estimate;

use crate::angle_regression::{Basis, problem, scatter};
use crate::sweep::Sweep;

/// Points further out do not enter: the series would have to follow separated flow there \[deg\].
const RANGE_DEG: f64 = 20.0;

/// The slope of one coefficient at zero drift.
#[derive(Debug, Clone)]
pub struct Slope {
    /// Per rad.
    pub estimate: Estimate,
    /// Degrees of freedom with which the scatter behind its error is known.
    pub dof: f64,
    /// Order of the series: 5, or 3 or 1 for want of points.
    pub order: usize,
    /// Number of points that entered.
    pub points: usize,
}

/// Series of order 1, 3, 5; those for points whose common zero is not among their known errors, and those for the others.
const WITH_ZERO: [Basis; 3] =
    [&[|x| x.sin(), |_| 1.0], &[|x| x.sin(), |_| 1.0, cube], &[|x| x.sin(), |_| 1.0, cube, fifth]];
const WITHOUT_ZERO: [Basis; 3] = [&[|x| x.sin()], &[|x| x.sin(), cube], &[|x| x.sin(), cube, fifth]];

/// The slope of a coefficient (0 CL, 2 CM); none where the points are too few for a straight line.
pub fn slope(sweep: &Sweep, coefficient: usize) -> Option<Slope> {
    let rows = sweep.within_deg(RANGE_DEG);
    let series = if sweep.has_errors() { WITHOUT_ZERO } else { WITH_ZERO };
    // The highest order that the points still decide with something left to tell their scatter by.
    [5, 3, 1].into_iter().find_map(|order| {
        let fit = problem(sweep, &rows, coefficient, series[order / 2]).solve(scatter(sweep))?;
        let (estimate, dof) = (fit.estimate(0, "1/rad"), fit.parameter_dof[0]);
        Some(Slope { estimate, dof, order, points: rows.len() })
    })
}

fn cube(alpha_rad: f64) -> f64 {
    alpha_rad.sin().powi(3)
}

fn fifth(alpha_rad: f64) -> f64 {
    alpha_rad.sin().powi(5)
}
