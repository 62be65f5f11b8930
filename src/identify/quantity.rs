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
    // Beyond, it is the normal distribution's to four digits, and the search for the quantile does not come to its end.
    StudentsT::new(0.0, 1.0, degrees_of_freedom.clamp(1.0, 1e5)).map_or(1.96, |t| t.inverse_cdf(0.975))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quantile_of_students_t_is_that_of_the_tables() {
        for (freedom, quantile) in [(1.0, 12.706), (5.0, 2.571), (30.0, 2.042), (1e12, 1.960), (f64::INFINITY, 1.960)] {
            assert!((student_975(freedom) - quantile).abs() < 1e-3, "{freedom}");
        }
    }
}
