//! `glidepolar simulate`: a time history by the equations of the FMU.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::history_page::History;
use super::mission::{self, Frame, MissionArguments};
use super::{Changes, CliError, Output, inputs, space, sweep, vehicle_input};
use crate::dynamics::Actuation;
use crate::log::{Dates, plain_table};
use crate::report::InputFile;
use crate::simulate::space::Origin;
use crate::simulate::{COLUMNS, Row, Schedule, SimulationSettings, fly};
use crate::spatial::Steering;
use crate::spatial::steering::with_gains;
use crate::vehicle::Vehicle;
use glidepolar_progress::one_more;

/// More rows than this are a slip of the keyboard.
const MAX_ROWS: f64 = 1e8;

/// End of a time history where nothing else is said [s].
const STOP_S: f64 = 1000.0;

/// Time between two rows where nothing else is said [s].
const INTERVAL_S: f64 = 1.0;

/// Time histories: the glider flown through given inputs, as the FMU flies
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar simulate slocum-graver --stop 1000 --csv history.csv\n  \
    glidepolar simulate my-glider.toml --inputs commands.csv --stop 3600 --interval 10 --csv history.csv\n  \
    glidepolar simulate slocum-049 --mission missions/rising-seabed.toml --out voyage/\n  \
    glidepolar simulate slocum-049 --3d --mission missions/lawn-mower.toml --out survey/\n  \
    glidepolar simulate slocum-graver --sweep variants.csv --stop 1000 --csv results.csv\n  \
    glidepolar simulate --mission-keys\n\n\
    A mission says how deep, at which pitch and with how much ballast, when to surface, and what seabed and water the\n\
    glider meets. Without mission and inputs the glider goes on in its steady glide. The table of inputs has a column\n\
    `time` and columns named as the FMU's inputs; FMPy takes the same file (`fmpy simulate ... --input-file`). A sweep's\n\
    table has columns named as the FMU's parameters and one row for each variant; --csv then has each one's last moment.")]
