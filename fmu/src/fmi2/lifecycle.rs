//! Making, initialising, ending and freeing an instance.

use std::ffi::{CString, c_char, c_int, c_void};

use super::types::*;
use crate::adapter::exported;
use crate::adapter::lifecycle::{self, Texts, Wanted};
use crate::instance::boundary::elements;
use crate::instance::log::{Log, Sink};
use crate::instance::refusal::{Outcome, Refusal, Status};
use crate::instance::resources::folder_of_uri;
use crate::instance::{Abilities, Interface};
use crate::model::vehicle::Vehicle;

exported! { Fmi2;
    fmi2SetDebugLogging(
        logging_on: Boolean,
        n_categories: usize,
        categories: *const *const c_char
    ) = lifecycle::set_debug_logging;
    fmi2SetupExperiment(
        tolerance_defined: Boolean,
        tolerance: f64,
        start_time: f64,
        stop_time_defined: Boolean,
        stop_time: f64
    ) = lifecycle::set_up;
    fmi2EnterInitializationMode() = lifecycle::enter_initialization;
    fmi2ExitInitializationMode() = lifecycle::exit_initialization;
    fmi2Terminate() = lifecycle::terminate;
    fmi2Reset() = lifecycle::reset;
}

/// `fmi2FreeInstance`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(component: Component) {
    // SAFETY: see the module.
    unsafe { lifecycle::free::<Fmi2>(component, "fmi2FreeInstance") }
}

/// `fmi2GetTypesPlatform`
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// `fmi2GetVersion`
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// `fmi2Instantiate`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instance_name: *const c_char,
    fmu_type: c_int,
    guid: *const c_char,
    resource_location: *const c_char,
    functions: *const CallbackFunctions,
    _visible: Boolean,
    logging_on: Boolean,
) -> Component {
    // SAFETY: texts or null, see the module.
    let texts = || unsafe { Texts::read(instance_name, guid, resource_location) };
    let log = || {
        // SAFETY: null or one struct, see the module.
        let functions = unsafe { elements(functions, 1, "functions") }.ok()?;
        Some(Log::new(sink(&functions[0], &texts().name), logging_on != 0))
    };
    lifecycle::made("fmi2Instantiate", log, Fmi2 { last_step: Status::Ok }, |log| chosen(&texts(), fmu_type, log))
}

fn chosen(texts: &Texts, fmu_type: c_int, log: &Log) -> Outcome<(Wanted, Vehicle)> {
    let interface = match fmu_type {
        MODEL_EXCHANGE => Interface::ModelExchange,
        CO_SIMULATION => Interface::CoSimulation,
        other => return Err(Refusal::error(format!("fmuType is {other}, expected 0 (ME) or 1 (CS)"))),
    };
    let folder = match texts.resources.as_deref().map(folder_of_uri) {
        None => None,
        Some(Ok(folder)) => Some(folder),
        Some(Err(why)) => {
            log.problem(Status::Warning, &format!("fmi2Instantiate: {why}; going on without resources"));
            None
        }
    };
    Ok((Wanted { interface, abilities: Abilities::default() }, texts.vehicle(folder.as_deref(), log)?))
}

/// A way out for messages through the importer's callback.
fn sink(functions: &CallbackFunctions, name: &str) -> Option<Sink> {
    struct Importer {
        logger: Logger,
        environment: *mut c_void,
        name: CString,
    }
    // SAFETY: the environment is the importer's own and only handed back to it.
    unsafe impl Send for Importer {}

    let importer = Importer {
        logger: functions.logger?,
        environment: functions.component_environment,
        name: CString::new(name.replace('\0', " ")).unwrap_or_default(),
    };
    Some(Box::new(move |status, category, message| {
        let importer = &importer;
        // The message is a format of printf, and #r1# a reference to a variable.
        let plain = message.to_string_lossy().replace('%', "%%").replace('#', "##");
        let message = CString::new(plain).unwrap_or_default();
        let (environment, name) = (importer.environment, importer.name.as_ptr());
        // SAFETY: the importer's own function, with texts that live through the call.
        unsafe {
            (importer.logger)(environment, name, status as FmiStatus, category.as_ptr(), message.as_ptr());
        }
    }))
}
