//! The same fit weighed once more, by the correlated noise of its residuals instead of by time: a test of the model
//! ([`glidepolar_inference::specification_test`]).
//!
//! Weighed by the time that bins stand for, a fit asks for the level of the residuals; by their correlated noise
//! (generalised least squares), for the answer to quick changes. Knows a fit and its dives; what is to be said about it
//! others decide.

use nalgebra::{DMatrix, DVector, SVector};
use num_dual::DualSVec64;

use super::data::{Dive, Stretch};
use super::evaluate::{by_size, with_derivatives};
use super::joint::JointFit;
use crate::glide::SteadyGlider;
use crate::noise::{Lasting, Series, whiten};
use glidepolar_inference::gram::Gram;
use glidepolar_inference::restricted_likelihood::estimate;
use glidepolar_inference::specification_test::{Disagreement, LEAST_BLOCKS, compare};

/// Of more bins than this whole dives are left out, evenly: the noise is estimated from all of them at once.
const MOST_BINS: usize = 20_000;

/// The other weighing of a fit, if any of its free parameters depends on that.
pub(super) fn reweighed(fit: &JointFit, dives: &mut [Dive]) -> Option<Disagreement> {
    let bins: usize = dives.iter().map(|dive| dive.bins.len()).sum();
    let every = bins.div_ceil(MOST_BINS).max(1);
    let by_time: Vec<Gram> = fit.grams.iter().step_by(every).cloned().collect();
    let mut chosen: Vec<&mut Dive> = dives.iter_mut().step_by(every).collect();
    if chosen.len() < LEAST_BLOCKS || fit.free.is_empty() {
        return None;
    }
    let by_noise = weighed_by_noise(fit, &mut chosen)?;
    let se: Vec<f64> = (0..fit.free.len()).map(|i| fit.se(i)).collect();
    compare(&se, &by_time, &by_noise)
}

/// Residuals and slopes at the fit, whitened by the noise of each quantity, into one matrix a dive.
fn weighed_by_noise(fit: &JointFit, dives: &mut [&mut Dive]) -> Option<Vec<Gram>> {
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
        let series = Series { time_s: &quantity.time_s, stated_sd: &quantity.stated_sd, place: &[], joined_s: 0.0 };
        let noise = estimate(series, Lasting::Minutes, f64::INFINITY, &residual, &slopes);
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
fn rows(fit: &JointFit, dives: &mut [&mut Dive]) -> [Rows; 2] {
    let (mut sink, mut speed) = (Rows::default(), Rows::default());
    by_size!(fit.free.len(), [6, 12, 32], N => {
        let lifted = SteadyGlider::new(with_derivatives::<N>(&fit.parameters, &fit.free));
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
