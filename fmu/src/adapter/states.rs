//! Saving, restoring and writing out the state.

use std::ffi::c_void;

use super::Version;
use crate::instance::Instance;
use crate::instance::boundary::{Component, elements, place, room};
use crate::instance::phase::Phase;
use crate::instance::refusal::{Outcome, Refusal};

/// Inside a step, while the importer looks in, there is no state to come back to.
fn not_inside_a_step(instance: &Instance) -> Outcome {
    match instance.phase() {
        Phase::Intermediate => Err(Refusal::error("not allowed in Intermediate Update Mode; let the step end first")),
        _ => Ok(()),
    }
}

/// Saves the state, into one that is there or into a new one.
///
/// # Safety
/// See the module.
pub unsafe fn save<V: Version>(c: &mut Component<V>, state: *mut *mut c_void) -> Outcome {
    not_inside_a_step(&c.instance)?;
    // SAFETY: see the module.
    let state = unsafe { place(state, "FMUState") }?;
    *state = c.instance.save(state.addr())? as *mut c_void;
    Ok(())
}

/// Goes back to a saved state.
pub fn restore<V: Version>(c: &mut Component<V>, state: *mut c_void) -> Outcome {
    not_inside_a_step(&c.instance)?;
    c.instance.restore(state.addr())
}

/// Frees a saved state.
///
/// # Safety
/// See the module.
pub unsafe fn forget<V: Version>(c: &mut Component<V>, state: *mut *mut c_void) -> Outcome {
    if state.is_null() {
        return Ok(());
    }
    // SAFETY: see the module.
    let state = unsafe { place(state, "FMUState") }?;
    c.instance.forget(state.addr())?;
    *state = std::ptr::null_mut();
    Ok(())
}

/// How many bytes a saved state takes.
///
/// # Safety
/// See the module.
pub unsafe fn serialized_size<V: Version>(c: &mut Component<V>, state: *mut c_void, size: *mut usize) -> Outcome {
    // SAFETY: see the module.
    let size = unsafe { place(size, "size") }?;
    *size = c.instance.serialized(state.addr())?.len();
    Ok(())
}

/// Writes out a saved state.
///
/// # Safety
/// See the module.
pub unsafe fn serialize<V: Version>(c: &mut Component<V>, state: *mut c_void, bytes: *mut u8, size: usize) -> Outcome {
    let serialized = c.instance.serialized(state.addr())?;
    // SAFETY: see the module.
    let room = unsafe { room(bytes, size, "serializedState") }?;
    if room.len() != serialized.len() {
        let (found, needed) = (room.len(), serialized.len());
        return Err(Refusal::error(format!("room for {found} bytes, expected {needed}")));
    }
    room.copy_from_slice(&serialized);
    Ok(())
}

/// Takes in a state that was written out.
///
/// # Safety
/// See the module.
pub unsafe fn deserialize<V: Version>(
    c: &mut Component<V>,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> Outcome {
    // SAFETY: see the module.
    let (state, bytes) = unsafe { (place(state, "FMUState")?, elements(bytes, size, "serializedState")?) };
    *state = c.instance.deserialized(bytes)? as *mut c_void;
    Ok(())
}
