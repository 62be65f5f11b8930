//! What both kinds of NetCDF log share: a variable by name as numbers in a known unit, errors that name the file.

use std::io::Read;
use std::path::Path;

use netcdf_reader::{NcFile, NcOpenOptions};

use glidepolar_input::{InputError, Place, printable};

/// Most that is ever read into memory for one variable \[bytes\]: no log of one file is longer, a damaged header may
/// claim anything.
const MAX_READ_BYTES: usize = 1 << 30;

/// Whether the file begins as one.
pub(super) fn is_one(path: &Path) -> Result<bool, InputError> {
    let mut magic = [0u8; 8];
    let file = std::fs::File::open(path).map_err(|error| InputError::io(path, &error))?;
    let mut read = Vec::new();
    file.take(8).read_to_end(&mut read).map_err(|error| InputError::io(path, &error))?;
    magic[..read.len()].copy_from_slice(&read);
    Ok(magic.starts_with(b"CDF") || magic == *b"\x89HDF\r\n\x1a\n")
}

pub(super) fn open(path: &Path) -> Result<NcFile, InputError> {
    let options = NcOpenOptions { max_read_bytes: MAX_READ_BYTES, ..NcOpenOptions::default() };
    NcFile::open_with_options(path, options).map_err(|error| {
        InputError::new(Place::file(path), format!("not readable as NetCDF: {}", printable(&error.to_string())))
            .help("was the file cut off while it was written or sent?")
    })
}

pub(super) fn has(file: &NcFile, name: &str) -> bool {
    file.variable(name).is_ok()
}

/// The first of these variables that is there, with fill values as NaN; nothing where none is there.
pub(super) fn first(path: &Path, file: &NcFile, names: &[&str]) -> Result<Option<Vec<f64>>, InputError> {
    match names.iter().find(|name| has(file, name)) {
        Some(name) => values(path, file, name).map(Some),
        None => Ok(None),
    }
}

/// A variable as numbers, packed values unpacked, fill values as NaN.
pub(super) fn values(path: &Path, file: &NcFile, name: &str) -> Result<Vec<f64>, InputError> {
    let array = file.read_variable_unpacked_masked(name).map_err(|error| {
        let problem = format!("variable `{}` is not readable: {}", printable(name), printable(&error.to_string()));
        InputError::new(Place::file(path), problem)
    })?;
    // Magnitudes that no instrument gives are default fill values that nobody declared; nanoseconds since 1970 are 1e18.
    let unit = units(file, name);
    let most = if unit.starts_with("nanosec") || unit.starts_with("microsec") { 5e18 } else { 1e15 };
    Ok(array.iter().map(|&value| if value.abs() < most { value } else { f64::NAN }).collect())
}

/// An attribute of a variable as text, lower case.
pub(super) fn attribute_of(file: &NcFile, name: &str, attribute: &str) -> String {
    file.variable(name)
        .ok()
        .and_then(|variable| variable.attribute(attribute)?.value.as_string())
        .unwrap_or_default()
        .trim()
        .to_lowercase()
}

/// The `units` attribute, lower case.
pub(super) fn units(file: &NcFile, name: &str) -> String {
    attribute_of(file, name, "units")
}

pub(super) fn attribute_f64(file: &NcFile, name: &str) -> Option<f64> {
    let value = &file.global_attribute(name).ok()?.value;
    value.as_f64().or_else(|| value.as_string()?.trim().parse().ok())
}

pub(super) fn attribute_text(file: &NcFile, name: &str) -> Option<String> {
    Some(file.global_attribute(name).ok()?.value.as_string()?.trim().to_owned())
}

/// A variable of one number; nothing where it is not there or has no value.
pub(super) fn scalar(file: &NcFile, name: &str) -> Option<f64> {
    file.variable(name).ok()?;
    let array = file.read_variable_unpacked_masked(name).ok()?;
    array.iter().copied().next().filter(|value| value.abs() < 1e15)
}

/// Complains about a variable that is missing or of another length than the time.
pub(super) fn of_length(path: &Path, name: &str, column: Vec<f64>, rows: usize) -> Result<Vec<f64>, InputError> {
    if column.len() == rows {
        return Ok(column);
    }
    let problem = format!("variable `{}` has {} values, the time has {rows}", printable(name), column.len());
    Err(InputError::new(Place::file(path), problem))
}

pub(super) fn missing(path: &Path, what: &str, names: &[&str]) -> InputError {
    InputError::new(Place::file(path), format!("no {what}: expected a variable {}", names.join(" or ")))
}
