//! Vehicle files as texts that Python holds.

use glidepolar_terminal::CliError;
use glidepolar_vehicle::keys::KEYS;
use glidepolar_vehicle::{Vehicle, builtin};
use pyo3::prelude::*;

use crate::failure::Failure;

/// The text of a vehicle's file, its name, its source, and whether it is built in.
type Parts = (String, String, String, bool);

/// The names of the built-in vehicles.
#[pyfunction]
pub fn builtin_vehicles() -> Vec<&'static str> {
    builtin::NAMES.to_vec()
}

/// Reads a vehicle file, or takes a built-in vehicle.
#[pyfunction]
pub fn load_vehicle(py: Python<'_>, name_or_file: &str) -> PyResult<Parts> {
    let vehicle = Vehicle::load(name_or_file).map_err(|error| raised(py, error.into()))?;
    let text = match builtin::text(name_or_file) {
        Some(text) => text.to_owned(),
        None => vehicle.to_toml(),
    };
    Ok((text, vehicle.name, vehicle.source, vehicle.is_builtin))
}

/// The text with other values, each checked as in a file.
#[pyfunction]
pub fn changed_vehicle(py: Python<'_>, text: &str, values: Vec<(String, f64)>) -> PyResult<Parts> {
    let changed = Vehicle::parse(text, "vehicle").and_then(|mut vehicle| {
        values.iter().try_for_each(|(key, value)| vehicle.set(key, *value))?;
        // Read again, so that the same bounds hold for a value as in a file.
        Vehicle::parse(&vehicle.to_toml(), "vehicle")
    });
    let vehicle = changed.map_err(|error| raised(py, error.into()))?;
    Ok((vehicle.to_toml(), vehicle.name, vehicle.source, false))
}

/// A value of the vehicle by its key, where it is stated.
#[pyfunction]
pub fn vehicle_value(py: Python<'_>, text: &str, key: &str) -> PyResult<Option<f64>> {
    Ok(Vehicle::parse(text, "vehicle").map_err(|error| raised(py, error.into()))?.get(key))
}

/// The keys of a vehicle file: path, unit, meaning.
#[pyfunction]
pub fn vehicle_keys() -> Vec<(&'static str, &'static str, &'static str)> {
    KEYS.iter().map(|key| (key.path, key.unit, key.meaning)).collect()
}

fn raised(py: Python<'_>, error: CliError) -> PyErr {
    Failure::new(&error).raised(py)
}
