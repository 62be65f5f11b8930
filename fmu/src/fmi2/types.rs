//! The types of FMI 2.0's headers.

use std::ffi::{c_char, c_int, c_void};

use crate::adapter::Version;
use crate::instance::boundary::Standard;
use crate::instance::phase::{Phase, Phases};
use crate::instance::refusal::Status;

/// `fmi2Component`.
pub type Component = *mut c_void;
/// `fmi2FMUstate`.
pub type FmuState = *mut c_void;
/// `fmi2Status`.
pub type FmiStatus = c_int;
/// `fmi2Boolean`.
pub type Boolean = c_int;

/// `fmi2CallbackLogger`.
pub type Logger = unsafe extern "C" fn(*mut c_void, *const c_char, FmiStatus, *const c_char, *const c_char, ...);

/// `fmi2CallbackFunctions`. Memory is not taken from the importer, and no step is asynchronous.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct CallbackFunctions {
    /// Where messages go.
    pub logger: Option<Logger>,
    /// Not used.
    pub allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// Not used.
    pub free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    /// Not used.
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, FmiStatus)>,
    /// Handed back with every message.
    pub component_environment: *mut c_void,
}

/// `fmi2EventInfo`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct EventInfo {
    /// Whether another round is needed.
    pub new_discrete_states_needed: Boolean,
    /// Whether the simulation should end.
    pub terminate_simulation: Boolean,
    /// Whether the usual sizes of the states changed.
    pub nominals_of_continuous_states_changed: Boolean,
    /// Whether a state jumped.
    pub values_of_continuous_states_changed: Boolean,
    /// Whether a time event is known.
    pub next_event_time_defined: Boolean,
    /// When it is \[s\].
    pub next_event_time: f64,
}

/// `fmi2ModelExchange` and `fmi2CoSimulation` of `fmi2Type`.
pub const MODEL_EXCHANGE: c_int = 0;
/// See [`MODEL_EXCHANGE`].
pub const CO_SIMULATION: c_int = 1;

/// What FMI 2.0 keeps beside an instance.
pub struct Fmi2 {
    /// How the last communication step ended.
    pub(super) last_step: Status,
}

impl Standard for Fmi2 {
    const MARK: u64 = u64::from_le_bytes(*b"glider-2");
}

impl Version for Fmi2 {
    type Boolean = Boolean;

    const NOT_BROKEN: Phases = Phases::of(&[
        Phase::Instantiated,
        Phase::Initialization,
        Phase::Event,
        Phase::ContinuousTime,
        Phase::Step,
        Phase::Terminated,
    ]);
    const RUNNING: Phases =
        Phases::of(&[Phase::Initialization, Phase::Event, Phase::ContinuousTime, Phase::Step, Phase::Terminated]);

    fn reset(&mut self) {
        self.last_step = Status::Ok;
    }
}

pub(super) const ANY: Phases = Phases::of(&Phase::ALL);
