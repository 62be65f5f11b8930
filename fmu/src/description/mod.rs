//! What an importer and a person read before a simulation runs: the model descriptions of both standards and the
//! documentation in the archive, all written from the table of variables.

mod document;
mod fmi2;
mod fmi3;
mod page;
pub mod structure;
mod terminals;
mod xml;

use std::path::PathBuf;

use glidepolar_dynamics::integrate::DEFAULT_TOLERANCE;

use crate::model::glider::Glider;
use crate::model::units::{UNITS, Unit};
use crate::model::vehicle::Vehicle;
use crate::model::{Kind, Model, Table, Variable};

/// Who made the model.
pub const AUTHOR: &str = "The glidepolar developers";

/// Whose it is.
pub const COPYRIGHT: &str = "Copyright (c) 2026 The glidepolar developers";

/// When the descriptions were last written with other variables. A constant: the same sources give the same archive.
pub const GENERATED: &str = "2026-11-23T00:00:00Z";

/// The experiment when nothing is said: stop time, communication step, tolerance. Importers take the step for their own
/// Euler method, too, which is stable with it up to modes of 20/s: the servo of the moving mass has 4/s, ROGUE 17/s.
pub const DEFAULT_EXPERIMENT: (f64, f64, f64) = (600.0, 0.1, DEFAULT_TOLERANCE);

/// The categories of log messages and what they carry.
pub const LOG_CATEGORIES: [(&str, &str); 4] = [
    ("logEvents", "State events, mode changes and what the instance starts from"),
    ("logStatusWarning", "What works, but perhaps not as meant"),
    ("logStatusDiscard", "Steps that could not be completed"),
    ("logStatusError", "Calls that were refused, with what to do"),
];

/// The files that are generated and checked in, by path below `modelDescription/`, with their content.
pub fn files() -> Vec<(PathBuf, String)> {
    let of_model = |model: Model| {
        let vehicle = Vehicle::built_in(model);
        let folder = match model {
            Model::Plane => PathBuf::new(),
            Model::Space => PathBuf::from("space"),
        };
        [
            ("fmi2/modelDescription.xml", document::model_description::<fmi2::Fmi2>(&vehicle)),
            ("fmi3/modelDescription.xml", document::model_description::<fmi3::Fmi3>(&vehicle)),
            ("fmi3/terminalsAndIcons/terminalsAndIcons.xml", terminals::terminals_and_icons(model)),
            ("documentation/index.html", page::documentation(&vehicle)),
        ]
        .map(|(path, text)| (folder.join(path), text))
    };
    Model::ALL.into_iter().flat_map(of_model).collect()
}

/// The units that variables of this table have.
fn used_units(table: Table) -> impl Iterator<Item = &'static Unit> {
    UNITS
        .iter()
        .filter(move |unit| table.rows.iter().any(|variable| variable.unit.is_some_and(|of| of.name == unit.name)))
}

/// The start value of a variable, as the descriptions write it.
fn start_value(glider: &Glider, name: &str, variable: &Variable) -> Option<String> {
    if !variable.has_start() {
        return None;
    }
    let mut reading = glider.read();
    match variable.kind {
        Kind::Real => reading.real(variable.slot).and_then(xml::number),
        Kind::Integer | Kind::Choice(_) => reading.integer(variable.slot).map(|n| n.to_string()),
        Kind::Boolean => reading.boolean(variable.slot).map(|b| b.to_string()),
        Kind::Text => Some(name.to_owned()),
    }
}
