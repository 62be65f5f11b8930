//! Making, initialising, ending and freeing an instance.

use std::ffi::{c_char, c_void};
use std::path::Path;

use super::types::*;
use crate::adapter::exported;
use crate::adapter::lifecycle::{self, Texts, Wanted};
use crate::instance::boundary::{Component, caught, elements};
use crate::instance::log::{Log, Sink};
use crate::instance::refusal::{Outcome, Refusal, Status};
use crate::instance::{Abilities, Interface};
use crate::model::vehicle::Vehicle;

exported! { Fmi3;
    fmi3SetDebugLogging(
        logging_on: Boolean,
        n_categories: usize,
        categories: *const *const c_char
    ) = lifecycle::set_debug_logging;
    fmi3EnterInitializationMode(
        tolerance_defined: Boolean,
        tolerance: f64,
        start_time: f64,
        stop_time_defined: Boolean,
        stop_time: f64
    ) = enter_initialization;
    fmi3ExitInitializationMode() = lifecycle::exit_initialization;
    fmi3Terminate() = lifecycle::terminate;
    fmi3Reset() = lifecycle::reset;
    fmi3EnterConfigurationMode() = no_structural_parameters;
    fmi3ExitConfigurationMode() = no_structural_parameters;
}

fn enter_initialization(
    c: &mut Component<Fmi3>,
    tolerance_defined: Boolean,
    tolerance: f64,
    start_time_s: f64,
    stop_time_defined: Boolean,
    stop_time_s: f64,
) -> Outcome {
    lifecycle::set_up(c, tolerance_defined, tolerance, start_time_s, stop_time_defined, stop_time_s)?;
    lifecycle::enter_initialization(c)
}

fn no_structural_parameters(_: &mut Component<Fmi3>) -> Outcome {
    Err(Refusal::error("there are no structural parameters to configure"))
}

/// `fmi3FreeInstance`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: Pointer) {
    // SAFETY: see the module.
    unsafe { lifecycle::free::<Fmi3>(instance, "fmi3FreeInstance") }
}

/// `fmi3GetVersion`
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// `fmi3InstantiateModelExchange`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    instance_name: *const c_char,
    instantiation_token: *const c_char,
    resource_path: *const c_char,
    _visible: Boolean,
    logging_on: Boolean,
    environment: *mut c_void,
    log_message: Option<LogMessage>,
) -> Pointer {
    let wanted = Wanted { interface: Interface::ModelExchange, abilities: Abilities::default() };
    let log = || Log::new(sink(log_message, environment), logging_on != 0);
    let standard = Fmi3 { environment, intermediate_update: None };
    // SAFETY: see the module.
    unsafe { make([instance_name, instantiation_token, resource_path], wanted, log, standard, |_| Ok(())) }
}

/// `fmi3InstantiateCoSimulation`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    instance_name: *const c_char,
    instantiation_token: *const c_char,
    resource_path: *const c_char,
    _visible: Boolean,
    logging_on: Boolean,
    event_mode_used: Boolean,
    early_return_allowed: Boolean,
    required_intermediate_variables: *const u32,
    n_required_intermediate_variables: usize,
    environment: *mut c_void,
    log_message: Option<LogMessage>,
    intermediate_update: Option<IntermediateUpdate>,
) -> Pointer {
    let abilities = Abilities { event_mode: event_mode_used != 0, early_return: early_return_allowed != 0 };
    let wanted = Wanted { interface: Interface::CoSimulation, abilities };
    let log = || Log::new(sink(log_message, environment), logging_on != 0);
    let standard = Fmi3 { environment, intermediate_update };
    let check = |vehicle: &Vehicle| {
        // SAFETY: see the module.
        let required = unsafe {
            elements(
                required_intermediate_variables,
                n_required_intermediate_variables,
                "requiredIntermediateVariables",
            )
        }?;
        match required.iter().find(|reference| vehicle.glider.model.table().variable(**reference).is_none()) {
            Some(unknown) => Err(Refusal::error(format!("there is no variable with value reference {unknown}"))),
            None => Ok(()),
        }
    };
    // SAFETY: see the module.
    unsafe { make([instance_name, instantiation_token, resource_path], wanted, log, standard, check) }
}

/// `fmi3InstantiateScheduledExecution`: this FMU has no clocks to schedule.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _instance_name: *const c_char,
    _instantiation_token: *const c_char,
    _resource_path: *const c_char,
    _visible: Boolean,
    logging_on: Boolean,
    environment: *mut c_void,
    log_message: Option<LogMessage>,
    _clock_update: Option<unsafe extern "C" fn(*mut c_void)>,
    _lock_preemption: Option<unsafe extern "C" fn()>,
    _unlock_preemption: Option<unsafe extern "C" fn()>,
) -> Pointer {
    let _ = caught(|| {
        Log::new(sink(log_message, environment), logging_on != 0).problem(
            Status::Error,
            "fmi3InstantiateScheduledExecution: not provided; use Co-Simulation or Model Exchange",
        );
    });
    std::ptr::null_mut()
}

/// Makes an instance from name, token and resource path.
///
/// # Safety
/// See the module.
unsafe fn make(
    [name, token, resources]: [*const c_char; 3],
    wanted: Wanted,
    log: impl FnOnce() -> Log,
    standard: Fmi3,
    check: impl FnOnce(&Vehicle) -> Outcome,
) -> Pointer {
    lifecycle::made(
        "fmi3Instantiate",
        || Some(log()),
        standard,
        |log| {
            // SAFETY: texts or null, see the module.
            let texts = unsafe { Texts::read(name, token, resources) };
            let vehicle = texts.vehicle(texts.resources.as_deref().map(Path::new), log)?;
            check(&vehicle)?;
            Ok((wanted, vehicle))
        },
    )
}

/// A way out for messages through the importer's callback.
fn sink(log_message: Option<LogMessage>, environment: *mut c_void) -> Option<Sink> {
    struct Importer {
        log_message: LogMessage,
        environment: *mut c_void,
    }
    // SAFETY: the environment is the importer's own and only handed back to it.
    unsafe impl Send for Importer {}

    let importer = Importer { log_message: log_message?, environment };
    Some(Box::new(move |status, category, message| {
        let importer = &importer;
        // SAFETY: the importer's own function, with texts that live through the call.
        unsafe {
            (importer.log_message)(importer.environment, status as FmiStatus, category.as_ptr(), message.as_ptr());
        }
    }))
}
