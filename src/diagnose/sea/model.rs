//! The steady glide of one bin, with its slopes in every direction that a fit may go.

use nalgebra::{Const, U1};
use num_dual::{Derivative, DualSVec64};

use super::bins::Bin;
use crate::dynamics::{Parameters, parameter_index};
use crate::glide::Glider;
use crate::identify::predict;

/// Most parameters that can be varied at once.
pub const MAX_DIRECTIONS: usize = 24;

type Dual = DualSVec64<MAX_DIRECTIONS>;

/// A value and its slopes.
pub type Slopes = (f64, [f64; MAX_DIRECTIONS]);

/// Which rows of the table of parameters are varied, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Directions {
    rows: Vec<usize>,
}

impl Directions {
    pub fn new(baseline: &[usize]) -> Self {
        Directions { rows: baseline.to_vec() }
    }

    /// The direction of a row, a new one where it has none yet; none where there is no room.
    pub fn of(&mut self, row: usize) -> Option<usize> {
        if let Some(direction) = self.rows.iter().position(|known| *known == row) {
            return Some(direction);
        }
        (self.rows.len() < MAX_DIRECTIONS).then(|| {
            self.rows.push(row);
            self.rows.len() - 1
        })
    }

    pub fn len(&self) -> usize {
        self.rows.len()
    }

    pub fn parameter(&self, direction: usize) -> usize {
        self.rows[direction]
    }
}

/// The vehicle at one point of a fit, before and after the jump of its drag.
pub struct Vehicle {
    before: Glider<Dual>,
    after: Glider<Dual>,
    jump_s: f64,
}

impl Vehicle {
    pub fn new(parameters: &Parameters<f64>, directions: &Directions) -> Self {
        let mut p = parameters.map(Dual::from);
        for (direction, row) in directions.rows.iter().enumerate() {
            let value = p.at(*row).re;
            *p.at(*row) = Dual::new(value, Derivative::derivative_generic(Const, U1, direction));
        }
        // The slope along a jump is wanted on both sides of it: the caller knows which rows a jump reaches.
        let jump_s = p.step_time_s.re;
        p.step_time_s = Dual::from(f64::NEG_INFINITY);
        let after = Glider::new(p);
        if let Some(row) = parameter_index("drag_step") {
            let step = *p.at(row);
            *p.at(row) = step - step.re;
        }
        Vehicle { before: Glider::new(p), after, jump_s }
    }

    /// Vertical velocity and speed as the instruments would read them. Where no glide balances the glider stands still:
    /// no velocity, no slope.
    pub fn fly(&self, bin: &Bin) -> (Slopes, Slopes) {
        let glider = if bin.mean.time_s < self.jump_s { &self.before } else { &self.after };
        let still = (0.0, [0.0; MAX_DIRECTIONS]);
        predict(glider, &bin.mean, None).map_or((still, still), |read| (parts(read.sink_m_s), parts(read.speed_m_s)))
    }
}

/// Whether the vehicle flies at all as this bin says.
pub fn flies(parameters: &Parameters<f64>, bin: &Bin) -> bool {
    predict(&Glider::new(*parameters), &bin.mean, None).is_some()
}

/// Takes the inertia of each bin off the weight that drives it, so that the steady glide of what is left sinks as the
/// accelerating glider does.
///
/// Along the path `M dV/dt = -m0 g sin xi - D` with `M` the mass and its added mass along axis 1. With `w = -V sin xi`
/// this is the steady balance of the net mass `m0 - M w' / (g sin^2 xi)`; the pitch stands in for the path, which is
/// steeper by a few degrees, in a term that is small itself. `w'` is that of the model, from bin to bin: the measured
/// one holds the water's own accelerations, which carry the glider along. It also is what a late pressure goes by.
pub fn take_inertia_off(parameters: &Parameters<f64>, bins: &mut [Bin]) {
    let glider = Glider::new(*parameters);
    let sinks: Vec<f64> =
        bins.iter().map(|bin| predict(&glider, &bin.mean, None).map_or(0.0, |read| read.sink_m_s)).collect();
    let mass = parameters.mass_kg() + parameters.added_mass_1_kg;
    for i in 0..bins.len() {
        let low = if i > 0 && bins[i - 1].mean.leg == bins[i].mean.leg { i - 1 } else { i };
        let high = if bins.get(i + 1).is_some_and(|next| next.mean.leg == bins[i].mean.leg) { i + 1 } else { i };
        if high > low {
            let acceleration = (sinks[high] - sinks[low]) / (bins[high].mean.time_s - bins[low].mean.time_s);
            let mean = &mut bins[i].mean;
            mean.sink_rate_m_s2 = acceleration;
            let sin = mean.pitch_rad.sin();
            let lost_kg = mass * acceleration / (parameters.gravity_m_s2 * (sin * sin).max(LEAST_SQUARE_OF_SINE));
            mean.ballast_m3 += lost_kg / parameters.true_density_kg_m3(mean.density_kg_m3);
        }
    }
}

/// Square of the sine of the shallowest path for which the inertia is taken off in full, 12 deg.
const LEAST_SQUARE_OF_SINE: f64 = 0.04;

fn parts(value: Dual) -> Slopes {
    let slopes = value.eps.0.map_or([0.0; MAX_DIRECTIONS], |eps| std::array::from_fn(|i| eps[i]));
    (value.re, slopes)
}
