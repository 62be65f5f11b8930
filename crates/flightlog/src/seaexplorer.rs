//! Files of SeaExplorer gliders: `gli.sub.N` of the vehicle and `pld1.sub.N` or `pld1.raw.N` of the payload, gzipped or not.
//!
//! Tables of text with `;` between cells and behind the last; times `DD/MM/YYYY HH:MM:SS(.mmm)`, positions `DDMM.mmm`,
//! missing cells empty or 9999. The rows of the log are the readings of the CTD's pressure, the vehicle's depth where there
//! are none; all else is brought to these times by straight lines.
//!
//! Angles are degrees, nose up and starboard down positive; `BallastPos` cc, up positive; `LinPos` mm, the battery forward
//! positive; `AngPos` degrees, the battery turned to starboard positive: the roll follows it by half of its angle on the
//! files of three vehicles. `NavState` 100 is a dive, 117 a climb, 110 and 118 the turns
//! between them, 115 and 116 the surface.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;

use super::ad2cp::{self, Ping};
use super::channels::{Channel, FlightLog};
use super::columns::Columns;
use super::dates::unix_s;
use super::fix::{GpsFix, Positions, degrees};
use super::gzip::is_gzip;
use super::resample::{Readings, at_rows, pressure_rows};
use glidepolar_input::{InputError, Place, printable};

const DEG: f64 = std::f64::consts::PI / 180.0;

/// Where channels are found, the best column first, and the factor to the unit kept here.
const COLUMNS: &[(Channel, &[(&str, f64)])] = &[
    (Channel::Pitch, &[("Pitch", DEG)]),
    (Channel::Ballast, &[("BallastPos", 1.0)]),
    (Channel::Roll, &[("Roll", DEG)]),
    (Channel::Heading, &[("Heading", DEG)]),
    (Channel::BatteryPosition, &[("LinPos", 0.001)]),
    (Channel::RollMass, &[("AngPos", DEG)]),
    (Channel::Voltage, &[("Voltage", 1.0)]),
    // Of the CTD, whichever it is: see `of_ctd`.
    (Channel::Temperature, &[]),
    (Channel::Conductivity, &[]),
    (Channel::Salinity, &[]),
    (Channel::Latitude, &[("Lat", 1.0), ("NAV_LATITUDE", 1.0)]),
    (Channel::Longitude, &[("Lon", 1.0), ("NAV_LONGITUDE", 1.0)]),
    (Channel::Density, &[]),
    (Channel::Speed, &[]),
];

/// What the name of a CTD's column ends in, whatever the instrument: `GPCTD_`, `LEGATO_`, `RBR_`, `CTD_`.
fn ending(channel: Channel) -> Option<&'static str> {
    match channel {
        Channel::Pressure => Some("_PRESSURE"),
        Channel::Temperature => Some("_TEMPERATURE"),
        Channel::Conductivity => Some("_CONDUCTIVITY"),
        Channel::Salinity => Some("_SALINITY"),
        _ => None,
    }
}

/// The column of a CTD: its instrument is the one that measures conductivity.
fn of_ctd(tables: &[Whole], channel: Channel) -> Option<String> {
    let names = || tables.iter().flat_map(|table| &table.columns);
    let instrument = names().find_map(|name| name.strip_suffix(ending(Channel::Conductivity)?))?;
    let wanted = format!("{instrument}{}", ending(channel)?);
    names().find(|name| **name == wanted).cloned()
}

/// Conductivities beyond \[S/m\] are in mS/cm: the Seabird gives S/m, the RBR mS/cm, and no sea has more.
const MOST_S_M: f64 = 10.0;

const DEPTHS: [&str; 2] = ["Depth", "NAV_DEPTH"];
const DBAR_PER_M: f64 = 1.0055;

/// States in which the vehicle turns or lies at the surface: nothing there is a glide.
const NO_GLIDE: [f64; 4] = [110.0, 115.0, 116.0, 118.0];

/// The state at the surface, where new positions are those of the receiver.
const SURFACE: f64 = 116.0;

/// What stands for a missing value.
const MISSING: f64 = 9999.0;

/// Largest file of one segment, unpacked \[bytes\]: what is longer is no file of a glider, or made to exhaust the memory.
const LARGEST: u64 = 2 << 30;

/// What a file is, before it is read.
pub(super) struct Headline {
    pub(super) glider: String,
    pub(super) segment: String,
    pub(super) start_s: f64,
    /// `raw` before `sub`.
    pub(super) rank: u8,
    pub(super) is_payload: bool,
}

/// Whether a file begins as one of a SeaExplorer; gzipped files are looked into.
pub(super) fn is_one(path: &Path) -> Result<bool, InputError> {
    let mut start = Vec::new();
    // What does not unpack is reported where it is read.
    let _ = content(path)?.take(4096).read_to_end(&mut start);
    Ok(dialect(&start).is_some())
}

