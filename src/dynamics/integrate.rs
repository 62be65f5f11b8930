//! The state carried through time: adaptive steps, events found inside a step, an exact stop where one is asked for.
//!
//! The method is DOP853 (Dormand and Prince, order 8 with error estimates of order 5 and 3, dense output of order 7) of
//! the crate `differential-equations`; `docs/integration.md` says what else was tried. This module gives it what that
//! crate leaves to its caller: states in units of their nominal size, so that one tolerance means the same for all of
//! them; an origin that travels with the glider, so that a long voyage is as exact as a short one; events; refusal of
//! anything that is not finite. Allocates nothing.
//!
//! Between two calls of [`Integrator::advance`] time, state and step size are all there is: a run that is saved,
//! restored and continued goes on bit for bit. Knows no glider beyond the number of its states.

use differential_equations::interpolate::Interpolation;
use differential_equations::methods::ExplicitRungeKutta;
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use differential_equations::status::Status;

use super::limits::N_EVENTS;
use super::state::{N_STATES, STATE_NOMINALS, State};

/// Usual relative tolerance.
pub const DEFAULT_TOLERANCE: f64 = 1e-8;

/// First step where none is known \[s\].
const FIRST_STEP_S: f64 = 0.1;

/// Longest step \[s\]: no surfacing or bottoming is jumped over.
const LONGEST_STEP_S: f64 = 60.0;

/// Accepted steps after which the method starts anew about the place reached. It also keeps the crate's stiffness
/// alarm, which counts over the life of a solver, from ending long voyages: a step at the edge of stability is what an
/// explicit method is meant to choose here.
const STEPS_PER_ORIGIN: usize = 64;

/// Rejections in a row after which the step is given up.
const MAX_REJECTIONS: usize = 100;

/// Width to which an event is located \[s\].
const EVENT_WIDTH_S: f64 = 1e-9;

/// How far past the place of the dense output an event is looked for at most \[s\].
const LANDING_S: f64 = 1e-2;

/// What moves: the equations, closed over parameters, modes and inputs.
pub trait System {
    /// Rates of change of the state.
    fn derivative(&self, time_s: f64, state: &State<f64>) -> State<f64>;

    /// Functions whose change of sign is an event.
    fn event_indicators(&self, time_s: f64, state: &State<f64>) -> [f64; N_EVENTS];

    /// The next time after `time_s` at which the rates jump, if they do.
    fn next_jump_s(&self, time_s: f64) -> Option<f64>;
}

/// How far an advance came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Advance {
    /// To the time that was asked for.
    Reached,
    /// To an event before it: which indicators changed sign. The state stands just behind the change.
    Event([bool; N_EVENTS]),
}

/// Why an advance failed. Time and state are as they were before it.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum IntegrationError {
    /// A rate of change is not a number or not finite.
    #[error("the rates of change at {time_s} s are not finite: check parameters and inputs for values out of range")]
    NotFinite {
        /// Time \[s\].
        time_s: f64,
    },
    /// No step is small enough.
    #[error(
        "no step at {time_s} s is small enough for the tolerance: check parameters and inputs for values out of range"
    )]
    StepTooSmall {
        /// Time \[s\].
        time_s: f64,
    },
}

/// Tolerance and step size of the method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrator {
    tolerance: f64,
    step_s: f64,
}

impl Integrator {
    /// An integrator with a relative tolerance; each state is absolute within it on the scale of its nominal value.
    /// A tolerance outside 1e-13 to 1e-2 is brought to the nearer end.
    pub fn new(tolerance: f64) -> Self {
        let tolerance = if tolerance.is_finite() { tolerance.clamp(1e-13, 1e-2) } else { DEFAULT_TOLERANCE };
        Integrator { tolerance, step_s: FIRST_STEP_S }
    }

    /// The step that comes next \[s\]: with time and state, all that a continued run depends on.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Takes over the step size of a saved run.
    pub fn with_step_s(self, step_s: f64) -> Self {
        let step_s = if step_s > 0.0 && step_s.is_finite() { step_s } else { FIRST_STEP_S };
        Integrator { step_s, ..self }
    }

    /// Forgets the step size: after a jump of state or inputs the old one says nothing.
    pub fn restart(&mut self) {
        self.step_s = self.step_s.min(FIRST_STEP_S);
    }

