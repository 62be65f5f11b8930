//! Bodies that the tests share.
#![allow(dead_code, reason = "each test takes what it needs")]

use glidepolar_spatial::Body;
use glidepolar_vehicle::Vehicle;

/// The built-in vehicle of Zhang et al. 2013.
pub fn seawing() -> Body<f64> {
    builtin("seawing")
}

/// A built-in vehicle.
pub fn builtin(name: &str) -> Body<f64> {
    Vehicle::load(name).unwrap_or_else(|error| panic!("{error}")).body().unwrap_or_else(|error| panic!("{error}"))
}
