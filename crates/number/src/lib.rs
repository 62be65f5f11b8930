//! The number that the equations are written in: an `f64`, or a dual number that carries derivatives with it.
//!
//! Everything physical is generic over [`Number`], so that a plain simulation, the FMU's directional derivatives and the
//! Jacobians of the fits run through the very same equations. Knows no physics.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

pub mod functions;
mod quantities;

use num_dual::{Dual64, DualNum, DualSVec64};

use functions::Function;
pub use quantities::Quantity;

/// A real number with or without derivatives: `f64`, `num_dual::Dual64`, `DualVec64<N>` and the like.
pub trait Number: DualNum<Primitive = f64> + Copy {
    /// Whether the type carries derivatives. Shortcuts that are right in value but wrong in slope ask this first.
    const HAS_DERIVATIVES: bool = Self::NDERIV > 0;

    /// The value without its derivatives.
    fn value(self) -> f64;

    /// Whether it is zero and stays zero along every derivative.
    fn is_constant_zero(&self) -> bool;

    /// A function's value where the type carries no derivatives. A type that counts operations counts it here.
    fn function_value(value: f64, _function: Function) -> Self {
        Self::constant(value)
    }

    /// A number whose derivatives are all zero.
    fn constant(value: f64) -> Self {
        Self::from(value)
    }

    /// The number held inside `[low, high]`; beyond a bound it is that bound, derivatives and all.
    fn held_within(self, low: Self, high: Self) -> Self {
        if self.value() < low.value() {
            low
        } else if self.value() > high.value() {
            high
        } else {
            self
        }
    }

    /// The number, but not below `low`.
    fn at_least(self, low: f64) -> Self {
        if self.value() < low { Self::constant(low) } else { self }
    }

    /// The number, but not above `high`.
    fn at_most(self, high: f64) -> Self {
        if self.value() > high { Self::constant(high) } else { self }
    }
}

impl Number for f64 {
    fn value(self) -> f64 {
        self
    }

    fn is_constant_zero(&self) -> bool {
        *self == 0.0
    }
}

impl Number for Dual64 {
    fn value(self) -> f64 {
        self.re
    }

    fn is_constant_zero(&self) -> bool {
        self.re == 0.0 && self.eps == 0.0
    }
}

impl<const N: usize> Number for DualSVec64<N> {
    fn value(self) -> f64 {
        self.re
    }

    fn is_constant_zero(&self) -> bool {
        self.re == 0.0 && self.eps.0.is_none_or(|eps| eps.iter().all(|slope| *slope == 0.0))
    }
}
