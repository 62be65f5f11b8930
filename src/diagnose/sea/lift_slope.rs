//! What a fitted lift slope hides, or names, where no speed shows it. Knows the vehicle's slope and what was diagnosed; fits nothing else.

use super::common_drag::CommonDrag;
use super::model::Directions;
use super::{Lift, SeaProblem};
use crate::diagnose::evidence::{Candidate, Problem};
use crate::diagnose::findings::Verdict;
use crate::diagnose::{Outcome, engine, holdout};
use crate::dynamics::parameter_index;

/// What is said where the vehicle's lift slope lets a cause be seen.
pub(super) const SLOPE_HELD: &str = "a fitted lift slope goes far from the vehicle's and leaves something unexplained; held at the vehicle's it does not, and predicts as well: it is held";

/// What is said where a name stands with a fitted lift slope alone.
pub(super) const NAME_REFUTED: &str = "what explains the log beside a fitted lift slope does not stand with the vehicle's own: that is held, and nothing is named";

pub(super) const LIFT_SLOPE: &str = "a_per_rad";

/// What a log says with the lift slope fitted, or with the vehicle's where that says more, or refutes what is named; with what to say of
/// it. `held` diagnoses the log with the vehicle's slope.
pub(super) fn decide(
    problem: SeaProblem,
    outcome: Outcome,
    held: impl FnOnce() -> (SeaProblem, Outcome),
) -> (SeaProblem, Outcome, Option<&'static str>) {
    let is_hidden = problem.is_hidden_by_a_far_slope(&outcome);
    let rests_on_it = !problem.names_stand_without_the_slope(&outcome);
    match (is_hidden || rests_on_it).then(held) {
        Some((held, of_held)) if is_hidden && held.explains_as_well(&of_held, &outcome) => {
            (held, of_held, Some(SLOPE_HELD))
        }
        Some((held, of_held)) if rests_on_it && of_held.named.is_empty() => (held, of_held, Some(NAME_REFUTED)),
        _ => (problem, outcome, None),
    }
}

impl SeaProblem {
    /// Whether something is wrong that no mechanism explains beside a lift slope that is far from the vehicle's: where no speed shows
    /// it, it may take up what a cause did.
    pub(super) fn is_hidden_by_a_far_slope(&self, outcome: &Outcome) -> bool {
        let is_left = matches!(outcome.diagnosis.verdict, Verdict::Unexplained | Verdict::PartlyExplained);
        let points = [&outcome.before.point, &outcome.after.point];
        is_left && !self.has_speed() && points.iter().any(|point| self.has_far_lift_slope(point))
    }

    /// Whether the names of a log rest on no fitted lift slope: nothing is named, a speed shows the slope, or some of them stand with
    /// the vehicle's too, everything else fitted again.
    fn names_stand_without_the_slope(&self, outcome: &Outcome) -> bool {
        if outcome.named.is_empty() || self.has_speed() || self.lift != Lift::Fitted {
            return true;
        }
        let held = self.with_lift_held();
        let same = |member: &usize| {
            let wanted = &self.candidates[*member];
            let is_same = |one: &Candidate| {
                one.name == wanted.name && one.version.map(|v| v.value) == wanted.version.map(|v| v.value)
            };
            held.candidates.iter().position(is_same).map(|place| (place, *member))
        };
        let members: Vec<(usize, usize)> = outcome.fitted.iter().filter_map(same).collect();
        let mut point = held.start();
        point.baseline = self.without_lift_slope(&outcome.after.point.baseline);
        for (place, member) in &members {
            point.candidates[*place].clone_from(&outcome.after.point.candidates[*member]);
        }
        let places: Vec<usize> = members.iter().map(|(place, _)| *place).collect();
        engine::is_any_standing(&held, &point, &places)
    }

    /// The same problem with the vehicle's lift slope held.
    pub(super) fn with_lift_held(&self) -> SeaProblem {
        let mut held = SeaProblem {
            lift: Lift::Held,
            baseline: self.without_lift_slope(&self.baseline),
            baseline_index: self.baseline_index.clone(),
            ..self.clone()
        };
        held.baseline_index.retain(|index| Some(*index) != parameter_index(LIFT_SLOPE));
        held.directions = Directions::new(&held.baseline_index);
        let pitch = parameter_index("pitch_offset_rad").expect("a row of the table");
        held.pitch_direction = held.directions.index_of(pitch);
        held.common_drag = CommonDrag::new(&self.parameters, &mut held.directions);
        held.look_for(self.tried.clone());
        held
    }

    /// What belongs to the parameters of the baseline, but for the lift slope.
    fn without_lift_slope<T: Clone>(&self, of_baseline: &[T]) -> Vec<T> {
        let of_names = self.baseline.iter().zip(of_baseline);
        of_names.filter(|((name, _), _)| *name != LIFT_SLOPE).map(|(_, one)| one.clone()).collect()
    }

    /// Whether a diagnosis explains its log, and predicts held-out vertical velocity for certain no worse than another of the same log.
    fn explains_as_well(&self, outcome: &Outcome, other: &Outcome) -> bool {
        let evidence = self.evidence(&outcome.after.point);
        let rows = evidence.quantities[0].rows.clone();
        let gained =
            || holdout::reduction_interval(&evidence.block, rows, &outcome.after.held_out, &other.after.held_out);
        outcome.diagnosis.verdict == Verdict::Explained
            && outcome.after.held_out.len() == other.after.held_out.len()
            && gained()[0] <= 0.0
    }
}
