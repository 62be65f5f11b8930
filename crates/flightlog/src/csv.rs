//! Flight logs in CSV: names of columns carry the units, an empty cell is a missing value, `#` opens a comment. Read in
//! pieces, so that a log may be longer than the memory.

use std::fs::File;
use std::path::{Path, PathBuf};

use super::channels::{CHANNELS, Channel, FlightLog};
use super::columns::Columns;
use glidepolar_input::{InputError, Place, nearest, printable};

/// A CSV log that is being read.
pub struct CsvLog {
    path: PathBuf,
    reader: ::csv::Reader<File>,
    columns: Vec<Column>,
    record: ::csv::ByteRecord,
    /// Cells that hold something else than a number, with the place of the first.
    pub header: Vec<String>,
}

struct Column {
    cell: usize,
    channel: Channel,
    factor: f64,
}

impl CsvLog {
    /// Opens a log and finds its channels.
    ///
    /// # Errors
    /// Where the file cannot be read or a channel is missing without which nothing can be done.
    pub fn open(path: &Path, columns: &Columns) -> Result<Self, InputError> {
        let mut reader = reader(path)?;
        let header = header(path, &mut reader)?;
        let found = find_columns(path, &header, columns)?;
        Ok(CsvLog { path: path.to_owned(), reader, columns: found, record: ::csv::ByteRecord::new(), header })
    }

    /// The next piece of at most `rows` samples; nothing at the end.
    ///
    /// # Errors
    /// A cell that is no number, with file, line and column.
    pub fn next_piece(&mut self, rows: usize) -> Result<Option<FlightLog>, InputError> {
        let mut piece = FlightLog::default();
        let mut row: Vec<(Channel, f64)> = Vec::with_capacity(self.columns.len());
        while piece.len() < rows {
            if !self.reader.read_byte_record(&mut self.record).map_err(|e| csv_error(&self.path, &e))? {
                break;
            }
            let line = self.record.position().map_or(0, |p| p.line() as usize);
            if self.record.len() != self.header.len() {
                let place = Place::line(&self.path, line);
                let problem = format!("{} cells, expected {} as in the header", self.record.len(), self.header.len());
                return Err(InputError::new(place, problem).help("was the file cut off while it was written?"));
            }
            row.clear();
            for column in &self.columns {
                let cell = self.record.get(column.cell).unwrap_or(b"");
                let value = number(cell).ok_or_else(|| {
                    let place = Place::line(&self.path, line).column(column.cell + 1);
                    not_a_number(place, &self.header[column.cell], cell)
                })?;
                row.push((column.channel, value * column.factor));
            }
            piece.push(&row);
        }
        Ok((!piece.is_empty()).then_some(piece))
    }
}

/// A reader for the dialect: commas, `#` comments, blanks around cells allowed.
pub(super) fn reader(path: &Path) -> Result<::csv::Reader<File>, InputError> {
    let file = File::open(path).map_err(|error| InputError::io(path, &error))?;
    Ok(::csv::ReaderBuilder::new().comment(Some(b'#')).trim(::csv::Trim::All).flexible(true).from_reader(file))
}

/// The names of the columns.
pub(super) fn header(path: &Path, reader: &mut ::csv::Reader<File>) -> Result<Vec<String>, InputError> {
    let header = reader.byte_headers().map_err(|error| csv_error(path, &error))?;
    let names: Vec<String> = header
        .iter()
        .map(|cell| String::from_utf8_lossy(cell).trim_start_matches('\u{feff}').trim_matches('"').to_owned())
        .collect();
    if names.len() < 2 && names.iter().any(|name| name.contains(';') || name.contains('\t')) {
        let place = Place::line(path, 1);
        return Err(InputError::new(place, "cells are not separated by commas")
            .help("write the file with `,` between cells and `.` in numbers"));
    }
    if names.iter().all(|name| name.is_empty()) {
        return Err(InputError::new(Place::file(path), "the file is empty, expected a line of column names"));
    }
    for (i, name) in names.iter().enumerate() {
        if !name.is_empty() && names[..i].contains(name) {
            let place = Place::line(path, 1).column(i + 1);
            return Err(InputError::new(place, format!("column `{}` stands twice", printable(name))));
        }
    }
    Ok(names)
}

fn find_columns(path: &Path, header: &[String], wanted: &Columns) -> Result<Vec<Column>, InputError> {
    let position = |name: &str| header.iter().position(|found| found == name);
    let mut columns = Vec::new();
    for info in CHANNELS {
        if let Some(name) = wanted.of(info.channel) {
            let cell = position(name).ok_or_else(|| {
                let near = nearest(name, header.iter().map(String::as_str));
                let error = InputError::new(Place::line(path, 1), format!("no column `{}`", printable(name)));
                match near {
                    Some(near) => error.help(format!("did you mean `{}`?", printable(near))),
                    None => error.help(format!("the columns are: {}", listed(header))),
                }
            })?;
            let factor = info.aliases.iter().find(|(alias, _)| same_unit(alias, name)).map_or(1.0, |alias| alias.1);
            columns.push(Column { cell, channel: info.channel, factor });
            continue;
        }
        let names = std::iter::once((info.name, 1.0)).chain(info.aliases.iter().copied());
        if let Some((cell, factor)) = names.filter_map(|(name, factor)| Some((position(name)?, factor))).next() {
            columns.push(Column { cell, channel: info.channel, factor });
        }
    }
    let has = |channel: Channel| columns.iter().any(|column| column.channel == channel);
    let need = |what: &str, names: &str| {
        InputError::new(Place::line(path, 1), format!("no {what}: expected a column {names}"))
            .help(format!("the columns are: {}", listed(header)))
    };
    if !has(Channel::Time) {
        return Err(need("time", "`time_s`"));
    }
    if !has(Channel::Pressure) && !has(Channel::Depth) {
        return Err(need("depth", "`pressure_dbar` or `depth_m`"));
    }
    if !has(Channel::Pitch) {
        return Err(need("pitch", "`pitch_rad` or `pitch_deg`"));
    }
    if !has(Channel::Ballast) {
        return Err(need("ballast volume", "`vbd_cc` or `vbd_m3`"));
    }
    Ok(columns)
}

/// Whether a name that the user gave ends in the unit of an alias, as `pitch_deg` and `pitch_corrected_deg` do.
fn same_unit(alias: &str, name: &str) -> bool {
    let unit = |text: &str| text.rsplit_once('_').map(|(_, unit)| unit.to_owned());
    unit(alias).is_some() && unit(alias) == unit(name)
}

fn listed(header: &[String]) -> String {
    header.iter().map(|name| printable(name)).collect::<Vec<_>>().join(", ")
}

/// The number in a cell; NaN for an empty one; nothing where it holds something else.
pub(super) fn number(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?.trim();
    if text.is_empty() || text.eq_ignore_ascii_case("nan") {
        return Some(f64::NAN);
    }
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

pub(super) fn not_a_number(place: Place, column: &str, cell: &[u8]) -> InputError {
    let found = printable(&String::from_utf8_lossy(cell));
    InputError::new(place, format!("`{}` is `{found}`, expected a number or an empty cell", printable(column)))
}

pub(super) fn csv_error(path: &Path, error: &::csv::Error) -> InputError {
    let place = match error.position() {
        Some(position) => Place::line(path, position.line() as usize),
        None => Place::file(path),
    };
    InputError::new(place, error.to_string())
}
