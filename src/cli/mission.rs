//! `glidepolar simulate --mission`: a mission flown, its legs, its log.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
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

pub(super) fn run(
    vehicle: &Vehicle,
    file: &Path,
    arguments: &MissionArguments,
    frame: &Frame<'_>,
) -> Result<(), CliError> {
    let parameters = vehicle.parameters()?;
    let mut mission = Mission::load(file)?;
    mission.duration_s = mission.duration_s.min(frame.stop_s.unwrap_or(f64::INFINITY));
    let mut tables = Tables::begin(frame.csv.is_some(), arguments.log.is_some());
    let mut trace = Trace::new();
    let interval_s = frame.interval_s.unwrap_or(INTERVAL_S);
    let flight = fly_mission(&parameters, &mission, interval_s, frame.tolerance, |moment| {
        tables.add(moment);
        if arguments.out.is_some() {
            trace.add(moment);
        }
        true
    })?;
    let tables = [frame.csv.zip(tables.history), arguments.log.as_deref().zip(tables.log)];
    for (path, table) in tables.iter().flatten() {
        frame.output.check(path, table.as_bytes())?;
    }
    if let Some(folder) = &arguments.out {
        let mut folder = frame.output.folder(folder)?;
        folder.add("legs.csv", legs_table(&flight.legs))?;
        let input = InputFile::read(file)?;
        mission_page::page(&vehicle.name, &mission, &flight, &trace, input).write(folder)?;
    }
    for (path, table) in tables.iter().flatten() {
        frame.output.write(path, table.as_bytes())?;
    }
    let report = Report::new(vehicle, &mission, &flight);
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

/// The tables that are filled while the mission is flown.
struct Tables {
    history: Option<String>,
    log: Option<String>,
    dive: u64,
    before: LegKind,
}

const LOG_COLUMNS: &str = "time_s,dive,pressure_dbar,depth_m,pitch_rad,vbd_cc,battpos_m,density_kg_m3,temperature_C";

impl Tables {
    fn begin(history: bool, log: bool) -> Self {
        Tables {
            history: history.then(|| format!("{},{},leg\n", COLUMNS.join(","), MISSION_COLUMNS.join(","))),
            log: log.then(|| {
                format!("# simulated by glidepolar; pitch and pressure as the glider reads them\n{LOG_COLUMNS}\n")
            }),
            dive: 0,
            before: LegKind::Surface,
        }
    }

    fn add(&mut self, moment: &Moment) {
        self.dive += u64::from(self.before == LegKind::Surface && moment.leg == LegKind::Descent);
        self.before = moment.leg;
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
                "{time:.3},{},{pressure:.4},{depth:.4},{pitch:.6},{:.3},{battery:.6},{density:.5},{temperature:.4}",
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
struct Report<'a> {
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
    pump_Wh: f64,
    hotel_Wh: f64,
    legs: &'a [Leg],
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
    values.sort_by(f64::total_cmp);
    let n = values.len();
    (n > 0).then(|| 0.5 * (values[(n - 1) / 2] + values[n / 2]))
}

impl<'a> Report<'a> {
    fn new(vehicle: &'a Vehicle, mission: &'a Mission, flight: &'a Flight) -> Self {
        let by = |turn: Turn| flight.legs.iter().filter(move |leg| leg.ended_by == turn).count();
        let mut turns = flight.legs.iter().filter(|leg| matches!(leg.ended_by, Turn::MaxDepth | Turn::Altimeter));
        let first = turns.next();
        Report {
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
            pump_Wh: flight.pump_J / 3600.0,
            hotel_Wh: flight.hotel_J / 3600.0,
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
            "  {:>4} pumpings, {} moves of the moving mass; pump {:.2} Wh, hotel {:.2} Wh",
            self.pumpings, self.pitch_moves, self.pump_Wh, self.hotel_Wh
        );
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
