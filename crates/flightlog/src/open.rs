//! Opening a log of any kind: the kind is told by the first bytes and the names of the columns.

use std::io::Read;
use std::path::{Path, PathBuf};

use super::channels::{CHANNELS, Channel, FlightLog};
use super::{CsvLog, Observation, glide_table, og1, seaglider};
use glidepolar_input::{InputError, Place, nearest, printable};

/// Which column of a file holds a channel, where it is not the usual one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    chosen: Vec<(Channel, String)>,
}

impl Columns {
    /// Takes a channel from this column.
    pub fn choose(&mut self, channel: Channel, column: &str) {
        self.chosen.retain(|(chosen, _)| *chosen != channel);
        self.chosen.push((channel, column.to_owned()));
    }

    /// Takes a choice as a user writes it, `pitch_rad=pitch_corr_rad`: the channel's own name, then the column.
    ///
    /// # Errors
    /// A text without `=`, or a channel that does not exist; the message names the nearest one.
    pub fn choose_text(&mut self, text: &str) -> Result<(), String> {
        let (name, column) = text
            .split_once('=')
            .ok_or_else(|| format!("`{}` is no choice of a column, expected CHANNEL=COLUMN", printable(text)))?;
        match CHANNELS.iter().find(|info| info.name == name) {
            Some(info) => {
                self.choose(info.channel, column);
                Ok(())
            }
            None => {
                let near = nearest(name, CHANNELS.iter().map(|info| info.name));
                let hint = near.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
                Err(format!("there is no channel `{}`{hint}", printable(name)))
            }
        }
    }

    /// The column chosen for a channel.
    pub fn of(&self, channel: Channel) -> Option<&str> {
        self.chosen.iter().find(|(chosen, _)| *chosen == channel).map(|(_, column)| column.as_str())
    }
}

/// What a file turned out to be.
pub enum Opened {
    /// A time series, to be read in pieces.
    Series(Box<LogPieces>),
    /// A table with one row per leg.
    Glides(Vec<Observation>),
}

/// A time series that is read in pieces.
pub enum LogPieces {
    /// CSV, from line to line.
    Csv(Box<CsvLog>),
    /// NetCDF, whole.
    Whole(Option<Box<FlightLog>>),
}

impl LogPieces {
    /// The next piece of about `rows` samples; nothing at the end.
    ///
    /// # Errors
    /// What cannot be read, with its place.
    pub fn next_piece(&mut self, rows: usize) -> Result<Option<FlightLog>, InputError> {
        match self {
            LogPieces::Csv(log) => log.next_piece(rows),
            LogPieces::Whole(log) => Ok(log.take().map(|log| *log)),
        }
    }
}

/// Opens a file, whatever its kind.
///
/// # Errors
/// Where it cannot be read or is no flight log, with its place and what was expected.
pub fn open(path: impl AsRef<Path>, columns: &Columns) -> Result<Opened, InputError> {
    let path: PathBuf = path.as_ref().to_owned();
    let mut magic = [0u8; 8];
    let mut file = std::fs::File::open(&path).map_err(|error| InputError::io(&path, &error))?;
    let read = file.read(&mut magic).map_err(|error| InputError::io(&path, &error))?;
    let is_netcdf = magic.starts_with(b"CDF") || magic == *b"\x89HDF\r\n\x1a\n";
    if is_netcdf {
        let whole = if seaglider::is_one(&path)? { seaglider::read(&path)? } else { og1::read(&path, columns)? };
        return Ok(Opened::Series(Box::new(LogPieces::Whole(Some(Box::new(whole))))));
    }
    if magic == *b"dbd_labe" {
        let error = InputError::new(Place::file(&path), "is a Slocum's binary file, which is not read here");
        return Err(error.help("convert the mission to NetCDF (pyglider) or CSV (dbdreader), with its ballast volume"));
    }
    if read == 0 {
        return Err(InputError::new(Place::file(&path), "the file is empty, expected a flight log"));
    }
    if glide_table::is_one(&path)? {
        return Ok(Opened::Glides(glide_table::read_glide_table(&path, columns)?));
    }
    Ok(Opened::Series(Box::new(LogPieces::Csv(Box::new(CsvLog::open(&path, columns)?)))))
}
