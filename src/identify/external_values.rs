//! What is known from outside the log: values of what is held, their errors, and where both come from.
//!
//! A vehicle's `[uncertainty]` says it; where it is silent, the error of an estimated coefficient. What the result refers
//! to (masses, volumes, areas, the trim) is exact here: a coefficient is one on the stated area, a ballast offset one
//! from the stated trim.

use std::collections::BTreeMap;

use serde::Serialize;

use super::considered::Considered;
use super::data::by_dive;
use super::evaluate::Scatter;
use super::joint::{IdentifyError, Question, fit};
use super::names::{long_name, short_name};
use super::trim::Trim;
use crate::assemble::{Figure, wing_lift_slope_per_rad};
use crate::dynamics::{PARAMETERS, Parameters, parameter_index};
use crate::log::Observation;
use crate::vehicle::Vehicle;

/// A value that is known from outside the log, as a user gives it: `21` or `21+-3`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExternalValue {
    /// The value.
    pub value: f64,
    /// Its standard error; without one it is taken for exact.
    pub se: Option<f64>,
}

impl ExternalValue {
    /// Reads `VALUE` or `VALUE+-SE`; none where they are no numbers, or the error is not positive.
    pub fn parse(text: &str) -> Option<Self> {
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|value| value.is_finite());
        let (value, se) = match text.split_once("+-") {
            Some((value, se)) => (value, Some(number(se).filter(|se| *se > 0.0)?)),
            None => (text, None),
        };
        Some(ExternalValue { value: number(value)?, se })
    }
}

/// A parameter that was held, at what, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pin {
    /// Its value.
    pub value: f64,
    /// Standard error of that value; none where nobody stated one, and then the others' errors know nothing of it.
    pub se: Option<f64>,
    /// Where the value, and its error, come from.
    pub source: String,
    /// Why it is not fitted.
    pub reason: String,
    /// By how much the fitted parameters move, by short name, where it is larger by one standard error.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub moves: BTreeMap<String, f64>,
}

impl Pin {
    /// A pin of which it is not known yet what it does to the others.
    pub fn new(value: f64, se: Option<f64>, source: String, reason: String) -> Self {
        Pin { value, se, source, reason, moves: BTreeMap::new() }
    }
}

/// What the build-up says of the lift slope of a built-in vehicle \[1/rad\], with its standard error and source: a built-in
/// Slocum stands for any Slocum, wings and all, where the slopes in its file are those of a paper's tank hull or model.
pub fn built_up_lift_slope(vehicle: &Vehicle) -> Option<(Figure, &'static str)> {
    is_any_slocum(vehicle).then(|| {
        let source = "build-up of a winged Slocum: wing of aspect ratio 7 swept by 43 deg, hull 3.8 per rad on 0.1 m2";
        (slocum_lift_slope_per_rad(vehicle.glide_parameters().frontal_area_m2), source)
    })
}

/// What is held of the lift slope where the log does not identify it, in an identification and in a diagnosis alike.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldLiftSlope {
    /// The vehicle's own slope, and where its error comes from. Where its legs were measured apart, each keeps its own beside
    /// it.
    pub value: f64,
    /// Its standard error; none where nobody stated one.
    pub se: Option<f64>,
    /// Where both come from.
    pub source: String,
    /// What to say where the vehicle is a built-in Slocum and its slope is not that of a real one with its wings.
    pub warning: Option<String>,
}

/// The lift slope that is held for this vehicle where vertical velocity is all that was measured: the vehicle's own. `option` is
/// the one of the command that holds another.
pub fn held_lift_slope(vehicle: &Vehicle, option: &str) -> HeldLiftSlope {
    let (value, se, source) = from_outside(vehicle, parameter_index("a_per_rad").expect("a row of the table"));
    HeldLiftSlope { value, se, source, warning: other_than_built_up(vehicle, option) }
}

