//! The whole identification of one log: trim, what is free and what is pinned, the fit, its errors, the hold-out, the
//! legs apart, and everything that has to be said about it.

use std::collections::BTreeMap;

use serde::Serialize;

use super::consider_parameters::{considered_of, propagate};
use super::considered::{Considered, Propagated};
use super::data::{Dive, by_dive};
use super::external_values::{ExternalValue, HeldLiftSlope, Pin, considered, from_outside, held_lift_slope};
use super::given::{Given, LARGEST_A, SMALLEST_A};
use super::holdout::{HeldOut, hold_out};
use super::identifiability::{ProfilePoint, is_identified, profile};
use super::inflections::{Inflections, UNSTEADY_ONLY, Unsteady, inflections};
use super::joint::{IdentifyError, JointFit, Question, fit};
use super::misfit;
use super::names::{long_name, short_name};
use super::pitch_balance::{PitchBalance, pitch_balance};
use super::quasi_steady::{self, fit_with_inertia_or_without};
use super::residuals::{Score, ScoreSums};
use super::specification_test::reweighed;
use super::speeds::Rows;
use super::trim::Trim;
use super::unknown_shear;
use crate::dynamics::{PARAMETERS, Parameters, parameter_index};
use crate::log::Observation;
use crate::vehicle::Vehicle;
use glidepolar_inference::covariance::condition_number;
use glidepolar_inference::specification_test::Disagreement;

/// What a user asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// What the baseline takes for the net weight.
    pub trim: Trim,
    /// Parameters to free besides a, b, c and the ballast offset; naming one of these frees it whatever the data say.
    pub free: Vec<String>,
    /// Parameters to hold.
    pub pin: Vec<Given>,
    /// Whether, and how, dives are flown through time, inflections included.
    pub unsteady: Option<Unsteady>,
}

/// The result.
#[derive(Debug, Clone)]
pub struct Identification {
    /// The net weight of the baseline.
    pub trim: Trim,
    /// The baseline.
    pub baseline: Parameters<f64>,
    /// The fit.
    pub fit: JointFit,
    /// The same question, to be asked again.
    pub question: Question,
    /// Steady samples, dive by dive.
    pub dives: Vec<Dive>,
    /// Parameters that were held although one would like to know them, by short name.
    pub pinned: BTreeMap<String, Pin>,
    /// The fit on the samples that it saw.
    pub score: Score,
    /// The same on dives that it did not see, and what each half of them says.
    pub held_out: Option<HeldOut>,
    /// The fit on dives flown through time, where it was asked for.
    pub inflections: Option<Inflections>,
    /// The balance of pitching moments, where the log has the position of the battery.
    pub pitch_balance: Option<PitchBalance>,
    /// Descents and ascents fitted apart, each without a ballast offset.
    pub legs: Option<LegsApart>,
    /// The profile of the lift slope.
    pub profile: Vec<ProfilePoint>,
    /// What a user has to know.
    pub warnings: Vec<String>,
}

/// Descents and ascents fitted apart, as the tank paper does, beside both together with one ballast offset.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LegsApart {
    /// b of the descents alone, trim as it is.
    pub descent_b: f64,
    /// b of the ascents alone, trim as it is.
    pub ascent_b: f64,
    /// Vertical velocity of both fits, root mean square \[m/s\].
    pub w_rms_m_s: f64,
    /// b of both legs together, with one ballast offset.
    pub joint_b: f64,
    /// The ballast offset \[kg\].
    pub ballast_offset_kg: f64,
    /// Vertical velocity of the joint fit, root mean square \[m/s\].
    pub joint_w_rms_m_s: f64,
}

/// Largest c that is published of a glider, on its frontal area \[1/rad2\]: 29, of a Slocum (docs/theory/identification.md).
const LARGEST_C: f64 = 30.0;

/// Rows that say by how much the polar of ascents differs from that of descents.
const LEG_RATIOS: [(&str, &str); 3] = [("ascent_a_ratio", "a"), ("ascent_b_ratio", "b"), ("ascent_c_ratio", "c")];

