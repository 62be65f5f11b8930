//! Seaglider basestation files, one NetCDF file a dive (`p*.nc`), of every version of the basestation.
//!
//! Each instrument stands on a dimension of its own, with times of its own. The rows of the log are the readings of
//! pressure: on the glider's clock where it has them, else on that of the CTD. Everything else is brought to these times
//! by straight lines: temperature and salinity from the CTD's clock, attitude and ballast from the glider's. A file whose
//! instruments share one dimension passes as it is.
//!
//! Angles are degrees, the pitch mass is in cm and positive nose up. Temperature and salinity are those that passed the
//! basestation's quality control, the raw ones where it gave none. A motor moves from `gc_st_secs` to `gc_end_secs`.

use std::path::Path;

use netcdf_reader::NcFile;

use super::ad2cp;
use super::calibration::Calibration;
use super::channels::{CHANNELS, Channel, FlightLog};
use super::columns::Columns;
use super::fix::GpsFix;
use super::netcdf::{attribute_f64, attribute_text, first, has, missing, of_length, open, scalar, units, values};
use super::resample::{Readings, at_rows};
use super::units::{self, Conversion};
use glidepolar_input::{InputError, Place, printable};

/// Time around a motor's move in which the record still shows it \[s\].
const MOVE_MARGIN_S: f64 = 6.0;

/// What makes a basestation file one.
const BALLAST: &str = "eng_vbdCC";

/// The record of one dive.
pub(super) struct Dive {
    pub(super) log: FlightLog,
    pub(super) fixes: Vec<GpsFix>,
    /// What was found in it, as sentences that name no file.
    pub(super) notes: Vec<String>,
}

/// Whether the file is one of the basestation's.
pub(super) fn is_one(file: &NcFile) -> bool {
    has(file, "eng_pitchAng") && (has(file, BALLAST) || has(file, "log_C_VBD") || has(file, "gc_st_secs"))
}

/// Reads the record of one dive.
///
/// # Errors
/// A variable that is missing or of the wrong length, a file that is no NetCDF.
pub(super) fn read(path: &Path, columns: &Columns) -> Result<Dive, InputError> {
    let file = open(path)?;
    let clocks = Clocks::read(path, &file)?;
    let mut notes = Vec::new();
    let pressure = pressure(path, &clocks, columns)?;
    let (rows, speed) = match columns.chosen(Channel::Speed) {
        Some(ad2cp::NAME) => {
            let found = ad2cp::read(path, &file, &Readings::new(&pressure.times, &pressure.values), &mut notes)?;
            (ad2cp::rows(&pressure.times, &found), found)
        }
        _ => (pressure.times.clone(), Vec::new()),
    };
    let mut log = FlightLog::default();
    log.set(Channel::Time, rows.clone());
    log.set(Channel::Pressure, pressure.at(&rows));
    for (channel, names, unit) in CHANNELS_OF_FILES {
        let is_chosen = columns.chosen(*channel).filter(|name| *name != ad2cp::NAME);
        let is_needed = matches!(channel, Channel::Pitch | Channel::Ballast);
        let found = match is_chosen {
            Some(name) if !has(&file, name) => return Err(no_variable(path, *channel, name)),
            Some(name) => clocks.instrument(&[name])?,
            None if is_needed => clocks.instrument(names)?,
            // An instrument whose clock was lost costs its own record only.
            None => clocks.instrument(names).unwrap_or_else(|error| {
                notes.push(format!("left out: {}", error.problem));
                None
            }),
        };
        // What quality control took from the salinity does not come back by the conductivity.
        if *channel == Channel::Conductivity && is_chosen.is_none() && log.has(Channel::Salinity) {
            continue;
        }
        let Some(found) = found else { continue };
        let conversion =
            columns.unit(*channel).map_or_else(|| stated(path, &file, *channel, &found.name, *unit), Ok)?;
        let found = found.without_fill(*channel).converted(conversion);
        log.set(*channel, at_rows(*channel, &rows, &found.times, &found.values));
    }
    for (channel, what) in [(Channel::Pitch, "pitch"), (Channel::Ballast, "ballast volume")] {
        if log.column(channel).is_empty() {
            let names =
                CHANNELS_OF_FILES.iter().find(|(named, ..)| *named == channel).map_or(&[][..], |(_, names, _)| names);
            return Err(missing(path, what, names));
        }
    }
    water(&clocks, columns, &mut log, &rows, &mut notes)?;
    if !speed.is_empty() {
        log.set(Channel::Speed, ad2cp::column(&rows, &speed));
    }
    let moves = moves(path, &file)?;
    log.set(Channel::MotorMoving, motor_moving(&moves, &rows));
    if !moves.is_empty() {
        log.set(Channel::SinceMove, since_move_s(&moves, &rows));
    }
    log.set(Channel::Dive, vec![dive_number(&file).unwrap_or(f64::NAN); rows.len()]);
    Ok(Dive { log, fixes: fixes(path, &file)?, notes })
}

