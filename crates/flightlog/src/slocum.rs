//! Files of Slocum gliders, binary or as the text of `dbd2asc`: flight and science file of a segment merged into one time
//! series.
//!
//! Flight computer and science computer write files of their own, each with its own clock, and each sensor is read when it
//! is its turn. The rows of the log are the readings of pressure, the CTD's where the segment has them and the glider's own
//! elsewhere; all else is brought to these times by straight lines.
//!
//! Pressures are bar, angles radians, battery positions inches, positions `DDMM.mmm`. A value that the glider read again and
//! found unchanged is a reading as well. The first cycle of a binary file has the last value of every sensor, however old, at
//! the time when the file was opened: it is no reading, and left out. The second may say of some that they are unchanged:
//! positions are fixes only where they change after that. `dbd2asc` leaves the first cycle out by itself.

use std::io::Read;
use std::path::{Path, PathBuf};

use glidepolar_dbd::{Caches, Error, Reader};

use super::channels::{CHANNELS, Channel, FlightLog};
use super::columns::Columns;
use super::dinkum_ascii::{self, Table};
use super::fix::{GpsFix, Positions, degrees};
use super::resample::{at_rows, pressure_rows};
use super::slocum_readings::Sensors;
use super::units::{self, Conversion};
use glidepolar_input::{InputError, Place, printable};

/// Where channels are found, the best sensor first, and the unit in which gliders have them.
const SENSORS: &[(Channel, &[&str], f64)] = &[
    (Channel::Pitch, &["m_pitch"], 1.0),
    (Channel::Ballast, &["m_ballast_pumped", "m_de_oil_vol"], 1.0),
    (Channel::Roll, &["m_roll"], 1.0),
    (Channel::Heading, &["m_heading"], 1.0),
    (Channel::Rudder, &["m_fin"], 1.0),
    (Channel::BatteryPosition, &["m_battpos"], 0.0254),
    (Channel::Temperature, &["sci_water_temp", "sci_rbrctd_temperature_00", "m_water_temp"], 1.0),
    (Channel::Conductivity, &["sci_water_cond", "m_water_cond"], 1.0),
    // The RBR's own sensors: mS/cm and dbar, where the Seabird's are S/m and bar.
    (Channel::Conductivity, &["sci_rbrctd_conductivity_00"], 0.1),
    (Channel::Charge, &["m_coulomb_amphr_total", "m_coulomb_amphr"], 1.0),
    (Channel::Voltage, &["m_battery"], 1.0),
    (Channel::Latitude, &["m_lat"], 1.0),
    (Channel::Longitude, &["m_lon"], 1.0),
    (Channel::Salinity, &[], 1.0),
    (Channel::Density, &[], 1.0),
    (Channel::Speed, &[], 1.0),
];

/// Pressure of the CTD, then of the glider; bar to dbar.
const PRESSURES: [&str; 3] = ["sci_water_pressure", "m_pressure", "m_water_pressure"];
const RBR_PRESSURE: &str = "sci_rbrctd_pressure_00";
const BAR: f64 = 10.0;

/// Depth, where no pressure is stored; 1 m of sea water of 1025 kg/m3 is 1.0055 dbar.
const DEPTH: &str = "m_depth";
const DBAR_PER_M: f64 = 1.0055;

/// The clocks of both computers.
const CLOCKS: [&str; 2] = ["m_present_time", "sci_m_present_time"];

/// Cycles of one file that are held at once.
const CYCLES: usize = 200_000;

/// Times that a glider can have \[s\].
const TIMES: std::ops::Range<f64> = 1e8..5e9;

/// What a file is, before it is read.
pub(super) struct Headline {
    pub(super) glider: String,
    pub(super) segment: String,
    pub(super) start_s: f64,
    /// How full a record of its computer it is: `dbd` before `mbd` before `sbd`; and of which computer.
    pub(super) rank: u8,
    pub(super) is_science: bool,
}

/// Whether a file is one of a Slocum's, compressed or not.
pub(super) fn is_one(path: &Path) -> Result<bool, InputError> {
    let start = start(path)?;
    Ok(glidepolar_dbd::is_one(&start) || dinkum_ascii::is_half_a_table(&start))
}

/// The first bytes of a file, a line of names among them.
fn start(path: &Path) -> Result<Vec<u8>, InputError> {
    let mut start = Vec::new();
    let file = std::fs::File::open(path).map_err(|error| InputError::io(path, &error))?;
    file.take(1 << 16).read_to_end(&mut start).map_err(|error| InputError::io(path, &error))?;
    Ok(start)
}

/// The cycles of a file, whatever its kind.
enum Cycles {
    Binary(Box<Reader>),
    Text(Box<Table>),
}

