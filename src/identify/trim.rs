//! What the baseline takes for the net weight, before any ballast offset.

use serde::Serialize;

use crate::dynamics::{Parameters, Surroundings};
use crate::log::{DBAR_PA, Observation};
use crate::vehicle::Vehicle;

/// Where the net weight of the baseline comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Trim {
    /// From the vehicle's mass and displaced volume.
    Vehicle,
    /// The tank paper's assumption: neutral at ballast volume zero in the mean water of the log.
    Neutral,
}

impl Trim {
    /// What suits a vehicle: a built-in one, which is not the user's own glider, is taken as neutral.
    pub fn for_vehicle(vehicle: &Vehicle) -> Trim {
        if vehicle.is_builtin { Trim::Neutral } else { Trim::Vehicle }
    }

    /// The baseline's parameters.
    ///
    /// `Neutral` sets the mass so that the net mass at ballast volume zero vanishes in the mean density, pressure and
    /// temperature of the steady samples; within that water `W - B = -rho g vbd`.
    pub fn baseline(self, vehicle: &Parameters<f64>, observations: &[Observation]) -> Parameters<f64> {
        let mut baseline = *vehicle;
        if let (Trim::Neutral, Some(water)) = (self, mean_water(vehicle, observations)) {
            baseline.hull_mass_kg -= baseline.net_mass_kg(0.0, &water);
        }
        baseline
    }

    /// The baseline in a sentence.
    pub fn sentence(self) -> &'static str {
        match self {
            Trim::Vehicle => "net weight from the vehicle's mass and displaced volume",
            Trim::Neutral => {
                "neutral at ballast volume zero in the mean water of the log (the tank paper's assumption)"
            }
        }
    }
}

/// The mean water of the steady samples.
fn mean_water(vehicle: &Parameters<f64>, observations: &[Observation]) -> Option<Surroundings<f64>> {
    let steady = || observations.iter().filter(|o| o.steady);
    let mean = |value: fn(&Observation) -> f64| {
        let (n, sum) = steady().map(value).filter(|v| v.is_finite()).fold((0, 0.0), |(n, sum), v| (n + 1, sum + v));
        (n > 0).then(|| sum / f64::from(n))
    };
    Some(Surroundings {
        density_kg_m3: mean(|o| o.density_kg_m3)?,
        pressure_Pa: mean(|o| o.pressure_dbar).unwrap_or(0.0) * DBAR_PA,
        temperature_C: mean(|o| o.temperature_C).unwrap_or(vehicle.reference_temperature_C),
        time_s: 0.0,
    })
}
