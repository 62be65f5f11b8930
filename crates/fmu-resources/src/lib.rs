//! What the FMU's library and the program that packs a vehicle into an FMU have in common, so that neither needs the other.
//!
//! - [`token`]: the mark of the vehicle and water that travel in the archive.
//! - [`page`]: the figures of the page in the archive that depend on the vehicle.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

pub mod page;
pub mod token;

/// Parameters that an instance takes from its vehicle file alone: without effect on motion or outputs (a log's matter), or
/// the damping law and the coupling of one published vehicle.
pub const NOT_PUBLISHED: &[&str] = &[
    "pressure_lag_s",
    "salinity_drift_per_day",
    "thermal_lag_s",
    "clock_offset_s",
    "pressure_hysteresis",
    "speed_scale",
    "pitch_damping_V2_kg_s",
    "added_Z_qdot_kg_m",
];
