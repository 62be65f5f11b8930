//! Making, initialising, ending and freeing an instance.

use std::ffi::{CString, c_char, c_int, c_void};

use super::types::*;
use crate::instance::boundary::{self, call, caught, elements, text};
use crate::instance::log::{Log, Sink};
use crate::instance::phase::{Phase, Phases};
use crate::instance::refusal::{Outcome, Refusal, Status};
use crate::instance::resources::{self, folder_of_uri};
use crate::instance::{Abilities, Instance, Interface};
use crate::model::vehicle::Vehicle;

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
    let made = caught(|| {
        // SAFETY: null or one struct, see the module.
        let functions = unsafe { elements(functions, 1, "functions") }.ok()?;
        // SAFETY: see the module.
        let name = unsafe { text(instance_name) }.unwrap_or_default();
        let log = Log::new(sink(&functions[0], &name), logging_on != 0);
        // SAFETY: see the module.
        let (guid, location) = unsafe { (text(guid), text(resource_location)) };
        match chosen(&name, fmu_type, guid, location, &log) {
            Ok((interface, vehicle)) => {
                let instance = Instance::new(interface, Abilities::default(), &vehicle, log);
                Some(boundary::Component::into_pointer(instance, Fmi2 { last_step: Status::Ok }))
            }
            Err(refusal) => {
                log.problem(refusal.status, &format!("fmi2Instantiate: {}", refusal.message));
                None
            }
        }
    });
    made.ok().flatten().unwrap_or(std::ptr::null_mut())
}

fn chosen(
    name: &str,
    fmu_type: c_int,
    guid: Option<String>,
    location: Option<String>,
    log: &Log,
) -> Outcome<(Interface, Vehicle)> {
    let interface = match fmu_type {
        MODEL_EXCHANGE => Interface::ModelExchange,
        CO_SIMULATION => Interface::CoSimulation,
        other => return Err(Refusal::error(format!("fmuType is {other}, expected 0 (ME) or 1 (CS)"))),
    };
    let folder = match location.filter(|location| !location.is_empty()).map(|location| folder_of_uri(&location)) {
        None => None,
        Some(Ok(folder)) => Some(folder),
        Some(Err(why)) => {
            log.problem(Status::Warning, &format!("fmi2Instantiate: {why}; going on without resources"));
            None
        }
    };
    Ok((interface, resources::chosen(name, &guid.unwrap_or_default(), folder.as_deref(), log)?))
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

/// `fmi2FreeInstance`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(component: Component) {
    // SAFETY: see the module.
    unsafe { boundary::Component::<Fmi2>::free(component) }
}

/// `fmi2SetDebugLogging`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    component: Component,
    logging_on: Boolean,
    n_categories: usize,
    categories: *const *const c_char,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2SetDebugLogging", |c| {
            let names: Vec<String> = elements(categories, n_categories, "categories")?
                .iter()
                .map(|name| text(*name).unwrap_or_default())
                .collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            c.instance.log.switch(logging_on != 0, &names).map_err(|unknown| {
                Refusal::error(format!("there is no log category \"{unknown}\"; see modelDescription.xml"))
            })
        })
    }
}

/// `fmi2SetupExperiment`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    component: Component,
    tolerance_defined: Boolean,
    tolerance: f64,
    start_time: f64,
    stop_time_defined: Boolean,
    stop_time: f64,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2SetupExperiment", |c| {
            c.instance.allow(Phases::of(&[Phase::Instantiated]))?;
            let tolerance = (tolerance_defined != 0).then_some(tolerance);
            c.instance.set_up(tolerance, start_time, (stop_time_defined != 0).then_some(stop_time))
        })
    }
}

/// `fmi2EnterInitializationMode`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(component: Component) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2EnterInitializationMode", |c| {
            c.instance.allow(Phases::of(&[Phase::Instantiated]))?;
            c.instance.enter_initialization()
        })
    }
}

/// `fmi2ExitInitializationMode`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(component: Component) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2ExitInitializationMode", |c| {
            c.instance.allow(Phases::of(&[Phase::Initialization]))?;
            c.instance.exit_initialization(match c.instance.interface() {
                Interface::ModelExchange => Phase::Event,
                Interface::CoSimulation => Phase::Step,
            })
        })
    }
}

/// `fmi2Terminate`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(component: Component) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2Terminate", |c| {
            c.instance.allow(Phases::of(&[Phase::Event, Phase::ContinuousTime, Phase::Step]))?;
            c.instance.enter(Phase::Terminated);
            Ok(())
        })
    }
}

/// `fmi2Reset`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(component: Component) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi2>(component, "fmi2Reset", |c| {
            c.instance.reset();
            c.standard.last_step = Status::Ok;
            Ok(())
        })
    }
}
