//! The glider as a set of variables: what can be read, what can be set, and how the ones follow from the others.
//!
//! - [`table`]: the one table of variables.
//! - [`Glider`]: their values, and the equations behind them.
//! - [`tangent`]: how the calculated ones change with the others, exactly.
//! - [`vehicle`]: what an instance starts from.
//!
//! Knows nothing of a standard's functions, of instances or of their states.

pub mod glider;
pub mod table;
pub mod tangent;
pub mod units;
pub mod vehicle;

pub use glider::{Glider, Reading};
pub use table::{Causality, Discrete, Initial, Kind, Slot, Variability, Variable, variable, variables};
