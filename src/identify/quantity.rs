//! Numbers with their errors.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::hull_tests::Estimate;

/// A number whose standard error has this many degrees of freedom.
pub fn estimate(value: f64, se: f64, degrees_of_freedom: f64, unit: &str) -> Estimate {
    let half = student_975(degrees_of_freedom) * se;
    Estimate { value, se, ci95: [value - half, value + half], unit: unit.to_owned() }
}

/// The 97.5 % quantile of Student's t distribution.
pub fn student_975(degrees_of_freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees_of_freedom.max(1.0)).map_or(1.96, |t| t.inverse_cdf(0.975))
}
