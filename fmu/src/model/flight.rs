//! The glider carried through a communication step, its inputs moving: the integrator of its model, and the right-hand side
//! that it asks.

use std::cell::Cell;

use glidepolar_dynamics::integrate::{Jet, System};
use glidepolar_dynamics::{self as dynamics, Parameters};
use glidepolar_number::Number;
use glidepolar_ode::{IntegrationError, Slopes};
use glidepolar_spatial::glider::{FIRST_FELT, N_FELT, N_MEMORY, NOMINAL_VALUES};
use glidepolar_spatial::{self as spatial, Body};

use super::glider::Rules;
use super::values::{MOST_INPUTS, MOST_PARAMETERS, MOST_STATES, head, row};
use super::which::Model;

/// What a right-hand side with its slopes costs, in plain ones.
const COST_OF_SLOPES: u64 = 10;

/// Inputs that move, at any time of a step.
pub trait InputsAt {
    /// The inputs at this time.
    fn inputs_at<T: Number>(&self, time_s: T) -> [T; MOST_INPUTS];
}

/// The glider with its inputs moving.
pub struct Moving<'a, I> {
    /// What the equations go by.
    pub rules: Rules<'a>,
    /// Parameters.
    pub parameters: &'a [f64; MOST_PARAMETERS],
    /// Inputs.
    pub inputs: I,
    /// Right-hand sides that may still be asked for.
    pub evaluations_left: Cell<u64>,
    /// The latest time that was asked about \[s\].
    pub furthest_s: Cell<f64>,
}

impl<I> Moving<'_, I> {
    /// Whether one more evaluation of this cost may be made, at this time; it is then counted.
    fn may_go_on(&self, time_s: f64, cost: u64) -> bool {
        let left = self.evaluations_left.get();
        self.evaluations_left.set(left.saturating_sub(cost));
        if left > 0 {
            self.furthest_s.set(self.furthest_s.get().max(time_s));
        }
        left > 0
    }
}

/// The integrator of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a saved state is a copy, without allocation")]
pub enum Integrator {
    /// In the plane.
    Plane(dynamics::Integrator),
    /// In space.
    Space(glidepolar_ode::Integrator<{ spatial::N_STATES }>),
}

/// Where an advance may end.
#[derive(Debug, Clone, Copy)]
pub struct Ends {
    /// Where the state is wanted \[s\].
    pub end_s: f64,
    /// How long nothing changes that the motion depends on; none where anything may after the end \[s\].
    pub horizon_s: Option<f64>,
}

impl Integrator {
    /// The integrator of this model with a relative tolerance.
    pub fn new(model: Model, tolerance: f64) -> Self {
        match model {
            Model::Plane => Integrator::Plane(dynamics::Integrator::new(tolerance)),
            Model::Space => Integrator::Space(glidepolar_ode::Integrator::new(tolerance)),
        }
    }

    /// The step that comes next \[s\].
    pub fn step_s(&self) -> f64 {
        match self {
            Integrator::Plane(it) => it.step_s(),
            Integrator::Space(it) => it.step_s(),
        }
    }

    /// Forgets what lies beyond the time that was asked for.
    pub fn forget_ahead(&mut self) {
        match self {
            Integrator::Plane(it) => it.forget_ahead(),
            Integrator::Space(it) => it.forget_ahead(),
        }
    }

    /// With time and state, all that a continued run depends on, as plain numbers: always as many.
    pub fn numbers(&self) -> Vec<f64> {
        match self {
            Integrator::Plane(it) => it.numbers(),
            Integrator::Space(it) => it.numbers(),
        }
    }

    /// The integrator of this model that wrote these numbers; none where no such integrator did.
    pub fn from_numbers(model: Model, numbers: &[f64]) -> Option<Self> {
        match model {
            Model::Plane => dynamics::Integrator::from_numbers(numbers).map(Integrator::Plane),
            Model::Space => glidepolar_ode::Integrator::from_numbers(numbers).map(Integrator::Space),
        }
    }

    /// Moves time and state forward to the end, or to the first event before it. Returns whether the end is reached.
    ///
    /// # Errors
    /// Where the equations cannot be followed; time and state are left as they were.
    pub fn advance<I: InputsAt>(
        &mut self,
        moving: &Moving<'_, I>,
        time_s: &mut f64,
        values: &mut [f64; MOST_STATES],
        ends: Ends,
    ) -> Result<bool, IntegrationError> {
        let Ends { end_s, horizon_s } = ends;
        match self {
            Integrator::Plane(it) => {
                let system =
                    InPlane { moving, active: moving.rules.active(&Parameters::from_array(head(moving.parameters))) };
                let mut state = dynamics::State::from_array(head(values));
                let advance = match horizon_s {
                    None => it.advance(&system, time_s, &mut state, end_s),
                    Some(horizon_s) => it.follow(&system, time_s, &mut state, end_s, horizon_s),
                };
                *values = row(state.as_array());
                advance.map(|advance| advance == dynamics::Advance::Reached)
            }
            Integrator::Space(it) => {
                let system = InSpace { moving, body: moving.rules.body(moving.parameters) };
                let advance = match horizon_s {
                    None => it.advance(&system, time_s, values, end_s),
                    Some(horizon_s) => it.follow(&system, time_s, values, end_s, horizon_s),
                };
                advance.map(|advance| advance == glidepolar_ode::Advance::Reached)
            }
        }
    }
}

