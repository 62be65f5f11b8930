//! Vehicle files, as a person writes them by hand.

use glidepolar_dynamics::glide::start;
use glidepolar_vehicle::{Vehicle, builtin};

use crate::Target;

pub const VEHICLE: Target = Target {
    name: "vehicle",
    what: "a vehicle file",
    run: vehicle,
    seeds: || {
        builtin::NAMES.iter().filter_map(|name| builtin::text(name)).map(|text| text.as_bytes().to_vec()).collect()
    },
    catches_panics: false,
};

fn vehicle(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let Ok(vehicle) = Vehicle::parse(text, "vehicle.toml") else { return };
    let again = Vehicle::parse(&vehicle.to_toml(), "vehicle.toml").expect("what was written can be read");
    assert_eq!(again.to_toml(), vehicle.to_toml());
    vehicle.glide_parameters();
    if let Ok(parameters) = vehicle.parameters() {
        start(&parameters);
    }
}
