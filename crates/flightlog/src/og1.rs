//! NetCDF time series of Slocum gliders and in the OG1 format: one dimension, one variable a channel, units as the
//! `units` attribute says. Names are those of OG1, of pyglider and of the Slocum's own sensors.

use std::path::Path;

use netcdf_reader::NcFile;

use super::channels::{CHANNELS, Channel, FlightLog};
use super::columns::Columns;
use super::netcdf::{attribute_text, has, missing, of_length, open, units, values};
use glidepolar_input::{InputError, Place, printable};

/// Under which names a channel is found, the best first.
const NAMES: &[(Channel, &[&str])] = &[
    (Channel::Time, &["TIME", "time", "m_present_time", "sci_m_present_time"]),
    (Channel::Pressure, &["PRES", "pressure", "sci_water_pressure", "m_pressure"]),
    (Channel::Depth, &["DEPTH", "depth", "m_depth"]),
    (Channel::Pitch, &["PITCH", "pitch", "m_pitch"]),
    (
        Channel::Ballast,
        &["vbd_cc", "ballast_pumped", "m_ballast_pumped", "buoyancy_pump", "m_de_oil_vol", "oil_volume", "BALLAST"],
    ),
    (Channel::Density, &["density", "DENSITY"]),
    (Channel::Temperature, &["TEMP", "temperature", "sci_water_temp", "m_water_temp"]),
    (Channel::Salinity, &["PSAL", "salinity"]),
    (Channel::Conductivity, &["CNDC", "conductivity", "sci_water_cond", "m_water_cond"]),
    (Channel::Roll, &["ROLL", "roll", "m_roll"]),
    (Channel::Heading, &["HEADING", "heading", "m_heading"]),
    (Channel::Rudder, &["fin", "m_fin", "FIN"]),
    (Channel::BatteryPosition, &["battpos", "battery_position", "m_battpos"]),
    (Channel::Speed, &["speed_through_water_m_s", "speed_through_water"]),
    (Channel::Charge, &["coulomb", "m_coulomb_amphr_total"]),
    (Channel::Voltage, &["battery", "m_battery"]),
    (Channel::Latitude, &["LATITUDE", "latitude"]),
    (Channel::Longitude, &["LONGITUDE", "longitude"]),
];

/// Reads a time series.
///
/// # Errors
/// A channel that is missing, has another length than the time, or a unit that is not known.
pub(super) fn read(path: &Path, columns: &Columns) -> Result<FlightLog, InputError> {
    let file = open(path)?;
    let mut log = FlightLog::default();
    let mut rows = None;
    for &(channel, names) in NAMES {
        let chosen = columns.of(channel);
        let name = match chosen {
            Some(name) if !has(&file, name) => return Err(missing(path, CHANNELS[channel as usize].meaning, &[name])),
            Some(name) => name,
            None => match names.iter().chain([&CHANNELS[channel as usize].name]).find(|name| has(&file, name)) {
                Some(name) => name,
                None => continue,
            },
        };
        let factor = factor(path, &file, channel, name)?;
        let column: Vec<f64> = values(path, &file, name)?.into_iter().map(|value| value * factor).collect();
        let rows = *rows.get_or_insert(column.len());
        log.set(channel, of_length(path, name, column, rows)?);
    }
    let need = |channel: Channel, what: &str| {
        let names = NAMES.iter().find(|(named, _)| *named == channel).map_or(&[][..], |(_, names)| names);
        if log.column(channel).is_empty() { Err(missing(path, what, names)) } else { Ok(()) }
    };
    need(Channel::Time, "time")?;
    if log.column(Channel::Depth).is_empty() {
        need(Channel::Pressure, "pressure")?;
    }
    need(Channel::Pitch, "pitch")?;
    need(Channel::Ballast, "ballast volume")?;
    Ok(log)
}

/// The glider, where the file names it, and the first time of its record \[s\].
///
/// # Errors
/// A file without time.
pub(super) fn headline(path: &Path, file: &NcFile, columns: &Columns) -> Result<(String, f64), InputError> {
    let names = NAMES.iter().find(|(channel, _)| *channel == Channel::Time).map_or(&[][..], |(_, names)| names);
    let name = columns.of(Channel::Time).or_else(|| names.iter().copied().find(|name| has(file, name)));
    let start_s = match name.filter(|name| has(file, name)) {
        Some(name) => {
            let factor = factor(path, file, Channel::Time, name)?;
            values(path, file, name)?.into_iter().find(|time| time.is_finite()).map_or(f64::NAN, |time| time * factor)
        }
        None => return Err(missing(path, "time", names)),
    };
    let glider = ["platform_serial_number", "glider_serial", "glider_name", "platform_id"]
        .into_iter()
        .find_map(|name| attribute_text(file, name).filter(|text| !text.is_empty()));
    Ok((glider.unwrap_or_default(), start_s))
}

/// From the unit of the file to that of the channel. A unit that is not stated is taken for the usual one.
fn factor(path: &Path, file: &NcFile, channel: Channel, name: &str) -> Result<f64, InputError> {
    let unit = units(file, name);
    let degrees = std::f64::consts::PI / 180.0;
    let is = |known: &[&str]| known.iter().any(|known| unit == *known);
    let starts = |known: &str| unit.starts_with(known);
    let factor = match channel {
        Channel::Time if starts("seconds") || is(&["s", "sec", "timestamp", ""]) => 1.0,
        Channel::Time if starts("days") => 86_400.0,
        Channel::Time if starts("nanoseconds") => 1e-9,
        Channel::Time if starts("milliseconds") => 1e-3,
        // The Slocum's own sensors give bar.
        Channel::Pressure if is(&["bar"]) => 10.0,
        Channel::Pressure if unit.is_empty() && (name.starts_with("sci_") || name.starts_with("m_")) => 10.0,
        Channel::Pressure if is(&["dbar", "decibar", "decibars", ""]) => 1.0,
        Channel::Pressure if is(&["pa"]) => 1e-4,
        Channel::Pitch | Channel::Roll | Channel::Heading | Channel::Rudder if starts("deg") => degrees,
        Channel::Pitch | Channel::Roll | Channel::Heading | Channel::Rudder if starts("rad") => 1.0,
        // OG1 gives degrees, the Slocum's own sensors radians.
        Channel::Pitch | Channel::Roll | Channel::Heading | Channel::Rudder if unit.is_empty() => {
            if name.starts_with("m_") { 1.0 } else { degrees }
        }
        Channel::Ballast if is(&["cc", "cm3", "cm^3", "cm", "ml", "1", ""]) => 1.0,
        Channel::Ballast if is(&["m3", "m^3"]) => 1e6,
        Channel::Conductivity if is(&["ms cm-1", "ms/cm", "mscm-1", "mhos/m*10"]) => 0.1,
        Channel::Pitch | Channel::Roll | Channel::Heading | Channel::Rudder | Channel::Time => {
            return Err(unknown(path, name, &unit));
        }
        Channel::Pressure | Channel::Ballast => return Err(unknown(path, name, &unit)),
        _ => 1.0,
    };
    Ok(factor)
}

fn unknown(path: &Path, name: &str, unit: &str) -> InputError {
    let problem = format!("variable `{}` is in `{}`, a unit that is not known here", printable(name), printable(unit));
    InputError::new(Place::file(path), problem).help("convert it, or write the log as CSV with the unit in the name")
}
