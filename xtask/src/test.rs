//! `cargo xtask test`: everything that is tested, in one go. The tests find the built programs, the FMUs and the Python
//! environment in environment variables, and say in one file what they skipped.
//!
//! What is tested is built in two lanes, in folders that cargo locks apart: the programs and the tests in Rust; the library
//! of the FMU with its one slow link, and the importers. The tests in Python then run in two processes, on copies of what
//! was built: pages of the documentation build some of it again.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};

use crate::fmu::{self, Fmus};
use crate::importers;
use crate::python::{self, Python};
use crate::wheel;
use crate::workspace::{Kind, Workspace, capture, run as run_command};

/// Everything is built once: what would make a second build of the same crate faster is time and space for nothing.
pub const ENVIRONMENT: [(&str, &str); 1] = [("CARGO_INCREMENTAL", "0")];

/// A part of the tests that can be run alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Part {
    /// Examples in the documentation
    Doc,
    /// Rust's tests of the whole workspace
    Rust,
    /// Tests in Python, with other programs as importers of the FMU
    Python,
}

/// Builds what the tests need and runs them. The first part that fails ends it.
pub fn run(workspace: &Workspace, only: Option<Part>) -> Result<()> {
    let mut stages = Stages::default();
    let tested = stages.time("build", || Tested::build(workspace))?;
    let wanted = |part| only.is_none_or(|only| only == part);
    if wanted(Part::Doc) {
        let mut command = workspace.cargo_for_all("test");
        command.arg("--doc");
        stages.time("examples in the documentation", || run_command(tested.announce(&mut command)))?;
    }
    if wanted(Part::Rust) {
        stages.time("Rust's tests", || run_command(tested.announce(rust_tests(workspace).arg("--no-fail-fast"))))?;
    }
    if wanted(Part::Python) {
        let mut command = workspace.command(tested.python.interpreter());
        command.args(["-m", "pytest", "tests/python", "-rs", "--timeout=300", "-p", "no:cacheprovider"]);
        // Tests of one group, those that run cargo, stay in one process and in their order: the long ones first, not the large groups.
        command.args(["--numprocesses=2", "--dist=loadgroup", "--no-loadscope-reorder", "--durations=40"]);
        stages.time("tests in Python", || run_command(tested.announce(&mut command)))?;
    }
    stages.print();
    print_skipped(&tested.skipped);
    Ok(())
}

/// nextest where it is installed, since it keeps a test that crashes from taking others along; else cargo's own test command.
fn rust_tests(workspace: &Workspace) -> Command {
    if has_nextest(workspace) {
        let mut command = workspace.cargo();
        command.args(["nextest", "run", "--workspace"]);
        command
    } else {
        let mut command = workspace.cargo_for_all("test");
        command.arg("--all-targets");
        command
    }
}

fn has_nextest(workspace: &Workspace) -> bool {
    capture(workspace.cargo().args(["nextest", "--version"])).is_ok()
}

/// What is tested, by where it lies.
struct Tested {
    programs: Vec<(&'static str, PathBuf)>,
    fmus: Fmus,
    wheel: PathBuf,
    python: Python,
    importers: PathBuf,
    skipped: PathBuf,
}

impl Tested {
    fn build(workspace: &Workspace) -> Result<Self> {
        let skipped = workspace.target("skipped-tests.txt");
        fs::create_dir_all(workspace.target(""))?;
        fs::write(&skipped, "").with_context(|| format!("cannot write {}", skipped.display()))?;

        let (programs, others) = std::thread::scope(|lanes| {
            let programs = lanes.spawn(|| build_programs_and_tests(workspace));
            let others = build_fmus_and_importers(workspace, &skipped);
            (programs.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)), others)
        });
        programs?;
        let (python, fmus, importers) = others?;

