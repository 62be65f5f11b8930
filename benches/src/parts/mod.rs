//! The parts of the bench, one module each, and their run in order.

mod diagnose;
mod ensembles;
mod fleet;
mod floor;
mod fmu;
mod growth;
mod identify;
mod logs;
mod tank;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context as _, Result, ensure};

use crate::arguments::{Choice, PartName, Run};
use crate::contest::Samples;
use crate::fmi::{self, Fmu, FmuGlider, Standard};
use crate::machine::Machine;
use crate::page;
use crate::report::{Part, Row, Unit};

/// What every part is given.
pub struct Context<'a> {
    pub choice: Choice,
    run: &'a Run,
}

type Measure = fn(&Context<'_>) -> Result<Part>;

const PARTS: [(PartName, &str, Measure); 8] = [
    (PartName::Fmu, "The FMU", fmu::measure),
    (PartName::Identify, "Identification", identify::measure),
    (PartName::Diagnose, "Diagnosis", diagnose::measure),
    (PartName::Logs, "Reading logs", logs::measure),
    (PartName::Tank, "Hull tests", tank::measure),
    (PartName::Ensembles, "Ensembles", ensembles::measure),
    (PartName::Fleet, "A fleet-year", fleet::measure),
    (PartName::Growth, "Growth", growth::measure),
];

/// Runs what was chosen, prints each table as it comes, writes the page.
pub fn run_all(run: &Run) -> Result<()> {
    std::fs::create_dir_all(&run.work).with_context(|| format!("cannot make {}", run.work.display()))?;
    let context = Context { choice: run.choice.clone(), run };
    let machine = Machine::look(run.python.as_deref());
    let (mut parts, mut lost) = (Vec::new(), Vec::new());
    for (name, heading, measure) in PARTS {
        if !run.choice.only.is_empty() && !run.choice.only.contains(&name) {
            continue;
        }
        eprintln!("measuring: {heading}");
        let begin = Instant::now();
        let measured = catch_unwind(AssertUnwindSafe(|| measure(&context)));
        let measured =
            measured.unwrap_or_else(|_| Err(anyhow::anyhow!("it panicked; the message stands above the table")));
        let mut part = measured.unwrap_or_else(|error| {
            lost.push(heading);
            failed(heading, error)
        });
        part.seconds = begin.elapsed().as_secs_f64();
        println!("{}", page::console(&part));
        parts.push(part);
    }
    page::write(run, &machine, &parts)?;
    // A short run is there to say whether everything runs.
    ensure!(lost.is_empty() || !run.choice.quick, "not measured: {}", lost.join(", "));
    Ok(())
}

/// A part that could not be measured at all.
fn failed(heading: &str, error: anyhow::Error) -> Part {
    let mut part = Part::new(heading, "");
    part.row(Row::new("the whole part", Unit::Seconds, Err::<Samples, _>(error)));
    part
}

impl Context<'_> {
    pub fn root(&self) -> &std::path::Path {
        &self.run.root
    }

    pub fn python(&self) -> Option<&std::path::Path> {
        self.run.python.as_deref()
    }

    /// A path for what is made on the way.
    pub fn work(&self, name: &str) -> PathBuf {
        self.run.work.join(name)
    }

    pub fn command(&self) -> Result<&std::path::Path> {
        self.run.command.as_deref().context("the command `glidepolar` was not built")
    }

    pub fn library(&self) -> Result<&std::path::Path> {
        self.run.library.as_deref().context("the FMU's library was not built")
    }

    pub fn fmu(&self, standard: Standard) -> Result<&std::path::Path> {
        let archive = match standard {
            Standard::Fmi2 => &self.run.fmu2,
            Standard::Fmi3 => &self.run.fmu3,
        };
        archive.as_deref().context("the FMU was not packed")
    }

    pub fn glider(&self, standard: Standard) -> Result<FmuGlider> {
        FmuGlider::load(self.root(), self.library()?, standard)
    }

    /// The same library as the glider in space.
    pub fn in_space(&self, standard: Standard) -> Result<(Fmu, usize)> {
        fmi::in_space(self.root(), self.library()?, standard)
    }
}