    /// Moves time and state forward to `end_s`, or to the first event before it.
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
        let (mut time, mut here, mut step_s) = (*time_s, *state, self.step_s);
        let mut outcome = Advance::Reached;
        while time < end_s {
            let jump = system.next_jump_s(time).filter(|jump| *jump < end_s);
            let target = jump.unwrap_or(end_s);
            // Up to a jump the rates are those before it, at the jump itself too.
            let last = if jump.is_some() { target.next_down() } else { target };
            let stretch = Stretch { system, origin: here, last_s: last };
            let passed = self.stretch(&stretch, &mut time, &mut here, &mut step_s, target)?;
            if let Some(event) = passed {
                outcome = event;
                break;
            }
            if jump.is_some() && time >= target {
                step_s = step_s.min(FIRST_STEP_S);
            }
        }
        (*time_s, *state, self.step_s) = (time, here, step_s);
        Ok(outcome)
    }

    /// Steps about one origin: to the target, an event, or the end of the stretch.
    fn stretch<S: System>(
        &self,
        stretch: &Stretch<'_, S>,
        time: &mut f64,
        state: &mut State<f64>,
        step_s: &mut f64,
        target: f64,
    ) -> Result<Option<Advance>, IntegrationError> {
        let mut method = self.method(stretch, *time, state, *step_s)?;
        let mut before = stretch.system.event_indicators(*time, state);
        let (mut accepted, mut rejected) = (0, 0);
        while *time < target && accepted < STEPS_PER_ORIGIN {
            let remaining = target - method.t();
            let unclipped = method.h();
            if unclipped <= 1e-13 * time.abs().max(1e-3) && unclipped < remaining {
                return Err(IntegrationError::StepTooSmall { time_s: *time });
            }
            let clipped = unclipped >= remaining * (1.0 - 1e-10);
            if clipped {
                method.set_h(remaining);
            }
            if method.step(stretch).is_err() {
                return Err(IntegrationError::StepTooSmall { time_s: *time });
            }
            if matches!(method.status(), Status::RejectedStep) {
                rejected += 1;
                if rejected > MAX_REJECTIONS {
                    return Err(IntegrationError::StepTooSmall { time_s: *time });
                }
                continue;
            }
            (accepted, rejected) = (accepted + 1, 0);
            if !method.y().iter().all(|value| value.is_finite()) {
                return Err(IntegrationError::NotFinite { time_s: *time });
            }
            let reached = stretch.state(method.y());
            let reached_s = if clipped { target } else { method.t() };
            let after = stretch.system.event_indicators(reached_s, &reached);
            let changed = sign_changes(&before, &after);
            if changed.contains(&true) {
                let (event_s, event) = locate(stretch, &mut method, (*time, reached_s), &before);
                return self.land(stretch, (time, state, step_s), (event_s, event, &before), target);
            }
            (*time, *state, before) = (reached_s, reached, after);
            // A step that was cut to end on the target says nothing against the one before it.
            *step_s = if clipped { unclipped.max(method.h()) } else { method.h() };
        }
        Ok(None)
    }

    /// Goes to the event by steps of its own, so that the state there has the order of the method, not of the dense
    /// output that found it. The two differ by the tolerance, and a slow crossing may not have happened yet where the
    /// dense output has it: then a little further, or the same event would be found again without end.
    fn land<S: System>(
        &self,
        stretch: &Stretch<'_, S>,
        (time, state, step_s): (&mut f64, &mut State<f64>, &mut f64),
        (mut event_s, changed, before): (f64, [bool; N_EVENTS], &[f64; N_EVENTS]),
        target: f64,
    ) -> Result<Option<Advance>, IntegrationError> {
        let first_step_s = (event_s - *time).min(*step_s).max(EVENT_WIDTH_S);
        let mut method = self.method(stretch, *time, state, first_step_s)?;
        let (mut rejected, mut further_s) = (0, EVENT_WIDTH_S);
        loop {
            let remaining = event_s - method.t();
            if remaining <= 4.0 * f64::EPSILON * event_s.abs() {
                let landed = stretch.state(method.y());
                let crossed = sign_changes(before, &stretch.system.event_indicators(event_s, &landed));
                let is_behind = crossed.contains(&true);
                if is_behind || further_s > LANDING_S || event_s >= target {
                    (*time, *state) = (event_s, landed);
                    *step_s = step_s.min(FIRST_STEP_S);
                    // Not yet there at the target: the next advance will find it.
                    let is_left = !is_behind && event_s >= target;
                    return Ok((!is_left).then_some(Advance::Event(if is_behind { crossed } else { changed })));
                }
                event_s = (event_s + further_s).min(target);
                further_s *= 2.0;
                continue;
            }
            if method.h() >= remaining * (1.0 - 1e-10) {
                method.set_h(remaining);
            }
            if method.step(stretch).is_err() || rejected > MAX_REJECTIONS {
                return Err(IntegrationError::StepTooSmall { time_s: *time });
            }
            rejected = if matches!(method.status(), Status::RejectedStep) { rejected + 1 } else { 0 };
        }
    }

    fn method<S: System>(
        &self,
        stretch: &Stretch<'_, S>,
        time: f64,
        state: &State<f64>,
        step_s: f64,
    ) -> Result<Method, IntegrationError> {
        let far = time + 1e12;
        let start = stretch.scaled(state);
        let mut method = ExplicitRungeKutta::dop853()
            .rtol(self.tolerance)
            .atol(self.tolerance)
            .h0(step_s.min(LONGEST_STEP_S))
            .h_max(LONGEST_STEP_S)
            .max_steps(usize::MAX);
        method.init(stretch, time, far, &start).map_err(|_| IntegrationError::NotFinite { time_s: time })?;
        method.set_status(Status::Solving);
        let rates = stretch.system.derivative(time, state).as_array();
        if rates.iter().chain(&start).all(|value| value.is_finite()) {
            Ok(method)
        } else {
            Err(IntegrationError::NotFinite { time_s: time })
        }
    }
}

