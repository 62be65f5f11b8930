//! The FMU.
