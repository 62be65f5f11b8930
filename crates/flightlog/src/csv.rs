//! Flight logs in CSV: names of columns carry the units, an empty cell is a missing value, `#` opens a comment. Read in
//! pieces, so that a log may be longer than the memory.
//!
//! Cells are separated by commas, semicolons or tabs, as the line of names shows; where commas do not separate, they may be
//! the decimal mark. Times are seconds, or dates. Names that Slocum, Seaglider, SeaExplorer and OG1 use are known; units may
//! stand in brackets behind the names, or in a line of their own below them, as ERDDAP writes both.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::channels::{CHANNELS, Channel, FlightLog};
use super::columns::Columns;
use super::dates::unix_s;
use super::names;
use super::times;
use super::units::{self, Conversion};
use glidepolar_input::{InputError, Place, nearest, printable};

/// A CSV log that is being read.
pub struct CsvLog {
    path: PathBuf,
    reader: ::csv::Reader<File>,
    columns: Vec<Column>,
    record: ::csv::ByteRecord,
    /// Whether the record is a row of data that was read to see whether it holds units.
    has_row: bool,
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
        let mut reader = reader(path)?;
        let header = header(path, &mut reader)?;
        let mut record = ::csv::ByteRecord::new();
        let mut has_row = reader.read_byte_record(&mut record).map_err(|error| csv_error(path, &error))?;
        let stated = stated_units(&header, has_row.then_some(&record));
        if has_row && is_line_of_units(&record) {
            has_row = false;
        }
        let found = find_columns(path, &header, &stated, columns).map_err(|error| {
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
        Ok(CsvLog { path: path.to_owned(), reader, columns: found, record, has_row, is_checked: false, header })
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
            if !is_read && !self.reader.read_byte_record(&mut self.record).map_err(|e| csv_error(&self.path, &e))? {
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
                let date = || unix_s(std::str::from_utf8(cell).ok()?).filter(|_| column.channel == Channel::Time);
                let read = number(cell).map(|value| column.value(value)).or_else(date);
                let value = read.ok_or_else(|| {
                    let place = Place::line(&self.path, line).column(column.cell + 1);
                    let name = &self.header[column.cell];
                    if column.channel == Channel::Time {
                        no_time(place, name, cell)
                    } else {
                        not_a_number(place, name, cell)
                    }
                })?;
                row.push((column.channel, value));
            }
            piece.push(&row);
        }
        if !self.is_checked && times::is_enough(&piece) {
            times::check(&self.path, &piece)?;
            self.is_checked = true;
        }
        Ok((!piece.is_empty()).then_some(piece))
    }
}

impl Column {
    /// What a number in this column is of its channel: NaN where it stands for a missing value.
    pub(super) fn value(&self, number: f64) -> f64 {
        if units::is_fill(self.channel, number) { f64::NAN } else { self.conversion.convert(number) }
    }
}

/// A reader for the dialect: `#` comments, blanks around cells allowed, cells separated as in the line of names.
pub(super) fn reader(path: &Path) -> Result<::csv::Reader<File>, InputError> {
    let separator = separator(path)?;
    let mut file = File::open(path).map_err(|error| InputError::io(path, &error))?;
    skip_separator_line(&mut file).map_err(|error| InputError::io(path, &error))?;
    let mut builder = ::csv::ReaderBuilder::new();
    builder.comment(Some(b'#')).trim(::csv::Trim::All).flexible(true).delimiter(separator);
    Ok(builder.from_reader(file))
}

/// A spreadsheet's `sep=;` above the names is no line of the table.
fn skip_separator_line(file: &mut File) -> std::io::Result<()> {
    let mut start = [0u8; 16];
    let read = file.read(&mut start)?;
    let text = start[..read].strip_prefix(b"\xef\xbb\xbf").unwrap_or(&start[..read]);
    let line = text.iter().position(|byte| *byte == b'\n').filter(|_| text.starts_with(b"sep="));
    let at = line.map_or(0, |line| (read - text.len()) + line + 1);
    file.seek(SeekFrom::Start(at as u64)).map(|_| ())
}

/// What separates the names in the first line that is no comment: tabs before semicolons before bars before commas, since a
/// name may hold the latter.
fn separator(path: &Path) -> Result<u8, InputError> {
    /// Longest beginning that is looked into.
    const LONGEST: u64 = 1 << 16;
    let mut start = Vec::new();
    let file = File::open(path).map_err(|error| InputError::io(path, &error))?;
    file.take(LONGEST).read_to_end(&mut start).map_err(|error| InputError::io(path, &error))?;
    let lines = start.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let is_names = |line: &&[u8]| !line.is_empty() && !line.starts_with(b"#") && !line.starts_with(b"sep=");
    let names = lines.into_iter().find(is_names).unwrap_or_default();
    Ok([b'\t', b';', b'|'].into_iter().find(|separator| names.contains(separator)).unwrap_or(b','))
}

