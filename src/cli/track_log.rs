//! A log as `glidepolar track` takes it: every row as it was recorded, and what dead reckoning needs of it.

use std::fmt::Write;
use std::path::PathBuf;

use super::reading::said;
use crate::diagnose::sea::consistency::DensityError;
use crate::input::{InputError, Place};
use crate::log::{
    CHANNELS, Channel, Columns, DBAR_PA, FlightLog, LogFiles, Piece, Shorten, in_situ_density_kg_m3, practical_salinity,
};
use crate::reading::{Gathering, ReadingError, check_pitch, no_density, no_rows, settings};
use crate::track::{Fix, Sample, Track};
use crate::vehicle::Vehicle;

/// Samples read at a time.
const PIECE_ROWS: usize = 100_000;

/// Longest time that a reading of a slow channel is kept [s].
const KEEP_S: f64 = 120.0;

/// A log as it was recorded, and what belongs to it.
pub(super) struct Read {
    pub log: FlightLog,
    /// The log as dead reckoning needs it.
    pub samples: Vec<Sample>,
    /// The vehicle where the log was recorded.
    pub vehicle: Vehicle,
    pub warnings: Vec<String>,
    /// What was found in the reading and done about it.
    pub notes: Vec<String>,
    /// Fixes and magnetic declination that the files themselves hold.
    pub fixes: Vec<Fix>,
    pub declination_deg: Option<f64>,
}

/// What a user states of a log.
pub(super) struct Stated<'a> {
    pub logs: &'a [PathBuf],
    pub columns: Columns,
    /// Density where the log gives none \[kg/m3\].
    pub density_kg_m3: Option<f64>,
}

/// The log as it was recorded. Beside it goes the way that the other commands take to their samples, so that what they
/// refuse is refused here, and what is doubtful comes back in words.
///
/// # Errors
/// What cannot be read, and a log that has no track; with what was warned of before.
pub(super) fn read(stated: &Stated<'_>, vehicle: Vehicle) -> Result<Read, ReadingError> {
    let mut files = LogFiles::open(stated.logs, &stated.columns)?;
    from_files(stated, vehicle, &mut files).map_err(|error| error.beside(files.warnings()))
}

fn from_files(stated: &Stated<'_>, vehicle: Vehicle, files: &mut LogFiles) -> Result<Read, ReadingError> {
    let logs = stated.logs;
    let mut log = FlightLog::default();
    let mut gathering = Gathering::new(logs.first().cloned(), settings(&vehicle, stated.density_kg_m3), Shorten::Means);
    while let Some(piece) = files.next_piece(PIECE_ROWS)? {
        match piece {
            Piece::Series(piece) => {
                log.append(&piece);
                gathering.push(*piece);
            }
            Piece::Glides(_) => {
                let error = InputError::new(Place::file(&logs[0]), "a table of glides has no track");
                return Err(error.help("name the log it was made from").into());
            }
        }
        said(gathering.progress(files));
    }
    let mut prepared = gathering.finish()?;
    check_pitch(&logs[0], &prepared.observations)?;
    let vehicle = prepared.located(vehicle)?;
    let (mut warnings, density_error) = prepared.checked(&vehicle)?;
    let samples = samples(stated, &log, density_error, files)?;
    warnings.splice(0..0, files.warnings().iter().cloned());
    let fixes = files
        .fixes()
        .iter()
        .map(|fix| Fix { time_s: fix.time_s, lat_deg: fix.lat_deg, lon_deg: fix.lon_deg })
        .collect();
    let declination_deg = files.calibration().and_then(|calibration| calibration.declination_deg);
    let notes = files.notes().iter().cloned().chain(prepared.notes).collect();
    Ok(Read { log, samples, vehicle, warnings, notes, fixes, declination_deg })
}