/// Where the channels are found, the best name first, and the unit in which the basestation has them.
const CHANNELS_OF_FILES: &[(Channel, &[&str], Conversion)] = &[
    (Channel::Pitch, &["eng_pitchAng"], Conversion::by(DEG)),
    (Channel::Ballast, &[BALLAST], Conversion::NONE),
    (Channel::Roll, &["eng_rollAng"], Conversion::by(DEG)),
    (Channel::Heading, &["eng_head"], Conversion::by(DEG)),
    (Channel::PitchMass, &["eng_pitchCtl"], Conversion::by(0.01)),
    // To starboard positive: the roll follows it by half of its angle on all files that have both.
    (Channel::RollMass, &["eng_rollCtl"], Conversion::by(DEG)),
    (
        Channel::Temperature,
        &["temperature", "temperature_raw", "legato_temp", "legato_temperature", "gpctd_temperature"],
        Conversion::NONE,
    ),
    (Channel::Salinity, &["salinity", "salinity_raw", "legato_salinity", "gpctd_salinity"], Conversion::NONE),
    (Channel::Latitude, &["latitude", "latitude_gsm"], Conversion::NONE),
    (Channel::Longitude, &["longitude", "longitude_gsm"], Conversion::NONE),
    (Channel::Density, &[], Conversion::NONE),
    (Channel::CurrentEast, &[], Conversion::NONE),
    (Channel::CurrentNorth, &[], Conversion::NONE),
    (
        Channel::Conductivity,
        &["conductivity", "conductivity_raw", "legato_conductivity", "gpctd_conductivity"],
        Conversion::NONE,
    ),
    (Channel::Rudder, &[], Conversion::by(DEG)),
    (Channel::BatteryPosition, &[], Conversion::NONE),
    (Channel::Speed, &[], Conversion::NONE),
];

const DEG: f64 = std::f64::consts::PI / 180.0;

/// Readings of one instrument at its own times.
struct Instrument {
    name: String,
    times: Vec<f64>,
    values: Vec<f64>,
}

impl Instrument {
    fn converted(mut self, conversion: Conversion) -> Self {
        self.values.iter_mut().for_each(|value| *value = conversion.convert(*value));
        self
    }

    /// Numbers that stand for a missing value as NaN.
    fn without_fill(mut self, channel: Channel) -> Self {
        self.values.iter_mut().filter(|value| units::is_fill(channel, **value)).for_each(|value| *value = f64::NAN);
        self
    }

    /// At the rows of the log, by straight lines.
    fn at(&self, rows: &[f64]) -> Vec<f64> {
        if rows == self.times { self.values.clone() } else { Readings::new(&self.times, &self.values).at_all(rows) }
    }
}

/// The times that belong to the dimensions of a file.
struct Clocks<'a> {
    path: &'a Path,
    file: &'a NcFile,
    /// Dimension, its times.
    known: Vec<(String, Vec<f64>)>,
}

impl<'a> Clocks<'a> {
    /// Finds for each dimension the variable with its times: `time`, `ctd_time`, or another that ends so and counts
    /// seconds since 1970.
    fn read(path: &'a Path, file: &'a NcFile) -> Result<Self, InputError> {
        let mut clocks = Clocks { path, file, known: Vec::new() };
        let variables = file.variables().unwrap_or_default();
        let named = ["time", "ctd_time", "epoch_time", "ctd_epoch_time"]
            .into_iter()
            .filter(|name| has(file, name))
            .map(str::to_owned);
        let others = variables
            .iter()
            .filter(|variable| variable.name().ends_with("_time") && units(file, variable.name()).contains(" since "))
            .map(|variable| variable.name().to_owned());
        for name in named.chain(others) {
            let Some(dimension) = dimension(file, &name) else { continue };
            if clocks.known.iter().all(|(known, _)| *known != dimension) {
                clocks.known.push((dimension, times(path, file, &name)?));
            }
        }
        clocks.by_seconds_of_the_dive()?;
        if clocks.known.is_empty() {
            return Err(missing(path, "time", &["time", "ctd_time"]));
        }
        Ok(clocks)
    }

