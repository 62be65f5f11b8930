//! `glidepolar track`: dead reckoning with a polar, and depth-averaged currents where fixes exist.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::reading::{columns, said};
use super::table::for_each_row;
use super::track_page::{self, Remarks};
use super::{CliError, Output, housekeeping, log_vehicle, print_notes, vehicle_input, warn, water_density};
use crate::diagnose::sea::consistency::DensityError;
use crate::dynamics::Parameters;
use crate::input::{InputError, Place};
use crate::log::{
    CHANNELS, Channel, DBAR_PA, FlightLog, LogFiles, Piece, Shorten, in_situ_density_kg_m3, practical_salinity,
};
use crate::reading::{Gathering, check_pitch, no_rows, settings};
use crate::report::{InputFile, Report as Page};
use crate::track::comparison::{self, Comparison, Stored};
use crate::track::plausibility;
use crate::track::{DiveTrack, Drift, Fix, Sample, Track, TrackSettings, reckon};
use crate::vehicle::Vehicle;

/// Samples read at a time.
const PIECE_ROWS: usize = 100_000;

/// Longest time that a reading of a slow channel is kept [s].
const KEEP_S: f64 = 120.0;

/// Dead reckoning by the polar and the heading; depth-averaged currents between fixes
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar track p542*.nc --vehicle my-seaglider.toml --declination-deg -23\n  \
    glidepolar track log.csv --vehicle my-glider.toml --fixes fixes.csv --csv track.csv\n  \
    glidepolar track log.csv --vehicle my-glider.toml --write log-with-speed.csv\n  \
    glidepolar track log.csv --vehicle my-glider.toml --fixes fixes.csv --out track/\n\n\
    Fixes: a table with time_s (or start_time_s), lat_deg, lon_deg; with dac_east_m_s and dac_north_m_s beside them the\n\
    currents are compared. The vehicle should be one whose trim and polar were identified (`glidepolar identify`).")]
