//! The hull-test reduction.

pub mod virtual_tank;
