//! The project's own Python environment: target/python, with the packages that tests/python/requirements.txt pins.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use glidepolar_archive::write_whole;

use crate::requirements::stamp;
use crate::workspace::{Workspace, capture, run};

/// The environment's folder below target/, and the file that lists its packages.
const FOLDER: &str = "python";
const REQUIREMENTS: &str = "tests/python/requirements.txt";

/// What simulates an FMU and links one, with what these bring along: a third of the work of installing all.
const FIRST: &[&str] = if cfg!(target_os = "linux") { &["fmpy", "cargo-zigbuild", "ziglang"] } else { &["fmpy"] };

/// Stamps of an environment that has the packages of `FIRST`, and of one that has all.
const BEGUN: &str = "glidepolar-stamp-begun";
const COMPLETE: &str = "glidepolar-stamp";

/// The oldest Python for which all pinned packages exist.
const OLDEST: (u32, u32) = (3, 11);

/// An environment that is complete and up to date.
pub struct Python {
    folder: PathBuf,
}

impl Python {
    /// The interpreter.
    pub fn interpreter(&self) -> PathBuf {
        self.tool("python")
    }

    /// A program that one of the packages installed.
    pub fn tool(&self, name: &str) -> PathBuf {
        let (folder, suffix) = if cfg!(windows) { ("Scripts", ".exe") } else { ("bin", "") };
        self.folder.join(folder).join(format!("{name}{suffix}"))
    }
}

/// Returns the environment, made anew if it is missing or was made from something else than what is wanted now.
pub fn ensure(workspace: &Workspace) -> Result<Python> {
    make(workspace, None)
}

/// The same environment as far as packing and simulating an FMU need it. What else belongs to it may be there or not.
pub fn ensure_begun(workspace: &Workspace) -> Result<Python> {
    make(workspace, Some(FIRST))
}

fn make(workspace: &Workspace, first: Option<&[&str]>) -> Result<Python> {
    let folder = workspace.target(FOLDER);
    let requirements = workspace.path(REQUIREMENTS);
    let wanted = fs::read(&requirements).with_context(|| format!("cannot read {REQUIREMENTS}"))?;
    let base = find_interpreter(workspace)?;
    let wanted = stamp(&wanted, &base.version, &folder);

    fs::create_dir_all(workspace.target(""))?;
    let lock = File::create(workspace.target("python.lock"))?;
    lock.lock().context("cannot wait for another xtask that makes the Python environment")?;
    let python = Python { folder };
    let has_stamp = |name: &str| {
        fs::read_to_string(python.folder.join(name)).is_ok_and(|found| found == wanted)
            && python.interpreter().is_file()
    };
    let has_begun = has_stamp(BEGUN);
    if has_stamp(COMPLETE) || (first.is_some() && has_begun) {
        return Ok(python);
    }

    eprintln!("making the Python environment in {} (Python {})", workspace.shown(&python.folder), base.version);
    if !has_begun {
        if python.folder.exists() {
            fs::remove_dir_all(&python.folder)?;
        }
        check_venv_modules(workspace, &base)?;
        run(workspace.command(&base.program).args(["-m", "venv"]).arg(&python.folder))?;
    }
    install(workspace, &python, &requirements, first)?;
    let name = if first.is_some() { BEGUN } else { COMPLETE };
    write_whole(&python.folder.join(name), |file| std::io::Write::write_all(file, wanted.as_bytes()))?;
    Ok(python)
}

