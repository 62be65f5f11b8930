//! The inverse process.
