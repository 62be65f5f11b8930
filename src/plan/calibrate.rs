//! The constants of the energy account from what a glider counted: strokes of the pump and charge drawn dive by dive.
//!
//! - Pump: `E = k1 P dV + k2 dV` by least squares over the strokes. `k1` is the ideal pump's 0.01 J/(dbar cc) over the
//!   efficiency, `k2` what the pump takes at no pressure.
//! - Dive: `Q = q0 + E_pump / U + I T` by least squares over the dives, `E_pump` by the fit of the strokes (not the
//!   strokes that the glider measured: a plan has only the fit), `q0` what each dive takes whatever its length.
//!
//! How well a held-out dive is predicted is found by leaving each out in turn, of both fits. Knows no files.

use glidepolar_inference::regression::{Problem, Regression, Scatter};
use nalgebra::{DMatrix, DVector};

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
    /// Error of a dive's charge as the other dives predict it, root mean square relative to the dive's own.
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
    /// The rows cannot separate the constants.
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
    let mean = strokes.iter().map(|stroke| stroke.energy_J).sum::<f64>() / strokes.len() as f64;
    Ok(PumpFit {
        strokes: strokes.len(),
        pump_J_per_dbar_cc: estimate(&fit, 0, "J/(dbar.cm3)"),
        pump_J_per_cc: estimate(&fit, 1, "J/cm3"),
        efficiency: IDEAL_J_PER_DBAR_CC / fit.parameters[0],
        relative_rms: fit.rms() / mean,
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
    let pump = pump_fit(strokes)?;
    let energy = dive_fit(strokes, dives, &pump, |dive| dive.energy_J)?;
    Ok(DiveFit {
        dives: dives.len(),
        surfacing_J: estimate(&energy, 0, "J"),
        pump_factor: estimate(&energy, 1, "1"),
        hotel_W: estimate(&energy, 2, "W"),
        charge_error_left_out: left_out(strokes, dives, |dive| dive.charge_Ah)?,
        energy_error_left_out: left_out(strokes, dives, |dive| dive.energy_J)?,
        charge_error_of_the_mean: of_the_mean(dives),
    })
}

/// Relative error, root mean square, of each dive as fits of pump and dives predict it from the others.
fn left_out(strokes: &[Stroke], dives: &[DiveCount], of: impl Fn(&DiveCount) -> f64) -> Result<f64, CalibrationError> {
    let mut sum = 0.0;
    for left in dives {
        let strokes_kept: Vec<Stroke> = strokes.iter().filter(|stroke| stroke.dive != left.dive).copied().collect();
        let dives_kept: Vec<DiveCount> = dives.iter().filter(|dive| dive.dive != left.dive).copied().collect();
        let pump = pump_fit(&strokes_kept)?;
        let fit = dive_fit(strokes, &dives_kept, &pump, &of)?;
        let predicted = fit.parameters.dot(&DVector::from(row(strokes, left, &pump).to_vec()));
        sum += ((predicted - of(left)) / of(left)).powi(2);
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
fn row(strokes: &[Stroke], dive: &DiveCount, pump: &Regression) -> [f64; 3] {
    let of_dive = strokes.iter().filter(|stroke| stroke.dive == dive.dive);
    let (k1, k2) = (pump.parameters[0], pump.parameters[1]);
    let energy_J: f64 = of_dive.map(|stroke| (k1 * stroke.pressure_dbar + k2) * stroke.volume_cc).sum();
    [1.0, energy_J, dive.duration_s]
}

fn pump_fit(strokes: &[Stroke]) -> Result<Regression, CalibrationError> {
    let rows = strokes.iter().map(|stroke| [stroke.pressure_dbar * stroke.volume_cc, stroke.volume_cc]);
    fit(rows, strokes.iter().map(|stroke| stroke.energy_J), "strokes of the pump")
}

fn dive_fit(
    strokes: &[Stroke],
    dives: &[DiveCount],
    pump: &Regression,
    of: impl Fn(&DiveCount) -> f64,
) -> Result<Regression, CalibrationError> {
    fit(dives.iter().map(|dive| row(strokes, dive, pump)), dives.iter().map(of), "dives")
}

fn fit<const N: usize>(
    rows: impl Iterator<Item = [f64; N]>,
    values: impl Iterator<Item = f64>,
    what: &'static str,
) -> Result<Regression, CalibrationError> {
    let rows: Vec<f64> = rows.flatten().collect();
    let design = DMatrix::from_row_slice(rows.len() / N, N, &rows);
    let values = DVector::from_iterator(design.nrows(), values);
    Problem::plain(design, values).solve(Scatter::Equal).ok_or(CalibrationError::TooAlike { what })
}

fn estimate(fit: &Regression, i: usize, unit: &str) -> Estimate {
    Estimate::normal(fit.parameters[i], fit.covariance[(i, i)].sqrt(), unit)
}

fn need(what: &'static str, found: usize, needed: usize) -> Result<(), CalibrationError> {
    if found >= needed { Ok(()) } else { Err(CalibrationError::TooFew { what, found, needed }) }
}