    /// Files that were never processed have seconds since the dive began, and that time as an attribute.
    fn by_seconds_of_the_dive(&mut self) -> Result<(), InputError> {
        const ELAPSED: &str = "eng_elaps_t";
        let Some(dimension) = dimension(self.file, ELAPSED) else { return Ok(()) };
        if self.known.iter().any(|(known, _)| *known == dimension) {
            return Ok(());
        }
        let start_s = attribute_f64(self.file, "start_time").or_else(|| scalar(self.file, "start_time"));
        let Some(start_s) = start_s else { return Ok(()) };
        let elapsed = values(self.path, self.file, ELAPSED)?;
        self.known.insert(0, (dimension, elapsed.into_iter().map(|seconds| start_s + seconds).collect()));
        Ok(())
    }

    /// The first of these variables that is there and has a value, with its times.
    fn instrument(&self, names: &[&str]) -> Result<Option<Instrument>, InputError> {
        for name in names.iter().filter(|name| has(self.file, name)) {
            let values = values(self.path, self.file, name)?;
            if !values.iter().any(|value| value.is_finite()) && name != &names[names.len() - 1] {
                continue;
            }
            let dimension = dimension(self.file, name);
            let of_dimension = self.known.iter().find(|(known, _)| Some(known) == dimension.as_ref());
            // Without dimensions in common: the first clock of as many times.
            let times = match of_dimension.or_else(|| self.known.iter().find(|(_, times)| times.len() == values.len()))
            {
                Some((_, times)) => times.clone(),
                None => return Err(self.without_clock(name, values.len())),
            };
            let values = of_length(self.path, name, values, times.len())?;
            return Ok(Some(Instrument { name: (*name).to_owned(), times, values }));
        }
        Ok(None)
    }
}

impl Clocks<'_> {
    /// What to say of a variable that none of the clocks belongs to.
    fn without_clock(&self, name: &str, values: usize) -> InputError {
        let clocks: Vec<String> = self
            .known
            .iter()
            .map(|(dimension, times)| format!("`{}` has {}", printable(dimension), times.len()))
            .collect();
        let problem = format!(
            "variable `{}` has {values} values and no clock: of the dimensions with times {}",
            printable(name),
            clocks.join(", ")
        );
        InputError::new(Place::file(self.path), problem)
            .help("expected a variable with its times, as `time` or `ctd_time`")
    }
}

/// The times in a variable, from the day that its unit states; seconds since 1970 where it states none.
fn times(path: &Path, file: &NcFile, name: &str) -> Result<Vec<f64>, InputError> {
    let unit = units(file, name);
    let conversion = match units::conversion(Channel::Time, &unit) {
        Some(conversion) => conversion,
        None if unit.is_empty() => Conversion::NONE,
        None => {
            let problem = format!("times `{}` are in `{}`, which is not known", printable(name), printable(&unit));
            return Err(InputError::new(Place::file(path), problem));
        }
    };
    Ok(values(path, file, name)?.into_iter().map(|time| conversion.convert(time)).collect())
}

/// The name of the only dimension of a variable.
fn dimension(file: &NcFile, name: &str) -> Option<String> {
    match file.variable(name).ok()?.dimensions() {
        [only] => Some(only.name.clone()),
        _ => None,
    }
}

