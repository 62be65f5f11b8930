//! A log against a vehicle, as a user asks for it: what is known of the lift slope, the trim that suits the vehicle, the
//! diagnosis, the extended vehicle. Commands, tests and benchmarks call the same functions. Knows no files.

use super::{DiagnosisSettings, Lift, SeaDiagnosis, SeaError, diagnose_log, stated_polar};
use crate::diagnose::{Point, Problem, Relevance};
use crate::dynamics::parameter_index;
use crate::identify::external_values::{built_up_lift_slope, held_lift_slope, is_any_slocum, is_fitted_better};
use crate::identify::{ExternalValue, Trim};
use crate::input::InputError;
use crate::log::Observation;
use crate::vehicle::Vehicle;

/// What is asked of a diagnosis.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Request {
    /// What the baseline takes for the net weight; none: what [suits the vehicle](Trim::for_vehicle).
    pub trim: Option<Trim>,
    /// What is known of the lift slope from outside; none: it is fitted where the data show it.
    pub lift_slope: Option<LiftSlope>,
    /// Which misfit is worth acting on.
    pub relevance: Relevance,
}

/// A lift slope that is not fitted \[1/rad\], on the frontal area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LiftSlope {
    /// The vehicle's, fixed.
    OfVehicle,
    /// This one: fixed, or with a standard error known as well as that.
    External(ExternalValue),
}

