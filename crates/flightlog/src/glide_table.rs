//! Tables with one row per descent or ascent, the mean of each leg, as the tank paper averages them.

use std::path::Path;

use super::channels::{CHANNELS, Channel};
use super::columns::Columns;
use super::csv::{Rows, header, not_a_number, number};
use super::observation::Observation;
use glidepolar_input::{InputError, Place};

/// The column that tells such a table from a time series: vertical velocity, positive up.
const VERTICAL_VELOCITY: &str = "w_m_s";

/// Whether the header is that of a table of glides.
pub(super) fn is_one(path: &Path) -> Result<bool, InputError> {
    let names = header(path, &mut Rows::open(path)?)?;
    let has = |name: &str| names.iter().any(|found| found == name);
    Ok(has(VERTICAL_VELOCITY) && (has("glide") || has("segment")))
}

/// Reads a table of glides. Rows without pitch, ballast volume or vertical velocity are left out.
///
/// # Errors
/// A missing column, or a cell that is no number, with its place.
pub fn read_glide_table(path: &Path, columns: &Columns) -> Result<Vec<Observation>, InputError> {
    let mut rows = Rows::open(path)?;
    let names = header(path, &mut rows)?;
    let line_of_names = rows.place();
    let position = |name: &str| names.iter().position(|found| found == name);
    // Where each channel stands, with the factor to its unit.
    let cell_of = |channel: Channel| {
        let info = &CHANNELS[channel as usize];
        if let Some(chosen) = columns.chosen(channel) {
            return position(chosen).map(|cell| (cell, 1.0));
        }
        std::iter::once((info.name, 1.0))
            .chain(info.aliases.iter().copied())
            .find_map(|(name, factor)| Some((position(name)?, factor)))
    };
    let need = |channel: Channel| {
        cell_of(channel).ok_or_else(|| {
            let problem = format!("no column `{}`", CHANNELS[channel as usize].name);
            InputError::new(line_of_names.clone(), problem)
                .help("a table of glides needs pitch, ballast volume and `w_m_s`")
        })
    };
    let (pitch, ballast) = (need(Channel::Pitch)?, need(Channel::Ballast)?);
    let w = position(VERTICAL_VELOCITY)
        .ok_or_else(|| InputError::new(line_of_names.clone(), format!("no column `{VERTICAL_VELOCITY}`")))?;
    let start = position("start_s").map(|cell| (cell, 1.0)).or_else(|| cell_of(Channel::Time));
    let duration = position("duration_s").map(|cell| (cell, 1.0));
    let depth = position("mean_depth_m").map(|cell| (cell, 1.0)).or_else(|| cell_of(Channel::Depth));
    let se = position("w_se_m_s").map(|cell| (cell, 1.0));
    let optional = [
        Channel::Pressure,
        Channel::Density,
        Channel::Temperature,
        Channel::Roll,
        Channel::Rudder,
        Channel::Heading,
        Channel::BatteryPosition,
        Channel::Speed,
    ]
    .map(cell_of);

    let mut glides: Vec<Observation> = Vec::new();
    let mut record = ::csv::ByteRecord::new();
    let mut first_time = f64::NAN;
    while rows.next(&mut record)? {
        let mut read = |at: Option<(usize, f64)>| -> Result<f64, InputError> {
            let Some((cell, factor)) = at else { return Ok(f64::NAN) };
            let text = record.get(cell).unwrap_or(b"");
            let value = number(text).map(|value| value * factor);
            value.ok_or_else(|| not_a_number(rows.place().column(cell + 1), &names[cell], text))
        };
        let (pitch_rad, vbd_cc, up) = (read(Some(pitch))?, read(Some(ballast))?, read(Some((w, 1.0)))?);
        if !(pitch_rad.is_finite() && vbd_cc.is_finite() && up.is_finite()) {
            continue;
        }
        let start_s = read(start)?;
        if first_time.is_nan() {
            first_time = start_s;
        }
        let half = read(duration)?;
        let time_s = start_s - first_time + if half.is_finite() { half / 2.0 } else { 0.0 };
        let mut value = [f64::NAN; 8];
        for (value, cell) in value.iter_mut().zip(optional) {
            *value = read(cell)?;
        }
        let [pressure, density, temperature, roll, rudder, heading, battery, speed] = value;
        let pressure_dbar = if pressure.is_finite() { pressure } else { read(depth)? * 1.01 };
        let descends = pitch_rad < 0.0;
        let dive = match glides.last() {
            // A descent opens a dive; so does an ascent after an ascent.
            Some(last) => last.dive + u32::from(descends || !last.descends()),
            None => 0,
        };
        glides.push(Observation {
            time_s: if time_s.is_finite() { time_s } else { 0.0 },
            pressure_dbar,
            pressure_rate_dbar_s: -up * density * 9.81 * 1e-4,
            temperature_C: temperature,
            density_kg_m3: density,
            teos10_density_kg_m3: f64::NAN,
            teos10_surface_density_kg_m3: f64::NAN,
            pitch_rad,
            roll_rad: roll,
            rudder_rad: rudder,
            roll_mass_rad: f64::NAN,
            heading_rad: heading,
            ballast_m3: vbd_cc * 1e-6,
            battery_forward_m: battery,
            sink_m_s: -up,
            sink_se_m_s: read(se)?,
            sink_window_s: [0.0; 2],
            sink_rate_m_s2: 0.0,
            speed_m_s: speed,
            water_met_m_s2: f64::NAN,
            leg: glides.len() as u32,
            dive,
            stretch: glides.len() as u32,
            motor_moving: false,
            since_move_s: f64::NAN,
            steady: (pitch_rad < 0.0) == (up < 0.0),
        });
    }
    if glides.is_empty() {
        return Err(InputError::new(Place::file(path), "no row with pitch, ballast volume and vertical velocity"));
    }
    Ok(glides)
}
