//! The equations of motion of an underwater glider in the vertical plane (Leonard and Graver 2001, Graver 2005), with
//! the mechanisms by which real gliders depart from them.
//!
//! - [`Parameters`]: the numbers, in one table.
//! - [`State`], [`Inputs`], [`Modes`]: what changes.
//! - [`equations::derivative`]: the right-hand side, generic over the number.
//! - [`equations::outputs`]: what is looked at.
//! - [`equations::accelerations`]: the right-hand side where the pitch is known, as it is from a log.
//! - [`Glider`] and [`Integrator`]: the same, carried through time.
//!
//! Knows nothing of files, of fits or of the FMI.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

pub mod buoyancy;
pub mod contact;
pub mod empirical;
pub mod energy;
pub mod equations;
pub mod forces;
pub mod glide;
pub mod integrate;
pub mod limits;
pub mod mechanisms;
pub mod parameters;
pub mod servo;
pub mod state;
pub mod steps;
pub mod system;

pub use buoyancy::Surroundings;
pub use energy::{Energy, Usage};
pub use equations::{Outputs, accelerations, derivative, next_bend_s, outputs, servo_corners};
pub use integrate::{Advance, IntegrationError, Integrator};
pub use parameters::{PARAMETERS, Parameters, parameter_index};
pub use state::{Actuation, Inputs, Modes, N_STATES, State, Stop};
pub use system::{Ends, Glider};

#[cfg(test)]
mod tests;