/// What to say where the vehicle's lift slope is not that of a real Slocum with its wings; nothing where it is, within two of
/// the build-up's standard errors.
fn other_than_built_up(vehicle: &Vehicle, option: &str) -> Option<String> {
    let (slope, source) = built_up_lift_slope(vehicle)?;
    let own = vehicle.glide_parameters().a_per_rad;
    ((own - slope.value).abs() > 2.0 * slope.se).then(|| {
        format!(
            "the lift slope of `{}` is {own:.1} per rad, that of its paper; {source}: {:.1} +- {:.1} per rad. For the log of a real Slocum hold that one: {option}{:.1}+-{:.1}",
            vehicle.name, slope.value, slope.se, slope.value, slope.se
        )
    })
}

/// Scatter of the published `c` of the Slocum, on its frontal area \[1/rad2\]: 1.4 (Leonard and Graver 2001), 6.4 (Williams et
/// al. 2007), 8.1 (Merckelbach et al. 2010) and 29 (the same authors' later code).
const SLOCUM_C_SCATTER_PER_RAD2: f64 = 12.0;

/// By how much more likely the log must be with another slope than with the vehicle's own, as a logarithm: twenty times.
const MUCH_MORE_LIKELY: f64 = 3.0;

/// Whether the vertical velocities of a log are fitted much better by the other of two vehicles that differ in their lift slopes:
/// drag, drag due to lift and trim fitted with each.
///
/// # Errors
/// Where there is too little of the log to fit.
pub fn is_fitted_better(
    [own, other]: [&Vehicle; 2],
    trim: Trim,
    observations: &[Observation],
) -> Result<bool, IdentifyError> {
    let scatter = |vehicle: &Vehicle| -> Result<Scatter, IdentifyError> {
        let baseline = trim.baseline(&vehicle.glide_parameters(), observations);
        let question = Question::new(baseline, &["b", "c_per_rad2", "ballast_offset_kg"])?;
        Ok(fit(&question, &mut by_dive(observations))?.tally.sink)
    };
    let (own, other) = (scatter(own)?, scatter(other)?);
    let independent = own.n as f64 / own.correlated_samples().max(other.correlated_samples());
    Ok(independent * (own.rms() / other.rms()).ln() > MUCH_MORE_LIKELY)
}

/// A built-in Slocum is not the user's own glider.
pub fn is_any_slocum(vehicle: &Vehicle) -> bool {
    vehicle.is_builtin && vehicle.name.to_lowercase().contains("slocum")
}

/// Lift slope of a winged Slocum by build-up, on its frontal area \[1/rad\], with its standard error.
///
/// Wing of aspect ratio 7, swept by 43 deg (Merckelbach et al. 2019): 3.73 per rad; hull 3.8 per rad; both on 0.1 m2.
///
/// Standard error: the hull's slope was published as 2.4 (Merckelbach et al. 2010) and, from the same kind of glider with a
/// Doppler log, as 3.8, a scatter of 1.0; the wing's formula errs by 5 % against tests of plain wings, and the hull between
/// the wings is worth anything from nothing to `1.07 (1 + d/b)^2 (1 - d/b)`, a quarter more (Raymer, Aircraft Design, eq.
/// 12.9), a scatter of 7 %.
pub fn slocum_lift_slope_per_rad(frontal_area_m2: f64) -> Figure {
    const ASPECT_RATIO: f64 = 7.0;
    const SWEEP_DEG: f64 = 43.0;
    const HULL_PER_RAD: f64 = 3.8;
    const REFERENCE_AREA_M2: f64 = 0.1;
    const HULL_SCATTER_PER_RAD: f64 = 1.0;
    const WING_ON_HULL: f64 = 0.07;
    let wing = wing_lift_slope_per_rad(ASPECT_RATIO, SWEEP_DEG.to_radians());
    let on_frontal_area = REFERENCE_AREA_M2 / frontal_area_m2;
    Figure {
        value: (wing.value + HULL_PER_RAD) * on_frontal_area,
        se: HULL_SCATTER_PER_RAD.hypot(wing.se).hypot(wing.value * WING_ON_HULL) * on_frontal_area,
    }
}

