//! The virtual tank from outside: its files against formulas written down here, by hand, from its stated truth.

mod closed_forms;
mod effects;
mod files;
mod folder;
mod support;
