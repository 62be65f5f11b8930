//! Reading and setting variables by value reference.

use std::ffi::CStr;

use super::Instance;
use super::phase::Phase;
use super::refusal::{Outcome, Refusal, Status};
use super::resources::COLUMN_FILE;
use crate::model::{Causality, Initial, Kind, Slot, Variability, Variable};

impl Instance {
    /// The numbers of these variables.
    pub fn get_reals(&self, references: &[u32], values: &mut [f64]) -> Outcome {
        let glider = self.now();
        let mut reading = glider.read();
        for (&reference, value) in references.iter().zip(values) {
            let variable = self.of_kind(reference, Kind::Real)?;
            *value = reading.real(variable.slot).ok_or_else(|| fault(variable))?;
            if !value.is_finite() {
                return Err(not_finite(variable, *value));
            }
        }
        Ok(())
    }

    /// The integers of these variables.
    pub fn get_integers(&self, references: &[u32], values: &mut [i32]) -> Outcome {
        let glider = self.now();
        for (&reference, value) in references.iter().zip(values) {
            let variable = self.of_number(reference)?;
            *value = glider.read().integer(variable.slot).ok_or_else(|| fault(variable))?;
        }
        Ok(())
    }

    /// The truths of these variables, by way of `put`.
    pub fn get_booleans(&self, references: &[u32], mut put: impl FnMut(usize, bool)) -> Outcome {
        let glider = self.now();
        for (i, &reference) in references.iter().enumerate() {
            let variable = self.of_kind(reference, Kind::Boolean)?;
            put(i, glider.read().boolean(variable.slot).ok_or_else(|| fault(variable))?);
        }
        Ok(())
    }

    /// The texts of these variables, by way of `put`. They live as long as the instance.
    pub fn get_texts(&self, references: &[u32], mut put: impl FnMut(usize, &CStr)) -> Outcome {
        for (i, &reference) in references.iter().enumerate() {
            self.of_kind(reference, Kind::Text)?;
            put(i, &self.vehicle_name);
        }
        Ok(())
    }

    /// Sets these variables, all or none.
    pub fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Outcome {
        for (&reference, &value) in references.iter().zip(values) {
            let variable = self.of_kind(reference, Kind::Real)?;
            if self.is_state_of_integrator(variable) {
                if !value.is_finite() {
                    return Err(Refusal::error(format!("{} = {value:?}: expected a finite number", variable.name)));
                }
                continue;
            }
            self.may_set(variable)?;
            check_value(variable, self.or_not_given(variable, value))?;
        }
        for (&reference, &value) in references.iter().zip(values) {
            if let Some(variable) = self.table().variable(reference) {
                if variable.initial == Some(Initial::Approx) && self.core.phase.is_starting() {
                    self.log
                        .event(&format!("{} follows from other start values; that given is not used", variable.name));
                    continue;
                }
                let given = value;
                let value = self.or_not_given(variable, given);
                if value != given {
                    self.warn_of_ground(variable, value);
                }
                if let Slot::Input(i) = variable.slot {
                    self.core.slopes.forget(i);
                }
                if self.core.glider.values.get(variable.slot) != Some(value) {
                    self.core.unsettled = true;
                    self.core.steer();
                    self.core.glider.values.set(variable.slot, value);
                }
            }
        }
        Ok(())
    }

    /// Sets these variables, all or none.
    pub fn set_integers(&mut self, references: &[u32], values: &[i32]) -> Outcome {
        for (&reference, &value) in references.iter().zip(values) {
            let variable = self.of_number(reference)?;
            self.may_set(variable)?;
            check_value(variable, f64::from(value))?;
            if variable.slot == Slot::WaterSource && value == 1 && self.core.glider.column.is_none() {
                return Err(Refusal::error(format!(
                    "water_source = 1, but there is no {COLUMN_FILE} in the resources; leave it 0 and set the inputs"
                )));
            }
        }
        for (&reference, &value) in references.iter().zip(values) {
            if let Some(variable) = self.table().variable(reference) {
                self.core.glider.choose(variable.slot, value);
            }
        }
        Ok(())
    }

    /// Refuses to set variables of a kind of which none can be set.
    pub fn set_none(&self, references: &[u32], kind: Kind) -> Outcome {
        references.iter().try_for_each(|&reference| self.may_set(self.of_kind(reference, kind)?))
    }

    /// Whether this is a continuous state while an importer's integrator drives them. It may then be set by its value
    /// reference, too (CasADi does), and on trial take any value, as with the function for all states.
    fn is_state_of_integrator(&self, variable: &Variable) -> bool {
        self.core.phase == Phase::ContinuousTime && matches!(variable.slot, Slot::State(_))
    }