type Method = ExplicitRungeKutta<
    differential_equations::methods::Ordinary,
    differential_equations::methods::DormandPrince,
    f64,
    [f64; N_STATES],
    8,
    12,
    16,
>;

/// The system about an origin, in units of the nominal sizes.
struct Stretch<'a, S> {
    system: &'a S,
    origin: State<f64>,
    last_s: f64,
}

impl<S> Stretch<'_, S> {
    fn scaled(&self, state: &State<f64>) -> [f64; N_STATES] {
        let (origin, nominal) = (self.origin.as_array(), STATE_NOMINALS.as_array());
        let state = state.as_array();
        std::array::from_fn(|i| (state[i] - origin[i]) / nominal[i])
    }

    fn state(&self, scaled: &[f64; N_STATES]) -> State<f64> {
        let (origin, nominal) = (self.origin.as_array(), STATE_NOMINALS.as_array());
        State::from_array(std::array::from_fn(|i| origin[i] + scaled[i] * nominal[i]))
    }
}

impl<S: System> ODE<f64, [f64; N_STATES]> for Stretch<'_, S> {
    fn diff(&self, time_s: f64, scaled: &[f64; N_STATES], rates: &mut [f64; N_STATES]) {
        let derivative = self.system.derivative(time_s.min(self.last_s), &self.state(scaled)).as_array();
        let nominal = STATE_NOMINALS.as_array();
        *rates = std::array::from_fn(|i| derivative[i] / nominal[i]);
    }
}

/// Where the first sign changes between the ends of an accepted step, by bisection on the dense output.
fn locate<S: System>(
    stretch: &Stretch<'_, S>,
    method: &mut Method,
    (mut low, mut high): (f64, f64),
    before: &[f64; N_EVENTS],
) -> (f64, [bool; N_EVENTS]) {
    let mut changes_at = |time: f64| {
        let within = time.clamp(method.t_prev(), method.t());
        method.interpolate(within).map_or([false; N_EVENTS], |scaled| {
            sign_changes(before, &stretch.system.event_indicators(time, &stretch.state(&scaled)))
        })
    };
    let mut changed = changes_at(high);
    while high - low > EVENT_WIDTH_S.max(1e-14 * high.abs()) {
        let middle = 0.5 * (low + high);
        let there = changes_at(middle);
        if there.contains(&true) {
            (high, changed) = (middle, there);
        } else {
            low = middle;
        }
    }
    (high, changed)
}

fn sign_changes(before: &[f64; N_EVENTS], after: &[f64; N_EVENTS]) -> [bool; N_EVENTS] {
    std::array::from_fn(|i| (before[i] >= 0.0) != (after[i] >= 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Drifts so slowly, so late, that nanoseconds do not move it across.
    struct Drift;

    impl System for Drift {
        fn derivative(&self, _: f64, _: &State<f64>) -> State<f64> {
            State { depth_m: 1e-7, ..State::from_array([0.0; N_STATES]) }
        }

        fn event_indicators(&self, _: f64, state: &State<f64>) -> [f64; N_EVENTS] {
            std::array::from_fn(|i| if i == 0 { 0.8e-7 - state.depth_m } else { 1.0 })
        }

        fn next_jump_s(&self, _: f64) -> Option<f64> {
            None
        }
    }

    #[test]
    fn a_slow_crossing_late_in_a_voyage_is_one_event_and_the_state_stands_behind_it() {
        let (mut time, mut state, mut integrator) = (1e6, State::from_array([0.0; N_STATES]), Integrator::new(1e-8));
        let advance = integrator.advance(&Drift, &mut time, &mut state, 1e6 + 5.0).unwrap();
        assert!(matches!(advance, Advance::Event(which) if which[0]), "{advance:?}");
        assert!(Drift.event_indicators(time, &state)[0] < 0.0 && (time - 1e6 - 0.8).abs() < 0.02, "{time}");
        let advance = integrator.advance(&Drift, &mut time, &mut state, 1e6 + 5.0).unwrap();
        assert_eq!((advance, time), (Advance::Reached, 1e6 + 5.0));
        assert!((state.depth_m - 5e-7).abs() < 1e-13, "{}", state.depth_m);
    }
}
