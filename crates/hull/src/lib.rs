//! A hull: coefficients from forces, what hull tests hand on, and the vehicle that a hull becomes with its wing, its tail
//! and its sensors.
//!
//! - [`coefficients`]: from forces on a hull to coefficients.
//! - [`hull_tests`]: reduced coefficients and derivatives of a hull as `fits.json` holds them.
//! - [`assemble`]: from a bare hull to a vehicle.
//!
//! Knows no balance, no tank and no log.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

pub mod assemble;
pub mod coefficients;
pub mod hull_tests;
