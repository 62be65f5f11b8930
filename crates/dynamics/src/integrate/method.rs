//! What the integrator asks of a method, and the system in the units in which methods work.

use num_dual::DualSVec64;

use super::{IntegrationError, System};
use crate::limits::N_EVENTS;
use crate::state::{N_MEMORY, N_STATES, STATE_NOMINALS, State};
use glidepolar_number::Number;

/// States that rates of change can depend on, from the second on.
pub const N_FELT: usize = N_STATES - 2 - N_MEMORY;

/// The others, which are only counted: the horizontal position and the energy drawn. (Over a seabed that slopes, a hull that
/// touches it feels its position; the Jacobian leaves that out, and the error control answers with shorter steps. So it does
/// with the memory, which changes over minutes and hours and moves the glider by some grams.)
pub const COUNTED: [usize; 2 + N_MEMORY] = [0, N_STATES - 4, N_STATES - 3, N_STATES - 2, N_STATES - 1];

/// A number with its slopes along every state that is felt, and along time.
pub type Jet = DualSVec64<{ N_FELT + 1 }>;

/// A state, or its rates of change, in units of the nominal sizes about an origin.
pub type Scaled = [f64; N_STATES];

/// The part of it that is felt.
pub type Felt = [f64; N_FELT];

/// Takes the part that is felt.
pub fn felt(scaled: &Scaled) -> Felt {
    std::array::from_fn(|j| scaled[j + 1])
}

/// What became of one trial step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trial {
    /// The error is within the tolerance: time and state have moved.
    Accepted,
    /// It is not: nothing moved, the next trial is shorter.
    Rejected,
    /// The method has no way on.
    Failed,
}

/// A method at work about one origin.
pub trait Method<S: System>: Sized {
    /// The method at a time and place, about to try a step of `step_s`.
    fn begin(stretch: &Stretch<'_, S>, tolerance: f64, time_s: f64, step_s: f64) -> Result<Self, IntegrationError>;

    /// Tries the step that is next.
    fn step(&mut self, stretch: &Stretch<'_, S>) -> Trial;

    /// The time reached \[s\].
    fn time_s(&self) -> f64;

    /// The state reached.
    fn place(&self) -> &Scaled;

    /// The step that is next \[s\].
    fn next_step_s(&self) -> f64;

    /// Makes it another.
    fn set_next_step_s(&mut self, step_s: f64);

    /// The state inside the last accepted step.
    fn inside(&mut self, time_s: f64) -> Option<Scaled>;
}

/// The system about an origin, in units of the nominal sizes.
pub struct Stretch<'a, S> {
    /// The system.
    pub system: &'a S,
    /// Where the origin lies; the stretch begins there.
    pub origin: State<f64>,
    /// From this time on the rates jump: they are those before it to the end of the stretch \[s\].
    pub last_s: f64,
}

impl<S: System> Stretch<'_, S> {
    /// The state that a scaled one stands for.
    pub fn state(&self, scaled: &Scaled) -> State<f64> {
        let (origin, nominal) = (self.origin.as_array(), STATE_NOMINALS.as_array());
        State::from_array(std::array::from_fn(|i| origin[i] + scaled[i] * nominal[i]))
    }

    /// Rates of change of the scaled state.
    pub fn rates(&self, time_s: f64, scaled: &Scaled) -> Scaled {
        let derivative = self.system.derivative(time_s.min(self.last_s), &self.state(scaled)).as_array();
        let nominal = STATE_NOMINALS.as_array();
        std::array::from_fn(|i| derivative[i] / nominal[i])
    }

    /// Rates of change of the scaled state, and their slopes along what is felt and along time.
    pub fn slopes(&self, time_s: f64, scaled: &Scaled) -> Slopes {
        let nominal = STATE_NOMINALS.as_array();
        let mut jets = self.state(scaled).as_array().map(Jet::constant);
        for j in 0..N_FELT {
            jets[j + 1] = seeded(jets[j + 1], j, nominal[j + 1]);
        }
        let time = seeded(Jet::constant(time_s.min(self.last_s)), N_FELT, 1.0);
        let rates = self.system.linearised(time, &State::from_array(jets)).as_array();
        let mut slopes =
            Slopes { rates: [0.0; N_STATES], jacobian: [[0.0; N_FELT]; N_STATES], in_time: [0.0; N_STATES] };
        for (i, rate) in rates.iter().enumerate() {
            slopes.rates[i] = rate.re / nominal[i];
            if let Some(eps) = rate.eps.0 {
                for j in 0..N_FELT {
                    slopes.jacobian[i][j] = eps[j] / nominal[i];
                }
                slopes.in_time[i] = eps[N_FELT] / nominal[i];
            }
        }
        slopes
    }

    /// The event indicators at a scaled state.
    pub fn indicators(&self, time_s: f64, scaled: &Scaled) -> [f64; N_EVENTS] {
        self.system.event_indicators(time_s, &self.state(scaled))
    }
}

/// Rates of change and how they change.
pub struct Slopes {
    /// Rates of change.
    pub rates: Scaled,
    /// `jacobian[i][j]`: the slope of rate `i` along the state `j` of those that are felt.
    pub jacobian: [Felt; N_STATES],
    /// Their slopes along time \[1/s\].
    pub in_time: Scaled,
}

fn seeded(jet: Jet, lane: usize, slope: f64) -> Jet {
    let mut eps = nalgebra::SVector::zeros();
    eps[lane] = slope;
    Jet::new(jet.re, num_dual::Derivative::some(eps))
}
