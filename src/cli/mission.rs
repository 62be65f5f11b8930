//! `glidepolar simulate --mission`: a mission flown, its legs, its log.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use glidepolar_inference::order::central_value;
use serde::Serialize;

use super::mission_page::{self, Trace};
use super::{CliError, Output};
use crate::report::InputFile;
use crate::simulate::COLUMNS;
use crate::simulate::mission::{
    Ending, Flight, KEYS, Leg, LegKind, MISSION_COLUMNS, Mission, Moment, Turn, fly_mission,
};
use crate::vehicle::Vehicle;

/// Time between two rows where nothing else is said [s].
const INTERVAL_S: f64 = 10.0;

/// Options of a mission.
#[derive(Debug, Args)]
pub(super) struct MissionArguments {
    /// Fly a mission: depths, pitch, ballast, surfacings, seabed, water (TOML)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["inputs", "actuation"])]
    pub mission: Option<PathBuf>,
    /// List every key of a mission file
    #[arg(long)]
    pub mission_keys: bool,
    /// Write the mission as the glider's own flight log to FILE (CSV)
    #[arg(long, value_name = "FILE", requires = "mission")]
    pub log: Option<PathBuf>,
    /// Write a fix at the start and the end of each stay at the surface to FILE (CSV), the course due north from 0 N 0 E
    #[arg(long, value_name = "FILE", requires = "mission")]
    pub fixes: Option<PathBuf>,
    /// Write report.html and its figures to DIR, of a mission its table of legs, too
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
}

/// Further options of `simulate`.
pub(super) struct Frame<'a> {
    pub stop_s: Option<f64>,
    pub interval_s: Option<f64>,
    pub tolerance: f64,
    pub csv: Option<&'a Path>,
    pub output: &'a Output,
}

impl Frame<'_> {
    /// Writes the tables of a flown mission (time history, log, fixes) and, where a folder is given, its page: none of
    /// them where one of the tables may not be written.
    pub fn write(
        &self,
        arguments: &MissionArguments,
        [history, log, fixes]: [Option<String>; 3],
        page: impl FnOnce(&Path) -> Result<(), CliError>,
    ) -> Result<(), CliError> {
        let tables = [self.csv.zip(history), arguments.log.as_deref().zip(log), arguments.fixes.as_deref().zip(fixes)];
        for (path, table) in tables.iter().flatten() {
            self.output.check(path, table.as_bytes())?;
        }
        arguments.out.as_deref().map_or(Ok(()), page)?;
        for (path, table) in tables.iter().flatten() {
            self.output.write(path, table.as_bytes())?;
        }
        Ok(())
    }
}

pub(super) fn run(
    vehicle: &Vehicle,
    file: &Path,
    arguments: &MissionArguments,
    frame: &Frame<'_>,
) -> Result<(), CliError> {
    let parameters = vehicle.parameters()?;
    let mut mission = Mission::load(file)?;
    mission.duration_s = mission.duration_s.min(frame.stop_s.unwrap_or(f64::INFINITY));
    let mut tables = Tables::begin(frame.csv.is_some(), arguments.log.is_some(), arguments.fixes.is_some());
    let mut trace = Trace::new();
    let interval_s = frame.interval_s.unwrap_or(INTERVAL_S);
    let flight = fly_mission(&parameters, &mission, interval_s, frame.tolerance, |moment| {
        tables.add(moment);
        if arguments.out.is_some() {
            trace.add(moment);
        }
        true
    })?;
    tables.last_fix();
    frame.write(arguments, [tables.history, tables.log, tables.fixes], |folder| {
        let mut folder = frame.output.folder(folder)?;
        folder.add("legs.csv", legs_table(&flight.legs))?;
        let input = InputFile::read(file)?;
        Ok(mission_page::page(&vehicle.name, &mission, &flight, &trace, input).write(folder)?)
    })?;
    let report = MissionReport::new(vehicle, &mission, &flight);
    if frame.output.shows_tables() {
        report.print();
    }
    frame.output.write_json(&report)
}

