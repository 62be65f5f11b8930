//! Model Exchange, and the events that it shares with Co-Simulation.

use super::Version;
use crate::instance::boundary::{Component, elements, place, room};
use crate::instance::exchange::EventOutcome;
use crate::instance::phase::{Phase, Phases};
use crate::instance::refusal::Outcome;
use crate::instance::{Instance, Interface};

/// At an event.
pub const EVENT: Phases = Phases::of(&[Phase::Event]);
/// Between events.
pub const CONTINUOUS_TIME: Phases = Phases::of(&[Phase::ContinuousTime]);
/// While an importer's integrator drives the instance.
pub const EVENT_OR_CONTINUOUS_TIME: Phases = Phases::of(&[Phase::Event, Phase::ContinuousTime]);

/// Refuses a call in Co-Simulation, or in another phase.
pub fn allow(instance: &Instance, phases: Phases) -> Outcome {
    instance.only(Interface::ModelExchange)?;
    instance.allow(phases)
}

/// Goes to the event that the importer found, from these phases.
pub fn enter_event<V: Version>(c: &mut Component<V>, phases: Phases) -> Outcome {
    c.instance.allow(phases)?;
    c.instance.enter(Phase::Event);
    Ok(())
}

/// When the next event comes that time alone brings, as both standards say it.
pub fn next_time_event<V: Version>(event: EventOutcome) -> (V::Boolean, f64) {
    (event.next_time_event_s.is_some().into(), event.next_time_event_s.unwrap_or(0.0))
}

/// Goes on between events.
pub fn enter_continuous_time<V: Version>(c: &mut Component<V>) -> Outcome {
    allow(&c.instance, EVENT)?;
    c.instance.check_limits()?;
    c.instance.enter(Phase::ContinuousTime);
    Ok(())
}

/// A step of the importer's integrator is over: that is no event here.
///
/// # Safety
/// See the module.
pub unsafe fn completed_integrator_step<V: Version>(
    c: &mut Component<V>,
    _no_set_fmu_state_prior_to_current_point: V::Boolean,
    enter_event_mode: *mut V::Boolean,
    terminate_simulation: *mut V::Boolean,
) -> Outcome {
    allow(&c.instance, CONTINUOUS_TIME)?;
    // SAFETY: see the module.
    let (enter, terminate) =
        unsafe { (place(enter_event_mode, "enterEventMode")?, place(terminate_simulation, "terminateSimulation")?) };
    (*enter, *terminate) = (false.into(), false.into());
    Ok(())
}

/// Sets the time.
pub fn set_time<V: Version>(c: &mut Component<V>, time_s: f64) -> Outcome {
    allow(&c.instance, EVENT_OR_CONTINUOUS_TIME)?;
    c.instance.set_time(time_s)
}

/// Sets the continuous states.
///
/// # Safety
/// See the module.
pub unsafe fn set_states<V: Version>(c: &mut Component<V>, states: *const f64, n_states: usize) -> Outcome {
    allow(&c.instance, CONTINUOUS_TIME)?;
    // SAFETY: see the module.
    c.instance.set_states(unsafe { elements(states, n_states, "continuousStates") }?)
}

/// Functions that fill the caller's array from a method of the instance, in these phases.
macro_rules! get_all {
    ($($name:ident, $what:literal, $phases:ident;)*) => {$(
        #[doc = concat!("Gives the ", stringify!($name), ".")]
        ///
        /// # Safety
        /// See the module.
        pub unsafe fn $name<V: Version>(c: &mut Component<V>, values: *mut f64, n: usize) -> Outcome {
            allow(&c.instance, V::$phases)?;
            // SAFETY: see the module.
            c.instance.$name(unsafe { room(values, n, $what) }?)
        }
    )*};
}

get_all! {
    derivatives, "derivatives", RUNNING;
    indicators, "eventIndicators", RUNNING;
    states, "continuousStates", RUNNING;
    nominals, "nominals", NOT_BROKEN;
}
