//! The types of FMI 3.0's headers.

use std::ffi::{c_char, c_int, c_void};

use crate::adapter::Version;
use crate::instance::boundary::Standard;
use crate::instance::phase::{Phase, Phases};

/// `fmi3Instance`.
pub type Pointer = *mut c_void;
/// `fmi3FMUState`.
pub type FmuState = *mut c_void;
/// `fmi3Status`.
pub type FmiStatus = c_int;
/// `fmi3Boolean` and `fmi3Clock`: C's `bool`. A caller's byte may hold anything, which Rust's `bool` may not.
pub type Boolean = u8;

/// `fmi3LogMessageCallback`.
pub type LogMessage = unsafe extern "C" fn(*mut c_void, FmiStatus, *const c_char, *const c_char);

/// `fmi3IntermediateUpdateCallback`: environment, time, set requested, get allowed, step finished, can return early,
/// early return requested, early return time.
pub type IntermediateUpdate =
    unsafe extern "C" fn(*mut c_void, f64, Boolean, Boolean, Boolean, Boolean, *mut Boolean, *mut f64);

/// What FMI 3.0 keeps beside an instance.
pub struct Fmi3 {
    /// Handed back with every callback.
    pub(super) environment: *mut c_void,
    /// Looks in during communication steps.
    pub(super) intermediate_update: Option<IntermediateUpdate>,
}

impl Standard for Fmi3 {
    const MARK: u64 = u64::from_le_bytes(*b"glider-3");
}

impl Version for Fmi3 {
    type Boolean = Boolean;

    const NOT_BROKEN: Phases = Phases::of(&[
        Phase::Instantiated,
        Phase::Initialization,
        Phase::Event,
        Phase::ContinuousTime,
        Phase::Step,
        Phase::Intermediate,
        Phase::Terminated,
    ]);
    const RUNNING: Phases = Phases::of(&[
        Phase::Initialization,
        Phase::Event,
        Phase::ContinuousTime,
        Phase::Step,
        Phase::Intermediate,
        Phase::Terminated,
    ]);
}
