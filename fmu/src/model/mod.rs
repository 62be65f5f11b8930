//! The glider as a set of variables: what can be read, what can be set, and how the ones follow from the others.
//!
//! - [`Model`]: which models there are, in the plane and in space.
//! - [`table`]: the table of variables of each; [`Variable`] is what a row is.
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
mod variable;
pub mod vehicle;
pub mod which;

pub use glider::{Glider, Reading};
pub use table::{variable, variables};
pub use variable::{Causality, Choice, Discrete, Initial, Kind, Slot, Table, Variability, Variable};
pub use which::Model;
