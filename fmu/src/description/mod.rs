//! What an importer and a person read before a simulation runs: the model descriptions of both standards and the
//! documentation in the archive, all written from the table of variables.

mod fmi2;
mod fmi3;
mod page;
pub mod structure;
mod terminals;
mod xml;

use std::path::PathBuf;

use glidepolar_dynamics::integrate::DEFAULT_TOLERANCE;

use crate::model::glider::Glider;
use crate::model::vehicle::Vehicle;
use crate::model::{Kind, Variable};

/// Name of the model, and of the binary in the archive.
pub const MODEL_NAME: &str = "UnderwaterGlider";

/// What the model is, in a line.
pub const MODEL_DESCRIPTION: &str = "Underwater glider in the vertical plane: buoyancy engine, moving mass, glide polar from hull tests, and the mechanisms by which gliders at sea depart from them";

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
    let vehicle = Vehicle::default();
    vec![
        ("fmi2/modelDescription.xml".into(), fmi2::model_description(&vehicle)),
        ("fmi3/modelDescription.xml".into(), fmi3::model_description(&vehicle)),
        ("fmi3/terminalsAndIcons/terminalsAndIcons.xml".into(), terminals::terminals_and_icons()),
        ("documentation/index.html".into(), page::documentation(&vehicle)),
    ]
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
