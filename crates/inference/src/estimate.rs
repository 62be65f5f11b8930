//! A figure with its uncertainty, as every result of a measurement is given.

use serde::{Deserialize, Serialize};

/// 97.5 % point of the normal distribution.
const NORMAL_975: f64 = 1.959_963_984_540_054;

/// A value with its standard error, 95 % interval and unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub se: f64,
    /// The interval that holds the true value with 95 % probability.
    pub ci95: [f64; 2],
    /// Unit of all of them.
    pub unit: String,
}

impl Estimate {
    /// An estimate with normal errors.
    pub fn normal(value: f64, se: f64, unit: &str) -> Self {
        Estimate::with_half_width(value, se, NORMAL_975 * se, unit)
    }

    /// An estimate whose standard error has so many degrees of freedom.
    pub fn student(value: f64, se: f64, degrees_of_freedom: f64, unit: &str) -> Self {
        Estimate::with_half_width(value, se, student_975(degrees_of_freedom) * se, unit)
    }

    /// An estimate whose interval reaches `half_width` to either side.
    pub fn with_half_width(value: f64, se: f64, half_width: f64, unit: &str) -> Self {
        Estimate { value, se, ci95: [value - half_width, value + half_width], unit: unit.to_owned() }
    }
}

/// The 97.5 % quantile of Student's t distribution; that of one degree of freedom where there are fewer, or none is known.
pub fn student_975(degrees_of_freedom: f64) -> f64 {
    use statrs::distribution::{ContinuousCDF, StudentsT};
    // Beyond 1e5 it is the normal distribution's to four digits, and the search for the quantile does not come to its end.
    let degrees_of_freedom = if degrees_of_freedom.is_nan() { 1.0 } else { degrees_of_freedom.clamp(1.0, 1e5) };
    StudentsT::new(0.0, 1.0, degrees_of_freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quantile_of_students_t_is_that_of_the_tables() {
        for (freedom, quantile) in [(1.0, 12.706), (5.0, 2.571), (30.0, 2.042), (1e12, 1.960), (f64::INFINITY, 1.960)] {
            assert!((student_975(freedom) - quantile).abs() < 1e-3, "{freedom}");
        }
        assert_eq!(student_975(f64::NAN), student_975(1.0));
    }
}
