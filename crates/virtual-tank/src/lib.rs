//! The virtual tank: writes a synthetic campaign of the five "Phoenix" hulls, with stated truth, in the format that a
//! real campaign has. For demonstration and for tests; never a result.
//!
//! It acts out the experiment forward: the mechanism moves the model through the water, the water and the model's
//! inertia load the balance, the balance shows readings. It knows nothing of how readings are reduced and shares no
//! formula, constant or line with the reduction; its water, its hulls, its frames are its own.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

mod balance;
mod campaign;
mod catalogue;
mod decimal;
mod digest;
mod effects;
mod entry;
mod faults;
mod folder;
mod hull;
mod motion;
mod noise;
mod outline;
mod paperwork;
mod planned_run;
mod programme;
mod random;
mod request;
mod simulate;
mod truth;
mod water;
mod world;

use std::io;
use std::path::{Path, PathBuf};

pub use balance::{DayZero, Strut};
pub use campaign::{write_campaign, write_campaign_watched};
pub use catalogue::{CATALOGUE, catalogue_text};
pub use effects::{EffectRequest, HiddenEffect};
pub use entry::Entry;
pub use hull::{DynamicDerivatives, LiveMass, StaticCoefficients};
pub use motion::Kind;
pub use noise::NoiseLevels;
pub use outline::{DIAMETER_M, PHOENIX, TableRow};
pub use truth::{BalanceTruth, HullTruth, RunTruth, SCHEMA, Trend, Truth};
pub use water::Water;
pub use world::Variety;

/// What to write.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// The same seed gives the same files, byte for byte, on any number of threads.
    pub seed: u64,
    /// What to hide; see [`CATALOGUE`].
    pub effects: Vec<EffectRequest>,
    /// Ids of the hulls to test; those of the tank when empty: all five, or some of them where it is drawn.
    pub hulls: Vec<String>,
    /// Scale of everything random within and between runs: 1 a good tank, 0 none. Zeros, their even drift, interaction
    /// and strut stay.
    pub noise: f64,
    /// Whether only the strut and the steady drift of each hull are towed, without oscillations and turns.
    pub statics_only: bool,
    /// The same tank for every seed, or another for each.
    pub variety: Variety,
    /// Whether an earlier virtual campaign is replaced even where its files were edited.
    pub force: bool,
    /// Total size to aim at, 10^6 bytes, by more passes and finer sampling; a default campaign when absent.
    pub size_mb: Option<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            seed: 1,
            effects: Vec::new(),
            hulls: Vec::new(),
            noise: 1.0,
            statics_only: false,
            variety: Variety::Phoenix,
            force: false,
            size_mb: None,
        }
    }
}

/// How far the writing has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Runs written.
    pub runs_done: usize,
    /// Runs in all.
    pub runs: usize,
}

/// Why no campaign was written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum Error {
    #[error("unknown effect {name}{nearest}; known are none, {known}")]
    UnknownEffect { name: String, nearest: String, known: String },
    #[error("effect {name}: found {found} for its size, expected {expected}")]
    EffectSize { name: String, found: String, expected: String },
    #[error("effect {name} is asked for twice; give each effect once")]
    EffectTwice { name: String },
    #[error("unknown hull {id}; the tank has {known}")]
    UnknownHull { id: String, known: String },
    #[error("noise: found {found}, expected a number from 0 (none) to 100 (1 is a good tank)")]
    Noise { found: f64 },
    #[error("size: found {found_mb} MB, expected {least_mb:.1} to 100000 MB; for less give fewer hulls")]
    Size { found_mb: f64, least_mb: f64 },
    #[error("{}: not overwritten, since {found}; give a new folder, or an earlier virtual campaign to replace", path.display())]
    FolderInUse { path: PathBuf, found: String },
    #[error("{}: cannot {doing}: {source}", path.display())]
    Io { path: PathBuf, doing: &'static str, source: io::Error },
}

fn io_error(path: &Path, doing: &'static str, source: io::Error) -> Error {
    Error::Io { path: path.to_owned(), doing, source }
}
