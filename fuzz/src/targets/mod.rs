//! The targets, one file for what belongs together.

mod archive;
mod fmu_calls;
mod fmu_state;
mod glider_files;
mod log;
mod pilot;
mod table;
mod tank;
mod toml;
mod vehicle_fmu;

use crate::Target;

/// Every target.
pub const TARGETS: &[Target] = &[
    tank::CAMPAIGN,
    tank::POINTS,
    tank::REDUCTION,
    log::CSV,
    log::NETCDF,
    glider_files::SLOCUM,
    glider_files::SEAEXPLORER,
    log::IDENTIFY,
    pilot::TRACK,
    pilot::CALIBRATION,
    pilot::INPUTS,
    pilot::SWEEP,
    table::TABLE,
    toml::VEHICLE,
    toml::MISSION,
    archive::ARCHIVE,
    vehicle_fmu::TEMPLATE,
    vehicle_fmu::RESOURCES,
    fmu_state::STATE,
    fmu_calls::CALLS,
];

/// The target of this name.
pub fn target(name: &str) -> Option<&'static Target> {
    TARGETS.iter().find(|target| target.name == name)
}
