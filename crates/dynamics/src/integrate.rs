//! The state in the vertical plane carried through time by `ode`: its sizes, its magnitudes, and which of its states
//! the rates of change depend on.

use glidepolar_ode::Slopes;
pub use glidepolar_ode::{DEFAULT_TOLERANCE, IMPLICIT_FROM, IntegrationError};

use super::limits::N_EVENTS;
use super::state::{N_MEMORY, N_STATES, State};

/// States that rates of change can depend on, from the second on.
const N_FELT: usize = N_STATES - 2 - N_MEMORY;

/// A number with its slopes along every state that is felt, and along time.
pub type Jet = glidepolar_ode::Jet<{ N_FELT + 1 }>;

/// How far an advance came, see [`glidepolar_ode::Advance`].
pub type Advance = glidepolar_ode::Advance<N_EVENTS>;

/// What moves in the plane: the equations, closed over parameters, modes and inputs.
pub trait System {
    /// Rates of change of the state.
    fn derivative(&self, time_s: f64, state: &State<f64>) -> State<f64>;

    /// The same equations in numbers that carry slopes along.
    fn linearised(&self, time_s: Jet, state: &State<Jet>) -> State<Jet>;

    /// Functions whose change of sign is an event.
    fn event_indicators(&self, time_s: f64, state: &State<f64>) -> [f64; N_EVENTS];

    /// The next time after `time_s` at which the rates jump, if they do.
    fn next_jump_s(&self, time_s: f64) -> Option<f64>;

    /// When the rates will bend, see [`glidepolar_ode::System::next_bend_s`].
    fn next_bend_s(&self, time_s: f64, state: &State<f64>) -> Option<f64>;
}

/// [`glidepolar_ode::Integrator`] of the state in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrator(glidepolar_ode::Integrator<N_STATES>);

impl Integrator {
    /// See [`glidepolar_ode::Integrator::new`].
    pub fn new(tolerance: f64) -> Self {
        Integrator(glidepolar_ode::Integrator::new(tolerance))
    }

    /// The step that comes next \[s\].
    pub fn step_s(&self) -> f64 {
        self.0.step_s()
    }

    /// Takes over the step size of a saved run.
    pub fn with_step_s(self, step_s: f64) -> Self {
        Integrator(self.0.with_step_s(step_s))
    }

    /// Forgets the step size: after a jump of state or inputs the old one says nothing.
    pub fn restart(&mut self) {
        self.0.restart();
    }

    /// See [`glidepolar_ode::Integrator::forget_ahead`].
    pub fn forget_ahead(&mut self) {
        self.0.forget_ahead();
    }

    /// With time and state, all that a continued run depends on, as plain numbers.
    pub fn numbers(&self) -> Vec<f64> {
        self.0.numbers()
    }

    /// The integrator that wrote these [`Integrator::numbers`]; none where no integrator did.
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        glidepolar_ode::Integrator::from_numbers(numbers).map(Integrator)
    }

    /// See [`glidepolar_ode::Integrator::advance`].
    ///
    /// # Errors
    /// Where a rate of change is not finite or no step is small enough; time and state are left as they were.
    pub fn advance(
        &mut self,
        system: &impl System,
        time_s: &mut f64,
        state: &mut State<f64>,
        end_s: f64,
    ) -> Result<Advance, IntegrationError> {
        let mut values = state.as_array();
        let outcome = self.0.advance(&InPlane(system), time_s, &mut values, end_s);
        *state = State::from_array(values);
        outcome
    }

    /// See [`glidepolar_ode::Integrator::follow`].
    ///
    /// # Errors
    /// As [`Integrator::advance`].
    pub fn follow(
        &mut self,
        system: &impl System,
        time_s: &mut f64,
        state: &mut State<f64>,
        end_s: f64,
        horizon_s: f64,
    ) -> Result<Advance, IntegrationError> {
        let mut values = state.as_array();
        let outcome = self.0.follow(&InPlane(system), time_s, &mut values, end_s, horizon_s);
        *state = State::from_array(values);
        outcome
    }
}

/// A system of the plane as the integrator knows systems. Counted only are the horizontal position and the energy drawn. (Over
/// a seabed that slopes, a hull that touches it feels its position; the Jacobian leaves that out, and the error control
/// answers with shorter steps. So it does with the memory, which changes over minutes and hours and moves the glider by some
/// grams.)
struct InPlane<'a, S>(&'a S);

impl<S: System> glidepolar_ode::System<N_STATES, N_FELT, N_EVENTS> for InPlane<'_, S> {
    const NOMINALS: [f64; N_STATES] = State::NOMINALS;
    const FIRST_FELT: usize = 1;
    const COUNTED_IN_ERROR: usize = N_STATES - N_MEMORY;

    fn derivative(&self, time_s: f64, state: &[f64; N_STATES]) -> [f64; N_STATES] {
        self.0.derivative(time_s, &State::from_array(*state)).as_array()
    }

    fn slopes(&self, time_s: f64, state: &[f64; N_STATES]) -> Slopes<N_STATES, N_FELT> {
        Slopes::new(time_s, state, (Self::FIRST_FELT, &Self::NOMINALS), |time_s, state| {
            self.0.linearised(time_s, &State::from_array(state)).as_array()
        })
    }

    fn event_indicators(&self, time_s: f64, state: &[f64; N_STATES]) -> [f64; N_EVENTS] {
        self.0.event_indicators(time_s, &State::from_array(*state))
    }

    fn next_jump_s(&self, time_s: f64) -> Option<f64> {
        self.0.next_jump_s(time_s)
    }

    fn next_bend_s(&self, time_s: f64, state: &[f64; N_STATES]) -> Option<f64> {
        self.0.next_bend_s(time_s, &State::from_array(*state))
    }
}
