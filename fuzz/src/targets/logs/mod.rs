//! Ways in through the files of flight logs. Built only with the feature `logs`.

mod glider_files;
mod log;
mod table;

#[cfg(feature = "commands")]
pub use log::logs;

use crate::Target;

/// Every target of these.
pub const TARGETS: &[Target] = &[log::CSV, log::NETCDF, glider_files::SLOCUM, glider_files::SEAEXPLORER, table::TABLE];
