//! The archive of an FMU that a vehicle is packed into.

use glidepolar::fmu_archive::pack;
use glidepolar::vehicle::{Vehicle, builtin};
use glidepolar_archive::Archive;

use crate::Target;
use crate::files::{joined, parts};

pub const TEMPLATE: Target = Target {
    name: "fmu_template",
    what: "the model description and the page of an archive that a vehicle is packed into",
    run: template,
    seeds: templates,
    catches_panics: false,
};

const DESCRIPTION: &str = include_str!("../../../../modelDescription/fmi3/modelDescription.xml");

fn template(data: &[u8]) {
    let mut archive = Archive::new();
    for (name, part) in ["modelDescription.xml", "documentation/index.html"].into_iter().zip(parts(data)) {
        archive.insert(name, part).expect("a plain name");
    }
    let text = builtin::text("slocum-049").expect("a built-in vehicle");
    let vehicle = Vehicle::parse(text, "slocum-049").expect("a built-in vehicle");
    match pack(&archive, &vehicle, None) {
        Err(error) => drop(error.to_string()),
        Ok(packed) => assert!(packed.get("resources/vehicle.toml").is_some()),
    }
}

fn templates() -> Vec<Vec<u8>> {
    let page = include_str!("../../../../modelDescription/documentation/index.html");
    vec![joined(&[DESCRIPTION, page])]
}
