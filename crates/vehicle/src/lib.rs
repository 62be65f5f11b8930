//! A vehicle: one description for the tank, the sea, the simulation and the FMU, kept in a TOML file.
//!
//! [`Vehicle::load`] takes the name of a [built-in](builtin) vehicle or a file, [`Vehicle::parameters`] gives the
//! equations of motion their numbers, [`Vehicle::set`] changes a figure and leaves the rest of the file as it was,
//! comments included. The keys stand in one table, [`keys::KEYS`]; mechanisms are rows of [`PARAMETERS`].

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

pub mod builtin;
pub mod keys;
mod read;
mod to_body;
mod to_parameters;

use std::collections::BTreeMap;
use std::path::Path;

use glidepolar_dynamics::mechanisms;
use glidepolar_dynamics::{PARAMETERS, parameter_index};
use glidepolar_input::{InputError, Place};

use glidepolar_spatial::RateLaw;

pub use keys::Sections;
pub use to_parameters::MissingKeys;

/// A vehicle as its file describes it.
#[derive(Debug, Clone)]
pub struct Vehicle {
    /// What the glider is called.
    pub name: String,
    /// Where the figures come from.
    pub source: String,
    /// The numbers, section by section.
    pub sections: Sections,
    /// Values of mechanism parameters, by parameter name; absent means without effect.
    pub mechanisms: BTreeMap<&'static str, f64>,
    /// Standard errors, by dotted name.
    pub uncertainty: BTreeMap<String, f64>,
    /// How lateral forces and moments by a rate grow with speed.
    pub rate_law: RateLaw,
    /// Moments of inertia of the moving mass about its own centre \[kg m2\].
    pub moving_mass_inertia_kg_m2: Option<[f64; 3]>,
    /// Whether it is one of the built-in vehicles rather than a user's own.
    pub is_builtin: bool,
    document: toml_edit::DocumentMut,
}

impl Vehicle {
    /// Reads a vehicle file, or takes a built-in vehicle where `name_or_file` is the name of one.
    ///
    /// # Errors
    /// Where the file cannot be read, a key is unknown, missing or of the wrong kind; with file, line and column.
    pub fn load(name_or_file: &str) -> Result<Vehicle, InputError> {
        if let Some(text) = builtin::text(name_or_file) {
            let vehicle = Vehicle::parse(text, format!("built-in vehicle {name_or_file}"))?;
            return Ok(Vehicle { is_builtin: true, ..vehicle });
        }
        let path = Path::new(name_or_file);
        let text = std::fs::read_to_string(path).map_err(|error| {
            let names = builtin::NAMES.join(", ");
            let near = glidepolar_input::nearest(name_or_file, builtin::NAMES.iter().copied());
            let help = match near {
                Some(near) => format!("did you mean the built-in vehicle {near}?"),
                None => format!("name a vehicle file or one of the built-in vehicles: {names}"),
            };
            InputError::io(path, &error).help(help)
        })?;
        Vehicle::parse(&text, path)
    }

    /// Reads the text of a vehicle file; `origin` is what errors name.
    ///
    /// # Errors
    /// As [`Vehicle::load`].
    pub fn parse(text: &str, origin: impl AsRef<Path>) -> Result<Vehicle, InputError> {
        read::read(text, origin.as_ref())
    }

    /// Sets a number by its dotted name (`hydro.b`, `mechanisms.leak_kg_per_hour`, `uncertainty.hydro.b`).
    ///
    /// # Errors
    /// Where no such key exists; the message names the nearest one.
    pub fn set(&mut self, path: &str, value: f64) -> Result<(), InputError> {
        let unknown = || read::unknown_key(path, Place::file("vehicle"));
        if let Some(slot) = self.sections.slot(path) {
            *slot = Some(value);
        } else if let Some(name) = path.strip_prefix("mechanisms.") {
            let index = parameter_index(name).filter(|_| mechanisms::is_of_vehicle(name)).ok_or_else(unknown)?;
            self.mechanisms.insert(PARAMETERS[index].name, value);
        } else if let Some(name) = path.strip_prefix("uncertainty.") {
            if !read::is_number_key(name) {
                return Err(unknown());
            }
            self.uncertainty.insert(name.to_owned(), value);
            // A dotted name is one quoted key of that table.
            table(self.document.as_table_mut(), "uncertainty")[name] = toml_edit::value(value);
            return Ok(());
        } else {
            return Err(unknown());
        }
        let (section, name) = path.rsplit_once('.').expect("a dotted path");
        let mut here = self.document.as_table_mut();
        for part in section.split('.') {
            here = table(here, part);
        }
        match here.get_mut(name).and_then(|item| item.as_value_mut()) {
            Some(old) => {
                let decor = old.decor().clone();
                *old = value.into();
                *old.decor_mut() = decor;
            }
            None => here[name] = toml_edit::value(value),
        }
        Ok(())
    }

    /// Takes a number away by its dotted name, with its comment; a table that is empty then goes, too. What is not there
    /// stays away.
    pub fn clear(&mut self, path: &str) {
        if let Some(slot) = self.sections.slot(path) {
            *slot = None;
        }
        let Some((section, name)) = path.rsplit_once('.') else {
            return;
        };
        let mut here = Some(self.document.as_table_mut());
        for part in section.split('.') {
            here = here.and_then(|table| table.get_mut(part)).and_then(toml_edit::Item::as_table_mut);
        }
        let is_empty = here.is_some_and(|table| {
            table.remove(name);
            table.is_empty()
        });
        if let (true, Some((parent, name))) = (is_empty, section.rsplit_once('.'))
            && let Some(parent) = self.document.get_mut(parent).and_then(toml_edit::Item::as_table_mut)
        {
            parent.remove(name);
        }
    }

    /// Sets the name and the source, in the file's text too.
    pub fn describe(&mut self, name: &str, source: &str) {
        self.name = name.to_owned();
        self.source = source.to_owned();
        self.document["name"] = toml_edit::value(name);
        self.document["source"] = toml_edit::value(source);
    }

    /// The text of the vehicle file: what was read, comments and all, with what was set since.
    pub fn to_toml(&self) -> String {
        self.document.to_string()
    }

    /// A number by its dotted name, its default where the file leaves it out.
    pub fn get(&self, path: &str) -> Option<f64> {
        if let Some(name) = path.strip_prefix("mechanisms.") {
            return self.mechanisms.get(name).copied();
        }
        let mut sections = self.sections;
        let given = *sections.slot(path)?;
        given.or_else(|| match keys::key(path)?.need {
            keys::Need::Default(value) => Some(value),
            _ => None,
        })
    }
}

/// The table of this name inside another, made where it is missing.
fn table<'a>(parent: &'a mut toml_edit::Table, name: &str) -> &'a mut toml_edit::Table {
    let item = parent.entry(name).or_insert_with(toml_edit::table);
    if !item.is_table() {
        // A table written inline is as good as one with a heading; make it one.
        let inline = std::mem::take(item);
        *item = toml_edit::Item::Table(inline.into_table().unwrap_or_default());
    }
    item.as_table_mut().expect("just made a table")
}

#[cfg(test)]
mod tests;