pub struct Arguments {
    /// Flight logs of one glider
    #[arg(required = true)]
    logs: Vec<PathBuf>,
    /// Vehicle file or name of a built-in vehicle
    #[arg(long, value_name = "VEHICLE")]
    vehicle: String,
    /// Fixes (CSV); default: those in the files
    #[arg(long, value_name = "FILE")]
    fixes: Option<PathBuf>,
    /// True less magnetic heading, positive to the east; default: what the files say, else 0 [deg]
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    declination_deg: Option<f64>,
    /// Standard error of the compass through a dive [deg]
    #[arg(long, value_name = "S", default_value_t = 3.0, allow_negative_numbers = true)]
    heading_error_deg: f64,
    /// Standard error of the polar's speed beyond the vehicle's [uncertainty], per cent; default: 0 where the vehicle
    /// states errors of its coefficients, 10 where it does not
    #[arg(long, value_name = "P", allow_negative_numbers = true)]
    speed_error_percent: Option<f64>,
    /// Where in a dive the fixes of a table with start_time_s were taken: at its start, or in its middle (needs duration_s)
    #[arg(long, value_enum, default_value_t = FixesAt::Start)]
    fixes_at: FixesAt,
    /// Standard error of a fix on either axis [m]
    #[arg(long, value_name = "S", default_value_t = 50.0, allow_negative_numbers = true)]
    fix_error_m: f64,
    /// Density where the log gives none [kg/m3]
    #[arg(long, value_name = "RHO", allow_negative_numbers = true)]
    density: Option<f64>,
    /// Take a channel from another column: heading_rad=heading_true_rad
    #[arg(long, value_name = "CHANNEL=COLUMN")]
    column: Vec<String>,
    /// State the unit of a channel, whatever the file says: pitch_rad=rad
    #[arg(long, value_name = "CHANNEL=UNIT")]
    unit: Vec<String>,
    /// Folder with the lists of sensors (.cac, .ccc) of a Slocum's binary files [default: beside them]
    #[arg(long, value_name = "DIR")]
    cache: Vec<PathBuf>,
    /// Write the track to FILE (CSV)
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write the log with the polar's speed through the water to FILE (CSV)
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
    /// Write report.html and its figures to DIR
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FixesAt {
    Start,
    Middle,
}

/// Error of the speed of a polar of which nothing is known \[per cent\]: by so much two flight models of one Seaglider,
/// both fitted to its vertical velocity, differ in speed.
const UNKNOWN_POLAR_PERCENT: f64 = 10.0;

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let a = arguments;
    for (name, value) in [
        ("--heading-error-deg", a.heading_error_deg),
        ("--speed-error-percent", a.speed_error_percent.unwrap_or(0.0)),
        ("--fix-error-m", a.fix_error_m),
    ] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(CliError::Usage(format!("{name} {value}: expected a number not below zero")));
        }
    }
    let Read { log, vehicle, mut warnings, notes, density_error, fixes: own_fixes, declination_deg } =
        read(a, log_vehicle::load(&a.vehicle, &a.logs)?)?;
    let declination_deg = a.declination_deg.or(declination_deg).unwrap_or(0.0);
    let samples = samples(a, &log, density_error)?;
    let moved: Vec<Parameters<f64>> = vehicle
        .uncertainty
        .iter()
        .filter_map(|(path, se)| {
            let mut moved = vehicle.clone();
            moved.set(path, vehicle.get(path)? + se).ok()?;
            Some(moved.glide_parameters())
        })
        .collect();
    let settings = TrackSettings {
        declination_rad: declination_deg.to_radians(),
        heading_error_rad: a.heading_error_deg.to_radians(),
        speed_error: a.speed_error_percent.unwrap_or_else(|| unknown_polar_percent(&vehicle)) / 100.0,
        ..TrackSettings::default()
    };
    let mut track = reckon(&vehicle.glide_parameters(), &moved, &samples, &settings);
    let table = match &a.fixes {
        Some(file) => Some(read_fixes(file, a.fixes_at)?),
        None if own_fixes.is_empty() => None,
        None => Some(Fixes { fixes: own_fixes, stored: Vec::new(), middle: None }),
    };
    let mut drifts = Vec::new();
    let mut comparison = None;
    if let Some(table) = &table {
        track.set_currents(&table.fixes, a.fix_error_m);
        drifts = track.drifts(&table.fixes, a.fix_error_m);
        warnings.extend(plausibility::too_strong(&drifts, &track.dives));
        comparison = match a.fixes_at {
            FixesAt::Start => Comparison::new(&comparison::by_dive(&track.dives, &table.stored)),
            FixesAt::Middle => Comparison::new(&comparison::by_drift(&drifts, &table.stored)),
        };
        if let (FixesAt::Start, Some(found), Some(middle)) = (a.fixes_at, &comparison, &table.middle) {
            let other = Comparison::new(&comparison::by_drift(&track.drifts(&middle.0, a.fix_error_m), &middle.1));
            if let Some(other) = other.filter(|other| 2.0 * other.rms_difference_m_s < found.rms_difference_m_s) {
                warnings.push(format!(
                    "the positions fit the stored currents far better as those of the middle of each dive ({:.3} against {:.3} m/s): --fixes-at middle",
                    other.rms_difference_m_s, found.rms_difference_m_s
                ));
            }
        }
    }
    let written = a.csv.as_ref().map(|path| (path, track_table(&track)));
    let tables = [written, a.write.as_ref().map(|path| (path, log_table(&log, &track, &samples)))];
    for (path, table) in tables.iter().flatten() {
        a.output.check(path, table.as_bytes())?;
    }
    if let Some(out) = &a.out {
        let remarks = Remarks {
            vehicle: &vehicle.name,
            is_builtin: vehicle.is_builtin,
            has_uncertainty: !moved.is_empty(),
            declination_deg,
            speed_error: settings.speed_error,
            fixes: table.as_ref().map_or(&[], |table| &table.fixes),
            drifts: &drifts,
            stored: table.as_ref().map_or(&[], |table| &table.stored),
            comparison: comparison.as_ref().map(Comparison::sentence),
        };
        let mut page = track_page::page(&track, &remarks).input(vehicle_input(&a.vehicle)?);
        page.warnings.extend(warnings.iter().cloned());
        page = housekeeping(&notes).into_iter().fold(page, Page::section);
        for file in a.logs.iter().chain(&a.fixes) {
            page = page.input(InputFile::read(file)?);
        }
        page.write(a.output.folder(out)?)?;
    }
    for (path, table) in tables.iter().flatten() {
        a.output.write(path, table.as_bytes())?;
    }
    let report = TrackReport {
        schema: "glidepolar.track/1",
        vehicle: &vehicle.name,
        dives: &track.dives,
        between_fixes: &drifts,
        comparison,
        warnings,
    };
    if a.output.shows_tables() {
        report.print();
        print_notes(&notes);
    }
    warn(&report.warnings);
    a.output.write_json(&report)
}

