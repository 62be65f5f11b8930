//! The samples of a fit, dive by dive: the unit in which residuals are taken to be independent.
//!
//! A sample weighs as much as the time it stands for. The water's own motion lasts for minutes: neighbours closer than
//! that say the same thing again, and a glider that samples the upper water four times as often as the deep would
//! otherwise have its hull constants from the upper water alone.

use std::ops::Range;

use super::inertia::{Inertia, inertia};
use crate::dynamics::Parameters;
use crate::log::Observation;

/// One dive: the steady samples of a descent and the ascent after it.
#[derive(Debug, Clone)]
pub struct Dive {
    /// Its samples.
    pub observations: Vec<Observation>,
    /// Solutions for the parameters tried last, from which the next ones start.
    guesses: Vec<Option<[f64; 2]>>,
    /// The inertia of each, by the parameters told last.
    inertia: Vec<Inertia>,
    /// Root of the time that each sample stands for, against the mean.
    root_weights: Vec<f64>,
    /// Samples of the dives before, so that every n-th sample is one of the whole log, however short the dives.
    before: usize,
}

impl Dive {
    /// The first dive of a log; [`by_dive`] gives each its place.
    fn new(observations: Vec<Observation>) -> Self {
        Dive {
            guesses: vec![None; observations.len()],
            inertia: observations.iter().map(Inertia::none).collect(),
            root_weights: root_weights(&observations),
            before: 0,
            observations,
        }
    }

    /// Every `every`-th sample of the log with its first guess and the root of its weight.
    pub(super) fn every(&mut self, every: usize) -> impl Iterator<Item = Sample<'_>> {
        let parts = self.observations.iter().zip(&self.inertia).zip(&mut self.guesses).zip(&self.root_weights);
        parts
            .map(|(((observed, inertia), guess), root)| Sample { observed, inertia, guess, root_weight: *root })
            .skip((every - self.before % every) % every)
            .step_by(every)
    }

    /// Takes the inertia along each leg as it is at these parameters.
    pub(super) fn settle(&mut self, parameters: &Parameters<f64>) {
        self.inertia = inertia(parameters, &self.observations);
    }

    /// Every `every`-th sample of the log, as a dive; nothing where none is left.
    pub(super) fn thinned(&self, every: usize) -> Option<Dive> {
        self.part(|i, _| (self.before + i).is_multiple_of(every))
    }

    /// The samples for which `keep` is true, their weights as they were; nothing where none is left.
    pub(super) fn part(&self, keep: impl Fn(usize, &Observation) -> bool) -> Option<Dive> {
        let kept = || (0..self.observations.len()).filter(|&i| keep(i, &self.observations[i]));
        let part = Dive {
            observations: kept().map(|i| self.observations[i]).collect(),
            guesses: kept().map(|i| self.guesses[i]).collect(),
            inertia: kept().map(|i| self.inertia[i]).collect(),
            root_weights: kept().map(|i| self.root_weights[i]).collect(),
            before: self.before,
        };
        (!part.observations.is_empty()).then_some(part)
    }
}

/// One sample of a dive.
pub(super) struct Sample<'d> {
    pub observed: &'d Observation,
    pub inertia: &'d Inertia,
    /// The solution for the parameters tried last.
    pub guess: &'d mut Option<[f64; 2]>,
    pub root_weight: f64,
}

/// A sample stands for no more than this long, or this many times what is usual in its dive: a gap is no measurement.
const LONGEST_S: f64 = 60.0;
const LONGEST: f64 = 5.0;

/// Root of the time that each sample of a dive stands for, against their mean.
pub(super) fn root_weights(observations: &[Observation]) -> Vec<f64> {
    let durations = durations_s(observations);
    let mean_s = mean(&durations);
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
    let usual = if known.is_empty() { 1.0 } else { crate::log::median(&mut known) };
    for duration in &mut durations {
        *duration = if duration.is_finite() { duration.min(LONGEST_S.max(LONGEST * usual)) } else { usual };
    }
    durations
}

fn mean(values: &[f64]) -> f64 {
    if values.is_empty() { 1.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
}

/// The steady samples grouped by dive. Dives without any are left out.
pub fn by_dive(observations: &[Observation]) -> Vec<Dive> {
    let mut dives: Vec<Dive> = ranges(observations, |o| o.dive)
        .into_iter()
        .map(|range| observations[range].iter().filter(|o| o.steady).copied().collect::<Vec<_>>())
        .filter(|samples| !samples.is_empty())
        .map(Dive::new)
        .collect();
    // Dives that were sampled more often than others weigh no more for it.
    let means: Vec<f64> = dives.iter().map(|dive| mean(&durations_s(&dive.observations))).collect();
    let samples: usize = dives.iter().map(|dive| dive.observations.len()).sum();
    let time_s: f64 = dives.iter().zip(&means).map(|(dive, mean_s)| dive.observations.len() as f64 * mean_s).sum();
    for (dive, mean_s) in dives.iter_mut().zip(means) {
        let factor = (mean_s * samples as f64 / time_s).sqrt();
        dive.root_weights.iter_mut().for_each(|root| *root *= factor);
    }
    let mut before = 0;
    for dive in &mut dives {
        dive.before = before;
        before += dive.observations.len();
    }
    dives
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
