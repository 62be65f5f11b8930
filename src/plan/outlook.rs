//! The plan with its intervals: every uncertain figure of the vehicle carried through, and the model's own error.
//!
//! Linear propagation: each figure with a standard error in the vehicle file moves the plan by half the difference
//! between one standard error up and one down; independent figures add in squares. The model error is one more such
//! figure, a factor on the energy of a dive; the speed of a polar whose errors nobody stated is another.

use super::{Dive, PerDive, per_dive};
use crate::assemble::Sensor;
use crate::estimate::Estimate;
use crate::glide::GlideError;
use crate::vehicle::{MissingKeys, Vehicle};

/// What is asked of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Ask {
    /// The dive that is repeated.
    pub dive: Dive,
    /// Energy of the battery \[J\].
    pub battery_J: f64,
    /// End of the voyage \[d\]; none: when the battery is empty.
    pub days: Option<f64>,
    /// Relative standard error of the energy of a dive that the model itself makes.
    pub model_error: f64,
    /// A sensor added outside.
    pub sensor: Sensor,
}

/// The plan.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[allow(missing_docs, reason = "units and quantities stand in the names")]
pub struct Outlook {
    pub dive_duration_h: Estimate,
    pub dive_distance_km: Estimate,
    pub dive_pump_kJ: Estimate,
    pub dive_hotel_kJ: Estimate,
    pub dive_steering_kJ: Estimate,
    pub dive_surfacing_kJ: Estimate,
    pub dive_energy_kJ: Estimate,
    pub days: Estimate,
    pub dives: Estimate,
    pub pumpings: Estimate,
    /// Through the water: currents come on top.
    pub distance_km: Estimate,
    pub energy_Wh: Estimate,
    pub battery_left_Wh: Estimate,
    pub battery_left_percent: Estimate,
}

/// Why there is no plan.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The vehicle lacks what a plan needs.
    #[error(transparent)]
    MissingKeys(#[from] MissingKeys),
    /// A leg cannot be flown.
    #[error("{0}; change --pitch-deg or the ballast of the dive")]
    Glide(#[from] GlideError),
    /// Nothing draws on the battery.
    #[error("nothing draws on the battery: set `energy.hotel_W` and the pump's figures in the vehicle file")]
    NoConsumption,
}

const N: usize = 14;
const UNITS: [&str; N] = ["h", "km", "kJ", "kJ", "kJ", "kJ", "kJ", "d", "1", "1", "km", "W.h", "W.h", "%"];

/// The plan for a vehicle.
///
/// # Errors
/// Where a leg cannot be flown, or nothing draws on the battery.
pub fn outlook(vehicle: &Vehicle, ask: &Ask) -> Result<Outlook, PlanError> {
    let centre = quantities(vehicle, ask, 1.0, 1.0)?;
    let mut variance = [0.0; N];
    let mut add = |up: [f64; N], down: [f64; N]| {
        for (variance, (up, down)) in variance.iter_mut().zip(up.into_iter().zip(down)) {
            *variance += (0.5 * (up - down)).powi(2);
        }
    };
    for (path, &se) in &vehicle.uncertainty {
        let Some(value) = vehicle.get(path).filter(|_| se > 0.0) else {
            continue;
        };
        let moved = |by: f64| {
            let mut vehicle = vehicle.clone();
            // A key with an uncertainty is a key; the value stays what it was where it is not.
            let _ = vehicle.set(path, value + by);
            quantities(&vehicle, ask, 1.0, 1.0)
        };
        add(moved(se)?, moved(-se)?);
    }
    let of_energy = |factor| quantities(vehicle, ask, factor, 1.0);
    add(of_energy(1.0 + ask.model_error)?, of_energy(1.0 - ask.model_error)?);
    if !states_polar_errors(vehicle) {
        let of_speed = |factor| quantities(vehicle, ask, 1.0, factor);
        add(of_speed(1.0 + UNSTATED_SPEED_ERROR)?, of_speed(1.0 - UNSTATED_SPEED_ERROR)?);
    }
    let [d0, d1, d2, d3, d4, d5, d6, days, dives, pumpings, distance, energy, left, percent] =
        std::array::from_fn(|i| Estimate::normal(centre[i], variance[i].sqrt(), UNITS[i]));
    Ok(Outlook {
        dive_duration_h: d0,
        dive_distance_km: d1,
        dive_pump_kJ: d2,
        dive_hotel_kJ: d3,
        dive_steering_kJ: d4,
        dive_surfacing_kJ: d5,
        dive_energy_kJ: d6,
        days,
        dives,
        pumpings,
        distance_km: distance,
        energy_Wh: energy,
        battery_left_Wh: left,
        battery_left_percent: percent,
    })
}

/// Error of the speed of a polar whose errors are not stated, relative: by so much two flight models of one Seaglider, both
/// fitted to its vertical velocity, differ in speed.
pub const UNSTATED_SPEED_ERROR: f64 = 0.1;

/// Whether the vehicle states errors of its lift and drag.
pub fn states_polar_errors(vehicle: &Vehicle) -> bool {
    vehicle.uncertainty.keys().any(|path| path.starts_with("hydro."))
}

fn quantities(vehicle: &Vehicle, ask: &Ask, energy_factor: f64, speed_factor: f64) -> Result<[f64; N], PlanError> {
    let mut parameters = ask.sensor.carried_by(&vehicle.parameters()?);
    // Forces go with area and the square of speed: the same glides, faster by the factor.
    parameters.frontal_area_m2 /= speed_factor * speed_factor;
    let one: PerDive = per_dive(&parameters, &ask.dive)?;
    let energy_J = one.energy.total_J() * energy_factor;
    if energy_J <= 0.0 {
        return Err(PlanError::NoConsumption);
    }
    let until_empty = ask.battery_J / energy_J;
    let dives = ask.days.map_or(until_empty, |days| (days * DAY_S / one.duration_s).min(until_empty));
    // Nothing at all of a battery that is used up, without the last digits of a difference.
    let left_J = (until_empty - dives) * energy_J;
    Ok([
        one.duration_s / HOUR_S,
        one.distance_m / 1e3,
        one.energy.pump_J * energy_factor / 1e3,
        one.energy.hotel_J * energy_factor / 1e3,
        one.energy.steering_J * energy_factor / 1e3,
        one.energy.surfacing_J * energy_factor / 1e3,
        energy_J / 1e3,
        dives * one.duration_s / DAY_S,
        dives,
        dives * one.pumpings,
        dives * one.distance_m / 1e3,
        dives * energy_J / HOUR_S,
        left_J / HOUR_S,
        100.0 * left_J / ask.battery_J,
    ])
}

const HOUR_S: f64 = 3600.0;
const DAY_S: f64 = 86_400.0;
