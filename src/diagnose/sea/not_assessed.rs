//! Mechanisms that the engine cannot assess, with the reason: those that no steady glide shows, and those equivalent to another one.
//! Knows the finished diagnosis.

use super::SeaProblem;
use super::consistency;
use crate::diagnose::Outcome;
use crate::diagnose::findings::{Check, Checked, Rejected, Why};

/// Adds `speed_scale` to the group of the other scales, and to each in which a scale of the pressure stands. With a fitted polar, a wrong scale of the vertical
/// velocity and one of the speed differ by a factor of all velocities alone, which the polar takes up; a scale of the pitch changes their ratio as well.
pub(super) fn add_speed_scale(outcome: &mut Outcome) {
    for cause in &mut outcome.diagnosis.causes {
        let is = |name: &str| cause.cause == name;
        let group = &mut cause.indistinguishable_from;
        let has = |name: &str| group.iter().any(|other| other == name);
        let is_of_scales = is("pressure_scale") || is("pitch_scale") || has("pressure_scale");
        if is_of_scales && !is("speed_scale") && !has("speed_scale") {
            group.push("speed_scale".to_owned());
        }
    }
}

/// Returns the mechanisms that no steady glide can show, and those that the consistency checks decide.
pub(super) fn rejections(checks: &[Check], outcome: &Outcome, problem: &SeaProblem) -> Vec<Rejected> {
    let density = checks.iter().find(|check| check.check == consistency::DENSITY);
    let is_named = |name: &str| outcome.diagnosis.causes.iter().any(|cause| cause.cause == name);
    let reject = |cause: &str, remark: String| Rejected {
        cause: cause.to_owned(),
        p_value: None,
        holdout_rms_after: None,
        why: Why::Equivalent,
        remark,
    };
    let mut found = vec![reject(
        "inertia",
        "samples near inflections take no part, and along the glide the vehicle's own inertia is in the model; it has no free size".to_owned(),
    )];
    let why = if problem.knows_shear() {
        "the log's own current is in the model: its force is subtracted, it has no free size"
    } else {
        "the log has no current (columns current_east_m_s and current_north_m_s): an unknown steady one whose velocity changes with depth as currents usually do is part of the model"
    };
    found.push(reject("shear", why.to_owned()));
    if !is_named("speed_scale") {
        let why = "beside a polar that is fitted it does what a scale of the pressure does";
        found.push(reject("speed_scale", why.to_owned()));
    }
    if !problem.has_speed() {
        let why = "without a measured speed lift slope and drag take up what a scale of the pitch would do";
        found.push(reject("pitch_scale", why.to_owned()));
    }
    if let Some(check) = density.filter(|_| !is_named("density_at_zero_pressure")) {
        let why = match check.outcome {
            Checked::NotChecked => format!("not checked: {}", check.says),
            _ => check.says.clone(),
        };
        found.push(reject("density_at_zero_pressure", why));
    }
    found
}
