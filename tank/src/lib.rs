//! From balance readings to coefficients: the reduction of hull tests in a towing tank, and a virtual tank to try it on.
//!
//! [`reduce_points`] takes a table of steady points, [`reduce_campaign`] a folder of raw runs; both give [`Results`], from
//! which `fits.json`, tables, figures and the page follow. Signs and reference values are those of
//! [`glidepolar_hull::coefficients`]. The [virtual tank](virtual_tank) shares nothing with the reduction.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C")]

pub mod adequacy;
pub mod angle_regression;
pub mod campaign;
pub mod checks;
mod clipping;
pub mod derivatives;
pub mod diagnose;
pub mod fits;
pub mod harmonics;
pub mod history;
pub mod hull;
pub mod hull_results;
pub mod influence;
pub mod motion;
pub mod outlier;
pub mod outline;
pub mod output;
pub mod points;
pub mod readings;
mod reduce;
pub mod results;
mod run_variance;
pub mod series;
pub mod shared;
mod spectrum;
mod spikes;
pub mod statics;
pub mod steady_run;
pub mod sweep;
mod table;
pub mod tare;
pub mod theory;
mod toml_file;
pub mod trend;
pub mod water;
pub mod window;
pub mod zero_drift;
mod zero_noise;
pub mod zeros;

pub use glidepolar_virtual_tank as virtual_tank;
pub use reduce::{Options, Progress, reduce_campaign, reduce_points};
pub use results::{HullResults, Results};
