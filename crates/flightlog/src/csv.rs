//! Flight logs in CSV: names of columns carry the units, an empty cell is a missing value, `#` opens a comment. Read in
//! pieces, so that a log may be longer than the memory.
//!
//! Cells are separated by commas, semicolons or tabs, as the line of names shows; where commas do not separate, they may be
//! the decimal mark. Times are seconds, or dates. Names that Slocum, Seaglider, SeaExplorer and OG1 use are known; units may
//! stand in brackets behind the names, or in a line of their own below them, as ERDDAP writes both.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::cells::no_time;
pub(super) use super::cells::{not_a_number, number};
use super::channels::{CHANNELS, Channel, FlightLog};
use super::columns::Columns;
use super::dates::unix_s;
pub(super) use super::dialect::Rows;
use super::makers;
use super::names;
use super::row_dates::RowDates;
use super::times;
use super::units::{self, Conversion};
use glidepolar_input::{InputError, Place, nearest, printable};

/// A CSV log that is being read.
pub struct CsvLog {
    path: PathBuf,
    rows: Rows,
    columns: Vec<Column>,
    record: ::csv::ByteRecord,
    /// Whether the record is a row of data that was read to see whether it holds units.
    has_row: bool,
    dates: RowDates,
    /// What a user should know of it.
    warnings: Vec<String>,
    /// Whether the times are known to be seconds.
    is_checked: bool,
    /// Cells that hold something else than a number, with the place of the first.
    pub header: Vec<String>,
}

pub(super) struct Column {
    pub cell: usize,
    pub channel: Channel,
    pub conversion: Conversion,
}

impl CsvLog {
    /// Opens a log and finds its channels.
    ///
    /// # Errors
    /// Where the file cannot be read or a channel is missing without which nothing can be done.
    pub fn open(path: &Path, columns: &Columns) -> Result<Self, InputError> {
        let mut rows = Rows::open(path)?;
        let header = header(path, &mut rows)?;
        let names = rows.place();
        let mut record = ::csv::ByteRecord::new();
        let mut has_row = rows.next(&mut record)?;
        let stated = stated_units(&header, has_row.then_some(&record));
        if has_row && is_line_of_units(&record) {
            has_row = false;
        }
        let found = find_columns(&names, &header, &stated, columns).map_err(|error| {
            // The names of a table are as many as its cells.
            let below = record.len();
            if below > header.len() + 1 {
                let names = header.len();
                error.help(format!(
                    "the line of names has {names} cells, the next one {below}: is there a title above the names? put # before it"
                ))
            } else {
                error
            }
        })?;
        let time = found.iter().find(|column| column.channel == Channel::Time).map_or(0, |column| column.cell);
        let mut warnings = Vec::new();
        let dates = RowDates::find(path, &header, time, columns.date_order(), &mut warnings)?;
        let path = path.to_owned();
        Ok(CsvLog { path, rows, columns: found, record, has_row, dates, warnings, is_checked: false, header })
    }

    /// The next piece of at most `rows` samples; nothing at the end.
    ///
    /// # Errors
    /// A cell that is no number, with file, line and column.
    pub fn next_piece(&mut self, rows: usize) -> Result<Option<FlightLog>, InputError> {
        let mut piece = FlightLog::default();
        let mut row: Vec<(Channel, f64)> = Vec::with_capacity(self.columns.len());
        while piece.len() < rows {
            let is_read = std::mem::take(&mut self.has_row);
            if !is_read && !self.rows.next(&mut self.record)? {
                break;
            }
            row.clear();
            match self.read_row(&mut row) {
                Ok(()) => piece.push(&row),
                Err(error) if self.is_cut_off()? => {
                    let error = InputError { help: None, ..error };
                    self.warnings.push(format!("the last line is cut off and left out: {error}"));
                    break;
                }
                Err(error) => return Err(error),
            }
        }
        if !self.is_checked && times::is_enough(&piece) {
            times::check(&self.path, &piece)?;
            self.is_checked = true;
        }
        Ok((!piece.is_empty()).then_some(piece))
    }