impl Cycles {
    fn open(path: &Path, columns: &Columns) -> Result<Self, InputError> {
        let start = start(path)?;
        if dinkum_ascii::is_one(&start) || dinkum_ascii::is_half_a_table(&start) {
            return Ok(Cycles::Text(Box::new(Table::open(path)?)));
        }
        let reader = Reader::open(path, &caches(columns)).map_err(|error| input(&error))?;
        Ok(Cycles::Binary(Box::new(reader)))
    }

    fn get(&self, key: &str) -> &str {
        match self {
            Cycles::Binary(reader) => reader.header().get(key),
            Cycles::Text(table) => table.get(key),
        }
    }

    /// The sensors with their units.
    fn sensors(&self) -> Vec<(String, String)> {
        match self {
            Cycles::Binary(reader) => reader.sensors().iter().map(|s| (s.name.clone(), s.unit.clone())).collect(),
            Cycles::Text(table) => table.sensors.clone(),
        }
    }

    fn select(&mut self, names: &[String]) {
        match self {
            Cycles::Binary(reader) => reader.select(names),
            Cycles::Text(table) => table.select(names),
        }
    }

    /// The next values, and whether they are those of the first cycle of a binary file.
    fn next(&mut self) -> Result<Option<(&[f64], bool)>, InputError> {
        match self {
            Cycles::Binary(reader) => {
                Ok(reader.next_cycle().map_err(|error| input(&error))?.map(|cycle| (cycle.values, cycle.is_first)))
            }
            Cycles::Text(table) => Ok(table.next_row()?.map(|values| (values, false))),
        }
    }

    fn damages(&self) -> Vec<String> {
        match self {
            Cycles::Binary(reader) => reader.damages().iter().map(ToString::to_string).collect(),
            Cycles::Text(table) => table.damages.clone(),
        }
    }
}

/// Reads the header of a file.
///
/// # Errors
/// A header that is damaged, a list of sensors that is not to be found.
pub(super) fn headline(path: &Path, columns: &Columns) -> Result<Headline, InputError> {
    let file = Cycles::open(path, columns)?;
    let sensors = file.sensors();
    let has = |name: &str| sensors.iter().any(|sensor| sensor.0 == name);
    // `unit-2025-056-0-27.sbd.csv`: the kind is in the name.
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let (stem, of_name) = match stem.rsplit_once('.') {
        Some((rest, kind)) if kind.len() == 3 && kind.to_lowercase().ends_with("bd") => (rest.to_owned(), kind),
        _ => (stem.clone(), ""),
    };
    let kind = Some(file.get("filename_extension")).filter(|kind| !kind.is_empty()).unwrap_or(of_name).to_lowercase();
    let (rank, is_science) = match kind.as_bytes().first() {
        Some(b'd') => (2, false),
        Some(b'm') => (1, false),
        Some(b's') => (0, false),
        Some(b'e') => (2, true),
        Some(b'n') => (1, true),
        Some(b't') => (0, true),
        _ => (0, !has("m_present_time")),
    };
    let named = |key: &str| Some(file.get(key)).filter(|name| !name.is_empty()).map(str::to_owned);
    let (glider, segment, start_s) = match &file {
        Cycles::Binary(reader) => {
            let header = reader.header();
            (header.glider().to_owned(), header.segment().to_owned(), header.opened_s().unwrap_or(f64::NAN))
        }
        Cycles::Text(_) => {
            let segment = named("segment_filename_0").or_else(|| named("filename")).unwrap_or_else(|| stem.clone());
            // `amadeus-2014-204-05-000`: the glider, then four numbers.
            let glider = segment.rsplitn(5, '-').nth(4).unwrap_or("").to_owned();
            (glider, segment, f64::NAN)
        }
    };
    let segment = if segment.is_empty() { stem } else { segment };
    // A text does not state in a form of its own when it was begun: its first cycle does.
    let start_s = if start_s.is_nan() { first_time(path, columns)? } else { start_s };
    Ok(Headline { glider, segment, start_s, rank, is_science })
}

/// The first time of a file that a glider can have \[s\].
fn first_time(path: &Path, columns: &Columns) -> Result<f64, InputError> {
    let mut file = Cycles::open(path, columns)?;
    file.select(&CLOCKS.map(str::to_owned));
    while let Some((values, _)) = file.next()? {
        if let Some(time) = values.iter().copied().find(|time| TIMES.contains(time)) {
            return Ok(time);
        }
    }
    Ok(f64::NAN)
}

fn caches(columns: &Columns) -> Caches {
    Caches::new(columns.caches().iter().cloned())
}

fn input(error: &Error) -> InputError {
    let place = error.place.to_string();
    let place = place.trim_start_matches(", ");
    let problem = if place.is_empty() { error.problem.clone() } else { format!("{place}: {}", error.problem) };
    let input = InputError::new(Place::file(&error.file), problem);
    match &error.help {
        Some(help) => input.help(help.clone()),
        None => input,
    }
}

