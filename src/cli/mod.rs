//! The command line `glidepolar`: one file a command, the habits they share here.
//!
//! Every command takes `--json FILE` (`-`: standard output, and nothing else there), `--out DIR` where it writes files,
//! and `--quiet`. Exit code 0: done; 1: the question has no answer (no such glide), or the result could not be written;
//! 2: the input cannot be used.
//! Standard output carries results, standard error messages. The library does the work; a command reads arguments,
//! calls it and shows what came back.

#![allow(rustdoc::broken_intra_doc_links, reason = "the arguments' documentation is their help: units in brackets")]

/// As the standard one, but an output that takes no more ends the program with a message and not with a panic. It stands
/// before the modules, so that it holds in all of them.
macro_rules! println {
    () => { glidepolar_terminal::print_line(format_args!("")) };
    ($($line:tt)*) => { glidepolar_terminal::print_line(format_args!($($line)*)) };
}

pub mod assemble;
pub mod compare;
pub mod demo;
pub mod diagnose;
mod diagnose_page;
mod diagnose_words;
mod export_fmu;
mod fmu;
pub mod glide;
mod glide_page;
mod history_page;
pub mod identify;
mod identify_figures;
mod identify_page;
mod identify_write;
mod log_vehicle;
mod mission;
mod mission_page;
pub mod plan;
mod plan_page;
mod plan_tables;
pub mod reading;
pub mod simulate;
mod space;
mod space_page;
mod sweep;
mod sweep_journal;
mod table;
pub mod track;
mod track_fixes;
mod track_log;
mod track_page;
pub mod turn;
mod turn_page;
pub mod vehicles;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, CommandFactory, Parser, Subcommand};

use crate::input::{InputError, Place, printable};
use crate::report::{Block, InputFile, Section};
use crate::simulate::mission::MissionError;
use crate::vehicle::Vehicle;

pub use glidepolar_terminal::{CliError, Output, begin, on_terminal, own_places, print_line, shell, show, warn};

/// An underwater glider from the towing tank to the sea and back.
#[derive(Debug, Parser)]
#[command(name = "glidepolar", version, propagate_version = true, max_term_width = 110)]
#[command(after_help = "VEHICLE is a vehicle file (TOML) or the name of a built-in vehicle: `glidepolar vehicles`.\n\
    Exit code: 0 done, 1 no answer or it could not be written, 2 the input cannot be used.")]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Glide(glide::Arguments),
    Compare(compare::Arguments),
    Simulate(simulate::Arguments),
    Identify(identify::Arguments),
    Diagnose(diagnose::Arguments),
    Track(track::Arguments),
    Turn(turn::Arguments),
    Plan(plan::Arguments),
    Assemble(assemble::Arguments),
    Vehicles(vehicles::Arguments),
    ExportFmu(export_fmu::Arguments),
    Fmu(fmu::Arguments),
    Demo(demo::Arguments),
    Completions(shell::CompletionsArguments),
    Man(shell::ManArguments),
}

/// Values that are not the vehicle's own, for this run.
#[derive(Debug, Clone, Default, Args)]
pub struct Changes {
    /// Change a value of the vehicle for this run (repeat): hydro.b=0.14; keys: `glidepolar vehicles --keys`
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
}

impl Changes {
    /// Reads a vehicle file or takes a built-in vehicle, and changes what was asked for, as if the file said so.
    ///
    /// # Errors
    /// Where the vehicle cannot be read, a key is unknown or a value is out of bounds.
    pub fn load(&self, name_or_file: &str) -> Result<Vehicle, CliError> {
        let vehicle = Vehicle::load(name_or_file)?;
        if self.set.is_empty() {
            return Ok(vehicle);
        }
        let mut changed = vehicle.clone();
        for change in &self.set {
            let pair = change.split_once('=').map(|(key, value)| (key.trim(), value.trim().parse::<f64>()));
            let Some((key, Ok(value))) = pair else {
                return Err(CliError::Usage(format!("--set {}: expected KEY=NUMBER", printable(change))));
            };
            changed.set(key, value).map_err(|error| InputError { place: Place::file("--set"), ..error })?;
        }
        // Read again, so that the same bounds hold for a value as in a file.
        let mut changed = Vehicle::parse(&changed.to_toml(), format!("{name_or_file} with --set"))?;
        changed.is_builtin = vehicle.is_builtin;
        Ok(changed)
    }
}

/// The density that was asked for.
///
/// # Errors
/// Where it is none of water.
pub fn water_density(density_kg_m3: Option<f64>) -> Result<Option<f64>, CliError> {
    match density_kg_m3.filter(|density| !(900.0..=1300.0).contains(density)) {
        Some(density) => {
            Err(CliError::Usage(format!("--density {density} is no density of water: expected 900 to 1300 kg/m3")))
        }
        None => Ok(density_kg_m3),
    }
}

/// The files that a command reads: those named, and the vehicle's where it is no built-in one.
fn inputs<'a>(files: impl IntoIterator<Item = &'a PathBuf>, vehicle: Option<&'a str>) -> Vec<&'a Path> {
    let is_file = |name: &&str| *name != log_vehicle::FROM_FILE && crate::vehicle::builtin::text(name).is_none();
    files.into_iter().map(PathBuf::as_path).chain(vehicle.filter(is_file).map(Path::new)).collect()
}

/// A vehicle as a report lists it among what was read.
///
/// # Errors
/// Where the vehicle file cannot be read.
pub fn vehicle_input(name_or_file: &str) -> Result<InputFile, CliError> {
    let name_or_file = if name_or_file == log_vehicle::FROM_FILE { "seaglider" } else { name_or_file };
    match crate::vehicle::builtin::text(name_or_file) {
        Some(text) => Ok(InputFile::new(format!("built-in vehicle {name_or_file}"), text.as_bytes())),
        None => Ok(InputFile::read(name_or_file)?),
    }
}

/// What was found in the reading of a log and done about it, folded away below the answers; nothing where there is nothing.
pub fn housekeeping(notes: &[String]) -> Option<Section> {
    let block = Block::List(notes.to_vec());
    (!notes.is_empty()).then(|| Section::new("Reading of the log").folded().block(block))
}

/// Prints the same below the tables.
pub fn print_notes(notes: &[String]) {
    notes.iter().for_each(|note| println!("note: {note}"));
}

/// Reads the arguments of this process, does what they ask and says what went wrong.
pub fn main() -> ExitCode {
    begin();
    let cli = Cli::parse();
    match on_terminal(|| run(cli)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            show(&error);
            error.exit_code()
        }
    }
}

/// Does what was asked.
///
/// # Errors
/// Where the input cannot be used, the question has no answer, or the results cannot be written.
pub fn run(cli: Cli) -> Result<(), CliError> {
    match cli.command {
        Command::Assemble(arguments) => assemble::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Completions(arguments) => arguments.run(Cli::command()),
        Command::Demo(arguments) => demo::run(&arguments),
        Command::Diagnose(arguments) => diagnose::run(&arguments),
        Command::ExportFmu(arguments) => export_fmu::run(&arguments),
        Command::Fmu(arguments) => fmu::run(&arguments),
        Command::Glide(arguments) => glide::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Identify(arguments) => identify::run(&arguments),
        Command::Man(arguments) => arguments.run(Cli::command()),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Track(arguments) => track::run(&arguments),
        Command::Turn(arguments) => turn::run(&arguments),
        Command::Vehicles(arguments) => vehicles::run(&arguments),
    }
}

impl From<MissionError> for CliError {
    fn from(error: MissionError) -> Self {
        CliError::Failed(error.to_string())
    }
}

#[cfg(test)]
mod tests;
