//! Residuals and their exact slopes over all dives, on all cores, without holding them.
//!
//! The parameters that are free carry derivatives (dual numbers) through the steady glide; a sample costs one solution
//! in plain numbers, from the last one nearby, and one evaluation with derivatives. Nothing is allocated.

use num_dual::{Derivative, DualSVec64};
use rayon::prelude::*;

use super::data::Dive;
use super::gram::Gram;
use super::model::{Prediction, predict};
use crate::dynamics::Parameters;
use crate::glide::Glider;

/// By how much one sample of each quantity scatters, the correlation of neighbours counted in: a residual divided by
/// this weighs as much as an independent one of unit variance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    /// Of the downward velocity \[m/s\].
    pub sink_m_s: f64,
    /// Of the measured speed \[m/s\]; infinite where it is not to be used.
    pub speed_m_s: f64,
}

/// How one quantity scatters about its prediction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Scatter {
    /// Number of samples.
    pub n: usize,
    /// Sum of the residuals, measured less predicted.
    pub sum: f64,
    /// Sum of their squares.
    pub sum_of_squares: f64,
    /// Sum over the legs of the squared sum of the residuals of a leg.
    pub sum_of_leg_squares: f64,
}

impl Scatter {
    pub(super) fn close_leg(&mut self, leg_sum: &mut f64) {
        self.sum_of_leg_squares += *leg_sum * *leg_sum;
        *leg_sum = 0.0;
    }

    pub(super) fn add(&mut self, residual: f64) {
        self.n += 1;
        self.sum += residual;
        self.sum_of_squares += residual * residual;
    }

    pub(super) fn merge(self, other: Scatter) -> Scatter {
        Scatter {
            n: self.n + other.n,
            sum: self.sum + other.sum,
            sum_of_squares: self.sum_of_squares + other.sum_of_squares,
            sum_of_leg_squares: self.sum_of_leg_squares + other.sum_of_leg_squares,
        }
    }

    /// Root mean square.
    pub fn rms(&self) -> f64 {
        (self.sum_of_squares / self.n as f64).sqrt()
    }

    /// Mean.
    pub fn bias(&self) -> f64 {
        self.sum / self.n as f64
    }

    /// How many neighbouring samples say together what one independent sample would: the variance of sums over legs
    /// against that of independent samples.
    pub fn correlated_samples(&self) -> f64 {
        if self.sum_of_squares > 0.0 { (self.sum_of_leg_squares / self.sum_of_squares).max(1.0) } else { 1.0 }
    }
}

/// What came out over all dives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tally {
    /// Downward velocity \[m/s\].
    pub sink: Scatter,
    /// Speed through the water \[m/s\].
    pub speed: Scatter,
    /// Samples at whose pitch and net mass no glide exists; they count as predicted at rest.
    pub unflyable: usize,
}

impl Tally {
    pub(super) fn merge(self, other: Tally) -> Tally {
        Tally {
            sink: self.sink.merge(other.sink),
            speed: self.speed.merge(other.speed),
            unflyable: self.unflyable + other.unflyable,
        }
    }
}

/// Most parameters that can be free at once.
pub const MOST_FREE: usize = 32;

/// Residuals and slopes over the dives, into one matrix per dive; every `every`-th sample of a dive.
///
/// `free` are rows of [`PARAMETERS`](crate::dynamics::PARAMETERS).
///
/// # Panics
/// When more than [`MOST_FREE`] parameters are free.
pub fn evaluate(
    parameters: &Parameters<f64>,
    free: &[usize],
    weights: Weights,
    dives: &mut [Dive],
    grams: &mut [Gram],
    every: usize,
) -> Tally {
    macro_rules! by_size {
        ($($size:literal),*) => {
            $(if free.len() <= $size {
                return evaluate_sized::<$size>(parameters, free, weights, dives, grams, every);
            })*
        };
    }
    by_size!(2, 3, 4, 5, 6, 8, 10, 12, 16, 24, 32);
    panic!("{} parameters are free, {MOST_FREE} can be", free.len())
}

fn evaluate_sized<const N: usize>(
    parameters: &Parameters<f64>,
    free: &[usize],
    weights: Weights,
    dives: &mut [Dive],
    grams: &mut [Gram],
    every: usize,
) -> Tally {
    let lifted = Glider::new(with_derivatives::<N>(parameters, free));
    let work = |(dive, gram): (&mut Dive, &mut Gram)| dive_rows(&lifted, free.len(), weights, dive, gram, every);
    dives.par_iter_mut().zip(grams.par_iter_mut()).map(work).reduce(Tally::default, Tally::merge)
}

/// Parameters of which the free ones carry a derivative each.
pub(super) fn with_derivatives<const N: usize>(
    parameters: &Parameters<f64>,
    free: &[usize],
) -> Parameters<DualSVec64<N>> {
    let mut lifted = parameters.map(DualSVec64::<N>::from);
    for (i, &row) in free.iter().enumerate() {
        lifted.at(row).eps = Derivative::derivative_generic(nalgebra::Const, nalgebra::U1, i);
    }
    lifted
}

fn dive_rows<const N: usize>(
    glider: &Glider<DualSVec64<N>>,
    n: usize,
    weights: Weights,
    dive: &mut Dive,
    gram: &mut Gram,
    every: usize,
) -> Tally {
    gram.clear();
    let mut tally = Tally::default();
    let mut row = [0.0; MOST_FREE + 1];
    let mut leg = u32::MAX;
    let (mut sink_sum, mut speed_sum) = (0.0, 0.0);
    for (observed, guess, root_weight) in dive.every(every) {
        if observed.leg != leg {
            leg = observed.leg;
            tally.sink.close_leg(&mut sink_sum);
            tally.speed.close_leg(&mut speed_sum);
        }
        let predicted = predict(glider, observed, *guess);
        *guess = predicted.map(|p: Prediction<_>| p.guess);
        if predicted.is_none() {
            tally.unflyable += 1;
        }
        let mut put = |observed: f64, predicted: Option<DualSVec64<N>>, weight: f64| {
            let residual = observed - predicted.map_or(0.0, |p| p.re);
            row[..n].fill(0.0);
            if let Some(slopes) = predicted.and_then(|p| p.eps.0) {
                for (cell, slope) in row[..n].iter_mut().zip(slopes.iter()) {
                    *cell = -slope * root_weight / weight;
                }
            }
            row[n] = residual * root_weight / weight;
            gram.add_row(&row[..=n]);
            residual
        };
        let residual = put(observed.sink_m_s, predicted.map(|p| p.sink_m_s), weights.sink_m_s);
        tally.sink.add(residual);
        sink_sum += residual;
        if observed.speed_m_s.is_finite() && weights.speed_m_s.is_finite() {
            let residual = put(observed.speed_m_s, predicted.map(|p| p.speed_m_s), weights.speed_m_s);
            tally.speed.add(residual);
            speed_sum += residual;
        }
    }
    tally.sink.close_leg(&mut sink_sum);
    tally.speed.close_leg(&mut speed_sum);
    tally
}
