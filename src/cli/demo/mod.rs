//! `glidepolar demo`: one pass from the tank to the FMU on synthetic data with known truth, with a page that shows what came of
//! each step and how to repeat it.
//!
//! A hull test with something wrong in it, reduced and diagnosed; a flight log with a fault that its vehicle file does not
//! know, diagnosed; the extended vehicle as an FMU, which flies a dive that the diagnosis has not read. Every step is a command
//! of this package, run as one would type it in the demonstration's folder.

mod flight;
mod page;
mod programs;

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use glidepolar_virtual_sea::vehicle::Hull;
use glidepolar_virtual_sea::{Options, Sea, catalogue, generate};
use serde::Serialize;
use serde_json::Value;

use super::{CliError, Output};
use crate::input::{InputError, Place};
use crate::output::OutputFolder;
use crate::vehicle::Vehicle;
use flight::{Dive, Flight, Misfit};
use glidepolar_progress::step;
use programs::{Programs, fmpy};

/// From the towing tank to the FMU on synthetic data with known truth: a folder with a page, in seconds
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar demo              writes glidepolar-demo/report.html\n  \
    glidepolar demo shown -q     the same into another folder, without a word\n\n\
    The FMU is flown by FMPy where Python has it (pip install fmpy); else its equations are flown without it.")]
pub struct Arguments {
    /// Folder to write: new, empty, or an earlier demonstration (which is replaced)
    #[arg(default_value = "glidepolar-demo", value_name = "DIR")]
    folder: PathBuf,
    /// Packed FMU to take the library from; else it is looked for as by `export-fmu`
    #[arg(long, value_name = "FMU")]
    template: Option<PathBuf>,
    /// Python that has FMPy; default: the one beside this program, then python3
    #[arg(long, value_name = "PROGRAM")]
    python: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
}

/// What the tank hides, and in which hull.
const TANK_EFFECT: (&str, f64) = ("yaw_misalignment", 0.5);
const HULL: &str = "LDR8.5";

/// The fault in the flight, as the virtual sea names it: a pocket of air in the hull. It does not depend on the time, so that an
/// FMU may fly any dive of the log from time 0 on.
const FLIGHT_EFFECT: &str = "trapped_air=110";
const SEED: u64 = 5;

/// The flight: short enough for a demonstration, long enough for a diagnosis.
const HOURS: f64 = 8.0;
const DIVES: u32 = 10;

/// Steps, for whoever waits.
const STEPS: usize = 6;

/// The file that says that a folder is a demonstration's.
const MARK: &str = ".glidepolar-demo";

