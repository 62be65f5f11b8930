//! The targets, one file for what belongs together. Those of [`commands`] need the programs, the others the readers alone.

mod archive;
#[cfg(feature = "commands")]
mod commands;
mod fmu_calls;
mod fmu_state;
mod glider_files;
mod log;
mod table;
mod vehicle;
mod vehicle_fmu;

use crate::Target;

/// Targets of what reads files, and of the FMU.
const READERS: &[Target] = &[
    log::CSV,
    log::NETCDF,
    glider_files::SLOCUM,
    glider_files::SEAEXPLORER,
    table::TABLE,
    vehicle::VEHICLE,
    archive::ARCHIVE,
    vehicle_fmu::RESOURCES,
    fmu_state::STATE,
    fmu_calls::CALLS,
];

#[cfg(feature = "commands")]
const COMMANDS: &[Target] = commands::TARGETS;
#[cfg(not(feature = "commands"))]
const COMMANDS: &[Target] = &[];

/// Every target that this build has.
pub fn targets() -> impl Iterator<Item = &'static Target> {
    READERS.iter().chain(COMMANDS)
}

/// The target of this name.
pub fn target(name: &str) -> Option<&'static Target> {
    targets().find(|target| target.name == name)
}