/// The readings of pressure, on whose times the rows of the log stand.
fn pressure(path: &Path, clocks: &Clocks<'_>, columns: &Columns) -> Result<Instrument, InputError> {
    // `pressure` is what the glider's own sensor read; `ctd_pressure` is brought from there to the times and the place of
    // the CTD. On one clock the latter belongs to the temperature beside it.
    let one_clock = dimension(clocks.file, "pressure") == dimension(clocks.file, "ctd_pressure");
    let names = match one_clock {
        true => ["ctd_pressure", "pressure", "legato_pressure", "gpctd_pressure"],
        false => ["pressure", "ctd_pressure", "legato_pressure", "gpctd_pressure"],
    };
    // A program that rewrites a basestation's file may write another unit; one that is no pressure is a label gone wrong.
    let in_dbar = |found: Instrument| {
        let stated = || units::conversion(Channel::Pressure, &units(clocks.file, &found.name));
        let conversion = columns.unit(Channel::Pressure).or_else(stated).unwrap_or(Conversion::NONE);
        found.without_fill(Channel::Pressure).converted(conversion)
    };
    if let Some(name) = columns.chosen(Channel::Pressure) {
        let found = clocks.instrument(&[name])?.ok_or_else(|| no_variable(path, Channel::Pressure, name))?;
        return Ok(in_dbar(found));
    }
    if let Some(found) = clocks.instrument(&names)? {
        return Ok(in_dbar(found));
    }
    // Files that were never processed have the depth only, in cm; 1 m is 1.0055 dbar in the basestation's own sea water.
    for (name, metres) in [("depth", 1.0), ("eng_depth", 0.01)] {
        if let Some(found) = clocks.instrument(&[name])? {
            return Ok(found.converted(Conversion::by(metres * 1.0055)));
        }
    }
    Err(missing(path, "pressure", &["pressure", "ctd_pressure", "depth"]))
}

/// Where quality control took too much away, the raw record is better than none; where there is none at all, it is said.
fn water(
    clocks: &Clocks<'_>,
    columns: &Columns,
    log: &mut FlightLog,
    rows: &[f64],
    notes: &mut Vec<String>,
) -> Result<(), InputError> {
    for (channel, raw) in [(Channel::Temperature, "temperature_raw"), (Channel::Salinity, "salinity_raw")] {
        if columns.chosen(channel).is_some() {
            continue;
        }
        let good = log.column(channel).iter().filter(|value| value.is_finite()).count();
        if 2 * good >= rows.len() {
            continue;
        }
        let Some(raw) = clocks.instrument(&[raw])? else { continue };
        let raw = raw.at(rows);
        // A CTD that was off for half of a dive is no reason.
        if raw.iter().filter(|value| value.is_finite()).count() > 2 * good {
            log.set(channel, raw);
        }
    }
    let has = |channel: Channel| log.has(channel);
    let has_salt = has(Channel::Salinity) || has(Channel::Conductivity);
    let has_water = has(Channel::Density) || (has(Channel::Temperature) && has_salt);
    if !has_water {
        notes.push("no record of the CTD, so no density of its own: it is used only with --density".to_owned());
    }
    Ok(())
}

/// What the file states of a unit, else the basestation's own.
fn stated(path: &Path, file: &NcFile, channel: Channel, name: &str, own: Conversion) -> Result<Conversion, InputError> {
    let unit = units(file, name);
    // The basestation states none of its engineering units, and wrong ones of others (`g/m^3` beside kg/m3).
    let is_own = CHANNELS_OF_FILES.iter().any(|(_, names, _)| names.contains(&name));
    if unit.is_empty() || is_own {
        return Ok(own);
    }
    units::conversion(channel, &unit).ok_or_else(|| {
        let problem =
            format!("variable `{}` is in `{}`, a unit that is not known here", printable(name), printable(&unit));
        let option = CHANNELS[channel as usize].name;
        InputError::new(Place::file(path), problem).help(format!("state it by --unit {option}=UNIT"))
    })
}

fn no_variable(path: &Path, channel: Channel, name: &str) -> InputError {
    missing(path, CHANNELS[channel as usize].meaning, &[name])
}

/// Starts and ends of the moves of the motors \[s\].
fn moves(path: &Path, file: &NcFile) -> Result<Vec<(f64, f64)>, InputError> {
    let starts = first(path, file, &["gc_st_secs"])?.unwrap_or_default();
    let ends = first(path, file, &["gc_end_secs"])?.unwrap_or_default();
    Ok(starts.into_iter().zip(ends).collect())
}

fn motor_moving(moves: &[(f64, f64)], time: &[f64]) -> Vec<f64> {
    let moving = |t: f64| moves.iter().any(|&(start, end)| (start - MOVE_MARGIN_S..=end + MOVE_MARGIN_S).contains(&t));
    time.iter().map(|&t| f64::from(u8::from(moving(t)))).collect()
}

