//! The inverse process: coefficients, trim and other parameters of the model from what a glider recorded.
//!
//! - [`identify()`]: the whole identification of one log, with what it cannot tell.
//! - [`joint`]: any parameters from all samples at once, exact slopes, standard errors by dives.
//! - [`evaluate()`], [`Gram`]: residuals over all dives in bounded memory.
//!
//! Works on [`Observation`](crate::log::Observation)s and [`Parameters`](crate::dynamics::Parameters); knows no files.

pub mod campaign;
mod data;
mod evaluate;
mod gram;
pub mod holdout;
pub mod identifiability;
pub mod joint;
pub mod model;
pub mod paper;
mod quantity;
mod residuals;
mod trim;
pub mod uncertainty;

pub use campaign::{Identification, Report, Request, identify};
pub use data::{Dive, by_dive, ranges};
pub use evaluate::{MOST_FREE, Scatter, Tally, Weights, evaluate};
pub use gram::Gram;
pub use joint::{Fit, IdentifyError, Question, fit};
pub use model::{Prediction, predict};
pub use quantity::{estimate, student_975};
pub use residuals::{Residual, Score, ScoreSums, residuals};
pub use trim::Trim;
