//! NetCDF time series of Slocum and SeaExplorer gliders (pyglider), and in the OG1 format: one dimension, one variable a
//! channel, units as the `units` attribute says, times from the day that it states. Names are those of [`names`], else a CF
//! standard name. Values that quality control flagged bad (4, 9) are missing.
//!
//! A unit that the user states goes before that of the file. Angles that a file labels degrees and that stay within what
//! radians can be are taken as radians, with a warning: pyglider's example for Slocum gliders writes such files. So is a
//! conductivity beyond what a sea has taken as mS/cm.

use std::path::Path;

use netcdf_reader::NcFile;

use super::channels::{CHANNELS, Channel, FlightLog};
use super::clean::MOST_S_M;
use super::columns::Columns;
use super::fix::{GpsFix, Positions, degrees};
use super::names;
use super::netcdf;
use super::netcdf::{attribute_of, attribute_text, has, missing, of_length, open, units, values};
use super::times;
use super::units::{self, Conversion, is_angle};
use glidepolar_input::{InputError, Place, printable};

/// Largest pitch in radians, and in degrees what no glider keeps within all its way \[either\].
const MOST_RAD: f64 = 1.6;

/// Reads a time series; what a user should know of it is added to the warnings.
///
/// # Errors
/// A channel that is missing, has another length than the time, or a unit that is not known.
pub(super) fn read(path: &Path, columns: &Columns, warnings: &mut Vec<String>) -> Result<FlightLog, InputError> {
    let file = open(path)?;
    let variables = Variables::new(&file);
    let mut log = FlightLog::default();
    let mut rows = None;
    // Angles in degrees by the label of the file only.
    let mut labelled_degrees = Vec::new();
    for &(channel, _) in names::NAMES {
        let chosen = columns.chosen(channel);
        let name = match chosen {
            Some(name) if !has(&file, name) => return Err(missing(path, CHANNELS[channel as usize].meaning, &[name])),
            Some(name) => name.to_owned(),
            None => match variables.find(path, &file, channel, rows)? {
                Some(name) => name,
                None => continue,
            },
        };
        let conversion = columns.unit(channel).map_or_else(|| stated(path, &file, channel, &name), Ok)?;
        let mut column: Vec<f64> =
            values(path, &file, &name)?.into_iter().map(|value| value_of(channel, conversion, value)).collect();
        one_dimension(path, &file, &name)?;
        flagged(path, &file, &name, &mut column, warnings);
        let rows = *rows.get_or_insert(column.len());
        if is_angle(channel) && columns.unit(channel).is_none() && conversion != Conversion::NONE {
            labelled_degrees.push(channel);
        }
        if channel == Channel::Depth {
            downward(&file, &name, &mut column);
        }
        let is_needed = matches!(channel, Channel::Pressure | Channel::Pitch | Channel::Ballast) || chosen.is_some();
        if column.len() != rows && !is_needed {
            warnings.push(format!(
                "{}: variable `{}` left out, it has {} values where the time has {rows}",
                printable(&path.to_string_lossy()),
                printable(&name),
                column.len()
            ));
            continue;
        }
        log.set(channel, of_length(path, &name, column, rows)?);
    }
    let need = |channel: Channel, what: &str| {
        if !log.column(channel).is_empty() {
            return Ok(());
        }
        /// So many names say what is looked for.
        const SHOWN: usize = 6;
        let known = names::known(channel);
        let error = missing(path, what, &known[..known.len().min(SHOWN)]);
        Err(error.help(format!(
            "name it by --column {}=VARIABLE; the variables are: {}",
            CHANNELS[channel as usize].name,
            variables.listed()
        )))
    };
    need(Channel::Time, "time")?;
    if log.column(Channel::Depth).is_empty() {
        need(Channel::Pressure, "pressure")?;
    }
    need(Channel::Pitch, "pitch")?;
    need(Channel::Ballast, "ballast volume")?;
    times::check(path, &log)?;
    radians_labelled_degrees(path, &labelled_degrees, &mut log, warnings);
    if columns.unit(Channel::Conductivity).is_none() {
        conductivity_in_s_m(path, &mut log, warnings);
    }
    degrees_and_minutes(&mut log);
    Ok(log)
}

/// A number as it stands in the file, in the unit kept here; NaN where it stands for a missing value.
fn value_of(channel: Channel, conversion: Conversion, value: f64) -> f64 {
    if units::is_fill(channel, value) { f64::NAN } else { conversion.convert(value) }
}

