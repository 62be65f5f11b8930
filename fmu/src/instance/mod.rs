//! One simulation of the glider: its state machine, what may be set when, its steps and its saved states.
//!
//! Both standards are served by this one core; their adapters only translate. Every call either does what it says or
//! is refused with a [`Refusal`] and leaves the instance as it was.
//! Knows no C types, and of the glider only its table of variables.

pub mod access;
pub mod boundary;
pub mod derivatives;
pub mod exchange;
pub mod log;
pub mod phase;
pub mod refusal;
pub mod resources;
pub mod snapshot;
pub mod stepping;

use std::borrow::Cow;
use std::ffi::CString;

use glidepolar_dynamics::integrate::DEFAULT_TOLERANCE;
use glidepolar_dynamics::limits::reversed;

use crate::model::flight::Integrator;
use crate::model::vehicle::Vehicle;
use crate::model::{Glider, Model, Table};
use log::Log;
use phase::{Phase, Phases};
use refusal::{Outcome, Refusal};
use stepping::InputSlopes;

/// What an instance is driven by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interface {
    /// An importer's integrator.
    ModelExchange,
    /// Its own.
    CoSimulation,
}

/// What the importer of a co-simulation can do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Abilities {
    /// It handles events itself.
    pub event_mode: bool,
    /// It accepts that a step ends before its communication point.
    pub early_return: bool,
}

/// One simulation.
pub struct Instance {
    interface: Interface,
    abilities: Abilities,
    vehicle_name: CString,
    resources: u64,
    at_start: Core,
    core: Core,
    /// Each in a place of its own, whose address is its handle.
    #[expect(clippy::vec_box, reason = "a handle must stay when the list grows")]
    saved: Vec<Box<Core>>,
    /// The inputs that were set to 0 where nothing can be 0, and warned of.
    grounded: [Option<u32>; 2],
    /// Where messages go.
    pub log: Log,
}

/// All that changes while a simulation runs: a clone is a saved state.
#[derive(Debug, Clone, PartialEq)]
pub struct Core {
    phase: Phase,
    glider: Glider,
    start_time_s: f64,
    stop_time_s: Option<f64>,
    integrator: Integrator,
    slopes: InputSlopes,
    /// Inputs or parameters changed, or an event was found, since the last step: limits must be looked at anew.
    unsettled: bool,
    /// Inputs or parameters changed since the last step: they may change after the next one, too.
    is_steered: bool,
}

impl Core {
    /// Notes that inputs or parameters change: what the integrator saw beyond this time does not come.
    fn steer(&mut self) {
        self.is_steered = true;
        self.integrator.forget_ahead();
    }
}

impl Instance {
    /// A fresh instance of this vehicle.
    pub fn new(interface: Interface, abilities: Abilities, vehicle: &Vehicle, log: Log) -> Self {
        let core = Core {
            phase: Phase::Instantiated,
            glider: vehicle.glider.clone(),
            start_time_s: 0.0,
            stop_time_s: None,
            integrator: Integrator::new(vehicle.glider.model, DEFAULT_TOLERANCE),
            slopes: InputSlopes::default(),
            unsettled: true,
            is_steered: true,
        };
        let vehicle_name = CString::new(vehicle.name.replace('\0', " ")).unwrap_or_default();
        let (resources, at_start) = (vehicle.resources, core.clone());
        Instance {
            interface,
            abilities,
            vehicle_name,
            resources,
            at_start,
            core,
            saved: Vec::new(),
            grounded: [None; 2],
            log,
        }
    }

    /// Which model it simulates.
    pub fn model(&self) -> Model {
        self.core.glider.model
    }

    /// Its variables.
    pub fn table(&self) -> Table {
        self.model().table()
    }

    /// Where it stands.
    pub fn phase(&self) -> Phase {
        self.core.phase
    }

    /// What drives it.
    pub fn interface(&self) -> Interface {
        self.interface
    }

    /// What the importer can do.
    pub fn abilities(&self) -> Abilities {
        self.abilities
    }

    /// The time it has reached \[s\].
    pub fn time_s(&self) -> f64 {
        self.core.glider.values.time_s
    }

    /// Refuses a call that this phase does not allow.
    pub fn allow(&self, phases: Phases) -> Outcome {
        let phase = self.core.phase;
        if phases.contain(phase) {
            return Ok(());
        }
        let hint = if phase == Phase::Broken { "; reset or free the instance" } else { "" };
        Err(Refusal::error(format!("not allowed in {phase}, only in {phases}{hint}")))
    }

