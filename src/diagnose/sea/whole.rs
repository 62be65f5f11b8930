//! The diagnosis of a whole log: consistency first, then mechanisms in what is left.

use super::consistency::{self, DensityError};
use super::{SeaError, SeaProblem, Settings};
use crate::diagnose::engine::{self, Outcome};
use crate::diagnose::findings::{Cause, Check, Checked, Verdict};
use crate::diagnose::holdout;
use crate::diagnose::{Evidence, Problem};
use crate::dynamics::{Parameters, parameter_index};
use crate::estimate::Estimate;
use crate::identify::Trim;
use crate::log::Observation;

/// A log's diagnosis.
pub struct SeaDiagnosis {
    /// The four answers, and what is left row by row.
    pub told: Outcome,
    /// The data, at the extended model.
    pub evidence: Evidence,
    /// The log against the vehicle, mended where it had to be.
    pub problem: SeaProblem,
    /// The baseline: the vehicle, with its trim decided.
    pub baseline: Parameters<f64>,
}

/// Relative compressibility of sea water \[1/Pa\], within a tenth over the ocean's upper kilometre (TEOS-10).
const WATER_COMPRESSIBILITY_PER_PA: f64 = 4.4e-10;

/// Diagnoses a log against a vehicle.
///
/// # Errors
/// Where the log contradicts itself beyond mending, or too little of it can be used.
pub fn diagnose_log(
    vehicle: &Parameters<f64>,
    trim: Trim,
    observations: &[Observation],
    settings: Settings,
) -> Result<SeaDiagnosis, SeaError> {
    let (checks, error) = consistency::checks(observations);
    if checks.iter().any(|check| check.outcome == Checked::Wrong) {
        return Err(SeaError::Inconsistent(checks));
    }
    let as_read = |observations: &[Observation]| {
        let baseline = trim.baseline(vehicle, observations);
        SeaProblem::new(observations, &baseline, settings).map(|problem| (problem, baseline))
    };
    let (problem, baseline, mut told) = match error {
        None => {
            let (problem, baseline) = as_read(observations)?;
            let (problem, told) = in_full(problem);
            (problem, baseline, told)
        }
        Some(error) => {
            let (problem, baseline) = as_read(&consistency::mended(observations, error))?;
            let (problem, mut told) = in_full(problem);
            // The density as it was read may fit no glide at all: then there is no misfit to compare with.
            if let Ok((raw, _)) = as_read(observations) {
                put_before(&mut told, &problem, &raw);
            }
            told.diagnosis.causes.insert(0, density_cause(&told, &problem.evidence(&told.after.point), error));
            told.diagnosis.verdict = match told.diagnosis.verdict {
                Verdict::None | Verdict::Explained => Verdict::Explained,
                Verdict::PartlyExplained | Verdict::Unexplained => Verdict::PartlyExplained,
            };
            (problem, baseline, told)
        }
    };
    if error.is_none() {
        name_what_density_hides(&mut told, &problem, &checks);
    }
    told.diagnosis.rejected.extend(unweighed(&checks, &told, problem.has_speed()));
    told.diagnosis.consistency = checks;
    told.diagnosis.warnings = problem.doubts(&told.after.point);
    let evidence = problem.evidence(&told.after.point);
    Ok(SeaDiagnosis { told, evidence, problem, baseline })
}

/// Diagnoses a problem; once more, where the drag jumped, with the time of the jump looked for more closely.
fn in_full(problem: SeaProblem) -> (SeaProblem, Outcome) {
    let told = engine::diagnose_in_full(&problem);
    let jump = told.named.iter().find_map(|named| problem.candidates()[*named].version);
    match jump.and_then(|jump| problem.with_jumps_about(jump.value)) {
        Some(finer) => {
            let told = engine::diagnose_in_full(&finer);
            (finer, told)
        }
        None => (problem, told),
    }
}

