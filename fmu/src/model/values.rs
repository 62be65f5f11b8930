//! All numbers of a model that do not follow from others, as rows of one length for every model: whoever gets, sets, saves
//! or differentiates them needs to know no model.

use glidepolar_dynamics::parameters::N_PARAMETERS;
use glidepolar_number::Number;
use glidepolar_spatial::N_LATERAL;

use super::variable::Slot;

/// Room for the continuous states of every model.
pub const MOST_STATES: usize = glidepolar_spatial::N_STATES;
/// Room for the inputs of every model.
pub const MOST_INPUTS: usize = glidepolar_spatial::N_INPUTS;
/// Room for the parameters of every model.
pub const MOST_PARAMETERS: usize = N_PARAMETERS + N_LATERAL;
/// Room for the outputs of every model.
pub const MOST_OUTPUTS: usize = 32;
/// Room for the event indicators of every model.
pub const MOST_EVENTS: usize = 10;

/// The quantities that the equations read, in any kind of number. What a model does not have is zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Values<T> {
    /// Parameters.
    pub parameters: [T; MOST_PARAMETERS],
    /// Time \[s\].
    pub time_s: T,
    /// Continuous states.
    pub state: [T; MOST_STATES],
    /// Inputs.
    pub inputs: [T; MOST_INPUTS],
}

impl<T: Number> Values<T> {
    /// A number that does not follow from others.
    pub fn get(&self, slot: Slot) -> Option<T> {
        match slot {
            Slot::Time => Some(self.time_s),
            Slot::Input(i) => self.inputs.get(i).copied(),
            Slot::State(i) => self.state.get(i).copied(),
            Slot::Parameter(i) => self.parameters.get(i).copied(),
            _ => None,
        }
    }

    /// Sets a number that does not follow from others; nothing else can be set.
    pub fn set(&mut self, slot: Slot, value: T) {
        let place = match slot {
            Slot::Time => Some(&mut self.time_s),
            Slot::Input(i) => self.inputs.get_mut(i),
            Slot::State(i) => self.state.get_mut(i),
            Slot::Parameter(i) => self.parameters.get_mut(i),
            _ => None,
        };
        if let Some(place) = place {
            *place = value;
        }
    }
}

impl Values<f64> {
    /// The same in another kind of number.
    pub fn lifted<T: Number>(&self) -> Values<T> {
        Values {
            parameters: self.parameters.map(T::constant),
            time_s: T::constant(self.time_s),
            state: self.state.map(T::constant),
            inputs: self.inputs.map(T::constant),
        }
    }
}

/// The first `N` of a row.
pub fn head<T: Copy, const N: usize, const M: usize>(row: &[T; M]) -> [T; N] {
    const { assert!(N <= M, "a row has room for every model") };
    std::array::from_fn(|i| row[i])
}

/// A row that begins with these, and is zero where they end.
pub fn row<T: Number, const N: usize, const M: usize>(values: [T; N]) -> [T; M] {
    const { assert!(N <= M, "a row has room for every model") };
    std::array::from_fn(|i| if i < N { values[i] } else { T::constant(0.0) })
}
