//! Partial derivatives, forward and adjoint, of any calculated number with respect to any number that is not.

use super::Instance;
use super::phase::Phase;
use super::refusal::{Outcome, Refusal};
use crate::model::tangent::Tangent;
use crate::model::{Initial, Kind, Slot, Variable};

impl Instance {
    /// `sensitivity = d unknowns / d knowns * seed`.
    pub fn directional_derivative(
        &self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivity: &mut [f64],
    ) -> Outcome {
        let knowns = self.knowns(knowns)?;
        check_seed(seed)?;
        let direction = knowns.iter().copied().zip(seed.iter().copied()).filter(|(_, seed)| *seed != 0.0);
        let tangent = self.tangent(direction);
        for (&unknown, sensitivity) in unknowns.iter().zip(sensitivity) {
            let unknown = self.unknown(unknown)?;
            *sensitivity = tangent.as_ref().map_or(Ok(0.0), |tangent| of(tangent, unknown))?;
        }
        Ok(())
    }

    /// `sensitivity = (d unknowns / d knowns)^T * seed`.
    pub fn adjoint_derivative(
        &self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivity: &mut [f64],
    ) -> Outcome {
        let knowns = self.knowns(knowns)?;
        check_seed(seed)?;
        let unknowns: Vec<&Variable> =
            unknowns.iter().map(|&reference| self.unknown(reference)).collect::<Outcome<_>>()?;
        let seeded = || unknowns.iter().zip(seed).filter(|(_, seed)| **seed != 0.0);
        for (&known, sensitivity) in knowns.iter().zip(sensitivity) {
            *sensitivity = 0.0;
            if seeded().next().is_none() {
                continue;
            }
            if let Some(tangent) = self.tangent([(known, 1.0)]) {
                for (unknown, seed) in seeded() {
                    *sensitivity += seed * of(&tangent, unknown)?;
                }
            }
            if !sensitivity.is_finite() {
                return Err(too_large(*sensitivity));
            }
        }
        Ok(())
    }

    /// How everything changes along a direction; none for no direction, along which nothing does, whatever the values are.
    fn tangent(&self, direction: impl IntoIterator<Item = (Slot, f64)>) -> Option<Tangent> {
        let mut direction = direction.into_iter().peekable();
        direction.peek()?;
        Some(Tangent::along(&self.now(), self.core.phase.is_starting(), direction))
    }

    /// What a derivative can be taken of.
    fn unknown(&self, reference: u32) -> Outcome<&'static Variable> {
        let variable = self.of_kind(reference, Kind::Real)?;
        match variable.slot {
            Slot::Derivative(_) | Slot::Power | Slot::Output(_) | Slot::Indicator(_) | Slot::State(_) => Ok(variable),
            _ => Err(Refusal::error(format!("{} is not an unknown: it follows from nothing", variable.name))),
        }
    }

    /// What a derivative can be taken with respect to: during initialisation all that a start value or time decides,
    /// afterwards states, inputs, time and tunable parameters.
    fn knowns(&self, references: &[u32]) -> Outcome<Vec<Slot>> {
        let known = |&reference: &u32| {
            let variable = self.of_kind(reference, Kind::Real)?;
            let starts = variable.initial == Some(Initial::Exact);
            match variable.slot {
                Slot::Time | Slot::Input(_) | Slot::Parameter(_) => Ok(variable.slot),
                Slot::State(_) if starts || self.core.phase != Phase::Initialization => Ok(variable.slot),
                _ => Err(Refusal::error(format!("{} is not a known here: it follows from others", variable.name))),
            }
        };
        references.iter().map(known).collect()
    }
}

fn of(tangent: &Tangent, variable: &Variable) -> Outcome<f64> {
    match tangent.of(variable.slot) {
        Some(change) if change.is_finite() => Ok(change),
        Some(change) => Err(Refusal::discard(format!("for {}: {}", variable.name, too_large(change).message))),
        None => Err(Refusal::error(format!("{} has no derivative", variable.name))),
    }
}

fn too_large(change: f64) -> Refusal {
    Refusal::discard(format!(
        "the derivative is {change} here: states, inputs, parameters or seeds are out of range; go back to where they were"
    ))
}

fn check_seed(seed: &[f64]) -> Outcome {
    match seed.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(Refusal::error(format!("a seed is {value}: expected finite numbers"))),
        None => Ok(()),
    }
}
