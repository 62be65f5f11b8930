//! Model Exchange, and the events that it shares with Co-Simulation.

use super::types::*;
use crate::adapter::exchange::{self, EVENT, allow};
use crate::adapter::{Version, exported};
use crate::instance::Interface;
use crate::instance::boundary::{Component, place};
use crate::instance::phase::{Phase, Phases};
use crate::instance::refusal::{Outcome, Refusal};

exported! { Fmi3;
    fmi3EnterEventMode() = enter_event;
    fmi3EvaluateDiscreteStates() = evaluate_discrete_states;
    fmi3UpdateDiscreteStates(
        discrete_states_need_update: *mut Boolean,
        terminate_simulation: *mut Boolean,
        nominals_of_continuous_states_changed: *mut Boolean,
        values_of_continuous_states_changed: *mut Boolean,
        next_event_time_defined: *mut Boolean,
        next_event_time: *mut f64
    ) = update_discrete_states;
    fmi3EnterContinuousTimeMode() = exchange::enter_continuous_time;
    fmi3CompletedIntegratorStep(
        no_set_fmu_state_prior_to_current_point: Boolean,
        enter_event_mode: *mut Boolean,
        terminate_simulation: *mut Boolean
    ) = exchange::completed_integrator_step;
    fmi3SetTime(time: f64) = exchange::set_time;
    fmi3SetContinuousStates(continuous_states: *const f64, n: usize) = exchange::set_states;
    fmi3GetContinuousStateDerivatives(derivatives: *mut f64, n: usize) = exchange::derivatives;
    fmi3GetEventIndicators(event_indicators: *mut f64, n: usize) = exchange::indicators;
    fmi3GetContinuousStates(continuous_states: *mut f64, n: usize) = exchange::states;
    fmi3GetNominalsOfContinuousStates(nominals: *mut f64, n: usize) = exchange::nominals;
    fmi3GetNumberOfEventIndicators(n_event_indicators: *mut usize) = count_of_indicators;
    fmi3GetNumberOfContinuousStates(n_continuous_states: *mut usize) = count_of_states;
}

fn enter_event(c: &mut Component<Fmi3>) -> Outcome {
    if c.instance.interface() == Interface::CoSimulation && !c.instance.abilities().event_mode {
        return Err(Refusal::error("the instance was made with eventModeUsed = false: steps handle events"));
    }
    exchange::enter_event(c, Phases::of(&[Phase::ContinuousTime, Phase::Step]))
}

/// Nothing has to be evaluated: no discrete state follows from another.
fn evaluate_discrete_states(c: &mut Component<Fmi3>) -> Outcome {
    c.instance.allow(Phases::of(&[Phase::Initialization, Phase::Event]))
}

unsafe fn update_discrete_states(
    c: &mut Component<Fmi3>,
    needed: *mut Boolean,
    terminate: *mut Boolean,
    nominals_changed: *mut Boolean,
    values_changed: *mut Boolean,
    next_is_defined: *mut Boolean,
    next_time: *mut f64,
) -> Outcome {
    c.instance.allow(EVENT)?;
    // SAFETY: see the module.
    unsafe {
        let needed = place(needed, "discreteStatesNeedUpdate")?;
        let terminate = place(terminate, "terminateSimulation")?;
        let nominals = place(nominals_changed, "nominalsOfContinuousStatesChanged")?;
        let values = place(values_changed, "valuesOfContinuousStatesChanged")?;
        let defined = place(next_is_defined, "nextEventTimeDefined")?;
        let next = place(next_time, "nextEventTime")?;
        let event = c.instance.handle_event();
        (*needed, *terminate, *nominals) = (0, 0, 0);
        *values = Boolean::from(event.states_changed);
        (*defined, *next) = exchange::next_time_event::<Fmi3>(event);
    }
    Ok(())
}

unsafe fn count_of_indicators(c: &mut Component<Fmi3>, n: *mut usize) -> Outcome {
    allow(&c.instance, Fmi3::NOT_BROKEN)?;
    // SAFETY: see the module.
    *unsafe { place(n, "nEventIndicators") }? = c.instance.model().n_events();
    Ok(())
}

unsafe fn count_of_states(c: &mut Component<Fmi3>, n: *mut usize) -> Outcome {
    allow(&c.instance, Fmi3::NOT_BROKEN)?;
    // SAFETY: see the module.
    *unsafe { place(n, "nContinuousStates") }? = c.instance.model().n_states();
    Ok(())
}
