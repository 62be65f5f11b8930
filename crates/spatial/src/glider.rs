//! A glider in space on its way: body, steering and inputs in one hand, carried through time.

use glidepolar_number::Number;
use glidepolar_ode::{Advance, IntegrationError, Integrator, Jet, Slopes, System};

use super::equations::derivative;
use super::lateral::Body;
use super::outputs::{Outputs, outputs};
use super::servos::next_bend_s;
use super::state::{Inputs, N_STATES, State};
use super::steering::Steering;

/// How many events there are: surface and seabed.
pub const N_EVENTS: usize = 2;

/// The event of meeting the surface.
const SURFACE: usize = 0;

/// States that rates of change can depend on, from the third on; north and east, the memory and the energy are counted.
pub const N_FELT: usize = 16;

/// The first of them.
pub const FIRST_FELT: usize = 2;

/// States of the memory of mechanisms, at rest where no mechanism needs it.
pub const N_MEMORY: usize = 4;

/// Nominal sizes of the states, in their order.
pub const NOMINAL_VALUES: [f64; N_STATES] = State::NOMINALS;

/// Slopes of rates of change in space, along the states that they can depend on and along time.
pub fn slopes(
    time_s: f64,
    state: &[f64; N_STATES],
    rates: impl FnOnce(Direction, State<Direction>) -> State<Direction>,
) -> Slopes<N_STATES, N_FELT> {
    let of_arrays = |time_s, state| rates(time_s, State::from_array(state)).as_array();
    Slopes::new::<{ N_FELT + 1 }>(time_s, state, (FIRST_FELT, &NOMINAL_VALUES), of_arrays)
}

/// A number with its slopes along those states and time.
pub type Direction = Jet<{ N_FELT + 1 }>;

/// A glider with everything that its motion depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpatialGlider {
    /// The numbers of the equations.
    pub body: Body<f64>,
    /// Who gives rudder and roll mass their set-points.
    pub steering: Steering,
    /// What acts on it, at the time `inputs_at_s`.
    pub inputs: Inputs<f64>,
    /// How the inputs change with time, per second; `None` for inputs that stand still.
    pub input_rates: Option<Inputs<f64>>,
    /// Time at which `inputs` holds \[s\].
    pub inputs_at_s: f64,
}

impl SpatialGlider {
    /// A glider with inputs that stand still.
    pub fn new(body: Body<f64>, steering: Steering, inputs: Inputs<f64>) -> Self {
        SpatialGlider { body, steering, inputs, input_rates: None, inputs_at_s: 0.0 }
    }

    /// The inputs at a time and place, with the set-points of the autopilot.
    fn acting<T: Number>(&self, body: &Body<T>, time_s: T, state: &State<T>) -> Inputs<T> {
        let inputs = self.inputs.map(T::constant);
        let inputs = match &self.input_rates {
            None => inputs,
            Some(rates) => inputs.plus(&rates.map(T::constant), time_s - self.inputs_at_s),
        };
        self.steering.steered(body, state, &inputs)
    }

    /// What follows from a state.
    pub fn outputs(&self, time_s: f64, state: &State<f64>) -> Outputs<f64> {
        outputs(&self.body, time_s, state, &self.acting(&self.body, time_s, state))
    }

    /// Carries time and state to `end_s`, over every meeting with surface and seabed.
    ///
    /// # Errors
    /// As [`Integrator::advance`]; time and state are then those of the last event.
    pub fn fly(
        &self,
        integrator: &mut Integrator<N_STATES>,
        time_s: &mut f64,
        state: &mut State<f64>,
        end_s: f64,
    ) -> Result<(), IntegrationError> {
        /// More than a hull that bounces on the seabed meets.
        const MOST_EVENTS: usize = 100_000;
        let mut values = state.as_array();
        for _ in 0..MOST_EVENTS {
            let advance = integrator.advance(self, time_s, &mut values, end_s);
            *state = State::from_array(values);
            match advance? {
                Advance::Reached => return Ok(()),
                Advance::Event(which) if which[SURFACE] && self.rates(*time_s, state).depth_m < 0.0 => {
                    state.energy_J += self.body.plane.surfacing_J;
                    values = state.as_array();
                }
                Advance::Event(_) => {}
            }
        }
        Err(IntegrationError::StepTooSmall { time_s: *time_s })
    }

    fn rates<T: Number>(&self, time_s: T, state: &State<T>) -> State<T> {
        let body = self.body.map(T::constant);
        derivative(&body, time_s, state, &self.acting(&body, time_s, state))
    }
}

impl System<N_STATES, N_FELT, N_EVENTS> for SpatialGlider {
    const NOMINALS: [f64; N_STATES] = NOMINAL_VALUES;
    const FIRST_FELT: usize = FIRST_FELT;
    const COUNTED_IN_ERROR: usize = N_STATES - N_MEMORY;

    fn derivative(&self, time_s: f64, state: &[f64; N_STATES]) -> [f64; N_STATES] {
        let state = State::from_array(*state);
        derivative(&self.body, time_s, &state, &self.acting(&self.body, time_s, &state)).as_array()
    }

    fn slopes(&self, time_s: f64, state: &[f64; N_STATES]) -> Slopes<N_STATES, N_FELT> {
        slopes(time_s, state, |time_s, state| self.rates(time_s, &state))
    }

    fn event_indicators(&self, time_s: f64, state: &[f64; N_STATES]) -> [f64; N_EVENTS] {
        let state = State::from_array(*state);
        [state.depth_m, self.acting(&self.body, time_s, &state).seabed_depth_m - state.depth_m]
    }

    fn next_jump_s(&self, time_s: f64) -> Option<f64> {
        self.body.plane.next_step_s(time_s)
    }

    fn next_bend_s(&self, time_s: f64, state: &[f64; N_STATES]) -> Option<f64> {
        let state = State::from_array(*state);
        next_bend_s(&self.body, time_s, &state, &self.acting(&self.body, time_s, &state))
    }
}
