//! The state carried through time: adaptive steps, events found inside a step, an exact stop where one is asked for.
//!
//! Two methods: DOP853 of the crate `differential-equations` (module `explicit`), whose order 8 goes through a turn in few
//! cheap steps, and at tight tolerances through everything; Rodas5P (module `rosenbrock`) for what comes after, when the fast
//! modes of pitch and servos have died out but would still hold an explicit method to short steps. Which one steps next
//! follows from the step size. `docs/integration.md` has the figures and says what else was tried.
//!
//! This module gives them what they leave to their caller: states in units of their nominal size, so that one tolerance
//! means the same for all of them; an origin that travels with the glider, so that a long voyage is as exact as a short one;
//! events; bends of the rates, where a step had better end; refusal of anything that is not finite. Allocates nothing.
//!
//! Between two calls of [`Integrator::advance`] time, state and step size are all there is: a run that is saved,
//! restored and continued goes on bit for bit. Knows no glider beyond its number of states.

mod explicit;
mod linear;
mod method;
mod rosenbrock;
#[cfg(test)]
mod tests;

use explicit::Explicit;
pub use method::Jet;
use method::{Method, Stretch, Trial};
use rosenbrock::Rosenbrock;

use super::limits::N_EVENTS;
use super::state::State;

/// Usual relative tolerance.
pub const DEFAULT_TOLERANCE: f64 = 1e-8;

/// The tightest tolerance at which the linearly implicit method takes part: below it, its order 5 asks for more steps than
/// stability asks of an explicit one.
pub const IMPLICIT_FROM: f64 = 5e-10;

/// From this step on the linearly implicit method is the cheaper one: its step costs as much as three explicit ones, which the
/// pitch damping of a glider holds to some 0.8 s \[s\].
const IMPLICIT_STEP_S: f64 = 2.5;

/// How many times its own step the explicit method must be able to hand over, to be left for the implicit one.
const WORTH_CHANGING: f64 = 4.0;

/// Explicit steps after which it is tried whether the implicit method would go further.
const STEPS_BEFORE_TRIAL: usize = 16;

/// First step where none is known \[s\].
const FIRST_STEP_S: f64 = 0.1;

/// Longest step \[s\]: no surfacing or bottoming is jumped over.
const LONGEST_STEP_S: f64 = 60.0;

/// The longest time between two looks at the events \[s\]: a boundary that is crossed and crossed back inside a long step
/// shows between its ends.
const LOOK_S: f64 = 10.0;

/// Accepted steps after which the method starts anew about the place reached. It also keeps the explicit crate's alarm
/// for stiffness, which counts over the life of a solver, from ending long voyages.
const STEPS_PER_ORIGIN: usize = 64;

/// Rejections in a row after which the step is given up.
const MAX_REJECTIONS: usize = 100;

/// Width to which an event is located \[s\].
const EVENT_WIDTH_S: f64 = 1e-9;

/// So near to a bend a step is at it: what is left on the other side no error shows \[s\].
const AT_A_BEND_S: f64 = 1e-5;

/// How far past the place of the dense output an event is looked for at most \[s\].
const LANDING_S: f64 = 1e-2;

/// What moves: the equations, closed over parameters, modes and inputs.
pub trait System {
    /// Rates of change of the state.
    fn derivative(&self, time_s: f64, state: &State<f64>) -> State<f64>;

    /// The same equations in numbers that carry slopes along.
    fn linearised(&self, time_s: Jet, state: &State<Jet>) -> State<Jet>;

    /// Functions whose change of sign is an event.
    fn event_indicators(&self, time_s: f64, state: &State<f64>) -> [f64; N_EVENTS];

    /// The next time after `time_s` at which the rates jump, if they do.
    fn next_jump_s(&self, time_s: f64) -> Option<f64>;

    /// When the rates will bend, from `time_s` and `state` on, as far as that can be foreseen: a step that ends there is
    /// spared the attempts to step across. An estimate changes the steps alone.
    fn next_bend_s(&self, time_s: f64, state: &State<f64>) -> Option<f64>;
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
            let passed = self.best_method(&stretch, (&mut time, &mut here, &mut step_s), target)?;
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

