//! The glider as a Functional Mock-up Unit: one shared library with the functions of FMI 2.0 and of FMI 3.0.
//!
//! - [`model`]: the glider as variables with values and equations.
//! - [`instance`]: one simulation of it, whatever standard it is driven through.
//! - `adapter`: what the C functions of both standards do in the same way.
//! - [`fmi2`], [`fmi3`]: the C functions of the standards, which only translate.
//! - [`description`]: the model descriptions and the in-archive documentation, written from the table of variables.

#![allow(
    non_snake_case,
    reason = "units stand in names as they are written: N, Pa, C, J; C functions as in the standards"
)]

mod adapter;
pub mod description;
pub mod fmi2;
pub mod fmi3;
pub mod instance;
pub mod model;
