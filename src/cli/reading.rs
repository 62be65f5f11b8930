//! The options by which the commands read flight logs; the reading itself is in [`crate::reading`]. Knows no command.

use std::path::PathBuf;

use clap::Args;

use super::{CliError, water_density};
use crate::input::{InputError, Place};
use crate::log::{Channel, Columns, Shorten};
use crate::reading::{PreparedLog, Progress, ReadingError, Request, read_watched};
use crate::vehicle::Vehicle;
use glidepolar_progress::step;

/// How logs are read; the same for every command that takes one.
#[derive(Debug, Clone, Args)]
pub struct Reading {
    /// Column that holds the measured speed through the water [m/s]; ad2cp: the near cells of a Seaglider's own AD2CP
    #[arg(long, value_name = "NAME", help_heading = "Log")]
    pub speed_column: Option<String>,
    /// Take a channel from this column (repeat): pitch_rad=pitch_corr_rad
    #[arg(long, value_name = "CHANNEL=COLUMN", help_heading = "Log")]
    pub column: Vec<String>,
    /// State the unit of a channel, whatever the file says (repeat): pitch_rad=rad
    #[arg(long, value_name = "CHANNEL=UNIT", help_heading = "Log")]
    pub unit: Vec<String>,
    /// Folder with the lists of sensors (.cac, .ccc) of a Slocum's binary files [default: beside them]
    #[arg(long, value_name = "DIR", help_heading = "Log")]
    pub cache: Vec<PathBuf>,
    /// In-situ density where the log gives none [kg/m3]
    #[arg(long, value_name = "RHO", help_heading = "Log", allow_negative_numbers = true)]
    pub density: Option<f64>,
    /// Half window of the filter for vertical velocity [s]
    #[arg(long, value_name = "S", default_value_t = 4.0, help_heading = "Log", allow_negative_numbers = true)]
    pub half_window_s: f64,
}

impl Reading {
    /// Reads logs into samples.
    ///
    /// # Errors
    /// What cannot be read, and where nothing is left to use.
    pub fn read(&self, logs: &[PathBuf], vehicle: &Vehicle) -> Result<PreparedLog, CliError> {
        self.read_shortened(logs, vehicle, Shorten::Means)
    }

    /// The same; a log that is too long for the memory is shortened in this way.
    ///
    /// # Errors
    /// The same.
    pub fn read_shortened(&self, logs: &[PathBuf], vehicle: &Vehicle, how: Shorten) -> Result<PreparedLog, CliError> {
        let columns = columns(&self.column, &self.unit, &self.cache, self.speed_column.as_deref())?;
        if !(0.1..=600.0).contains(&self.half_window_s) {
            return Err(CliError::Usage(format!(
                "--half-window-s {} is no window: expected 0.1 to 600 s",
                self.half_window_s
            )));
        }
        let request = Request {
            columns,
            half_window_s: Some(self.half_window_s),
            density_kg_m3: water_density(self.density)?,
            shorten: how,
        };
        Ok(read_watched(logs, vehicle, &request, &said)?)
    }
}

/// Says how far a reading is.
pub(super) fn said(progress: Progress) {
    match progress.files {
        1 => step("rows (reading)", progress.rows, 0),
        files => step("files (reading)", progress.begun, files),
    }
}

impl From<ReadingError> for CliError {
    fn from(error: ReadingError) -> Self {
        match error {
            ReadingError::Input(error) => error.into(),
            ReadingError::Inconsistent { .. } => CliError::Usage(error.to_string()),
        }
    }
}

/// What the user says of the columns of a log.
///
/// # Errors
/// A choice or a unit that is none.
pub fn columns(
    choices: &[String],
    units: &[String],
    caches: &[PathBuf],
    speed: Option<&str>,
) -> Result<Columns, CliError> {
    let mut columns = Columns::default();
    for choice in choices {
        columns.choose_text(choice).map_err(CliError::Usage)?;
    }
    for unit in units {
        columns.unit_text(unit).map_err(CliError::Usage)?;
    }
    for folder in caches {
        if !folder.is_dir() {
            let error = InputError::new(Place::file(folder), "is no folder");
            return Err(error.help("--cache names the folder with the files .cac or .ccc").into());
        }
        columns.cache(folder);
    }
    if let Some(name) = speed {
        columns.choose(Channel::Speed, name);
    }
    Ok(columns)
}

#[cfg(test)]
mod tests;
