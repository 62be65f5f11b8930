//! What is to be measured, with what, and how long it may take.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

#[derive(Parser)]
#[command(name = "glidepolar-bench")]
pub struct Arguments {
    #[command(subcommand)]
    pub task: Task,
}

#[derive(Subcommand)]
pub enum Task {
    /// Measure, print the table, write the page
    Run(Box<Run>),
    /// One job in a process of its own, for its memory or its instructions; the result is one line of JSON
    Work(Work),
}

/// Where everything is that a measurement needs. What is missing is said in the rows that would need it.
#[derive(Args)]
pub struct Run {
    #[command(flatten)]
    pub choice: Choice,
    /// The checkout
    #[arg(long)]
    pub root: PathBuf,
    /// The FMI 3 archive
    #[arg(long)]
    pub fmu3: Option<PathBuf>,
    /// The FMI 2 archive
    #[arg(long)]
    pub fmu2: Option<PathBuf>,
    /// The shared library that is in both
    #[arg(long)]
    pub library: Option<PathBuf>,
    /// The command `glidepolar`
    #[arg(long)]
    pub command: Option<PathBuf>,
    /// The Python that has the other programs
    #[arg(long)]
    pub python: Option<PathBuf>,
    /// Folder for what is made on the way
    #[arg(long)]
    pub work: PathBuf,
}

/// How much of it.
#[derive(Args, Clone)]
pub struct Choice {
    /// Few rounds, small sizes: whether everything runs, not how fast
    #[arg(long)]
    pub quick: bool,
    /// The large sizes, too: 1 GB, 100,000 missions, a whole fleet-year, the peer's slow calibration to its end
    #[arg(long, conflicts_with = "quick")]
    pub full: bool,
    /// Only these parts
    #[arg(long, value_enum, value_delimiter = ',')]
    pub only: Vec<PartName>,
}

/// One part of the bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PartName {
    /// doStep, right-hand side, voyage, instantiate and free
    Fmu,
    /// Fits on real logs
    Identify,
    /// The whole diagnosis
    Diagnose,
    /// Glider files of all three makers
    Logs,
    /// Hull tests: reduction of a campaign
    Tank,
    /// Many missions on one and two cores
    Ensembles,
    /// A hundred gliders for a year
    Fleet,
    /// Time and memory against size
    Growth,
}

/// A size for each of the three ways to run.
#[derive(Debug, Clone, Copy)]
pub struct Sized<T> {
    pub quick: T,
    pub standard: T,
    pub full: T,
}

impl Choice {
    /// The size that belongs to this choice.
    pub fn size<T: Copy>(&self, sizes: Sized<T>) -> T {
        match (self.quick, self.full) {
            (true, _) => sizes.quick,
            (_, true) => sizes.full,
            _ => sizes.standard,
        }
    }

    /// Rounds in which all contenders take their turn.
    pub fn rounds(&self) -> usize {
        self.size(Sized { quick: 0, standard: 7, full: 11 })
    }

    /// Whether this is the run that the page is written from.
    pub fn is_whole(&self) -> bool {
        !self.quick && self.only.is_empty()
    }
}

/// A job for [`crate::workers`].
#[derive(Args)]
pub struct Work {
    /// Which
    #[arg(value_enum)]
    pub job: Job,
    /// How much of it
    #[arg(long, default_value_t = 1)]
    pub n: usize,
    /// What it works on
    #[arg(long)]
    pub on: Vec<PathBuf>,
}

/// Which job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Job {
    /// The csv crate's bare parse of a campaign's columns
    CsvParse,
    /// The reduction of the same campaign
    TankReduce,
    /// A fit of n samples, made from a log repeated
    Fit,
    /// n instances of the FMU alive at once
    Instances,
    /// n right-hand sides of the FMU as an importer calls them
    Rates3,
    /// The same through FMI 2
    Rates2,
    /// n communication steps of one second
    Steps3,
    /// The same through FMI 2
    Steps2,
    /// n right-hand sides in the library itself
    RightHandSide,
}
