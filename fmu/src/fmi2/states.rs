//! Saving, restoring and writing out the state.

use super::types::*;
use crate::adapter::{exported, states};

exported! { Fmi2;
    fmi2GetFMUstate(state: *mut FmuState) = states::save;
    fmi2SetFMUstate(state: FmuState) = states::restore;
    fmi2FreeFMUstate(state: *mut FmuState) = states::forget;
    fmi2SerializedFMUstateSize(state: FmuState, size: *mut usize) = states::serialized_size;
    fmi2SerializeFMUstate(state: FmuState, bytes: *mut u8, size: usize) = states::serialize;
    fmi2DeSerializeFMUstate(bytes: *const u8, size: usize, state: *mut FmuState) = states::deserialize;
}