/// Identifies what the log can tell of the vehicle.
///
/// # Errors
/// Without steady samples, with unknown names, or where the baseline cannot fly.
pub fn identify(
    vehicle: &Vehicle,
    observations: &[Observation],
    request: &Request,
) -> Result<Identification, IdentifyError> {
    identify_from(vehicle, observations, request).map_err(|error| match error {
        IdentifyError::CannotFly { unflyable, samples, .. } => {
            IdentifyError::CannotFly { unflyable, samples, trim: Some(request.trim) }
        }
        other => other,
    })
}

fn identify_from(
    vehicle: &Vehicle,
    observations: &[Observation],
    request: &Request,
) -> Result<Identification, IdentifyError> {
    let mut dives = by_dive(observations);
    if dives.is_empty() {
        return Err(IdentifyError::NoSamples);
    }
    let mut baseline = request.trim.baseline(&vehicle.glide_parameters(), observations);
    let mut warnings = Vec::new();
    let speeds = Rows::of_speed(&dives);
    if let Some(few) = speeds.too_few(dives.len()) {
        return without_speed(vehicle, observations, request, few);
    }
    let has_speed = speeds.rows > 0;

    let mut pinned = BTreeMap::new();
    let mut free: Vec<&str> = vec!["a_per_rad", "b", "c_per_rad2", "ballast_offset_kg"];
    let asked: Vec<&str> = request.free.iter().map(|name| long_name(name)).collect();
    // d belongs to the balance of moments, which comes after the polar; added masses show only where speeds change.
    let later = |name: &str| name == "d_per_rad" || UNSTEADY_ONLY.contains(&name);
    let polar = ["a_per_rad", "b", "c_per_rad2", "ballast_offset_kg"];
    free.extend(asked.iter().copied().filter(|name| !polar.contains(name) && !later(name)));
    if request.unsteady.is_none()
        && let Some(name) = asked.iter().find(|name| UNSTEADY_ONLY.contains(name))
    {
        return Err(IdentifyError::NeedsUnsteady((*name).to_owned()));
    }

    for given @ Given { name, known: ExternalValue { value, se } } in &request.pin {
        given.check()?;
        let row = parameter_index(long_name(name)).ok_or_else(|| IdentifyError::UnknownParameter(name.clone()))?;
        *baseline.at(row) = *value;
        free.retain(|free| *free != PARAMETERS[row].name);
        let reason = match se {
            Some(_) => "held as asked",
            None => "held as asked, taken for exact: what is fitted beside it knows no error of it",
        };
        let pin = Pin::new(*value, *se, "given by the user".to_owned(), reason.to_owned());
        pinned.insert(short_name(PARAMETERS[row].name).to_owned(), pin);
    }
    if !has_speed && free.contains(&"a_per_rad") && !asked.contains(&"a_per_rad") {
        let HeldLiftSlope { value, se, source, warning } = held_lift_slope(vehicle, "--pin a=");
        baseline.a_per_rad = value;
        warnings.extend(warning);
        free.retain(|name| *name != "a_per_rad");
        let reason = "vertical velocity alone does not identify the lift slope: a larger b cancels the effect of a smaller angle \
                      of attack; a measured speed through the water would identify it"
            .to_owned();
        pinned.insert("a".to_owned(), Pin::new(value, se, source, reason));
    }
    if !has_speed && asked.contains(&"a_per_rad") {
        warnings.push(
            "a was freed by the user without a measured speed: its interval is that of a perfect model, the value means little"
                .to_owned(),
        );
    }
    // A vehicle with a polar for each leg keeps the ratios of the two; what else differs between them is asked for by name.
    for (name, of) in LEG_RATIOS {
        let row = parameter_index(name).expect("a row of the table");
        let ratio = *baseline.at(row);
        if !free.contains(&name) && ratio != 1.0 && !pinned.contains_key(name) {
            let source = format!("vehicle `{}`", vehicle.name);
            let reason = format!("the vehicle has another {of} on ascents than on descents: their ratio is kept");
            pinned.insert(name.to_owned(), Pin::new(ratio, None, source, reason));
        }
    }

    // Parameters that the data cannot identify are pinned, the worst first, until all that are left are identified.
    let mut question = Question::new(baseline, &free)?;
    let mut fitted = fit_with_inertia_or_without(&question, &mut dives)?;
    if let Some(few) = speeds.worth(&fitted.tally.speed).too_few(dives.len()) {
        return without_speed(vehicle, observations, request, few);
    }
    propagate(&mut fitted, &mut &mut dives[..], &considered(vehicle, &baseline, &pinned));
    unknown_shear::consider(&mut fitted, &dives);
    loop {
        let unknown = (0..fitted.free.len())
            .filter(|&i| !is_identified(&fitted, i) && !asked.contains(&PARAMETERS[fitted.free[i]].name))
            // b and the trim are what is left when nothing else is identified.
            .filter(|&i| !["b", "ballast_offset_kg"].contains(&PARAMETERS[fitted.free[i]].name))
            .max_by_key(|&i| u8::from(PARAMETERS[fitted.free[i]].name == "c_per_rad2"));
        let Some(position) = unknown.filter(|_| dives.len() >= 2) else { break };
        let row = fitted.free[position];
        let info = &PARAMETERS[row];
        let (value, se, source) = from_outside(vehicle, row);
        let reason = format!(
            "these data leave it open: fitted freely it would be {:.3} +- {:.3} {}",
            fitted.value(row),
            fitted.se(position),
            info.unit
        );
        pinned.insert(short_name(info.name).to_owned(), Pin::new(value, se, source, reason));
        *baseline.at(row) = value;
        free.retain(|name| *name != info.name);
        question = Question::new(baseline, &free)?;
        fitted = fit_with_inertia_or_without(&question, &mut dives)?;
        propagate(&mut fitted, &mut &mut dives[..], &considered(vehicle, &baseline, &pinned));
        unknown_shear::consider(&mut fitted, &dives);
    }
    let considered = considered(vehicle, &baseline, &pinned);

    let reweighed = reweighed(&fitted, &mut dives);
    fitted.model_error = reweighed.as_ref().map_or_else(Vec::new, Disagreement::model_error);

    let score = score(&fitted.parameters, &dives);
    let held_out = hold_out(&question, &dives)?;
    let inflections = match &request.unsteady {
        Some(unsteady) => {
            let mut moving = question.clone();
            for name in asked.iter().filter(|name| UNSTEADY_ONLY.contains(name)) {
                moving.free.extend(parameter_index(name));
            }
            let mut flown = inflections(&moving, &fitted.parameters, observations, unsteady)?;
            propagate(&mut flown.fit, &mut flown.passages, &considered);
            unknown_shear::consider(&mut flown.fit, &dives);
            flown.fit.model_error = model_error_of(&flown.fit.free, &fitted);
            Some(flown)
        }
        None => None,
    };
    let polar = inflections.as_ref().map_or(&fitted, |flown| &flown.fit);
    for propagated in polar.propagated.iter().filter(|propagated| propagated.considered.name != unknown_shear::NAME) {
        let moves = polar.free.iter().map(|&row| short_name(PARAMETERS[row].name).to_owned());
        let moves: BTreeMap<String, f64> = moves.zip(propagated.moves.iter().copied()).collect();
        let pin = pinned
            .entry(propagated.considered.name.clone())
            .or_insert_with(|| as_the_vehicle_has_it(vehicle, propagated));
        pin.moves = moves;
    }
    // The balance of moments rests on the polar, whose errors are correlated, and on what else is held in it.
    let is_in_polar =
        |one: &&Considered| polar.propagated.iter().any(|propagated| propagated.considered.name == one.name);
    let mut of_moments = considered_of(polar);
    of_moments.extend(considered.iter().filter(|one| !is_in_polar(one)).cloned());
    let pitch_balance = pitch_balance(vehicle, &polar.parameters, &dives, &of_moments)?;
    let legs = legs_apart(&question, &fitted, &dives);
    let a = fitted.parameters.a_per_rad;
    let values: Vec<f64> = [0.3, 0.45, 0.6, 0.8, 1.0, 1.3, 1.8, 2.6].iter().map(|factor| factor * a).collect();
    let profile = profile(&question, &fitted.parameters, "a_per_rad", &values, &dives).unwrap_or_default();

    if dives.iter().any(Dive::is_quasi_steady) {
        warnings.push(quasi_steady::WARNING.to_owned());
    }
    warn(&mut warnings, &fitted, &dives, has_speed);
    warnings.extend(misfit::warnings(&score, &dives));
    if let Some(reweighed) = &reweighed {
        warnings.extend(reweighed.named.iter().map(|&position| depends_on_weighing(&fitted, reweighed, position)));
    }
    if let Some(propagated) = fitted.propagated.iter().find(|propagated| propagated.considered.name == "a") {
        warnings.push(speed_warning(&fitted, propagated, &dives));
    }
    if let Some(why) = pitch_balance.as_ref().and_then(|balance| balance.failure.as_ref()) {
        warnings
            .push(format!("the balance of moments is not identifiable, d and the centre of gravity with it: {why}"));
    }
    let pitch_balance = pitch_balance.filter(|balance| balance.failure.is_none());
    if pitch_balance.as_ref().is_some_and(|balance| !balance.is_identified) {
        warnings.push(
            "d and the height of the centre of gravity rest on the arm of the ballast, which these data do not identify: give the vehicle its `ballast.forward_m`"
                .into(),
        );
    }
    Ok(Identification {
        trim: request.trim,
        baseline,
        fit: fitted,
        question,
        dives,
        pinned,
        score,
        held_out,
        inflections,
        pitch_balance,
        legs,
        profile,
        warnings,
    })
}

