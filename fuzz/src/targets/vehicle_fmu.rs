//! A vehicle and its water that an FMU finds in its archive when it starts.

use std::ffi::CStr;

use glidepolar_fmu::instance::log::Log;
use glidepolar_fmu::instance::phase::Phase;
use glidepolar_fmu::instance::refusal::Outcome;
use glidepolar_fmu::instance::{Abilities, Instance, Interface, resources};
use glidepolar_fmu::model::{Kind, Model, variables};
use glidepolar_vehicle::builtin;

use crate::Target;
use crate::files::{Folder, joined, parts};

pub const RESOURCES: Target = Target {
    name: "fmu_resources",
    what: "what travels in an FMU: vehicle.toml, water_column.csv; and where the importer says that it lies",
    run: resources,
    seeds: resource_files,
    catches_panics: false,
};

const COLUMN: &str = "depth_m,temperature_C,density_kg_m3\n0,18,1024.0\n20,17.5,1024.2\n35,9,1026.4\n500,6,1029.5\n";

fn resources(data: &[u8]) {
    let folder = Folder::new();
    folder.write_parts(data, &[resources::VEHICLE_FILE, resources::COLUMN_FILE]);
    if let Some(uri) = parts(data).nth(2).and_then(|uri| std::str::from_utf8(uri).ok()) {
        let _ = resources::folder_of_uri(uri);
    }
    let Ok(vehicle) = resources::vehicle(Model::Plane, Some(folder.root()), true) else { return };
    let silent = Log::new(Some(Box::new(|_, _: &CStr, _: &CStr| ())), true);
    let mut instance = Instance::new(Interface::CoSimulation, Abilities::default(), &vehicle, silent);
    let _ = fly(&mut instance);
}

/// As an importer would.
fn fly(instance: &mut Instance) -> Outcome {
    instance.set_up(None, 0.0, None)?;
    instance.enter_initialization()?;
    instance.exit_initialization(Phase::Step)?;
    instance.whole_step(0.0, 1.0)?;
    let reals = variables().iter().enumerate().filter(|(_, variable)| variable.kind == Kind::Real);
    let references: Vec<u32> = reals.map(|(place, _)| place as u32).collect();
    instance.get_reals(&references, &mut vec![0.0; references.len()])
}

fn resource_files() -> Vec<Vec<u8>> {
    let uri = "file:///tmp/a%20folder/resources";
    let vehicle = |name: &str| builtin::text(name).unwrap_or_default();
    vec![
        joined(&[vehicle("slocum-graver"), COLUMN, uri]),
        joined(&[vehicle("slocum-049"), COLUMN]),
        joined(&[vehicle("rogue")]),
    ]
}
