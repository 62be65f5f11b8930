//! Clocks and model partitions: this FMU has none, so every reference is refused.

use super::common::none_of_this_type;
use super::types::*;
use crate::instance::boundary::call;
use crate::instance::refusal::Refusal;

macro_rules! no_clocks {
    ($($function:ident($($argument:ident: $type:ty),*);)*) => {
        $(
            /// There are no clocks.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $function(
                instance: Pointer,
                value_references: *const u32,
                n_value_references: usize,
                $($argument: $type),*
            ) -> FmiStatus {
                $(let _ = $argument;)*
                // SAFETY: see the module.
                unsafe { none_of_this_type(instance, value_references, n_value_references, stringify!($function)) }
            }
        )*
    };
}

no_clocks! {
    fmi3GetClock(values: *mut Boolean);
    fmi3SetClock(values: *const Boolean);
    fmi3GetIntervalDecimal(intervals: *mut f64, qualifiers: *mut FmiStatus);
    fmi3GetIntervalFraction(counters: *mut u64, resolutions: *mut u64, qualifiers: *mut FmiStatus);
    fmi3GetShiftDecimal(shifts: *mut f64);
    fmi3GetShiftFraction(counters: *mut u64, resolutions: *mut u64);
    fmi3SetIntervalDecimal(intervals: *const f64);
    fmi3SetIntervalFraction(counters: *const u64, resolutions: *const u64);
    fmi3SetShiftDecimal(shifts: *const f64);
    fmi3SetShiftFraction(counters: *const u64, resolutions: *const u64);
}

/// `fmi3ActivateModelPartition`: there are no partitions.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ActivateModelPartition(
    instance: Pointer,
    _clock_reference: u32,
    _activation_time: f64,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3ActivateModelPartition", |_| {
            Err(Refusal::error("belongs to Scheduled Execution, which is not provided"))
        })
    }
}