/// Refuses a grid of profiles: what happens along the way of the glider is not in it.
fn one_dimension(path: &Path, file: &NcFile, name: &str) -> Result<(), InputError> {
    let Ok(variable) = file.variable(name) else { return Ok(()) };
    let long: Vec<String> =
        variable.dimensions().iter().filter(|dimension| dimension.size > 1).map(|d| printable(&d.name)).collect();
    if long.len() < 2 {
        return Ok(());
    }
    let problem = format!("variable `{}` is a grid over {}, not a time series", printable(name), long.join(" and "));
    Err(InputError::new(Place::file(path), problem).help("give the time series from which the grid was made"))
}

/// The variables of a file by their names.
struct Variables {
    names: Vec<String>,
}

impl Variables {
    fn new(file: &NcFile) -> Self {
        Variables { names: file.variables().unwrap_or_default().iter().map(|v| v.name().to_owned()).collect() }
    }

    /// As many names as a person reads, without those of flags.
    fn listed(&self) -> String {
        const MOST: usize = 40;
        let is_value = |name: &&String| !name.to_lowercase().contains("qc");
        let names: Vec<String> = self.names.iter().filter(is_value).map(|name| printable(name)).collect();
        let more = if names.len() > MOST { ", ..." } else { "" };
        format!("{}{more}", names[..names.len().min(MOST)].join(", "))
    }

    /// The variable that holds a channel: of those with a known name the first that has a value and is as long as the time,
    /// else one by its CF standard name.
    fn find(
        &self,
        path: &Path,
        file: &NcFile,
        channel: Channel,
        rows: Option<usize>,
    ) -> Result<Option<String>, InputError> {
        let own = CHANNELS[channel as usize].name;
        let named = |wanted: &str| self.names.iter().find(|name| name.eq_ignore_ascii_case(wanted));
        let mut candidates: Vec<&String> =
            names::known(channel).iter().chain([&own]).filter_map(|wanted| named(wanted)).collect();
        if candidates.is_empty() {
            let standard = names::standard(channel);
            let is_standard = |name: &&String| standard.contains(&attribute_of(file, name, "standard_name").as_str());
            candidates = self.names.iter().filter(is_standard).collect();
        }
        if let ([only], _) | ([only, ..], Channel::Time) = (&candidates[..], channel) {
            return Ok(Some((*only).clone()));
        }
        for name in &candidates {
            let column = values(path, file, name)?;
            if rows.is_none_or(|rows| column.len() == rows) && column.iter().any(|value| value.is_finite()) {
                return Ok(Some((*name).clone()));
            }
        }
        Ok(candidates.first().map(|name| (*name).clone()))
    }
}

/// Takes out what quality control flagged bad (4) or missing (9), in the scheme of Argo, OceanSITES and QARTOD alike.
fn flagged(path: &Path, file: &NcFile, name: &str, column: &mut [f64], warnings: &mut Vec<String>) {
    let Some(flags) = [format!("{name}_QC"), format!("{name}_qc")].into_iter().find(|flags| has(file, flags)) else {
        return;
    };
    let Some(flags) = netcdf::flags(path, file, &flags) else { return };
    if flags.len() != column.len() {
        return;
    }
    let mut bad = 0;
    for (value, flag) in column.iter_mut().zip(flags).filter(|(value, _)| value.is_finite()) {
        if flag == 4.0 || flag == 9.0 {
            *value = f64::NAN;
            bad += 1;
        }
    }
    if bad > 0 {
        warnings.push(format!(
            "{}: {bad} of {} values of `{}` left out, flagged bad by quality control",
            printable(&path.to_string_lossy()),
            column.len(),
            printable(name)
        ));
    }
}

/// Depths that count up are turned round: by the attribute `positive`, or where all of the record lies above the surface.
fn downward(file: &NcFile, name: &str, depth: &mut [f64]) {
    /// Height above the surface that a wave and an offset of the sensor explain \[m\].
    const MOST_HEIGHT_M: f64 = 5.0;
    let mut known: Vec<f64> = depth.iter().copied().filter(|value| value.is_finite()).collect();
    if known.is_empty() {
        return;
    }
    let is_up = attribute_of(file, name, "positive") == "up";
    if super::median(&mut known) < if is_up { 0.0 } else { -MOST_HEIGHT_M } {
        depth.iter_mut().for_each(|value| *value = -*value);
    }
}

/// A conductivity beyond what a sea has is in mS/cm, whatever the label.
fn conductivity_in_s_m(path: &Path, log: &mut FlightLog, warnings: &mut Vec<String>) {
    let mut known: Vec<f64> =
        log.column(Channel::Conductivity).iter().copied().filter(|value| value.is_finite()).collect();
    if known.is_empty() || super::median(&mut known) <= MOST_S_M {
        return;
    }
    log.column_mut(Channel::Conductivity).iter_mut().for_each(|value| *value *= 0.1);
    warnings.push(format!(
        "{}: conductivity beyond {MOST_S_M} S/m, which no sea has: taken as mS/cm (--unit conductivity_S_m=S/m keeps it)",
        printable(&path.to_string_lossy())
    ));
}

