//! Mission files, as a person writes them by hand.

use std::path::Path;

use glidepolar::simulate::mission::{Mission, fly_mission};
use glidepolar::vehicle::{Vehicle, builtin};

use crate::Target;

pub const MISSION: Target = Target {
    name: "mission",
    what: "a mission file, and the first minutes of the mission",
    run: mission,
    seeds: || MISSIONS.map(|text| text.as_bytes().to_vec()).to_vec(),
    catches_panics: false,
};

const MISSIONS: [&str; 2] =
    [include_str!("../../../../missions/rising-seabed.toml"), include_str!("../../../../missions/voyage-215.toml")];

/// Moments of a mission after which enough of it was seen.
const MOMENTS: usize = 5;

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
