//! The unsteady mode: the glider flown through its measured pitch, ballast and water, so that turns and accelerating
//! samples take part.
//!
//! Pitch is measured, so the equation of its moment is not needed: what is integrated are the first two rows of the
//! equations of motion ([`accelerations`](crate::dynamics::accelerations)), with the pitch rate of the record,
//! ```text
//! (v1, v3)' = f(v1, v3; pitch(t), pitch rate(t), ballast(t), water(t)),     sink = v3 cos pitch - v1 sin pitch
//! ```
//! Heave settles within a second, surge within half a minute: TR-BDF2 (Bank et al. 1985), which is L-stable and of second
//! order, takes both at the pace of the samples. Each implicit stage is solved in plain numbers; its slopes by the
//! parameters follow from one evaluation with derivatives (implicit function theorem), so that they are exactly those of
//! the discrete solution. The model's depth passes the very filter that made the vertical velocity of the record.
//!
//! A passage begins at rest where the glider floats, in a steady glide where the record begins under way; after the
//! latter, samples count once the start is forgotten.

mod flight;
mod flyer;
mod moment;
mod step;

use num_dual::DualSVec64;

use super::blocks::Blocks;
use super::data::{ranges, root_weights};
use super::evaluate::{Rows, Tally, Weights, by_block, by_size, with_derivatives};
use super::residuals::Residual;
use crate::dynamics::Parameters;
use crate::log::{Observation, filter_windows};
use flight::fly;
use flyer::Flyer;
use glidepolar_inference::gram::Gram;

/// Pressure above which the glider is taken to float at rest \[dbar\].
const AFLOAT_DBAR: f64 = 0.5;

/// Time that a dive is flown before its first sample counts \[s\]: five time constants of surge.
const WARM_UP_S: f64 = 120.0;

/// One dive with what is needed to fly it: the samples, some of the dive before, and which of them count.
#[derive(Debug, Clone)]
pub struct Passage {
    /// Samples in the order of time, those of the run-up first.
    pub observations: Vec<Observation>,
    /// Whether a sample takes part in the fit.
    pub counts: Vec<bool>,
    pitch_rates_rad_s: Vec<f64>,
    /// First and last sample of the filter around each one.
    windows: Vec<(usize, usize)>,
    root_weights: Vec<f64>,
}

/// The dives of a log as passages. Samples above `from_dbar` do not count; `half_window_s` is that of the filter for the
/// vertical velocity.
pub fn passages(observations: &[Observation], from_dbar: f64, half_window_s: f64) -> Vec<Passage> {
    let mut passages = Vec::new();
    for range in ranges(observations, |o| o.dive) {
        // A gap within a dive ends one passage and begins another.
        let mut start = range.start;
        for end in range.start + 1..=range.end {
            if end < range.end && observations[end].stretch == observations[start].stretch {
                continue;
            }
            let stretch = observations[start].stretch;
            let mut first = start;
            while first > 0
                && observations[first - 1].stretch == stretch
                && observations[start].time_s - observations[first - 1].time_s < WARM_UP_S
            {
                first -= 1;
            }
            // The filter of the last sample looks beyond the dive, by its half window and half a step, no more than twice the former.
            let mut last = end;
            while last < observations.len()
                && observations[last].stretch == stretch
                && observations[last].time_s - observations[end - 1].time_s <= 2.0 * half_window_s
            {
                last += 1;
            }
            passages.extend(Passage::new(
                &observations[first..last],
                start - first..end - first,
                from_dbar,
                half_window_s,
            ));
            start = end;
        }
    }
    passages
}

impl Passage {
    fn new(
        observations: &[Observation],
        own: std::ops::Range<usize>,
        from_dbar: f64,
        half_window_s: f64,
    ) -> Option<Passage> {
        let n = observations.len();
        if n < 5 {
            return None;
        }
        let time: Vec<f64> = observations.iter().map(|o| o.time_s).collect();
        let windows = filter_windows(&time, half_window_s);
        let mut known_since_s = f64::NAN;
        let counts: Vec<bool> = (0..n)
            .map(|i| {
                if is_start(observations, i) {
                    let rests = observations[i].pressure_dbar < AFLOAT_DBAR;
                    known_since_s = time[i] + if rests { 0.0 } else { 0.5 * WARM_UP_S };
                }
                let o = &observations[i];
                own.contains(&i)
                    && windows[i].0 < windows[i].1
                    && time[i] >= known_since_s
                    && o.pressure_dbar >= from_dbar
                    && o.sink_m_s.is_finite()
            })
            .collect();
        let rate = |i: usize, j: usize| (observations[j].pitch_rad - observations[i].pitch_rad) / (time[j] - time[i]);
        Some(Passage {
            pitch_rates_rad_s: (0..n).map(|i| rate(i.saturating_sub(1), (i + 1).min(n - 1))).collect(),
            root_weights: root_weights(observations),
            windows,
            counts,
            observations: observations.to_vec(),
        })
        .filter(|passage| passage.counts.contains(&true))
    }

    /// Measured less predicted, sample by sample; NaN where a sample does not count.
    pub fn residuals(&self, parameters: &Parameters<f64>) -> Vec<Residual> {
        let flight = fly(&Flyer::new(*parameters), self);
        (0..self.observations.len())
            .map(|i| {
                let observed = &self.observations[i];
                match flight.at(self, parameters, i).filter(|_| self.counts[i]) {
                    Some((sink, speed)) => Residual {
                        sink_m_s: observed.sink_m_s - sink,
                        speed_m_s: observed.speed_m_s - speed,
                        angle_of_attack_rad: flight.velocity[i][1].atan2(flight.velocity[i][0]),
                        predicted_speed_m_s: speed,
                    },
                    None => Residual::NONE,
                }
            })
            .collect()
    }
}

/// Whether the flight begins anew at this sample.
fn is_start(observations: &[Observation], i: usize) -> bool {
    i == 0 || observations[i].pressure_dbar < AFLOAT_DBAR
}

impl Blocks for Vec<Passage> {
    fn count(&self) -> usize {
        self.len()
    }

    fn samples(&self) -> usize {
        self.iter().map(|passage| passage.counts.iter().filter(|&&counts| counts).count()).sum()
    }

    fn has_speed(&self) -> bool {
        let counted = self.iter().flat_map(|passage| passage.observations.iter().zip(&passage.counts));
        counted.into_iter().any(|(o, &counts)| counts && o.speed_m_s.is_finite())
    }

    /// Time goes on from sample to sample: all of them are flown whatever `every` says.
    fn evaluate(
        &mut self,
        parameters: &Parameters<f64>,
        free: &[usize],
        weights: Weights,
        grams: &mut [Gram],
        _every: usize,
    ) -> Tally {
        by_size!(free.len(), [4, 6, 10, 32], N => {
            let flyer = Flyer::new(with_derivatives::<N>(parameters, free));
            by_block(self, grams, |passage, gram| rows(&flyer, free.len(), weights, passage, gram))
        })
    }
}

fn rows<const N: usize>(
    flyer: &Flyer<DualSVec64<N>>,
    n: usize,
    weights: Weights,
    passage: &Passage,
    gram: &mut Gram,
) -> Tally {
    let flight = fly(flyer, passage);
    let mut rows = Rows::new(gram, n, weights);
    for (i, observed) in passage.observations.iter().enumerate().filter(|(i, _)| passage.counts[*i]) {
        rows.glide(observed, flight.at(passage, &flyer.lifted, i), [passage.root_weights[i]; 2]);
    }
    rows.close()
}