/// Many a move begins and ends between two samples, and no sample has its flag.
fn since_move_s(moves: &[(f64, f64)], time: &[f64]) -> Vec<f64> {
    let of = |t: f64| {
        let begun = moves.iter().filter(|(start, _)| *start <= t);
        begun.map(|(_, end)| (t - end).max(0.0)).min_by(f64::total_cmp).unwrap_or(f64::NAN)
    };
    time.iter().map(|&t| of(t)).collect()
}

/// The positions before the dive and after it.
fn fixes(path: &Path, file: &NcFile) -> Result<Vec<GpsFix>, InputError> {
    let mut columns = Vec::new();
    for names in [["log_gps_time", "gps_time"], ["log_gps_lat", "gps_lat"], ["log_gps_lon", "gps_lon"]] {
        match names.into_iter().find(|name| has(file, name)) {
            Some(name) if columns.is_empty() => columns.push(times(path, file, name)?),
            Some(name) => columns.push(values(path, file, name)?),
            None => return Ok(Vec::new()),
        }
    }
    let rows = columns[0].iter().zip(&columns[1]).zip(&columns[2]);
    Ok(rows.filter_map(|((&time, &lat), &lon)| GpsFix::new(time, lat, lon)).collect())
}

fn dive_number(file: &NcFile) -> Option<f64> {
    attribute_f64(file, "dive_number").or_else(|| scalar(file, "log_DIVE"))
}

/// What is known of a file before its record is read: enough to put dives in order.
pub(super) struct Headline {
    /// When the dive began \[s\].
    pub(super) start_s: f64,
    pub(super) calibration: Calibration,
}

/// Reads the headline of a dive.
///
/// # Errors
/// A file without any time.
pub(super) fn headline(path: &Path, file: &NcFile) -> Result<Headline, InputError> {
    let clocks = Clocks::read(path, file)?;
    let start_s = clocks.known[0].1.iter().copied().find(|time| time.is_finite());
    let start_s = start_s.ok_or_else(|| {
        InputError::new(Place::file(path), "not a single time in it").help("was the dive aborted, or the file cut off?")
    })?;
    let number = |name: &str| scalar(file, name);
    // The basestation keeps volumes in cm3 under a label of m3.
    let volume = |value: f64| if value > 1.0 { value * 1e-6 } else { value };
    let density = |value: f64| if value < 100.0 { value * 1000.0 } else { value };
    let glider = attribute_text(file, "platform_id")
        .filter(|name| !name.is_empty())
        .or_else(|| number("log_ID").or_else(|| attribute_f64(file, "glider")).map(|id| format!("SG{id:03}")));
    let declination = first(path, file, &["log_gps_magvar"])?.unwrap_or_default();
    let calibration = Calibration {
        glider: glider.unwrap_or_default(),
        dive: dive_number(file),
        mass_kg: number("sg_cal_mass").or_else(|| number("log_MASS").map(|grams| grams * 1e-3)),
        volmax_m3: number("sg_cal_volmax").map(volume),
        hd_a: number("sg_cal_hd_a").or_else(|| number("log_HD_A")),
        hd_b: number("sg_cal_hd_b").or_else(|| number("log_HD_B")),
        hd_c: number("sg_cal_hd_c").or_else(|| number("log_HD_C")),
        hd_s: number("sg_cal_hd_s"),
        length_m: number("sg_cal_glider_length"),
        rho0_kg_m3: number("sg_cal_rho0"),
        log_rho_kg_m3: number("log_RHO").map(density),
        c_vbd_counts: number("log_C_VBD"),
        vbd_min_counts: number("log_VBD_MIN"),
        vbd_cc_per_count: number("log_VBD_CNV"),
        vbd_bias_cc: number("sg_cal_vbdbias"),
        compressibility_1_dbar: number("sg_cal_abs_compress"),
        thermal_expansion_1_K: number("sg_cal_therm_expan"),
        reference_temperature_C: number("sg_cal_temp_ref"),
        c_roll_dive_counts: number("log_C_ROLL_DIVE"),
        c_roll_climb_counts: number("log_C_ROLL_CLIMB"),
        roll_deg_per_count: number("log_ROLL_CNV"),
        declination_deg: declination.into_iter().rfind(|angle| angle.is_finite() && angle.abs() <= 180.0),
    };
    Ok(Headline { start_s, calibration })
}
