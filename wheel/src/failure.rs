//! Errors of the commands as exceptions of Python, with file, line and hint apart.

use std::path::PathBuf;

use glidepolar_input::InputError;
use glidepolar_report::output::OutputError;
use glidepolar_terminal::CliError;
use pyo3::prelude::*;

/// Why there is no result, in parts.
#[derive(Debug, Clone)]
pub struct Failure {
    /// Which exception of `glidepolar.errors` it is.
    kind: &'static str,
    problem: String,
    file: Option<PathBuf>,
    line: Option<usize>,
    column: Option<usize>,
    hint: Option<String>,
}

impl Failure {
    /// The parts of a command's error.
    pub fn new(error: &CliError) -> Self {
        match error {
            CliError::Input(error) => Self::at("InputError", error),
            CliError::Output(OutputError(error)) => Self::at("OutputError", error),
            CliError::MissingKeys(_) | CliError::Usage(_) => Self::plain("InputError", error),
            CliError::Glide(_) | CliError::Failed(_) => Self::plain("NoAnswerError", error),
        }
    }

    fn at(kind: &'static str, error: &InputError) -> Self {
        let place = &error.place;
        Failure {
            kind,
            problem: error.problem.clone(),
            file: Some(place.file.clone()),
            line: place.line,
            column: place.column,
            hint: error.help.clone(),
        }
    }

    fn plain(kind: &'static str, error: &CliError) -> Self {
        Failure { kind, problem: error.to_string(), file: None, line: None, column: None, hint: None }
    }

    /// The exception.
    pub fn raised(self, py: Python<'_>) -> PyErr {
        let made = py.import("glidepolar.errors").and_then(|errors| errors.getattr(self.kind)).and_then(|class| {
            let file = self.file.map(|file| file.to_string_lossy().into_owned());
            class.call1((self.problem, file, self.line, self.column, self.hint))
        });
        made.map_or_else(|error| error, PyErr::from_value)
    }
}