/// A log as it was recorded, and what belongs to it.
struct Read {
    log: FlightLog,
    /// The vehicle where the log was recorded.
    vehicle: Vehicle,
    warnings: Vec<String>,
    /// What was found in the reading and done about it.
    notes: Vec<String>,
    density_error: Option<DensityError>,
    /// Fixes and magnetic declination that the files themselves hold.
    fixes: Vec<Fix>,
    declination_deg: Option<f64>,
}

/// The log as it was recorded. Beside it goes the way that the other commands take to their samples, so that what they
/// refuse is refused here, and what is doubtful comes back in words.
fn read(a: &Arguments, vehicle: Vehicle) -> Result<Read, CliError> {
    let columns = columns(&a.column, &a.unit, &a.cache, None)?;
    let mut log = FlightLog::default();
    let mut gathering = Gathering::new(settings(&vehicle, water_density(a.density)?), Shorten::Means);
    let mut files = LogFiles::open(&a.logs, &columns)?;
    while let Some(piece) = files.next_piece(PIECE_ROWS)? {
        match piece {
            Piece::Series(piece) => {
                log.append(&piece);
                gathering.push(*piece);
            }
            Piece::Glides(_) => {
                let error = InputError::new(Place::file(&a.logs[0]), "a table of glides has no track");
                return Err(error.help("name the log it was made from").into());
            }
        }
        said(gathering.progress(&files));
    }
    let mut prepared = gathering.finish()?;
    check_pitch(&a.logs[0], &prepared.observations)?;
    let vehicle = prepared.located(vehicle)?;
    let (mut warnings, density_error) = prepared.checked(&vehicle)?;
    warnings.splice(0..0, files.warnings().iter().cloned());
    let fixes = files
        .fixes()
        .iter()
        .map(|fix| Fix { time_s: fix.time_s, lat_deg: fix.lat_deg, lon_deg: fix.lon_deg })
        .collect();
    let declination_deg = files.calibration().and_then(|calibration| calibration.declination_deg);
    let notes = files.notes().iter().cloned().chain(prepared.notes).collect();
    Ok(Read { log, vehicle, warnings, notes, density_error, fixes, declination_deg })
}

