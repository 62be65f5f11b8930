//! Rates of change with their exact slopes, by dual numbers through the very equations that give the rates.

use nalgebra::SVector;
use num_dual::{Derivative, DualSVec64};

/// A number with its slopes in `L` directions.
pub type Jet<const L: usize> = DualSVec64<L>;

/// Rates of change of `N` states and how they change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slopes<const N: usize, const F: usize> {
    /// Rates of change.
    pub rates: [f64; N],
    /// `jacobian[i][j]`: the slope of rate `i` along the state `j` of those that are felt, times the nominal size of that
    /// state.
    pub jacobian: [[f64; F]; N],
    /// Their slopes along time.
    pub in_time: [f64; N],
}

impl<const N: usize, const F: usize> Slopes<N, F> {
    /// Slopes of `rates` at a time and state, along the `F` states from `first_felt` on and along time. `L` is `F + 1`.
    pub fn new<const L: usize>(
        time_s: f64,
        state: &[f64; N],
        (first_felt, nominals): (usize, &[f64; N]),
        rates: impl FnOnce(Jet<L>, [Jet<L>; N]) -> [Jet<L>; N],
    ) -> Self {
        const { assert!(L == F + 1, "one direction for every state that is felt, and one for time") };
        let mut jets = state.map(Jet::from_re);
        for j in 0..F {
            jets[j + first_felt] = seeded(state[j + first_felt], j, nominals[j + first_felt]);
        }
        let found = rates(seeded(time_s, F, 1.0), jets);
        let mut slopes = Slopes { rates: [0.0; N], jacobian: [[0.0; F]; N], in_time: [0.0; N] };
        for (i, rate) in found.iter().enumerate() {
            slopes.rates[i] = rate.re;
            if let Some(eps) = rate.eps.0 {
                slopes.jacobian[i] = std::array::from_fn(|j| eps[j]);
                slopes.in_time[i] = eps[F];
            }
        }
        slopes
    }

    /// Whether all of them are finite.
    pub(crate) fn are_finite(&self) -> bool {
        let vectors = self.rates.iter().chain(&self.in_time);
        vectors.chain(self.jacobian.iter().flatten()).all(|slope| slope.is_finite())
    }
}

fn seeded<const L: usize>(value: f64, lane: usize, slope: f64) -> Jet<L> {
    let mut eps = SVector::zeros();
    eps[lane] = slope;
    Jet::new(value, Derivative::some(eps))
}
