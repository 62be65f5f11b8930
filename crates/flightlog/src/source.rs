//! What a file is, by its content, before it is read: its kind, its glider, when its record begins.

use std::path::{Path, PathBuf};

use super::calibration::Calibration;
use super::channels::{Channel, FlightLog};
use super::columns::Columns;
use super::dates::FIRST_UNIX_S;
use super::open::Opened;
use super::{glide_table, netcdf, og1, open, seaexplorer, seaglider, slocum};
use glidepolar_input::InputError;
use glidepolar_input::memory::Table;

/// One file, before it is read; or the files of one segment.
pub(super) struct Source {
    pub(super) path: PathBuf,
    pub(super) kind: Kind,
    /// The glider, where the file names it.
    pub(super) glider: String,
    /// When its record begins \[s\]; NaN where that is not known without reading it.
    pub(super) start_s: f64,
    /// Whether its times begin again within those of another file, so that they are laid behind those before.
    pub(super) begins_again: bool,
}

pub(super) enum Kind {
    Seaglider(Box<Calibration>),
    /// A file of a Slocum or of a SeaExplorer, whose computers write files of their own for each segment.
    Part(Part),
    /// The files of one segment.
    Segment(Maker, Vec<PathBuf>),
    TimeSeries,
    /// A file of any kind that [`open`] knows.
    OneFile,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Maker {
    Slocum,
    SeaExplorer,
}

pub(super) struct Part {
    pub(super) maker: Maker,
    pub(super) segment: String,
    /// Of several records by one computer the fullest has the highest rank.
    pub(super) rank: u8,
    pub(super) is_science: bool,
}

/// What a file is, by its content.
pub(super) fn probe(path: &Path, columns: &Columns) -> Result<Source, InputError> {
    let source = |kind, glider, start_s| Source { path: path.to_owned(), kind, glider, start_s, begins_again: false };
    if Table::named(path).is_some() {
        return one_file(path, columns);
    }
    if netcdf::is_one(path)? {
        let file = netcdf::open(path)?;
        if seaglider::is_one(&file) {
            let headline = seaglider::headline(path, &file)?;
            let glider = headline.calibration.glider.clone();
            return Ok(source(Kind::Seaglider(Box::new(headline.calibration)), glider, headline.start_s));
        }
        let (glider, start_s) = og1::headline(path, &file, columns)?;
        return Ok(source(Kind::TimeSeries, glider, start_s));
    }
    if slocum::is_one(path)? {
        let found = slocum::headline(path, columns)?;
        let slocum::Headline { segment, rank, is_science, .. } = found;
        let part = Part { maker: Maker::Slocum, segment, rank, is_science };
        return Ok(source(Kind::Part(part), found.glider, found.start_s));
    }
    if seaexplorer::is_one(path)? {
        let found = seaexplorer::headline(path)?;
        let seaexplorer::Headline { segment, rank, is_payload, .. } = found;
        let part = Part { maker: Maker::SeaExplorer, segment, rank, is_science: is_payload };
        return Ok(source(Kind::Part(part), found.glider, found.start_s));
    }
    super::open::refuse_foreign(path)?;
    if glide_table::is_one(path)? {
        return Ok(source(Kind::OneFile, String::new(), f64::NAN));
    }
    one_file(path, columns)
}

/// A file of any kind that [`open`] knows.
fn one_file(path: &Path, columns: &Columns) -> Result<Source, InputError> {
    let start_s = match open(path, columns)? {
        Opened::Series(mut pieces) => ordering_s(pieces.next_piece(1)?.as_ref()),
        Opened::Glides(_) => f64::NAN,
    };
    Ok(Source { path: path.to_owned(), kind: Kind::OneFile, glider: String::new(), start_s, begins_again: false })
}

/// The time by which a log is put in order among others. Times since a start of their own order nothing.
fn ordering_s(first: Option<&FlightLog>) -> f64 {
    first.map(|piece| piece.at(Channel::Time, 0)).filter(|time| *time > FIRST_UNIX_S).unwrap_or(f64::NAN)
}

impl Source {
    /// The first and the last time of a table whose times count from a start of its own; nothing for any other file. The table is
    /// read for it.
    pub(super) fn own_times_s(&self, columns: &Columns) -> Option<[f64; 2]> {
        if !matches!(self.kind, Kind::OneFile) || self.start_s.is_finite() {
            return None;
        }
        // What cannot be read is reported where the log is.
        let Ok(Opened::Series(mut pieces)) = open(&self.path, columns) else { return None };
        let mut span: Option<[f64; 2]> = None;
        while let Ok(Some(piece)) = pieces.next_piece(ROWS) {
            for &time in piece.column(Channel::Time).iter().filter(|time| time.is_finite()) {
                span = Some(span.map_or([time; 2], |[first, last]| [first.min(time), last.max(time)]));
            }
        }
        span
    }
}

/// Rows of a table that are looked at together.
const ROWS: usize = 50_000;
