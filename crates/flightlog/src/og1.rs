//! NetCDF time series of Slocum and SeaExplorer gliders (pyglider), and in the OG1 format: one dimension, one variable a
//! channel, units as the `units` attribute says. Names are those of OG1, of pyglider and of the Slocum's own sensors.
//!
//! A unit that the user states goes before that of the file. Angles that a file labels degrees and that stay within what
//! radians can be are taken as radians, with a warning: pyglider's example for Slocum gliders writes such files.

use std::path::Path;

use netcdf_reader::NcFile;

use super::channels::{CHANNELS, Channel, FlightLog};
use super::columns::Columns;
use super::fix::GpsFix;
use super::netcdf::{attribute_text, first, has, missing, of_length, open, units, values};
use super::units::{self, Conversion, is_angle};
use glidepolar_input::{InputError, Place, printable};

/// Under which names a channel is found, the best first.
const NAMES: &[(Channel, &[&str])] = &[
    (Channel::Time, &["TIME", "time", "m_present_time", "sci_m_present_time"]),
    (Channel::Pressure, &["PRES", "pressure", "sci_water_pressure", "m_pressure"]),
    (Channel::Depth, &["DEPTH", "GLIDER_DEPTH", "depth", "m_depth"]),
    (Channel::Pitch, &["PITCH", "GLIDER_PITCH", "pitch", "m_pitch"]),
    (
        Channel::Ballast,
        &[
            "vbd_cc",
            "ballast_pumped",
            "m_ballast_pumped",
            "buoyancy_pump",
            "m_de_oil_vol",
            "oil_volume",
            "ballast_volume",
            "BallastPos",
            "ballast_pos",
            "eng_vbdCC",
            "BALLAST",
        ],
    ),
    (Channel::Density, &["density", "DENSITY"]),
    (Channel::Temperature, &["TEMP", "temperature", "sci_water_temp", "m_water_temp"]),
    (Channel::Salinity, &["PSAL", "salinity"]),
    (Channel::Conductivity, &["CNDC", "conductivity", "sci_water_cond", "m_water_cond"]),
    (Channel::Roll, &["ROLL", "GLIDER_ROLL", "roll", "m_roll"]),
    (Channel::Heading, &["HEADING", "GLIDER_HEADING", "heading", "m_heading"]),
    (Channel::Rudder, &["fin", "m_fin", "FIN"]),
    (Channel::BatteryPosition, &["battpos", "battery_position", "m_battpos"]),
    (Channel::Speed, &["speed_through_water_m_s", "speed_through_water"]),
    (Channel::Charge, &["coulomb", "m_coulomb_amphr_total"]),
    (Channel::Voltage, &["battery", "m_battery"]),
    (Channel::Latitude, &["LATITUDE", "latitude"]),
    (Channel::Longitude, &["LONGITUDE", "longitude"]),
];

/// Largest pitch in radians, and in degrees what no glider keeps within all its way \[either\].
const MOST_RAD: f64 = 1.6;

/// Reads a time series; what a user should know of it is added to the warnings.
///
/// # Errors
/// A channel that is missing, has another length than the time, or a unit that is not known.
pub(super) fn read(path: &Path, columns: &Columns, warnings: &mut Vec<String>) -> Result<FlightLog, InputError> {
    let file = open(path)?;
    let mut log = FlightLog::default();
    let mut rows = None;
    // Angles in degrees by the label of the file only.
    let mut labelled_degrees = Vec::new();
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
        let conversion = columns.unit(channel).map_or_else(|| stated(path, &file, channel, name), Ok)?;
        let column: Vec<f64> = values(path, &file, name)?.into_iter().map(|value| conversion.of(value)).collect();
        let rows = *rows.get_or_insert(column.len());
        if is_angle(channel) && columns.unit(channel).is_none() && conversion != Conversion::NONE {
            labelled_degrees.push(channel);
        }
        let is_needed = matches!(channel, Channel::Pressure | Channel::Pitch | Channel::Ballast) || chosen.is_some();
        if column.len() != rows && !is_needed {
            warnings.push(format!(
                "{}: variable `{}` left out, it has {} values where the time has {rows}",
                printable(&path.to_string_lossy()),
                printable(name),
                column.len()
            ));
            continue;
        }
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
    radians_labelled_degrees(path, &labelled_degrees, &mut log, warnings);
    Ok(log)
}

