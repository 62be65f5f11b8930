//! Saving, restoring and writing out the state.

use super::types::*;
use crate::adapter::{exported, states};

exported! { Fmi3;
    fmi3GetFMUState(state: *mut FmuState) = states::save;
    fmi3SetFMUState(state: FmuState) = states::restore;
    fmi3FreeFMUState(state: *mut FmuState) = states::forget;
    fmi3SerializedFMUStateSize(state: FmuState, size: *mut usize) = states::serialized_size;
    fmi3SerializeFMUState(state: FmuState, bytes: *mut u8, size: usize) = states::serialize;
    fmi3DeserializeFMUState(bytes: *const u8, size: usize, state: *mut FmuState) = states::deserialize;
}