    /// Steps about one origin by the method that gets furthest for its cost.
    fn best_method<S: System>(
        &self,
        stretch: &Stretch<'_, S>,
        (time, state, step_s): (&mut f64, &mut State<f64>, &mut f64),
        target: f64,
    ) -> Result<Option<Advance>, IntegrationError> {
        if self.tolerance < IMPLICIT_FROM {
            return self.stretch::<_, Explicit>(stretch, (time, state, step_s), target, Until::steps(STEPS_PER_ORIGIN));
        }
        let (begun_s, begun_with_s, remaining) = (*time, *step_s, target - *time);
        let is_implicit = begun_with_s.min(remaining) >= IMPLICIT_STEP_S;
        let trial_s = if is_implicit { begun_with_s } else { (WORTH_CHANGING * begun_with_s).min(LONGEST_STEP_S) };
        if trial_s <= remaining || trial_s.min(remaining) >= IMPLICIT_STEP_S {
            *step_s = trial_s;
            let until = Until { steps: STEPS_PER_ORIGIN, shorter_than_s: trial_s.min(IMPLICIT_STEP_S) };
            let passed = self.stretch::<_, Rosenbrock>(stretch, (time, state, step_s), target, until)?;
            if *time > begun_s || passed.is_some() {
                return Ok(passed);
            }
            // Not even one step: what was tried in vain says nothing of the explicit method's own step, unless it is shorter.
            *step_s = step_s.min(begun_with_s);
        }
        self.stretch::<_, Explicit>(stretch, (time, state, step_s), target, Until::steps(STEPS_BEFORE_TRIAL))
    }

    /// Steps about one origin: to the target, an event, or the end of the stretch.
    fn stretch<S: System, M: Method<S>>(
        &self,
        stretch: &Stretch<'_, S>,
        (time, state, step_s): (&mut f64, &mut State<f64>, &mut f64),
        target: f64,
        until: Until,
    ) -> Result<Option<Advance>, IntegrationError> {
        // Rates that are no numbers reject every step, however small.
        let too_small = |time_s: f64, state: &State<f64>| {
            let rates = stretch.system.derivative(time_s.min(stretch.last_s), state).as_array();
            let are_finite = rates.iter().all(|rate| rate.is_finite());
            Err(if are_finite {
                IntegrationError::StepTooSmall { time_s }
            } else {
                IntegrationError::NotFinite { time_s }
            })
        };
        let mut method = M::begin(stretch, self.tolerance, *time, step_s.min(LONGEST_STEP_S))?;
        let mut before = stretch.system.event_indicators(*time, state);
        let (mut accepted, mut rejected) = (0, 0);
        let mut stop_s = next_stop_s(stretch, *time, state, target);
        while *time < target && accepted < until.steps {
            let remaining = stop_s - method.time_s();
            let unclipped = method.next_step_s();
            if unclipped <= 1e-13 * time.abs().max(1e-3) && unclipped < remaining {
                return too_small(*time, state);
            }
            let clipped = unclipped >= remaining * (1.0 - 1e-10);
            if clipped {
                method.set_next_step_s(remaining);
            }
            match method.step(stretch) {
                Trial::Failed => return too_small(*time, state),
                Trial::Rejected if method.next_step_s() < until.shorter_than_s => {
                    *step_s = method.next_step_s();
                    return Ok(None);
                }
                Trial::Rejected if rejected >= MAX_REJECTIONS => return too_small(*time, state),
                Trial::Rejected => {
                    rejected += 1;
                    continue;
                }
                Trial::Accepted => (accepted, rejected) = (accepted + 1, 0),
            }
            if !method.place().iter().all(|value| value.is_finite()) {
                return Err(IntegrationError::NotFinite { time_s: *time });
            }
            let reached_s = if clipped { stop_s } else { method.time_s() };
            let after = stretch.indicators(reached_s, method.place());
            if let Some(ends) = first_change(stretch, &mut method, (*time, reached_s), (&before, &after)) {
                let (event_s, event) = locate(stretch, &mut method, ends, &before);
                return self.land::<S, M>(stretch, (time, state, step_s), (event_s, event, &before), target);
            }
            (*time, *state, before) = (reached_s, stretch.state(method.place()), after);
            // A step that was cut to end at a stop says nothing against the one before it.
            *step_s = if clipped { unclipped.max(method.next_step_s()) } else { method.next_step_s() };
            method.set_next_step_s(*step_s);
            stop_s = next_stop_s(stretch, *time, state, target);
        }
        Ok(None)
    }

