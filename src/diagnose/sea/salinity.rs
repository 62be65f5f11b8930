//! What salinity itself shows of the mechanisms that change it: a cell that drifts, a cell that is late.
//!
//! Water keeps its salinity at a temperature over a day better than anything else in the log. A cell that drifts moves the whole
//! relation with time; a cell whose temperature is late moves it with the rate of change of the temperature, opposite on
//! the two legs. With `rho_0` the density at p = 0 by the log's own temperature and salinity,
//! ```text
//! rho_0 = f(T) - (d rho/d S) (drift t + (d S/d T) lag dT/dt) + error
//! ```
//! `f` is a broken line over the temperatures met. The standard errors are those of the scatter between dives (Liang and Zeger
//! 1986), since what the water itself changes lasts as long as a dive at least. Knows observations; no vehicle.

use nalgebra::{DMatrix, DVector};

use super::history::{DENSITY_PER_SALINITY, SALINITY_PER_KELVIN};
use crate::log::Observation;

/// Pieces of the broken line, of equally many samples.
const PIECES: usize = 40;

/// Fewest dives between which there is a scatter.
const LEAST_DIVES: usize = 4;

/// Longest step over which a rate of change is taken \[s\].
const LONGEST_STEP_S: f64 = 90.0;

/// Share of a size that the relation of temperature and salinity states at best: both its densities are linearised, and the
/// water may follow the drift.
const SHARE: f64 = 0.3;

/// A size that the channel shows may count against no effect by as much evidence as this and no more: the water may have
/// changed by itself.
const MOST_EVIDENCE: f64 = 12.0;

/// Least error of a drift over the whole log \[-\], and of a lag \[s\]: the accuracy of a salinity, the response of a thermistor.
const LEAST_DRIFT: f64 = 0.01;
const LEAST_LAG_S: f64 = 0.2;

const DAY_S: f64 = 86_400.0;

/// A size that the channel shows, with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    /// The size.
    pub value: f64,
    /// Its standard error.
    pub se: f64,
}

impl Shown {
    fn new(value: f64, se: f64, least: f64) -> Shown {
        let se = se.hypot(SHARE * value).max(least).max(value.abs() / MOST_EVIDENCE.sqrt());
        Shown { value, se }
    }
}

/// What salinity shows of this mechanism; none where it shows none, or the log has no salinity.
pub fn shown(mechanism: &str, observations: &[Observation]) -> Option<Shown> {
    let place = match mechanism {
        "conductivity_drift" => 0,
        "thermal_lag" => 1,
        _ => return None,
    };
    let rows = rows(observations);
    let (step, covariance) = slopes(&rows)?;
    let span_days = (rows.last()?.time_s - rows.first()?.time_s) / DAY_S;
    let unit = [-DENSITY_PER_SALINITY / DAY_S, -DENSITY_PER_SALINITY * SALINITY_PER_KELVIN][place];
    let least = [LEAST_DRIFT / span_days.max(1e-3), LEAST_LAG_S][place];
    let (value, se) = (step[place] / unit, covariance[(place, place)].max(0.0).sqrt() / unit.abs());
    (value.is_finite() && se.is_finite()).then(|| Shown::new(value, se, least))
}

struct Row {
    time_s: f64,
    dive: u32,
    temperature_c: f64,
    density_kg_m3: f64,
    rate_k_s: f64,
}

/// The samples with temperature and salinity, and the rate of change of their temperature.
fn rows(observations: &[Observation]) -> Vec<Row> {
    let measured: Vec<&Observation> = observations
        .iter()
        .filter(|o| o.temperature_C.is_finite() && o.teos10_surface_density_kg_m3.is_finite())
        .collect();
    let of = |three: &[&Observation]| {
        let [before, here, after] = [three[0], three[1], three[2]];
        let step_s = after.time_s - before.time_s;
        let is_one = before.leg == after.leg && step_s > 0.0 && step_s < LONGEST_STEP_S;
        is_one.then(|| Row {
            time_s: here.time_s,
            dive: here.dive,
            temperature_c: here.temperature_C,
            density_kg_m3: here.teos10_surface_density_kg_m3,
            rate_k_s: (after.temperature_C - before.temperature_C) / step_s,
        })
    };
    measured.windows(3).filter_map(of).collect()
}

