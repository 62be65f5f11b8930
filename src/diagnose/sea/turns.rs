//! What turns or leans the glider, beside what the vertical plane shows: causes of the turn rate and of the roll join the
//! diagnosis, a list with its cost.

use std::collections::BTreeMap;

use crate::diagnose::findings::{Cause, Diagnosis, Gain, HalfSize, Rejected, Verdict, Why, Wrong};
use crate::dynamics::Parameters;
use crate::estimate::Estimate;
use crate::log::Observation;
use crate::spatial::turn::{Setting, Trim, continued};
use crate::turning::causes::{KnownTurning, LateralCause, LateralDiagnosis, ModelledStretch, ROLL, causes};
use crate::vehicle::Vehicle;

/// Relative growth of the drag with the squared rudder angle where the vehicle states none \[1/rad2\]: the middle of what
/// trials of Slocums gave (1.5 to 4).
const RUDDER_DRAG_PER_RAD2: f64 = 2.0;

/// Adds what the turn rate and the roll of a log show; returns the stretches before and after the named causes.
pub(super) fn add(diagnosis: &mut Diagnosis, vehicle: &Vehicle, observations: &[Observation]) -> Vec<ModelledStretch> {
    let Some(found) = causes(observations, known_turning(vehicle)) else { return Vec::new() };
    for cause in &found.causes {
        diagnosis.wrong.push(wrong(cause));
        diagnosis.gains.push(Gain {
            quantity: cause.quantity.to_owned(),
            holdout_rms_before: cause.holdout_rms_before,
            holdout_rms_after: cause.holdout_rms_after,
            reduction_percent: cause.reduction_percent.value,
            ci95: cause.reduction_percent.ci95,
        });
        // Behind those of the vertical plane, whose evidence is in other rows and of another kind.
        diagnosis.causes.push(named(cause, &found, vehicle, observations));
        diagnosis.verdict = match diagnosis.verdict {
            Verdict::None | Verdict::Explained => Verdict::Explained,
            Verdict::PartlyExplained | Verdict::Unexplained => Verdict::PartlyExplained,
        };
    }
    for one in found.rejected {
        let why = match one.p_value {
            _ if one.predicts_no_better => Why::PredictsNoBetter,
            None => Why::Equivalent,
            Some(_) => Why::ByChance,
        };
        diagnosis.rejected.push(Rejected {
            cause: one.cause.to_owned(),
            p_value: one.p_value,
            holdout_rms_after: None,
            why,
            remark: one.remark,
        });
    }
    found.modelled
}

/// What a vehicle's file says of its turning, as far as it says it.
pub fn known_turning(vehicle: &Vehicle) -> KnownTurning {
    KnownTurning {
        roll_per_roll_mass: roll_per_roll_mass(vehicle),
        curvature_per_rudder: curvature_per_rudder(vehicle),
    }
}

/// Roll per small angle of the roll mass: its first moment over that of all that hangs below the centre of buoyancy.
fn roll_per_roll_mass(vehicle: &Vehicle) -> Option<f64> {
    let rolling_kg_m = vehicle.get("roll_mass.mass_kg")? * vehicle.get("roll_mass.radius_m")?;
    Some(rolling_kg_m / below_kg_m(vehicle)).filter(|ratio| ratio.is_finite())
}

/// A small rudder angle, by which the vehicle's curvature per rudder is computed \[rad\].
const SMALL_RUDDER_RAD: f64 = 0.02;

/// Pitch of the glides in which it is computed \[rad\]; it depends on it weakly.
const COMMON_PITCH_RAD: f64 = 0.45;

/// Curvature per small rudder angle, the mean of a descent and an ascent with half of what the buoyancy engine gives \[1/m\].
fn curvature_per_rudder(vehicle: &Vehicle) -> Option<f64> {
    if vehicle.get("rudder.CN_delta_per_rad")? == 0.0 {
        return None;
    }
    let body = vehicle.body().ok()?;
    let p = &body.plane;
    let net_mass_kg = 0.25 * (p.ballast_max_m3 - p.ballast_min_m3) * p.reference_density_kg_m3;
    let at = |leg: f64, rudder_rad: f64| {
        let setting = Setting {
            net_mass_kg: leg * net_mass_kg,
            trim: Trim::Pitch(-leg * COMMON_PITCH_RAD),
            roll_mass_rad: 0.0,
            rudder_rad,
            density_kg_m3: p.reference_density_kg_m3,
            depth_m: 0.0,
        };
        continued(&body, &setting, None).map(|turn| turn.turn_rate_rad_s / turn.speed_m_s)
    };
    let of_leg = |leg: f64| Some((at(leg, SMALL_RUDDER_RAD)? - at(leg, -SMALL_RUDDER_RAD)?) / (2.0 * SMALL_RUDDER_RAD));
    let mean = 0.5 * (of_leg(1.0)? + of_leg(-1.0)?);
    Some(mean).filter(|curvature| curvature.is_finite())
}

/// First moment of the masses below the centre of buoyancy.
fn below_kg_m(vehicle: &Vehicle) -> f64 {
    let p = vehicle.glide_parameters();
    p.moving_mass_kg * p.moving_mass_height_m + p.offset_mass_kg * p.offset_mass_below_m
}

fn wrong(cause: &LateralCause) -> Wrong {
    Wrong {
        quantity: cause.quantity.to_owned(),
        regime: if cause.quantity == ROLL { "roll at rest" } else { "both legs alike" }.to_owned(),
        rms: cause.holdout_rms_before,
        expected_rms: cause.expected_rms,
        size: cause.size,
        relevant_above: cause.relevant_above,
        p_value: cause.p_value,
    }
}

