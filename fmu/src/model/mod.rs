//! The glider as a set of variables: what can be read, what can be set, and how the ones follow from the others.
//!
//! - [`Model`]: which models there are, in the plane and in space.
//! - [`table`]: the table of variables of each.
//! - [`Glider`]: their values, and the equations behind them.
//! - [`flight`]: the same carried through a communication step.
//! - [`tangent`]: how the calculated ones change with the others, exactly.
//! - [`vehicle`]: what an instance starts from.
//!
//! Knows nothing of a standard's functions, of instances or of their states.

pub mod flight;
pub mod glider;
mod plane;
mod references;
pub mod rules;
mod sizes;
pub mod space;
pub mod table;
pub mod tangent;
pub mod units;
pub mod values;
pub mod vehicle;
pub mod which;

pub use glider::{Glider, Reading};
pub use table::{Causality, Discrete, Initial, Kind, Slot, Table, Variability, Variable, variable, variables};
pub use which::Model;