/// Installs all that is required, or the packages `first` with what they bring along, in the versions that are required.
fn install(workspace: &Workspace, python: &Python, requirements: &Path, first: Option<&[&str]>) -> Result<()> {
    let pip = || {
        let mut command = workspace.command(python.interpreter());
        command.args(["-m", "pip", "--disable-pip-version-check", "--no-input", "install", "--quiet", "--no-compile"]);
        command
    };
    let uv = || {
        let mut command = workspace.command(python.tool("uv"));
        command.args(["pip", "install", "--quiet", "--python"]).arg(python.interpreter());
        command
    };
    let packages = |mut installer: Command| {
        installer.arg("--only-binary=:all:");
        installer.arg(if first.is_some() { "--constraint" } else { "--requirement" }).arg(requirements);
        run(installer.args(first.unwrap_or_default()))
    };
    // The pinned installers first: they read the rest.
    let text = fs::read_to_string(requirements)?;
    let installers: Vec<&str> = INSTALLERS
        .iter()
        .map(|name| text.lines().find(|line| line.strip_prefix(name).is_some_and(|rest| rest.starts_with("=="))))
        .collect::<Option<_>>()
        .with_context(|| format!("the list of packages does not pin {}", INSTALLERS.join(" and ")))?;
    run(pip().args(installers))
        // uv takes a quarter of the time. It does not read pip's settings: where they are needed, pip installs.
        .and_then(|()| packages(uv()).or_else(|_| packages(pip())))
        .context("the packages could not be installed; is the package index reachable (`python3 -m pip download pip`)?")
}

/// What installs packages.
const INSTALLERS: [&str; 2] = ["pip", "uv"];

struct Interpreter {
    program: String,
    version: String,
}

/// The first of the usual names that is a Python, new enough. `PYTHON` names another.
fn find_interpreter(workspace: &Workspace) -> Result<Interpreter> {
    let chosen = std::env::var("PYTHON").ok();
    let names: Vec<&str> = match &chosen {
        Some(program) => vec![program],
        None => vec!["python3", "python"],
    };
    let mut too_old = None;
    for program in names {
        let print_version = "import platform; print(platform.python_version())";
        let Ok(version) = capture(workspace.command(program).args(["-c", print_version])) else {
            continue;
        };
        let version = version.trim().to_owned();
        if is_new_enough(&version) {
            return Ok(Interpreter { program: program.to_owned(), version });
        }
        too_old.get_or_insert(format!("{program} is Python {version}"));
    }
    let (major, minor) = OLDEST;
    let found = too_old.unwrap_or_else(|| match chosen {
        Some(program) => format!("PYTHON={program} does not run"),
        None => "neither python3 nor python runs".to_owned(),
    });
    bail!(
        "Python {major}.{minor} or newer is needed, and {found}.\n  {}\n  (PYTHON=/path/to/python3 chooses another.)",
        advice(
            "install it with",
            "apt-get install python3 python3-venv",
            "brew install python3",
            "winget install Python.Python.3.13"
        )
    )
}

fn is_new_enough(version: &str) -> bool {
    let mut numbers = version.split('.').map(|part| part.parse::<u32>().unwrap_or(0));
    (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0)) >= OLDEST
}

/// Debian and its relatives ship Python without the two modules that make environments.
fn check_venv_modules(workspace: &Workspace, base: &Interpreter) -> Result<()> {
    let mut import: Command = workspace.command(&base.program);
    import.args(["-c", "import venv, ensurepip"]);
    if capture(&mut import).is_err() {
        bail!(
            "Python {} ({}) has no venv module.\n  {}",
            base.version,
            base.program,
            advice(
                "install it with",
                "apt-get install python3-venv",
                "brew install python3",
                "the installer of Python"
            )
        );
    }
    Ok(())
}

fn advice(what: &str, linux: &str, macos: &str, windows: &str) -> String {
    let command = match std::env::consts::OS {
        "macos" => macos,
        "windows" => windows,
        _ => linux,
    };
    format!("{what}: {command}")
}

#[cfg(test)]
mod tests {
    use super::is_new_enough;

    #[test]
    fn versions_are_compared_as_numbers() {
        assert!(is_new_enough("3.11.7"));
        assert!(is_new_enough("3.14.0rc1"));
        assert!(is_new_enough("4.0"));
        assert!(!is_new_enough("3.9.18"));
        assert!(!is_new_enough("2.7.18"));
        assert!(!is_new_enough("not a version"));
    }
}
