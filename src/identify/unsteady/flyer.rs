//! The glider in every kind of number that a flight through time needs.

use num_dual::Dual64;

use crate::Number;
use crate::dynamics::Parameters;
use crate::glide::SteadyGlider;

/// The parameters in every kind of number that the flight needs.
pub(super) struct Flyer<T> {
    pub(super) lifted: Parameters<T>,
    pub(super) plain: Parameters<f64>,
    pub(super) with_slopes: Parameters<Dual64>,
    pub(super) glider: SteadyGlider<T>,
}

impl<T: Number> Flyer<T> {
    pub(super) fn new(lifted: Parameters<T>) -> Self {
        let plain = lifted.map(T::value);
        Flyer { lifted, plain, with_slopes: plain.map(Dual64::from), glider: SteadyGlider::new(lifted) }
    }
}
