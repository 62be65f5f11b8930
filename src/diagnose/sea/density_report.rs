//! Reports a density that the consistency checks found wrong, or could not check: the cause, the misfit of the log as read, and the
//! equivalent mechanism. Knows the checks' answer and the diagnosis of the corrected log.

use std::collections::BTreeMap;

use super::SeaProblem;
use super::consistency::{self, DensityError};
use crate::diagnose::findings::{Cause, Check, Checked, Verdict};
use crate::diagnose::{Evidence, Outcome, Problem, engine, gains, holdout};
use crate::dynamics::parameter_index;
use crate::estimate::Estimate;

/// Relative compressibility of sea water \[1/Pa\], within a tenth over the ocean's upper kilometre (TEOS-10).
const WATER_COMPRESSIBILITY_PER_PA: f64 = 4.4e-10;

/// Adds the error that the checks found as the first cause, with the misfit of the log as read where the model fits it at all.
pub(super) fn add_cause(
    outcome: &mut Outcome,
    corrected: &SeaProblem,
    as_read: Option<&SeaProblem>,
    error: DensityError,
    carried_kg_m3: f64,
) {
    if let Some(raw) = as_read {
        put_before(outcome, corrected, raw);
    }
    let evidence = corrected.evidence(&outcome.after.point);
    outcome.diagnosis.causes.insert(0, density_cause(outcome, &evidence, error, carried_kg_m3));
    outcome.diagnosis.verdict = match outcome.diagnosis.verdict {
        Verdict::None | Verdict::Explained => Verdict::Explained,
        Verdict::PartlyExplained | Verdict::Unexplained => Verdict::PartlyExplained,
    };
}

/// Puts the misfit of the log as read in place of the corrected log's baseline, row by row.
fn put_before(outcome: &mut Outcome, corrected: &SeaProblem, raw: &SeaProblem) {
    let (stage, wrong) = engine::baseline(raw);
    let key = |evidence: &Evidence, row: usize| {
        let quantity = evidence.quantities.iter().position(|q| q.rows.contains(&row));
        (quantity, evidence.time_s[row].to_bits())
    };
    let evidence = raw.evidence(&stage.point);
    let known: std::collections::HashMap<_, usize> =
        (0..stage.residual.len()).map(|row| (key(&evidence, row), row)).collect();
    let evidence = corrected.evidence(&outcome.after.point);
    for row in 0..outcome.before.residual.len() {
        if let Some(&other) = known.get(&key(&evidence, row)) {
            outcome.before.held_out[row] = stage.held_out[other];
            outcome.before.residual[row] = stage.residual[other];
        }
    }
    outcome.diagnosis.wrong = wrong;
    outcome.diagnosis.gains = gains(&evidence, &outcome.before.held_out, &outcome.after.held_out);
    outcome.diagnosis.gain = outcome.diagnosis.gains[0].clone();
}

/// Returns the cause that the checks found. As for every mechanism, its magnitude includes what the vehicle file already has.
fn density_cause(outcome: &Outcome, evidence: &Evidence, error: DensityError, carried_kg_m3: f64) -> Cause {
    let quantity = &evidence.quantities[0];
    let rms = |values| holdout::rms(values, quantity.rows.clone());
    let (before, after) = (rms(&outcome.before.held_out), rms(&outcome.after.held_out));
    let (cause, parameters) = match error {
        DensityError::AtZeroPressure => ("density_at_zero_pressure", Default::default()),
        DensityError::Bias(bias, se) => {
            let whole = Estimate::normal(carried_kg_m3 + bias, se, "kg/m3");
            ("density_bias", [("density_bias_kg_m3".to_owned(), whole)].into())
        }
    };
    let blocks: std::collections::BTreeSet<usize> = evidence.block.iter().copied().collect();
    // The log's own temperature, salinity and pressure say it sample by sample: chance has no part in it.
    let after_it = outcome.diagnosis.causes.first().map_or(after, |next| next.holdout_rms_before);
    Cause {
        cause: cause.to_owned(),
        parameters,
        p_value: 0.0,
        delta_bic: 2.0 * blocks.len() as f64 * (before / after_it).ln(),
        quantity: quantity.name.to_owned(),
        holdout_rms_before: before,
        holdout_rms_after: after_it,
        stability: Vec::new(),
        log_likelihood_ratio: BTreeMap::new(),
        indistinguishable_from: Vec::new(),
    }
}

/// Adds `density_at_zero_pressure` to the group of a compressibility. Without temperature and salinity, a density evaluated at p = 0 has
/// the same effect as a hull compressibility smaller by that of water: where this difference was found the two are equivalent.
pub(super) fn add_uncheckable(outcome: &mut Outcome, problem: &SeaProblem, checks: &[Check]) {
    let unchecked =
        checks.iter().any(|check| check.check == consistency::DENSITY && check.outcome == Checked::NotChecked);
    let row = parameter_index("hull_compressibility_per_Pa");
    let neutral = problem.candidates().iter().find(|candidate| candidate.name == "hull_compressibility");
    let (true, Some(_), Some(neutral)) = (unchecked, row, neutral) else {
        return;
    };
    for cause in outcome.diagnosis.causes.iter_mut().filter(|cause| cause.cause == "hull_compressibility") {
        let Some(found) = cause.parameters.get("hull_compressibility_per_Pa") else { continue };
        let apart = found.value - (neutral.neutral[0] - WATER_COMPRESSIBILITY_PER_PA);
        if apart.abs() <= (found.ci95[1] - found.value) + 0.1 * WATER_COMPRESSIBILITY_PER_PA {
            cause.indistinguishable_from.push("density_at_zero_pressure".to_owned());
        }
    }
}
