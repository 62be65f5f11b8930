//! How the calculated variables change with the others: derivatives to rounding, by dual numbers through the very
//! equations that give the values.

use glidepolar_dynamics::N_STATES;
use glidepolar_dynamics::limits::N_EVENTS;
use glidepolar_number::Number;
use num_dual::Dual64;

use super::glider::{ENERGY, Glider, Values};
use super::table::{N_OUTPUTS, Slot};

/// The change of everything that follows, per change along one direction.
#[derive(Debug, Clone, Copy)]
pub struct Tangent {
    values: Values<Dual64>,
    derivative: [f64; N_STATES],
    outputs: [f64; N_OUTPUTS],
    indicators: [f64; N_EVENTS],
}

impl Tangent {
    /// The change along `direction`, which names places that do not follow from others, and how fast each moves. During
    /// initialisation (`starting`) the states that follow from other starts move with them.
    pub fn along(glider: &Glider, starting: bool, direction: impl IntoIterator<Item = (Slot, f64)>) -> Self {
        let mut values = lift(&glider.values);
        for (slot, rate) in direction {
            // The same variable may be named twice; its rates add up.
            if let Some(value) = values.get(slot) {
                values.set(slot, Dual64::new(value.re, value.eps + rate));
            }
        }
        if starting {
            values.complete_start();
        }
        let rules = glider.rules();
        let active = rules.parameters(&values.parameters);
        let Values { time_s, state, inputs, .. } = &values;
        let rates = rules.rates(&active, *time_s, state, inputs).as_array();
        let indicators = rules.published_indicators(&active, *time_s, state, inputs);
        Tangent {
            derivative: rates.map(|rate| rate.eps),
            outputs: rules.outputs(&values).map(|output| output.eps),
            indicators: indicators.map(|indicator| indicator.eps),
            values,
        }
    }

    /// The rate of change of every output in time, the inputs moving at `input_rates`.
    pub fn in_time(glider: &Glider, input_rates: impl IntoIterator<Item = f64>) -> Self {
        let states = glider.derivative().as_array().into_iter().enumerate().map(|(i, rate)| (Slot::State(i), rate));
        let inputs = input_rates.into_iter().enumerate().map(|(i, rate)| (Slot::Input(i), rate));
        Self::along(glider, false, states.chain(inputs).chain([(Slot::Time, 1.0)]))
    }

    /// The change of what stands in this place; none for what is not a number.
    pub fn of(&self, slot: Slot) -> Option<f64> {
        match slot {
            Slot::Derivative(i) => Some(self.derivative[i]),
            Slot::Power => Some(self.derivative[ENERGY]),
            Slot::Output(i) => Some(self.outputs[i]),
            Slot::Indicator(i) => Some(self.indicators[i]),
            slot => self.values.get(slot).map(|value| value.eps),
        }
    }
}

fn lift(values: &Values<f64>) -> Values<Dual64> {
    Values {
        parameters: values.parameters.map(Dual64::constant),
        time_s: Dual64::constant(values.time_s),
        state: values.state.map(Dual64::constant),
        inputs: values.inputs.map(Dual64::constant),
    }
}