/// The identification of a log whose measured speed is too little to fit by.
fn without_speed(
    vehicle: &Vehicle,
    observations: &[Observation],
    request: &Request,
    few: String,
) -> Result<Identification, IdentifyError> {
    let without: Vec<Observation> = observations.iter().map(|o| Observation { speed_m_s: f64::NAN, ..*o }).collect();
    let mut found = identify(vehicle, &without, request)?;
    found.warnings.insert(0, few);
    Ok(found)
}

/// The error of the model as the steady fit has it, for another list of free parameters.
fn model_error_of(free: &[usize], fitted: &JointFit) -> Vec<f64> {
    if fitted.model_error.is_empty() {
        return Vec::new();
    }
    let of = |row: &usize| fitted.free.iter().position(|known| known == row).map_or(0.0, |i| fitted.model_error[i]);
    free.iter().map(of).collect()
}

/// Says that a parameter depends on the weighing.
fn depends_on_weighing(fitted: &JointFit, reweighed: &Disagreement, position: usize) -> String {
    let (info, by_time) = (&PARAMETERS[fitted.free[position]], fitted.value(fitted.free[position]));
    let shown = |value: f64| if value.abs() < 1e-2 { format!("{value:.2e}") } else { format!("{value:.3}") };
    format!(
        "`{}` depends on how the data are weighed: {} by time, as above, {} {} by their correlated noise. Where the model is right both agree; an effect is missing from the model, and the interval includes that error",
        short_name(info.name),
        shown(by_time),
        shown(by_time + reweighed.differences[position]),
        info.unit
    )
}