pub(super) fn print_keys() {
    for key in KEYS {
        let need = match key.default {
            _ if key.needed => ", needed".to_owned(),
            Some(value) => format!(", default {value}"),
            None => String::new(),
        };
        let list = if key.list { ", a number or a list" } else { "" };
        println!("{:<26} [{}]  {}{list}{need}", key.path, key.unit, key.meaning);
    }
}

/// Radius of curvature of the meridian at the equator, WGS 84 \[m\]: within 1e-4 over 100 km of it.
const MERIDIAN_RADIUS_M: f64 = 6_335_439.327;

/// The column of the way over ground in a row of the time history.
const X: usize = 2;

/// The tables that are filled while the mission is flown.
struct Tables {
    history: Option<String>,
    log: Option<String>,
    fixes: Option<String>,
    dive: u64,
    before: LegKind,
    /// Time and way of the moment before \[s, m\].
    last: Option<(f64, f64)>,
}

const LOG_COLUMNS: &str =
    "time_s,dive,pressure_dbar,depth_m,pitch_rad,heading_rad,vbd_cc,battpos_m,density_kg_m3,temperature_C";

impl Tables {
    fn begin(history: bool, log: bool, fixes: bool) -> Self {
        Tables {
            history: history.then(|| format!("{},{},leg\n", COLUMNS.join(","), MISSION_COLUMNS.join(","))),
            log: log.then(|| {
                format!("# simulated by glidepolar; pitch and pressure as the glider reads them\n{LOG_COLUMNS}\n")
            }),
            fixes: fixes.then(|| "# simulated by glidepolar\ntime_s,lat_deg,lon_deg\n".to_owned()),
            dive: 0,
            before: LegKind::Surface,
            last: None,
        }
    }

    /// A fix at the moment before, due north of 0 N 0 E.
    fn last_fix(&mut self) {
        if let (Some(fixes), Some((time_s, x_m))) =
            (&mut self.fixes, self.last.filter(|_| self.before == LegKind::Surface))
        {
            let _ = writeln!(fixes, "{time_s:.1},{:.7},0", (x_m / MERIDIAN_RADIUS_M).to_degrees());
        }
    }

    fn add(&mut self, moment: &Moment) {
        self.dive += u64::from(self.before == LegKind::Surface && moment.leg == LegKind::Descent);
        // Where the glider comes up, and where it leaves.
        if moment.leg != LegKind::Surface {
            self.last_fix();
        }
        let came_up = self.before != LegKind::Surface && moment.leg == LegKind::Surface;
        self.before = moment.leg;
        self.last = Some((moment.row[0], moment.row[X]));
        if came_up {
            self.last_fix();
        }
        // Writing to a string cannot fail.
        if let Some(history) = &mut self.history {
            for value in moment.row.iter().chain(&moment.around) {
                let _ = write!(history, "{value},");
            }
            history.push_str(leg_name(moment.leg));
            history.push('\n');
        }
        if let Some(log) = &mut self.log {
            let [ballast_m3, density, temperature, _, _, pitch, pressure] = moment.around;
            let (time, depth, battery) = (moment.row[0], moment.row[1], moment.row[13]);
            let _ = writeln!(
                log,
                "{time:.3},{},{pressure:.4},{depth:.4},{pitch:.6},0,{:.3},{battery:.6},{density:.5},{temperature:.4}",
                self.dive,
                ballast_m3 * 1e6
            );
        }
    }
}

fn leg_name(leg: LegKind) -> &'static str {
    match leg {
        LegKind::Descent => "descent",
        LegKind::Ascent => "ascent",
        LegKind::Surface => "surface",
    }
}

fn turn_name(turn: Turn) -> &'static str {
    match turn {
        Turn::MaxDepth => "max_depth",
        Turn::Altimeter => "altimeter",
        Turn::ClimbTo => "climb_to",
        Turn::SurfacingDue => "surfacing_due",
        Turn::Surfaced => "surfaced",
        Turn::StayOver => "stay_over",
        Turn::MissionEnd => "mission_end",
    }
}