/// The log as dead reckoning needs it: slow channels kept until they are read again.
/// A density whose error the log itself shows is corrected as the other commands correct it.
fn samples(
    stated: &Stated<'_>,
    log: &FlightLog,
    density_error: Option<DensityError>,
    files: &LogFiles,
) -> Result<Vec<Sample>, InputError> {
    let name_of_log = &stated.logs[0];
    if log.is_empty() {
        return Err(no_rows(name_of_log));
    }
    for (channel, name) in [(Channel::Pitch, "pitch"), (Channel::Heading, "heading"), (Channel::Ballast, "ballast")] {
        if !log.has(channel) {
            let info = CHANNELS.iter().find(|info| info.channel == channel).map_or("", |info| info.name);
            let error = InputError::new(Place::file(name_of_log), format!("no {name}: expected a column `{info}`"));
            let help = files.help(channel);
            return Err(
                error.help(help.unwrap_or_else(|| "choose another column by --column CHANNEL=COLUMN".to_owned()))
            );
        }
    }
    let mut kept = [(f64::NEG_INFINITY, f64::NAN); CHANNELS.len()];
    let (mut samples, mut dive, mut latest_s) = (Vec::with_capacity(log.len()), 0, f64::NEG_INFINITY);
    let mut under_water = false;
    for row in 0..log.len() {
        let time_s = log.at(Channel::Time, row);
        // Backward clocks and missing times are left out: no way can be laid to them.
        if time_s.is_nan() || time_s <= latest_s {
            continue;
        }
        latest_s = time_s;
        let mut value = |channel: Channel| {
            let read = log.at(channel, row);
            let kept = &mut kept[channel as usize];
            if read.is_finite() {
                *kept = (time_s, read);
            }
            if time_s - kept.0 <= KEEP_S { kept.1 } else { f64::NAN }
        };
        let (pressure, temperature_C) = (value(Channel::Pressure), value(Channel::Temperature));
        let depth_m = match value(Channel::Depth) {
            depth if depth.is_finite() => depth,
            _ => pressure * DBAR_PA / (1025.0 * 9.81),
        };
        let (salinity, conductivity_S_m) = (value(Channel::Salinity), value(Channel::Conductivity));
        let salinity =
            if salinity.is_finite() { salinity } else { practical_salinity(conductivity_S_m, temperature_C, pressure) };
        let at_zero_pressure = density_error == Some(DensityError::AtZeroPressure);
        let density_kg_m3 = match value(Channel::Density) {
            density if density.is_finite() && !at_zero_pressure => match density_error {
                Some(DensityError::Bias(bias_kg_m3, _)) => density + bias_kg_m3,
                _ => density,
            },
            _ if salinity.is_finite() && temperature_C.is_finite() && pressure.is_finite() => {
                let (lat, lon) = (value(Channel::Latitude), value(Channel::Longitude));
                in_situ_density_kg_m3(salinity, temperature_C, pressure, lat, lon)
            }
            _ => stated.density_kg_m3.unwrap_or(f64::NAN),
        };
        let numbered = value(Channel::Dive);
        if numbered.is_finite() {
            dive = numbered as u32;
        } else if depth_m > 5.0 && !under_water {
            (dive, under_water) = (dive + 1, true);
        } else if depth_m < 2.0 {
            under_water = false;
        }
        samples.push(Sample {
            time_s,
            dive,
            depth_m,
            pitch_rad: value(Channel::Pitch),
            heading_rad: value(Channel::Heading),
            ballast_m3: value(Channel::Ballast) * 1e-6,
            density_kg_m3,
            temperature_C,
        });
    }
    if !samples.iter().any(|sample| sample.density_kg_m3.is_finite()) {
        return Err(no_density(name_of_log, files));
    }
    Ok(samples)
}

/// The log in its own columns, the speed of the polar among them, and the density that was taken where the log has none.
/// `samples` are those that the track was reckoned from.
pub(super) fn log_table(log: &FlightLog, track: &Track, samples: &[Sample]) -> String {
    let channels: Vec<_> =
        CHANNELS.iter().filter(|info| log.has(info.channel) && info.channel != Channel::Speed).collect();
    let names: Vec<&str> = channels.iter().map(|info| info.name).collect();
    let mut table = format!("# speed_through_water_m_s is the polar's, by glidepolar track\n{},", names.join(","));
    let adds_density = !log.has(Channel::Density);
    table.push_str(if adds_density { "density_kg_m3,speed_through_water_m_s\n" } else { "speed_through_water_m_s\n" });
    let mut points = track.points.iter().zip(samples).peekable();
    for row in 0..log.len() {
        for info in &channels {
            let value = log.at(info.channel, row);
            if value.is_finite() {
                let _ = write!(table, "{value}");
            }
            table.push(',');
        }
        let here = points.next_if(|(point, _)| point.time_s == log.at(Channel::Time, row));
        if adds_density {
            if let Some(density) = here.map(|(_, sample)| sample.density_kg_m3).filter(|density| density.is_finite()) {
                let _ = write!(table, "{density:.4}");
            }
            table.push(',');
        }
        if let Some(speed_m_s) = here.map(|(point, _)| point.speed_m_s).filter(|speed| speed.is_finite()) {
            let _ = write!(table, "{speed_m_s:.5}");
        }
        table.push('\n');
    }
    table
}