/// The log as dead reckoning needs it: slow channels kept until they are read again.
/// A density whose error the log itself shows is corrected as the other commands correct it.
fn samples(a: &Arguments, log: &FlightLog, density_error: Option<DensityError>) -> Result<Vec<Sample>, CliError> {
    if log.is_empty() {
        return Err(no_rows(&a.logs[0]).into());
    }
    for (channel, name) in [(Channel::Pitch, "pitch"), (Channel::Heading, "heading"), (Channel::Ballast, "ballast")] {
        if !log.has(channel) {
            let info = CHANNELS.iter().find(|info| info.channel == channel).map_or("", |info| info.name);
            let error = InputError::new(Place::file(&a.logs[0]), format!("no {name}: expected a column `{info}`"));
            return Err(error.help("choose another column by --column CHANNEL=COLUMN").into());
        }
    }
    let mut kept = [(f64::NEG_INFINITY, f64::NAN); CHANNELS.len()];
    let (mut samples, mut dive, mut latest_s) = (Vec::with_capacity(log.len()), 0, f64::NEG_INFINITY);
    let mut under_water = false;
    for row in 0..log.len() {
        let time_s = log.at(Channel::Time, row);
        // Backward clocks and missing times are left out: no way can be laid to them.
        if time_s.is_nan() || time_s <= latest_s {
            continue;
        }
        latest_s = time_s;
        let mut value = |channel: Channel| {
            let read = log.at(channel, row);
            let kept = &mut kept[channel as usize];
            if read.is_finite() {
                *kept = (time_s, read);
            }
            if time_s - kept.0 <= KEEP_S { kept.1 } else { f64::NAN }
        };
        let (pressure, temperature_C) = (value(Channel::Pressure), value(Channel::Temperature));
        let depth_m = match value(Channel::Depth) {
            depth if depth.is_finite() => depth,
            _ => pressure * DBAR_PA / (1025.0 * 9.81),
        };
        let (salinity, conductivity_S_m) = (value(Channel::Salinity), value(Channel::Conductivity));
        let salinity =
            if salinity.is_finite() { salinity } else { practical_salinity(conductivity_S_m, temperature_C, pressure) };
        let at_zero_pressure = density_error == Some(DensityError::AtZeroPressure);
        let density_kg_m3 = match value(Channel::Density) {
            density if density.is_finite() && !at_zero_pressure => match density_error {
                Some(DensityError::Bias(bias_kg_m3, _)) => density + bias_kg_m3,
                _ => density,
            },
            _ if salinity.is_finite() && temperature_C.is_finite() && pressure.is_finite() => {
                let (lat, lon) = (value(Channel::Latitude), value(Channel::Longitude));
                in_situ_density_kg_m3(salinity, temperature_C, pressure, lat, lon)
            }
            _ => a.density.unwrap_or(f64::NAN),
        };
        let numbered = value(Channel::Dive);
        if numbered.is_finite() {
            dive = numbered as u32;
        } else if depth_m > 5.0 && !under_water {
            (dive, under_water) = (dive + 1, true);
        } else if depth_m < 2.0 {
            under_water = false;
        }
        samples.push(Sample {
            time_s,
            dive,
            depth_m,
            pitch_rad: value(Channel::Pitch),
            heading_rad: value(Channel::Heading),
            ballast_m3: value(Channel::Ballast) * 1e-6,
            density_kg_m3,
            temperature_C,
        });
    }
    if !samples.iter().any(|sample| sample.density_kg_m3.is_finite()) {
        let error =
            InputError::new(Place::file(&a.logs[0]), "no density, nor temperature with salinity or conductivity");
        return Err(error.help("give it with --density").into());
    }
    Ok(samples)
}

/// The per cent by which the speed of this vehicle may err beyond what its file states.
fn unknown_polar_percent(vehicle: &Vehicle) -> f64 {
    let stated = vehicle.uncertainty.iter().any(|(path, _)| path.starts_with("hydro."));
    if stated { 0.0 } else { UNKNOWN_POLAR_PERCENT }
}

/// A table of fixes.
struct Fixes {
    fixes: Vec<Fix>,
    stored: Vec<Stored>,
    /// The same with the times of the middle of the dives, where these are known and were not asked for.
    middle: Option<(Vec<Fix>, Vec<Stored>)>,
}

fn read_fixes(file: &Path, at: FixesAt) -> Result<Fixes, InputError> {
    let text = std::fs::read_to_string(file).map_err(|error| InputError::io(file, &error))?;
    let header = text.lines().find(|line| !line.starts_with('#')).unwrap_or("");
    let has = |name: &str| header.split(',').any(|column| column.trim() == name);
    let time = if has("time_s") { "time_s" } else { "start_time_s" };
    let duration = (time == "start_time_s" && has("duration_s")).then_some("duration_s");
    if at == FixesAt::Middle && duration.is_none() && !header.trim().is_empty() {
        let error = InputError::new(Place::line(file, 1), "no columns `start_time_s` and `duration_s`");
        return Err(error.help("the middle of a dive follows from both; for fixes with a time_s leave --fixes-at out"));
    }
    let currents = has("dac_east_m_s") && has("dac_north_m_s");
    let mut rows: Vec<[f64; 6]> = Vec::new();
    // Columns that are not there are read as others that are, and not looked at.
    let columns = [
        time,
        duration.unwrap_or(time),
        "lat_deg",
        "lon_deg",
        if currents { "dac_east_m_s" } else { "lat_deg" },
        if currents { "dac_north_m_s" } else { "lat_deg" },
    ];
    for_each_row(file, columns, |_, row| rows.extend(Some(row).filter(|row| !row.iter().any(|v| v.is_nan()))))?;
    rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let at_times = |share: f64| {
        let later = |row: &[f64; 6]| row[0] + share * row[1];
        let fixes = rows.iter().map(|row| Fix { time_s: later(row), lat_deg: row[2], lon_deg: row[3] }).collect();
        let stored = rows.iter().filter(|_| currents).map(|row| (later(row), row[4], row[5])).collect();
        (fixes, stored)
    };
    let (fixes, stored) = at_times(if at == FixesAt::Middle { 0.5 } else { 0.0 });
    let middle = (at == FixesAt::Start && duration.is_some()).then(|| at_times(0.5));
    Ok(Fixes { fixes, stored, middle })
}