    /// Refuses a call that belongs to the other interface.
    pub fn only(&self, interface: Interface) -> Outcome {
        match (self.interface == interface, interface) {
            (true, _) => Ok(()),
            (false, Interface::ModelExchange) => {
                Err(Refusal::error("belongs to Model Exchange, this instance was made for Co-Simulation"))
            }
            (false, Interface::CoSimulation) => {
                Err(Refusal::error("belongs to Co-Simulation, this instance was made for Model Exchange"))
            }
        }
    }

    /// Takes over tolerance, start and stop time.
    pub fn set_up(&mut self, tolerance: Option<f64>, start_time_s: f64, stop_time_s: Option<f64>) -> Outcome {
        if let Some(tolerance) = tolerance
            && !(tolerance > 0.0 && tolerance.is_finite())
        {
            return Err(Refusal::error(format!("the tolerance is {tolerance}, expected a number above zero")));
        }
        if !start_time_s.is_finite() {
            return Err(Refusal::error(format!("the start time is {start_time_s}, expected a finite number")));
        }
        if let Some(stop) = stop_time_s
            && (stop.is_nan() || stop < start_time_s)
        {
            return Err(Refusal::error(format!(
                "the stop time is {stop}, expected a time after the start at {start_time_s} s"
            )));
        }
        let core = &mut self.core;
        core.integrator = Integrator::new(core.glider.model, tolerance.unwrap_or(DEFAULT_TOLERANCE));
        core.glider.values.time_s = start_time_s;
        core.start_time_s = start_time_s;
        core.stop_time_s = stop_time_s;
        Ok(())
    }

    /// Start values are set and looked at from here.
    pub fn enter_initialization(&mut self) -> Outcome {
        self.core.phase = Phase::Initialization;
        Ok(())
    }

    /// The simulation begins, in `next`.
    pub fn exit_initialization(&mut self, next: Phase) -> Outcome {
        self.check_limits()?;
        self.check_weight()?;
        if self.core.glider.starts_in_trim && !self.core.glider.has_glide() {
            return Err(Refusal::error(
                "start_in_trim is set, but these parameters have no steady glide within the limits of ballast and moving mass; change them, or give start values",
            ));
        }
        let glider = self.started();
        if !glider.derivative().into_iter().all(f64::is_finite) {
            return Err(Refusal::error(
                "with these start values the rates of change are not finite: look for masses or inertias that are zero",
            ));
        }
        self.tell_of_moves(&self.core.glider.values.state, &glider);
        self.core.glider = glider;
        self.core.unsettled = true;
        self.core.phase = next;
        self.log.event("the simulation begins");
        Ok(())
    }

    /// Refuses limits of ballast or moving mass that stand the wrong way round. Looked at where a simulation goes on, not
    /// where one of a pair is set: the other may follow.
    pub fn check_limits(&self) -> Outcome {
        match reversed(&self.core.glider.parameters()) {
            None => Ok(()),
            Some([(low, least), (high, largest)]) => Err(Refusal::error(format!(
                "{high} = {largest:?} lies below {low} = {least:?}; set them the other way round"
            ))),
        }
    }

    /// Refuses a glider that weighs nothing in air.
    fn check_weight(&self) -> Outcome {
        let p = self.core.glider.parameters();
        let weight_kg = p.mass_kg() + p.ballast_offset_kg;
        if weight_kg > 0.0 {
            return Ok(());
        }
        Err(Refusal::error(format!(
            "hull, moving mass, ballast and offset weigh {weight_kg} kg together; expected more than nothing"
        )))
    }

    /// Goes to another phase.
    pub fn enter(&mut self, phase: Phase) {
        self.core.phase = phase;
    }

    /// As after instantiation.
    pub fn reset(&mut self) {
        self.core = self.at_start.clone();
    }

    /// The glider as it is now: before the simulation begins, with what follows from the start values.
    pub(crate) fn now(&self) -> Cow<'_, Glider> {
        if self.core.phase.is_starting() { Cow::Owned(self.started()) } else { Cow::Borrowed(&self.core.glider) }
    }

    fn started(&self) -> Glider {
        let mut glider = self.core.glider.clone();
        glider.complete_start();
        glider.begin();
        glider
    }
}
