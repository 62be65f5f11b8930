//! Making, initialising, ending and freeing an instance.

use std::ffi::{c_char, c_void};
use std::path::Path;

use super::{Version, is_true};
use crate::instance::boundary::{Component, caught, elements, text};
use crate::instance::log::Log;
use crate::instance::phase::{Phase, Phases};
use crate::instance::refusal::{Outcome, Refusal, Status};
use crate::instance::{Abilities, Instance, Interface, resources};
use crate::model::vehicle::Vehicle;

/// What an importer asks for.
pub struct Wanted {
    /// What the instance is driven by.
    pub interface: Interface,
    /// What the importer can do.
    pub abilities: Abilities,
}

/// The texts that an instance is made from.
pub struct Texts {
    /// What the importer calls the instance.
    pub name: String,
    /// The token of the model description that the importer has read.
    pub token: String,
    /// Where the resources are: a path, or with FMI 2.0 a URI.
    pub resources: Option<String>,
}

impl Texts {
    /// Reads the caller's texts.
    ///
    /// # Safety
    /// See the module.
    pub unsafe fn read(name: *const c_char, token: *const c_char, resources: *const c_char) -> Self {
        // SAFETY: see the module.
        let [name, token, resources] = [name, token, resources].map(|pointer| unsafe { text(pointer) });
        Texts {
            name: name.unwrap_or_default(),
            token: token.unwrap_or_default(),
            resources: resources.filter(|path| !path.is_empty()),
        }
    }

    /// The vehicle in the resources, or the built-in one.
    pub fn vehicle(&self, folder: Option<&Path>, log: &Log) -> Outcome<Vehicle> {
        resources::chosen(&self.name, &self.token, folder, log)
    }
}

/// Makes an instance as `prepare` says, and returns the pointer that the caller holds; null, with a message, if it
/// refuses.
pub fn made<V: Version>(
    function: &str,
    log: impl FnOnce() -> Option<Log>,
    standard: V,
    prepare: impl FnOnce(&Log) -> Outcome<(Wanted, Vehicle)>,
) -> *mut c_void {
    let made = caught(|| {
        let log = log()?;
        match prepare(&log) {
            Ok((Wanted { interface, abilities }, vehicle)) => {
                Some(Component::into_pointer(Instance::new(interface, abilities, &vehicle, log), standard))
            }
            Err(refusal) => {
                log.problem(refusal.status, &format!("{function}: {}", refusal.message));
                None
            }
        }
    });
    made.ok().flatten().unwrap_or(std::ptr::null_mut())
}

/// Frees an instance.
///
/// # Safety
/// See the module; the pointer must not be used again.
pub unsafe fn free<V: Version>(pointer: *mut c_void, function: &str) {
    // SAFETY: see the module.
    unsafe {
        let Some(component) = Component::<V>::from_pointer(pointer) else { return };
        // The step that waits for its importer's callback still needs the instance.
        if (*component).instance.phase() == Phase::Intermediate {
            let refused = format!("{function}: not allowed in Intermediate Update Mode; let the step end first");
            let _ = caught(|| (*component).instance.log.problem(Status::Error, &refused));
            return;
        }
        Component::<V>::free(pointer);
    }
}

/// Switches categories of messages on or off.
///
/// # Safety
/// See the module.
pub unsafe fn set_debug_logging<V: Version>(
    c: &mut Component<V>,
    logging_on: V::Boolean,
    n_categories: usize,
    categories: *const *const c_char,
) -> Outcome {
    // SAFETY: see the module.
    let names: Vec<String> = unsafe { elements(categories, n_categories, "categories") }?
        .iter()
        .map(|name| unsafe { text(*name) }.unwrap_or_default())
        .collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    c.instance
        .log
        .switch(is_true(logging_on), &names)
        .map_err(|unknown| Refusal::error(format!("there is no log category \"{unknown}\"; see modelDescription.xml")))
}

/// Takes over tolerance, start and stop time, where they are given.
pub fn set_up<V: Version>(
    c: &mut Component<V>,
    tolerance_defined: V::Boolean,
    tolerance: f64,
    start_time_s: f64,
    stop_time_defined: V::Boolean,
    stop_time_s: f64,
) -> Outcome {
    c.instance.allow(Phases::of(&[Phase::Instantiated]))?;
    let given = |defined, value| is_true::<V::Boolean>(defined).then_some(value);
    c.instance.set_up(given(tolerance_defined, tolerance), start_time_s, given(stop_time_defined, stop_time_s))
}

/// Start values are set and read from here.
pub fn enter_initialization<V: Version>(c: &mut Component<V>) -> Outcome {
    c.instance.allow(Phases::of(&[Phase::Instantiated]))?;
    c.instance.enter_initialization()
}

/// The simulation begins: at an event in Model Exchange, and in Co-Simulation with an importer that handles events.
pub fn exit_initialization<V: Version>(c: &mut Component<V>) -> Outcome {
    c.instance.allow(Phases::of(&[Phase::Initialization]))?;
    let at_event = c.instance.interface() == Interface::ModelExchange || c.instance.abilities().event_mode;
    c.instance.exit_initialization(if at_event { Phase::Event } else { Phase::Step })
}

/// The simulation ends.
pub fn terminate<V: Version>(c: &mut Component<V>) -> Outcome {
    c.instance.allow(Phases::of(&[Phase::Event, Phase::ContinuousTime, Phase::Step]))?;
    c.instance.enter(Phase::Terminated);
    Ok(())
}

/// As after instantiation.
pub fn reset<V: Version>(c: &mut Component<V>) -> Outcome {
    // During a callback from inside a step the step itself is still to be finished.
    if c.instance.phase() == Phase::Intermediate {
        return Err(Refusal::error("not allowed in Intermediate Update Mode; let the step end first"));
    }
    c.instance.reset();
    c.standard.reset();
    Ok(())
}
