//! The speed through the water from a Seaglider's own current profiler (Nortek AD2CP), for `--speed-column ad2cp`.
//!
//! The basestation stores the velocity of the water in each cell relative to the glider, as the instrument turned it with
//! its own heading and tilt: `ad2cp_velX` to the magnetic east, `velY` to the magnetic north, `velZ` up. The water of
//! the near cells is that through which the glider moves, so the glider's velocity through the water is minus theirs.
//! The speed is that of its part along `ad2cp_heading` and its vertical part; the part across is noise and sideslip.
//!
//! A ping is left out where the glider is tilted so far that a beam no longer points away from the surface, where the
//! near cells contradict each other, where the water seems to come from behind, and where the vertical part is not that
//! of the pressure. Not the inverse solution `ad2cp_inv_*`, which holds the profile of the ocean as well.

use std::path::Path;

use netcdf_reader::NcFile;

use super::netcdf::{has, scalar, values};
use super::resample::{Readings, in_nearest_rows, nearest};
use glidepolar_input::InputError;

/// How a user names it.
pub(super) const NAME: &str = "ad2cp";

/// Centre of the farthest cell that counts as near \[m\]: four cells of 2 m.
const NEAR_M: f64 = 8.0;

/// Largest angle between the instrument's axis and the vertical \[deg\]: the side beams stand 25 deg from the axis.
const MOST_TILT_DEG: f64 = 65.0;

/// Standard deviation among the near cells from which on they contradict each other \[m/s\]: a cell's own noise is 0.02 to
/// 0.05 m/s by the maker's data sheet.
const MOST_SPREAD_M_S: f64 = 0.1;

/// Largest difference of the vertical part from the rate of pressure \[m/s\]: noise, and waves inside the water. A wrong
/// choice of three beams makes 0.14 m/s.
const MOST_W_ERROR_M_S: f64 = 0.1;

/// Bias of the vertical part, median over the pings, from which on it is reported \[m/s\].
const BIAS_REPORTED_M_S: f64 = 0.05;

/// Within so many seconds of a ping the rate of pressure is taken; twice as far where the glider samples rarely \[s\].
const RATE_WITHIN_S: f64 = 15.0;

/// Metres in a decibar of sea water, within one per cent \[m/dbar\].
const M_PER_DBAR: f64 = 0.995;

/// A measured speed at its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ping {
    pub(super) time_s: f64,
    pub(super) speed_m_s: f64,
}

/// The speeds of one dive, in the order of time. What was left out is noted.
pub(super) fn read(
    path: &Path,
    file: &NcFile,
    pressure: &Readings,
    notes: &mut Vec<String>,
) -> Result<Vec<Ping>, InputError> {
    const NAMES: [&str; 5] = ["ad2cp_time", "ad2cp_heading", "ad2cp_velX", "ad2cp_velY", "ad2cp_velZ"];
    if let Some(absent) = NAMES.iter().find(|name| !has(file, name)) {
        notes.push(format!("no AD2CP in it (`{absent}` is not there), so no measured speed"));
        return Ok(Vec::new());
    }
    let column = |name: &str| if has(file, name) { values(path, file, name) } else { Ok(Vec::new()) };
    let [times, headings, x, y, z] = NAMES.map(column);
    let (times, headings) = (times?, headings?);
    let velocities = [x?, y?, z?];
    let (pitch, roll) = (column("ad2cp_pitch")?, column("ad2cp_roll")?);
    let pings = times.len();
    let cells = velocities[0].len().checked_div(pings).unwrap_or(0);
    if cells == 0 || velocities.iter().any(|v| v.len() != pings * cells) || headings.len() != pings {
        notes.push("the AD2CP's velocities are not one row a ping, so no measured speed".to_owned());
        return Ok(Vec::new());
    }
    let near = near_cells(file).clamp(1, cells);
    let at = |column: &[f64], i: usize| column.get(i).copied().unwrap_or(0.0);

    let mut speeds: Vec<Ping> = Vec::new();
    let mut left_out = [0usize; 4];
    let mut w_errors = Vec::new();
    for i in (0..pings).filter(|&i| times[i].is_finite() && headings[i].is_finite()) {
        let cell = |v: &[f64]| -> Vec<f64> {
            v[i * cells..i * cells + near].iter().copied().filter(|value| value.is_finite()).collect()
        };
        let [x, y, z] = [0, 1, 2].map(|axis| mean_and_sd(&cell(&velocities[axis])));
        let Some(((x, x_sd), (y, y_sd), (z, z_sd))) = x.zip(y).zip(z).map(|((x, y), z)| (x, y, z)) else { continue };
        let up = -z;
        let rate = pressure.slope(times[i], RATE_WITHIN_S);
        let rate = if rate.is_nan() { pressure.slope(times[i], 2.0 * RATE_WITHIN_S) } else { rate };
        let w_error = up + rate * M_PER_DBAR;
        let tilt = (at(&pitch, i).to_radians().cos() * at(&roll, i).to_radians().cos()).acos();
        let heading = headings[i].to_radians();
        let along = -(x * heading.sin() + y * heading.cos());
        let under_water = pressure.at(times[i]) > 1.0;
        if !under_water {
            continue;
        }
        if w_error.is_finite() {
            w_errors.push(w_error);
        }
        let reasons = [
            tilt.to_degrees() > MOST_TILT_DEG,
            x_sd.max(y_sd).max(z_sd) > MOST_SPREAD_M_S,
            along <= 0.0,
            w_error.abs() > MOST_W_ERROR_M_S,
        ];
        if let Some(reason) = reasons.iter().position(|reason| *reason) {
            left_out[reason] += 1;
        } else {
            speeds.push(Ping { time_s: times[i], speed_m_s: along.hypot(up) });
        }
    }
    speeds.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    speeds.dedup_by(|later, earlier| later.time_s <= earlier.time_s);
    let reasons = [
        "the glider was tilted beyond the beams",
        "the near cells contradict each other",
        "the water came from behind",
        "the vertical velocity is not that of the pressure",
    ];
    for (count, reason) in left_out.into_iter().zip(reasons).filter(|(count, _)| *count > 0) {
        notes.push(format!("{count} of {pings} pings of the AD2CP left out: {reason}"));
    }
    if w_errors.len() >= 5 {
        let bias = super::median(&mut w_errors);
        if bias.abs() > BIAS_REPORTED_M_S {
            notes.push(format!(
                "the AD2CP's vertical velocity is {bias:+.3} m/s off that of the pressure, median of {} pings: wrong beams, \
                 or an instrument that is turned in its mount; its speeds are doubtful",
                w_errors.len()
            ));
        }
    }
    Ok(speeds)
}

