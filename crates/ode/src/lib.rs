//! The state carried through time: adaptive steps, events found inside a step, an exact stop where one is asked for.
//!
//! Two methods: DOP853 of the crate `differential-equations` (module `explicit`), whose order 8 goes through a turn in few
//! cheap steps, and at tight tolerances through everything; Rodas5P (module `rosenbrock`) for what comes after, when the fast
//! modes of pitch and servos have died out but would still hold an explicit method to short steps. Which one steps next
//! follows from the step size. `docs/theory/integration.md` has the figures and says what else was tried.
//!
//! This module gives them what they leave to their caller: states in units of their nominal size, so that one tolerance
//! means the same for all of them; an origin that travels with the glider, so that a long voyage is as exact as a short one;
//! events; bends of the rates, where a step had better end; refusal of anything that is not finite. Allocates nothing.
//!
//! Between two calls of [`Integrator::advance`] time, state and step size are all there is, between two of
//! [`Integrator::follow`] also the rest of the last step: a run that is saved, restored and continued goes on bit for bit.
//! Knows no glider.

mod ahead;
mod crossing;
mod explicit;
mod linear;
mod method;
mod rosenbrock;
mod slopes;
mod stretch;
#[cfg(test)]
mod tests;

use ahead::Ahead;
use explicit::Explicit;
use method::Stretch;
use rosenbrock::Rosenbrock;
pub use slopes::{Jet, Slopes};
use stretch::{Aim, Place, Until};

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

/// Accepted steps after which the method starts anew about the place reached. It also keeps the explicit crate's alarm
/// for stiffness, which counts over the life of a solver, from ending long voyages.
const STEPS_PER_ORIGIN: usize = 64;

/// Those of [`Integrator::numbers`] that are no part of a step that reached further.
const N_OWN_NUMBERS: usize = 4;

/// What moves: the equations of `N` states, closed over parameters, modes and inputs. `F` of the states are felt: rates of
/// change may depend on them. The others are only counted, or felt so little that the error control may answer for them.
/// The sign of any of `E` indicators changes at an event.
pub trait System<const N: usize, const F: usize, const E: usize> {
    /// The usual size of every state, on which the tolerance is meant.
    const NOMINALS: [f64; N];

    /// The first of the states that are felt; the others of them follow.
    const FIRST_FELT: usize;

    /// How many states the mean of the error is taken over. States that rest for most users are left out: where they rest
    /// the steps are those without them.
    const COUNTED_IN_ERROR: usize = N;

    /// Rates of change of the state.
    fn derivative(&self, time_s: f64, state: &[f64; N]) -> [f64; N];

    /// The same with their slopes, see [`Slopes::new`].
    fn slopes(&self, time_s: f64, state: &[f64; N]) -> Slopes<N, F>;

    /// Functions whose change of sign is an event.
    fn event_indicators(&self, time_s: f64, state: &[f64; N]) -> [f64; E];

    /// The next time after `time_s` at which the rates jump, if they do.
    fn next_jump_s(&self, time_s: f64) -> Option<f64>;

    /// When the rates will bend, from `time_s` and `state` on, as far as that can be foreseen: a step that ends there is
    /// spared the attempts to step across. An estimate changes the steps alone.
    fn next_bend_s(&self, time_s: f64, state: &[f64; N]) -> Option<f64>;
}

/// How far an advance came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Advance<const E: usize> {
    /// To the time that was asked for.
    Reached,
    /// To an event before it: which indicators changed sign. The state stands just behind the change.
    Event([bool; E]),
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

/// Tolerance and step size of the method, and how far its last step went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrator<const N: usize> {
    tolerance: f64,
    step_s: f64,
    /// Explicit steps still to go before the implicit method is tried again.
    explicit_steps: usize,
    /// The last step, where it went beyond the time that was asked for.
    ahead: Option<Ahead<N>>,
}

impl<const N: usize> Integrator<N> {
    /// An integrator with a relative tolerance; each state is absolute within it on the scale of its nominal value.
    /// A tolerance outside 1e-13 to 1e-2 is brought to the nearer end.
    pub fn new(tolerance: f64) -> Self {
        let tolerance = if tolerance.is_finite() { tolerance.clamp(1e-13, 1e-2) } else { DEFAULT_TOLERANCE };
        Integrator { tolerance, step_s: FIRST_STEP_S, explicit_steps: 0, ahead: None }
    }

