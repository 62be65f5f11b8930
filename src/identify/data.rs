//! The samples of a fit, dive by dive, and their means over bins, which are what is fitted.
//!
//! A bin, and where samples themselves are fitted a sample, weighs as much as the time it stands for. The water's own motion
//! lasts for minutes: neighbours closer than that say the same thing again, and a glider that samples the upper water four
//! times as often as the deep would otherwise have its hull constants from the upper water alone. A mean of few measured
//! speeds has more of the sensor's noise in it than one of many, and weighs that much less ([`SpeedNoise`]).

use std::ops::Range;
use std::sync::Arc;

use super::bins::{Bin, bins};
use super::residuals::{Residual, residuals, residuals_at_rest};
use super::within_bin::{Inside, Parts};
use crate::dynamics::Parameters;
use crate::log::Observation;

/// One dive: the steady samples of a descent and the ascent after it.
#[derive(Debug, Clone)]
pub struct Dive {
    /// Its samples.
    pub observations: Vec<Observation>,
    /// All samples of the dive, of which these are the steady ones: what goes before a steady glide is where its speed begins.
    log: Arc<[Observation]>,
    /// Their means over stretches of a leg: what is fitted.
    pub bins: Vec<Bin>,
    /// The bins in parts.
    parts: Parts,
    /// Solutions for the parameters tried last, from which the next ones start; one a bin.
    guesses: Vec<Option<[f64; 2]>>,
    /// What happens inside each bin, by the parameters of the latest update.
    inside: Vec<Inside>,
    /// Root of the time that each sample stands for, against the mean.
    root_weights: Vec<f64>,
    /// Root of the time that each bin stands for, in the same measure.
    pub bin_root_weights: Vec<f64>,
    /// What a few measured speeds scatter by.
    speed_noise: SpeedNoise,
    /// Samples and bins of the dives before, so that every n-th one is one of the whole log, however short the dives.
    before: [usize; 2],
}

/// One bin of a dive, as a fit takes it.
pub(super) struct Stretch<'d> {
    pub bin: &'d Bin,
    pub inside: &'d Inside,
    /// The solution for the parameters tried last.
    pub guess: &'d mut Option<[f64; 2]>,
    pub root_weight: f64,
    /// What the variance of its mean speed is beside that of the others \[m2/s2\].
    pub speed_excess: f64,
}

/// The scatter of measured speeds inside bins: a mean of `n` of them has `s^2/n` of it, beside what whole bins scatter by.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct SpeedNoise {
    /// Variance of one speed \[m2/s2\].
    variance: f64,
    /// Mean of `1/n` over the bins that have any.
    mean_inverse: f64,
}

impl SpeedNoise {
    fn estimate(dives: &[Dive]) -> SpeedNoise {
        let (mut squares, mut freedom, mut inverses, mut bins) = (0.0, 0usize, 0.0, 0usize);
        for dive in dives {
            for bin in dive.bins.iter().filter(|bin| bin.speeds > 0) {
                let speeds = dive.observations[bin.first..bin.first + bin.samples].iter().map(|o| o.speed_m_s);
                squares += speeds.filter(|v| v.is_finite()).map(|v| (v - bin.mean.speed_m_s).powi(2)).sum::<f64>();
                freedom += bin.speeds - 1;
                inverses += 1.0 / bin.speeds as f64;
                bins += 1;
            }
        }
        // One speed in each bin: all of them weigh alike.
        if freedom == 0 {
            return SpeedNoise::default();
        }
        SpeedNoise { variance: squares / freedom as f64, mean_inverse: inverses / bins as f64 }
    }

    /// What the variance of this bin's mean is beside the mean of all bins \[m2/s2\].
    fn excess(&self, bin: &Bin) -> f64 {
        if bin.speeds == 0 { 0.0 } else { self.variance * (1.0 / bin.speeds as f64 - self.mean_inverse) }
    }
}

impl Dive {
    fn new(
        log: Arc<[Observation]>,
        observations: Vec<Observation>,
        root_weights: Vec<f64>,
        before: [usize; 2],
    ) -> Self {
        let mut weights = root_weights.iter().map(|root| root * root);
        let bins = bins(&observations, usize::MAX, 1);
        let bin_weights: Vec<f64> = bins.iter().map(|bin| weights.by_ref().take(bin.samples).sum()).collect();
        Dive {
            guesses: vec![None; bins.len()],
            inside: vec![Inside::NOTHING; bins.len()],
            bin_root_weights: bin_weights.into_iter().map(f64::sqrt).collect(),
            parts: Parts::new(&bins, &observations, &log),
            bins,
            root_weights,
            speed_noise: SpeedNoise::default(),
            before,
            observations,
            log,
        }
    }

    /// The same dive of a glider whose forces balance at every moment.
    pub fn without_inertia(self) -> Self {
        let inside = vec![Inside::NOTHING; self.bins.len()];
        Dive { parts: self.parts.without_inertia(), inside, ..self }
    }

    /// Whether forces are taken to balance at every moment.
    pub fn is_quasi_steady(&self) -> bool {
        self.parts.is_quasi_steady()
    }

    /// The residual of each of its steady samples at these parameters.
    pub fn residuals(&self, parameters: &Parameters<f64>) -> Vec<Residual> {
        let residuals = if self.is_quasi_steady() { residuals_at_rest } else { residuals };
        residuals(parameters, &self.observations)
    }

    /// What happens inside each of its bins at these parameters.
    pub fn inside(&self, parameters: &Parameters<f64>) -> Vec<Inside> {
        self.parts.inside(parameters, &self.bins)
    }

