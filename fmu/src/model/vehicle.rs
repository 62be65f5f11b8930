//! What an instance starts from: the vehicle that travels with it, or the default one.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use glidepolar_dynamics::{Actuation, Parameters};
use glidepolar_environment::{WaterAt, WaterColumn};
use glidepolar_fmu_resources::token::resources_hash;
use glidepolar_spatial::steering::with_gains;
use glidepolar_spatial::{Body, RateLaw, Steering};
use glidepolar_vehicle::builtin;

use super::glider::{DiscreteState, Glider};
use super::rules::Corners;
use super::values::Values;
use super::which::Model;
use super::{plane, space};

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
    fn default() -> Self {
        Vehicle::built_in(Model::Plane)
    }
}

impl Vehicle {
    /// The built-in SLOCUM-like vehicle. Its text is read once in a process: systems of many instances are common.
    pub fn built_in(model: Model) -> Self {
        static PLANE: OnceLock<Vehicle> = OnceLock::new();
        static SPACE: OnceLock<Vehicle> = OnceLock::new();
        let read = || {
            let text = builtin::text(DEFAULT_VEHICLE).expect("the default vehicle is built in");
            Vehicle::parse(model, text, DEFAULT_VEHICLE).expect("a built-in vehicle is complete")
        };
        match model {
            Model::Plane => PLANE.get_or_init(read).clone(),
            Model::Space => SPACE.get_or_init(read).clone(),
        }
    }

    /// The vehicle of a vehicle file's text as this model flies it; `origin` is what errors name.
    ///
    /// # Errors
    /// What is wrong with the text, where, and what to do.
    pub fn parse(model: Model, text: &str, origin: impl AsRef<Path>) -> Result<Self, String> {
        let file = glidepolar_vehicle::Vehicle::parse(text, origin.as_ref()).map_err(|error| error.to_string())?;
        let (values, rate_law) = match model {
            Model::Plane => {
                let parameters = file.parameters().map_err(|error| error.to_string())?;
                (plane::start(&parameters, |_| reference_water(&parameters)), RateLaw::default())
            }
            Model::Space => {
                let body = with_gains(&file.body().map_err(|error| error.to_string())?);
                (space::start(&body, |_| reference_water(&body.plane)), body.rate_law)
            }
        };
        let mut glider = Glider {
            model,
            values,
            actuation: Actuation::Servo,
            steering: Steering::Direct,
            rate_law,
            discrete: DiscreteState::default(),
            corners: Corners::default(),
            column: None,
            uses_column: false,
            starts_in_trim: false,
        };
        glider.complete_start();
        Ok(Vehicle { name: file.name.clone(), glider, resources: resources_hash(text, None) })
    }

    /// The same vehicle in the water of this column: the start is steady in the water at its depth.
    pub fn in_water(self, column: WaterColumn) -> Self {
        let mut glider = self.glider;
        let water = |depth_m| column.at(depth_m);
        let Values { state, inputs, .. } = match glider.model {
            Model::Plane => plane::start(&glider.parameters(), water),
            Model::Space => {
                let body: Body<f64> = glider.rules().body(&glider.values.parameters);
                space::start(&Body { plane: glider.parameters(), ..body }, water)
            }
        };
        (glider.values.state, glider.values.inputs) = (state, inputs);
        (glider.column, glider.uses_column) = (Some(Arc::new(column)), true);
        glider.complete_start();
        Vehicle { glider, ..self }
    }
}

fn reference_water(parameters: &Parameters<f64>) -> WaterAt<f64> {
    WaterAt { density_kg_m3: parameters.reference_density_kg_m3, temperature_C: parameters.reference_temperature_C }
}
