//! Results of a mission in space: time history, totals and errors.

use std::fmt;

use glidepolar_ode::IntegrationError;

use super::account::{Ending, LegKind, MissionError};
use crate::simulate::space::Row;

/// One moment of a mission in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RouteMoment {
    /// As in every time history in space.
    pub row: Row,
    /// What the glider is doing.
    pub leg: LegKind,
    /// Ballast volume that an instrument reads \[m3\].
    pub ballast_m3: f64,
    /// Density of the water \[kg/m3\].
    pub density_kg_m3: f64,
    /// Its temperature \[degC\].
    pub temperature_C: f64,
    /// Pitch as the instrument reads it \[rad\].
    pub pitch_read_rad: f64,
    /// Pressure as the instrument reads it \[dbar\].
    pub pressure_read_dbar: f64,
}

/// What a mission in space came to.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Account {
    /// Why it ended.
    pub ended_by: Ending,
    /// Time \[s\].
    pub duration_s: f64,
    /// Way over ground, summed from moment to moment of control \[m\].
    pub distance_m: f64,
    /// Waypoints that were reached.
    pub waypoints_reached: usize,
    /// Waypoints that there are.
    pub waypoints: usize,
    /// Descents.
    pub dives: u64,
    /// Stays at the surface.
    pub surfacings: u64,
    /// Times the buoyancy engine pumped out.
    pub pumpings: u64,
    /// Moves of the moving mass.
    pub pitch_moves: u64,
    /// Moves of rudder or roll mass.
    pub steering_moves: u64,
    /// Times the glider touched the seabed.
    pub groundings: u64,
    /// Energy of the pump \[J\].
    pub pump_J: f64,
    /// Energy of rudder, roll mass and moving mass \[J\].
    pub steering_J: f64,
    /// Energy of the surfacings \[J\].
    pub surfacing_J: f64,
    /// Energy of everything that runs all the time \[J\].
    pub hotel_J: f64,
}

/// Why a mission could not be flown in space.
#[derive(Debug, Clone, PartialEq)]
pub enum RouteError {
    /// A leg cannot be flown, or the equations cannot be followed.
    Mission(MissionError),
    /// There are waypoints and nothing that steers.
    NothingSteers(&'static str),
}

impl fmt::Display for RouteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RouteError::Mission(error) => error.fmt(f),
            RouteError::NothingSteers(what) => write!(
                f,
                "the mission has waypoints, but the vehicle does not turn by its {what}: add [rudder] or [roll_mass] to its file, or choose the other by steering.actuator"
            ),
        }
    }
}

impl std::error::Error for RouteError {}

impl From<MissionError> for RouteError {
    fn from(error: MissionError) -> Self {
        RouteError::Mission(error)
    }
}

impl From<IntegrationError> for RouteError {
    fn from(error: IntegrationError) -> Self {
        RouteError::Mission(error.into())
    }
}
