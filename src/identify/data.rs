//! The samples of a fit, dive by dive: the unit in which residuals are taken to be independent.

use std::ops::Range;

use crate::log::Observation;

/// One dive: the steady samples of a descent and the ascent after it.
#[derive(Debug, Clone)]
pub struct Dive {
    /// Its samples.
    pub observations: Vec<Observation>,
    /// Solutions for the parameters tried last, from which the next ones start.
    guesses: Vec<Option<[f64; 2]>>,
}

impl Dive {
    /// A dive of these samples.
    pub fn new(observations: Vec<Observation>) -> Self {
        let guesses = vec![None; observations.len()];
        Dive { observations, guesses }
    }

    /// Every sample with its first guess.
    pub(super) fn with_guesses(&mut self) -> impl Iterator<Item = (&Observation, &mut Option<[f64; 2]>)> {
        self.observations.iter().zip(&mut self.guesses)
    }
}

/// The steady samples grouped by dive. Dives without any are left out.
pub fn by_dive(observations: &[Observation]) -> Vec<Dive> {
    ranges(observations, |o| o.dive)
        .into_iter()
        .map(|range| observations[range].iter().filter(|o| o.steady).copied().collect::<Vec<_>>())
        .filter(|samples| !samples.is_empty())
        .map(Dive::new)
        .collect()
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