    /// What a user should know of what was read so far; it is said once.
    pub fn take_warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.warnings)
    }

    /// The values of the row that was read last.
    fn read_row(&mut self, row: &mut Vec<(Channel, f64)>) -> Result<(), InputError> {
        if self.record.len() != self.header.len() {
            let place = self.rows.place();
            let problem = format!("{} cells, expected {} as in the header", self.record.len(), self.header.len());
            return Err(InputError::new(place, problem).help("was the file cut off while it was written?"));
        }
        for column in &self.columns {
            let cell = self.record.get(column.cell).unwrap_or(b"");
            let is_time = column.channel == Channel::Time;
            let date = || if is_time { self.dates.unix_s(&self.record) } else { None };
            let read = number(cell).map(|value| column.value(value)).or_else(date);
            let value = read.ok_or_else(|| {
                let place = self.rows.place().column(column.cell + 1);
                let name = &self.header[column.cell];
                if is_time { no_time(place, name, cell) } else { not_a_number(place, name, cell) }
            })?;
            row.push((column.channel, value));
        }
        Ok(())
    }

    /// Whether the row that was read last is the end of a file without an end of line: one that was cut off while it was
    /// written.
    fn is_cut_off(&mut self) -> Result<bool, InputError> {
        let io = |error: std::io::Error| InputError::io(&self.path, &error);
        let mut file = File::open(&self.path).map_err(io)?;
        let mut last = [0u8; 1];
        file.seek(SeekFrom::End(-1)).map_err(io)?;
        file.read_exact(&mut last).map_err(io)?;
        let mut next = ::csv::ByteRecord::new();
        Ok(last[0] != b'\n' && !self.rows.next(&mut next)?)
    }
}

impl Column {
    /// What a number in this column is of its channel: NaN where it stands for a missing value.
    pub(super) fn value(&self, number: f64) -> f64 {
        if units::is_fill(self.channel, number) { f64::NAN } else { self.conversion.convert(number) }
    }
}

/// The names of the columns.
pub(super) fn header(path: &Path, rows: &mut Rows) -> Result<Vec<String>, InputError> {
    let names: Vec<String> = rows
        .names()?
        .iter()
        .map(|cell| text(cell).trim_start_matches('\u{feff}').trim_matches('"').to_owned())
        .collect();
    if names.iter().all(|name| name.is_empty()) {
        return Err(InputError::new(Place::file(path), "the file is empty, expected a line of column names"));
    }
    for (i, name) in names.iter().enumerate() {
        if !name.is_empty() && names[..i].contains(name) {
            let place = rows.place().column(i + 1);
            return Err(InputError::new(place, format!("column `{}` stands twice", printable(name))));
        }
    }
    Ok(names)
}

/// A cell as text: Latin-1, of which older programs write `°` and `³`, where it is no UTF-8.
fn text(cell: &[u8]) -> String {
    std::str::from_utf8(cell).map_or_else(|_| cell.iter().map(|byte| char::from(*byte)).collect(), str::to_owned)
}

/// The name of each column without its unit, and the unit where the table states one: behind the name in brackets, or in
/// the line below the names.
pub(super) fn stated_units(header: &[String], first: Option<&::csv::ByteRecord>) -> Vec<(String, Option<String>)> {
    let below = first.filter(|record| is_line_of_units(record));
    let of = |(i, name): (usize, &String)| match (names::with_unit(name), below) {
        (Some((stem, unit)), _) => (stem.to_owned(), Some(unit.to_owned())),
        (None, Some(units)) => {
            let unit = units.get(i).map(|cell| text(cell).trim().to_owned());
            (name.clone(), unit.filter(|unit| !unit.is_empty()))
        }
        (None, None) => (name.clone(), None),
    };
    header.iter().enumerate().map(of).collect()
}

/// Whether a row holds units instead of values: no number and no date in it, and units of some channels. 1 and 1e-3 are the
/// units of a salinity.
fn is_line_of_units(record: &::csv::ByteRecord) -> bool {
    let texts: Vec<String> = record.iter().map(|cell| text(cell).trim().to_owned()).collect();
    let is_value = |number: f64| number.is_finite() && number != 1.0 && number != 1e-3;
    let holds_value = |text: &String| number(text.as_bytes()).is_some_and(is_value);
    let is_unit = |text: &String| CHANNELS.iter().any(|info| units::conversion(info.channel, text).is_some());
    !texts.iter().any(|text| holds_value(text) || unix_s(text).is_some())
        && texts.iter().filter(|text| !text.is_empty() && is_unit(text)).count() >= 2
}

