//! The targets, one file for what belongs together. Those of a folder are built only with the feature of its name: what stands
//! behind the commands, and what reads logs, takes long to build.

mod archive;
#[cfg(feature = "commands")]
mod commands;
mod fmu_calls;
mod fmu_state;
#[cfg(feature = "logs")]
mod logs;
mod vehicle;
mod vehicle_fmu;

use crate::Target;

/// Targets of vehicles and of the FMU.
const VEHICLES: &[Target] =
    &[vehicle::VEHICLE, archive::ARCHIVE, vehicle_fmu::RESOURCES, fmu_state::STATE, fmu_calls::CALLS];

#[cfg(feature = "logs")]
const LOGS: &[Target] = logs::TARGETS;
#[cfg(not(feature = "logs"))]
const LOGS: &[Target] = &[];

#[cfg(feature = "commands")]
const COMMANDS: &[Target] = commands::TARGETS;
#[cfg(not(feature = "commands"))]
const COMMANDS: &[Target] = &[];

/// Every target that this build has.
pub fn targets() -> impl Iterator<Item = &'static Target> {
    LOGS.iter().chain(VEHICLES).chain(COMMANDS)
}

/// The target of this name.
pub fn target(name: &str) -> Option<&'static Target> {
    targets().find(|target| target.name == name)
}