    /// The value that acts where an input is set to this one. Importers ground inputs that nothing feeds: a density of 0, or
    /// a seabed at the surface, says that there is no such signal. Then the water is of the reference density, and the
    /// seabed out of reach.
    fn or_not_given(&self, variable: &Variable, value: f64) -> f64 {
        /// PathSim takes differences about 0 by steps of 1e-8, in both directions.
        const NOTHING: f64 = 1e-6;
        match (variable.name, variable.bounds) {
            ("water_density_kg_m3", _) if value.abs() <= NOTHING => {
                self.core.glider.parameters().reference_density_kg_m3
            }
            ("seabed_depth_m", Some((_, deepest))) if value.abs() <= NOTHING => deepest,
            _ => value,
        }
    }

    /// Says so, once for each input.
    fn warn_of_ground(&mut self, variable: &'static Variable, value: f64) {
        if self.grounded.contains(&Some(variable.reference)) {
            return;
        }
        if let Some(free) = self.grounded.iter_mut().find(|place| place.is_none()) {
            *free = Some(variable.reference);
        }
        let unit = variable.unit.map_or("", |unit| unit.name);
        self.log.problem(
            Status::Warning,
            &format!(
                "{} = 0 counts as not given: {value:?} {unit} is used; connect the input to change it",
                variable.name
            ),
        );
    }

    /// Refuses a variable that cannot be set, or not now.
    fn may_set(&self, variable: &Variable) -> Outcome {
        let (name, phase) = (&variable.name, self.core.phase);
        let refused = |why: &str| Err(Refusal::error(format!("{name} cannot be set: {why}")));
        let input = variable.causality == Causality::Input;
        if variable.variability == Variability::Constant {
            return refused("it is a constant");
        }
        if variable.causality == Causality::Independent {
            return refused("it is the time");
        }
        if variable.initial == Some(Initial::Calculated) {
            return refused("it is calculated from other variables");
        }
        if variable.initial == Some(Initial::Approx) && !phase.is_starting() {
            return refused("it is a continuous state");
        }
        let tunable = variable.variability == Variability::Tunable;
        match phase {
            Phase::Instantiated | Phase::Initialization => Ok(()),
            Phase::Event | Phase::Step if input || tunable => Ok(()),
            Phase::ContinuousTime | Phase::Intermediate if input => Ok(()),
            Phase::ContinuousTime if tunable => refused(
                "in Continuous-Time Mode a parameter stays as it is, only inputs and states move; enter Event Mode first",
            ),
            _ if variable.causality == Causality::Parameter => {
                refused(&format!("in {phase} a fixed parameter stays as it is; set it before the simulation begins"))
            }
            Phase::ContinuousTime => refused("in Continuous-Time Mode only inputs and continuous states can"),
            _ => refused(&format!("in {phase} only inputs and tunable parameters can")),
        }
    }
}

impl Instance {
    /// The variable of this reference, if it is of this kind.
    pub(super) fn of_kind(&self, reference: u32, kind: Kind) -> Outcome<&'static Variable> {
        let table = self.table();
        let Some(variable) = table.variable(reference) else {
            let last = table.rows.len();
            return Err(Refusal::error(format!(
                "there is no variable with value reference {reference}; they go from 1 to {last}, see modelDescription.xml"
            )));
        };
        if variable.kind == kind {
            return Ok(variable);
        }
        Err(Refusal::error(format!(
            "{} (value reference {reference}) is of type {}, not {}",
            variable.name,
            kind_name(variable.kind),
            kind_name(kind)
        )))
    }

    /// The variable of this reference, if it is an integer or one of a list of choices.
    fn of_number(&self, reference: u32) -> Outcome<&'static Variable> {
        match self.table().variable(reference) {
            Some(variable) if matches!(variable.kind, Kind::Choice(_)) => Ok(variable),
            _ => self.of_kind(reference, Kind::Integer),
        }
    }
}

/// How the standards call a kind.
pub fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Real => "Real (Float64)",
        Kind::Integer => "Integer (Int32)",
        Kind::Choice(_) => "Enumeration",
        Kind::Boolean => "Boolean",
        Kind::Text => "String",
    }
}

pub(super) fn check_value(variable: &Variable, value: f64) -> Outcome {
    let name = &variable.name;
    if !value.is_finite() {
        return Err(Refusal::error(format!("{name} = {value:?}: expected a finite number")));
    }
    match variable.bounds {
        Some((min, max)) if !(min..=max).contains(&value) => {
            let unit = variable.unit.map_or("", |unit| unit.name);
            Err(Refusal::error(format!("{name} = {value:?} {unit} lies outside its bounds, {min:?} to {max:?}")))
        }
        _ => Ok(()),
    }
}

/// What a calculated number says that is none.
pub(super) fn not_finite(variable: &Variable, value: f64) -> Refusal {
    Refusal::discard(format!(
        "{} is {value} here: states, inputs or parameters are out of range; go back to where they were, or take a shorter step",
        variable.name
    ))
}

fn fault(variable: &Variable) -> Refusal {
    Refusal::error(format!("{} has no value", variable.name))
}