/// The slopes with time and with the rate of change, each piece of the line having its own level and slope, and their
/// covariance by the scatter between dives.
fn slopes(rows: &[Row]) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by(|a, b| rows[*a].temperature_c.total_cmp(&rows[*b].temperature_c));
    let per_piece = rows.len().div_ceil(PIECES).max(8);
    let mut free: Vec<(u32, [f64; 3])> = Vec::with_capacity(rows.len());
    let begin_s = rows.first()?.time_s;
    for piece in order.chunks(per_piece).filter(|piece| piece.len() >= 8) {
        let x: Vec<f64> = piece.iter().map(|i| rows[*i].temperature_c).collect();
        let columns = [
            straightened(&x, piece.iter().map(|i| rows[*i].time_s - begin_s)),
            straightened(&x, piece.iter().map(|i| rows[*i].rate_k_s)),
            straightened(&x, piece.iter().map(|i| rows[*i].density_kg_m3)),
        ];
        free.extend(piece.iter().enumerate().map(|(k, i)| (rows[*i].dive, [0, 1, 2].map(|c| columns[c][k]))));
    }
    let mut gram = DMatrix::zeros(2, 2);
    let mut moments = DVector::zeros(2);
    for (_, [a, b, y]) in &free {
        gram += DMatrix::from_row_slice(2, 2, &[a * a, a * b, a * b, b * b]);
        moments += DVector::from_row_slice(&[a * y, b * y]);
    }
    // In units of their own lengths, which differ by eight orders of magnitude.
    let length = [gram[(0, 0)].sqrt(), gram[(1, 1)].sqrt()];
    if length.iter().any(|length| *length < 1e-12) {
        return None;
    }
    let scaled = DMatrix::from_fn(2, 2, |i, j| gram[(i, j)] / (length[i] * length[j]));
    let inverse = scaled.try_inverse()?;
    let inverse = DMatrix::from_fn(2, 2, |i, j| inverse[(i, j)] / (length[i] * length[j]));
    let step = &inverse * moments;
    let mut of_dive: std::collections::BTreeMap<u32, DVector<f64>> = std::collections::BTreeMap::new();
    for (dive, [a, b, y]) in &free {
        let left = y - a * step[0] - b * step[1];
        *of_dive.entry(*dive).or_insert_with(|| DVector::zeros(2)) += DVector::from_row_slice(&[a * left, b * left]);
    }
    let n = of_dive.len();
    if n < LEAST_DIVES {
        return None;
    }
    let between = of_dive.values().fold(DMatrix::zeros(2, 2), |sum, score| sum + score * score.transpose());
    let few = n as f64 / (n as f64 - 2.0);
    Some((step, &inverse * between * &inverse * few))
}

/// Values less their own line over `x`.
fn straightened(x: &[f64], values: impl Iterator<Item = f64>) -> Vec<f64> {
    let values: Vec<f64> = values.collect();
    let n = x.len() as f64;
    let (mean_x, mean) = (x.iter().sum::<f64>() / n, values.iter().sum::<f64>() / n);
    let spread: f64 = x.iter().map(|x| (x - mean_x).powi(2)).sum();
    let moment: f64 = x.iter().zip(&values).map(|(x, v)| (x - mean_x) * (v - mean)).sum();
    let slope = if spread > 0.0 { moment / spread } else { 0.0 };
    x.iter().zip(&values).map(|(x, v)| v - mean - slope * (x - mean_x)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::sea::steady_log::SAMPLE;

    /// Twelve dives through a thermocline, with a salinity that is wrong by `drift` a day and by a lag.
    fn log(drift: f64, lag_s: f64) -> Vec<Observation> {
        let vehicle = crate::vehicle::Vehicle::load("slocum-049").unwrap();
        let reference = vehicle.glide_parameters().reference_temperature_C;
        let mut found = Vec::new();
        for i in 0..2400u32 {
            let (leg, within) = (i / 100, f64::from(i % 100));
            let depth_m = 2.0 * if leg % 2 == 0 { within } else { 100.0 - within };
            let sign = if leg % 2 == 0 { 1.0 } else { -1.0 };
            let temperature = 12.0 - 5.0 * ((depth_m - 80.0) / 20.0).tanh();
            let rate = -5.0 / 20.0 / ((depth_m - 80.0) / 20.0).cosh().powi(2) * 0.2 * sign;
            let noise = (f64::from(i) * 78.233).sin() * 43_758.545 % 1.0;
            let error = drift * f64::from(i) * 10.0 / DAY_S + SALINITY_PER_KELVIN * lag_s * rate + 0.003 * noise;
            let density = 1025.0 - 0.2 * (temperature - reference) - DENSITY_PER_SALINITY * error;
            found.push(Observation {
                time_s: 10.0 * f64::from(i),
                pressure_dbar: depth_m,
                pressure_rate_dbar_s: 0.2 * sign,
                temperature_C: temperature,
                density_kg_m3: density,
                teos10_density_kg_m3: density,
                teos10_surface_density_kg_m3: density,
                pitch_rad: -0.4 * sign,
                ballast_m3: -2e-4 * sign,
                sink_m_s: 0.2 * sign,
                leg,
                dive: leg / 2,
                ..SAMPLE
            });
        }
        found
    }

    #[test]
    fn a_drift_and_a_lag_of_the_cell_are_distinguished() {
        for (drift, lag_s) in [(0.0, 0.0), (0.8, 0.0), (-0.5, 0.0), (0.0, 5.0), (0.3, -4.0)] {
            let log = log(drift, lag_s);
            let (of_drift, of_lag) = (shown("conductivity_drift", &log).unwrap(), shown("thermal_lag", &log).unwrap());
            assert!((of_drift.value - drift).abs() < 0.05, "{drift} {lag_s}: {of_drift:?}");
            assert!((of_lag.value - lag_s).abs() < 0.4, "{drift} {lag_s}: {of_lag:?}");
            assert!(
                of_drift.se < 0.1 + 0.31 * drift.abs() && of_lag.se < 0.3 + 0.31 * lag_s.abs(),
                "{of_drift:?} {of_lag:?}"
            );
        }
        assert!(shown("leak", &log(0.0, 0.0)).is_none());
    }
}