pub struct Arguments {
    /// Vehicle file or name of a built-in vehicle
    #[arg(required_unless_present = "mission_keys")]
    vehicle: Option<String>,
    #[command(flatten)]
    mission: MissionArguments,
    /// Fly in six degrees of freedom: the glider rolls, slips and turns; a mission may have waypoints
    #[arg(long = "3d")]
    space: bool,
    /// Who steers without a mission (--3d): commands, or heading_command_rad by rudder or roll mass
    #[arg(long, value_enum, default_value = "direct", requires = "space")]
    steering: Steers,
    /// Inputs against time (CSV)
    #[arg(long, value_name = "FILE")]
    inputs: Option<PathBuf>,
    /// Fly many variants at once: a table of parameters (CSV), a row for each
    #[arg(long, value_name = "FILE", conflicts_with_all = ["mission", "out", "space"])]
    sweep: Option<PathBuf>,
    /// Go on where the same sweep was interrupted: its finished rows stand in FILE.unfinished beside --csv FILE
    #[arg(long, requires = "sweep", requires = "csv")]
    resume: bool,
    #[command(flatten)]
    changes: Changes,
    /// End of the time history [s]; default 1000, of a mission its own
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    stop: Option<f64>,
    /// Time between two rows [s]; default 1, of a mission 10
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    interval: Option<f64>,
    /// Relative tolerance of the integration
    #[arg(long, default_value_t = crate::dynamics::integrate::DEFAULT_TOLERANCE, allow_negative_numbers = true)]
    tolerance: f64,
    /// Who moves ballast and moving mass: servos (set-points), raw forces, or raw along axis 1
    #[arg(long, value_enum, default_value = "servo")]
    actuation: Who,
    /// Write the time history to FILE
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Steers {
    Direct,
    Rudder,
    RollMass,
}

impl From<Steers> for Steering {
    fn from(steers: Steers) -> Self {
        match steers {
            Steers::Direct => Steering::Direct,
            Steers::Rudder => Steering::HeadingByRudder,
            Steers::RollMass => Steering::HeadingByRollMass,
        }
    }
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Who {
    Servo,
    Raw,
    RawAlongAxis1,
}

impl From<Who> for Actuation {
    fn from(who: Who) -> Self {
        match who {
            Who::Servo => Actuation::Servo,
            Who::Raw => Actuation::Raw,
            Who::RawAlongAxis1 => Actuation::RawAlongAxis1,
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    if arguments.mission.mission_keys {
        mission::print_keys();
        return Ok(());
    }
    let settings = settings(arguments)?;
    let files = arguments.inputs.iter().chain(&arguments.sweep).chain(&arguments.mission.mission);
    let inputs = inputs(files, arguments.vehicle.as_deref());
    arguments.output.begin(
        &inputs,
        &[
            ("--csv", arguments.csv.as_deref()),
            ("--log", arguments.mission.log.as_deref()),
            ("--fixes", arguments.mission.fixes.as_deref()),
            ("--out", arguments.mission.out.as_deref()),
        ],
    )?;
    let name = arguments.vehicle.as_deref().unwrap_or_default();
    if let Some(file) = &arguments.mission.mission {
        let frame = Frame {
            stop_s: arguments.stop,
            interval_s: arguments.interval,
            tolerance: settings.tolerance,
            csv: arguments.csv.as_deref(),
            output: &arguments.output,
        };
        let vehicle = arguments.changes.load(name)?;
        return match arguments.space {
            true => space::mission(&vehicle, file, &arguments.mission, &frame),
            false => mission::run(&vehicle, file, &arguments.mission, &frame),
        };
    }
    let vehicle = arguments.changes.load(name)?;
    if arguments.space {
        return in_space(arguments, &vehicle, &settings);
    }
    let parameters = vehicle.parameters()?;
    let schedule = match &arguments.inputs {
        None => Schedule::default(),
        Some(path) => {
            let text = plain_table(path, Dates::SinceFirst)?;
            Schedule::parse(&text, path)?
        }
    };
    if let Some(variants) = &arguments.sweep {
        let request = sweep::Request {
            vehicle: &vehicle.name,
            parameters: &parameters,
            file: variants,
            schedule: &schedule,
            settings: &settings,
            csv: arguments.csv.as_deref(),
            resumes: arguments.resume,
        };
        return sweep::run(&request, &arguments.output);
    }
    let mut table = arguments.csv.as_ref().map(|_| COLUMNS.join(",") + "\n");
    let mut summary = Summary::default();
    let mut history = arguments.mission.out.as_ref().map(|_| History::default());
    fly(&parameters, &schedule, &settings, |row| {
        one_more("rows");
        if let Some(table) = &mut table {
            push(table, row);
        }
        if let Some(history) = &mut history {
            history.add(row);
        }
        summary.add(row);
        true
    })
    .map_err(|error| CliError::Failed(error.to_string()))?;
    let table = arguments.csv.as_ref().zip(table);
    if let Some((path, table)) = &table {
        arguments.output.check(path, table.as_bytes())?;
    }
    if let (Some(out), Some(history)) = (&arguments.mission.out, history) {
        let mut page = history.page(&vehicle.name).input(vehicle_input(name)?);
        if let Some(inputs) = &arguments.inputs {
            page = page.input(InputFile::read(inputs)?);
        }
        page.write(arguments.output.folder(out)?)?;
    }
    if let Some((path, table)) = &table {
        arguments.output.write(path, table.as_bytes())?;
    }
    if arguments.output.shows_tables() {
        summary.print();
    }
    arguments.output.write_json(&summary)
}

fn in_space(arguments: &Arguments, vehicle: &Vehicle, settings: &SimulationSettings) -> Result<(), CliError> {
    if settings.actuation != Actuation::Servo {
        return Err(CliError::Usage("--3d knows servos only: leave --actuation out".to_owned()));
    }
    let body = with_gains(&vehicle.body()?);
    let in_space = crate::simulate::space::SpaceSettings {
        steering: arguments.steering.into(),
        stop_s: settings.stop_s,
        interval_s: settings.interval_s,
        tolerance: settings.tolerance,
        origin: Origin::default(),
    };
    let input = vehicle_input(arguments.vehicle.as_deref().unwrap_or_default())?;
    let places = (arguments.mission.out.as_deref(), input, &arguments.output);
    space::history(&vehicle.name, &body, arguments.inputs.as_deref(), &in_space, arguments.csv.as_deref(), places)
}

/// Largest relative tolerance: with more, a step may be as wrong as the motion is large.
const MOST_TOLERANCE: f64 = 0.1;

fn settings(arguments: &Arguments) -> Result<SimulationSettings, CliError> {
    let stop_s = arguments.stop.unwrap_or(STOP_S);
    let interval_s = arguments.interval.unwrap_or(INTERVAL_S);
    for (name, value) in [("--stop", stop_s), ("--interval", interval_s), ("--tolerance", arguments.tolerance)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(CliError::Usage(format!("{name} {value}: expected a number above zero")));
        }
    }
    if arguments.tolerance > MOST_TOLERANCE {
        return Err(CliError::Usage(format!(
            "--tolerance {}: expected at most {MOST_TOLERANCE}, an error of a tenth in each step",
            arguments.tolerance
        )));
    }
    if stop_s / interval_s > MAX_ROWS {
        return Err(CliError::Usage(format!("--stop {stop_s} with --interval {interval_s} makes too many rows")));
    }
    Ok(SimulationSettings { actuation: arguments.actuation.into(), stop_s, interval_s, tolerance: arguments.tolerance })
}

fn push(table: &mut String, row: &Row) {
    use std::fmt::Write;
    for (i, value) in row.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(table, "{}{value}", if i == 0 { "" } else { "," });
    }
    table.push('\n');
}

/// Where the flight went, as JSON gives it.
#[derive(Debug, Serialize)]
struct Summary {
    schema: &'static str,
    rows: u64,
    duration_s: f64,
    distance_m: f64,
    final_depth_m: f64,
    largest_depth_m: f64,
    mean_speed_m_s: f64,
    energy_J: f64,
}

impl Default for Summary {
    fn default() -> Self {
        Summary {
            schema: "glidepolar.simulate/1",
            rows: 0,
            duration_s: 0.0,
            distance_m: 0.0,
            final_depth_m: 0.0,
            largest_depth_m: f64::NEG_INFINITY,
            mean_speed_m_s: 0.0,
            energy_J: 0.0,
        }
    }
}

impl Summary {
    fn add(&mut self, row: &Row) {
        let column = |name: &str| COLUMNS.iter().position(|column| *column == name).map_or(f64::NAN, |i| row[i]);
        self.rows += 1;
        self.duration_s = column("time");
        self.distance_m = column("x_m");
        self.final_depth_m = column("depth_m");
        self.largest_depth_m = self.largest_depth_m.max(self.final_depth_m);
        self.mean_speed_m_s += (column("speed_m_s") - self.mean_speed_m_s) / self.rows as f64;
        self.energy_J = column("energy_J");
    }

    fn print(&self) {
        println!(
            "after {:.0} s: {:.1} m along, at {:.1} m depth",
            self.duration_s, self.distance_m, self.final_depth_m
        );
        println!(
            "largest depth {:.1} m, mean speed {:.3} m/s, energy {:.0} J",
            self.largest_depth_m, self.mean_speed_m_s, self.energy_J
        );
    }
}