/// Something that nobody asked for and that the vehicle states with an error.
fn as_the_vehicle_has_it(vehicle: &Vehicle, propagated: &Propagated) -> Pin {
    let (row, se) = propagated.considered.along[0];
    let value = vehicle.glide_parameters().as_array()[row];
    let reason = "not asked for; the vehicle states its error".to_owned();
    Pin::new(value, Some(se.abs()), format!("vehicle `{}`", vehicle.name), reason)
}

/// How well parameters do on the samples of dives.
fn score(parameters: &Parameters<f64>, dives: &[Dive]) -> Score {
    let mut sums = ScoreSums::default();
    for dive in dives {
        sums.add(&dive.observations, &dive.residuals(parameters));
    }
    sums.score()
}

/// The tank paper's own comparison: each leg fitted with the trim as it is, then both with one offset.
fn legs_apart(question: &Question, joint: &JointFit, dives: &[Dive]) -> Option<LegsApart> {
    let offset = parameter_index("ballast_offset_kg")?;
    let leg = |descends: bool| -> Option<(f64, Score)> {
        let mut of_leg: Vec<Dive> =
            dives.iter().filter_map(|dive| dive.part(|_, o| o.descends() == descends)).collect();
        if of_leg.len() < 2 {
            return None;
        }
        let mut baseline = question.baseline;
        baseline.b = joint.parameters.b;
        let free = vec![parameter_index("b")?];
        let apart = Question { baseline, free, use_speed: false, ..question.clone() };
        let found = fit(&apart, &mut of_leg).ok()?;
        let p = &found.parameters;
        Some((p.b * if descends { 1.0 } else { p.ascent_b_ratio }, score(p, &of_leg)))
    };
    joint.free.contains(&offset).then_some(())?;
    let ((descent_b, descent), (ascent_b, ascent)) = (leg(true)?, leg(false)?);
    let squares = |score: &Score| score.n as f64 * score.w_rms_m_s.powi(2);
    Some(LegsApart {
        descent_b,
        ascent_b,
        w_rms_m_s: ((squares(&descent) + squares(&ascent)) / (descent.n + ascent.n) as f64).sqrt(),
        joint_b: joint.parameters.b,
        ballast_offset_kg: joint.parameters.ballast_offset_kg,
        joint_w_rms_m_s: score(&joint.parameters, dives).w_rms_m_s,
    })
}

