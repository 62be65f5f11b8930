//! Seaglider basestation files, one NetCDF file a dive (`p*.nc`).
//!
//! Angles are degrees, the pitch mass is in cm and positive nose up. Temperature and salinity are those that passed the
//! basestation's quality control, the raw ones where it gave none. A motor moves from `gc_st_secs` to `gc_end_secs`.

use std::path::Path;

use super::channels::{Channel, FlightLog};
use super::netcdf::{attribute_f64, first, has, missing, of_length, open};
use glidepolar_input::InputError;

/// Time around a motor's move in which the record still shows it \[s\].
const MOVE_MARGIN_S: f64 = 6.0;

/// What makes a basestation file one.
const BALLAST: &str = "eng_vbdCC";

/// Whether the file is one of the basestation's.
pub(super) fn is_one(path: &Path) -> Result<bool, InputError> {
    let file = open(path)?;
    Ok(has(&file, BALLAST) && has(&file, "eng_pitchAng"))
}

/// Reads the record of one dive.
///
/// # Errors
/// A variable that is missing or of the wrong length, a file that is no NetCDF.
pub(super) fn read(path: &Path) -> Result<FlightLog, InputError> {
    let file = open(path)?;
    let times = ["time", "ctd_time"];
    let time = first(path, &file, &times)?.ok_or_else(|| missing(path, "time", &times))?;
    let rows = time.len();
    let column = |names: &[&str], factor: f64| -> Result<Option<Vec<f64>>, InputError> {
        let Some(values) = first(path, &file, names)? else { return Ok(None) };
        let values = values.into_iter().map(|value| value * factor).collect();
        of_length(path, names[0], values, rows).map(Some)
    };
    let need =
        |what: &str, names: &[&str], factor: f64| column(names, factor)?.ok_or_else(|| missing(path, what, names));
    let degrees = std::f64::consts::PI / 180.0;

    let mut log = FlightLog::default();
    log.set(Channel::Pressure, need("pressure", &["ctd_pressure", "pressure"], 1.0)?);
    log.set(Channel::Pitch, need("pitch", &["eng_pitchAng"], degrees)?);
    log.set(Channel::Ballast, need("ballast volume", &[BALLAST], 1.0)?);
    for (channel, names, factor) in [
        (Channel::Roll, &["eng_rollAng"][..], degrees),
        (Channel::Heading, &["eng_head"], degrees),
        (Channel::PitchMass, &["eng_pitchCtl"], 0.01),
        (Channel::Temperature, &["temperature", "temperature_raw"], 1.0),
        (Channel::Salinity, &["salinity", "salinity_raw"], 1.0),
        (Channel::Latitude, &["latitude", "latitude_gsm"], 1.0),
        (Channel::Longitude, &["longitude", "longitude_gsm"], 1.0),
    ] {
        if let Some(values) = column(names, factor)? {
            log.set(channel, values);
        }
    }
    // Where quality control took too much away, the raw record is better than none.
    for (channel, raw) in [(Channel::Temperature, "temperature_raw"), (Channel::Salinity, "salinity_raw")] {
        let Some(raw) = column(&[raw], 1.0)? else { continue };
        let good = log.column(channel).iter().filter(|value| value.is_finite()).count();
        if 2 * good < rows {
            log.set(channel, raw);
        }
    }
    log.set(Channel::MotorMoving, motor_moving(path, &file, &time)?);
    log.set(Channel::Dive, vec![attribute_f64(&file, "dive_number").unwrap_or(f64::NAN); rows]);
    log.set(Channel::Time, time);
    Ok(log)
}

fn motor_moving(path: &Path, file: &netcdf_reader::NcFile, time: &[f64]) -> Result<Vec<f64>, InputError> {
    let starts = first(path, file, &["gc_st_secs"])?.unwrap_or_default();
    let ends = first(path, file, &["gc_end_secs"])?.unwrap_or_default();
    let moves: Vec<(f64, f64)> =
        starts.into_iter().zip(ends).map(|(start, end)| (start - MOVE_MARGIN_S, end + MOVE_MARGIN_S)).collect();
    let moving = |t: f64| moves.iter().any(|&(start, end)| (start..=end).contains(&t));
    Ok(time.iter().map(|&t| f64::from(u8::from(moving(t)))).collect())
}
