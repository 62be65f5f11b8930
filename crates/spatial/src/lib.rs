//! The glider in six degrees of freedom (Graver 2005; Zhang, Yu, Zhang, Zhang 2013): it rolls, slips and turns.
//!
//! - [`Lateral`]: the numbers that the vertical plane does not need, in one table; [`Body`] joins them to those that it does.
//! - [`State`], [`Inputs`]: what changes.
//! - [`derivative`]: the right-hand side, generic over the number; [`outputs`]: what follows from a state.
//! - [`turn`]: steady turns, all that are found, with eigenvalues.
//! - [`Steering`]: heading control by rudder or roll mass.
//! - [`SpatialGlider`], [`fly`]: the same equations carried through time.
//!
//! Coefficients of lift, drag and pitching moment, net mass, mechanisms, servos and contact with surface and seabed are
//! those of the vertical plane and are asked of `dynamics`; in the plane both sets of equations give the same
//! accelerations. Body axes x forward, y starboard, z down; roll + starboard down, pitch + nose up, heading + clockwise
//! from north; sideslip `beta = asin(v2 / V)`. Knows no files.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

mod equations;
mod fly;
mod forces;
pub mod glider;
mod inertia;
mod lateral;
mod outputs;
mod servos;
mod state;
pub mod steering;
pub mod turn;
mod vector;

pub use equations::derivative;
pub use fly::fly;
pub use glider::SpatialGlider;
pub use lateral::{Body, LATERAL, Lateral, N_LATERAL, RateLaw};
pub use outputs::{Outputs, outputs};
pub use servos::{next_bend_s, servo_corners};
pub use state::{INPUTS, Inputs, N_INPUTS, N_STATES, STATES, State};
pub use steering::Steering;
