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

pub mod assemble;
#[cfg(feature = "cli")]
pub mod cli;
pub mod coefficients;
#[cfg(feature = "diagnosis")]
pub mod diagnose;
pub mod dynamics;
pub mod estimate;
#[cfg(feature = "report")]
pub mod fmu_archive;
pub mod fmu_page;
pub mod fmu_token;
pub mod glide;
pub mod hull_tests;
#[cfg(feature = "sea")]
pub mod identify;
pub mod input;
#[cfg(feature = "sea")]
pub mod log;
pub mod mechanisms;
#[cfg(any(feature = "diagnosis", feature = "sea"))]
pub mod noise;
pub mod number;
#[cfg(feature = "report")]
pub mod output;
pub mod plan;
#[cfg(feature = "report")]
pub mod report;
pub mod simulate;
pub mod track;
pub mod vehicle;
pub mod water;

pub use number::Number;
