//! A log as a fit takes it, held against itself and against the vehicle that flew it. Knows no file but by its name.

use std::path::PathBuf;

use super::{ReadingError, added_mass, force_balance, measured_speed, states_gravity};
use crate::diagnose::sea::consistency::{self, DensityError};
use crate::diagnose::{Check, Checked};
use crate::input::InputError;
use crate::log::{Calibration, Observation};
use crate::vehicle::Vehicle;

/// Samples of a log, and how they were come by.
#[derive(Debug)]
pub struct PreparedLog {
    /// Samples in the order of time.
    pub observations: Vec<Observation>,
    /// Samples without density or ballast volume: for turn rates alone.
    pub turns_only: Vec<Observation>,
    /// How the vertical velocity was measured.
    pub w_filter: String,
    /// What was found in the log and done about it.
    pub notes: Vec<String>,
    /// What was left out as a whole: files, the speeds of legs on which the sensor had lost the water, speeds that were
    /// interpolated or repeated.
    pub left_out: Vec<String>,
    /// What the files say of the vehicle; Seaglider only.
    pub calibration: Option<Calibration>,
    /// Steady samples and all samples on legs, before a long log was shortened.
    pub steady: [usize; 2],
    /// Acceleration of gravity where the log was recorded; nothing without a position \[m/s2\].
    pub gravity_m_s2: Option<f64>,
    /// The first file, where it is known.
    pub log: Option<PathBuf>,
}

impl PreparedLog {
    /// The vehicle where the log was recorded: with the acceleration of gravity there, unless its file states one.
    pub fn located(&mut self, vehicle: Vehicle) -> Result<Vehicle, InputError> {
        let mut here = vehicle;
        if states_gravity(&here) {
            return Ok(here);
        }
        match self.gravity_m_s2 {
            Some(gravity_m_s2) => {
                here.set("mass.gravity_m_s2", (gravity_m_s2 * 1e5).round() / 1e5)?;
                self.notes.push(format!("g = {gravity_m_s2:.4} m/s2 by the latitude of the log"));
            }
            None => self.notes.push("g = 9.81 m/s2: the log has no position".to_owned()),
        }
        Ok(here)
    }

    /// All samples that show how the glider turned, in the order of time.
    pub fn for_turning(&self) -> Vec<Observation> {
        let mut all: Vec<Observation> = self.observations.iter().chain(&self.turns_only).copied().collect();
        all.sort_by(|a, b| (a.stretch, a.leg).cmp(&(b.stretch, b.leg)).then(a.time_s.total_cmp(&b.time_s)));
        all
    }

    /// The share of the samples on legs that are steady, in a sentence.
    pub fn steady_share(&self) -> String {
        let [steady, all] = self.steady;
        format!("{steady} of {all} samples on legs are steady ({:.0} %)", 100.0 * steady as f64 / all.max(1) as f64)
    }

    /// Corrects a density whose error the log's own temperature, salinity and pressure show, as `diagnose` does; what was
    /// done comes back as warnings.
    ///
    /// # Errors
    /// Where the log contradicts itself so that nothing follows from it, in the words of `diagnose`.
    pub fn corrected(&mut self, vehicle: &Vehicle) -> Result<Vec<String>, ReadingError> {
        let (warnings, error) = self.checked(vehicle)?;
        if let Some(error) = error {
            let carried_kg_m3 = vehicle.glide_parameters().density_bias_kg_m3;
            self.observations = consistency::corrected(&self.observations, error, carried_kg_m3);
        }
        Ok(warnings)
    }

    /// Holds the log against itself: what is wrong and can be corrected comes back as warnings, and the error of the density.
    ///
    /// # Errors
    /// Where the log contradicts itself so that nothing follows from it, in the words of `diagnose`.
    pub fn checked(&self, vehicle: &Vehicle) -> Result<(Vec<String>, Option<DensityError>), ReadingError> {
        let bias_kg_m3 = vehicle.glide_parameters().density_bias_kg_m3;
        let (checks, error) = consistency::checks(&self.observations, bias_kg_m3);
        if checks.iter().any(|check| check.outcome == Checked::Wrong) {
            return Err(self.inconsistent(checks));
        }
        let found = checks.iter().filter(|check| check.outcome == Checked::Corrected);
        let warning = |check: &Check| format!("{}: {}; corrected before anything else", check.check, check.says);
        let warnings = self.left_out.iter().cloned().chain(found.map(warning));
        Ok((warnings.chain(self.contradictions(vehicle)).collect(), error))
    }

    /// The error of a log that does not pass these checks.
    pub fn inconsistent(&self, checks: Vec<Check>) -> ReadingError {
        ReadingError::Inconsistent { log: self.log.clone(), checks, notes: self.notes.clone() }
    }

    /// Returns what in the log no glider of this size could have flown, where a unit is wrong, and what of the vehicle no hull can have.
    pub fn contradictions(&self, vehicle: &Vehicle) -> Vec<String> {
        let parameters = vehicle.glide_parameters();
        let balance = force_balance::contradiction(&self.observations, &parameters);
        let speed = measured_speed::contradiction(&self.observations, &parameters);
        balance.into_iter().chain(speed).chain(added_mass::contradiction(&parameters)).collect()
    }
}