/// What the error of a held lift slope does to the speed, in a sentence.
fn speed_warning(fitted: &JointFit, propagated: &Propagated, dives: &[Dive]) -> String {
    let mean_speed = |parameters: &Parameters<f64>| {
        let speeds = dives.iter().flat_map(|dive| dive.residuals(parameters));
        let (n, sum) = speeds
            .map(|r| r.predicted_speed_m_s)
            .filter(|speed| speed.is_finite())
            .fold((0usize, 0.0), |(n, sum), speed| (n + 1, sum + speed));
        sum / n as f64
    };
    let mut moved = fitted.parameters;
    for (row, by) in propagated.whole(&fitted.free).along {
        *moved.at(row) += by;
    }
    let (mean, with) = (mean_speed(&fitted.parameters), mean_speed(&moved));
    format!(
        "the lift slope is held at {:.1} +- {:.1} per rad: one such standard error moves the mean speed of {mean:.3} m/s by {:.3} m/s, and b and c as the report says",
        fitted.parameters.a_per_rad,
        propagated.considered.along.iter().map(|(_, by)| by.abs()).sum::<f64>(),
        (with - mean).abs()
    )
}

fn warn(warnings: &mut Vec<String>, fitted: &JointFit, dives: &[Dive], has_speed: bool) {
    if !has_speed {
        warnings.push(
            "no measured speed: vertical velocity alone; speeds and glide angles rest on the pinned lift slope".into(),
        );
    }
    if fitted.tally.unflyable > 0 {
        warnings.push(format!(
            "at {} of {} stretches no glide exists at the recorded pitch and net mass; they count as predicted at rest",
            fitted.tally.unflyable, fitted.tally.sink.n
        ));
    }
    if dives.len() < 8 {
        warnings.push(format!("few dives ({}): standard errors, which compare dives, are rough", dives.len()));
    }
    if !fitted.converged {
        warnings.push("the solver stopped before the minimum was certain".into());
    }
    let condition = condition_number(&super::Gram::sum(fitted.free.len(), &fitted.grams).normal_matrix());
    if condition > 1e4 {
        warnings.push(format!("condition number {condition:.0}: some combination of the parameters is hardly seen"));
    }
    for (i, &row) in fitted.free.iter().enumerate() {
        let (value, info) = (fitted.value(row), &PARAMETERS[row]);
        if value <= info.min || value >= info.max {
            warnings.push(format!("`{}` ran to its bound {value}", info.name));
        }
        if info.name == "c_per_rad2" && value - 2.0 * fitted.se(i) > LARGEST_C {
            warnings.push(format!(
                "c = {value:.0} +- {:.0} per rad2 is more than gliders are known to have ({LARGEST_C:.0}): drag that falls with speed (--free drag_exponent) and a wrong scale of the ballast (--free ballast_scale) look like it",
                fitted.se(i)
            ));
        }
        if info.name == "a_per_rad" && (value <= SMALLEST_A || value >= LARGEST_A) {
            warnings.push(format!(
                "a lift slope of {value:.1} +- {:.1} per rad is none that a glider has; check pitch and speed",
                fitted.se(i)
            ));
        }
    }
    let angles = dives.iter().flat_map(|dive| dive.residuals(&fitted.parameters));
    let (n, small) = angles
        .map(|r| r.angle_of_attack_rad)
        .filter(|a| a.is_finite())
        .fold((0, 0), |(n, small), a| (n + 1, small + u32::from(a.abs() < 0.5f64.to_radians())));
    if n > 0 && 2 * small > n {
        warnings.push(
            "the angle of attack is below 0.5 deg on most samples, impossible for a glider that its wings carry: does the pitch sensor read too large?"
                .into(),
        );
    }
}
