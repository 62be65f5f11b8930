//! The hull-test reduction.
