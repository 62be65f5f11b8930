//! Saving, restoring and writing out the state.

use super::types::*;
use crate::instance::Instance;
use crate::instance::boundary::{call, elements, place, room};
use crate::instance::phase::Phase;
use crate::instance::refusal::{Outcome, Refusal};

/// Inside a step, while the importer looks in, there is no state to come back to.
fn not_inside_a_step(instance: &Instance) -> Outcome {
    match instance.phase() {
        Phase::Intermediate => Err(Refusal::error("not allowed in Intermediate Update Mode; let the step end first")),
        _ => Ok(()),
    }
}

/// `fmi3GetFMUState`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(instance: Pointer, state: *mut FmuState) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3GetFMUState", |c| {
            not_inside_a_step(&c.instance)?;
            let state = place(state, "FMUState")?;
            *state = c.instance.save(state.addr())? as FmuState;
            Ok(())
        })
    }
}

/// `fmi3SetFMUState`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(instance: Pointer, state: FmuState) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3SetFMUState", |c| {
            not_inside_a_step(&c.instance)?;
            c.instance.restore(state.addr())
        })
    }
}

/// `fmi3FreeFMUState`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(instance: Pointer, state: *mut FmuState) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3FreeFMUState", |c| {
            if state.is_null() {
                return Ok(());
            }
            let state = place(state, "FMUState")?;
            c.instance.forget(state.addr())?;
            *state = std::ptr::null_mut();
            Ok(())
        })
    }
}

/// `fmi3SerializedFMUStateSize`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(instance: Pointer, state: FmuState, size: *mut usize) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3SerializedFMUStateSize", |c| {
            *place(size, "size")? = c.instance.serialized(state.addr())?.len();
            Ok(())
        })
    }
}

/// `fmi3SerializeFMUState`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    instance: Pointer,
    state: FmuState,
    bytes: *mut u8,
    size: usize,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3SerializeFMUState", |c| {
            let serialized = c.instance.serialized(state.addr())?;
            let room = room(bytes, size, "serializedState")?;
            if room.len() != serialized.len() {
                let (found, needed) = (room.len(), serialized.len());
                return Err(Refusal::error(format!("room for {found} bytes, expected {needed}")));
            }
            room.copy_from_slice(&serialized);
            Ok(())
        })
    }
}

/// `fmi3DeserializeFMUState`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: Pointer,
    bytes: *const u8,
    size: usize,
    state: *mut FmuState,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3DeserializeFMUState", |c| {
            let state = place(state, "FMUState")?;
            *state = c.instance.deserialized(elements(bytes, size, "serializedState")?)? as FmuState;
            Ok(())
        })
    }
}