fn legs_table(legs: &[Leg]) -> String {
    let mut table =
        "leg,start_s,end_s,start_depth_m,end_depth_m,start_x_m,end_x_m,inflection_depth_m,seabed_depth_m,ended_by\n"
            .to_owned();
    for leg in legs {
        let inflection = leg.inflection_depth_m.map(|depth| format!("{depth:.3}")).unwrap_or_default();
        let _ = writeln!(
            table,
            "{},{:.3},{:.3},{:.3},{:.3},{:.2},{:.2},{inflection},{:.2},{}",
            leg_name(leg.kind),
            leg.start_s,
            leg.end_s,
            leg.start_depth_m,
            leg.end_depth_m,
            leg.start_x_m,
            leg.end_x_m,
            leg.seabed_depth_m,
            turn_name(leg.ended_by)
        );
    }
    table
}

/// The mission as JSON gives it.
#[derive(Debug, Serialize)]
struct MissionReport<'a> {
    schema: &'static str,
    vehicle: &'a str,
    mission: &'a str,
    ended_by: Ending,
    duration_h: f64,
    distance_km: f64,
    mean_speed_over_ground_m_s: f64,
    descents: Legs,
    ascents: Legs,
    surfacings: usize,
    turns_by_altimeter: usize,
    turns_by_max_depth: usize,
    first_turn_m: Option<f64>,
    last_turn_m: Option<f64>,
    pumpings: u64,
    pitch_moves: u64,
    groundings: u64,
    #[serde(flatten)]
    figures: EnergyFigures,
    pump_Wh: f64,
    steering_Wh: f64,
    surfacing_Wh: f64,
    hotel_Wh: f64,
    legs: &'a [Leg],
}

/// Whether the vehicle has what pump and hotel draw; else their energies are nothing for want of figures.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct EnergyFigures {
    has_pump_figures: bool,
    has_hotel_figures: bool,
}

impl EnergyFigures {
    /// Those of a vehicle.
    pub(super) fn of(vehicle: &Vehicle) -> EnergyFigures {
        let has = |key: &str| vehicle.get(key).is_some_and(|value| value > 0.0);
        EnergyFigures {
            has_pump_figures: ["energy.pump_J_per_cc", "energy.pump_J_per_dbar_cc"].iter().any(|key| has(key)),
            has_hotel_figures: has("energy.hotel_W"),
        }
    }

    /// What the pump drew, in words.
    pub(super) fn pump(self, energy_Wh: f64) -> String {
        in_words(self.has_pump_figures, energy_Wh)
    }

    /// What the hotel drew, in words.
    pub(super) fn hotel(self, energy_Wh: f64) -> String {
        in_words(self.has_hotel_figures, energy_Wh)
    }
}

fn in_words(is_known: bool, energy_Wh: f64) -> String {
    if is_known { format!("{energy_Wh:.2} Wh") } else { "not known: the vehicle has no figures of it".to_owned() }
}

/// The complete legs of one kind: from turn to turn.
#[derive(Debug, Serialize)]
struct Legs {
    number: usize,
    median_duration_min: Option<f64>,
    median_horizontal_speed_m_s: Option<f64>,
    median_vertical_speed_m_s: Option<f64>,
}

impl Legs {
    fn new(legs: &[Leg], kind: LegKind) -> Self {
        let whole: Vec<&Leg> = legs.iter().filter(|leg| leg.kind == kind && leg.ended_by != Turn::MissionEnd).collect();
        let middle = |of: fn(&Leg) -> f64| median(whole.iter().map(|leg| of(leg)));
        Legs {
            number: whole.len(),
            median_duration_min: middle(|leg| (leg.end_s - leg.start_s) / 60.0),
            median_horizontal_speed_m_s: middle(|leg| (leg.end_x_m - leg.start_x_m) / (leg.end_s - leg.start_s)),
            median_vertical_speed_m_s: middle(|leg| {
                (leg.end_depth_m - leg.start_depth_m).abs() / (leg.end_s - leg.start_s)
            }),
        }
    }

