//! The functions of FMI 2.0.4, all 44, as its headers declare them.
//!
//! Translates C arguments into calls of [`crate::instance`] and statuses back. Knows nothing of the model.
//!
//! # Safety
//! Every function trusts its caller in what C cannot check: a component pointer is null or was returned by
//! `fmi2Instantiate` and not freed, an array has as many elements as its count says, a text ends with a zero. Anything
//! else that a caller may get wrong ends in a status and a message.

#![allow(clippy::missing_safety_doc, reason = "the safety of all of them is the module's")]

mod common;
mod cosimulation;
mod exchange;
mod lifecycle;
mod states;
mod types;

pub use common::*;
pub use cosimulation::*;
pub use exchange::*;
pub use lifecycle::*;
pub use states::*;
pub use types::*;
