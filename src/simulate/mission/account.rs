//! What a flown mission leaves behind: moments, legs, why each ended, and what the whole of it cost. Data alone.

use crate::dynamics::{Energy, IntegrationError};
use crate::glide::GlideError;
use crate::simulate::Row;

/// The names of what a [`Moment`] adds to a row.
pub const MISSION_COLUMNS: [&str; 7] = [
    "ballast_m3",
    "water_density_kg_m3",
    "water_temperature_C",
    "current_x_m_s",
    "seabed_depth_m",
    "pitch_read_rad",
    "pressure_read_dbar",
];

/// One moment of a mission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// As in every time history.
    pub row: Row,
    /// What is read and what is around, in the order of [`MISSION_COLUMNS`].
    pub around: [f64; MISSION_COLUMNS.len()],
    /// What the glider is doing.
    pub leg: LegKind,
}

/// What a glider can be doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LegKind {
    /// On its way down.
    Descent,
    /// On its way up.
    Ascent,
    /// At the surface, for a fix and a call.
    Surface,
}

/// Why a leg ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Turn {
    /// At the largest depth.
    MaxDepth,
    /// At the altimeter's height above the seabed.
    Altimeter,
    /// At the depth of turning down again.
    ClimbTo,
    /// It was time to come up.
    SurfacingDue,
    /// At the surface.
    Surfaced,
    /// The stay at the surface was over.
    StayOver,
    /// The mission was over.
    MissionEnd,
}

/// One leg.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Leg {
    /// Descent, ascent or surface.
    pub kind: LegKind,
    /// Time of its beginning \[s\].
    pub start_s: f64,
    /// Time of its end \[s\].
    pub end_s: f64,
    /// Depth at which it began, the glider still moving as on the leg before \[m\].
    pub start_depth_m: f64,
    /// Depth at which it ended \[m\].
    pub end_depth_m: f64,
    /// Way over ground at its beginning \[m\].
    pub start_x_m: f64,
    /// Way over ground at its end \[m\].
    pub end_x_m: f64,
    /// Deepest (before an ascent) or shallowest (before a descent) depth that was reached after the turn; none
    /// where the leg ended before.
    pub inflection_depth_m: Option<f64>,
    /// Depth of the seabed at its end \[m\].
    pub seabed_depth_m: f64,
    /// Why it ended.
    pub ended_by: Turn,
}

/// How the mission ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// Its time was up.
    Duration,
    /// The way was done.
    Distance,
    /// The water became too shallow to dive.
    TooShallow,
    /// Whoever looked on had seen enough.
    Stopped,
}

/// A mission that was flown.
#[derive(Debug, Clone, PartialEq)]
pub struct Flight {
    /// Why it ended.
    pub ending: Ending,
    /// Time \[s\].
    pub duration_s: f64,
    /// Way over ground \[m\].
    pub distance_m: f64,
    /// Leg by leg.
    pub legs: Vec<Leg>,
    /// Times the buoyancy engine pumped out.
    pub pumpings: u64,
    /// Moves of the moving mass, those at the turns included.
    pub pitch_moves: u64,
    /// Times the glider touched the seabed.
    pub groundings: u64,
    /// Energy, by what took it.
    pub energy: Energy<f64>,
}

/// Why a mission could not be flown.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MissionError {
    /// Ballast and pitch do not belong to any glide.
    #[error(
        "the {leg} cannot be flown at {depth_m:.0} m: with {ballast_cc:.0} cc of ballast the net mass there is {net_mass_kg:.4} kg, and {error}; change the ballast or the pitch of the mission, or the trim of the vehicle"
    )]
    NoGlide {
        /// Descent or ascent.
        leg: &'static str,
        /// Where \[m\].
        depth_m: f64,
        /// Ballast volume of that leg \[cm3\].
        ballast_cc: f64,
        /// Net mass there \[kg\].
        net_mass_kg: f64,
        /// What the glide says.
        error: GlideError,
    },
    /// The equations gave no finite rate of change.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
}
