//! The inverse process: coefficients, trim and other parameters of the model from what a glider recorded.
//!
//! - [`identify()`]: the whole identification of one log, with what it cannot tell.
//! - [`joint`]: any parameters from all dives at once, exact slopes, standard errors by dives.
//! - [`inertia()`]: what the inertia of a nearly steady glide adds to its balance; [`Parts`]: what happens inside a bin.
//! - [`unsteady`]: the same on dives flown through time, turns and all.
//! - [`consider_parameters`]: the errors of what was held, carried to what was fitted.
//! - [`pitch_balance`]: d and the height of the centre of gravity from battery, ballast and pitch.
//! - [`evaluate()`], [`Gram`]: residuals over all dives in bounded memory.
//!
//! Works on [`Observation`](crate::log::Observation)s and [`Parameters`](crate::dynamics::Parameters); knows no files.

mod bins;
mod blocks;
pub mod campaign;
pub mod consider_parameters;
pub mod considered;
mod constant_pitch;
mod data;
mod evaluate;
pub mod external_values;
mod form;
mod given;
pub mod holdout;
pub mod identifiability;
mod inertia;
pub mod inflections;
pub mod joint;
mod misfit;
pub mod model;
pub mod names;
pub mod paper;
pub mod paper_form;
pub mod pitch_balance;
pub mod polar_points;
mod quasi_steady;
mod residuals;
mod specification_test;
mod speeds;
mod trim;
pub mod unknown_shear;
pub mod unsteady;
mod within_bin;

pub use bins::{Bin, bins};
pub use campaign::{Identification, Request, identify};
pub use considered::{Considered, Propagated};
pub use data::{Dive, by_dive, ranges};
pub use evaluate::{MOST_FREE, Scatter, Tally, Weights, evaluate};
pub use external_values::{ExternalValue, Pin};
pub use form::{CorrelationTable, FitQuality, IdentifyReport};
pub use given::Given;
pub use glidepolar_inference::gram::Gram;
pub use inertia::{inertia, median_step_s};
pub use inflections::Unsteady;
pub use joint::{IdentifyError, JointFit, Question, fit};
pub(crate) use model::surroundings;
pub use model::{Inertia, Prediction, predict};
pub use residuals::{Residual, Score, ScoreSums, residuals};
pub use speeds::Rows;
pub use trim::Trim;
pub use within_bin::{Inside, Parts};
pub(crate) use within_bin::{felt_density_kg_m3, make_heavier, turns_by_rad};

#[cfg(test)]
pub(crate) mod tests;
