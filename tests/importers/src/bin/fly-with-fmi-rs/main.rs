//! Flies an FMU with `fmi-rs`, the importer by the makers of FMPy, after it has validated the model description.

mod runge_kutta;

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result, bail};
use clap::Parser;
use fmi_rs::fmi3::LibraryKind;
use fmi_rs::model_description::{FMIMajorVersion, ValidationError, peek_fmi_major_version};
use fmi_rs::zip::extract_zip_archive;
use glidepolar_importers::{Flight, Interface};
use runge_kutta::RungeKuttaFactory;

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    flight: Flight,
    /// Step of the Runge-Kutta method in Model Exchange, s
    #[arg(long, default_value_t = 0.01)]
    step: f64,
    /// Let the FMU call back during the steps of FMI 3.0 Co-Simulation
    #[arg(long)]
    intermediate_update: bool,
    /// Continue from an FMU state that another run saved
    #[arg(long)]
    load_state: Option<PathBuf>,
    /// Save the FMU's state at the end
    #[arg(long)]
    save_state: Option<PathBuf>,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let folder = tempfile::tempdir()?;
    extract_zip_archive(&arguments.flight.fmu, folder.path())?;
    match peek_fmi_major_version(&folder.path().join("modelDescription.xml"))? {
        FMIMajorVersion::V2 => fly_fmi2(&arguments, folder.path()),
        FMIMajorVersion::V3 => fly_fmi3(&arguments, folder.path()),
    }
}

/// A function that flies an FMU of one version. `fmi-rs` has a module for each, with the same names in both.
macro_rules! flies {
    ($function:ident, $version:ident, |$arguments:ident| { $($setting:ident: $value:expr,)* }) => {
        fn $function($arguments: &Arguments, folder: &Path) -> Result<()> {
            use fmi_rs::model_description::$version::{Causality, ModelDescription};
            use fmi_rs::sim::$version::input::StaticInput;
            use fmi_rs::sim::$version::recorder::Recorder;
            use fmi_rs::sim::$version::{SimulationSettings, Trajectories, cs, csv, me};

            let flight = &$arguments.flight;
            let description = Arc::new(ModelDescription::from_path(&folder.join("modelDescription.xml"))?);
            refuse(description.validate())?;
            let settings = SimulationSettings {
                unzipdir: folder.to_owned(),
                model_description: description.clone(),
                start_time: flight.start_time,
                stop_time: flight.stop_time,
                logging_on: true,
                // An FMU may refuse to go beyond it, also when it goes on from a saved state.
                set_stop_time: $arguments.save_state.is_none(),
                output_interval: flight.output_interval,
                log_time_scale: false,
                tolerance: flight.tolerance,
                set_tolerance: true,
                start_values: start_values(flight)?,
                log_fmi_calls: false,
                input_file: flight.input.clone(),
                early_return_allowed: flight.early_return,
                event_mode_used: flight.event_mode,
                log_file: None,
                initial_fmu_state_file: $arguments.load_state.clone(),
                final_fmu_state_file: $arguments.save_state.clone(),
                $($setting: $value,)*
            };
            let input = match &flight.input {
                Some(path) => {
                    let file = File::open(path).with_context(|| format!("cannot open {}", path.display()))?;
                    let trajectories = csv::read_csv(file, description.clone())?;
                    Some(Arc::new(StaticInput::new(trajectories, flight.tolerance)))
                }
                None => None,
            };
            let outputs = (0..description.modelVariables.len())
                .filter(|index| description.modelVariables[*index].causality == Causality::Output)
                .collect();
            let recorder = Arc::new(Recorder::new(Trajectories::new(description, outputs)));
            let solver = RungeKuttaFactory { step: $arguments.step };
            match flight.interface {
                Interface::Cs => cs::simulate(&settings, input, recorder.clone())?,
                Interface::Me => me::simulate(&settings, &solver, input, recorder.clone())?,
            }
            csv::write_csv(&recorder.trajectories.borrow(), &flight.output).context("cannot write the trajectory")
        }
    };
}

flies!(fly_fmi2, fmi2, |arguments| {});
flies!(fly_fmi3, fmi3, |arguments| {
    library_kind: LibraryKind::Native,
    enable_dae: false,
    visible: false,
    intermediate_update: arguments.intermediate_update,
});

fn refuse(problems: Vec<ValidationError>) -> Result<()> {
    if problems.is_empty() {
        return Ok(());
    }
    let problems: Vec<_> = problems.into_iter().map(|problem| problem.message).collect();
    bail!("the model description is not valid:\n  {}", problems.join("\n  "));
}

fn start_values(flight: &Flight) -> Result<Vec<(String, String)>> {
    let split = |pair: &String| {
        let (name, value) = pair.split_once('=').with_context(|| format!("--start {pair}: expected NAME=VALUE"))?;
        Ok((name.to_owned(), value.to_owned()))
    };
    flight.start_values.iter().map(split).collect()
}
