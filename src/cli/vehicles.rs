//! `glidepolar vehicles`: the built-in vehicles, and the keys of a vehicle file.

use clap::Args;

use super::CliError;
use crate::dynamics::{PARAMETERS, parameter_index};
use crate::mechanisms;
use crate::vehicle::keys::{KEYS, Need};
use crate::vehicle::{Vehicle, builtin};

/// List the built-in vehicles, print one as a file to start from, or list the keys
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    glidepolar vehicles\n  \
    glidepolar vehicles slocum-graver > my-glider.toml\n  \
    glidepolar vehicles --keys")]
pub struct Arguments {
    /// Print this built-in vehicle's file
    name: Option<String>,
    /// List every key of a vehicle file with its unit, what it is and whether it is needed
    #[arg(long)]
    keys: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    if arguments.keys {
        print_keys();
        return Ok(());
    }
    match &arguments.name {
        None => {
            for name in builtin::NAMES {
                println!("{name:<15} {}", Vehicle::load(name)?.name);
            }
            Ok(())
        }
        Some(name) => match builtin::text(name) {
            Some(text) => {
                print!("{text}");
                Ok(())
            }
            None => Err(CliError::Usage(format!(
                "no built-in vehicle is called {}; there are: {}",
                crate::input::printable(name),
                builtin::NAMES.join(", ")
            ))),
        },
    }
}

fn print_keys() {
    for key in KEYS {
        let need = match key.need {
            Need::Always(purpose) => format!("needed: {purpose}"),
            Need::ForMotion(purpose) => format!("needed for time histories: {purpose}"),
            Need::ForTurns(purpose) => format!("needed for turns: {purpose}"),
            Need::Default(value) => format!("default {value}"),
            Need::Optional => "optional".to_owned(),
        };
        println!("{:<36} [{}]  {} ({need})", key.path, key.unit, key.meaning);
    }
    for (path, meaning) in [
        (
            "lateral.rate_law",
            "\"V\" (default) or \"V2\": forces by a rate grow with the speed or with its square; then CY_r, CN_r, Cl_p, Cl_r, CN_p are in s",
        ),
        (
            "moving_mass.inertia_kg_m2",
            "[x, y, z]: moments of inertia of the moving mass about its own centre [kg.m2] (optional)",
        ),
    ] {
        println!("{path:<36} {meaning}");
    }
    for name in mechanisms::vehicle_parameters() {
        if let Some(row) = parameter_index(name).map(|index| PARAMETERS[index]) {
            let path = format!("mechanisms.{name}");
            println!("{path:<36} [{}]  {} (without effect at {})", row.unit, row.meaning, row.default);
        }
    }
}
