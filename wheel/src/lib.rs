//! The extension module `glidepolar._native`: the work of both commands inside Python's process.
//!
//! - [`run`]: a command by its arguments, in a thread of its own, with Python free to do other things meanwhile.
//! - [`read`]: the channels of a log as arrays.
//! - [`table::Table`]: columns of a data frame that readers of logs take without a copy.
//! - [`vehicle`]: vehicle files as texts.
//!
//! The package's Python sources are what users see; this module does not know what a result means.

#[path = "../../tank/src/demo_cli.rs"]
mod demo_cli;
mod failure;
mod table;
#[path = "../../tank/src/cli.rs"]
mod tank_cli;
mod vehicle;
mod work;

use std::path::PathBuf;

use clap::Parser;
use glidepolar::cli::Cli;
use glidepolar_flightlog::{CHANNELS, Channel, Columns, FlightLog, LogFiles, Piece};
use glidepolar_input::{InputError, Place};
use glidepolar_report::as_command;
use glidepolar_terminal::{CliError, captured};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use failure::Failure;
use work::in_a_thread;

/// What a command gave back: its JSON, its tables as text, its warnings.
type Outcome = (Option<String>, String, Vec<String>);

/// Channels by name, what was found in the files, and what was left out.
type Channels<'py> = (Bound<'py, PyDict>, Vec<String>, Vec<String>);

/// Does what a command line asks, `["glidepolar", "glide", ...]`: its JSON, its tables as text, its warnings.
#[pyfunction]
#[pyo3(signature = (arguments, progress=None))]
fn run(py: Python<'_>, arguments: Vec<String>, progress: Option<Py<PyAny>>) -> PyResult<Outcome> {
    let done = in_a_thread(py, progress, move || {
        let (done, kept) = captured(|| as_command(&arguments, || command(&arguments)));
        done.map(|()| (kept.json, kept.lines, kept.warnings)).map_err(|error| Failure::new(&error))
    })?;
    done.map_err(|failure| failure.raised(py))
}

fn command(arguments: &[String]) -> Result<(), CliError> {
    let usage = |error: clap::Error| CliError::Usage(error.render().to_string().trim().to_owned());
    if arguments.first().is_some_and(|program| program == "tank-reduce") {
        return tank_cli::Cli::try_parse_from(arguments).map_err(usage)?.run();
    }
    glidepolar::cli::run(Cli::try_parse_from(arguments).map_err(usage)?)
}

/// Reads logs of any maker: the channels that were recorded, by name; notes; warnings.
#[pyfunction]
fn read<'py>(
    py: Python<'py>,
    files: Vec<PathBuf>,
    columns: Vec<String>,
    units: Vec<String>,
    caches: Vec<PathBuf>,
    speed: Option<String>,
) -> PyResult<Channels<'py>> {
    let read = in_a_thread(py, None, move || {
        let columns = self::columns(&columns, &units, &caches, speed.as_deref())?;
        channels(&files, &columns).map_err(|error| Failure::new(&error.into()))
    })?;
    let (log, notes, warnings) = read.map_err(|failure| failure.raised(py))?;
    let found = PyDict::new(py);
    for (channel, values) in log.into_columns() {
        found.set_item(CHANNELS[channel as usize].name, values.into_pyarray(py))?;
    }
    Ok((found, notes, warnings))
}

/// Rows of a log that are read at once.
const PIECE_ROWS: usize = 50_000;

fn channels(files: &[PathBuf], columns: &Columns) -> Result<(FlightLog, Vec<String>, Vec<String>), InputError> {
    let (mut log, mut files_of) = (FlightLog::default(), LogFiles::open(files, columns)?);
    while let Some(piece) = files_of.next_piece(PIECE_ROWS)? {
        match piece {
            Piece::Series(piece) => log.append(&piece),
            Piece::Glides(_) => {
                let place = Place::file(files.first().cloned().unwrap_or_default());
                let error = InputError::new(place, "has one row per descent or ascent, and is no time series");
                return Err(error.help("identify and diagnose take it as it is; pandas.read_csv reads it"));
            }
        }
    }
    Ok((log, files_of.notes().to_vec(), files_of.warnings().to_vec()))
}

fn columns(choices: &[String], units: &[String], caches: &[PathBuf], speed: Option<&str>) -> Result<Columns, Failure> {
    let usage = |problem: String| Failure::new(&CliError::Usage(problem));
    let mut columns = Columns::default();
    choices.iter().try_for_each(|choice| columns.choose_text(choice)).map_err(usage)?;
    units.iter().try_for_each(|unit| columns.unit_text(unit)).map_err(usage)?;
    caches.iter().for_each(|folder| columns.cache(folder));
    if let Some(name) = speed {
        columns.choose(Channel::Speed, name);
    }
    Ok(columns)
}

/// The module.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::table::Table;
    #[pymodule_export]
    use super::vehicle::{builtin_vehicles, changed_vehicle, load_vehicle, vehicle_keys, vehicle_value};
    #[pymodule_export]
    use super::{read, run};
}
