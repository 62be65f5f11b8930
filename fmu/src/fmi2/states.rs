//! Saving, restoring and writing out the state.

use super::types::*;
use crate::instance::boundary::{call, elements, place, room};
use crate::instance::refusal::Refusal;

/// `fmi2GetFMUstate`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(component: Component, state: *mut FmuState) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2GetFMUstate", |c| {
            let state = place(state, "FMUstate")?;
            *state = c.instance.save(state.addr())? as FmuState;
            Ok(())
        })
    }
}

/// `fmi2SetFMUstate`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(component: Component, state: FmuState) -> FmiStatus {
    // SAFETY: see the module.
    unsafe { call::<Fmi2>(component, "fmi2SetFMUstate", |c| c.instance.restore(state.addr())) }
}

/// `fmi2FreeFMUstate`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(component: Component, state: *mut FmuState) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2FreeFMUstate", |c| {
            if state.is_null() {
                return Ok(());
            }
            let state = place(state, "FMUstate")?;
            c.instance.forget(state.addr())?;
            *state = std::ptr::null_mut();
            Ok(())
        })
    }
}

/// `fmi2SerializedFMUstateSize`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    component: Component,
    state: FmuState,
    size: *mut usize,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2SerializedFMUstateSize", |c| {
            *place(size, "size")? = c.instance.serialized(state.addr())?.len();
            Ok(())
        })
    }
}

/// `fmi2SerializeFMUstate`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    component: Component,
    state: FmuState,
    bytes: *mut u8,
    size: usize,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2SerializeFMUstate", |c| {
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

/// `fmi2DeSerializeFMUstate`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    component: Component,
    bytes: *const u8,
    size: usize,
    state: *mut FmuState,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2DeSerializeFMUstate", |c| {
            let state = place(state, "FMUstate")?;
            *state = c.instance.deserialized(elements(bytes, size, "serializedState")?)? as FmuState;
            Ok(())
        })
    }
}