fn track_table(track: &Track) -> String {
    let mut table = "time_s,dive,depth_m,speed_through_water_m_s,east_m,north_m\n".to_owned();
    for point in &track.points {
        let speed = if point.speed_m_s.is_finite() { format!("{:.5}", point.speed_m_s) } else { String::new() };
        let _ = writeln!(
            table,
            "{:.3},{},{:.3},{speed},{:.2},{:.2}",
            point.time_s, point.dive, point.depth_m, point.east_m, point.north_m
        );
    }
    table
}

/// The log in its own columns, the speed of the polar among them, and the density that was taken where the log has none.
/// `samples` are those that the track was reckoned from.
fn log_table(log: &FlightLog, track: &Track, samples: &[Sample]) -> String {
    let channels: Vec<_> =
        CHANNELS.iter().filter(|info| log.has(info.channel) && info.channel != Channel::Speed).collect();
    let names: Vec<&str> = channels.iter().map(|info| info.name).collect();
    let mut table = format!("# speed_through_water_m_s is the polar's, by glidepolar track\n{},", names.join(","));
    let adds_density = !log.has(Channel::Density);
    table.push_str(if adds_density { "density_kg_m3,speed_through_water_m_s\n" } else { "speed_through_water_m_s\n" });
    let mut points = track.points.iter().zip(samples).peekable();
    for row in 0..log.len() {
        for info in &channels {
            let value = log.at(info.channel, row);
            if value.is_finite() {
                let _ = write!(table, "{value}");
            }
            table.push(',');
        }
        let here = points.next_if(|(point, _)| point.time_s == log.at(Channel::Time, row));
        if adds_density {
            if let Some(density) = here.map(|(_, sample)| sample.density_kg_m3).filter(|density| density.is_finite()) {
                let _ = write!(table, "{density:.4}");
            }
            table.push(',');
        }
        if let Some(speed_m_s) = here.map(|(point, _)| point.speed_m_s).filter(|speed| speed.is_finite()) {
            let _ = write!(table, "{speed_m_s:.5}");
        }
        table.push('\n');
    }
    table
}

/// The result as JSON gives it.
#[derive(Debug, Serialize)]
struct TrackReport<'a> {
    schema: &'static str,
    vehicle: &'a str,
    dives: &'a [DiveTrack],
    between_fixes: &'a [Drift],
    #[serde(skip_serializing_if = "Option::is_none")]
    comparison: Option<Comparison>,
    warnings: Vec<String>,
}

impl TrackReport<'_> {
    fn print(&self) {
        println!("{}: ways through the water and currents, +- standard error", self.vehicle);
        println!("  dive   hours     east [km]        north [km]       current east      current north [m/s]");
        for dive in self.dives {
            let current = dive.current.map_or(String::new(), |current| {
                format!(
                    "{:8.3} +- {:.3}   {:8.3} +- {:.3}",
                    current.east_m_s, current.east_se_m_s, current.north_m_s, current.north_se_m_s
                )
            });
            println!(
                "{:6} {:7.2} {:9.3} +- {:.3} {:9.3} +- {:.3} {current}",
                dive.dive,
                (dive.end_s - dive.start_s) / 3600.0,
                dive.east_m / 1e3,
                dive.east_se_m / 1e3,
                dive.north_m / 1e3,
                dive.north_se_m / 1e3
            );
        }
        if self.dives.iter().all(|dive| dive.current.is_none()) && !self.between_fixes.is_empty() {
            println!("  between fixes [h]      current east      current north [m/s]");
            for drift in self.between_fixes {
                let c = drift.current;
                println!(
                    "  {:8.2} .. {:8.2}  {:8.3} +- {:.3}   {:8.3} +- {:.3}",
                    (drift.start_s - self.between_fixes[0].start_s) / 3600.0,
                    (drift.end_s - self.between_fixes[0].start_s) / 3600.0,
                    c.east_m_s,
                    c.east_se_m_s,
                    c.north_m_s,
                    c.north_se_m_s
                );
            }
        }
        if let Some(comparison) = &self.comparison {
            println!("{}", comparison.sentence());
        }
    }
}
