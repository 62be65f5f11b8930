//! From balance readings to coefficients: the reduction of hull tests in a towing tank, and a virtual tank to try it on.
//!
//! [`reduce_points`] takes a table of steady points, giving [`Results`], from
//! which `fits.json`, tables, figures and the page follow. Signs and reference values are those of
//! [`glidepolar::coefficients`]. The [virtual tank](virtual_tank) shares nothing with the reduction.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C")]

pub mod adequacy;
pub mod checks;
pub mod fits;
pub mod hull;
pub mod output;
pub mod points;
mod reduce;
pub mod regression;
pub mod results;
pub mod sweep;
mod table;
mod toml_file;
pub mod virtual_tank;
pub mod water;

pub use reduce::reduce_points;
pub use results::{HullResults, Results};
