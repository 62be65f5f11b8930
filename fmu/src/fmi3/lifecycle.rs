//! Making, initialising, ending and freeing an instance.

use std::ffi::{c_char, c_void};
use std::path::Path;

use super::types::*;
use crate::instance::boundary::{Component, call, caught, elements, text};
use crate::instance::log::{Log, Sink};
use crate::instance::phase::{Phase, Phases};
use crate::instance::refusal::{Outcome, Refusal, Status};
use crate::instance::{Abilities, Instance, Interface, resources};
use crate::model::vehicle::Vehicle;

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

struct Wanted {
    interface: Interface,
    abilities: Abilities,
}

/// Makes an instance from name, token and resource path.
///
/// # Safety
/// See the module.
unsafe fn make(
    texts: [*const c_char; 3],
    wanted: Wanted,
    log: impl FnOnce() -> Log,
    standard: Fmi3,
    check: impl FnOnce(&Vehicle) -> Outcome,
) -> Pointer {
    let made = caught(|| {
        let log = log();
        // SAFETY: see the module.
        let [name, token, folder] = texts.map(|pointer| unsafe { text(pointer) });
        let folder = folder.filter(|folder| !folder.is_empty());
        let (name, token) = (name.unwrap_or_default(), token.unwrap_or_default());
        let vehicle = resources::chosen(&name, &token, folder.as_deref().map(Path::new), &log)
            .and_then(|vehicle| check(&vehicle).map(|()| vehicle));
        match vehicle {
            Ok(vehicle) => {
                let instance = Instance::new(wanted.interface, wanted.abilities, &vehicle, log);
                Some(Component::into_pointer(instance, standard))
            }
            Err(refusal) => {
                log.problem(refusal.status, &format!("fmi3Instantiate: {}", refusal.message));
                None
            }
        }
    });
    made.ok().flatten().unwrap_or(std::ptr::null_mut())
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

/// `fmi3FreeInstance`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: Pointer) {
    // SAFETY: see the module.
    unsafe {
        let Some(component) = Component::<Fmi3>::from_pointer(instance) else { return };
        // The step that waits for its importer's callback still needs the instance.
        if (*component).instance.phase() == Phase::Intermediate {
            let refused = "fmi3FreeInstance: not allowed in Intermediate Update Mode; let the step end first";
            let _ = caught(|| (*component).instance.log.problem(Status::Error, refused));
            return;
        }
        Component::<Fmi3>::free(instance);
    }
}

/// `fmi3SetDebugLogging`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: Pointer,
    logging_on: Boolean,
    n_categories: usize,
    categories: *const *const c_char,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3SetDebugLogging", |c| {
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

/// `fmi3EnterInitializationMode`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: Pointer,
    tolerance_defined: Boolean,
    tolerance: f64,
    start_time: f64,
    stop_time_defined: Boolean,
    stop_time: f64,
) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3EnterInitializationMode", |c| {
            c.instance.allow(Phases::of(&[Phase::Instantiated]))?;
            let tolerance = (tolerance_defined != 0).then_some(tolerance);
            c.instance.set_up(tolerance, start_time, (stop_time_defined != 0).then_some(stop_time))?;
            c.instance.enter_initialization()
        })
    }
}

/// `fmi3ExitInitializationMode`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitInitializationMode(instance: Pointer) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3ExitInitializationMode", |c| {
            c.instance.allow(Phases::of(&[Phase::Initialization]))?;
            let in_events = c.instance.interface() == Interface::ModelExchange || c.instance.abilities().event_mode;
            c.instance.exit_initialization(if in_events { Phase::Event } else { Phase::Step })
        })
    }
}

/// `fmi3Terminate`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Terminate(instance: Pointer) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3Terminate", |c| {
            c.instance.allow(Phases::of(&[Phase::Event, Phase::ContinuousTime, Phase::Step]))?;
            c.instance.enter(Phase::Terminated);
            Ok(())
        })
    }
}

/// `fmi3Reset`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(instance: Pointer) -> FmiStatus {
    // SAFETY: see the module.
    unsafe {
        call::<Fmi3>(instance, "fmi3Reset", |c| {
            // During a callback from inside a step the step itself is still to be finished.
            if c.instance.phase() == Phase::Intermediate {
                return Err(Refusal::error("not allowed in Intermediate Update Mode; let the step end first"));
            }
            c.instance.reset();
            Ok(())
        })
    }
}

/// `fmi3EnterConfigurationMode`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterConfigurationMode(instance: Pointer) -> FmiStatus {
    // SAFETY: see the module.
    unsafe { call::<Fmi3>(instance, "fmi3EnterConfigurationMode", |_| no_structural_parameters()) }
}

/// `fmi3ExitConfigurationMode`
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitConfigurationMode(instance: Pointer) -> FmiStatus {
    // SAFETY: see the module.
    unsafe { call::<Fmi3>(instance, "fmi3ExitConfigurationMode", |_| no_structural_parameters()) }
}

fn no_structural_parameters() -> Outcome {
    Err(Refusal::error("there are no structural parameters to configure"))
}