/// Positions that no sphere has are the receiver's `DDMM.mmm`.
fn degrees_and_minutes(log: &mut FlightLog) {
    let beyond = |channel: Channel, most: f64| log.column(channel).iter().any(|value| value.abs() > most);
    if beyond(Channel::Latitude, 90.0) || beyond(Channel::Longitude, 360.0) {
        for channel in [Channel::Latitude, Channel::Longitude] {
            log.column_mut(channel).iter_mut().for_each(|value| *value = degrees(*value));
        }
    }
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

/// Names of a receiver's positions, latitude and longitude: OG1 and EGO, a Slocum's, those of a Seaglider.
const RECEIVER: [[&str; 2]; 4] = [
    ["LATITUDE_GPS", "LONGITUDE_GPS"],
    ["m_gps_lat", "m_gps_lon"],
    ["gps_lat", "gps_lon"],
    ["log_gps_lat", "log_gps_lon"],
];

/// Names of the positions of all rows, most of them reckoned.
const ROWS: [[&str; 2]; 2] = [["LATITUDE", "LONGITUDE"], ["latitude", "longitude"]];

/// Fixes: the receiver's positions, where the file holds them apart, else those of all rows that quality control calls good. A
/// receiver's position that stands in most rows was written again and again: it is a fix where it changes at the surface.
///
/// # Errors
/// A variable that is not readable.
pub(super) fn fixes(path: &Path) -> Result<Vec<GpsFix>, InputError> {
    let file = open(path)?;
    let there =
        |pairs: &[[&'static str; 2]]| pairs.iter().copied().find(|pair| pair.iter().all(|name| has(&file, name)));
    let (names, is_receiver) = match (there(&RECEIVER), there(&ROWS)) {
        (Some(names), _) => (names, true),
        (None, Some(names)) => (names, false),
        (None, None) => return Ok(Vec::new()),
    };
    let (mut lat, lon) = (values(path, &file, names[0])?, values(path, &file, names[1])?);
    if lat.len() != lon.len() {
        return Ok(Vec::new());
    }
    let flags = names.map(|name| format!("{name}_QC")).into_iter().chain(names.map(|name| format!("{name}_qc")));
    let of_both = if is_receiver { "POSITION_GPS_QC" } else { "POSITION_QC" };
    let mut is_judged = false;
    for flags in flags.chain([of_both.to_owned()]).filter_map(|name| netcdf::flags(path, &file, &name)) {
        if flags.len() == lat.len() {
            is_judged = true;
            lat.iter_mut()
                .zip(flags)
                .filter(|(_, flag)| !is_received(*flag, is_receiver))
                .for_each(|(lat, _)| *lat = f64::NAN);
        }
    }
    // Positions between fixes that nobody judged are reckoned ones for all that is known.
    if !is_receiver && !is_judged {
        return Ok(Vec::new());
    }
    let time = times_of(path, &file, lat.len())?;
    let is_ddmm = lat.iter().any(|value| value.abs() > 90.0);
    let of = |value: f64| if is_ddmm { degrees(value) } else { value };
    let depth = depth_of(path, &file, lat.len());
    let is_filled = 2 * lat.iter().filter(|lat| lat.is_finite()).count() > lat.len() && !depth.is_empty();
    let mut positions = Positions::default();
    let mut last: Option<GpsFix> = None;
    let mut fixes = Vec::new();
    for (row, (&time, (&lat, &lon))) in time.iter().zip(lat.iter().zip(&lon)).enumerate() {
        let is_deep = depth.get(row).is_some_and(|depth| depth.abs() > AT_SURFACE);
        let is_new = positions.is_received(lat, lon, !is_deep && lat.is_finite() && lon.is_finite());
        let Some(fix) = GpsFix::new(time, of(lat), of(lon)).filter(|_| !is_deep) else { continue };
        let differs = last.is_none_or(|last| (last.lat_deg, last.lon_deg) != (fix.lat_deg, fix.lon_deg));
        let counts = if is_filled { is_new } else { differs };
        if counts {
            fixes.push(fix);
        }
        last = Some(fix);
    }
    Ok(fixes)
}

/// A receiver gets no position below, an offset of the sensor included \[dbar or m\].
const AT_SURFACE: f64 = 5.0;

/// Whether quality control takes a position for one that was received: neither bad (3, 4) nor missing (9), nor interpolated (8).
/// Of the positions of all rows those alone that it calls good (1, 2).
fn is_received(flag: f64, is_receiver: bool) -> bool {
    if is_receiver { ![3.0, 4.0, 8.0, 9.0].contains(&flag) } else { [1.0, 2.0].contains(&flag) }
}

/// The times of so many positions \[s\]: the receiver's own before those of the rows.
fn times_of(path: &Path, file: &NcFile, rows: usize) -> Result<Vec<f64>, InputError> {
    for name in ["TIME_GPS", "gps_time", "log_gps_time", "TIME", "time", "m_present_time"] {
        if !has(file, name) {
            continue;
        }
        let time = values(path, file, name)?;
        // Where the receiver has a time of its own in few rows only, it has it where the positions are.
        if time.len() == rows && time.iter().any(|time| time.is_finite()) {
            let conversion = stated(path, file, Channel::Time, name)?;
            return Ok(time.into_iter().map(|value| conversion.convert(value)).collect());
        }
    }
    Ok(Vec::new())
}

/// Pressure or depth of the rows where positions stand in them, the last value before where one is missing; else nothing.
fn depth_of(path: &Path, file: &NcFile, rows: usize) -> Vec<f64> {
    let variables = Variables::new(file);
    for channel in [Channel::Pressure, Channel::Depth] {
        let Ok(Some(name)) = variables.find(path, file, channel, Some(rows)) else { continue };
        let (Ok(column), Ok(conversion)) = (values(path, file, &name), stated(path, file, channel, &name)) else {
            continue;
        };
        if column.len() == rows {
            let mut last = f64::NAN;
            let known = column.into_iter().map(|value| value_of(channel, conversion, value));
            return known
                .map(|value| {
                    if value.is_finite() {
                        last = value
                    }
                    last
                })
                .collect();
        }
    }
    Vec::new()
}

/// The glider, where the file names it, and the first time of its record \[s\].
///
/// # Errors
/// A file without time.
pub(super) fn headline(path: &Path, file: &NcFile, columns: &Columns) -> Result<(String, f64), InputError> {
    let name = match columns.chosen(Channel::Time) {
        Some(name) => Some(name.to_owned()),
        None => Variables::new(file).find(path, file, Channel::Time, None)?,
    };
    let start_s = match name.filter(|name| has(file, name)) {
        Some(name) => {
            let conversion =
                columns.unit(Channel::Time).map_or_else(|| stated(path, file, Channel::Time, &name), Ok)?;
            values(path, file, &name)?
                .into_iter()
                .find(|time| time.is_finite())
                .map_or(f64::NAN, |time| conversion.convert(time))
        }
        None => return Err(missing(path, "time", names::known(Channel::Time))),
    };
    let glider = ["platform_serial_number", "glider_serial", "glider_name", "platform_id"]
        .into_iter()
        .find_map(|name| attribute_text(file, name).filter(|text| !text.is_empty()));
    Ok((glider.unwrap_or_default(), start_s))
}

/// What the file says of a unit. One that is not stated is taken for the usual one.
fn stated(path: &Path, file: &NcFile, channel: Channel, name: &str) -> Result<Conversion, InputError> {
    let unit = units(file, name);
    let is_slocums = (name.starts_with("m_") || name.starts_with("sci_")) && !name.starts_with("sci_rbrctd");
    if let Some(conversion) = units::conversion(channel, &unit) {
        return Ok(conversion);
    }
    match channel {
        // The Slocum's own sensors give bar and radians, OG1 dbar and degrees.
        Channel::Pressure if unit.is_empty() => Ok(Conversion::by(if is_slocums { 10.0 } else { 1.0 })),
        _ if is_angle(channel) && unit.is_empty() => {
            Ok(if is_slocums { Conversion::NONE } else { Conversion::by(std::f64::consts::PI / 180.0) })
        }
        Channel::PitchMass if unit.is_empty() => Ok(Conversion::by(0.01)),
        Channel::BatteryPosition if is_slocums => Ok(Conversion::by(0.0254)),
        // Volumes of ballast that a program could not label.
        Channel::Ballast if ["cm", "1", "", "counts", "dimensionless", "nodim"].contains(&unit.as_str()) => {
            Ok(Conversion::NONE)
        }
        Channel::Time if unit.is_empty() => Ok(Conversion::NONE),
        Channel::Speed if unit.is_empty() => Ok(units::unit_at_end(channel, name).unwrap_or(Conversion::NONE)),
        Channel::Time | Channel::Pressure | Channel::Ballast | Channel::Speed => {
            Err(unknown(path, channel, name, &unit))
        }
        _ if is_angle(channel) => Err(unknown(path, channel, name, &unit)),
        _ => Ok(Conversion::NONE),
    }
}

fn unknown(path: &Path, channel: Channel, name: &str, unit: &str) -> InputError {
    let problem = format!("variable `{}` is in `{}`, a unit that is not known here", printable(name), printable(unit));
    let option = CHANNELS[channel as usize].name;
    InputError::new(Place::file(path), problem).help(format!("state it by --unit {option}=UNIT"))
}
