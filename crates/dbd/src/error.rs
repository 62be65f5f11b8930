//! What could not be read: the file, the place in it, what was found and what to do.

use std::fmt;
use std::path::{Path, PathBuf};

/// A place in a file: bytes count from 0 in the file's contents, for compressed files in what they unpack to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Place {
    /// Compressed block, from 1; none in files that are not compressed.
    pub block: Option<u64>,
    /// Byte.
    pub byte: Option<u64>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(block) = self.block {
            write!(f, ", block {block}")?;
        }
        if let Some(byte) = self.byte {
            write!(f, ", byte {byte}")?;
        }
        Ok(())
    }
}

/// A file that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    /// The file.
    pub file: PathBuf,
    /// Where in it.
    pub place: Place,
    /// What was found, and what was expected.
    pub problem: String,
    /// What to do.
    pub help: Option<String>,
}

impl Error {
    pub(crate) fn new(file: &Path, problem: impl Into<String>) -> Self {
        Error { file: file.to_owned(), place: Place::default(), problem: problem.into(), help: None }
    }

    pub(crate) fn at(self, place: Place) -> Self {
        Error { place, ..self }
    }

    pub(crate) fn help(self, help: impl Into<String>) -> Self {
        Error { help: Some(help.into()), ..self }
    }

    pub(crate) fn io(file: &Path, error: &std::io::Error) -> Self {
        Error::new(file, error.to_string())
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}: {}", self.file.display(), self.place, self.problem)?;
        match &self.help {
            Some(help) => write!(f, "; {help}"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for Error {}

/// A damaged part of a file, with sound parts around it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Damage {
    /// Where it begins.
    pub place: Place,
    /// What was found, and what was done.
    pub problem: String,
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = self.place.to_string();
        write!(f, "{}: {}", place.trim_start_matches(", "), self.problem)
    }
}