    /// The step that comes next \[s\].
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
        self.forget_ahead();
    }

    /// Forgets what lies beyond the time that was asked for. To be called where time, state or system change between two
    /// calls of [`Integrator::follow`].
    pub fn forget_ahead(&mut self) {
        (self.ahead, self.explicit_steps) = (None, 0);
    }

    /// With time and state, all that a continued run depends on, as plain numbers: always as many.
    pub fn numbers(&self) -> Vec<f64> {
        let has_ahead = f64::from(u8::from(self.ahead.is_some()));
        let own = [self.tolerance, self.step_s, self.explicit_steps as f64, has_ahead];
        let ahead = self.ahead.iter().flat_map(Ahead::numbers).chain(std::iter::repeat(0.0));
        own.into_iter().chain(ahead).take(N_OWN_NUMBERS + Ahead::<N>::N_NUMBERS).collect()
    }

    /// The integrator that wrote these [`Integrator::numbers`]; none where no integrator did.
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let (&[tolerance, step_s, explicit_steps, has_ahead], ahead) = numbers.split_first_chunk::<N_OWN_NUMBERS>()?;
        let fresh = Integrator::new(tolerance).with_step_s(step_s);
        let explicit_steps = (0..=STEPS_BEFORE_TRIAL).find(|steps| *steps as f64 == explicit_steps)?;
        let ahead = if has_ahead == 0.0 { None } else { Some(Ahead::from_numbers(ahead)?) };
        let is_same = fresh.tolerance == tolerance && fresh.step_s == step_s;
        is_same.then_some(Integrator { explicit_steps, ahead, ..fresh })
    }

    /// Moves time and state forward to `end_s`, or to the first event before it. The last step ends there, too: for a
    /// system that may change then.
    ///
    /// # Errors
    /// Where a rate of change is not finite or no step is small enough; time and state are left as they were.
    pub fn advance<const F: usize, const E: usize>(
        &mut self,
        system: &impl System<N, F, E>,
        time_s: &mut f64,
        state: &mut [f64; N],
        end_s: f64,
    ) -> Result<Advance<E>, IntegrationError> {
        self.forget_ahead();
        self.run(system, (time_s, state), end_s, end_s)
    }

    /// As [`Integrator::advance`], for a system that rests: steps go on beyond `end_s`, as far as `horizon_s`, as if nobody
    /// had asked for a state there, which comes from dense output; what is left of the last step serves the next call.
    /// After a change of time, state or system, [`Integrator::forget_ahead`] comes first.
    ///
    /// # Errors
    /// As [`Integrator::advance`].
    pub fn follow<const F: usize, const E: usize>(
        &mut self,
        system: &impl System<N, F, E>,
        time_s: &mut f64,
        state: &mut [f64; N],
        end_s: f64,
        horizon_s: f64,
    ) -> Result<Advance<E>, IntegrationError> {
        let (mut time, mut here) = (*time_s, *state);
        if let Some(ahead) = self.ahead {
            if ahead.knows(end_s) {
                (*time_s, *state) = (end_s, ahead.at(end_s));
                return Ok(Advance::Reached);
            }
            // From the end of that step, as exact as the method, unless an event keeps it from being reached.
            (time, here) = ahead.end().unwrap_or((time, here));
            self.ahead = None;
        }
        let reached = match self.run(system, (&mut time, &mut here), end_s, horizon_s.max(end_s)) {
            // What fails may lie beyond.
            Err(_) if horizon_s > end_s => self.advance(system, &mut time, &mut here, end_s)?,
            other => other?,
        };
        (*time_s, *state) = (time, here);
        Ok(reached)
    }

    /// Steps until `end_s` is reached, none of them beyond `horizon_s`.
    fn run<const F: usize, const E: usize>(
        &mut self,
        system: &impl System<N, F, E>,
        (time_s, state): (&mut f64, &mut [f64; N]),
        end_s: f64,
        horizon_s: f64,
    ) -> Result<Advance<E>, IntegrationError> {
        let Integrator { step_s, explicit_steps, .. } = *self;
        let mut place = Place { time_s: *time_s, state: *state, step_s, explicit_steps, ahead: None };
        let mut outcome = Advance::Reached;
        while place.time_s < end_s {
            let jump = system.next_jump_s(place.time_s).filter(|jump| *jump < horizon_s);
            let target_s = jump.unwrap_or(horizon_s);
            // Up to a jump the rates are those before it, at the jump itself too.
            let last_s = if jump.is_some() { target_s.next_down() } else { target_s };
            let stretch = Stretch { system, origin: place.state, last_s };
            let aim = Aim { wanted_s: end_s.min(target_s), target_s };
            if let Some(event) = self.best_method(&stretch, &mut place, aim)? {
                outcome = event;
                break;
            }
            if jump.is_some() && place.time_s >= target_s {
                place.step_s = place.step_s.min(FIRST_STEP_S);
            }
        }
        let Place { time_s: time, state: here, step_s, explicit_steps, ahead } = place;
        *self = Integrator { step_s, explicit_steps, ahead, ..*self };
        (*time_s, *state) = (time, here);
        Ok(outcome)
    }

    /// Steps about one origin by the method that gets furthest for its cost.
    fn best_method<S: System<N, F, E>, const F: usize, const E: usize>(
        &self,
        stretch: &Stretch<'_, S, N>,
        place: &mut Place<N>,
        aim: Aim,
    ) -> Result<Option<Advance<E>>, IntegrationError> {
        let tolerance = self.tolerance;
        if tolerance < IMPLICIT_FROM {
            return stretch
                .walk::<Explicit<N>, F, E>(tolerance, place, aim, Until::steps(STEPS_PER_ORIGIN))
                .map(|walk| walk.1);
        }
        let (begun_s, begun_with_s, remaining) = (place.time_s, place.step_s, aim.target_s - place.time_s);
        let is_implicit = begun_with_s.min(remaining) >= IMPLICIT_STEP_S;
        let trial_s = if is_implicit { begun_with_s } else { (WORTH_CHANGING * begun_with_s).min(LONGEST_STEP_S) };
        if place.explicit_steps == 0 {
            if trial_s <= remaining || trial_s.min(remaining) >= IMPLICIT_STEP_S {
                place.step_s = trial_s;
                let until = Until { steps: STEPS_PER_ORIGIN, shorter_than_s: trial_s.min(IMPLICIT_STEP_S) };
                let (_, passed) = stretch.walk::<Rosenbrock<N, F>, F, E>(tolerance, place, aim, until)?;
                if place.time_s > begun_s || passed.is_some() {
                    return Ok(passed);
                }
                // Not even one step: what was tried in vain says nothing of the explicit method's own step, unless it is
                // shorter.
                place.step_s = place.step_s.min(begun_with_s);
            }
            place.explicit_steps = STEPS_BEFORE_TRIAL;
        }
        let until = Until::steps(place.explicit_steps);
        let (taken, passed) = stretch.walk::<Explicit<N>, F, E>(tolerance, place, aim, until)?;
        place.explicit_steps = if passed.is_some() { 0 } else { place.explicit_steps.saturating_sub(taken) };
        Ok(passed)
    }
}
