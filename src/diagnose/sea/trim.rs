//! A trim that was assumed: part of the baseline while mechanisms are searched for, reported against the assumption.

use glidepolar_inference::score::CLEARLY_WRONG;

use super::candidates::{self, Tried};
use super::{LEAST_KNOWN, SeaProblem, Shape, Slopes};
use crate::diagnose::evidence::Candidate;
use crate::diagnose::findings::{Verdict, Wrong};
use crate::diagnose::{Outcome, engine};
use crate::dynamics::Parameters;
use crate::mechanisms::AT_SEA;

/// The parameter that a fitted trim is.
pub(super) const PARAMETER: &str = "ballast_offset_kg";

/// The mechanism with that parameter.
const MECHANISM: &str = "ballast_offset";

/// The mechanisms that cannot be distinguished from a trim.
pub(super) const OFFSETS: [&str; 2] = [MECHANISM, "density_bias"];

/// To this density of the water gliders are ballasted \[kg/m3\]: what more the water has on the day is a trim.
const BALLASTING_KG_M3: f64 = 1.0;

/// Density of sea water near the surface, where the volume of a glider is wanted \[kg/m3\].
const SEA_WATER_KG_M3: f64 = 1025.0;

/// Prior standard deviation of a trim \[kg\]: that of the mechanism.
pub(super) fn prior_sd_kg() -> f64 {
    AT_SEA.iter().find(|known| known.name == MECHANISM).map_or(f64::INFINITY, |known| known.size.prior_sd)
}

impl SeaProblem {
    /// Whether the trim is fitted as part of the baseline, since it was assumed.
    pub(super) fn fits_trim(&self) -> bool {
        self.baseline.iter().any(|(name, _)| *name == PARAMETER)
    }

    /// The same problem with a fitted trim as a mechanism, and what was decided beside it with the trim's size; both as they are where
    /// the trim was stated.
    ///
    /// Which mechanisms have a name is decided beside a free trim: where it is assumed, the first of them to imitate a trim would have
    /// its place. What is reported compares with the assumption. A trim of no more than `most_kg` says nothing of what is wrong.
    pub(super) fn with_trim_as_cause(self, decided: Outcome, most_kg: f64) -> (SeaProblem, Outcome) {
        let mut problem = self;
        let Some(place) = problem.baseline.iter().position(|(name, _)| *name == PARAMETER) else {
            return (problem, decided);
        };
        problem.baseline.remove(place);
        problem.baseline_index.remove(place);
        let mut point = decided.after.point;
        let trim_kg = point.baseline.remove(place);
        let all = candidates::list(&problem.bins, &problem.channels, &Tried::default(), &problem.parameters);
        let is_trim = |candidate: &Candidate| candidate.name == MECHANISM;
        let mut added = 0;
        for (candidate, row) in all.into_iter().filter(|(candidate, _)| OFFSETS.contains(&candidate.name)) {
            point.candidates.insert(added, if is_trim(&candidate) { vec![trim_kg] } else { candidate.neutral.clone() });
            problem.shapes.insert(added, Shape { row, slopes: Slopes::Direction(problem.directions.index_of(row)) });
            problem.candidates.insert(added, candidate);
            added += 1;
        }
        let trim = problem.candidates.iter().position(is_trim);
        let included: Vec<usize> = trim.into_iter().chain(decided.fitted.iter().map(|member| member + added)).collect();
        let curve = decided.diagnosis.unexplained.as_ref().and_then(|left| left.depends_on.first().cloned());
        let no_fault = trim.filter(|_| trim_kg.abs() <= most_kg);
        let mut outcome = engine::decided(&problem, &point, &included, no_fault, curve);
        outcome.diagnosis.unexplained = decided.diagnosis.unexplained;
        outcome.diagnosis.rejected = decided.diagnosis.rejected;
        outcome.refused = decided.refused.iter().map(|member| member + added).collect();
        (problem, outcome)
    }
}

/// Reports a ballast offset against a baseline that was assumed, as the trim. It is no fault of the glider where it does not exceed this,
/// is not clear, or is known by fewer standard errors than a name needs.
pub(super) fn report(outcome: &mut Outcome, most_kg: f64) {
    let diagnosis = &mut outcome.diagnosis;
    let Some(place) = diagnosis.causes.iter().position(|cause| cause.cause == MECHANISM) else { return };
    let Some(offset) = diagnosis.causes[place].parameters.get(PARAMETER).cloned() else { return };
    let is_clear = diagnosis.causes[place].p_value <= CLEARLY_WRONG;
    let is_beyond = offset.value.abs() > most_kg && offset.value.abs() >= LEAST_KNOWN * offset.se;
    if !is_clear || !is_beyond {
        diagnosis.wrong.retain(|wrong| wrong.regime != Wrong::regime_of(MECHANISM));
    }
    if !is_beyond || diagnosis.wrong.is_empty() {
        diagnosis.causes.remove(place);
        if diagnosis.causes.is_empty() {
            // They would stand in the place of what is no cause any more.
            diagnosis.alternatives.clear();
        }
        diagnosis.verdict = Verdict::new(!diagnosis.causes.is_empty(), diagnosis.unexplained.is_some());
    }
    diagnosis.trim = Some(offset);
}

/// Net mass to which a glider is ballasted \[kg\].
pub(super) fn ballasting_kg(baseline: &Parameters<f64>) -> f64 {
    BALLASTING_KG_M3 * baseline.mass_kg() / SEA_WATER_KG_M3
}
