//! Co-Simulation: steps, events inside them, and the importer's look at what happens between communication points.

use super::types::*;
use crate::instance::boundary::{Component, call, call_open, elements, place, room, same_length};
use crate::instance::phase::{Phase, Phases};
use crate::instance::refusal::{Outcome, Refusal};
use crate::instance::stepping::{Progress, Step};
use crate::instance::{Instance, Interface};

fn allow(instance: &Instance, phases: Phases) -> Outcome {
    instance.only(Interface::CoSimulation)?;
    instance.allow(phases)
}

/// `fmi3EnterStepMode`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterStepMode(instance: Pointer) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3EnterStepMode", |c| {
            allow(&c.instance, Phases::of(&[Phase::Event]))?;
            c.instance.enter(Phase::Step);
            Ok(())
        })
    }
}

/// `fmi3GetOutputDerivatives`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetOutputDerivatives(
    instance: Pointer,
    value_references: *const u32,
    n_value_references: usize,
    orders: *const i32,
    values: *mut f64,
    n_values: usize,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3GetOutputDerivatives", |c| {
            allow(&c.instance, Phases::of(&[Phase::Step, Phase::Intermediate, Phase::Terminated]))?;
            same_length(n_value_references, n_values)?;
            c.instance.output_derivatives(
                elements(value_references, n_value_references, "valueReferences")?,
                elements(orders, n_value_references, "orders")?,
                room(values, n_values, "values")?,
            )
        })
    }
}

/// How a step ended.
#[derive(Default)]
struct End {
    event: bool,
    early: bool,
}

/// `fmi3DoStep`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: Pointer,
    current_communication_point: f64,
    communication_step_size: f64,
    _no_set_fmu_state_prior_to_current_point: Boolean,
    event_handling_needed: *mut Boolean,
    terminate_simulation: *mut Boolean,
    early_return: *mut Boolean,
    last_successful_time: *mut f64,
) -> FmiStatus {
    // SAFETY: see the module. No reference to the component lives while the importer looks in.
    unsafe {
        call_open::<Fmi3>(instance, "fmi3DoStep", |c| {
            allow(&(*c).instance, Phases::of(&[Phase::Step]))?;
            let event = place(event_handling_needed, "eventHandlingNeeded")?;
            let terminate = place(terminate_simulation, "terminateSimulation")?;
            let early = place(early_return, "earlyReturn")?;
            let reached = place(last_successful_time, "lastSuccessfulTime")?;
            (*event, *terminate, *early) = (0, 0, 0);
            *reached = (*c).instance.time_s();

            let before = (*c).instance.checkpoint();
            let result = do_step(c, current_communication_point, communication_step_size);
            match result {
                Ok(end) => {
                    (*event, *early) = (Boolean::from(end.event), Boolean::from(end.early));
                    *reached = (*c).instance.time_s();
                    Ok(())
                }
                Err(refusal) => {
                    (*c).instance.roll_back(before);
                    Err(refusal)
                }
            }
        })
    }
}

/// # Safety
/// `c` must be a component that nobody else uses, callbacks apart.
unsafe fn do_step(c: *mut Component<Fmi3>, current_s: f64, size_s: f64) -> Outcome<End> {
    // SAFETY: the caller's word; each reference ends with its statement.
    unsafe {
        let abilities = (*c).instance.abilities();
        let returns_at_events = abilities.event_mode && abilities.early_return;
        let looks_in = (*c).standard.intermediate_update.is_some();
        let mut step = (*c).instance.begin_step(current_s, size_s)?;
        let mut end_s = step.target_s;
        let mut end = End::default();
        loop {
            let time = (*c).instance.time_s();
            let until_s = if looks_in { end_s.min(time + (*c).instance.integrator_step_s()) } else { end_s };
            if returns_at_events {
                end.event = (*c).instance.advance(&mut step, until_s)? == Progress::Event;
            } else {
                (*c).instance.advance_over_events(&mut step, until_s)?;
            }
            let done = end.event || (*c).instance.time_s() >= end_s;
            if looks_in {
                let requested = look_in(c, &mut step, abilities.early_return && !done)?;
                end_s = requested.map_or(end_s, |wanted| wanted.max((*c).instance.time_s()).min(end_s));
            }
            if end.event || (*c).instance.time_s() >= end_s {
                break;
            }
        }
        end.early = (*c).instance.time_s() < step.target_s;
        (*c).instance.end_step(&step);
        Ok(end)
    }
}

/// Lets the importer look in. Returns the time at which it wants the step to end, if it does.
///
/// # Safety
/// As [`do_step`].
unsafe fn look_in(c: *mut Component<Fmi3>, step: &mut Step, can_return_early: bool) -> Outcome<Option<f64>> {
    // SAFETY: the caller's word; no reference lives during the callback.
    unsafe {
        let (environment, callback) = ((*c).standard.environment, (*c).standard.intermediate_update);
        let Some(callback) = callback else { return Ok(None) };
        let time = (*c).instance.time_s();
        let (mut requested, mut return_s) = (Boolean::from(false), time);
        let finished = time >= step.target_s;
        (*c).instance.enter(Phase::Intermediate);
        callback(
            environment,
            time,
            Boolean::from(!finished),
            Boolean::from(true),
            Boolean::from(true),
            Boolean::from(can_return_early),
            &raw mut requested,
            &raw mut return_s,
        );
        if (*c).instance.phase() != Phase::Intermediate {
            return Err(Refusal::error("the importer changed the state of the instance from inside a step"));
        }
        (*c).instance.enter(Phase::Step);
        (*c).instance.take_inputs_inside(step);
        let wanted = if return_s.is_finite() { return_s } else { time };
        Ok((requested != 0 && can_return_early).then_some(wanted))
    }
}
