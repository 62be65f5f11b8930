//! Residuals sample by sample: what figures, hold-outs and a diagnosis look at.

use serde::Serialize;

use super::inertia::inertia;
use super::model::{Inertia, predict};
use crate::dynamics::Parameters;
use crate::glide::SteadyGlider;
use crate::log::Observation;

/// One sample beside its prediction. Measured less predicted; NaN where there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Downward velocity \[m/s\].
    pub sink_m_s: f64,
    /// Speed through the water \[m/s\].
    pub speed_m_s: f64,
    /// Predicted angle of attack \[rad\].
    pub angle_of_attack_rad: f64,
    /// Predicted speed through the water \[m/s\].
    pub predicted_speed_m_s: f64,
}

impl Residual {
    /// Of a sample without a prediction.
    pub const NONE: Residual = Residual {
        sink_m_s: f64::NAN,
        speed_m_s: f64::NAN,
        angle_of_attack_rad: f64::NAN,
        predicted_speed_m_s: f64::NAN,
    };
}

/// The residual of every observation, steady or not; NaN where no glide exists.
pub fn residuals(parameters: &Parameters<f64>, observations: &[Observation]) -> Vec<Residual> {
    residuals_with(parameters, observations, inertia(parameters, observations))
}

/// The same for a glider whose forces balance at every moment.
pub(super) fn residuals_at_rest(parameters: &Parameters<f64>, observations: &[Observation]) -> Vec<Residual> {
    residuals_with(parameters, observations, std::iter::repeat(Inertia::NONE))
}

fn residuals_with(
    parameters: &Parameters<f64>,
    observations: &[Observation],
    inertia: impl IntoIterator<Item = Inertia>,
) -> Vec<Residual> {
    let glider = SteadyGlider::new(*parameters);
    let mut guess = None;
    observations
        .iter()
        .zip(inertia)
        .map(|(observed, inertia)| {
            let predicted = predict(&glider, observed, &inertia, guess);
            guess = predicted.map(|p| p.guess);
            match predicted {
                Some(p) => Residual {
                    sink_m_s: observed.sink_m_s - p.sink_m_s,
                    speed_m_s: observed.speed_m_s - p.speed_m_s,
                    angle_of_attack_rad: p.angle_of_attack_rad,
                    predicted_speed_m_s: p.speed_m_s,
                },
                None => Residual::NONE,
            }
        })
        .collect()
}

/// How well a model does on samples: root mean squares and means of the residuals.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Score {
    /// Samples.
    pub n: usize,
    /// Vertical velocity, root mean square \[m/s\].
    pub w_rms_m_s: f64,
    /// The same after a running mean over nine samples of a leg \[m/s\]; absent where legs are shorter.
    pub w_rms_9_point_m_s: Option<f64>,
    /// Speed, root mean square \[m/s\]; absent where none was measured.
    pub speed_rms_m_s: Option<f64>,
    /// Speed, mean of measured less predicted \[m/s\].
    pub speed_bias_m_s: Option<f64>,
}

/// Sums from which a [`Score`] follows; sums of several parts add up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ScoreSums {
    w: (usize, f64),
    smooth: (usize, f64),
    speed: (usize, f64, f64),
}

/// Half the width of the running mean.
const HALF: usize = 4;

impl ScoreSums {
    /// Adds observations with their residuals. Samples without a prediction do not count, means stay within a leg.
    pub fn add(&mut self, observations: &[Observation], residuals: &[Residual]) {
        self.add_joined(residuals, |i, j| observations[i].leg == observations[j].leg);
    }

    /// Adds the residuals of consecutive samples of one stretch, whatever the leg.
    pub fn add_stretch(&mut self, residuals: &[Residual]) {
        self.add_joined(residuals, |_, _| true);
    }

    fn add_joined(&mut self, residuals: &[Residual], joined: impl Fn(usize, usize) -> bool) {
        for (i, residual) in residuals.iter().enumerate() {
            if residual.sink_m_s.is_finite() {
                self.w.0 += 1;
                self.w.1 += residual.sink_m_s * residual.sink_m_s;
            }
            if residual.speed_m_s.is_finite() {
                self.speed.0 += 1;
                self.speed.1 += residual.speed_m_s;
                self.speed.2 += residual.speed_m_s * residual.speed_m_s;
            }
            let Some(low) = i.checked_sub(HALF).filter(|_| i + HALF < residuals.len()) else { continue };
            let window = low..=i + HALF;
            if joined(low, i + HALF) {
                let mean = residuals[window].iter().map(|r| r.sink_m_s).sum::<f64>() / (2 * HALF + 1) as f64;
                if mean.is_finite() {
                    self.smooth.0 += 1;
                    self.smooth.1 += mean * mean;
                }
            }
        }
    }

    /// The score of all that was added.
    pub fn score(&self) -> Score {
        let rms = |n: usize, sum: f64| (n > 0).then(|| (sum / n as f64).sqrt());
        Score {
            n: self.w.0,
            w_rms_m_s: rms(self.w.0, self.w.1).unwrap_or(f64::NAN),
            w_rms_9_point_m_s: rms(self.smooth.0, self.smooth.1),
            speed_rms_m_s: rms(self.speed.0, self.speed.2),
            speed_bias_m_s: (self.speed.0 > 0).then(|| self.speed.1 / self.speed.0 as f64),
        }
    }
}