/// Communication step of FMPy \[s\]. It holds the inputs over a step, which delays them by half of it.
const FMPY_INTERVAL_S: f64 = 0.25;

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let effects = catalogue::parse_requests(FLIGHT_EFFECT).map_err(|error| CliError::Failed(error.to_string()))?;
    let folder = &arguments.folder;
    take(folder, arguments.output.force)?;
    let mut programs = Programs::of(folder)?;

    step("steps of the demonstration", 0, STEPS);
    let (effect, degrees) = TANK_EFFECT;
    programs.run("tank-reduce", &["demo", "pmm_runs", "--hull", HULL, "--effect", &format!("{effect}={degrees}")])?;
    programs.run("tank-reduce", &["pmm_runs", "--diagnose", "--out", "tank", "--json", "tank.json"])?;
    let tank = read_json(&folder.join("tank.json"))?;

    step("steps of the demonstration", 1, STEPS);
    let sea = generate(&Options {
        effects,
        hours: HOURS,
        dives: DIVES,
        hull: Some(Hull::Slocum200),
        ..Options::seeded(SEED)
    });
    let held_out = sea.log.dive.iter().copied().max().unwrap_or(0).saturating_sub(1);
    write_flight(folder, &sea, held_out)?;

    step("steps of the demonstration", 2, STEPS);
    let diagnose = ["diagnose", "flight/log.csv", "--vehicle", "flight/vehicle.toml", "--extended", "extended.toml"];
    let results = ["--out", "diagnosis", "--json", "diagnosis.json", "--force"];
    programs.run("glidepolar", &[&diagnose[..], &results[..]].concat())?;
    let diagnosis = read_json(&folder.join("diagnosis.json"))?;

    step("steps of the demonstration", 3, STEPS);
    let template = arguments.template.as_ref().map(|file| std::path::absolute(file).unwrap_or_else(|_| file.clone()));
    let template = template.map(|file| file.to_string_lossy().into_owned());
    let mut pack = vec!["export-fmu", "extended.toml", "-o", "Extended.fmu"];
    pack.extend(template.iter().flat_map(|file| ["--template", file]));
    programs.run("glidepolar", &pack)?;
    let load = |name: &str| Ok::<_, CliError>(Vehicle::load(&folder.join(name).to_string_lossy())?);
    let (believed, extended) = (load("flight/vehicle.toml")?, load("extended.toml")?);
    let dive = Dive::of(&sea.log, held_out, believed.glide_parameters().gravity_m_s2);
    if dive.time_s.len() < 20 {
        return Err(CliError::Failed("the flight has no dive that could be held out".to_owned()));
    }
    let (before, mut after) = (Flight::of(&believed, &dive)?, Flight::of(&extended, &dive)?);
    write(folder, "flight/held-out-inputs.csv", &after.inputs)?;

    step("steps of the demonstration", 4, STEPS);
    let fmpy = fmpy(arguments.python.as_deref());
    if let Some(python) = &fmpy {
        after = fly_fmu(&mut programs, python, folder, &dive)?;
    }

    step("steps of the demonstration", 5, STEPS);
    let result = Demonstration {
        schema: "glidepolar.demo/1",
        tank: &tank["hulls"][0]["diagnosis"]["causes"],
        tank_hidden: Hidden { parameter: effect.to_owned(), value: degrees },
        verdict: &diagnosis["verdict"],
        causes: &diagnosis["causes"],
        hidden: hidden(&sea),
        held_out_dive: held_out,
        before: Misfit::of(&dive, &before.time_s, &before.depth_m),
        after: Misfit::of(&dive, &after.time_s, &after.depth_m),
        flown_by_fmpy: fmpy.is_some(),
    };
    let shown = page::Shown {
        result: &result,
        tank: &tank,
        tank_truth: tank_truth(&folder.join("pmm_runs/truth.toml")),
        diagnosis: &diagnosis,
        dive: &dive,
        before: &before,
        after: &after,
        commands: programs.commands(),
    };
    page::of(&shown).write(OutputFolder::open(folder, true)?)?;
    if arguments.output.shows_tables() {
        for finding in page::findings(&shown) {
            println!("{finding}");
        }
        println!("The page: {}", folder.join("report.html").display());
    }
    arguments.output.write_json(&result)
}

/// What came out of it, as JSON gives it.
#[derive(Debug, Serialize)]
struct Demonstration<'a> {
    schema: &'static str,
    /// Causes that the diagnosis of the hull test names.
    tank: &'a Value,
    tank_hidden: Hidden,
    verdict: &'a Value,
    /// Causes that the diagnosis of the flight names.
    causes: &'a Value,
    /// What the flight hides.
    hidden: Vec<Hidden>,
    held_out_dive: u32,
    /// How far the vehicle of the file is from the held-out dive.
    before: Misfit,
    /// The same of the extended vehicle.
    after: Misfit,
    flown_by_fmpy: bool,
}

/// A hidden effect's size, in the unit that its name has.
#[derive(Debug, Serialize)]
struct Hidden {
    parameter: String,
    value: f64,
}

fn hidden(sea: &Sea) -> Vec<Hidden> {
    let parameters = sea.truth.effects.iter().flat_map(|effect| &effect.parameters);
    parameters.map(|(parameter, value)| Hidden { parameter: (*parameter).to_owned(), value: *value }).collect()
}