fn named(cause: &LateralCause, found: &LateralDiagnosis, vehicle: &Vehicle, observations: &[Observation]) -> Cause {
    let mut parameters = cause.parameters.clone();
    if let Some(list) = parameters.get("static_list_rad").cloned() {
        let share = cost(&list, found, vehicle, observations);
        parameters.extend(share.map(|share| ("drag_increase".to_owned(), share.clone())));
    }
    if let Some(share) = parameters.get("drag_increase").cloned() {
        parameters.insert("days_lost_per_100".to_owned(), days(&share));
    }
    let halves = ["first", "second"].into_iter().zip(&cause.halves);
    let whole = cause.halves.iter().map(|(value, _)| value).sum::<f64>();
    Cause {
        cause: cause.cause.to_owned(),
        parameters,
        p_value: cause.p_value,
        delta_bic: cause.delta_bic,
        quantity: cause.quantity.to_owned(),
        holdout_rms_before: cause.holdout_rms_before,
        holdout_rms_after: cause.holdout_rms_after,
        stability: halves
            .map(|(half, &(value, se))| HalfSize {
                half,
                value,
                se,
                found: value.abs() > 2.0 * se && value * whole > 0.0,
            })
            .collect(),
        indistinguishable_from: cause.indistinguishable_from.iter().map(|name| (*name).to_owned()).collect(),
        log_likelihood_ratio: BTreeMap::new(),
    }
}

/// Relative growth of the drag by a list that the glider is held straight with, by the polar: lift that leans, the rudder that
/// holds the course, the side force of the slip. It grows with the square of the list, and so does its interval.
fn cost(
    list: &Estimate,
    found: &LateralDiagnosis,
    vehicle: &Vehicle,
    observations: &[Observation],
) -> Option<Estimate> {
    let p: Parameters<f64> = vehicle.glide_parameters();
    let mut pitches: Vec<f64> =
        observations.iter().filter(|o| o.steady).map(|o| o.pitch_rad.abs()).filter(|pitch| pitch.is_finite()).collect();
    if pitches.is_empty() {
        return None;
    }
    let pitch = crate::log::median(&mut pitches).clamp(0.1, 1.4);
    let mut alpha = 0.0f64;
    for _ in 0..60 {
        alpha = 0.5 * (alpha + (p.b + p.c_per_rad2 * alpha * alpha) / (p.a_per_rad * (pitch + alpha).tan()));
    }
    let drag = p.b + p.c_per_rad2 * alpha * alpha;
    let net_weight = drag * pitch.cos() / (pitch + alpha).sin();
    let side = vehicle.get("lateral.CY_beta_per_rad").map_or(0.0, |slope| {
        let slip = net_weight / slope.abs().max(0.1);
        slope.abs() * slip * slip / drag
    });
    let rudder = found.rudder_per_roll.map_or(0.0, |per_roll| per_roll / pitch.tan());
    let of_rudder = if p.rudder_drag_per_rad2 > 0.0 { p.rudder_drag_per_rad2 } else { RUDDER_DRAG_PER_RAD2 };
    let per_rad2 = p.c_per_rad2 * alpha * alpha / drag + of_rudder * rudder * rudder + side;
    let of = |list: f64| per_rad2 * list * list;
    let [low, high] = list.ci95;
    let least = if low * high < 0.0 { 0.0 } else { of(low).min(of(high)) };
    per_rad2.is_finite().then(|| Estimate {
        value: of(list.value),
        se: 2.0 * per_rad2 * list.value.abs() * list.se,
        ci95: [least, of(low).max(of(high))],
        unit: "1".to_owned(),
    })
}

/// Days lost of a hundred at the same speed, where all energy goes into pumping: the net weight grows as the drag does.
fn days(share: &Estimate) -> Estimate {
    let of = |share: f64| 100.0 * share / (1.0 + share);
    Estimate {
        value: of(share.value),
        se: 100.0 * share.se / (1.0 + share.value).powi(2),
        ci95: share.ci95.map(of),
        unit: "d".to_owned(),
    }
}

/// What the named causes are in the vehicle file: its tables for three dimensions, as far as it has them.
pub(super) fn extend(vehicle: &mut Vehicle, causes: &[Cause]) -> Result<(), crate::input::InputError> {
    let sizes = causes.iter().flat_map(|cause| cause.parameters.iter().map(move |(name, size)| (cause, name, size)));
    for (cause, name, size) in sizes {
        match (cause.cause.as_str(), name.as_str()) {
            ("static_list", "static_list_rad") if vehicle.get("lateral.m2_kg").is_some() => {
                let before = vehicle.get("mass.cg_starboard_m").unwrap_or(0.0);
                let moved = below_kg_m(vehicle) * size.value.tan() / vehicle.glide_parameters().mass_kg();
                vehicle.set("mass.cg_starboard_m", before + moved)?;
            }
            ("rudder_offset", "rudder_offset_rad") if vehicle.get("rudder.CN_delta_per_rad").is_some() => {
                vehicle.set("rudder.offset_rad", size.value)?;
            }
            ("roll_mass_offset", "roll_mass_offset_rad") if vehicle.get("roll_mass.mass_kg").is_some() => {
                vehicle.set("roll_mass.offset_rad", size.value)?;
            }
            _ => {}
        }
    }
    Ok(())
}
