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
    () => { $crate::cli::print_line(format_args!("")) };
    ($($line:tt)*) => { $crate::cli::print_line(format_args!($($line)*)) };
}

pub mod assemble;
pub mod diagnose;
mod diagnose_page;
mod export_fmu;
mod fmu;
pub mod glide;
mod glide_page;
mod history_page;
pub mod identify;
mod identify_figures;
mod identify_page;
mod mission;
mod mission_page;
pub mod plan;
mod plan_page;
mod plan_tables;
pub mod reading;
pub mod shell;
pub mod simulate;
mod sweep;
mod table;
pub mod track;
mod track_page;
pub mod vehicles;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, CommandFactory, Parser, Subcommand};

use crate::glide::GlideError;
use crate::input::{InputError, Place, printable};
use crate::output::{OutputError, OutputFolder, Replace, check, write_whole};
use crate::report::InputFile;
use crate::simulate::mission::MissionError;
use crate::vehicle::{MissingKeys, Vehicle};

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
    Simulate(simulate::Arguments),
    Identify(identify::Arguments),
    Diagnose(diagnose::Arguments),
    Track(track::Arguments),
    Plan(plan::Arguments),
    Assemble(assemble::Arguments),
    Vehicles(vehicles::Arguments),
    ExportFmu(export_fmu::Arguments),
    Fmu(fmu::Arguments),
    Completions(shell::CompletionsArguments),
    Man(shell::ManArguments),
}

/// Where results go; the same for every command.
#[derive(Debug, Clone, Args)]
pub struct Output {
    /// Write the result as JSON to FILE; `-` prints it, and nothing else, on standard output
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub json: Option<PathBuf>,
    /// Print no table; warnings still go to standard error
    #[arg(long, short, help_heading = "Output")]
    pub quiet: bool,
    /// Replace files, too, that this program did not write
    #[arg(long, help_heading = "Output")]
    pub force: bool,
}

impl Output {
    /// Whether tables belong on standard output.
    pub fn shows_tables(&self) -> bool {
        !self.quiet && self.json.as_ref().is_none_or(|path| path.as_os_str() != "-")
    }

    /// Writes the result as JSON where it was asked for.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn write_json(&self, result: &impl serde::Serialize) -> Result<(), CliError> {
        let Some(path) = &self.json else {
            return Ok(());
        };
        let mut text = serde_json::to_string_pretty(result).map_err(|error| CliError::Failed(error.to_string()))?;
        text.push('\n');
        if path.as_os_str() == "-" {
            use std::io::Write;
            return std::io::stdout()
                .write_all(text.as_bytes())
                .map_err(|error| CliError::Failed(format!("standard output cannot be written: {error}")));
        }
        Ok(write_whole(path, text.as_bytes(), self.replace())?)
    }

    /// Writes a file that the user named, whole or not at all; an earlier result is replaced, anything else only with
    /// `--force`.
    ///
    /// # Errors
    /// Where the file cannot be written or may not be replaced.
    pub fn write(&self, path: &Path, bytes: &[u8]) -> Result<(), CliError> {
        self.check_json()?;
        Ok(write_whole(path, bytes, self.replace())?)
    }

    /// Finds out whether [`write`](Self::write) will write there, before something else is written.
    ///
    /// # Errors
    /// Where the file cannot be written or may not be replaced.
    pub fn check(&self, path: &Path, bytes: &[u8]) -> Result<(), CliError> {
        Ok(check(path, bytes, self.replace())?)
    }

    /// Opens a folder for results, in which only earlier results are replaced, or anything with `--force`.
    ///
    /// # Errors
    /// Where the folder cannot be made, or the place of `--json` cannot be written to: the folder would be left without it.
    pub fn folder(&self, path: &Path) -> Result<OutputFolder, CliError> {
        self.check_json()?;
        Ok(OutputFolder::open(path, self.force)?)
    }

    fn check_json(&self) -> Result<(), CliError> {
        match &self.json {
            Some(path) if path.as_os_str() != "-" => self.check(path, b"{}"),
            _ => Ok(()),
        }
    }

    fn replace(&self) -> Replace {
        if self.force { Replace::Any } else { Replace::Own }
    }
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

