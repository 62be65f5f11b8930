//! The programs of the demonstration, run in its folder, and the commands as one would type them there.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::cli::CliError;

/// Runs programs in one folder and remembers the commands.
pub(super) struct Programs {
    folder: PathBuf,
    /// Where this program is, and those that were installed with it.
    beside: PathBuf,
    commands: Vec<String>,
}

impl Programs {
    /// To run in this folder.
    ///
    /// # Errors
    /// Where this program does not know where it is.
    pub fn of(folder: &Path) -> Result<Programs, CliError> {
        let unknown = |error: std::io::Error| CliError::Failed(format!("cannot find the other programs: {error}"));
        let own = std::env::current_exe().map_err(unknown)?;
        let beside = own.parent().map(Path::to_owned).unwrap_or_default();
        Ok(Programs { folder: std::path::absolute(folder).map_err(unknown)?, beside, commands: Vec::new() })
    }

    /// Runs a program of this package, or another one by its path. What it prints is shown only where it fails.
    ///
    /// # Errors
    /// Where it cannot be started, or fails.
    pub fn run(&mut self, program: &str, arguments: &[&str]) -> Result<(), CliError> {
        let name = Path::new(program).file_stem().map_or(program.into(), |stem| stem.to_string_lossy());
        let line = format!("{name} {}", arguments.join(" "));
        let installed = self.beside.join(format!("{program}{}", std::env::consts::EXE_SUFFIX));
        let program = if installed.is_file() { installed } else { PathBuf::from(program) };
        let mut command = Command::new(&program);
        command.args(arguments).current_dir(&self.folder).stdin(Stdio::null());
        let done = command.output().map_err(|error| {
            CliError::Failed(format!("{line}: cannot be started: {error}; is the whole package installed?"))
        })?;
        if !done.status.success() {
            let said = String::from_utf8_lossy(&done.stderr);
            return Err(CliError::Failed(format!("in {}: {line} failed: {}", self.folder.display(), said.trim_end())));
        }
        self.commands.push(line);
        Ok(())
    }

    /// The commands so far.
    pub fn commands(self) -> Vec<String> {
        self.commands
    }
}

/// A Python that has FMPy: the one that was asked for, the one beside this program, or the one on the path.
pub(super) fn fmpy(asked_for: Option<&Path>) -> Option<PathBuf> {
    let name = format!("python{}", std::env::consts::EXE_SUFFIX);
    let beside = std::env::current_exe().ok().and_then(|own| Some(own.parent()?.join(name)));
    let candidates = match asked_for {
        Some(python) => vec![std::path::absolute(python).unwrap_or_else(|_| python.to_owned())],
        None => beside.into_iter().chain(["python3".into(), "python".into()]).collect(),
    };
    candidates.into_iter().find(|python| {
        let mut command = Command::new(python);
        command.args(["-c", "import fmpy"]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    })
}