/// The names of the columns.
pub(super) fn header(path: &Path, reader: &mut ::csv::Reader<File>) -> Result<Vec<String>, InputError> {
    let header = reader.byte_headers().map_err(|error| csv_error(path, &error))?;
    let names: Vec<String> =
        header.iter().map(|cell| text(cell).trim_start_matches('\u{feff}').trim_matches('"').to_owned()).collect();
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

/// Whether a row holds units instead of values: no number and no date in it, and a unit of some channel.
fn is_line_of_units(record: &::csv::ByteRecord) -> bool {
    let texts: Vec<String> = record.iter().map(|cell| text(cell).trim().to_owned()).collect();
    let holds_value = |text: &String| number(text.as_bytes()).is_some_and(f64::is_finite) && text != "1";
    let is_unit = |text: &String| CHANNELS.iter().any(|info| units::conversion(info.channel, text).is_some());
    !texts.iter().any(|text| holds_value(text) || unix_s(text).is_some())
        && texts.iter().filter(|text| !text.is_empty() && is_unit(text)).count() >= 2
}

/// Where each channel stands among the columns, and in which unit.
pub(super) fn find_columns(
    path: &Path,
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
                let error = InputError::new(Place::line(path, 1), format!("no column `{}`", printable(name)));
                match near {
                    Some(near) => error.help(format!("did you mean `{}`?", printable(near))),
                    None => error.help(format!("the columns are: {}", listed(header))),
                }
            })?;
            let by_name = || {
                let of_table = stated[cell].1.as_deref().and_then(|unit| units::conversion(info.channel, unit));
                let maker = || maker_factor(info.channel, name).map(Conversion::by);
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
            let cell = stated.iter().position(|(stem, unit)| unit.is_some() && stem.eq_ignore_ascii_case(name))?;
            Some((cell, units::conversion(info.channel, stated[cell].1.as_deref()?)?))
        });
        if let Some((cell, conversion)) = with_unit.into_iter().next() {
            let conversion = wanted.unit(info.channel).unwrap_or(conversion);
            columns.push(Column { cell, channel: info.channel, conversion });
            continue;
        }
        let makers =
            MAKERS.iter().filter(|(channel, ..)| *channel == info.channel).map(|(_, name, factor)| (*name, *factor));
        let names = std::iter::once((info.name, 1.0)).chain(info.aliases.iter().copied()).chain(makers);
        // Without capital letters where no column has the very name; a plain word as `Pitch` is no maker's in small letters.
        let alike = |name: &str| header.iter().position(|found| name.contains('_') && found.eq_ignore_ascii_case(name));
        let mut exact = names.clone().filter_map(|(name, factor)| Some((position(name)?, factor)));
        let mut alike = names.filter_map(|(name, factor)| Some((alike(name)?, factor)));
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
    let need = |what: &str, names: &str| {
        let error = InputError::new(Place::line(path, 1), format!("no {what}: expected a column {names}"));
        let alike = header.iter().find(|name| name.to_lowercase().starts_with(what.split(' ').next().unwrap_or(what)));
        match alike {
            Some(name) if header.len() == 1 && name.split_whitespace().count() > 2 => {
                error.help("are the columns separated by blanks? commas, semicolons, tabs and bars are read")
            }
            // A name without a unit says too little.
            Some(name) => {
                let channel = names.trim_start_matches('`').split('`').next().unwrap_or("");
                error.help(format!(
                    "is it `{}`? say --column {channel}={0}, and --unit {channel}=... where it is in another unit",
                    printable(name)
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
        return Err(need("ballast volume", "`vbd_cc` or `vbd_m3`"));
    }
    Ok(columns)
}

const DEG: f64 = std::f64::consts::PI / 180.0;

/// Names that the makers and the formats use, the factor to the unit kept here: Slocum (bar, rad, inches), Seaglider's
/// basestation (degrees, cm), SeaExplorer (degrees, mm), OG1 (degrees).
const MAKERS: &[(Channel, &str, f64)] = &[
    (Channel::Time, "m_present_time", 1.0),
    (Channel::Time, "sci_m_present_time", 1.0),
    (Channel::Time, "Timestamp", 1.0),
    (Channel::Time, "PLD_REALTIMECLOCK", 1.0),
    (Channel::Time, "TIME", 1.0),
    (Channel::Time, "time", 1.0),
    (Channel::Time, "datetime", 1.0),
    (Channel::Pressure, "sci_water_pressure", 10.0),
    (Channel::Pressure, "m_pressure", 10.0),
    (Channel::Pressure, "ctd_pressure", 1.0),
    (Channel::Pressure, "GPCTD_PRESSURE", 1.0),
    (Channel::Pressure, "LEGATO_PRESSURE", 1.0),
    (Channel::Pressure, "PRES", 1.0),
    (Channel::Pressure, "pressure", 1.0),
    (Channel::Depth, "m_depth", 1.0),
    (Channel::Depth, "Depth", 1.0),
    (Channel::Depth, "DEPTH", 1.0),
    (Channel::Depth, "GLIDER_DEPTH", 1.0),
    (Channel::Depth, "depth", 1.0),
    (Channel::Pitch, "m_pitch", 1.0),
    (Channel::Pitch, "eng_pitchAng", DEG),
    (Channel::Pitch, "Pitch", DEG),
    (Channel::Pitch, "PITCH", DEG),
    (Channel::Pitch, "GLIDER_PITCH", DEG),
    (Channel::Ballast, "m_ballast_pumped", 1.0),
    (Channel::Ballast, "m_de_oil_vol", 1.0),
    (Channel::Ballast, "eng_vbdCC", 1.0),
    (Channel::Ballast, "BallastPos", 1.0),
    (Channel::Density, "DENSITY", 1.0),
    (Channel::Density, "density", 1.0),
    (Channel::Temperature, "sci_water_temp", 1.0),
    (Channel::Temperature, "GPCTD_TEMPERATURE", 1.0),
    (Channel::Temperature, "LEGATO_TEMPERATURE", 1.0),
    (Channel::Temperature, "TEMP", 1.0),
    (Channel::Temperature, "temperature", 1.0),
    (Channel::Salinity, "LEGATO_SALINITY", 1.0),
    (Channel::Salinity, "PSAL", 1.0),
    (Channel::Salinity, "salinity", 1.0),
    (Channel::Conductivity, "sci_water_cond", 1.0),
    (Channel::Conductivity, "GPCTD_CONDUCTIVITY", 1.0),
    (Channel::Conductivity, "LEGATO_CONDUCTIVITY", 0.1),
    (Channel::Roll, "m_roll", 1.0),
    (Channel::Roll, "eng_rollAng", DEG),
    (Channel::Roll, "Roll", DEG),
    (Channel::Roll, "ROLL", DEG),
    (Channel::Roll, "GLIDER_ROLL", DEG),
    (Channel::Heading, "m_heading", 1.0),
    (Channel::Heading, "eng_head", DEG),
    (Channel::Heading, "Heading", DEG),
    (Channel::Heading, "HEADING", DEG),
    (Channel::Rudder, "m_fin", 1.0),
    (Channel::BatteryPosition, "m_battpos", 0.0254),
    (Channel::BatteryPosition, "LinPos", 0.001),
    (Channel::PitchMass, "eng_pitchCtl", 0.01),
    (Channel::Charge, "m_coulomb_amphr_total", 1.0),
    (Channel::Voltage, "m_battery", 1.0),
    (Channel::Latitude, "LATITUDE", 1.0),
    (Channel::Latitude, "latitude", 1.0),
    (Channel::Longitude, "LONGITUDE", 1.0),
    (Channel::Longitude, "longitude", 1.0),
];

/// What a maker's name says of the unit.
fn maker_factor(channel: Channel, name: &str) -> Option<f64> {
    MAKERS.iter().find(|(of, known, _)| *of == channel && *known == name).map(|(.., factor)| *factor)
}

fn listed(header: &[String]) -> String {
    header.iter().map(|name| printable(name)).collect::<Vec<_>>().join(", ")
}

/// What programs write for a value that is missing.
const MISSING: [&str; 8] = ["nan", "na", "n/a", "null", "none", "--", "-", "nat"];

/// The number in a cell; NaN for an empty one; nothing where it holds something else.
pub(super) fn number(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?.trim();
    if text.is_empty() || MISSING.iter().any(|missing| text.eq_ignore_ascii_case(missing)) {
        return Some(f64::NAN);
    }
    // A comma in a cell is the decimal mark of half the world.
    let parsed = if text.contains(',') { text.replacen(',', ".", 1).parse() } else { text.parse() };
    parsed.ok().filter(|value: &f64| value.is_finite())
}

pub(super) fn not_a_number(place: Place, column: &str, cell: &[u8]) -> InputError {
    let found = printable(&String::from_utf8_lossy(cell));
    InputError::new(place, format!("`{}` is `{found}`, expected a number or an empty cell", printable(column)))
}

fn no_time(place: Place, column: &str, cell: &[u8]) -> InputError {
    let found = printable(&String::from_utf8_lossy(cell));
    let problem = format!("`{}` is `{found}`, neither seconds nor a date that is known", printable(column));
    InputError::new(place, problem).help("dates are 2022-06-13T18:00:00Z or, the day first, 13/06/2022 18:00:00")
}

pub(super) fn csv_error(path: &Path, error: &::csv::Error) -> InputError {
    let place = match error.position() {
        Some(position) => Place::line(path, position.line() as usize),
        None => Place::file(path),
    };
    InputError::new(place, error.to_string())
}
