//! What the tests that take several programs share: where the built things are, and how a test that cannot run says so.
//!
//! `cargo xtask test` builds everything and tells the tests in environment variables. Under plain `cargo test` they are
//! not set, and the tests that need them skip.

mod blind;
mod trajectory;

use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

pub use blind::diagnosed;
pub use trajectory::Trajectory;

/// Something that `cargo xtask test` builds or makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Built {
    /// The program `glidepolar`.
    Glidepolar,
    /// The program `tank-reduce`.
    TankReduce,
    /// The FMI 3.0 archive.
    Fmu3,
    /// The FMI 2.0 archive.
    Fmu2,
    /// The FMI 3.0 archive of the glider in space.
    SpaceFmu3,
    /// The FMI 2.0 archive of the glider in space.
    SpaceFmu2,
    /// The shared library in both.
    FmuLibrary,
    /// The interpreter of the Python environment.
    Python,
    /// The folder of the importer programs in tests/importers.
    Importers,
}

impl Built {
    /// The environment variable that says where it is.
    pub fn variable(self) -> &'static str {
        match self {
            Built::Glidepolar => "GLIDEPOLAR_COMMAND",
            Built::TankReduce => "GLIDEPOLAR_TANK_REDUCE",
            Built::Fmu3 => "GLIDEPOLAR_FMU3",
            Built::Fmu2 => "GLIDEPOLAR_FMU2",
            Built::SpaceFmu3 => "GLIDEPOLAR_SPACE_FMU3",
            Built::SpaceFmu2 => "GLIDEPOLAR_SPACE_FMU2",
            Built::FmuLibrary => "GLIDEPOLAR_FMU_LIBRARY",
            Built::Python => "GLIDEPOLAR_PYTHON",
            Built::Importers => "GLIDEPOLAR_IMPORTERS",
        }
    }

    /// Where it is; `None`, said aloud, when the tests were not started by `cargo xtask test`. A test then returns.
    ///
    /// # Panics
    /// Where the variable names something that does not exist: a test must not skip over a failed build.
    pub fn path(self) -> Option<PathBuf> {
        let Some(path) = std::env::var_os(self.variable()).map(PathBuf::from) else {
            skip(&format!("{} is not set; run the tests as `cargo xtask test`", self.variable()));
            return None;
        };
        assert!(path.exists(), "{} = {} does not exist", self.variable(), path.display());
        Some(path)
    }
}

/// Says aloud that the running test skips, and why: on standard error, and in the list that `cargo xtask test` shows at
/// its end.
pub fn skip(reason: &str) {
    let thread = std::thread::current();
    let line = format!("{}: {reason}", thread.name().unwrap_or("a test"));
    eprintln!("SKIPPED {line}");
    if let Some(list) = std::env::var_os("GLIDEPOLAR_SKIPPED") {
        let mut list =
            OpenOptions::new().append(true).create(true).open(list).expect("the list of skipped tests opens");
        writeln!(list, "{line}").expect("the list of skipped tests can be written");
    }
}

/// The folder of measured data: the one that `GLIDEPOLAR_DATA` names, or `shared/data` beside the checkout. `None`, said
/// aloud, when there is neither.
pub fn measured_data() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = match std::env::var_os("GLIDEPOLAR_DATA") {
        Some(folder) => PathBuf::from(folder),
        None => root.join("../shared/data"),
    };
    if !folder.is_dir() {
        skip("no measured data; set GLIDEPOLAR_DATA to their folder");
        return None;
    }
    Some(folder)
}

/// A folder that `cargo xtask fetch-data` fills; `None`, said aloud, when it has not.
pub fn fetched_data(folder: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data").join(folder);
    if !folder.is_dir() {
        skip("the logs are not there; fetch them by `cargo xtask fetch-data`");
        return None;
    }
    Some(folder)
}
