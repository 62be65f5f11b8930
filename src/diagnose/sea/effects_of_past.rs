//! What the past of a log does to each bin: the columns of all mechanisms that go by it, summed at a point.
//!
//! Knows which mechanisms act and how late the glider follows them; how each goes by the past is in [`super::history`].

use std::sync::Arc;

use super::history::{Acts, History, acting};
use super::past::MOVED_M3;
use crate::dynamics::Parameters;
use crate::identify::Bin;
use crate::log::{Observation, median};

/// What mechanisms of the past do to one bin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Effect {
    /// Change of net mass \[kg\], its mean over the bin.
    pub net_mass_kg: f64,
    /// The same as the glider follows it, late.
    pub late_net_mass_kg: f64,
    /// Horizontal force along the heading \[N\].
    pub along_N: f64,
    /// Change of the vertical velocity that is read, in its own share.
    pub reading: f64,
}

/// The columns that a problem needs again and again, and their sum at a point.
#[derive(Debug, Clone)]
pub struct Columns {
    pub(super) history: History,
    /// Time that the glider takes at each sample to follow a change of the force on it \[s\].
    slow_s: Arc<[f64]>,
    /// Change of the water's velocity along the heading that is met, as late as the glider follows \[m/s2\]; none where the log
    /// has no current.
    met_m_s2: Option<Vec<f64>>,
}

impl Columns {
    /// From the bins, the samples they are made of, and the vehicle.
    pub fn new(bins: &[Bin], samples: &[Observation], parameters: &Parameters<f64>) -> Columns {
        let history = History::new(bins, samples, parameters);
        let slow_s: Arc<[f64]> = slow_s(bins, samples, parameters).into();
        let met_m_s2 = history.met_m_s2(bins, samples, &slow_s);
        Columns { history, slow_s, met_m_s2 }
    }

    /// Whether the log's own current gives the force of its shear.
    pub fn knows_shear(&self) -> bool {
        self.met_m_s2.is_some()
    }

    /// The same in water whose own current has this share of its shear.
    pub fn with_share_of_shear(&self, share: f64) -> Columns {
        let scaled = |met: &Vec<f64>| met.iter().map(|met| share * met).collect();
        Columns { met_m_s2: self.met_m_s2.as_ref().map(scaled), ..self.clone() }
    }

    /// What the samples meet as the glider follows it, late, in each bin.
    pub fn late(&self, met: &[f64]) -> Vec<f64> {
        self.history.late(met, &self.slow_s)
    }

    /// What a unit of a mechanism's size does to each bin: where forces balance at every moment, and as the glider follows it.
    pub fn effect(&self, mechanism: &str, bins: &[Bin], parameters: &Parameters<f64>) -> [Vec<f64>; 2] {
        let late = self.history.late_column(mechanism, bins, parameters, &self.slow_s);
        [self.history.column(mechanism, bins, parameters), late]
    }

    /// What all mechanisms of the past at these parameters do to each bin; nothing where all are neutral.
    pub fn effects(&self, bins: &[Bin], parameters: &Parameters<f64>) -> Option<Vec<Effect>> {
        let mass_kg = parameters.mass_kg();
        let sheared =
            |met: &Vec<f64>| met.iter().map(|met| Effect { along_N: -mass_kg * met, ..Effect::default() }).collect();
        let mut effects: Option<Vec<Effect>> = self.met_m_s2.as_ref().map(sheared);
        for (mechanism, size, acts) in acting(parameters) {
            let effects = effects.get_or_insert_with(|| vec![Effect::default(); bins.len()]);
            let [at_rest, late] = self.effect(mechanism, bins, parameters);
            for (effect, (at_rest, late)) in effects.iter_mut().zip(at_rest.iter().zip(late)) {
                match acts {
                    Acts::NetMass => {
                        effect.net_mass_kg += size * at_rest;
                        effect.late_net_mass_kg += size * late;
                    }
                    Acts::Reading => effect.reading += size * at_rest,
                }
            }
        }
        effects
    }

    /// What all mechanisms of the past at these parameters add to the net mass in each part of the bins \[kg\]; nothing where they add
    /// nothing.
    pub fn added_kg(&self, means: &[Observation], bins: &[Bin], parameters: &Parameters<f64>) -> Option<Vec<f64>> {
        self.history.added_kg(means, bins, parameters)
    }
}

/// Time that the glider takes at each sample to follow a change of the force on it \[s\], `M V / (2 D)` with `V = w / sin` and
/// `D = m0 g sin`, both as measured: the median over the bins of its leg, before the first leg with bins that of the log.
fn slow_s(bins: &[Bin], samples: &[Observation], parameters: &Parameters<f64>) -> Vec<f64> {
    let mass_kg = parameters.mass_kg() + parameters.added_mass_1_kg;
    let slow = |bin: &Bin| {
        let sin2 = bin.mean.pitch_rad.sin().powi(2).max(1e-4);
        let volume_m3 = bin.mean.ballast_m3.abs().max(MOVED_M3);
        let weight_N = bin.mean.density_kg_m3 * volume_m3 * parameters.gravity_m_s2;
        mass_kg * bin.mean.sink_m_s.abs() / (2.0 * weight_N * sin2)
    };
    let median_of = |bins: &[Bin]| median(&mut bins.iter().map(slow).collect::<Vec<f64>>());
    let mut legs =
        bins.chunk_by(|a, b| a.mean.leg == b.mean.leg).map(|leg| (leg[0].mean.leg, median_of(leg))).peekable();
    let mut last_s = median_of(bins);
    let of_sample = |sample: &Observation| {
        while let Some((_, slow_s)) = legs.next_if(|(leg, _)| *leg <= sample.leg) {
            last_s = slow_s;
        }
        last_s
    };
    samples.iter().map(of_sample).collect()
}
