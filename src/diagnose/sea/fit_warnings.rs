//! Warnings about a fit: a polar, a current, a scale of the pitch that are far from the prior. Knows the fitted points; no samples.

use super::lift_slope::LIFT_SLOPE;
use super::{Lift, MOST_USUAL, SeaProblem};
use crate::diagnose::evidence::Point;
use crate::identify::unknown_shear::DIFFERENCE_M_S;
use crate::report::significant;

/// Ratio of a fitted coefficient of the polar to the vehicle's, or the reverse, from which on a warning is due.
const FAR_FROM_BELIEF: f64 = 3.0;

/// What to do where a lift slope runs away, or a scale of the pitch stands beside it.
const PITCH_OR_LIFT: &str = "a lift slope and a scale of the pitch cannot be distinguished by vertical velocity and speed: hold the slope at an outside value (--pin-lift=A)";

impl SeaProblem {
    /// Whether the lift slope of a point is far from what the vehicle says.
    pub(super) fn has_far_lift_slope(&self, point: &Point) -> bool {
        let mut believed = self.parameters;
        let place = self.baseline.iter().position(|(name, _)| *name == LIFT_SLOPE);
        place.is_some_and(|place| {
            let belief = *believed.at(self.baseline_index[place]);
            let is_usual = |ratio: f64| (1.0 / FAR_FROM_BELIEF..=FAR_FROM_BELIEF).contains(&ratio);
            belief > 0.0 && !is_usual(point.baseline[place] / belief)
        })
    }

    /// Warnings about the fit, in a sentence each: parameters of the baseline that lie far from what the vehicle says,
    /// `alone` or with what was `named`, and a scale of the pitch beside a lift slope that was fitted as well.
    pub fn warnings(&self, alone: &Point, named: &Point) -> Vec<String> {
        let mut believed = self.parameters;
        let mut warnings: Vec<String> = Vec::new();
        for (i, ((name, unit), index)) in self.baseline.iter().zip(&self.baseline_index).enumerate() {
            let belief = *believed.at(*index);
            let is_far = |value: f64| {
                let ratio = value / belief;
                if belief > 0.0 {
                    !(1.0 / FAR_FROM_BELIEF..=FAR_FROM_BELIEF).contains(&ratio)
                } else {
                    (value - belief).abs() > (FAR_FROM_BELIEF - 1.0) * belief.abs().max(0.1)
                }
            };
            let (value, when) = match (alone.baseline[i], named.baseline[i]) {
                (_, value) if is_far(value) => (value, ""),
                // A drag that only the misfit drove away has come back with its cause; a lift slope says more.
                (value, _) if is_far(value) && *name == LIFT_SLOPE => (value, " as long as nothing is named"),
                _ => continue,
            };
            let pitch = if *name == LIFT_SLOPE { format!("; {PITCH_OR_LIFT}") } else { String::new() };
            let unit = if *unit == "1" { String::new() } else { format!(" {unit}") };
            warnings.push(format!("`{name}` = {value:.3}{unit}{when} is far from the vehicle's {belief:.3}{pitch}"));
        }
        let is_scaled = self.candidates.iter().zip(&named.candidates).any(|(candidate, values)| {
            candidate.name == "pitch_scale" && *values != candidate.neutral && self.lift == Lift::Fitted
        });
        if is_scaled && !warnings.iter().any(|warning| warning.ends_with(PITCH_OR_LIFT)) {
            warnings.push(format!(
                "the scale of the pitch rests on a lift slope that was fitted beside it: {PITCH_OR_LIFT}"
            ));
        }
        for (candidate, values) in self.candidates.iter().zip(&named.candidates) {
            if *values != candidate.neutral && candidate.is_unusual(values[0]) {
                let (name, unit) = candidate.parameters[0];
                let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
                let [low, high] =
                    [-1.0, 1.0].map(|sign| candidate.neutral[0] + sign * MOST_USUAL * candidate.prior_sd[0]);
                warnings.push(format!(
                    "`{name}` = {}{unit} is a size that is seldom seen (usually {} to {}): named because nothing else explains the log",
                    significant(values[0], 3),
                    significant(low.max(candidate.possible[0]), 3),
                    significant(high, 3)
                ));
            }
        }
        let current_m_s = self.shear.difference_m_s(self.shear_coefficients(named));
        if current_m_s > MOST_USUAL * DIFFERENCE_M_S {
            warnings.push(format!(
                "the fit needs a current that differs by {current_m_s:.2} m/s between the surface and the deepest, more than most seas have: something else may depend on depth and leg"
            ));
        }
        warnings
    }
}
