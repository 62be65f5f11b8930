//! Flies an FMU with the `fmi` crate, by way of its simulator `fmi-sim`. In Model Exchange that integrates by the
//! forward Euler method with the output interval as its step.

use std::fs::File;

use anyhow::{Context, Result};
use arrow::csv::WriterBuilder;
use clap::Parser;
use fmi_sim::options::{CoSimulationOptions, CommonOptions, FmiSimOptions, ModelExchangeOptions};
use glidepolar_importers::{Flight, Interface};

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    flight: Flight,
}

fn main() -> Result<()> {
    let flight = Arguments::parse().flight;
    let common = CommonOptions {
        initial_values: flight.start_values,
        output_interval: Some(flight.output_interval),
        start_time: Some(flight.start_time),
        stop_time: Some(flight.stop_time),
        tolerance: Some(flight.tolerance),
        ..CommonOptions::default()
    };
    let interface = match flight.interface {
        Interface::Cs => fmi_sim::options::Interface::CoSimulation(CoSimulationOptions {
            common,
            event_mode_used: flight.event_mode,
            early_return_allowed: flight.early_return,
        }),
        Interface::Me => fmi_sim::options::Interface::ModelExchange(ModelExchangeOptions {
            common,
            ..ModelExchangeOptions::default()
        }),
    };
    let options = FmiSimOptions {
        interface,
        model: flight.fmu,
        input_file: flight.input,
        separator: ',',
        ..FmiSimOptions::default()
    };
    let (trajectory, _) = fmi_sim::simulate(&options)?;
    let file = File::create(&flight.output).context("cannot write the trajectory")?;
    WriterBuilder::new().with_header(true).build(file).write(&trajectory)?;
    Ok(())
}