        let folder = workspace.target("tested");
        if folder.exists() {
            fs::remove_dir_all(&folder).with_context(|| format!("cannot empty {}", folder.display()))?;
        }
        fs::create_dir_all(&folder)?;
        let program = |name: &str| {
            copy(&folder, &workspace.target("debug").join(format!("{name}{}", std::env::consts::EXE_SUFFIX)))
        };
        let programs = vec![
            ("GLIDEPOLAR_COMMAND", program("glidepolar")?),
            ("GLIDEPOLAR_TANK_REDUCE", program("tank-reduce")?),
            ("GLIDEPOLAR_REPORT_EXAMPLE", program("examples/report")?),
            ("GLIDEPOLAR_VIRTUAL_SEA", program("virtual-sea")?),
            ("GLIDEPOLAR_LOG_VALUES", program("examples/log_values")?),
        ];
        let wheel = copy(&folder, &wheel::build(workspace, Kind::Tests, &python, &fmus)?)?;
        let fmus = Fmus {
            fmi3: copy(&folder, &fmus.fmi3)?,
            fmi2: copy(&folder, &fmus.fmi2)?,
            space3: copy(&folder, &fmus.space3)?,
            space2: copy(&folder, &fmus.space2)?,
            library: copy(&folder, &fmus.library)?,
        };
        Ok(Self { programs, fmus, wheel, python, importers, skipped })
    }

    /// Tells a command where everything is.
    fn announce<'c>(&self, command: &'c mut Command) -> &'c mut Command {
        command
            .envs(self.programs.iter().map(|(name, path)| (name, path)))
            .env("GLIDEPOLAR_FMU3", &self.fmus.fmi3)
            .env("GLIDEPOLAR_FMU2", &self.fmus.fmi2)
            .env("GLIDEPOLAR_SPACE_FMU3", &self.fmus.space3)
            .env("GLIDEPOLAR_SPACE_FMU2", &self.fmus.space2)
            .env("GLIDEPOLAR_FMU_LIBRARY", &self.fmus.library)
            .env("GLIDEPOLAR_WHEEL", &self.wheel)
            .env("GLIDEPOLAR_PYTHON", self.python.interpreter())
            .env("GLIDEPOLAR_IMPORTERS", &self.importers)
            .env("GLIDEPOLAR_SKIPPED", &self.skipped)
    }
}

/// The programs that tests run, and the tests in Rust, by one command: a second one would wait for the last crate of the first,
/// which one core builds alone. What nextest builds by itself is then there.
fn build_programs_and_tests(workspace: &Workspace) -> Result<()> {
    let bins = ["--bin", "glidepolar", "--bin", "tank-reduce", "--bin", "virtual-sea"];
    run_command(workspace.cargo_for_all("build").args(bins).args(["--examples", "--tests"]))?;
    run_command(rust_tests(workspace).arg("--no-run"))
}

/// What lies in folders of its own: the Python environment, the FMUs, the importers.
fn build_fmus_and_importers(workspace: &Workspace, skipped: &Path) -> Result<(Python, Fmus, PathBuf)> {
    let python = python::ensure(workspace)?;
    let fmus = fmu::run(workspace, &[], fmu::Scope::Host)?;
    let importers = importers::build(workspace, skipped)?;
    Ok((python, fmus, importers))
}

/// Copies a file into a folder and returns where it is then.
fn copy(folder: &Path, file: &Path) -> Result<PathBuf> {
    let copied = folder.join(file.file_name().context("a file has a name")?);
    fs::copy(file, &copied).with_context(|| format!("cannot copy {}", file.display()))?;
    Ok(copied)
}

fn print_skipped(file: &Path) {
    let skipped = fs::read_to_string(file).unwrap_or_default();
    if !skipped.is_empty() {
        eprintln!("\nSKIPPED, so not tested on this machine:");
        for line in skipped.lines() {
            eprintln!("  {line}");
        }
    }
}

/// How long each part took.
#[derive(Default)]
struct Stages(Vec<(&'static str, Duration)>);

impl Stages {
    fn time<T>(&mut self, name: &'static str, work: impl FnOnce() -> Result<T>) -> Result<T> {
        let start = Instant::now();
        let result = work();
        self.0.push((name, start.elapsed()));
        if result.is_err() {
            self.print();
        }
        result
    }

    fn print(&self) {
        eprintln!();
        for (name, duration) in &self.0 {
            eprintln!("{:8.1} s  {name}", duration.as_secs_f64());
        }
    }
}
