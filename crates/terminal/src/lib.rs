//! What the programs have in common on a terminal: where results go, why a command ended, messages, completions and manual
//! pages.
//!
//! Exit code 0: done; 1: the question has no answer, or the result could not be written; 2: the input cannot be used.
//! Standard output carries results, standard error messages. Knows no command.

mod alike;
mod capture;
mod progress;
pub mod shell;

pub use capture::{Captured, captured};
pub use progress::on_terminal;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use glidepolar_dynamics::glide::GlideError;
use glidepolar_input::{InputError, printable};
use glidepolar_report::output::{OutputError, OutputFolder, Replace, check, write_whole};
use glidepolar_vehicle::MissingKeys;

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

    /// Finds out before any work whether the results have places of their own, `--json` among them; each place comes with its
    /// option. `inputs` are the files that the command reads; what is not there is none of them.
    ///
    /// # Errors
    /// Where two options name one place or an option names an input, or the place of `--json` cannot be written to.
    pub fn begin(&self, inputs: &[&Path], places: &[(&str, Option<&Path>)]) -> Result<(), CliError> {
        let json = self.json.as_deref().filter(|path| path.as_os_str() != "-");
        let places: Vec<(&str, Option<&Path>)> = places.iter().copied().chain([("--json", json)]).collect();
        own_places(inputs, &places)?;
        self.check_json()
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
            if capture::json(&text) {
                return Ok(());
            }
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

/// Finds out whether each result has a place of its own. A result in the place of what it was made of is never meant, and an
/// input is lost by it: `--force` does not allow it. A folder among the inputs stands for the files in it.
///
/// # Errors
/// Where two options name one place, or an option names an input.
pub fn own_places(inputs: &[&Path], places: &[(&str, Option<&Path>)]) -> Result<(), CliError> {
    // A device, as standard input, is nobody's place.
    let is_kept = |path: &&&Path| std::fs::metadata(path).is_ok_and(|found| found.is_file() || found.is_dir());
    let inputs: Vec<PathBuf> = inputs.iter().filter(is_kept).map(|path| place(path)).collect();
    let mut taken: Vec<(&str, PathBuf)> = Vec::new();
    for (option, path) in places {
        let Some(path) = path else { continue };
        let (name, place) = (printable(&path.to_string_lossy()), place(path));
        let is_of =
            |input: &PathBuf| *input == place || (input.is_dir() && place.is_file() && place.starts_with(input));
        if inputs.iter().any(is_of) {
            let problem = format!("{option} {name} names a file that this command reads: give the result another name");
            return Err(CliError::Usage(problem));
        }
        if let Some((other, _)) = taken.iter().find(|(_, taken)| *taken == place) {
            let problem = format!("{other} and {option} name the same place, {name}: give each result its own");
            return Err(CliError::Usage(problem));
        }
        taken.push((option, place));
    }
    Ok(())
}

/// Where a path leads to, whether or not the file is there already.
fn place(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let named = || Some(std::fs::canonicalize(folder).ok()?.join(path.file_name()?));
    std::fs::canonicalize(path).ok().or_else(named).unwrap_or_else(|| path.to_owned())
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
            CliError::Output(_) | CliError::Glide(_) | CliError::Failed(_) => ExitCode::FAILURE,
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
    if capture::line(line) {
        return;
    }
    progress::hide();
    if let Err(error) = writeln!(anstream::stdout().lock(), "{line}") {
        let error = CliError::Failed(format!("standard output cannot be written: {error}"));
        show(&error);
        std::process::exit(1);
    }
}

/// Prints an error: what, then what to do.
pub fn show(error: &CliError) {
    progress::hide();
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
/// and one that throws them away has still received it. Many that differ in their numbers alone are shortened; the JSON has them all.
pub fn warn<S: std::fmt::Display>(warnings: impl IntoIterator<Item = S>) {
    let printed: Vec<String> =
        warnings.into_iter().filter(|warning| !capture::warning(warning)).map(|warning| warning.to_string()).collect();
    for warning in alike::shortened(&printed) {
        progress::hide();
        anstream::eprintln!("{YELLOW}warning{YELLOW:#}: {warning}");
    }
}

const RED: anstyle::Style = anstyle::AnsiColor::Red.on_default().bold();
const YELLOW: anstyle::Style = anstyle::AnsiColor::Yellow.on_default().bold();
const CYAN: anstyle::Style = anstyle::AnsiColor::Cyan.on_default().bold();
