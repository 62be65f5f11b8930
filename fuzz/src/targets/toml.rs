//! What a person writes by hand: vehicle files and mission files.

use std::path::Path;

use glidepolar::glide::start;
use glidepolar::simulate::mission::{Mission, fly_mission};
use glidepolar::vehicle::{Vehicle, builtin};

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

pub const MISSION: Target = Target {
    name: "mission",
    what: "a mission file, and the first minutes of the mission",
    run: mission,
    seeds: || MISSIONS.map(|text| text.as_bytes().to_vec()).to_vec(),
    catches_panics: false,
};

const MISSIONS: [&str; 2] =
    [include_str!("../../../missions/rising-seabed.toml"), include_str!("../../../missions/voyage-215.toml")];

/// Moments of a mission after which enough of it was seen.
const MOMENTS: usize = 5;

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

fn mission(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let Ok(mission) = Mission::parse(text, Path::new("mission.toml")) else { return };
    mission.turning_depth_m(100.0);
    let glider = builtin::text("slocum-049").expect("a built-in vehicle");
    let glider = Vehicle::parse(glider, "slocum-049").expect("a built-in vehicle");
    let parameters = glider.parameters().expect("a whole vehicle");
    let mut moments = 0;
    let _ = fly_mission(&parameters, &mission, 60.0, 1e-4, |_| {
        moments += 1;
        moments < MOMENTS
    });
}