/// A pitch that never exceeds 1.6 deg is none of a glider that glides: it is in radians, and so are the other angles of the
/// file that stay within what radians can be.
fn radians_labelled_degrees(path: &Path, labelled: &[Channel], log: &mut FlightLog, warnings: &mut Vec<String>) {
    let degree = std::f64::consts::PI / 180.0;
    let most = |log: &FlightLog, channel: Channel| {
        log.column(channel).iter().filter(|value| value.is_finite()).fold(0.0f64, |most, value| most.max(value.abs()))
            / degree
    };
    let pitch = most(log, Channel::Pitch);
    if !labelled.contains(&Channel::Pitch) || !(0.05..=MOST_RAD).contains(&pitch) {
        return;
    }
    let mut names = Vec::new();
    for &channel in labelled {
        let limit = if channel == Channel::Heading { std::f64::consts::TAU + 0.01 } else { MOST_RAD };
        if most(log, channel) <= limit {
            log.column_mut(channel).iter_mut().for_each(|value| *value /= degree);
            names.push(CHANNELS[channel as usize].name.trim_end_matches("_rad"));
        }
    }
    warnings.push(format!(
        "{}: {} labelled degrees, but the pitch stays within {pitch:.2}: taken as radians (--unit pitch=deg keeps the label)",
        printable(&path.to_string_lossy()),
        names.join(", ")
    ));
}

/// Positions of the receiver, where the file holds them apart from the positions between.
///
/// # Errors
/// A variable that is not readable.
pub(super) fn fixes(path: &Path) -> Result<Vec<GpsFix>, InputError> {
    let file = open(path)?;
    let column = |names: &[&str]| first(path, &file, names);
    let (time, lat, lon) = (column(&["TIME_GPS"])?, column(&["LATITUDE_GPS"])?, column(&["LONGITUDE_GPS"])?);
    let (Some(time), Some(lat), Some(lon)) = (time, lat, lon) else { return Ok(Vec::new()) };
    let mut fixes: Vec<GpsFix> = Vec::new();
    for ((&time, &lat), &lon) in time.iter().zip(&lat).zip(&lon) {
        let Some(fix) = GpsFix::new(time, lat, lon) else { continue };
        if fixes.last().is_none_or(|last| (last.lat_deg, last.lon_deg) != (fix.lat_deg, fix.lon_deg)) {
            fixes.push(fix);
        }
    }
    Ok(fixes)
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
            let conversion = stated(path, file, Channel::Time, name)?;
            values(path, file, name)?
                .into_iter()
                .find(|time| time.is_finite())
                .map_or(f64::NAN, |time| conversion.of(time))
        }
        None => return Err(missing(path, "time", names)),
    };
    let glider = ["platform_serial_number", "glider_serial", "glider_name", "platform_id"]
        .into_iter()
        .find_map(|name| attribute_text(file, name).filter(|text| !text.is_empty()));
    Ok((glider.unwrap_or_default(), start_s))
}

/// What the file says of a unit. One that is not stated is taken for the usual one.
fn stated(path: &Path, file: &NcFile, channel: Channel, name: &str) -> Result<Conversion, InputError> {
    let unit = units(file, name);
    let is_slocums = name.starts_with("m_") || name.starts_with("sci_");
    if let Some(conversion) = units::conversion(channel, &unit) {
        return Ok(conversion);
    }
    match channel {
        // The Slocum's own sensors give bar and radians, OG1 dbar and degrees.
        Channel::Pressure if unit.is_empty() => Ok(Conversion::by(if is_slocums { 10.0 } else { 1.0 })),
        _ if is_angle(channel) && unit.is_empty() => {
            Ok(if is_slocums { Conversion::NONE } else { Conversion::by(std::f64::consts::PI / 180.0) })
        }
        Channel::BatteryPosition if is_slocums => Ok(Conversion::by(0.0254)),
        Channel::Ballast if ["cm", "1", ""].contains(&unit.as_str()) => Ok(Conversion::NONE),
        Channel::Time if unit.is_empty() => Ok(Conversion::NONE),
        Channel::Time | Channel::Pressure | Channel::Ballast => Err(unknown(path, channel, name, &unit)),
        _ if is_angle(channel) => Err(unknown(path, channel, name, &unit)),
        _ => Ok(Conversion::NONE),
    }
}

fn unknown(path: &Path, channel: Channel, name: &str, unit: &str) -> InputError {
    let problem = format!("variable `{}` is in `{}`, a unit that is not known here", printable(name), printable(unit));
    let option = CHANNELS[channel as usize].name;
    InputError::new(Place::file(path), problem).help(format!("state it by --unit {option}=UNIT"))
}
