//! How the commands read flight logs: the options, the way from files to samples, and the log held against itself, so that
//! every command refuses the same logs in the same words.
//!
//! Knows no command.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{CliError, water_density};
use crate::diagnose::sea::SeaError;
use crate::diagnose::sea::consistency::{self, DensityError};
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
    /// Steady samples and all samples on legs, before a long log was shortened.
    pub steady: [usize; 2],
    /// Acceleration of gravity where the log was recorded; nothing without a position \[m/s2\].
    pub gravity_m_s2: Option<f64>,
}

impl Log {
    /// The vehicle where the log was recorded: with the acceleration of gravity there, unless its file states one.
    pub fn located(&mut self, vehicle: Vehicle) -> Result<Vehicle, CliError> {
        let mut here = vehicle;
        if states_gravity(&here) {
            return Ok(here);
        }
        match self.gravity_m_s2 {
            Some(gravity_m_s2) => {
                here.set("mass.gravity_m_s2", (gravity_m_s2 * 1e5).round() / 1e5)?;
                self.notes.push(format!("g = {gravity_m_s2:.4} m/s2 by the latitude of the log"));
            }
            None => self.notes.push("g = 9.81 m/s2: the log has no position".to_owned()),
        }
        Ok(here)
    }

    /// The share of the samples on legs that are steady, in a sentence.
    pub fn steady_share(&self) -> String {
        let [steady, all] = self.steady;
        format!("{steady} of {all} samples on legs are steady ({:.0} %)", 100.0 * steady as f64 / all.max(1) as f64)
    }

    /// Corrects a density whose error the log's own temperature, salinity and pressure show, as `diagnose` does; what was
    /// done comes back as warnings.
    ///
    /// # Errors
    /// Where the log contradicts itself so that nothing follows from it, in the words of `diagnose`.
    pub fn corrected(&mut self, vehicle: &Vehicle) -> Result<Vec<String>, CliError> {
        let (warnings, error) = self.checked(vehicle)?;
        if let Some(error) = error {
            let carried_kg_m3 = vehicle.glide_parameters().density_bias_kg_m3;
            self.observations = consistency::mended(&self.observations, error, carried_kg_m3);
        }
        Ok(warnings)
    }

    /// Holds the log against itself: what is wrong and can be corrected comes back as warnings, and the error of the density.
    ///
    /// # Errors
    /// Where the log contradicts itself so that nothing follows from it, in the words of `diagnose`.
    pub fn checked(&self, vehicle: &Vehicle) -> Result<(Vec<String>, Option<DensityError>), CliError> {
        let bias_kg_m3 = vehicle.glide_parameters().density_bias_kg_m3;
        let (checks, error) = consistency::checks(&self.observations, bias_kg_m3);
        if checks.iter().any(|check| check.outcome == Checked::Wrong) {
            return Err(refused(checks, &self.notes));
        }
        let found = checks.iter().filter(|check| check.outcome == Checked::Mended);
        let warning = |check: &Check| format!("{}: {}; corrected before anything else", check.check, check.says);
        Ok((self.of_files.iter().cloned().chain(found.map(warning)).collect(), error))
    }
}

/// Whether the vehicle's file states its acceleration of gravity.
fn states_gravity(vehicle: &Vehicle) -> bool {
    vehicle.sections.mass.gravity_m_s2.is_some()
}

/// Acceleration of gravity at the surface of the sea \[m/s2\], by the normal gravity of GRS 80 (Moritz 2000, as TEOS-10 has it).
pub fn gravity_m_s2(latitude_deg: f64) -> f64 {
    let sin2 = latitude_deg.to_radians().sin().powi(2);
    9.780_327 * (1.0 + (5.279_041_4e-3 + (2.327_18e-5 + (1.262e-7 + 7e-10 * sin2) * sin2) * sin2) * sin2)
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
        gathering.gravity_is_known = states_gravity(vehicle);
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
    steady: [usize; 2],
    gravity_is_known: bool,
    gravity_m_s2: Option<f64>,
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
            steady: [0; 2],
            gravity_is_known: false,
            gravity_m_s2: None,
        }
    }

    fn condense(&mut self) {
        self.steady[0] += self.batch.iter().filter(|o| o.steady).count();
        self.steady[1] += self.batch.len();
        self.condenser.take(&mut self.batch);
    }

    /// Gravity where the log begins, for all of it: over a hundred kilometres it changes by a ten-thousandth.
    fn locate(&mut self, piece: &FlightLog) {
        if self.gravity_is_known || self.gravity_m_s2.is_some() {
            return;
        }
        let latitude = piece.column(Channel::Latitude).iter().find(|latitude| latitude.abs() <= 90.0);
        if let Some(gravity) = latitude.copied().map(gravity_m_s2) {
            self.gravity_m_s2 = Some(gravity);
            self.preparation.set_gravity(gravity);
        }
    }

    /// Takes the next piece of a time series.
    pub fn push(&mut self, piece: FlightLog) {
        self.rows += piece.len();
        self.locate(&piece);
        for info in CHANNELS.iter().filter(|info| piece.has(info.channel)) {
            if !self.recorded.contains(&info.channel) {
                self.recorded.push(info.channel);
            }
        }
        self.preparation.push(piece, &mut self.batch);
        self.condense();
    }

    /// Takes a table of glides.
    pub fn push_glides(&mut self, mut glides: Vec<Observation>) {
        self.has_tables = true;
        self.steady[0] += glides.iter().filter(|o| o.steady).count();
        self.steady[1] += glides.len();
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
        self.condense();
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
            Ok(Log {
                observations,
                w_filter,
                notes,
                of_files: Vec::new(),
                steady: self.steady,
                gravity_m_s2: self.gravity_m_s2,
            })
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
