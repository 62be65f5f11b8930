//! `glidepolar simulate --3d`: time histories and missions in six degrees of freedom.

use std::fmt::Write;
use std::path::Path;

use serde::Serialize;

use super::mission::{EnergyFigures, Frame, MissionArguments};
use super::space_page::{Trace, history_page, mission_page};
use super::{CliError, Output};
use crate::log::{Dates, plain_table};
use crate::report::InputFile;
use crate::simulate::Schedule;
use crate::simulate::mission::{Account, LegKind, Mission, RouteMoment, fly_route};
use crate::simulate::space::{COLUMNS, Row, SpaceSettings, column, fly};
use crate::spatial::{Body, Inputs};
use crate::vehicle::Vehicle;

/// Time between two rows of a mission where nothing else is said [s].
const INTERVAL_S: f64 = 10.0;

const LOG_COLUMNS: &str = "time_s,dive,pressure_dbar,depth_m,pitch_rad,roll_rad,heading_rad,vbd_cc,battpos_m,roll_mass_rad,rudder_rad,lat_deg,lon_deg,density_kg_m3,temperature_C";

/// A time history through a table of inputs.
pub(super) fn history(
    vehicle: &str,
    body: &Body<f64>,
    inputs: Option<&Path>,
    settings: &SpaceSettings,
    csv: Option<&Path>,
    (out, input, output): (Option<&Path>, InputFile, &Output),
) -> Result<(), CliError> {
    let schedule = match inputs {
        None => Schedule::default(),
        Some(path) => {
            let text = plain_table(path, Dates::SinceFirst)?;
            Schedule::of_names(Inputs::NAMES, &text, path)?
        }
    };
    let mut table = csv.map(|_| COLUMNS.join(",") + "\n");
    let mut trace = Trace::default();
    let mut summary = Summary { schema: "glidepolar.simulate-space/1", ..Summary::default() };
    fly(body, &schedule, settings, |row| {
        if let Some(table) = &mut table {
            push(table, row);
        }
        if out.is_some() {
            trace.add(row);
        }
        summary.add(row);
        true
    })
    .map_err(|error| CliError::Failed(error.to_string()))?;
    let table = csv.zip(table);
    if let Some((path, table)) = &table {
        output.check(path, table.as_bytes())?;
    }
    if let Some(out) = out {
        let mut page = history_page(vehicle, &trace).input(input);
        if let Some(inputs) = inputs {
            page = page.input(InputFile::read(inputs)?);
        }
        page.write(output.folder(out)?)?;
    }
    if let Some((path, table)) = &table {
        output.write(path, table.as_bytes())?;
    }
    if output.shows_tables() {
        summary.print();
    }
    output.write_json(&summary)
}

/// A mission.
pub(super) fn mission(
    vehicle: &Vehicle,
    file: &Path,
    arguments: &MissionArguments,
    frame: &Frame<'_>,
) -> Result<(), CliError> {
    let body = vehicle.body()?;
    let mut mission = Mission::load(file)?;
    mission.duration_s = mission.duration_s.min(frame.stop_s.unwrap_or(f64::INFINITY));
    let mut tables = Tables {
        history: frame.csv.map(|_| format!("{},leg\n", COLUMNS.join(","))),
        log: arguments.log.as_ref().map(|_| {
            format!("# simulated by glidepolar; pitch and pressure as the glider reads them\n{LOG_COLUMNS}\n")
        }),
        fixes: arguments.fixes.as_ref().map(|_| "# simulated by glidepolar\ntime_s,lat_deg,lon_deg\n".to_owned()),
        dive: 0,
        before: LegKind::Surface,
        last: None,
    };
    let mut trace = Trace::default();
    let interval_s = frame.interval_s.unwrap_or(INTERVAL_S);
    let account = fly_route(&body, &mission, interval_s, frame.tolerance, |moment| {
        tables.add(moment);
        if arguments.out.is_some() {
            trace.add(&moment.row);
        }
        true
    })
    .map_err(|error| CliError::Failed(error.to_string()))?;
    tables.last_fix();
    frame.write(arguments, [tables.history, tables.log, tables.fixes], |folder| {
        let page = mission_page(&vehicle.name, &mission, &account, &trace).input(InputFile::read(file)?);
        Ok(page.write(frame.output.folder(folder)?)?)
    })?;
    let report = SpaceReport {
        schema: "glidepolar.mission-space/1",
        vehicle: &vehicle.name,
        mission: &mission.name,
        account: &account,
        figures: EnergyFigures::of(vehicle),
    };
    if frame.output.shows_tables() {
        report.print();
    }
    frame.output.write_json(&report)
}

fn push(table: &mut String, row: &Row) {
    for (i, value) in row.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(table, "{}{value}", if i == 0 { "" } else { "," });
    }
    table.push('\n');
}

