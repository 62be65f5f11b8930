//! `glidepolar track`: dead reckoning with a polar, and depth-averaged currents where fixes exist.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::reading::columns;
use super::track_fixes::{self, Fixes, FixesAt};
use super::track_log::{self, Read, Stated, log_table};
use super::track_page::{self, Remarks};
use super::{CliError, Output, housekeeping, inputs, log_vehicle, print_notes, vehicle_input, warn, water_density};
use crate::dynamics::Parameters;
use crate::report::{InputFile, Report as Page};
use crate::track::comparison::{self, Comparison};
use crate::track::plausibility;
use crate::track::{DiveTrack, Drift, Track, TrackSettings, reckon};
use crate::vehicle::Vehicle;

/// Dead reckoning by the polar and the heading; depth-averaged currents between fixes
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar track p542*.nc --vehicle my-seaglider.toml --declination-deg -23\n  \
    glidepolar track log.csv --vehicle my-glider.toml --fixes fixes.csv --csv track.csv\n  \
    glidepolar track log.csv --vehicle my-glider.toml --write log-with-speed.csv\n  \
    glidepolar track log.csv --vehicle my-glider.toml --fixes fixes.csv --out track/\n\n\
    Fixes: a table with time_s (or start_time_s), lat_deg, lon_deg, in any form that logs may have; with dac_east_m_s and\n\
    dac_north_m_s beside them the currents are compared. The vehicle should be one whose trim and polar were identified (`glidepolar identify`).")]
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

/// Error of the speed of a polar of which nothing is known \[per cent\]: by so much two flight models of one Seaglider,
/// both fitted to its vertical velocity, differ in speed.
const UNKNOWN_POLAR_PERCENT: f64 = 10.0;

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let a = arguments;
    let inputs = inputs(a.logs.iter().chain(&a.fixes), Some(&a.vehicle));
    let places = [("--csv", a.csv.as_deref()), ("--write", a.write.as_deref()), ("--out", a.out.as_deref())];
    a.output.begin(&inputs, &places)?;
    for (name, value) in [
        ("--heading-error-deg", a.heading_error_deg),
        ("--speed-error-percent", a.speed_error_percent.unwrap_or(0.0)),
        ("--fix-error-m", a.fix_error_m),
    ] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(CliError::Usage(format!("{name} {value}: expected a number not below zero")));
        }
    }
    let stated = Stated {
        logs: &a.logs,
        columns: columns(&a.column, &a.unit, &a.cache, None)?,
        density_kg_m3: water_density(a.density)?,
    };
    let Read { log, samples, vehicle, mut warnings, notes, fixes: own_fixes, declination_deg } =
        track_log::read(&stated, log_vehicle::load(&a.vehicle, &a.logs)?)?;
    let declination_deg = a.declination_deg.or(declination_deg).unwrap_or(0.0);
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
    warnings.extend(track.long_gaps().into_iter().map(plausibility::long_gap));
    let table = match &a.fixes {
        Some(file) => Some(track_fixes::read(file, a.fixes_at)?),
        None if own_fixes.is_empty() => None,
        None => Some(Fixes { fixes: own_fixes, ..Fixes::default() }),
    };
    let mut drifts = Vec::new();
    let mut comparison = None;
    if let Some(table) = &table {
        warnings.extend(table.warnings.iter().cloned());
        warnings.extend(a.fixes.as_ref().and_then(|file| table.beside_the_log(file, &track)));
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

/// The per cent by which the speed of this vehicle may err beyond what its file states.
fn unknown_polar_percent(vehicle: &Vehicle) -> f64 {
    let stated = vehicle.uncertainty.iter().any(|(path, _)| path.starts_with("hydro."));
    if stated { 0.0 } else { UNKNOWN_POLAR_PERCENT }
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
                dive.recorded_s() / 3600.0,
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
