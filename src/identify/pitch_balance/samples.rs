//! Samples of which the pitch is what is predicted: the balance of moments solved for it. Knows no starts and no pins.

use num_dual::{Dual64, DualSVec64};

use crate::Number;
use crate::dynamics::Parameters;
use crate::glide::{Attitude, at_pitch};
use crate::identify::blocks::Blocks;
use crate::identify::data::Dive;
use crate::identify::evaluate::{Rows, Tally, Weights, by_block, by_size, with_derivatives};
use crate::identify::model::{surroundings, true_pitch_rad};
use crate::log::Observation;
use glidepolar_inference::gram::Gram;

/// The pitch that battery and ballast give, as the instrument reads it; `near_rad` is where the search begins.
pub fn predicted_pitch_rad<T: Number>(
    parameters: &Parameters<T>,
    with_slope: &Parameters<Dual64>,
    observed: &Observation,
    near_rad: f64,
) -> Option<T> {
    const TOLERANCE_RAD: f64 = 1e-7;
    let water = surroundings(with_slope, observed);
    let net_mass_kg = with_slope.net_mass_kg(Dual64::from(observed.ballast_m3), &water);
    let mut pitch = near_rad;
    let mut slope = f64::NAN;
    let mut converged = false;
    for _ in 0..30 {
        let attitude = Attitude { pitch_rad: Dual64::from(pitch).derivative(), net_mass_kg };
        let needed = at_pitch(with_slope, &water, attitude).ok()?.moving_mass_m;
        slope = needed.eps;
        let step = (needed.re - observed.battery_forward_m) / slope;
        if !step.is_finite() {
            return None;
        }
        pitch -= step.clamp(-0.1, 0.1);
        if step.abs() < TOLERANCE_RAD {
            converged = true;
            break;
        }
    }
    if !converged {
        return None;
    }
    let mut solution = T::constant(pitch);
    if T::HAS_DERIVATIVES {
        let water = surroundings(parameters, observed);
        let net_mass_kg = parameters.net_mass_kg(T::constant(observed.ballast_m3), &water);
        let needed = at_pitch(parameters, &water, Attitude { pitch_rad: solution, net_mass_kg }).ok()?.moving_mass_m;
        // The value is at the solution already: only the slopes are taken.
        let slopes = needed - needed.value();
        solution -= slopes / slope;
    }
    Some((solution - parameters.pitch_offset_rad) / parameters.pitch_scale)
}

/// Dives of which the pitch is what is predicted; the tally's first quantity is the pitch \[rad\].
pub(super) struct PitchSamples(pub(super) Vec<Dive>);

impl Blocks for PitchSamples {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn samples(&self) -> usize {
        self.0.iter().map(|dive| dive.observations.len()).sum()
    }

    fn has_speed(&self) -> bool {
        false
    }

    fn evaluate(
        &mut self,
        parameters: &Parameters<f64>,
        free: &[usize],
        weights: Weights,
        grams: &mut [Gram],
        every: usize,
    ) -> Tally {
        by_size!(free.len(), [4, 32], N => {
            let lifted = with_derivatives::<N>(parameters, free);
            by_block(&mut self.0, grams, |dive, gram| rows(&lifted, free.len(), weights, dive, gram, every))
        })
    }
}

fn rows<const N: usize>(
    lifted: &Parameters<DualSVec64<N>>,
    n: usize,
    weights: Weights,
    dive: &mut Dive,
    gram: &mut Gram,
    every: usize,
) -> Tally {
    let with_slope = lifted.map(|value| Dual64::from(value.re));
    let mut rows = Rows::new(gram, n, weights);
    for (observed, root_weight) in dive.samples(every) {
        let near = true_pitch_rad(lifted, observed.pitch_rad).re;
        // Where no pitch balances, level flight is what is predicted: nothing is gained by being unable to fly.
        let predicted = predicted_pitch_rad(lifted, &with_slope, observed, near);
        rows.first(observed.leg, observed.pitch_rad, predicted, root_weight);
    }
    rows.close()
}
