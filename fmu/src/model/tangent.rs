//! How the calculated variables change with the others: derivatives to rounding, by dual numbers through the very
//! equations that give the values.

use num_dual::Dual64;

use super::glider::{Glider, complete_start};
use super::values::{MOST_EVENTS, MOST_OUTPUTS, MOST_STATES, Values};
use super::variable::Slot;
use super::which::Model;

/// The change of everything that follows, per change along one direction.
#[derive(Debug, Clone, Copy)]
pub struct Tangent {
    model: Model,
    values: Values<Dual64>,
    derivative: [f64; MOST_STATES],
    outputs: [f64; MOST_OUTPUTS],
    indicators: [f64; MOST_EVENTS],
}

impl Tangent {
    /// The change along `direction`, which names places that do not follow from others, and how fast each moves. During
    /// initialisation (`starting`) the states that follow from other starts move with them.
    pub fn along(glider: &Glider, starting: bool, direction: impl IntoIterator<Item = (Slot, f64)>) -> Self {
        let mut values = glider.values.lifted::<Dual64>();
        for (slot, rate) in direction {
            // The same variable may be named twice; its rates add up.
            if let Some(value) = values.get(slot) {
                values.set(slot, Dual64::new(value.re, value.eps + rate));
            }
        }
        let rules = glider.rules();
        if starting {
            complete_start(glider.model, &mut values);
        }
        Tangent {
            model: glider.model,
            derivative: rules.derivative(&values).map(|rate| rate.eps),
            outputs: rules.outputs(&values).map(|output| output.eps),
            indicators: rules.published_indicators(&values).map(|indicator| indicator.eps),
            values,
        }
    }

    /// The rate of change of every output in time, the inputs moving at `input_rates`.
    pub fn in_time(glider: &Glider, input_rates: impl IntoIterator<Item = f64>) -> Self {
        let states = glider.derivative().into_iter().enumerate().map(|(i, rate)| (Slot::State(i), rate));
        let inputs = input_rates.into_iter().enumerate().map(|(i, rate)| (Slot::Input(i), rate));
        Self::along(glider, false, states.chain(inputs).chain([(Slot::Time, 1.0)]))
    }

    /// The change of what stands in this place; none for what is not a number.
    pub fn of(&self, slot: Slot) -> Option<f64> {
        match slot {
            Slot::Derivative(i) => Some(self.derivative[i]),
            Slot::Power => Some(self.derivative[self.model.energy()]),
            Slot::Output(i) => Some(self.outputs[i]),
            Slot::Indicator(i) => Some(self.indicators[i]),
            slot => self.values.get(slot).map(|value| value.eps),
        }
    }
}
