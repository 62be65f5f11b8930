//! Model Exchange.

use super::types::*;
use crate::adapter::exchange::{self, EVENT, EVENT_OR_CONTINUOUS_TIME, allow};
use crate::adapter::exported;
use crate::instance::Interface;
use crate::instance::boundary::{Component as Boxed, place};
use crate::instance::refusal::Outcome;

exported! { Fmi2;
    fmi2EnterEventMode() = enter_event;
    fmi2NewDiscreteStates(event_info: *mut EventInfo) = new_discrete_states;
    fmi2EnterContinuousTimeMode() = exchange::enter_continuous_time;
    fmi2CompletedIntegratorStep(
        no_set_fmu_state_prior_to_current_point: Boolean,
        enter_event_mode: *mut Boolean,
        terminate_simulation: *mut Boolean
    ) = exchange::completed_integrator_step;
    fmi2SetTime(time: f64) = exchange::set_time;
    fmi2SetContinuousStates(x: *const f64, nx: usize) = exchange::set_states;
    fmi2GetDerivatives(derivatives: *mut f64, nx: usize) = exchange::derivatives;
    fmi2GetEventIndicators(event_indicators: *mut f64, ni: usize) = exchange::indicators;
    fmi2GetContinuousStates(x: *mut f64, nx: usize) = exchange::states;
    fmi2GetNominalsOfContinuousStates(x_nominal: *mut f64, nx: usize) = exchange::nominals;
}

fn enter_event(c: &mut Boxed<Fmi2>) -> Outcome {
    c.instance.only(Interface::ModelExchange)?;
    exchange::enter_event(c, EVENT_OR_CONTINUOUS_TIME)
}

unsafe fn new_discrete_states(c: &mut Boxed<Fmi2>, event_info: *mut EventInfo) -> Outcome {
    allow(&c.instance, EVENT)?;
    // SAFETY: see the module.
    let info = unsafe { place(event_info, "eventInfo") }?;
    let event = c.instance.handle_event();
    let (next_event_time_defined, next_event_time) = exchange::next_time_event::<Fmi2>(event);
    *info = EventInfo {
        new_discrete_states_needed: 0,
        terminate_simulation: 0,
        nominals_of_continuous_states_changed: 0,
        values_of_continuous_states_changed: Boolean::from(event.states_changed),
        next_event_time_defined,
        next_event_time,
    };
    Ok(())
}
