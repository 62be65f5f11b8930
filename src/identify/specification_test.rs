//! The same fit weighed once more, otherwise, as a test of the model (Hausman 1978).
//!
//! Weighed by the time that bins stand for, a fit asks for the level of the residuals; by their correlated noise
//! (generalised least squares), for the answer to quick changes. Where the model is right both have the same truth, and the
//! difference scatters about zero; where something that goes with a parameter is missing, as a lag, it does not:
//! ```text
//! D = t(noise) - t(time),      z = D / se(D),   se(D) by leaving out one dive at a time in both
//! ```
//! Where they disagree, two answers of one model to one question tell how far off it is: their standard deviation is
//! `|D|/sqrt 2`. As that of what every such answer is about, it belongs to the errors of the parameters, all of which move
//! together along `D`.
//! Knows a fit and its dives; what is to be said about it others decide.

use nalgebra::{DMatrix, DVector, SVector};
use num_dual::DualSVec64;

use super::data::{Dive, Stretch};
use super::evaluate::{by_size, with_derivatives};
use super::gram::Gram;
use super::joint::Fit;
use super::uncertainty::solve_symmetric;
use crate::glide::Glider;
use crate::noise::{Lasting, Series, estimate, whiten};

/// Of more bins than this whole dives are left out, evenly: the noise is estimated from all of them at once.
const MOST_BINS: usize = 20_000;

/// Fewest dives whose scatter says what a difference is worth.
const LEAST_DIVES: usize = 8;

/// A difference of so many of its standard errors is one: a probability of one in a hundred with 14 dives, to the safe side
/// for being looked for in each parameter.
const DIFFERENT: f64 = 3.5;

/// Two weighings that disagree.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reweighed {
    /// By how much the free parameters move from the one by time to the one by the correlated noise.
    pub differences: Vec<f64>,
    /// Places among them of those that depend on the weighing by more than their 95 % intervals allow.
    pub named: Vec<usize>,
}

impl Reweighed {
    /// One standard error of the model.
    pub(super) fn model_error(&self) -> Vec<f64> {
        self.differences.iter().map(|difference| difference / std::f64::consts::SQRT_2).collect()
    }
}

/// The other weighing of a fit, if any of its free parameters depends on that.
pub(super) fn reweighed(fit: &Fit, dives: &mut [Dive]) -> Option<Reweighed> {
    let bins: usize = dives.iter().map(|dive| dive.bins.len()).sum();
    let every = bins.div_ceil(MOST_BINS).max(1);
    let by_time: Vec<Gram> = fit.grams.iter().step_by(every).cloned().collect();
    let mut chosen: Vec<&mut Dive> = dives.iter_mut().step_by(every).collect();
    if chosen.len() < LEAST_DIVES || fit.free.is_empty() {
        return None;
    }
    let by_noise = weighed_by_noise(fit, &mut chosen)?;
    let (of_time, of_noise) = (Steps::new(fit.free.len(), &by_time)?, Steps::new(fit.free.len(), &by_noise)?);
    let differences: Vec<f64> = (&of_noise.whole - &of_time.whole).iter().copied().collect();
    let named: Vec<usize> = (0..fit.free.len())
        .filter(|&i| {
            let difference = differences[i];
            let without: Vec<f64> = of_noise.without.iter().zip(&of_time.without).map(|(n, t)| n[i] - t[i]).collect();
            let count = without.len() as f64;
            let mean = without.iter().sum::<f64>() / count;
            let scatter: f64 = without.iter().map(|one| (one - mean).powi(2)).sum();
            let se = (scatter * (count - 1.0) / count).sqrt();
            let [low, high] = [-1.96, 1.96].map(|z| z * fit.se(i));
            difference.abs() > DIFFERENT * se && !(low..=high).contains(&difference)
        })
        .collect();
    (!named.is_empty()).then_some(Reweighed { differences, named })
}