/// A segment that is being read.
pub struct Segment {
    files: Vec<File>,
    columns: Columns,
    names: Vec<String>,
    has_begun: bool,
    has_rows: bool,
}

/// One of its files.
struct File {
    path: PathBuf,
    cycles: Cycles,
    ended: bool,
    /// A cycle that was read ahead of its time.
    next: Option<(f64, Vec<f64>)>,
    reported: usize,
    is_end_reported: bool,
    /// Whether the first cycle was read.
    has_begun: bool,
}

impl Segment {
    /// Opens the files of one segment: those of the flight computer, of the science computer, or both.
    ///
    /// # Errors
    /// A file that cannot be opened.
    pub(super) fn open(paths: &[PathBuf], columns: &Columns) -> Result<Self, InputError> {
        let mut names: Vec<String> =
            ["m_present_time", "sci_m_present_time", "m_gps_lat", "m_gps_lon", "m_gps_status", DEPTH]
                .into_iter()
                .chain(PRESSURES)
                .chain([RBR_PRESSURE])
                .chain(SENSORS.iter().flat_map(|(_, names, _)| names.iter().copied()))
                .map(str::to_owned)
                .collect();
        names.extend(CHANNELS.iter().filter_map(|info| columns.chosen(info.channel)).map(str::to_owned));
        let mut files = Vec::new();
        for path in paths {
            let mut cycles = Cycles::open(path, columns)?;
            cycles.select(&names);
            files.push(File {
                path: path.clone(),
                cycles,
                ended: false,
                next: None,
                reported: 0,
                is_end_reported: false,
                has_begun: false,
            });
        }
        Ok(Segment { files, columns: columns.clone(), names, has_begun: false, has_rows: false })
    }

    /// The next piece, its fixes, warnings and notes added to those that are there; nothing at the end.
    ///
    /// # Errors
    /// Where a file cannot be read any further.
    pub(super) fn next_piece(
        &mut self,
        positions: &mut Positions,
        fixes: &mut Vec<GpsFix>,
        warnings: &mut Vec<String>,
        notes: &mut Vec<String>,
    ) -> Result<Option<FlightLog>, InputError> {
        let mut readings = Sensors::new(self.names.len());
        // The first file that still has cycles leads; the others follow up to its time.
        let mut end_s = f64::INFINITY;
        let mut leads = true;
        for file in &mut self.files {
            if file.ended && file.next.is_none() {
                continue;
            }
            let last_s = file.collect(&mut readings, if leads { f64::INFINITY } else { end_s }, leads)?;
            if leads && !file.ended {
                end_s = last_s;
            }
            leads = false;
            file.report(warnings);
            notes.extend(file.cut_off());
        }
        if leads {
            return Ok(None);
        }
        readings.sort();
        if !std::mem::replace(&mut self.has_begun, true) {
            positions.begin_file();
        }
        fixes.extend(readings.fixes(positions));
        let log = self.log(&readings)?;
        if log.is_empty() && !self.has_rows && readings.is_some() {
            let files: Vec<String> = self.files.iter().map(|file| file.path.display().to_string()).collect();
            warnings.push(format!("{}: no pressure and no depth in it, left out", printable(&files.join(", "))));
        }
        self.has_rows |= !log.is_empty();
        Ok(Some(log))
    }

    fn log(&self, readings: &Sensors) -> Result<FlightLog, InputError> {
        let mut log = FlightLog::default();
        let Some((rows, pressure)) = self.pressure(readings) else { return Ok(log) };
        for &(channel, names, unit) in SENSORS {
            let chosen = self.columns.chosen(channel);
            if chosen.is_none() && !log.column(channel).is_empty() {
                continue;
            }
            let Some(sensor) = self.sensor(readings, chosen.map_or(names, |_| &[]), chosen) else { continue };
            let name = &self.names[sensor];
            let conversion = match (self.columns.unit(channel), chosen) {
                (Some(unit), _) => unit,
                (None, None) => Conversion::by(unit),
                (None, Some(_)) => self.stated(channel, name)?,
            };
            let (times, values) = readings.series(sensor);
            let is_position = matches!(channel, Channel::Latitude | Channel::Longitude) && chosen.is_none();
            let of = |value: f64| if is_position { degrees(value) } else { conversion.convert(value) };
            let values: Vec<f64> = values.iter().map(|value| of(*value)).collect();
            log.set(channel, at_rows(channel, &rows, &times, &values));
        }
        log.set(Channel::Pressure, pressure);
        log.set(Channel::Time, rows);
        Ok(log)
    }

