//! What a fit asks of its samples, whether they are steady glides or whole dives flown through time.

use rayon::prelude::*;

use super::data::Dive;
use super::evaluate::{Tally, Weights, evaluate};
use crate::dynamics::Parameters;
use glidepolar_inference::gram::Gram;

/// Samples in blocks; residuals of different blocks are taken to be independent.
pub trait Blocks {
    /// How many blocks there are.
    fn count(&self) -> usize;

    /// How many bins, or samples, there are in all.
    fn samples(&self) -> usize;

    /// Whether any sample has a measured speed.
    fn has_speed(&self) -> bool;

    /// Takes the inertia of glides that are nearly steady as it is at these parameters.
    fn update_inertia(&mut self, _parameters: &Parameters<f64>) {}

    /// Residuals and slopes at these parameters, into one matrix a block; of every `every`-th sample where samples stand
    /// alone.
    fn evaluate(
        &mut self,
        parameters: &Parameters<f64>,
        free: &[usize],
        weights: Weights,
        grams: &mut [Gram],
        every: usize,
    ) -> Tally;
}

impl Blocks for &mut [Dive] {
    fn count(&self) -> usize {
        self.len()
    }

    fn samples(&self) -> usize {
        self.iter().map(|dive| dive.bins.len()).sum()
    }

    fn has_speed(&self) -> bool {
        self.iter().flat_map(|dive| &dive.observations).any(|o| o.speed_m_s.is_finite())
    }

    fn update_inertia(&mut self, parameters: &Parameters<f64>) {
        self.par_iter_mut().for_each(|dive| dive.update_inertia(parameters));
    }

    fn evaluate(
        &mut self,
        parameters: &Parameters<f64>,
        free: &[usize],
        weights: Weights,
        grams: &mut [Gram],
        every: usize,
    ) -> Tally {
        evaluate(parameters, free, weights, self, grams, every)
    }
}