struct InPlane<'a, I> {
    moving: &'a Moving<'a, I>,
    active: Parameters<f64>,
}

impl<I: InputsAt> InPlane<'_, I> {
    fn inputs<T: Number>(&self, time_s: T) -> dynamics::Inputs<T> {
        dynamics::Inputs::from_array(head(&self.moving.inputs.inputs_at(time_s)))
    }
}

impl<I: InputsAt> System for InPlane<'_, I> {
    fn derivative(&self, time_s: f64, state: &dynamics::State<f64>) -> dynamics::State<f64> {
        if !self.moving.may_go_on(time_s, 1) {
            // The integrator refuses what is not a number: the way out of a step without end.
            return state.map(|_| f64::NAN);
        }
        self.moving.rules.rates_in_plane(&self.active, time_s, state, &self.inputs(time_s))
    }

    fn linearised(&self, time_s: Jet, state: &dynamics::State<Jet>) -> dynamics::State<Jet> {
        if !self.moving.may_go_on(time_s.value(), COST_OF_SLOPES) {
            return state.map(|_| Jet::constant(f64::NAN));
        }
        self.moving.rules.rates_in_plane(&self.active.map(Jet::constant), time_s, state, &self.inputs(time_s))
    }

    fn event_indicators(&self, time_s: f64, state: &dynamics::State<f64>) -> [f64; dynamics::limits::N_EVENTS] {
        self.moving.rules.indicators_in_plane(&self.active, time_s, state, &self.inputs(time_s))
    }

    fn next_jump_s(&self, _: f64) -> Option<f64> {
        // The jump of drag is a mode here; each advance ends on it.
        None
    }

    fn next_bend_s(&self, time_s: f64, state: &dynamics::State<f64>) -> Option<f64> {
        self.moving.rules.bend_in_plane(&self.active, time_s, state, &self.inputs(time_s))
    }
}

struct InSpace<'a, I> {
    moving: &'a Moving<'a, I>,
    body: Body<f64>,
}

impl<I: InputsAt> InSpace<'_, I> {
    /// The state of these values, and the inputs that act on it.
    fn parts<T: Number>(
        &self,
        body: &Body<T>,
        time_s: T,
        values: [T; spatial::N_STATES],
    ) -> (spatial::State<T>, spatial::Inputs<T>) {
        let state = spatial::State::from_array(values);
        let inputs = spatial::Inputs::from_array(head(&self.moving.inputs.inputs_at(time_s)));
        let acting = self.moving.rules.in_space(body, &state, &inputs);
        (state, acting)
    }
}

impl<I: InputsAt> glidepolar_ode::System<{ spatial::N_STATES }, N_FELT, { spatial::glider::N_EVENTS }>
    for InSpace<'_, I>
{
    const NOMINALS: [f64; spatial::N_STATES] = NOMINAL_VALUES;
    const FIRST_FELT: usize = FIRST_FELT;
    const COUNTED_IN_ERROR: usize = spatial::N_STATES - N_MEMORY;

    fn derivative(&self, time_s: f64, state: &[f64; spatial::N_STATES]) -> [f64; spatial::N_STATES] {
        if !self.moving.may_go_on(time_s, 1) {
            return [f64::NAN; spatial::N_STATES];
        }
        let (state, inputs) = self.parts(&self.body, time_s, *state);
        spatial::derivative(&self.body, time_s, &state, &inputs).as_array()
    }

    fn slopes(&self, time_s: f64, state: &[f64; spatial::N_STATES]) -> Slopes<{ spatial::N_STATES }, N_FELT> {
        let may_go_on = self.moving.may_go_on(time_s, COST_OF_SLOPES);
        let body = self.body.map(glidepolar_ode::Jet::constant);
        Slopes::new::<{ N_FELT + 1 }>(time_s, state, (FIRST_FELT, &NOMINAL_VALUES), |time_s, values| {
            let (state, inputs) = self.parts(&body, time_s, values);
            let rates = spatial::derivative(&body, time_s, &state, &inputs).as_array();
            if may_go_on { rates } else { rates.map(|_| glidepolar_ode::Jet::constant(f64::NAN)) }
        })
    }

    fn event_indicators(&self, time_s: f64, state: &[f64; spatial::N_STATES]) -> [f64; spatial::glider::N_EVENTS] {
        let (state, inputs) = self.parts(&self.body, time_s, *state);
        self.moving.rules.boundaries(&state, &inputs)
    }

    fn next_jump_s(&self, _: f64) -> Option<f64> {
        None
    }

    fn next_bend_s(&self, time_s: f64, state: &[f64; spatial::N_STATES]) -> Option<f64> {
        let (state, inputs) = self.parts(&self.body, time_s, *state);
        spatial::next_bend_s(&self.body, time_s, &state, &inputs)
    }
}