/// Standard error of a coefficient that a vehicle file states without one, relative to it: estimated lift slopes are off by
/// 10 to 20 %, and drag due to lift goes with the square of the slope.
pub fn unstated_error(row: &str) -> Option<f64> {
    match row {
        "a_per_rad" => Some(0.15),
        "c_per_rad2" => Some(0.3),
        _ => None,
    }
}

/// What is known of a row of [`PARAMETERS`] without this log: its value, the standard error and the source.
pub(super) fn from_outside(vehicle: &Vehicle, row: usize) -> (f64, Option<f64>, String) {
    let name = PARAMETERS[row].name;
    let value = vehicle.glide_parameters().as_array()[row];
    if is_any_slocum(vehicle) && name == "c_per_rad2" {
        let source = format!("vehicle `{}`; published for Slocums: 1.4 to 29", vehicle.name);
        return (value, Some(SLOCUM_C_SCATTER_PER_RAD2), source);
    }
    let stated = stated(vehicle).into_iter().flat_map(|one| one.along).find(|(of, _)| *of == row);
    match (stated, unstated_error(name)) {
        (Some((_, se)), _) => (value, Some(se.abs()), format!("vehicle `{}`", vehicle.name)),
        (None, Some(share)) => {
            let source = format!("vehicle `{}`, which states no error: {:.0} %", vehicle.name, 100.0 * share);
            (value, Some((share * value).abs()), source)
        }
        (None, None) => (value, None, format!("vehicle `{}`", vehicle.name)),
    }
}

/// The parameters considered in a fit: every pin that has an error, and what else the vehicle states with one and the baseline takes
/// over from it.
pub(super) fn considered(
    vehicle: &Vehicle,
    baseline: &Parameters<f64>,
    pinned: &BTreeMap<String, Pin>,
) -> Vec<Considered> {
    let pins = pinned.iter().filter_map(|(name, pin)| {
        let row = parameter_index(long_name(name))?;
        Some(Considered { name: name.clone(), along: vec![(row, pin.se?)] })
    });
    let (own, taken) = (vehicle.glide_parameters().as_array(), baseline.as_array());
    let is_pinned = |row: usize| pinned.contains_key(short_name(PARAMETERS[row].name));
    let others = stated(vehicle).into_iter().filter(|one| {
        // The trim sets the mass of the hull anew, and with it nothing that was uncertain.
        one.along
            .iter()
            .all(|&(row, _)| !is_pinned(row) && (own[row] == taken[row] || PARAMETERS[row].name == "hull_mass_kg"))
    });
    pins.chain(others).collect()
}

/// What a vehicle states with an error, as far as a fit may hold it.
fn stated(vehicle: &Vehicle) -> Vec<Considered> {
    const HOLDS: [&str; 5] = ["hydro.", "hull.", "mechanisms.", "added_mass.", "ballast."];
    let own = vehicle.glide_parameters().as_array();
    let considered = |(path, se): (&String, &f64)| {
        let held = HOLDS.iter().any(|section| path.starts_with(section)) || path == "mass.moving_mass_kg";
        let mut moved = vehicle.clone();
        moved.set(path, vehicle.get(path).filter(|_| held)? + se).ok()?;
        let moved = moved.glide_parameters().as_array();
        let along: Vec<(usize, f64)> =
            (0..own.len()).map(|row| (row, moved[row] - own[row])).filter(|(_, by)| *by != 0.0).collect();
        // A mass that has its own name beside the hull's: its own name, not the hull's.
        let (first, _) = along.iter().find(|(row, _)| PARAMETERS[*row].name != "hull_mass_kg")?;
        Some(Considered { name: short_name(PARAMETERS[*first].name).to_owned(), along })
    };
    vehicle.uncertainty.iter().filter_map(considered).collect()
}
