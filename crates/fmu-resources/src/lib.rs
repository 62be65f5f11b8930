//! What the FMU's library and the program that packs a vehicle into an FMU have in common, so that neither needs the other.
//!
//! - [`token`]: the mark of the vehicle and water that travel in the archive.
//! - [`page`]: the figures of the page in the archive that depend on the vehicle.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

pub mod page;
pub mod token;
