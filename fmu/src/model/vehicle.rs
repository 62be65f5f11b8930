//! What an instance starts from: the vehicle that travels with it, or the default one.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use glidepolar_dynamics::glide::{start, start_in};
use glidepolar_dynamics::{Actuation, Parameters};
use glidepolar_environment::WaterColumn;
use glidepolar_fmu_resources::token::resources_hash;
use glidepolar_vehicle::builtin;

use super::glider::{DiscreteState, Glider, Values};

/// The vehicle when none travels with the instance.
pub const DEFAULT_VEHICLE: &str = "slocum-graver";

/// A vehicle ready to start.
#[derive(Debug, Clone)]
pub struct Vehicle {
    /// What it is called.
    pub name: String,
    /// The glider at the start of a simulation.
    pub glider: Glider,
    /// What tells the files that it was read from, vehicle and water, from others.
    pub resources: u64,
}

impl Default for Vehicle {
    /// The built-in SLOCUM-like vehicle. Its text is read once in a process: systems of many instances are common.
    fn default() -> Self {
        static BUILT_IN: OnceLock<Vehicle> = OnceLock::new();
        let read = || {
            let text = builtin::text(DEFAULT_VEHICLE).expect("the default vehicle is built in");
            Vehicle::parse(text, DEFAULT_VEHICLE).expect("a built-in vehicle is complete")
        };
        BUILT_IN.get_or_init(read).clone()
    }
}

impl Vehicle {
    /// The vehicle of a vehicle file's text; `origin` is what errors name.
    ///
    /// # Errors
    /// What is wrong with the text, where, and what to do.
    pub fn parse(text: &str, origin: impl AsRef<Path>) -> Result<Self, String> {
        let file = glidepolar_vehicle::Vehicle::parse(text, origin.as_ref()).map_err(|error| error.to_string())?;
        let parameters = file.parameters().map_err(|error| error.to_string())?;
        Ok(Vehicle { resources: resources_hash(text, None), ..Vehicle::new(&file.name, parameters) })
    }

    /// The vehicle with these parameters, in the library's start.
    fn new(name: &str, parameters: Parameters<f64>) -> Self {
        let start = start(&parameters);
        let values = Values { parameters, time_s: 0.0, state: start.state, inputs: start.inputs };
        let discrete = DiscreteState::default();
        let mut glider = Glider {
            values,
            actuation: Actuation::Servo,
            discrete,
            column: None,
            uses_column: false,
            starts_in_trim: false,
        };
        glider.complete_start();
        Vehicle { name: name.to_owned(), glider, resources: 0 }
    }

    /// The same vehicle in the water of this column: the start is steady in the water at its depth.
    pub fn in_water(self, column: WaterColumn) -> Self {
        let mut glider = self.glider;
        let start = start_in(&glider.values.parameters, |depth_m| column.at(depth_m));
        (glider.values.state, glider.values.inputs) = (start.state, start.inputs);
        (glider.column, glider.uses_column) = (Some(Arc::new(column)), true);
        glider.complete_start();
        Vehicle { glider, ..self }
    }
}
