//! A parameter that the user holds, and the values that a glider may have. Knows no log.

use super::external_values::ExternalValue;
use super::joint::IdentifyError;
use super::names::{long_name, short_name};
use crate::dynamics::{PARAMETERS, parameter_index};

/// A parameter that the user holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Given {
    /// Its name, short or long.
    pub name: String,
    /// Its value; one without a standard error is taken for exact, and the report says so.
    pub known: ExternalValue,
}

impl Given {
    /// Whether the parameter exists and a glider can have this value of it.
    ///
    /// # Errors
    /// Where it does not.
    pub fn check(&self) -> Result<(), IdentifyError> {
        let row =
            parameter_index(long_name(&self.name)).ok_or_else(|| IdentifyError::UnknownParameter(self.name.clone()))?;
        let (info, value) = (&PARAMETERS[row], self.known.value);
        let (min, max) = match info.name {
            "a_per_rad" => (SMALLEST_A, LARGEST_A),
            "b" => (SMALLEST_B, LARGEST_B),
            "c_per_rad2" => (0.0, info.max),
            _ => (info.min, info.max),
        };
        match (min..=max).contains(&value) {
            true => Ok(()),
            false => Err(IdentifyError::OutOfBounds { name: short_name(info.name), value, min, max }),
        }
    }
}

/// Lift slopes on the frontal area that a glider may have: that of a slender hull without wings is 1 to 3, a wing of ten times
/// the frontal area has 60 \[1/rad\].
pub(super) const SMALLEST_A: f64 = 1.0;
pub(super) const LARGEST_A: f64 = 60.0;

/// Drag coefficients on the frontal area that a glider may have: a laminar hull alone has 0.02, a disc across the flow 1.17
/// (Hoerner 1965), and what hangs outside of the hull may be some times as large.
const SMALLEST_B: f64 = 0.01;
const LARGEST_B: f64 = 10.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn says(name: &str, value: f64) -> String {
        let given = Given { name: name.to_owned(), known: ExternalValue { value, se: None } };
        given.check().map_or_else(|error| error.to_string(), |()| String::new())
    }

    #[test]
    fn a_value_that_no_glider_has_is_refused_with_what_it_can_be() {
        for (name, value) in [("a", -3.0), ("a_per_rad", 500.0), ("b", 0.0), ("c", -1.0), ("ballast_offset_kg", 1e3)] {
            assert!(says(name, value).contains(&format!("= {value} is beyond what it can be")), "{name}");
        }
        for (name, value) in [("a", 21.0), ("b", 0.2), ("c", 0.0), ("drag_exponent", -0.12)] {
            assert_eq!(says(name, value), "", "{name}");
        }
        assert!(says("lift", 1.0).contains("no parameter `lift`"));
    }
}
