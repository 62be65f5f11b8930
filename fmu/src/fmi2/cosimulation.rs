//! Co-Simulation.

use std::ffi::{c_char, c_int};

use super::types::*;
use crate::instance::boundary::{call, elements, place, room};
use crate::instance::phase::{Phase, Phases};
use crate::instance::refusal::{Outcome, Refusal, Status};
use crate::instance::{Instance, Interface};

fn allow(instance: &Instance, phases: Phases) -> Outcome {
    instance.only(Interface::CoSimulation)?;
    instance.allow(phases)
}

/// `fmi2DoStep`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(
    component: Component,
    current_communication_point: f64,
    communication_step_size: f64,
    _no_set_fmu_state_prior_to_current_point: Boolean,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2DoStep", |c| {
            allow(&c.instance, Phases::of(&[Phase::Step]))?;
            let result = c.instance.whole_step(current_communication_point, communication_step_size);
            c.standard.last_step = result.as_ref().map_or_else(|refusal| refusal.status, |()| Status::Ok);
            result
        })
    }
}

/// `fmi2CancelStep`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(component: Component) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2CancelStep", |_| {
            Err(Refusal::error("no step is under way: fmi2DoStep never returns fmi2Pending"))
        })
    }
}

/// `fmi2SetRealInputDerivatives`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    component: Component,
    value_references: *const u32,
    n: usize,
    orders: *const c_int,
    values: *const f64,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2SetRealInputDerivatives", |c| {
            allow(&c.instance, Phases::of(&[Phase::Instantiated, Phase::Initialization, Phase::Step]))?;
            c.instance.set_input_derivatives(
                elements(value_references, n, "vr")?,
                elements(orders, n, "order")?,
                elements(values, n, "value")?,
            )
        })
    }
}

/// `fmi2GetRealOutputDerivatives`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    component: Component,
    value_references: *const u32,
    n: usize,
    orders: *const c_int,
    values: *mut f64,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2GetRealOutputDerivatives", |c| {
            allow(&c.instance, Phases::of(&[Phase::Step, Phase::Terminated]))?;
            c.instance.output_derivatives(
                elements(value_references, n, "vr")?,
                elements(orders, n, "order")?,
                room(values, n, "value")?,
            )
        })
    }
}

const DO_STEP_STATUS: c_int = 0;
const LAST_SUCCESSFUL_TIME: c_int = 2;
const TERMINATED: c_int = 3;

fn no_such_status<T>(kind: c_int) -> Outcome<T> {
    Err(Refusal::discard(format!("there is no status {kind} of this type: no step is ever pending")))
}

/// `fmi2GetStatus`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(component: Component, kind: c_int, value: *mut FmiStatus) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2GetStatus", |c| {
            allow(&c.instance, ANY)?;
            let value = place(value, "value")?;
            *value = match kind {
                DO_STEP_STATUS => c.standard.last_step as FmiStatus,
                _ => return no_such_status(kind),
            };
            Ok(())
        })
    }
}

/// `fmi2GetRealStatus`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(component: Component, kind: c_int, value: *mut f64) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2GetRealStatus", |c| {
            allow(&c.instance, ANY)?;
            let value = place(value, "value")?;
            *value = match kind {
                LAST_SUCCESSFUL_TIME => c.instance.time_s(),
                _ => return no_such_status(kind),
            };
            Ok(())
        })
    }
}

/// `fmi2GetIntegerStatus`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(component: Component, kind: c_int, _value: *mut c_int) -> FmiStatus {
    // SAFETY: see the module.
    unsafe { call::<Fmi2>(component, "fmi2GetIntegerStatus", |_| no_such_status(kind)) }
}

/// `fmi2GetBooleanStatus`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(component: Component, kind: c_int, value: *mut Boolean) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2GetBooleanStatus", |c| {
            allow(&c.instance, ANY)?;
            let value = place(value, "value")?;
            *value = match kind {
                TERMINATED => Boolean::from(false),
                _ => return no_such_status(kind),
            };
            Ok(())
        })
    }
}

/// `fmi2GetStringStatus`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(
    component: Component,
    kind: c_int,
    _value: *mut *const c_char,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe { call::<Fmi2>(component, "fmi2GetStringStatus", |_| no_such_status(kind)) }
}
