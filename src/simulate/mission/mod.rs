//! Missions as pilots think of them: how deep, how high above the seabed to turn, when to surface, at which pitch and
//! with how much ballast; and the glider flown through them.
//!
//! A mission file ([`Mission::load`]) holds what a pilot would write into the glider and what the glider will meet:
//! the seabed against distance, the water column, the current. [`fly_mission`] flies it by the same equations as
//! everything else; the glider's own controller is a small state machine (descend, climb, stay at the surface) that
//! sets ballast and moving mass at each turn from the steady pitch balance and then, as real gliders do, corrects the
//! moving mass slowly by the pitch that it reads. Knows no vehicle file and prints nothing.

mod account;
mod controller;
mod course;
mod flight;
mod keys;
mod pilot;
mod profile;
mod read;
mod route;
mod route_account;
mod space_course;
mod spent;

use std::path::Path;

use super::space::Origin;
use crate::input::InputError;
use crate::spatial::Steering;

pub use account::{Ending, Flight, Leg, LegKind, MISSION_COLUMNS, MissionError, Moment, Turn};
pub use flight::fly_mission;
pub use keys::{KEYS, Key};
pub use profile::Profile;
pub use route::fly_route;
pub use route_account::{Account, RouteError, RouteMoment};

/// What a glider is commanded to do, and what it will meet.
#[derive(Debug, Clone, PartialEq)]
pub struct Mission {
    /// What the mission is called.
    pub name: String,
    /// Where its figures come from.
    pub source: String,
    /// The mission ends after this time \[s\].
    pub duration_s: f64,
    /// The mission ends after this way over ground, should it come first \[m\].
    pub distance_m: f64,
    /// Turn up at this depth \[m\].
    pub max_depth_m: f64,
    /// Turn up at this height above the seabed; 0 without an altimeter \[m\].
    pub altimeter_m: f64,
    /// Turn down again at this depth \[m\].
    pub climb_to_m: f64,
    /// The leg down.
    pub descent: LegOrder,
    /// The leg up.
    pub ascent: LegOrder,
    /// When to come up, and for how long.
    pub surfacing: Surfacing,
    /// The slow correction of the pitch.
    pub control: PitchControl,
    /// Depth of the seabed \[m\] against distance over ground \[m\].
    pub seabed: Profile,
    /// In-situ density of the water \[kg/m3\] against depth \[m\]; without it the vehicle's reference density.
    pub density: Option<Profile>,
    /// Temperature of the water \[degC\] against depth \[m\]; without it the vehicle's reference temperature.
    pub temperature: Option<Profile>,
    /// Current along the course \[m/s\] against depth \[m\].
    pub current: Profile,
    /// The tide that comes on top of it, alike at all depths.
    pub tide: Tide,
    /// The way in space, and how the heading is held.
    pub route: Route,
}

/// A way over the earth, for a glider in six degrees of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct Route {
    /// Where it begins.
    pub origin: Origin,
    /// Places to go to one after the other, north and east of the start \[m\].
    pub waypoints_m: Vec<[f64; 2]>,
    /// Distance within which a waypoint counts as reached \[m\].
    pub reached_m: f64,
    /// What steers, where the file says so.
    pub steering: Option<Steering>,
    /// Time between two looks at the heading \[s\].
    pub period_s: f64,
    /// Error of the heading up to which nothing moves \[rad\].
    pub deadband_rad: f64,
    /// Current to the north \[m/s\] against depth \[m\].
    pub current_north: Profile,
    /// Current to the east.
    pub current_east: Profile,
}

/// A tidal current along the course, `along cos(2 pi (t - most_at) / period)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tide {
    /// Its largest velocity \[m/s\].
    pub along_m_s: f64,
    /// Its period \[s\].
    pub period_s: f64,
    /// Time from the start of the mission at which it helps most \[s\].
    pub most_at_s: f64,
}

/// How one leg is flown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LegOrder {
    /// Pitch to hold, nose-up positive \[rad\].
    pub pitch_rad: f64,
    /// Ballast volume, positive = more buoyant \[m3\].
    pub ballast_m3: f64,
}

/// Surfacing for a fix and a call.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surfacing {
    /// Time from the start of the mission until the glider turns up for the surface \[s\]; none: after its first dive.
    pub first_s: Option<f64>,
    /// Time from leaving the surface until it turns up again, later on \[s\]; none: after each dive.
    pub every_s: Option<f64>,
    /// Stay at the surface \[s\].
    pub stay_s: f64,
    /// Ballast volume at the surface \[m3\].
    pub ballast_m3: f64,
    /// Pitch at the surface, which keeps the antenna out of the water \[rad\].
    pub pitch_rad: f64,
}

/// The slow correction of the pitch by the moving mass, an integral controller with a dead band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PitchControl {
    /// Time between two looks at the pitch \[s\].
    pub period_s: f64,
    /// Error of the pitch that is left alone \[rad\].
    pub deadband_rad: f64,
    /// Share of the error that one move is meant to remove; 0 leaves the pitch to the feed-forward.
    pub gain: f64,
}

impl Mission {
    /// Reads a mission file.
    ///
    /// # Errors
    /// Where the file cannot be read, a key is unknown, missing, out of range or of the wrong kind, or two of them
    /// contradict each other; with file, line and column.
    pub fn load(file: &Path) -> Result<Mission, InputError> {
        let text = std::fs::read_to_string(file).map_err(|error| InputError::io(file, &error))?;
        Mission::parse(&text, file)
    }

    /// Reads the text of a mission file; `origin` is what errors name.
    ///
    /// # Errors
    /// As [`Mission::load`].
    pub fn parse(text: &str, origin: &Path) -> Result<Mission, InputError> {
        read::read(text, origin)
    }

    /// Depth at which a descent ends above this place \[m\].
    pub fn turning_depth_m(&self, x_m: f64) -> f64 {
        if self.altimeter_m > 0.0 {
            self.max_depth_m.min(self.seabed.at(x_m) - self.altimeter_m)
        } else {
            self.max_depth_m
        }
    }
}

#[cfg(test)]
mod tests;
