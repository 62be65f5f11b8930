//! A trim that was assumed: part of the baseline while mechanisms are searched for, reported against the assumption.

use super::{SeaProblem, Shape, Slopes, candidates};
use crate::diagnose::evidence::Candidate;
use crate::diagnose::findings::Verdict;
use crate::diagnose::{Outcome, engine};
use crate::dynamics::Parameters;
use crate::identify::surroundings;
use crate::log::Observation;
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
    AT_SEA.iter().find(|known| known.name == MECHANISM).map_or(f64::INFINITY, |known| known.prior_sd)
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
    /// its place. What is reported compares with the assumption.
    pub(super) fn with_trim_as_cause(self, decided: Outcome) -> (SeaProblem, Outcome) {
        let mut problem = self;
        let Some(place) = problem.baseline.iter().position(|(name, _)| *name == PARAMETER) else {
            return (problem, decided);
        };
        problem.baseline.remove(place);
        problem.baseline_index.remove(place);
        let mut point = decided.after.point;
        let trim_kg = point.baseline.remove(place);
        let all = candidates::list(&problem.bins, &problem.channels, &[], &problem.parameters);
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
        let mut outcome = engine::decided(&problem, &point, &included, trim, curve);
        outcome.diagnosis.unexplained = decided.diagnosis.unexplained;
        outcome.diagnosis.rejected = decided.diagnosis.rejected;
        outcome.refused = decided.refused.iter().map(|member| member + added).collect();
        (problem, outcome)
    }
}

/// Reports a ballast offset against a baseline that was assumed to be neutral as the trim. Where the glider is neutral in some water of
/// the log, within the tolerance of ballasting, or nothing is wrong without the offset, it is no fault: nobody has said for which water
/// it was ballasted.
pub(super) fn report(outcome: &mut Outcome, baseline: &Parameters<f64>, observations: &[Observation]) {
    let ballasting_kg = BALLASTING_KG_M3 * baseline.mass_kg() / SEA_WATER_KG_M3;
    report_unless(outcome, |offset_kg| from_neutral_kg(offset_kg, baseline, observations) > ballasting_kg);
}

/// The same of an offset from a weight that was stated, and that may be off by this much as the water's temperature is not known.
pub(super) fn report_beyond(outcome: &mut Outcome, most_kg: f64) {
    report_unless(outcome, |offset_kg| offset_kg.abs() > most_kg);
}

fn report_unless(outcome: &mut Outcome, is_fault: impl Fn(f64) -> bool) {
    let diagnosis = &mut outcome.diagnosis;
    let Some(place) = diagnosis.causes.iter().position(|cause| cause.cause == MECHANISM) else { return };
    let Some(offset) = diagnosis.causes[place].parameters.get(PARAMETER).cloned() else { return };
    if !is_fault(offset.value) || diagnosis.wrong.is_empty() {
        diagnosis.causes.remove(place);
        if diagnosis.causes.is_empty() {
            // They would stand in the place of what is no cause any more.
            diagnosis.alternatives.clear();
        }
        diagnosis.verdict = match (diagnosis.causes.is_empty(), diagnosis.unexplained.is_some()) {
            (true, false) => Verdict::None,
            (true, true) => Verdict::Unexplained,
            (false, true) => Verdict::PartlyExplained,
            (false, false) => Verdict::Explained,
        };
    }
    diagnosis.trim = Some(offset);
}

/// By how much an offset leaves the glider from neutral at ballast volume zero, in the water of the steady samples that suits it best
/// \[kg\]: zero where it is neutral in some of it.
pub(super) fn from_neutral_kg(offset_kg: f64, baseline: &Parameters<f64>, observations: &[Observation]) -> f64 {
    let steady = observations.iter().filter(|o| o.steady);
    let net = steady.map(|o| baseline.net_mass_kg(0.0, &surroundings(baseline, o))).filter(|kg| kg.is_finite());
    // The mean water, of which the assumption speaks, counts as well.
    let [least, most] = net.fold([0.0, 0.0], |[least, most]: [f64; 2], kg| [least.min(kg), most.max(kg)]);
    (-most - offset_kg).max(offset_kg + least).max(0.0)
}
