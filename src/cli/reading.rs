//! How the commands read flight logs: the options, the way from files to samples, and the log held against itself, so that
//! every command refuses the same logs in the same words.
//!
//! Knows no command.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{CliError, water_density};
use crate::diagnose::sea::SeaError;
use crate::diagnose::sea::consistency;
use crate::diagnose::{Check, Checked};
use crate::input::{InputError, Place};
use crate::log::{
    CHANNELS, Channel, Columns, Condenser, FlightLog, LogFiles, MOST_OBSERVATIONS, Observation, Piece, Preparation,
    Settings, Shorten, take_out_lost_speeds,
};
use crate::vehicle::Vehicle;

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

/// Samples of a log, and how they were come by.
pub struct Log {
    /// Samples in the order of time.
    pub observations: Vec<Observation>,
    /// How the vertical velocity was measured.
    pub w_filter: String,
    /// What was found in the log and done about it.
    pub notes: Vec<String>,
    /// Files that were left out.
    pub of_files: Vec<String>,
}

impl Log {
    /// Holds the log against itself: what is wrong and does no more than shift the results comes back as warnings.
    ///
    /// # Errors
    /// Where the log contradicts itself so that nothing follows from it, in the words of `diagnose`.
    pub fn warnings(&self, vehicle: &Vehicle) -> Result<Vec<String>, CliError> {
        let bias_kg_m3 = vehicle.glide_parameters().density_bias_kg_m3;
        let (checks, _) = consistency::checks(&self.observations, bias_kg_m3);
        if checks.iter().any(|check| check.outcome == Checked::Wrong) {
            return Err(refused(checks, &self.notes));
        }
        // Only `diagnose` mends: a glide polar that followed from another density than the log's would not be the log's.
        let found = checks.iter().filter(|check| check.outcome == Checked::Mended);
        let warning = |check: &Check| {
            format!(
                "{}: {}; it is used as it was read: run `glidepolar diagnose`, which says what that changes",
                check.check, check.says
            )
        };
        Ok(self.of_files.iter().cloned().chain(found.map(warning)).collect())
    }
}

/// Samples of a CSV file that are read at once.
const PIECE_ROWS: usize = 50_000;

impl Reading {
    /// Reads logs into samples.
    ///
    /// # Errors
    /// What cannot be read, and where nothing is left to use.
    pub fn read(&self, logs: &[PathBuf], vehicle: &Vehicle) -> Result<Log, CliError> {
        self.read_shortened(logs, vehicle, Shorten::Means)
    }

