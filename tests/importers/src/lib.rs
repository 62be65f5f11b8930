//! What the two importers share: what to fly, as the command line says it.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// Which of the FMU's two interfaces to use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Interface {
    /// Co-Simulation: the FMU integrates
    Cs,
    /// Model Exchange: the importer integrates
    Me,
}

/// One flight.
#[derive(Debug, Args)]
pub struct Flight {
    /// The FMU, of FMI 2.0 or 3.0
    pub fmu: PathBuf,
    /// The trajectory: a CSV file with the time and every output of the FMU
    pub output: PathBuf,
    #[arg(long, value_enum, default_value = "cs")]
    pub interface: Interface,
    /// Time to start at, s
    #[arg(long, default_value_t = 0.0)]
    pub start_time: f64,
    /// Time to stop at, s
    #[arg(long)]
    pub stop_time: f64,
    /// Time between two rows, s; in Co-Simulation also the communication step
    #[arg(long)]
    pub output_interval: f64,
    /// Relative tolerance handed to the FMU
    #[arg(long, default_value_t = 1e-8)]
    pub tolerance: f64,
    /// A start value, NAME=VALUE
    #[arg(long = "start", value_name = "NAME=VALUE")]
    pub start_values: Vec<String>,
    /// Inputs over time: a CSV file with a column `time` first and one column per input
    #[arg(long)]
    pub input: Option<PathBuf>,
    /// Use the event mode of FMI 3.0 Co-Simulation
    #[arg(long)]
    pub event_mode: bool,
    /// Allow the FMU to return early from a step of FMI 3.0 Co-Simulation
    #[arg(long)]
    pub early_return: bool,
}
