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

    /// An estimate whose interval reaches `half_width` to either side.
    pub fn with_half_width(value: f64, se: f64, half_width: f64, unit: &str) -> Self {
        Estimate { value, se, ci95: [value - half_width, value + half_width], unit: unit.to_owned() }
    }
}