/// How cells are separated and whether they may be in quotation marks: a table that a spreadsheet has saved again has other
/// ways than the glider. Nothing where the text does not begin as a table of a SeaExplorer.
fn dialect(start: &[u8]) -> Option<(u8, bool)> {
    let text = String::from_utf8_lossy(start);
    let first = text.lines().next().unwrap_or("").trim_start_matches('\u{feff}');
    let is_quoted = first.starts_with('"');
    let plain = first.replace('"', "");
    let name = ["PLD_REALTIMECLOCK", "Timestamp"].into_iter().find(|name| plain.starts_with(name))?;
    let separator = *plain.as_bytes().get(name.len())?;
    let is_whole = name == "PLD_REALTIMECLOCK" || plain.contains("NavState");
    (is_whole && [b';', b',', b'\t'].contains(&separator)).then_some((separator, is_quoted))
}

fn content(path: &Path) -> Result<Box<dyn Read>, InputError> {
    let is_gzip = is_gzip(path)?;
    let file = std::io::BufReader::new(File::open(path).map_err(|error| InputError::io(path, &error))?);
    Ok(if is_gzip { Box::new(MultiGzDecoder::new(file).take(LARGEST)) } else { Box::new(file) })
}

/// What the name and the first row of a file say: `sea035.12.gli.sub.39.gz`.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn headline(path: &Path) -> Result<Headline, InputError> {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let parts: Vec<&str> = name.trim_end_matches(".gz").trim_end_matches(".csv").split('.').collect();
    let (glider, segment, rank) = match parts[..] {
        [glider, mission, _, stage, number] => (
            glider.to_owned(),
            // Numbers with and without leading zeros are the same.
            format!("{glider}.{mission}.{}", number.trim_start_matches('0')),
            u8::from(stage == "raw"),
        ),
        // Renamed files: what is left without the words that tell the vehicle's from the payload's is the same for both.
        _ => {
            let words = ["gli", "pld1", "pld", "raw", "sub"];
            let rest = words.iter().fold(name.to_lowercase(), |rest, word| rest.replace(word, ""));
            (String::new(), rest, u8::from(name.contains("raw")))
        }
    };
    let mut table = Table::open(path)?;
    let is_payload = table.columns.first().is_some_and(|first| first == "PLD_REALTIMECLOCK");
    let start_s = table.next_row()?.map_or(f64::NAN, |(time, _)| time);
    Ok(Headline { glider, segment, start_s, rank, is_payload })
}

/// Reads the files of one segment: the vehicle's, the payload's, or both.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn read(
    paths: &[PathBuf],
    columns: &Columns,
    positions: &mut Positions,
    fixes: &mut Vec<GpsFix>,
    warnings: &mut Vec<String>,
) -> Result<FlightLog, InputError> {
    let mut log = FlightLog::default();
    let mut tables = Vec::new();
    for path in paths {
        let mut table = Table::open(path)?;
        tables.push(table.whole(warnings)?);
    }
    let of = |name: &str| tables.iter().find_map(|table| table.series(name));
    let first = |names: &[&str]| names.iter().find_map(|name| of(name).filter(|(times, _)| times.len() > 1));
    let chosen = |channel: Channel| columns.chosen(channel).filter(|name| *name != ad2cp::NAME);
    let ctd = match chosen(Channel::Pressure) {
        Some(name) => first(&[name]),
        None => of_ctd(&tables, Channel::Pressure).and_then(|name| first(&[&name])),
    };
    let depth = first(&DEPTHS).map(|(times, depth)| (times, depth.iter().map(|z| z * DBAR_PER_M).collect::<Vec<_>>()));
    let own = if chosen(Channel::Pressure).is_some() { None } else { depth };
    let Some((mut rows, mut pressure)) = pressure_rows(ctd, own) else {
        warnings.push(format!("{}: no pressure and no depth in it, left out", printable(&paths[0].to_string_lossy())));
        return Ok(log);
    };
    let mut pings = Vec::new();
    if columns.chosen(Channel::Speed) == Some(ad2cp::NAME) {
        let readings = Readings::new(&rows, &pressure);
        pings = tables.iter().find_map(|table| table.pings(&readings)).unwrap_or_default();
        let with_pings = ad2cp::rows(&rows, &pings);
        if with_pings.len() > rows.len() {
            pressure = readings.at_all(&with_pings);
            rows = with_pings;
        }
    }
    for &(channel, names) in COLUMNS {
        let named = || names.iter().copied().find(|(name, _)| of(name).is_some_and(|(times, _)| !times.is_empty()));
        let found = match chosen(channel) {
            Some(name) => Some((name.to_owned(), 1.0)),
            None => match of_ctd(&tables, channel) {
                Some(name) => Some((name, 1.0)),
                None => named().map(|(name, factor)| (name.to_owned(), factor)),
            },
        };
        let Some((name, mut factor)) = found else { continue };
        let Some((times, values)) = of(&name) else { continue };
        if channel == Channel::Conductivity && !values.is_empty() && super::median(&mut values.clone()) > MOST_S_M {
            factor = 0.1;
        }
        let factor = columns.unit(channel).map_or(factor, |unit| unit.factor);
        let is_position = matches!(channel, Channel::Latitude | Channel::Longitude);
        let values: Vec<f64> = values.iter().map(|v| if is_position { degrees(*v) } else { v * factor }).collect();
        log.set(channel, at_rows(channel, &rows, &times, &values));
    }
    if let Some((times, states)) = first(&["NavState", "NAV_RESOURCE"]) {
        // The state holds until the next is written.
        let state = |time: f64| states[times.partition_point(|t| *t <= time).saturating_sub(1)];
        log.set(
            Channel::MotorMoving,
            rows.iter().map(|t| f64::from(u8::from(NO_GLIDE.contains(&state(*t))))).collect(),
        );
    }
    if !pings.is_empty() {
        log.set(Channel::Speed, ad2cp::column(&rows, &pings));
    }
    log.set(Channel::Pressure, pressure);
    log.set(Channel::Time, rows);
    fixes.extend(tables.iter().flat_map(|table| table.fixes(positions)));
    Ok(log)
}