/// Where each channel stands among the columns, and in which unit; `names` is the place of their names.
pub(super) fn find_columns(
    names: &Place,
    header: &[String],
    stated: &[(String, Option<String>)],
    wanted: &Columns,
) -> Result<Vec<Column>, InputError> {
    let position = |name: &str| header.iter().position(|found| found == name);
    let mut columns = Vec::new();
    for info in CHANNELS {
        if let Some(name) = wanted.chosen(info.channel) {
            let cell = position(name).ok_or_else(|| {
                let near = nearest(name, header.iter().map(String::as_str));
                let error = InputError::new(names.clone(), format!("no column `{}`", printable(name)));
                match near {
                    Some(near) => error.help(format!("did you mean `{}`?", printable(near))),
                    None => error.help(format!("the columns are: {}", listed(header))),
                }
            })?;
            if info.channel == Channel::Ballast && wanted.unit(info.channel).is_none() {
                refuse_mass(names, cell, &stated[cell])?;
            }
            let by_name = || {
                let of_table = stated[cell].1.as_deref().and_then(|unit| units::conversion(info.channel, unit));
                let maker = || makers::factor(info.channel, name).map(Conversion::by);
                of_table.or_else(maker).or_else(|| units::unit_at_end(info.channel, name)).unwrap_or(Conversion::NONE)
            };
            let conversion = wanted.unit(info.channel).unwrap_or_else(by_name);
            columns.push(Column { cell, channel: info.channel, conversion });
            continue;
        }
        // A unit that the table states goes before what a name says of it.
        let own = [info.name];
        let known = names::known(info.channel).iter().chain(&own);
        let with_unit = known.filter_map(|name| {
            let cell = stated.iter().position(|(stem, unit)| unit.is_some() && names::is_same(stem, name))?;
            Some((cell, units::conversion(info.channel, stated[cell].1.as_deref()?)?))
        });
        if let Some((cell, conversion)) = with_unit.into_iter().next() {
            let conversion = wanted.unit(info.channel).unwrap_or(conversion);
            columns.push(Column { cell, channel: info.channel, conversion });
            continue;
        }
        let makers = makers::MAKERS
            .iter()
            .filter(|(channel, ..)| *channel == info.channel)
            .map(|(_, name, factor)| (*name, *factor));
        let of_channel = std::iter::once((info.name, 1.0)).chain(info.aliases.iter().copied()).chain(makers);
        // Without capital letters where no column has the very name; a plain word as `Pitch` is no maker's in small letters.
        let alike = |name: &str| header.iter().position(|found| name.contains('_') && found.eq_ignore_ascii_case(name));
        let mut exact = of_channel.clone().filter_map(|(name, factor)| Some((position(name)?, factor)));
        let mut alike = of_channel.filter_map(|(name, factor)| Some((alike(name)?, factor)));
        let found = exact.next().or_else(|| alike.next()).map(|(cell, factor)| (cell, Conversion::by(factor)));
        let found = found.or_else(|| {
            let of = |(cell, name): (usize, &String)| Some((cell, units::unit_in_name(info.channel, name)?));
            header.iter().enumerate().find_map(of)
        });
        if let Some((cell, conversion)) = found {
            let conversion = wanted.unit(info.channel).unwrap_or(conversion);
            columns.push(Column { cell, channel: info.channel, conversion });
        }
    }
    let has = |channel: Channel| columns.iter().any(|column| column.channel == channel);
    let need = |what: &str, wanted: &str| {
        let error = InputError::new(names.clone(), format!("no {what}: expected a column {wanted}"));
        let word = what.split(' ').next().unwrap_or(what);
        let begins = header.iter().find(|name| name.to_lowercase().starts_with(word));
        let alike = begins.or_else(|| header.iter().find(|name| name.to_lowercase().contains(word)));
        match alike {
            Some(name) if header.len() == 1 && name.split_whitespace().count() > 2 => {
                error.help("are the columns separated by blanks? commas, semicolons, tabs and bars are read")
            }
            // A name without a unit says too little.
            Some(name) => {
                let channel = wanted.trim_start_matches('`').split('`').next().unwrap_or("");
                let name = printable(name);
                // A shell takes a name with blanks or brackets apart.
                let is_plain = name.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '.' | '-'));
                let quote = if is_plain { "" } else { "\"" };
                error.help(format!(
                    "is it `{name}`? say --column {quote}{channel}={name}{quote}, and --unit {channel}=... where it is in another unit"
                ))
            }
            None => error.help(format!("the columns are: {}", listed(header))),
        }
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
        let is_ballast = |name: &str| ["ballast", "vbd", "oil"].iter().any(|word| name.to_lowercase().contains(word));
        for (cell, column) in stated.iter().enumerate().filter(|(_, (name, _))| is_ballast(name)) {
            refuse_mass(names, cell, column)?;
        }
        return Err(need("ballast volume", "`vbd_cc` or `vbd_m3`"));
    }
    Ok(columns)
}

/// Refuses a mass of ballast: its volume depends on the water.
fn refuse_mass(names: &Place, cell: usize, (name, unit): &(String, Option<String>)) -> Result<(), InputError> {
    if !units::is_mass(name, unit.as_deref()) {
        return Ok(());
    }
    let problem = format!("`{}` is a mass, expected the volume of the ballast", printable(name));
    Err(InputError::new(names.clone().column(cell + 1), problem).help(
        "divide grams by the density of the water, 1.025 g/cc in the sea, and name the column `vbd_cc`; more buoyant is positive",
    ))
}

fn listed(header: &[String]) -> String {
    header.iter().map(|name| printable(name)).collect::<Vec<_>>().join(", ")
}