/// Why there is no diagnosis.
#[derive(Debug, thiserror::Error)]
pub enum VehicleLogError {
    /// A lift slope that the vehicle cannot have.
    #[error(transparent)]
    Vehicle(#[from] InputError),
    /// A log from which nothing follows.
    #[error(transparent)]
    Log(#[from] SeaError),
}

/// Diagnoses a log against a vehicle; returns the vehicle with the lift slope that was used as well.
///
/// Without measured speed nothing identifies the lift slope: that of a built-in Slocum is held where an identification holds
/// it, unless the log contradicts that value.
///
/// # Errors
/// Where the log contradicts itself beyond correction, too little of it can be used, or the lift slope is out of bounds.
pub fn diagnose_vehicle(
    vehicle: &Vehicle,
    observations: &[Observation],
    request: &Request,
) -> Result<(Vehicle, SeaDiagnosis), VehicleLogError> {
    let mut vehicle = vehicle.clone();
    let has_speed = observations.iter().any(|o| o.speed_m_s.is_finite());
    let mut warnings = Vec::new();
    let trim = request.trim.unwrap_or_else(|| Trim::for_vehicle(&vehicle));
    let lift = match request.lift_slope {
        Some(LiftSlope::OfVehicle) => Lift::Held,
        Some(LiftSlope::External(known)) => {
            set_lift_slope(&mut vehicle, known.value)?;
            known.se.map_or(Lift::Held, |se_per_rad| Lift::Known { se_per_rad })
        }
        None if !has_speed && is_any_slocum(&vehicle) => {
            warnings.extend(hold_the_slope_of_a_slocum(&mut vehicle, trim, observations)?);
            Lift::Held
        }
        None => Lift::Fitted,
    };
    let relevance = request.relevance.clone();
    let polar_se = stated_polar::errors(&vehicle);
    let settings = DiagnosisSettings { lift, polar_se, relevance, ..DiagnosisSettings::default() };
    let mut found = diagnose_log(&vehicle.glide_parameters(), trim, observations, settings)?;
    found.outcome.diagnosis.warnings.extend(warnings);
    found.turns = super::turns::add(&mut found.outcome.diagnosis, &vehicle, observations);
    Ok((vehicle, found))
}

/// Holds the lift slope of a built-in Slocum, which is no prior of the user's own glider: the vehicle's own, that of each leg, or that
/// of the build-up, which is that of a real one with its wings. Where the vehicle's trim is taken, so is its slope; where a trim is
/// assumed, that of the build-up. The other one is held where the log contradicts this one: what a wrong slope leaves would be blamed on
/// something else. Returns what to say of it.
fn hold_the_slope_of_a_slocum(
    vehicle: &mut Vehicle,
    trim: Trim,
    observations: &[Observation],
) -> Result<Vec<String>, InputError> {
    let held = held_lift_slope(vehicle, "--pin-lift=");
    let of_legs = vehicle.get("hydro.ascent.a_per_rad").map_or("", |_| ", on each leg at its own");
    let own =
        format!("no measured speed: the lift slope is held at {:.2} per rad{of_legs}: {}", held.value, held.source);
    let Some((slope, source)) = built_up_lift_slope(vehicle).filter(|_| held.warning.is_some()) else {
        return Ok(vec![own]);
    };
    let mut winged = vehicle.clone();
    set_lift_slope(&mut winged, slope.value)?;
    // Too little for a fit is said by the diagnosis itself.
    let is_better = |this: &Vehicle, other: &Vehicle| is_fitted_better([other, this], trim, observations);
    let (holds_own, why) = match trim {
        Trim::Vehicle => (!is_better(&winged, vehicle).unwrap_or(false), "the log is fitted better by"),
        Trim::Neutral => (is_better(vehicle, &winged).unwrap_or(true), "the log is fitted as well or better by"),
    };
    if holds_own {
        return Ok(std::iter::once(own).chain(held.warning).collect());
    }
    *vehicle = winged;
    Ok(vec![format!(
        "no measured speed: {why} a lift slope of {:.1} per rad than by the vehicle's own of {:.2}, and that one is held: {source}",
        slope.value, held.value
    )])
}

/// The vehicle with the polar that was fitted and the mechanisms that were named.
///
/// # Errors
/// Where a figure that was found is beyond the bounds of the vehicle file.
pub fn extended(vehicle: &Vehicle, found: &SeaDiagnosis) -> Result<Vehicle, InputError> {
    let mut vehicle = vehicle.clone();
    let parameters = vehicle.glide_parameters();
    // What the trim took for the mass belongs to the extended vehicle as well, or it would fly at another weight.
    let trimmed_kg = found.baseline.hull_mass_kg - parameters.hull_mass_kg;
    let polar: &Point = &found.outcome.after.point;
    for ((name, _), value) in found.problem.baseline().iter().zip(&polar.baseline) {
        // One polar is fitted, that of descents; where the legs were measured apart each keeps its ratio.
        let before = parameter_index(name).map_or(0.0, |index| *parameters.clone().at(index));
        let ratio = if before == 0.0 { f64::NAN } else { value / before };
        for key in ["hydro.", "hydro.descent.", "hydro.ascent."].map(|table| format!("{table}{name}")) {
            if let Some(known) = vehicle.get(&key) {
                vehicle.set(&key, if ratio.is_finite() { known * ratio } else { *value })?;
            }
        }
    }
    // A file that states the polar of descents alone has that of ascents in `hydro`.
    let ascent_b = vehicle.get("hydro.ascent.b").or_else(|| vehicle.get("hydro.b"));
    if let Some((of_legs, ascent_b)) = found.problem.ratio_of_legs_over_vehicles(polar).zip(ascent_b) {
        vehicle.set("hydro.ascent.b", ascent_b * of_legs)?;
    }
    if trimmed_kg != 0.0 {
        let mass = vehicle.get("mass.mass_kg").unwrap_or(0.0) + trimmed_kg;
        vehicle.set("mass.mass_kg", mass)?;
    }
    let trim_name = "ballast_offset_kg".to_owned();
    let trim = found.outcome.diagnosis.trim.as_ref().map(|trim| (&trim_name, trim));
    for (name, estimate) in found.outcome.diagnosis.causes.iter().flat_map(|cause| &cause.parameters).chain(trim) {
        if parameter_index(name).is_some() {
            vehicle.set(&format!("mechanisms.{name}"), estimate.value)?;
            if estimate.se > 0.0 {
                vehicle.set(&format!("uncertainty.mechanisms.{name}"), estimate.se)?;
            }
        }
    }
    super::turns::extend(&mut vehicle, &found.outcome.diagnosis.causes)?;
    for (name, value) in super::empirical::rows(&found.problem.parameters) {
        vehicle.set(&format!("mechanisms.{name}"), value)?;
    }
    Ok(vehicle)
}

/// Sets the lift slope, that of the legs as well where they were measured apart.
fn set_lift_slope(vehicle: &mut Vehicle, lift_per_rad: f64) -> Result<(), InputError> {
    vehicle.set("hydro.a_per_rad", lift_per_rad)?;
    for leg in ["hydro.descent.a_per_rad", "hydro.ascent.a_per_rad"] {
        if vehicle.get(leg).is_some() {
            vehicle.set(leg, lift_per_rad)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::sea::steady_log;
    use crate::dynamics::Parameters;

    /// A pod on a vehicle whose legs differ: the extended vehicle has the ratio of the legs that was found, whether its file states the
    /// polar of ascents or that of descents beside one of both.
    #[test]
    fn an_extended_vehicle_keeps_the_drag_in_common() {
        for (key, factor) in [("hydro.ascent.b", 0.8), ("hydro.descent.b", 1.25)] {
            let mut vehicle = Vehicle::load("slocum-graver").expect("a vehicle");
            let b = vehicle.get("hydro.b").expect("a polar");
            vehicle.set(key, b * factor).expect("within bounds");
            let parameters = vehicle.glide_parameters();
            let (descent, ascent) = (1.3 * parameters.b, parameters.b * (parameters.ascent_b_ratio + 0.3));
            let truth = Parameters { b: descent, ascent_b_ratio: ascent / descent, ..parameters };
            let settings = DiagnosisSettings::default();
            let found =
                diagnose_log(&parameters, Trim::Vehicle, &steady_log::log(&truth), settings).expect("a diagnosis");
            let flies = extended(&vehicle, &found).expect("a vehicle").glide_parameters();
            let fitted = found.problem.parameters_at(&found.outcome.after.point);
            assert!((flies.ascent_b_ratio / fitted.ascent_b_ratio - 1.0).abs() < 1e-9, "{key}: {flies:?}");
            assert!((flies.b / fitted.b - 1.0).abs() < 1e-9 && (fitted.b / descent - 1.0).abs() < 0.02, "{key}");
        }
    }
}