    /// Goes to the event by steps of its own, so that the state there has the order of the method, not of the dense
    /// output that found it. The two differ by the tolerance, and a slow crossing may not have happened yet where the
    /// dense output has it: then a little further, or the same event would be found again without end.
    fn land<S: System, M: Method<S>>(
        &self,
        stretch: &Stretch<'_, S>,
        (time, state, step_s): (&mut f64, &mut State<f64>, &mut f64),
        (mut event_s, changed, before): (f64, [bool; N_EVENTS], &[f64; N_EVENTS]),
        target: f64,
    ) -> Result<Option<Advance>, IntegrationError> {
        let stretch = &Stretch { origin: *state, ..*stretch };
        let first_step_s = (event_s - *time).min(*step_s).clamp(EVENT_WIDTH_S, LONGEST_STEP_S);
        let mut method = M::begin(stretch, self.tolerance, *time, first_step_s)?;
        let (mut rejected, mut further_s) = (0, EVENT_WIDTH_S);
        loop {
            let remaining = event_s - method.time_s();
            if remaining <= 4.0 * f64::EPSILON * event_s.abs() {
                let landed = stretch.state(method.place());
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
            if method.next_step_s() >= remaining * (1.0 - 1e-10) {
                method.set_next_step_s(remaining);
            }
            let trial = method.step(stretch);
            rejected = if trial == Trial::Rejected { rejected + 1 } else { 0 };
            if trial == Trial::Failed || rejected > MAX_REJECTIONS {
                return Err(IntegrationError::StepTooSmall { time_s: *time });
            }
        }
    }
}

/// Where a step from here must end at the latest: at a bend of the rates, or at the target.
fn next_stop_s<S: System>(stretch: &Stretch<'_, S>, time_s: f64, state: &State<f64>, target: f64) -> f64 {
    let is_ahead = |bend_s: &f64| *bend_s > time_s + AT_A_BEND_S && *bend_s < target - AT_A_BEND_S;
    stretch.system.next_bend_s(time_s, state).filter(is_ahead).unwrap_or(target)
}

/// When a stretch ends before its target.
#[derive(Clone, Copy)]
struct Until {
    /// After so many accepted steps.
    steps: usize,
    /// With a rejected step after which the next is to be shorter than this \[s\].
    shorter_than_s: f64,
}

impl Until {
    fn steps(steps: usize) -> Self {
        Until { steps, shorter_than_s: 0.0 }
    }
}

/// The part of an accepted step in which a sign changes first, if one does.
fn first_change<S: System, M: Method<S>>(
    stretch: &Stretch<'_, S>,
    method: &mut M,
    (begun_s, reached_s): (f64, f64),
    (before, after): (&[f64; N_EVENTS], &[f64; N_EVENTS]),
) -> Option<(f64, f64)> {
    let parts = ((reached_s - begun_s) / LOOK_S).ceil().max(1.0);
    let part_s = (reached_s - begun_s) / parts;
    let mut from_s = begun_s;
    for look in 1..parts as u32 {
        let time_s = begun_s + part_s * f64::from(look);
        let there = method.inside(time_s).map(|scaled| stretch.indicators(time_s, &scaled));
        if there.is_some_and(|there| sign_changes(before, &there).contains(&true)) {
            return Some((from_s, time_s));
        }
        from_s = time_s;
    }
    sign_changes(before, after).contains(&true).then_some((from_s, reached_s))
}

/// Where the first sign changes between two times inside an accepted step, by bisection on the dense output.
fn locate<S: System, M: Method<S>>(
    stretch: &Stretch<'_, S>,
    method: &mut M,
    (mut low, mut high): (f64, f64),
    before: &[f64; N_EVENTS],
) -> (f64, [bool; N_EVENTS]) {
    let mut changes_at = |time: f64| {
        let scaled = method.inside(time);
        scaled.map_or([false; N_EVENTS], |scaled| sign_changes(before, &stretch.indicators(time, &scaled)))
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
