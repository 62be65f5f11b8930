//! The constants of the energy account from what a glider counted: strokes of the pump and charge drawn dive by dive.
//!
//! - Pump: `E = k1 P dV + k2 dV` by least squares over the strokes. `k1` is the ideal pump's 0.01 J/(dbar cc) over the
//!   efficiency, `k2` what the pump takes at no pressure.
//! - Dive: `Q = q0 + E_pump / U + I T` by least squares over the dives, `E_pump` by the fit of the strokes (not the
//!   strokes that the glider measured: a plan has only the fit), `q0` what each dive takes whatever its length.
//!
//! How well a dive that was not seen is foretold is found by leaving each out in turn, of both fits. Knows no files.

use nalgebra::{SMatrix, SVector};

use crate::estimate::Estimate;

/// One stroke of the pump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Number of the dive.
    pub dive: u32,
    /// Gauge pressure outside \[dbar\].
    pub pressure_dbar: f64,
    /// Volume pumped out \[cm3\].
    pub volume_cc: f64,
    /// Energy drawn by the pump \[J\].
    pub energy_J: f64,
}

/// What one dive drew from the battery.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiveCount {
    /// Number of the dive.
    pub dive: u32,
    /// Its duration \[s\].
    pub duration_s: f64,
    /// Charge \[A.h\].
    pub charge_Ah: f64,
    /// The same as energy, by the voltage of each battery \[J\].
    pub energy_J: f64,
}

/// The pump.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct PumpFit {
    /// Strokes in the fit.
    pub strokes: usize,
    /// `k1`.
    pub pump_J_per_dbar_cc: Estimate,
    /// `k2`.
    pub pump_J_per_cc: Estimate,
    /// Ideal over actual energy per pressure.
    pub efficiency: f64,
    /// Root of the mean square residual over the mean stroke's energy.
    pub relative_rms: f64,
}

/// The dive.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct DiveFit {
    /// Dives in the fit.
    pub dives: usize,
    /// What each dive takes whatever its length: surfacing, turns \[J\].
    pub surfacing_J: Estimate,
    /// Battery energy per energy of the pump.
    pub pump_factor: Estimate,
    /// Power of everything that runs all the time \[W\].
    pub hotel_W: Estimate,
    /// Error of a dive's charge foretold by the other dives, root mean square relative to the dive's own.
    pub charge_error_left_out: f64,
    /// The same for its energy.
    pub energy_error_left_out: f64,
    /// What the mean of the other dives' charge would have done.
    pub charge_error_of_the_mean: f64,
}

/// Why a calibration has no answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CalibrationError {
    /// Too few rows.
    #[error("{found} {what} are too few to calibrate with, at least {needed} are needed")]
    TooFew {
        /// Strokes or dives.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many it takes.
        needed: usize,
    },
    /// The rows do not tell the constants apart.
    #[error(
        "the {what} are too alike to tell the constants apart: strokes at several depths, dives of several lengths are needed"
    )]
    TooAlike {
        /// Strokes or dives.
        what: &'static str,
    },
}

/// Fits the pump.
///
/// # Errors
/// With fewer than four strokes, or strokes at one pressure only.
pub fn fit_pump(strokes: &[Stroke]) -> Result<PumpFit, CalibrationError> {
    need("strokes of the pump", strokes.len(), 4)?;
    let fit = pump_fit(strokes)?;
    let n = strokes.len() as f64;
    let mean = strokes.iter().map(|stroke| stroke.energy_J).sum::<f64>() / n;
    let [k1, k2] = fit.coefficients;
    Ok(PumpFit {
        strokes: strokes.len(),
        pump_J_per_dbar_cc: Estimate::normal(k1, fit.standard_errors[0], "J/(dbar.cm3)"),
        pump_J_per_cc: Estimate::normal(k2, fit.standard_errors[1], "J/cm3"),
        efficiency: IDEAL_J_PER_DBAR_CC / k1,
        relative_rms: (fit.square_sum / n).sqrt() / mean,
    })
}

/// 1 dbar cm3 is 0.01 J.
const IDEAL_J_PER_DBAR_CC: f64 = 0.01;

/// Fits what dives draw, and tests the fit on each dive left out.
///
/// # Errors
/// With fewer than six dives, or dives that are all alike.
pub fn fit_dives(strokes: &[Stroke], dives: &[DiveCount]) -> Result<DiveFit, CalibrationError> {
    need("dives", dives.len(), 6)?;
    let [k1, k2] = pump_fit(strokes)?.coefficients;
    let rows: Vec<[f64; 3]> = dives.iter().map(|dive| row(strokes, dive, k1, k2)).collect();
    let energy = least_squares(&rows, &dives.iter().map(|dive| dive.energy_J).collect::<Vec<_>>())
        .ok_or(CalibrationError::TooAlike { what: "dives" })?;
    let estimate = |i: usize, unit: &str| Estimate::normal(energy.coefficients[i], energy.standard_errors[i], unit);
    Ok(DiveFit {
        dives: dives.len(),
        surfacing_J: estimate(0, "J"),
        pump_factor: estimate(1, "1"),
        hotel_W: estimate(2, "W"),
        charge_error_left_out: left_out(strokes, dives, |dive| dive.charge_Ah)?,
        energy_error_left_out: left_out(strokes, dives, |dive| dive.energy_J)?,
        charge_error_of_the_mean: of_the_mean(dives),
    })
}