/// Angles of the beams of a SeaExplorer's profiler from its axis: fore and aft, to the sides \[rad\].
const FORE_AFT_RAD: f64 = 47.5 * std::f64::consts::PI / 180.0;
const SIDES_RAD: f64 = 25.0 * std::f64::consts::PI / 180.0;

/// The speed by four beams in one cell, each positive away from the instrument, which looks down: fore, side, aft, other
/// side. Fore and aft beams give both parts in the plane of symmetry, the side beams one of them again. Nothing where these
/// contradict each other, or the rate of pressure.
pub(super) fn of_four_beams(time_s: f64, beams: [f64; 4], pitch_rad: f64, pressure: &Readings) -> Option<Ping> {
    let [fore, side, aft, other] = beams;
    // Where the glider goes forward, the water ahead comes nearer.
    let forward = (aft - fore) / (2.0 * FORE_AFT_RAD.sin());
    let up = (fore + aft) / (2.0 * FORE_AFT_RAD.cos());
    let up_by_sides = (side + other) / (2.0 * SIDES_RAD.cos());
    let rate = pressure.slope(time_s, RATE_WITHIN_S);
    let rate = if rate.is_nan() { pressure.slope(time_s, 4.0 * RATE_WITHIN_S) } else { rate };
    let climb = forward * pitch_rad.sin() + up * pitch_rad.cos();
    let is_sound = (up - up_by_sides).abs() <= MOST_SPREAD_M_S
        && forward > 0.0
        && pressure.at(time_s) > 1.0
        && (climb + rate * M_PER_DBAR).abs() <= MOST_W_ERROR_M_S;
    is_sound.then(|| Ping { time_s, speed_m_s: forward.hypot(up) })
}

/// How many cells lie near the glider, by the blanking \[cm\] and the size of a cell \[mm\].
fn near_cells(file: &NcFile) -> usize {
    let blanking_m = scalar(file, "ad2cp_blanking").filter(|cm| (0.0..1e4).contains(cm)).map_or(0.1, |cm| cm / 100.0);
    let cell_m = scalar(file, "ad2cp_cellSize").filter(|mm| (100.0..1e5).contains(mm)).map_or(2.0, |mm| mm / 1000.0);
    ((NEAR_M - blanking_m) / cell_m + 0.5).floor().max(1.0) as usize
}

/// Mean and standard deviation; nothing where there is no value.
fn mean_and_sd(values: &[f64]) -> Option<(f64, f64)> {
    let n = values.len() as f64;
    if values.is_empty() {
        return None;
    }
    let mean = values.iter().sum::<f64>() / n;
    let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    Some((mean, (squares / (n - 1.0).max(1.0)).sqrt()))
}

/// The rows of the log with those of pings that are far from any.
pub(super) fn rows(times: &[f64], pings: &[Ping]) -> Vec<f64> {
    let mut rows = times.to_vec();
    let is_increasing = times.windows(2).all(|pair| pair[1] > pair[0]);
    if is_increasing {
        rows.extend(pings.iter().map(|ping| ping.time_s).filter(|&time| nearest(times, time).is_none()));
        rows.sort_by(f64::total_cmp);
    }
    rows
}

/// The speeds, each in the row nearest to it; means where a row has several.
pub(super) fn column(rows: &[f64], pings: &[Ping]) -> Vec<f64> {
    in_nearest_rows(rows, pings.iter().map(|ping| (ping.time_s, ping.speed_m_s)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_stands_in_the_row_of_its_time_or_in_one_of_its_own() {
        let ping = |time_s: f64| Ping { time_s, speed_m_s: 0.3 };
        let times = [0.0, 5.0, 10.0, 100.0];
        let pings = [ping(6.0), ping(50.0)];
        let rows = rows(&times, &pings);
        assert_eq!(rows, [0.0, 5.0, 10.0, 50.0, 100.0]);
        let column = column(&rows, &pings);
        assert_eq!((column[1], column[3]), (0.3, 0.3));
        assert_eq!(column.iter().filter(|value| value.is_finite()).count(), 2);
    }
}