/// A file that is being read.
struct Table {
    path: PathBuf,
    reader: ::csv::Reader<Box<dyn Read>>,
    columns: Vec<String>,
    record: ::csv::ByteRecord,
    /// Rows whose first cell is no time, and the first such cell.
    timeless: usize,
    first_timeless: String,
}

impl Table {
    fn open(path: &Path) -> Result<Self, InputError> {
        let mut start = Vec::new();
        let _ = content(path)?.take(4096).read_to_end(&mut start);
        let (separator, is_quoted) = dialect(&start).unwrap_or((b';', false));
        let mut builder = ::csv::ReaderBuilder::new();
        builder.delimiter(separator).flexible(true).quoting(is_quoted).trim(::csv::Trim::All);
        let mut reader = builder.from_reader(content(path)?);
        let header = reader.byte_headers().map_err(|error| unreadable(path, &error))?;
        let columns = header.iter().map(|cell| String::from_utf8_lossy(cell).trim_start_matches('\u{feff}').to_owned());
        let columns = columns.collect();
        Ok(Table {
            path: path.to_owned(),
            reader,
            columns,
            record: ::csv::ByteRecord::new(),
            timeless: 0,
            first_timeless: String::new(),
        })
    }

    /// The next row with a time; nothing at the end.
    fn next_row(&mut self) -> Result<Option<(f64, &::csv::ByteRecord)>, InputError> {
        loop {
            match self.reader.read_byte_record(&mut self.record) {
                Ok(true) => {}
                Ok(false) => return Ok(None),
                Err(error) => return Err(unreadable(&self.path, &error)),
            }
            let cell = String::from_utf8_lossy(self.record.get(0).unwrap_or(b"")).into_owned();
            if let Some(time) = unix_s(&cell) {
                return Ok(Some((time, &self.record)));
            }
            if !cell.trim().is_empty() {
                if self.timeless == 0 {
                    self.first_timeless = printable(cell.trim());
                }
                self.timeless += 1;
            }
        }
    }

