//! Residuals and their exact slopes over all dives, on all cores, without holding them.
//!
//! The parameters that are free carry derivatives (dual numbers) through the steady glide; a bin costs one solution
//! in plain numbers, from the last one nearby, and one evaluation with derivatives. Nothing is allocated.

use num_dual::{Derivative, DualSVec64};
use rayon::prelude::*;

use super::data::{Dive, Stretch};
use super::model::Prediction;
use crate::dynamics::Parameters;
use crate::glide::SteadyGlider;
use crate::log::Observation;
use glidepolar_inference::gram::Gram;
use glidepolar_progress::one_more;

/// By how much each quantity scatters: residuals are divided by it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    /// Of the downward velocity \[m/s\].
    pub sink_m_s: f64,
    /// Of the measured speed \[m/s\]; infinite where it is not to be used.
    pub speed_m_s: f64,
}

/// A mean of many speeds has no less than this share of the nominal variance: the water's own motion stays in it.
const LEAST_VARIANCE: f64 = 0.25;

impl Weights {
    /// Root of the weight of a speed whose variance is by so much beside the nominal \[m2/s2\].
    pub(super) fn of_few_speeds(&self, excess: f64) -> f64 {
        let nominal = self.speed_m_s * self.speed_m_s;
        if nominal.is_finite() { (nominal / (nominal + excess).max(LEAST_VARIANCE * nominal)).sqrt() } else { 1.0 }
    }
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
    fn close_leg(&mut self, leg_sum: &mut f64) {
        self.sum_of_leg_squares += *leg_sum * *leg_sum;
        *leg_sum = 0.0;
    }

    fn add(&mut self, residual: f64) {
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

/// Residuals and slopes over the dives, into one matrix per dive; every `every`-th bin of the log.
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
    // Fewer than six slopes are no quicker: two and three take twice as long, as the compiler lays them out.
    by_size!(free.len(), [6, 10, 16, 32], N => {
        let lifted = SteadyGlider::new(with_derivatives::<N>(parameters, free));
        by_block(dives, grams, |dive, gram| dive_rows(&lifted, free.len(), weights, dive, gram, every))
    })
}

/// Runs its body with the smallest of some numbers of slopes that is enough.
///
/// # Panics
/// When none of them is.
macro_rules! by_size {
    ($free:expr, [$($size:literal),*], $n:ident => $body:expr) => {
        match $free {
            $(free if free <= $size => {
                const $n: usize = $size;
                $body
            })*
            free => panic!("{free} parameters are free, {} can be", $crate::identify::evaluate::MOST_FREE),
        }
    };
}
pub(super) use by_size;

/// Every block into its own matrix, on all cores.
pub(super) fn by_block<B: Send>(
    blocks: &mut [B],
    grams: &mut [Gram],
    rows: impl Fn(&mut B, &mut Gram) -> Tally + Sync,
) -> Tally {
    let one = |(block, gram): (&mut B, &mut Gram)| rows(block, gram);
    one_more("flights of the model");
    blocks.par_iter_mut().zip(grams.par_iter_mut()).map(one).reduce(Tally::default, Tally::merge)
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
    glider: &SteadyGlider<DualSVec64<N>>,
    n: usize,
    weights: Weights,
    dive: &mut Dive,
    gram: &mut Gram,
    every: usize,
) -> Tally {
    let mut rows = Rows::new(gram, n, weights);
    for Stretch { bin, inside, guess, root_weight, speed_excess } in dive.stretches(every) {
        let predicted = inside.predict(glider, bin, *guess);
        *guess = predicted.map(|p: Prediction<_>| p.guess);
        let root_weights = [root_weight, root_weight * weights.of_few_speeds(speed_excess)];
        rows.glide(&bin.mean, predicted.map(|p| (p.sink_m_s, p.speed_m_s)), root_weights);
    }
    rows.close()
}

/// Residuals and their slopes on their way into the matrix of one dive, tallied leg by leg.
pub(super) struct Rows<'g> {
    gram: &'g mut Gram,
    n: usize,
    weights: Weights,
    row: [f64; MOST_FREE + 1],
    tally: Tally,
    leg: u32,
    sink_sum: f64,
    speed_sum: f64,
}

impl<'g> Rows<'g> {
    /// Into an emptied matrix of `n` parameters.
    pub(super) fn new(gram: &'g mut Gram, n: usize, weights: Weights) -> Self {
        gram.clear();
        let row = [0.0; MOST_FREE + 1];
        Rows { gram, n, weights, row, tally: Tally::default(), leg: u32::MAX, sink_sum: 0.0, speed_sum: 0.0 }
    }

    /// A sample's downward velocity, and its speed where it was measured and counts; where nothing is predicted the glider
    /// is taken to rest.
    pub(super) fn glide<const N: usize>(
        &mut self,
        observed: &Observation,
        predicted: Option<(DualSVec64<N>, DualSVec64<N>)>,
        [of_sink, of_speed]: [f64; 2],
    ) {
        self.first(observed.leg, observed.sink_m_s, predicted.map(|p| p.0), of_sink);
        if observed.speed_m_s.is_finite() && self.weights.speed_m_s.is_finite() {
            let residual = self.put(observed.speed_m_s, predicted.map(|p| p.1), of_speed, self.weights.speed_m_s);
            self.tally.speed.add(residual);
            self.speed_sum += residual;
        }
    }

    /// A sample's first quantity alone.
    pub(super) fn first<const N: usize>(
        &mut self,
        leg: u32,
        observed: f64,
        predicted: Option<DualSVec64<N>>,
        root_weight: f64,
    ) {
        if leg != self.leg {
            self.leg = leg;
            self.close_leg();
        }
        self.tally.unflyable += usize::from(predicted.is_none());
        let residual = self.put(observed, predicted, root_weight, self.weights.sink_m_s);
        self.tally.sink.add(residual);
        self.sink_sum += residual;
    }

    /// What came out.
    pub(super) fn close(mut self) -> Tally {
        self.close_leg();
        self.tally
    }

    fn put<const N: usize>(
        &mut self,
        observed: f64,
        predicted: Option<DualSVec64<N>>,
        root_weight: f64,
        weight: f64,
    ) -> f64 {
        let residual = observed - predicted.map_or(0.0, |p| p.re);
        let row = &mut self.row[..=self.n];
        row.fill(0.0);
        if let Some(slopes) = predicted.and_then(|p| p.eps.0) {
            for (cell, slope) in row[..self.n].iter_mut().zip(slopes.iter()) {
                *cell = -slope * root_weight / weight;
            }
        }
        row[self.n] = residual * root_weight / weight;
        self.gram.add_row(row);
        residual
    }

    fn close_leg(&mut self) {
        self.tally.sink.close_leg(&mut self.sink_sum);
        self.tally.speed.close_leg(&mut self.speed_sum);
    }
}