/// Each dive foretold by fits, of pump and dives, that have not seen it.
fn left_out(strokes: &[Stroke], dives: &[DiveCount], of: impl Fn(&DiveCount) -> f64) -> Result<f64, CalibrationError> {
    let mut sum = 0.0;
    for left in dives {
        let others: Vec<Stroke> = strokes.iter().filter(|stroke| stroke.dive != left.dive).copied().collect();
        let [k1, k2] = pump_fit(&others)?.coefficients;
        let seen: Vec<&DiveCount> = dives.iter().filter(|dive| dive.dive != left.dive).collect();
        let rows: Vec<[f64; 3]> = seen.iter().map(|dive| row(strokes, dive, k1, k2)).collect();
        let values: Vec<f64> = seen.iter().map(|dive| of(dive)).collect();
        let fit = least_squares(&rows, &values).ok_or(CalibrationError::TooAlike { what: "dives" })?;
        let foretold: f64 = fit.coefficients.iter().zip(row(strokes, left, k1, k2)).map(|(c, x)| c * x).sum();
        sum += ((foretold - of(left)) / of(left)).powi(2);
    }
    Ok((sum / dives.len() as f64).sqrt())
}

fn of_the_mean(dives: &[DiveCount]) -> f64 {
    let n = dives.len() as f64;
    let total: f64 = dives.iter().map(|dive| dive.charge_Ah).sum();
    let error = |dive: &DiveCount| (total - dive.charge_Ah) / (n - 1.0) / dive.charge_Ah - 1.0;
    (dives.iter().map(|dive| error(dive).powi(2)).sum::<f64>() / n).sqrt()
}

/// `1, E_pump, T` of a dive: pressures and volumes as flown, energy by the constants.
fn row(strokes: &[Stroke], dive: &DiveCount, k1: f64, k2: f64) -> [f64; 3] {
    let of_dive = strokes.iter().filter(|stroke| stroke.dive == dive.dive);
    let pump: f64 = of_dive.map(|stroke| (k1 * stroke.pressure_dbar + k2) * stroke.volume_cc).sum();
    [1.0, pump, dive.duration_s]
}

fn pump_fit(strokes: &[Stroke]) -> Result<Fit<2>, CalibrationError> {
    let rows: Vec<[f64; 2]> =
        strokes.iter().map(|stroke| [stroke.pressure_dbar * stroke.volume_cc, stroke.volume_cc]).collect();
    let energies: Vec<f64> = strokes.iter().map(|stroke| stroke.energy_J).collect();
    least_squares(&rows, &energies).ok_or(CalibrationError::TooAlike { what: "strokes of the pump" })
}

struct Fit<const N: usize> {
    coefficients: [f64; N],
    standard_errors: [f64; N],
    square_sum: f64,
}

/// Ordinary least squares; none where the columns are not independent. Columns are scaled to unit length first.
fn least_squares<const N: usize>(rows: &[[f64; N]], values: &[f64]) -> Option<Fit<N>> {
    let mut scale = [0.0; N];
    for row in rows {
        for (scale, x) in scale.iter_mut().zip(row) {
            *scale += x * x;
        }
    }
    let scale = scale.map(f64::sqrt);
    let scaled = |row: &[f64; N]| SVector::<f64, N>::from_fn(|i, _| row[i] / scale[i]);
    let (mut normal, mut right) = (SMatrix::<f64, N, N>::zeros(), SVector::<f64, N>::zeros());
    for (row, value) in rows.iter().zip(values) {
        let x = scaled(row);
        normal += x * x.transpose();
        right += x * *value;
    }
    let inverse = normal.try_inverse().filter(|inverse| inverse.norm() < 1e10)?;
    let solution = inverse * right;
    let square_sum: f64 =
        rows.iter().zip(values).map(|(row, value)| (value - scaled(row).dot(&solution)).powi(2)).sum();
    let freedom = rows.len().checked_sub(N).filter(|freedom| *freedom > 0)?;
    let variance = square_sum / freedom as f64;
    Some(Fit {
        coefficients: std::array::from_fn(|i| solution[i] / scale[i]),
        standard_errors: std::array::from_fn(|i| (variance * inverse[(i, i)]).sqrt() / scale[i]),
        square_sum,
    })
}

fn need(what: &'static str, found: usize, needed: usize) -> Result<(), CalibrationError> {
    if found >= needed { Ok(()) } else { Err(CalibrationError::TooFew { what, found, needed }) }
}