/// A vehicle as a report lists it among what was read.
///
/// # Errors
/// Where the vehicle file cannot be read.
pub fn vehicle_input(name_or_file: &str) -> Result<InputFile, CliError> {
    match crate::vehicle::builtin::text(name_or_file) {
        Some(text) => Ok(InputFile::of(format!("built-in vehicle {name_or_file}"), text.as_bytes())),
        None => Ok(InputFile::read(name_or_file)?),
    }
}

/// Why a command ended without its result.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// Input that cannot be used: exit code 2.
    #[error(transparent)]
    Input(#[from] InputError),
    /// Results that cannot be written: exit code 1.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A vehicle file that lacks what this command needs: exit code 2.
    #[error(transparent)]
    MissingKeys(#[from] MissingKeys),
    /// Arguments that do not fit together: exit code 2.
    #[error("{0}")]
    Usage(String),
    /// No such glide: exit code 1.
    #[error(transparent)]
    Glide(#[from] GlideError),
    /// A mission that cannot be flown: exit code 1.
    #[error(transparent)]
    Mission(#[from] MissionError),
    /// Anything else: exit code 1.
    #[error("{0}")]
    Failed(String),
}

impl CliError {
    /// The exit code that tells it to a script.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            CliError::Input(_) | CliError::MissingKeys(_) | CliError::Usage(_) => ExitCode::from(2),
            CliError::Glide(GlideError::OutOfRange { .. }) => ExitCode::from(2),
            CliError::Output(_) | CliError::Glide(_) | CliError::Mission(_) | CliError::Failed(_) => ExitCode::FAILURE,
        }
    }
}

/// What a program does before anything else.
pub fn begin() {
    // A reader that has seen enough (`| head`) closes the pipe; the program then ends, as others do, and complains of
    // nothing. Rust's own start-up turns that off.
    #[cfg(unix)]
    // SAFETY: no other thread runs yet, and the default action calls no code of this program.
    unsafe {
        libc::signal(libc::SIGPIPE, libc::SIG_DFL);
    }
}

/// Prints a line of a table on standard output, in colour on a terminal only. Where it cannot be written, on a full disk,
/// the program ends with a message: the rest of the table would not arrive either.
pub fn print_line(line: std::fmt::Arguments) {
    use std::io::Write;
    if let Err(error) = writeln!(anstream::stdout().lock(), "{line}") {
        let error = CliError::Failed(format!("standard output cannot be written: {error}"));
        show(&error);
        std::process::exit(1);
    }
}

/// Reads the arguments of this process, does what they ask and says what went wrong.
pub fn main() -> ExitCode {
    begin();
    let cli = Cli::parse();
    match run(cli) {
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
        Command::Completions(arguments) => arguments.run(Cli::command()),
        Command::Diagnose(arguments) => diagnose::run(&arguments),
        Command::ExportFmu(arguments) => export_fmu::run(&arguments),
        Command::Fmu(arguments) => fmu::run(&arguments),
        Command::Glide(arguments) => glide::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Identify(arguments) => identify::run(&arguments),
        Command::Man(arguments) => arguments.run(Cli::command()),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Track(arguments) => track::run(&arguments),
        Command::Vehicles(arguments) => vehicles::run(&arguments),
    }
}

/// Prints an error: what, then what to do.
pub fn show(error: &CliError) {
    let text = error.to_string();
    match error {
        CliError::Input(InputError { place, problem, help: Some(help) })
        | CliError::Output(OutputError(InputError { place, problem, help: Some(help) })) => {
            anstream::eprintln!("{RED}error{RED:#}: {place}: {problem}\n{CYAN}help{CYAN:#}: {help}");
        }
        _ => anstream::eprintln!("{RED}error{RED:#}: {text}"),
    }
}

/// Says on standard error what a result is to be read with, `--quiet` or not: a script that keeps the tables keeps them clean,
/// and one that throws them away has still been told.
pub fn warn<S: std::fmt::Display>(warnings: impl IntoIterator<Item = S>) {
    for warning in warnings {
        anstream::eprintln!("{YELLOW}warning{YELLOW:#}: {warning}");
    }
}

const RED: anstyle::Style = anstyle::AnsiColor::Red.on_default().bold();
const YELLOW: anstyle::Style = anstyle::AnsiColor::Yellow.on_default().bold();
const CYAN: anstyle::Style = anstyle::AnsiColor::Cyan.on_default().bold();

#[cfg(test)]
mod tests;