/// Makes the folder, where it is new, empty or an earlier demonstration's.
fn take(folder: &Path, force: bool) -> Result<(), CliError> {
    let is_empty = fs::read_dir(folder).map_or(true, |mut entries| entries.next().is_none());
    if !(is_empty || force || folder.join(MARK).is_file()) {
        let error = InputError::new(Place::file(folder), "is not empty, and no earlier demonstration");
        return Err(error.help("name another folder, or replace what has the same names with --force").into());
    }
    for below in ["", "flight"] {
        let place = folder.join(below);
        fs::create_dir_all(&place).map_err(|error| unwritten(&place, &error))?;
    }
    write(folder, MARK, "")
}

/// The log without the held-out dive and what came after it, the dive itself, the vehicle that its owner believes in, the truth.
fn write_flight(folder: &Path, sea: &Sea, held_out: u32) -> Result<(), CliError> {
    let csv = sea.log.to_csv();
    let (header, rows) = csv.split_once('\n').unwrap_or_default();
    let part = |of: &dyn Fn(u32) -> bool| {
        let rows = rows.lines().zip(&sea.log.dive).filter(|(_, dive)| of(**dive)).map(|(row, _)| row);
        std::iter::once(header).chain(rows).fold(String::new(), |table, row| table + row + "\n")
    };
    write(folder, "flight/log.csv", &part(&|dive| dive < held_out))?;
    write(folder, "flight/held-out.csv", &part(&|dive| dive == held_out))?;
    write(folder, "flight/vehicle.toml", &sea.vehicle_toml)?;
    write(folder, "flight/truth.json", &format!("{:#}\n", sea.truth.to_json()))
}

/// Flies the held-out dive by the FMU in FMPy.
fn fly_fmu(programs: &mut Programs, python: &Path, folder: &Path, dive: &Dive) -> Result<Flight, CliError> {
    let (stop, interval, depth) = (dive.end_s().to_string(), FMPY_INTERVAL_S.to_string(), dive.depth_m[0].to_string());
    let words = ["-m", "fmpy", "simulate", "Extended.fmu", "--input-file", "flight/held-out-inputs.csv"];
    let times = ["--stop-time", &stop, "--output-interval", &interval, "--relative-tolerance", "1e-8"];
    let rest = ["--start-values", "depth_m", &depth, "--output-file", "flight/held-out-flown.csv"];
    programs.run(&python.to_string_lossy(), &[&words[..], &times[..], &rest[..]].concat())?;
    let file = folder.join("flight/held-out-flown.csv");
    let text = fs::read_to_string(&file).map_err(|error| InputError::io(&file, &error))?;
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').map(|name| name.trim_matches('"')).collect();
    let column = |name: &str| names.iter().position(|known| *known == name);
    let (Some(time), Some(depth)) = (column("time"), column("depth_m")) else {
        return Err(InputError::new(Place::file(&file), "FMPy wrote no columns time and depth_m").into());
    };
    let cell = |line: &str, column: usize| line.split(',').nth(column).and_then(|cell| cell.trim().parse::<f64>().ok());
    let (time_s, depth_m) = lines.filter_map(|line| Some((cell(line, time)?, cell(line, depth)?))).unzip();
    Ok(Flight { inputs: String::new(), time_s, depth_m })
}

/// The true coefficients a, b, c, d of the first hull; nothing where the file does not say them.
fn tank_truth(file: &Path) -> Option<[f64; 4]> {
    let document: toml_edit::DocumentMut = fs::read_to_string(file).ok()?.parse().ok()?;
    let hull = document.get("hull")?.as_array_of_tables()?.get(0)?;
    let value = |name: &str| hull.get(name)?.as_float();
    Some([value("a")?, value("b")?, value("c")?, value("d")?])
}

fn read_json(file: &Path) -> Result<Value, CliError> {
    let text = fs::read_to_string(file).map_err(|error| InputError::io(file, &error))?;
    serde_json::from_str(&text).map_err(|error| CliError::Failed(format!("{}: {error}", file.display())))
}

fn write(folder: &Path, name: &str, text: &str) -> Result<(), CliError> {
    let file = folder.join(name);
    fs::write(&file, text).map_err(|error| unwritten(&file, &error))
}

fn unwritten(file: &Path, error: &std::io::Error) -> CliError {
    CliError::Failed(format!("{}: cannot be written: {error}", file.display()))
}