    /// The same; a log that is too long for the memory is shortened in this way.
    ///
    /// # Errors
    /// The same.
    pub fn read_shortened(&self, logs: &[PathBuf], vehicle: &Vehicle, how: Shorten) -> Result<Log, CliError> {
        let columns = columns(&self.column, &self.unit, &self.cache, self.speed_column.as_deref())?;
        if !(0.1..=600.0).contains(&self.half_window_s) {
            return Err(CliError::Usage(format!(
                "--half-window-s {} is no window: expected 0.1 to 600 s",
                self.half_window_s
            )));
        }
        let settings = Settings { half_window_s: self.half_window_s, ..settings(vehicle, self.density)? };
        let mut gathering = Gathering::new(settings, how);
        let mut files = LogFiles::open(logs, &columns)?;
        while let Some(piece) = files.next_piece(PIECE_ROWS)? {
            match piece {
                Piece::Series(piece) => gathering.push(*piece),
                Piece::Glides(mut glides) => {
                    if let Some(density) = self.density {
                        glides
                            .iter_mut()
                            .filter(|g| !g.density_kg_m3.is_finite())
                            .for_each(|g| g.density_kg_m3 = density);
                    }
                    if glides.iter().any(|glide| !glide.density_kg_m3.is_finite()) {
                        let place = Place::file(&logs[0]);
                        let error = InputError::new(place, "no density: expected a column `density_kg_m3`");
                        return Err(error.help("give it with --density").into());
                    }
                    gathering.push_glides(glides);
                }
            }
        }
        let nothing_left = gathering.nothing_left(&logs[0], self.density.is_some());
        let mut log = gathering.finish()?;
        if log.observations.is_empty() {
            return Err(nothing_left.into());
        }
        log.notes.splice(0..0, files.notes().iter().cloned());
        log.of_files = files.warnings().to_vec();
        Ok(log)
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

/// What a log is prepared by that is flown with this vehicle.
///
/// # Errors
/// Where the density, which a user gave for want of one in the log, is none of water.
pub fn settings(vehicle: &Vehicle, density_kg_m3: Option<f64>) -> Result<Settings, CliError> {
    Ok(Settings {
        density_kg_m3: water_density(density_kg_m3)?,
        gravity_m_s2: vehicle.glide_parameters().gravity_m_s2,
        ..Settings::default()
    })
}

/// A log of column names only.
pub fn no_rows(log: &Path) -> InputError {
    InputError::new(Place::file(log), "no row of data below the names of the columns").help("is the file whole?")
}

/// Pieces of a log on their way to samples, in bounded memory.
pub struct Gathering {
    preparation: Preparation,
    condenser: Condenser,
    batch: Vec<Observation>,
    has_tables: bool,
    /// Channels that had a value anywhere.
    recorded: Vec<Channel>,
    rows: usize,
}

impl Gathering {
    /// Begins with nothing.
    pub fn new(settings: Settings, how: Shorten) -> Self {
        Gathering {
            preparation: Preparation::new(settings),
            condenser: Condenser::new(how, MOST_OBSERVATIONS),
            batch: Vec::new(),
            has_tables: false,
            recorded: Vec::new(),
            rows: 0,
        }
    }

    /// Takes the next piece of a time series.
    pub fn push(&mut self, piece: FlightLog) {
        self.rows += piece.len();
        for info in CHANNELS.iter().filter(|info| piece.has(info.channel)) {
            if !self.recorded.contains(&info.channel) {
                self.recorded.push(info.channel);
            }
        }
        self.preparation.push(piece, &mut self.batch);
        self.condenser.take(&mut self.batch);
    }

    /// Takes a table of glides.
    pub fn push_glides(&mut self, mut glides: Vec<Observation>) {
        self.has_tables = true;
        self.condenser.take(&mut glides);
    }

    /// Why no sample came of a log.
    fn nothing_left(&self, log: &Path, has_density: bool) -> InputError {
        let has = |channel: Channel| self.recorded.contains(&channel);
        let of_sea_water = has(Channel::Temperature) && (has(Channel::Salinity) || has(Channel::Conductivity));
        let error = |problem: String| InputError::new(Place::file(log), problem);
        if self.rows == 0 {
            return no_rows(log);
        }
        for channel in [Channel::Pitch, Channel::Ballast] {
            if !has(channel) {
                let name = CHANNELS[channel as usize].name;
                return error(format!("not a single value of `{name}`"))
                    .help(format!("choose another column by --column {name}=COLUMN"));
            }
        }
        if !(has_density || has(Channel::Density) || of_sea_water) {
            return error("no density, nor temperature with salinity or conductivity".to_owned())
                .help("give it with --density");
        }
        let leg_dbar = Settings::default().least_leg_dbar;
        error(format!("no descent or ascent of more than {leg_dbar} dbar with pitch, ballast volume and density on it"))
            .help("is it the log of a dive, with pressure in decibar, or depth in metres?")
    }

    /// The samples.
    ///
    /// # Errors
    /// Where a column is in another unit than it says, so that its values were taken out.
    pub fn finish(mut self) -> Result<Log, CliError> {
        self.preparation.finish(&mut self.batch);
        self.condenser.take(&mut self.batch);
        let (mut observations, shortened) = self.condenser.finish();
        let lost = take_out_lost_speeds(&mut observations);
        let w_filter =
            if self.has_tables { "the column w_m_s of the table".to_owned() } else { self.preparation.filter() };
        let w_filter = match &shortened {
            Some(said) => format!("{w_filter}; {said}"),
            None => w_filter,
        };
        let notes: Vec<String> =
            self.preparation.notes().sentences().into_iter().chain(lost).chain(shortened).collect();
        let wrong = consistency::taken_out(&self.preparation);
        if wrong.is_empty() {
            Ok(Log { observations, w_filter, notes, of_files: Vec::new() })
        } else {
            Err(refused(wrong, &notes))
        }
    }
}

/// A log that contradicts itself. What was taken out in the reading may be what is wrong, so the notes are told with it.
pub fn refused(checks: Vec<Check>, notes: &[String]) -> CliError {
    CliError::Usage(format!("{}{}", SeaError::Inconsistent(checks), noted(notes)))
}

/// Notes of the reading as the end of an error.
pub fn noted(notes: &[String]) -> String {
    if notes.is_empty() { String::new() } else { format!("; the reading noted: {}", notes.join("; ")) }
}

#[cfg(test)]
mod tests;
