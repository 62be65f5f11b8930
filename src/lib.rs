//! glidepolar takes an underwater glider from the towing tank to the sea and back.
//!
//! Data flow one way through this library: balance readings become [coefficients], coefficients and masses make a
//! [vehicle], a vehicle gives the [equations of motion](dynamics) their parameters, and the equations give
//! [steady glides](glide) and time histories.
//!
//! # Axes and signs
//! Body axes after SNAME: 1 (x) forward, 2 (y) starboard, 3 (z) down; pitch positive nose-up. The inertial vertical
//! points down, so depth is positive. Angle of attack `alpha = atan2(v3, v1)`, glide path angle `xi = pitch - alpha`
//! (negative when descending). Net mass is positive when the glider is heavy; ballast volume is positive when it makes
//! the glider more buoyant. Units stand in every name: `pitch_rad`, `vbd_cc`, `density_kg_m3`.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

pub mod cli;
pub mod diagnose;
pub mod fmu_archive;
pub mod identify;
pub mod plan;
pub mod reading;
pub mod simulate;
pub mod track;

pub use glidepolar_dynamics as dynamics;
pub use glidepolar_dynamics::{glide, mechanisms};
pub use glidepolar_environment as water;
pub use glidepolar_flightlog as log;
pub use glidepolar_fmu_resources::{page as fmu_page, token as fmu_token};
pub use glidepolar_hull::{assemble, coefficients, hull_tests};
pub use glidepolar_inference::{estimate, noise};
pub use glidepolar_input as input;
pub use glidepolar_number as number;
pub use glidepolar_number::Number;
pub use glidepolar_report as report;
pub use glidepolar_report::output;
pub use glidepolar_spatial as spatial;
pub use glidepolar_turning as turning;
pub use glidepolar_vehicle as vehicle;
