//! Where the project's folders are, and running other programs from there.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

/// For whom something is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// For others: optimised, on Linux for glibc 2.28 and newer.
    Release,
    /// For the tests: the programs as they are built for them, for this machine.
    Tests,
}

/// The checkout that the chores work on.
pub struct Workspace {
    root: PathBuf,
    target: PathBuf,
    /// Variables that every command is given.
    environment: &'static [(&'static str, &'static str)],
}

impl Workspace {
    /// The checkout that this program was built from.
    pub fn find() -> Result<Self> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .filter(|root| root.join("Cargo.toml").is_file())
            .context("the checkout that xtask was built in is gone; run it as `cargo xtask` inside a checkout")?
            .to_owned();
        let target = match std::env::var_os("CARGO_TARGET_DIR") {
            Some(folder) => std::path::absolute(folder)?,
            None => root.join("target"),
        };
        Ok(Self { root, target, environment: &[] })
    }

    /// The same checkout, with these variables for every command.
    pub fn with_environment(self, environment: &'static [(&'static str, &'static str)]) -> Self {
        Self { environment, ..self }
    }

    /// Some other folder in place of a checkout.
    #[cfg(test)]
    pub fn at(root: &Path) -> Self {
        Self { root: root.to_owned(), target: root.join("target"), environment: &[] }
    }

    /// A path below the checkout's root.
    pub fn path(&self, below: impl AsRef<Path>) -> PathBuf {
        self.root.join(below)
    }

    /// A path below the folder for everything built.
    pub fn target(&self, below: impl AsRef<Path>) -> PathBuf {
        self.target.join(below)
    }

    /// A path as a person at the root of the checkout would write it.
    pub fn shown<'p>(&self, path: &'p Path) -> std::path::Display<'p> {
        path.strip_prefix(&self.root).unwrap_or(path).display()
    }

    /// A command that runs at the checkout's root and sees no standard input.
    pub fn command(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.root).stdin(Stdio::null()).envs(self.environment.iter().copied());
        // What Python has compiled is kept, whatever this machine is set up with, and not in the checkout: hundreds of its processes
        // begin in a run of the tests, and without it each compiles all that it imports.
        command.env_remove("PYTHONDONTWRITEBYTECODE").env("PYTHONPYCACHEPREFIX", self.target("pycache"));
        command
    }

    /// The cargo that started this program.
    pub fn cargo(&self) -> Command {
        self.command(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
    }

    /// A verb of cargo with the features that all packages of the workspace together ask for, even where only some targets
    /// are built. A selection of packages has other features of shared dependencies, and cargo builds these, and all that
    /// depends on them, once more.
    pub fn cargo_for_all(&self, verb: &str) -> Command {
        let mut command = self.cargo();
        command.args([verb, "--workspace"]);
        command
    }
}

/// Says what is run, runs it with its output going to the terminal, and fails unless it succeeds.
pub fn run(command: &mut Command) -> Result<()> {
    eprintln!("$ {}", line(command));
    let status = command.status().with_context(|| format!("cannot start {}", line(command)))?;
    if !status.success() {
        bail!("{} failed: {status}", line(command));
    }
    Ok(())
}

/// Runs a command and returns what it printed on standard output; its standard error is part of the error if it fails.
pub fn capture(command: &mut Command) -> Result<String> {
    let output = command.output().with_context(|| format!("cannot start {}", line(command)))?;
    if !output.status.success() {
        let complaint = String::from_utf8_lossy(&output.stderr);
        bail!("{} failed: {}\n{}", line(command), output.status, complaint.trim_end());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The command as one would type it, the program without its folder.
pub fn line(command: &Command) -> String {
    let program = Path::new(command.get_program());
    let program = program.file_name().unwrap_or(program.as_os_str());
    std::iter::once(program)
        .chain(command.get_args())
        .map(|word| {
            let word = word.to_string_lossy();
            if word.is_empty() || word.contains(char::is_whitespace) { format!("'{word}'") } else { word.into_owned() }
        })
        .collect::<Vec<_>>()
        .join(" ")
}