    /// The same dive among others that show what a few speeds scatter by.
    fn with_speed_noise(self, speed_noise: SpeedNoise) -> Self {
        Dive { speed_noise, ..self }
    }

    /// Every `every`-th bin of the log.
    pub(super) fn stretches(&mut self, every: usize) -> impl Iterator<Item = Stretch<'_>> {
        let parts = self.bins.iter().zip(&self.inside).zip(&mut self.guesses).zip(&self.bin_root_weights);
        let noise = self.speed_noise;
        let stretches = parts.map(move |(((bin, inside), guess), root)| {
            let speed_excess = noise.excess(bin);
            Stretch { bin, inside, guess, root_weight: *root, speed_excess }
        });
        stretches.skip((every - self.before[1] % every) % every).step_by(every)
    }

    /// Every `every`-th sample of the log with the root of its weight.
    pub(super) fn samples(&self, every: usize) -> impl Iterator<Item = (&Observation, f64)> {
        let samples = self.observations.iter().zip(self.root_weights.iter().copied());
        samples.skip((every - self.before[0] % every) % every).step_by(every)
    }

    /// Takes what happens along each leg as it is at these parameters.
    pub(super) fn update_inertia(&mut self, parameters: &Parameters<f64>) {
        self.inside = self.parts.inside(parameters, &self.bins);
    }

    /// Every `every`-th sample of the log, as a dive; nothing where none is left.
    pub(super) fn subsampled(&self, every: usize) -> Option<Dive> {
        self.part(|i, _| (self.before[0] + i).is_multiple_of(every))
    }

    /// The samples for which `keep` is true, their weights as they were; nothing where none is left.
    pub(super) fn part(&self, keep: impl Fn(usize, &Observation) -> bool) -> Option<Dive> {
        let kept = || (0..self.observations.len()).filter(|&i| keep(i, &self.observations[i]));
        let observations: Vec<Observation> = kept().map(|i| self.observations[i]).collect();
        let root_weights = kept().map(|i| self.root_weights[i]).collect();
        if observations.is_empty() {
            return None;
        }
        let part = Dive::new(self.log.clone(), observations, root_weights, self.before);
        let part = part.with_speed_noise(self.speed_noise);
        Some(if self.is_quasi_steady() { part.without_inertia() } else { part })
    }
}

/// A sample stands for no more than this long, or this many times the median in its dive: a gap is no measurement.
const LONGEST_S: f64 = 60.0;
const LONGEST: f64 = 5.0;

/// Root of the time that each sample of a dive stands for, against their mean.
pub(super) fn root_weights(observations: &[Observation]) -> Vec<f64> {
    let durations = durations_s(observations);
    let mean_s = durations.iter().sum::<f64>() / durations.len() as f64;
    durations.iter().map(|duration| (duration / mean_s).sqrt()).collect()
}

/// The time that each sample stands for: half of that between its neighbours on the leg, all alike where there are none.
fn durations_s(observations: &[Observation]) -> Vec<f64> {
    let step = |i: usize, j: usize| {
        let (a, b) = (observations.get(i)?, observations.get(j)?);
        let step = b.time_s - a.time_s;
        (a.leg == b.leg && step > 0.0).then_some(step)
    };
    let mut durations: Vec<f64> = (0..observations.len())
        .map(|i| match (i.checked_sub(1).and_then(|before| step(before, i)), step(i, i + 1)) {
            (Some(before), Some(after)) => 0.5 * (before + after),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => f64::NAN,
        })
        .collect();
    let mut known: Vec<f64> = durations.iter().copied().filter(|duration| duration.is_finite()).collect();
    let median_s = if known.is_empty() { 1.0 } else { crate::log::median(&mut known) };
    for duration in &mut durations {
        *duration = if duration.is_finite() { duration.min(LONGEST_S.max(LONGEST * median_s)) } else { median_s };
    }
    durations
}

/// The steady samples grouped by dive. Dives without any are left out.
pub fn by_dive(observations: &[Observation]) -> Vec<Dive> {
    let dives: Vec<(Arc<[Observation]>, Vec<Observation>)> = ranges(observations, |o| o.dive)
        .into_iter()
        .map(|range| {
            let log = &observations[range];
            (log.into(), log.iter().filter(|o| o.steady).copied().collect::<Vec<_>>())
        })
        .filter(|(_, samples)| !samples.is_empty())
        .collect();
    // Dives that were sampled more often than others weigh no more for it.
    let durations: Vec<Vec<f64>> = dives.iter().map(|(_, dive)| durations_s(dive)).collect();
    let samples: usize = dives.iter().map(|(_, dive)| dive.len()).sum();
    let mean_s = durations.iter().flatten().sum::<f64>() / samples as f64;
    let mut before = [0, 0];
    let dives: Vec<Dive> = dives
        .into_iter()
        .zip(durations)
        .map(|((log, observations), durations)| {
            let root_weights = durations.into_iter().map(|duration_s| (duration_s / mean_s).sqrt()).collect();
            let dive = Dive::new(log, observations, root_weights, before);
            before[0] += dive.observations.len();
            before[1] += dive.bins.len();
            dive
        })
        .collect();
    let speed_noise = SpeedNoise::estimate(&dives);
    dives.into_iter().map(|dive| dive.with_speed_noise(speed_noise)).collect()
}

/// Runs of samples with one value of a key.
pub fn ranges(observations: &[Observation], key: fn(&Observation) -> u32) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for (i, observation) in observations.iter().enumerate() {
        match ranges.last_mut() {
            Some(last) if key(&observations[last.start]) == key(observation) => last.end = i + 1,
            _ => ranges.push(i..i + 1),
        }
    }
    ranges
}
