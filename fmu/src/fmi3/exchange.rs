//! Model Exchange, and the events that it shares with Co-Simulation.

use super::types::*;
use crate::instance::boundary::{call, elements, place, room};
use crate::instance::phase::{Phase, Phases};
use crate::instance::refusal::{Outcome, Refusal};
use crate::instance::{Instance, Interface};
use glidepolar_dynamics::N_STATES;
use glidepolar_dynamics::limits::N_EVENTS;

const EVENT: Phases = Phases::of(&[Phase::Event]);
const CONTINUOUS_TIME: Phases = Phases::of(&[Phase::ContinuousTime]);
const EVENT_OR_CONTINUOUS_TIME: Phases = Phases::of(&[Phase::Event, Phase::ContinuousTime]);

fn allow(instance: &Instance, phases: Phases) -> Outcome {
    instance.only(Interface::ModelExchange)?;
    instance.allow(phases)
}

/// `fmi3EnterEventMode`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterEventMode(instance: Pointer) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3EnterEventMode", |c| {
            c.instance.allow(Phases::of(&[Phase::ContinuousTime, Phase::Step]))?;
            if c.instance.interface() == Interface::CoSimulation && !c.instance.abilities().event_mode {
                return Err(Refusal::error("the instance was made with eventModeUsed = false: steps handle events"));
            }
            c.instance.enter(Phase::Event);
            Ok(())
        })
    }
}

/// `fmi3EvaluateDiscreteStates`: nothing has to be evaluated, no discrete state follows from another.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EvaluateDiscreteStates(instance: Pointer) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3EvaluateDiscreteStates", |c| {
            c.instance.allow(Phases::of(&[Phase::Initialization, Phase::Event]))
        })
    }
}

/// `fmi3UpdateDiscreteStates`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3UpdateDiscreteStates(
    instance: Pointer,
    discrete_states_need_update: *mut Boolean,
    terminate_simulation: *mut Boolean,
    nominals_of_continuous_states_changed: *mut Boolean,
    values_of_continuous_states_changed: *mut Boolean,
    next_event_time_defined: *mut Boolean,
    next_event_time: *mut f64,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3UpdateDiscreteStates", |c| {
            c.instance.allow(EVENT)?;
            let needed = place(discrete_states_need_update, "discreteStatesNeedUpdate")?;
            let terminate = place(terminate_simulation, "terminateSimulation")?;
            let nominals = place(nominals_of_continuous_states_changed, "nominalsOfContinuousStatesChanged")?;
            let values = place(values_of_continuous_states_changed, "valuesOfContinuousStatesChanged")?;
            let defined = place(next_event_time_defined, "nextEventTimeDefined")?;
            let next = place(next_event_time, "nextEventTime")?;
            let event = c.instance.handle_event();
            (*needed, *terminate, *nominals) = (0, 0, 0);
            *values = Boolean::from(event.states_changed);
            *defined = Boolean::from(event.next_time_event_s.is_some());
            *next = event.next_time_event_s.unwrap_or(0.0);
            Ok(())
        })
    }
}

/// `fmi3EnterContinuousTimeMode`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterContinuousTimeMode(instance: Pointer) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3EnterContinuousTimeMode", |c| {
            allow(&c.instance, EVENT)?;
            c.instance.check_limits()?;
            c.instance.enter(Phase::ContinuousTime);
            Ok(())
        })
    }
}

/// `fmi3CompletedIntegratorStep`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3CompletedIntegratorStep(
    instance: Pointer,
    _no_set_fmu_state_prior_to_current_point: Boolean,
    enter_event_mode: *mut Boolean,
    terminate_simulation: *mut Boolean,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3CompletedIntegratorStep", |c| {
            allow(&c.instance, CONTINUOUS_TIME)?;
            let enter = place(enter_event_mode, "enterEventMode")?;
            let terminate = place(terminate_simulation, "terminateSimulation")?;
            (*enter, *terminate) = (0, 0);
            Ok(())
        })
    }
}

/// `fmi3SetTime`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetTime(instance: Pointer, time: f64) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3SetTime", |c| {
            allow(&c.instance, EVENT_OR_CONTINUOUS_TIME)?;
            c.instance.set_time(time)
        })
    }
}

/// `fmi3SetContinuousStates`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetContinuousStates(
    instance: Pointer,
    continuous_states: *const f64,
    n_continuous_states: usize,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3SetContinuousStates", |c| {
            allow(&c.instance, CONTINUOUS_TIME)?;
            c.instance.set_states(elements(continuous_states, n_continuous_states, "continuousStates")?)
        })
    }
}

macro_rules! get_all {
    ($(#[$doc:meta])* $function:ident, $what:literal, $phases:expr, $method:ident) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $function(instance: Pointer, values: *mut f64, n: usize) -> FmiStatus {
            // SAFETY: see the module.
            unsafe {
                call::<Fmi3>(instance, stringify!($function), |c| {
                    allow(&c.instance, $phases)?;
                    c.instance.$method(room(values, n, $what)?)
                })
            }
        }
    };
}

get_all!(/** `fmi3GetContinuousStateDerivatives` */ fmi3GetContinuousStateDerivatives, "derivatives", RUNNING, derivatives);
get_all!(/** `fmi3GetEventIndicators` */ fmi3GetEventIndicators, "eventIndicators", RUNNING, indicators);
get_all!(/** `fmi3GetContinuousStates` */ fmi3GetContinuousStates, "continuousStates", RUNNING, states);
get_all!(/** `fmi3GetNominalsOfContinuousStates` */ fmi3GetNominalsOfContinuousStates, "nominals", NOT_BROKEN, nominals);

macro_rules! count {
    ($(#[$doc:meta])* $function:ident, $what:literal, $number:expr) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $function(instance: Pointer, number: *mut usize) -> FmiStatus {
            // SAFETY: see the module.
            unsafe {
                call::<Fmi3>(instance, stringify!($function), |c| {
                    allow(&c.instance, NOT_BROKEN)?;
                    *place(number, $what)? = $number;
                    Ok(())
                })
            }
        }
    };
}

count!(/** `fmi3GetNumberOfEventIndicators` */ fmi3GetNumberOfEventIndicators, "nEventIndicators", N_EVENTS);
count!(/** `fmi3GetNumberOfContinuousStates` */ fmi3GetNumberOfContinuousStates, "nContinuousStates", N_STATES);