    /// The times of the rows, and the pressure there.
    fn pressure(&self, readings: &Sensors) -> Option<(Vec<f64>, Vec<f64>)> {
        let of = |name: &str, factor: f64| -> Option<(Vec<f64>, Vec<f64>)> {
            let sensor = self.names.iter().position(|known| known == name)?;
            let (times, values) = readings.series(sensor);
            (times.len() > 1).then(|| (times, values.iter().map(|value| value * factor).collect()))
        };
        if let Some(name) = self.columns.chosen(Channel::Pressure) {
            let factor = self.columns.unit(Channel::Pressure).map_or(BAR, |unit| unit.factor);
            return of(name, factor);
        }
        let ctd = of(PRESSURES[0], BAR).or_else(|| of(RBR_PRESSURE, 1.0));
        let own = of(PRESSURES[1], BAR).or_else(|| of(DEPTH, DBAR_PER_M)).or_else(|| of(PRESSURES[2], BAR));
        pressure_rows(ctd, own)
    }

    /// The sensor that holds a channel: of several that were read, the one that moved most.
    fn sensor(&self, readings: &Sensors, names: &[&str], chosen: Option<&str>) -> Option<usize> {
        let found =
            names.iter().copied().chain(chosen).filter_map(|name| self.names.iter().position(|known| known == name));
        let range = |sensor: usize| {
            let values = || readings.values[sensor].iter().map(|(_, value)| *value);
            values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
        };
        let mut best: Option<(usize, f64)> = None;
        for sensor in found.filter(|sensor| !readings.values[*sensor].is_empty()) {
            if best.is_none_or(|(_, most)| range(sensor) > most) {
                best = Some((sensor, range(sensor)));
            }
        }
        best.map(|(sensor, _)| sensor)
    }

    /// The unit of a sensor that the user chose, as the file states it.
    fn stated(&self, channel: Channel, name: &str) -> Result<Conversion, InputError> {
        let sensor = |file: &File| file.cycles.sensors().into_iter().find(|sensor| sensor.0 == name);
        let Some((file, (_, unit))) = self.files.iter().find_map(|file| Some((file, sensor(file)?))) else {
            return Ok(Conversion::NONE);
        };
        // A table of CSV states no units.
        if unit.is_empty() || ["nodim", "enum", "bool"].contains(&unit.as_str()) {
            return Ok(Conversion::NONE);
        }
        units::conversion(channel, &unit).ok_or_else(|| {
            let problem =
                format!("sensor `{}` is in `{}`, a unit that is not known here", printable(name), printable(&unit));
            let option = CHANNELS[channel as usize].name;
            InputError::new(Place::file(&file.path), problem).help(format!("state it by --unit {option}=UNIT"))
        })
    }
}

impl File {
    /// Takes cycles up to a time, and of the file that leads no more than are held at once; the last time comes back.
    fn collect(&mut self, readings: &mut Sensors, end_s: f64, leads: bool) -> Result<f64, InputError> {
        let (mut last_s, mut cycles) = (f64::NEG_INFINITY, 0);
        if let Some((time, values)) = self.next.take() {
            if time > end_s {
                self.next = Some((time, values));
                return Ok(last_s);
            }
            readings.take(time, &values);
        }
        while !self.ended {
            if leads && cycles >= CYCLES {
                break;
            }
            let Some((values, is_no_reading)) = self.cycles.next()? else {
                self.ended = true;
                break;
            };
            cycles += 1;
            let is_first = !std::mem::replace(&mut self.has_begun, true);
            let time = if values[0].is_finite() { values[0] } else { values[1] };
            if !TIMES.contains(&time) {
                continue;
            }
            if is_no_reading {
                // The flight computer's file leads; it alone has positions.
                if leads {
                    readings.begin(time, values);
                }
                continue;
            }
            if time > end_s {
                self.next = Some((time, values.to_vec()));
                break;
            }
            last_s = last_s.max(time);
            if is_first && leads {
                readings.begin(time, values);
            }
            readings.take(time, values);
        }
        Ok(last_s)
    }

    /// Where a file that has ended does so within a cycle, once: a glider that surfaces ends its files like that.
    fn cut_off(&mut self) -> Option<String> {
        let Cycles::Binary(reader) = &self.cycles else { return None };
        let bytes = reader.cut_off().filter(|_| self.ended && !self.is_end_reported)?;
        self.is_end_reported = true;
        let name = printable(&self.path.to_string_lossy());
        Some(format!("{name}: cut off within a cycle, of which {bytes} bytes are left; all cycles before it are read"))
    }

    /// Adds what was damaged.
    fn report(&mut self, warnings: &mut Vec<String>) {
        let name = printable(&self.path.to_string_lossy());
        let damages = self.cycles.damages();
        warnings.extend(damages[self.reported..].iter().map(|damage| format!("{name}: {damage}")));
        self.reported = damages.len();
    }
}