    /// All rows. What is damaged is left out and counted; a file that ends too early is read as far as it goes.
    fn whole(&mut self, warnings: &mut Vec<String>) -> Result<Whole, InputError> {
        let mut whole = Whole {
            columns: self.columns.clone(),
            times: Vec::new(),
            values: vec![Vec::new(); self.columns.len()],
            pings: Vec::new(),
        };
        let name = printable(&self.path.to_string_lossy());
        let clock = self.columns.iter().position(|column| column == "AD2CP_TIME");
        let width = self.columns.iter().filter(|column| !column.is_empty()).count();
        let (mut wrong, mut short, mut first_wrong) = (0usize, 0usize, String::new());
        loop {
            let (time, record) = match self.next_row() {
                Ok(Some(row)) => row,
                Ok(None) => break,
                Err(error) if whole.times.is_empty() => return Err(error),
                Err(error) => {
                    warnings.push(format!("read as far as it goes: {error}"));
                    break;
                }
            };
            short += usize::from(record.len() < width);
            whole.times.push(time);
            whole.pings.push(
                clock.and_then(|cell| ping_time(std::str::from_utf8(record.get(cell)?).ok()?)).unwrap_or(f64::NAN),
            );
            let Whole { columns, values: all, .. } = &mut whole;
            for (cell, values) in all.iter_mut().enumerate() {
                let text = record.get(cell).unwrap_or(b"");
                let value = super::csv::number(text);
                if value.is_none() && cell > 0 && Some(cell) != clock {
                    if wrong == 0 {
                        first_wrong = format!(
                            "`{}` in `{}`",
                            printable(&String::from_utf8_lossy(text)),
                            printable(&columns[cell])
                        );
                    }
                    wrong += 1;
                }
                values.push(value.filter(|value| *value != MISSING).unwrap_or(f64::NAN));
            }
        }
        if self.timeless > 0 {
            let problem = format!(
                "{} rows begin with no time and were left out, the first with `{}`",
                self.timeless, self.first_timeless
            );
            let help = "a SeaExplorer writes DD/MM/YYYY HH:MM:SS";
            // Headers of files that were put one behind the other are no loss.
            if whole.times.is_empty() {
                return Err(InputError::new(Place::file(&self.path), problem).help(help));
            }
            if !self.columns.contains(&self.first_timeless) {
                warnings.push(format!("{name}: {problem}; {help}"));
            }
        }
        if wrong > 0 {
            warnings
                .push(format!("{name}: {wrong} cells are no numbers and were left out, the first is {first_wrong}"));
        }
        if short > 0 {
            warnings
                .push(format!("{name}: {short} rows have fewer cells than the line of names; was the file cut off?"));
        }
        Ok(whole)
    }
}

/// A whole table.
struct Whole {
    columns: Vec<String>,
    times: Vec<f64>,
    values: Vec<Vec<f64>>,
    /// The times of the current profiler's own pings.
    pings: Vec<f64>,
}

impl Whole {
    fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().position(|column| column == name).map(|cell| &self.values[cell][..])
    }

    /// The values of a column that are there, with their times.
    fn series(&self, name: &str) -> Option<(Vec<f64>, Vec<f64>)> {
        let column = self.column(name)?;
        Some(self.times.iter().zip(column).filter(|(_, value)| value.is_finite()).map(|(t, v)| (*t, *v)).unzip())
    }

    /// Positions at the surface that were received there, and not reckoned or carried over from before the dive.
    fn fixes(&self, positions: &mut Positions) -> Vec<GpsFix> {
        let (Some(state), Some(lat), Some(lon)) = (self.column("NavState"), self.column("Lat"), self.column("Lon"))
        else {
            return Vec::new();
        };
        let reckoned = self.column("DeadReckoning");
        positions.begin_file();
        let rows = (0..self.times.len()).filter(|&row| lat[row].is_finite() && lon[row].is_finite());
        let received = rows.filter(|&row| {
            let is_reckoned = reckoned.is_some_and(|column| column[row] != 0.0);
            positions.is_received(lat[row], lon[row], state[row] == SURFACE && !is_reckoned)
        });
        received.filter_map(|row| GpsFix::new(self.times[row], degrees(lat[row]), degrees(lon[row]))).collect()
    }

    /// The speed by the nearest cell of the current profiler's four beams: two fore and aft at 47.5 deg from its axis, two to
    /// the sides at 25 deg.
    fn pings(&self, pressure: &Readings) -> Option<Vec<Ping>> {
        let beams: Vec<&[f64]> = (1..=4).filter_map(|beam| self.column(&format!("AD2CP_V{beam}_CN1"))).collect();
        let [fore, side, aft, other] = beams[..] else { return None };
        let pitch = self.column("AD2CP_PITCH")?;
        let rows = (0..self.times.len()).filter(|&row| self.pings[row].is_finite());
        let pings = rows.filter_map(|row| {
            let beams = [fore[row], side[row], aft[row], other[row]];
            ad2cp::of_four_beams(self.pings[row], beams, pitch[row].to_radians(), pressure)
        });
        let mut pings: Vec<Ping> = pings.collect();
        pings.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        pings.dedup_by(|later, earlier| later.time_s <= earlier.time_s);
        Some(pings)
    }
}

/// `MMDDYY HH:MM:SS`, the profiler's own clock.
fn ping_time(text: &str) -> Option<f64> {
    let (date, clock) = text.trim().split_once(' ')?;
    if date.len() != 6 || !date.bytes().all(|digit| digit.is_ascii_digit()) {
        return None;
    }
    unix_s(&format!("20{}-{}-{}T{clock}", &date[4..6], &date[..2], &date[2..4]))
}

fn unreadable(path: &Path, error: &::csv::Error) -> InputError {
    let place = match error.position() {
        Some(position) => Place::line(path, position.line() as usize),
        None => Place::file(path),
    };
    InputError::new(place, format!("not readable: {}", printable(&error.to_string()))).help("was the file cut off?")
}
