//! `cargo xtask test`: everything that is tested, in one go. The tests find the built programs, the FMUs and the Python
//! environment in environment variables, and say in one file what they skipped.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};

use crate::fmu::{self, Fmus};
use crate::importers;
use crate::python::{self, Python};
use crate::wheel;
use crate::workspace::{Workspace, capture, run as run_command};

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
        let mut command = workspace.cargo();
        command.args(["test", "--doc", "--workspace"]);
        stages.time("examples in the documentation", || run_command(tested.announce(&mut command)))?;
    }
    if wanted(Part::Rust) {
        stages.time("Rust's tests", || run_command(tested.announce(&mut rust_tests(workspace))))?;
    }
    if wanted(Part::Python) {
        let mut command = workspace.command(tested.python.interpreter());
        command.args(["-m", "pytest", "tests/python", "-rs", "--timeout=300", "-p", "no:cacheprovider"]);
        stages.time("tests in Python", || run_command(tested.announce(&mut command)))?;
    }
    stages.print();
    print_skipped(&tested.skipped);
    Ok(())
}

/// nextest where it is installed, since it keeps a test that crashes from taking others along; else cargo's own test command.
fn rust_tests(workspace: &Workspace) -> Command {
    let mut command = workspace.cargo();
    if capture(workspace.cargo().args(["nextest", "--version"])).is_ok() {
        command.args(["nextest", "run", "--workspace", "--no-fail-fast"]);
    } else {
        command.args(["test", "--workspace", "--all-targets", "--no-fail-fast"]);
    }
    command
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
        let python = python::ensure(workspace)?;
        run_command(workspace.cargo().args([
            "build",
            "--package",
            "glidepolar",
            "--package",
            "glidepolar-tank",
            "--package",
            "glidepolar-virtual-sea",
            "--bins",
            "--example",
            "report",
        ]))?;
        let program = |name: &str| workspace.target("debug").join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
        let fmus = fmu::run(workspace, &[], fmu::Scope::Host)?;
        let wheel = wheel::build(workspace, wheel::Kind::Tests, &python, &fmus)?;
        let skipped = workspace.target("skipped-tests.txt");
        fs::write(&skipped, "").with_context(|| format!("cannot write {}", skipped.display()))?;
        let importers = importers::build(workspace, &skipped)?;
        Ok(Self {
            programs: vec![
                ("GLIDEPOLAR_COMMAND", program("glidepolar")),
                ("GLIDEPOLAR_TANK_REDUCE", program("tank-reduce")),
                ("GLIDEPOLAR_REPORT_EXAMPLE", program("examples/report")),
                ("GLIDEPOLAR_VIRTUAL_SEA", program("virtual-sea")),
            ],
            fmus,
            wheel,
            python,
            importers,
            skipped,
        })
    }

    /// Tells a command where everything is.
    fn announce<'c>(&self, command: &'c mut Command) -> &'c mut Command {
        command
            .envs(self.programs.iter().map(|(name, path)| (name, path)))
            .env("GLIDEPOLAR_FMU3", &self.fmus.fmi3)
            .env("GLIDEPOLAR_FMU2", &self.fmus.fmi2)
            .env("GLIDEPOLAR_FMU_LIBRARY", &self.fmus.library)
            .env("GLIDEPOLAR_WHEEL", &self.wheel)
            .env("GLIDEPOLAR_PYTHON", self.python.interpreter())
            .env("GLIDEPOLAR_IMPORTERS", &self.importers)
            .env("GLIDEPOLAR_SKIPPED", &self.skipped)
    }
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