/// Puts the misfit of the log as it was read in place of the mended log's baseline, row by row.
fn put_before(told: &mut Outcome, mended: &SeaProblem, raw: &SeaProblem) {
    let (stage, wrong) = engine::baseline(raw);
    let key = |evidence: &Evidence, row: usize| {
        let quantity = evidence.quantities.iter().position(|q| q.rows.contains(&row));
        (quantity, evidence.time_s[row].to_bits())
    };
    let evidence = raw.evidence(&stage.point);
    let known: std::collections::HashMap<_, usize> =
        (0..stage.residual.len()).map(|row| (key(&evidence, row), row)).collect();
    let evidence = mended.evidence(&told.after.point);
    for row in 0..told.before.residual.len() {
        if let Some(&other) = known.get(&key(&evidence, row)) {
            told.before.held_out[row] = stage.held_out[other];
            told.before.residual[row] = stage.residual[other];
        }
    }
    told.diagnosis.wrong = wrong;
    told.diagnosis.gains = engine::gains(&evidence, &told.before.held_out, &told.after.held_out);
    told.diagnosis.gain = told.diagnosis.gains[0].clone();
}

fn density_cause(told: &Outcome, evidence: &Evidence, error: DensityError) -> Cause {
    let quantity = &evidence.quantities[0];
    let rms = |values| holdout::rms(values, quantity.rows.clone());
    let (before, after) = (rms(&told.before.held_out), rms(&told.after.held_out));
    let (cause, parameters) = match error {
        DensityError::AtZeroPressure => ("density_at_zero_pressure", Default::default()),
        DensityError::Bias(bias, se) => {
            ("density_bias", [("density_bias_kg_m3".to_owned(), Estimate::normal(bias, se, "kg/m3"))].into())
        }
    };
    let blocks: std::collections::BTreeSet<usize> = evidence.block.iter().copied().collect();
    // The log's own temperature, salinity and pressure say it sample by sample: chance has no part in it.
    let after_it = told.diagnosis.causes.first().map_or(after, |next| next.holdout_rms_before);
    Cause {
        cause: cause.to_owned(),
        parameters,
        p_value: 0.0,
        delta_bic: 2.0 * blocks.len() as f64 * (before / after_it).ln(),
        quantity: quantity.name.to_owned(),
        holdout_rms_before: before,
        holdout_rms_after: after_it,
        indistinguishable_from: Vec::new(),
    }
}

/// Without temperature and salinity a density at p = 0 is a hull that yields less than it does by the compressibility of
/// the water: where that is the size that was found, the two cannot be told apart.
fn name_what_density_hides(told: &mut Outcome, problem: &SeaProblem, checks: &[Check]) {
    let unchecked =
        checks.iter().any(|check| check.check == consistency::DENSITY && check.outcome == Checked::NotChecked);
    let row = parameter_index("hull_compressibility_per_Pa");
    let neutral = problem.candidates().iter().find(|candidate| candidate.name == "hull_compressibility");
    let (true, Some(_), Some(neutral)) = (unchecked, row, neutral) else {
        return;
    };
    for cause in told.diagnosis.causes.iter_mut().filter(|cause| cause.cause == "hull_compressibility") {
        let Some(found) = cause.parameters.get("hull_compressibility_per_Pa") else { continue };
        let apart = found.value - (neutral.neutral[0] - WATER_COMPRESSIBILITY_PER_PA);
        if apart.abs() <= (found.ci95[1] - found.value) + 0.1 * WATER_COMPRESSIBILITY_PER_PA {
            cause.indistinguishable_from.push("density_at_zero_pressure".to_owned());
        }
    }
}

/// The mechanisms that no steady glide can show, and those that the checks settle.
fn unweighed(checks: &[Check], told: &Outcome, has_speed: bool) -> Vec<crate::diagnose::Rejected> {
    let density = checks.iter().find(|check| check.check == consistency::DENSITY);
    let reject = |cause: &str, why: String| crate::diagnose::Rejected {
        cause: cause.to_owned(),
        p_value: None,
        holdout_rms_after: None,
        why,
    };
    let mut found = vec![reject(
        "inertia",
        "samples near inflections take no part, and along the glide the vehicle's own inertia is in the model; it has no free size".to_owned(),
    )];
    if !has_speed {
        let why = "without a measured speed lift slope and drag take up what a scale of the pitch would do";
        found.push(reject("pitch_scale", why.to_owned()));
    }
    let is_named = told.diagnosis.causes.iter().any(|cause| cause.cause == "density_at_zero_pressure");
    if let Some(check) = density.filter(|_| !is_named) {
        let why = match check.outcome {
            Checked::NotChecked => format!("not checked: {}", check.says),
            _ => check.says.clone(),
        };
        found.push(reject("density_at_zero_pressure", why));
    }
    found
}