/// Steps of Gauss and Newton from a fit, with all dives and without each.
struct Steps {
    whole: DVector<f64>,
    without: Vec<DVector<f64>>,
}

impl Steps {
    fn new(n: usize, grams: &[Gram]) -> Option<Steps> {
        let all = Gram::sum(n, grams);
        let (normal, gradient) = (all.normal_matrix(), all.gradient());
        let without = |gram: &Gram| -solve_symmetric(&(&normal - gram.normal_matrix()), &(&gradient - gram.gradient()));
        let steps = Steps { whole: -solve_symmetric(&normal, &gradient), without: grams.iter().map(without).collect() };
        let is_finite = |step: &DVector<f64>| step.iter().all(|x| x.is_finite());
        let all_are = is_finite(&steps.whole) && steps.without.iter().all(is_finite);
        all_are.then_some(steps)
    }
}

/// Residuals and slopes at the fit, whitened by the noise of each quantity, into one matrix a dive.
fn weighed_by_noise(fit: &Fit, dives: &mut [&mut Dive]) -> Option<Vec<Gram>> {
    let n = fit.free.len();
    let mut grams = vec![Gram::new(n); dives.len()];
    for quantity in rows(fit, dives) {
        if quantity.residual.is_empty() {
            continue;
        }
        if quantity.residual.len() < 4 * (n + 1) {
            return None;
        }
        let slopes = DMatrix::from_row_slice(quantity.residual.len(), n, &quantity.slopes);
        let residual = DVector::from_vec(quantity.residual);
        let series = Series { time_s: &quantity.time_s, stated_sd: &quantity.stated_sd, place: &[] };
        let noise = estimate(series, Lasting::Minutes, &residual, &slopes);
        let mut columns = slopes.insert_column(n, 0.0);
        columns.column_mut(n).copy_from(&residual);
        whiten(series, &noise, &mut columns);
        for (row, dive) in columns.row_iter().zip(&quantity.dive) {
            // The residual's own slope is less the prediction's.
            let row: Vec<f64> = row.iter().enumerate().map(|(j, x)| if j < n { -x } else { *x }).collect();
            grams[*dive].add_row(&row);
        }
    }
    Some(grams)
}

/// The rows of one quantity in the order of time.
#[derive(Default)]
struct Rows {
    dive: Vec<usize>,
    time_s: Vec<f64>,
    stated_sd: Vec<f64>,
    residual: Vec<f64>,
    /// Of the prediction, row by row.
    slopes: Vec<f64>,
}

/// Downward velocity, and speed where it took part.
fn rows(fit: &Fit, dives: &mut [&mut Dive]) -> [Rows; 2] {
    let (mut sink, mut speed) = (Rows::default(), Rows::default());
    by_size!(fit.free.len(), [6, 12, 32], N => {
        let lifted = Glider::new(with_derivatives::<N>(&fit.parameters, &fit.free));
        for (dive, of_dive) in dives.iter_mut().enumerate() {
            for Stretch { bin, inside, guess, .. } in of_dive.stretches(1) {
                let Some(predicted) = inside.predict(&lifted, bin, *guess) else { continue };
                let add = |rows: &mut Rows, measured: f64, predicted: &DualSVec64<N>, stated_sd: f64| {
                    rows.dive.push(dive);
                    rows.time_s.push(bin.mean.time_s);
                    rows.stated_sd.push(stated_sd);
                    rows.residual.push(measured - predicted.re);
                    let slopes = predicted.eps.0.unwrap_or_else(SVector::zeros);
                    rows.slopes.extend(slopes.iter().take(fit.free.len()));
                };
                add(&mut sink, bin.mean.sink_m_s, &predicted.sink_m_s, bin.sink_sd_m_s);
                if fit.weights.speed_m_s.is_finite() && bin.mean.speed_m_s.is_finite() {
                    add(&mut speed, bin.mean.speed_m_s, &predicted.speed_m_s, bin.speed_sd_m_s);
                }
            }
        }
    });
    [sink, speed]
}
