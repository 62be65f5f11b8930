//! Model Exchange.

use super::types::*;
use crate::instance::boundary::{call, elements, place, room};
use crate::instance::phase::{Phase, Phases};
use crate::instance::refusal::Outcome;
use crate::instance::{Instance, Interface};

const EVENT: Phases = Phases::of(&[Phase::Event]);
const CONTINUOUS_TIME: Phases = Phases::of(&[Phase::ContinuousTime]);
const EVENT_OR_CONTINUOUS_TIME: Phases = Phases::of(&[Phase::Event, Phase::ContinuousTime]);

fn allow(instance: &Instance, phases: Phases) -> Outcome {
    instance.only(Interface::ModelExchange)?;
    instance.allow(phases)
}

/// `fmi2EnterEventMode`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterEventMode(component: Component) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2EnterEventMode", |c| {
            allow(&c.instance, EVENT_OR_CONTINUOUS_TIME)?;
            c.instance.enter(Phase::Event);
            Ok(())
        })
    }
}

/// `fmi2NewDiscreteStates`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2NewDiscreteStates(component: Component, event_info: *mut EventInfo) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2NewDiscreteStates", |c| {
            allow(&c.instance, EVENT)?;
            let info = place(event_info, "eventInfo")?;
            let event = c.instance.handle_event();
            *info = EventInfo {
                new_discrete_states_needed: 0,
                terminate_simulation: 0,
                nominals_of_continuous_states_changed: 0,
                values_of_continuous_states_changed: Boolean::from(event.states_changed),
                next_event_time_defined: Boolean::from(event.next_time_event_s.is_some()),
                next_event_time: event.next_time_event_s.unwrap_or(0.0),
            };
            Ok(())
        })
    }
}

/// `fmi2EnterContinuousTimeMode`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterContinuousTimeMode(component: Component) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2EnterContinuousTimeMode", |c| {
            allow(&c.instance, EVENT)?;
            c.instance.check_limits()?;
            c.instance.enter(Phase::ContinuousTime);
            Ok(())
        })
    }
}

/// `fmi2CompletedIntegratorStep`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CompletedIntegratorStep(
    component: Component,
    _no_set_fmu_state_prior_to_current_point: Boolean,
    enter_event_mode: *mut Boolean,
    terminate_simulation: *mut Boolean,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2CompletedIntegratorStep", |c| {
            allow(&c.instance, CONTINUOUS_TIME)?;
            let (enter, terminate) =
                (place(enter_event_mode, "enterEventMode")?, place(terminate_simulation, "terminateSimulation")?);
            (*enter, *terminate) = (0, 0);
            Ok(())
        })
    }
}

/// `fmi2SetTime`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetTime(component: Component, time: f64) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2SetTime", |c| {
            allow(&c.instance, EVENT_OR_CONTINUOUS_TIME)?;
            c.instance.set_time(time)
        })
    }
}

/// `fmi2SetContinuousStates`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetContinuousStates(component: Component, x: *const f64, nx: usize) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2SetContinuousStates", |c| {
            allow(&c.instance, CONTINUOUS_TIME)?;
            c.instance.set_states(elements(x, nx, "x")?)
        })
    }
}

macro_rules! get_all {
    ($(#[$doc:meta])* $function:ident, $what:literal, $phases:expr, $method:ident) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $function(component: Component, values: *mut f64, n: usize) -> FmiStatus {
            // SAFETY: see the module.
            unsafe {
                call::<Fmi2>(component, stringify!($function), |c| {
                    allow(&c.instance, $phases)?;
                    c.instance.$method(room(values, n, $what)?)
                })
            }
        }
    };
}

get_all!(/** `fmi2GetDerivatives` */ fmi2GetDerivatives, "derivatives", RUNNING, derivatives);
get_all!(/** `fmi2GetEventIndicators` */ fmi2GetEventIndicators, "eventIndicators", RUNNING, indicators);
get_all!(/** `fmi2GetContinuousStates` */ fmi2GetContinuousStates, "x", RUNNING, states);
get_all!(/** `fmi2GetNominalsOfContinuousStates` */ fmi2GetNominalsOfContinuousStates, "x_nominal", NOT_BROKEN, nominals);