/// The tables that are filled while the mission is flown.
struct Tables {
    history: Option<String>,
    log: Option<String>,
    fixes: Option<String>,
    dive: u64,
    before: LegKind,
    last: Option<Row>,
}

impl Tables {
    fn last_fix(&mut self) {
        if let (Some(fixes), Some(row)) = (&mut self.fixes, self.last.filter(|_| self.before == LegKind::Surface)) {
            let [time, latitude, longitude] = ["time", "lat_deg", "lon_deg"].map(|name| column(&row, name));
            let _ = writeln!(fixes, "{time:.1},{latitude:.7},{longitude:.7}");
        }
    }

    fn add(&mut self, moment: &RouteMoment) {
        self.dive += u64::from(self.before == LegKind::Surface && moment.leg == LegKind::Descent);
        // Where the glider comes up, and where it leaves.
        if moment.leg != LegKind::Surface {
            self.last_fix();
        }
        let came_up = self.before != LegKind::Surface && moment.leg == LegKind::Surface;
        (self.before, self.last) = (moment.leg, Some(moment.row));
        if came_up {
            self.last_fix();
        }
        if let Some(history) = &mut self.history {
            push(history, &moment.row);
            history.pop();
            let leg = match moment.leg {
                LegKind::Descent => "descent",
                LegKind::Ascent => "ascent",
                LegKind::Surface => "surface",
            };
            let _ = writeln!(history, ",{leg}");
        }
        if let Some(log) = &mut self.log {
            let of = |name: &str| column(&moment.row, name);
            let _ = writeln!(
                log,
                "{:.3},{},{:.4},{:.4},{:.6},{:.6},{:.6},{:.3},{:.6},{:.6},{:.6},{:.7},{:.7},{:.5},{:.4}",
                of("time"),
                self.dive,
                moment.pressure_read_dbar,
                of("depth_m"),
                moment.pitch_read_rad,
                of("roll_rad"),
                of("heading_rad").rem_euclid(std::f64::consts::TAU),
                moment.ballast_m3 * 1e6,
                of("moving_mass_position_m"),
                of("roll_mass_rad"),
                of("rudder_rad"),
                of("lat_deg"),
                of("lon_deg"),
                moment.density_kg_m3,
                moment.temperature_C
            );
        }
    }
}

/// Where the flight went, as JSON gives it.
#[derive(Debug, Default, Serialize)]
struct Summary {
    schema: &'static str,
    rows: u64,
    duration_s: f64,
    north_m: f64,
    east_m: f64,
    heading_rad: f64,
    final_depth_m: f64,
    largest_depth_m: f64,
    energy_J: f64,
}

impl Summary {
    fn add(&mut self, row: &Row) {
        let of = |name: &str| column(row, name);
        self.rows += 1;
        self.duration_s = of("time");
        (self.north_m, self.east_m, self.heading_rad) = (of("north_m"), of("east_m"), of("heading_rad"));
        self.final_depth_m = of("depth_m");
        self.largest_depth_m = self.largest_depth_m.max(self.final_depth_m);
        self.energy_J = of("energy_J");
    }

    fn print(&self) {
        println!(
            "after {:.0} s: {:.1} m north, {:.1} m east, at {:.1} m depth, heading {:.1} deg",
            self.duration_s,
            self.north_m,
            self.east_m,
            self.final_depth_m,
            self.heading_rad.to_degrees()
        );
        println!("largest depth {:.1} m, energy {:.0} J", self.largest_depth_m, self.energy_J);
    }
}

/// A mission as JSON gives it.
#[derive(Debug, Serialize)]
struct SpaceReport<'a> {
    schema: &'static str,
    vehicle: &'a str,
    mission: &'a str,
    #[serde(flatten)]
    account: &'a Account,
    #[serde(flatten)]
    figures: EnergyFigures,
}

impl SpaceReport<'_> {
    fn print(&self) {
        let a = self.account;
        println!(
            "{}, {}: {:.2} h, {:.2} km over ground, {} of {} waypoints",
            self.vehicle,
            self.mission,
            a.duration_s / 3600.0,
            a.distance_m / 1e3,
            a.waypoints_reached,
            a.waypoints
        );
        println!(
            "  {} dives, {} surfacings; {} pumpings, {} moves of the moving mass, {} of rudder or roll mass",
            a.dives, a.surfacings, a.pumpings, a.pitch_moves, a.steering_moves
        );
        println!("  pump {}, hotel {}", self.figures.pump(a.pump_J / 3600.0), self.figures.hotel(a.hotel_J / 3600.0));
        if a.steering_J + a.surfacing_J > 0.0 {
            println!("  steering {:.2} Wh, surfacings {:.2} Wh", a.steering_J / 3600.0, a.surfacing_J / 3600.0);
        }
        if a.groundings > 0 {
            println!("  the glider touched the seabed {} times", a.groundings);
        }
    }
}