    fn print(&self, name: &str) {
        let or_dash =
            |value: Option<f64>, decimals: usize| value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"));
        println!(
            "  {:>4} {name:<9} median {:>6} min, {:>6} m/s along, {:>6} m/s {}",
            self.number,
            or_dash(self.median_duration_min, 1),
            or_dash(self.median_horizontal_speed_m_s, 3),
            or_dash(self.median_vertical_speed_m_s, 3),
            if name.starts_with('d') { "down" } else { "up" }
        );
    }
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    (!values.is_empty()).then(|| central_value(&mut values))
}

impl<'a> MissionReport<'a> {
    fn new(vehicle: &'a Vehicle, mission: &'a Mission, flight: &'a Flight) -> Self {
        let by = |turn: Turn| flight.legs.iter().filter(move |leg| leg.ended_by == turn).count();
        let mut turns = flight.legs.iter().filter(|leg| matches!(leg.ended_by, Turn::MaxDepth | Turn::Altimeter));
        let first = turns.next();
        MissionReport {
            schema: "glidepolar.mission/1",
            vehicle: &vehicle.name,
            mission: &mission.name,
            ended_by: flight.ending,
            duration_h: flight.duration_s / 3600.0,
            distance_km: flight.distance_m / 1e3,
            mean_speed_over_ground_m_s: flight.distance_m / flight.duration_s,
            descents: Legs::new(&flight.legs, LegKind::Descent),
            ascents: Legs::new(&flight.legs, LegKind::Ascent),
            surfacings: by(Turn::Surfaced),
            turns_by_altimeter: by(Turn::Altimeter),
            turns_by_max_depth: by(Turn::MaxDepth),
            first_turn_m: first.map(|leg| leg.end_depth_m),
            last_turn_m: turns.next_back().or(first).map(|leg| leg.end_depth_m),
            pumpings: flight.pumpings,
            pitch_moves: flight.pitch_moves,
            groundings: flight.groundings,
            figures: EnergyFigures::of(vehicle),
            pump_Wh: flight.energy.pump_J / 3600.0,
            steering_Wh: flight.energy.steering_J / 3600.0,
            surfacing_Wh: flight.energy.surfacing_J / 3600.0,
            hotel_Wh: flight.energy.hotel_J / 3600.0,
            legs: &flight.legs,
        }
    }

    fn print(&self) {
        println!(
            "{}, {}: {:.2} h, {:.2} km over ground, {:.3} m/s on the mean",
            self.vehicle, self.mission, self.duration_h, self.distance_km, self.mean_speed_over_ground_m_s
        );
        self.descents.print("descents");
        self.ascents.print("ascents");
        println!(
            "  {:>4} turns by the altimeter, {} at the largest depth; {} surfacings",
            self.turns_by_altimeter, self.turns_by_max_depth, self.surfacings
        );
        if let (Some(first), Some(last)) = (self.first_turn_m, self.last_turn_m) {
            println!("       first turn at {first:.1} m, last at {last:.1} m");
        }
        println!(
            "  {:>4} pumpings, {} moves of the moving mass; pump {}, hotel {}",
            self.pumpings,
            self.pitch_moves,
            self.figures.pump(self.pump_Wh),
            self.figures.hotel(self.hotel_Wh)
        );
        if self.steering_Wh + self.surfacing_Wh > 0.0 {
            println!("       steering {:.2} Wh, surfacings {:.2} Wh", self.steering_Wh, self.surfacing_Wh);
        }
        match self.ended_by {
            Ending::TooShallow => println!("  ended early: the water is too shallow to dive"),
            Ending::Distance => println!("  ended with its way done"),
            Ending::Duration | Ending::Stopped => {}
        }
        if self.groundings > 0 {
            println!("  the glider touched the seabed {} times", self.groundings);
        }
    }
}
