//! Sine, logarithm and the like with the same last place on every platform.
//!
//! The standard library calls the mathematical functions of the system's C library. Those of two systems, or of one system
//! on two processors, differ in the last place. An integrator that controls its steps carries that up to its tolerance. These
//! here are those of the crate `libm`, compiled with the project: one source for all platforms.

use crate::Number;

/// Which function it is, for a number that counts what it costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    /// Sine and cosine of one angle.
    SineCosine,
    /// The angle of a point.
    ArcTangent,
    /// The exponential function.
    Exponential,
    /// The natural logarithm.
    Logarithm,
    /// Any other.
    Other,
}

/// Computes sine and cosine.
pub fn sin_cos<T: Number>(x: T) -> (T, T) {
    let (sin, cos) = libm::sincos(x.value());
    if T::HAS_DERIVATIVES {
        let change = change(x);
        (change * cos + sin, change * -sin + cos)
    } else {
        (T::function_value(sin, Function::SineCosine), T::constant(cos))
    }
}

/// Computes the sine.
pub fn sin<T: Number>(x: T) -> T {
    with_slope(x, Function::SineCosine, libm::sin(x.value()), || libm::cos(x.value()))
}

/// Computes the cosine.
pub fn cos<T: Number>(x: T) -> T {
    with_slope(x, Function::SineCosine, libm::cos(x.value()), || -libm::sin(x.value()))
}

/// Computes the tangent.
pub fn tan<T: Number>(x: T) -> T {
    let tan = libm::tan(x.value());
    with_slope(x, Function::Other, tan, || 1.0 + tan * tan)
}

/// Computes the angle whose sine this is.
pub fn asin<T: Number>(x: T) -> T {
    let value = x.value();
    with_slope(x, Function::Other, libm::asin(value), || 1.0 / (1.0 - value * value).sqrt())
}

/// Computes the angle whose tangent this is.
pub fn atan<T: Number>(x: T) -> T {
    let value = x.value();
    with_slope(x, Function::Other, libm::atan(value), || 1.0 / (1.0 + value * value))
}

/// Computes the angle of the point `(x, y)`, seen from the origin.
pub fn atan2<T: Number>(y: T, x: T) -> T {
    let (a, b) = (y.value(), x.value());
    let angle = libm::atan2(a, b);
    if !T::HAS_DERIVATIVES {
        return T::function_value(angle, Function::ArcTangent);
    }
    let squared = a * a + b * b;
    change(y) * (b / squared) - change(x) * (a / squared) + angle
}

/// Computes the exponential function.
pub fn exp<T: Number>(x: T) -> T {
    let exp = libm::exp(x.value());
    with_slope(x, Function::Exponential, exp, || exp)
}

/// Computes the natural logarithm.
pub fn ln<T: Number>(x: T) -> T {
    with_slope(x, Function::Logarithm, libm::log(x.value()), || 1.0 / x.value())
}

/// Computes a power of a plain number.
pub fn powf(x: f64, exponent: f64) -> f64 {
    libm::pow(x, exponent)
}

/// A function's value, with its slope where the type carries derivatives.
fn with_slope<T: Number>(x: T, function: Function, value: f64, slope: impl FnOnce() -> f64) -> T {
    if T::HAS_DERIVATIVES { change(x) * slope() + value } else { T::function_value(value, function) }
}

/// The derivatives of a number alone: its value is zero.
fn change<T: Number>(x: T) -> T {
    const { assert!(T::NDERIV <= 1, "the slopes here are those of first order") };
    x - x.value()
}

#[cfg(test)]
mod tests {
    use num_dual::{Dual64, DualNum};

    use super::*;

    /// Value and slope beside those of the standard library.
    fn agree(ours: Dual64, theirs: Dual64) {
        assert!((ours.re - theirs.re).abs() <= 2.0 * f64::EPSILON * theirs.re.abs(), "{ours} {theirs}");
        assert!((ours.eps - theirs.eps).abs() <= 4.0 * f64::EPSILON * theirs.eps.abs().max(1.0), "{ours} {theirs}");
    }

    #[test]
    fn values_and_slopes_are_those_of_the_functions() {
        for i in 1..2000 {
            let x = Dual64::new(f64::from(i) * 7.3e-4, 1.3);
            for x in [x, -x] {
                agree(sin(x), DualNum::sin(&x));
                agree(cos(x), DualNum::cos(&x));
                agree(sin_cos(x).0, DualNum::sin(&x));
                agree(sin_cos(x).1, DualNum::cos(&x));
                agree(atan(x), DualNum::atan(&x));
                agree(exp(x), DualNum::exp(&x));
                agree(atan2(x, x * x - 0.5), DualNum::atan2(&x, x * x - 0.5));
            }
            let half = x * 0.5;
            agree(tan(half), DualNum::tan(&half));
            agree(asin(half), DualNum::asin(&half));
            agree(ln(x), DualNum::ln(&x));
            let power = powf(x.re, -0.2);
            assert!((power / x.re.powf(-0.2) - 1.0).abs() < 4.0 * f64::EPSILON);
        }
    }

    #[test]
    fn plain_and_dual_numbers_have_the_same_value() {
        for i in -500..500 {
            let x = f64::from(i) * 0.017 + 0.001;
            assert_eq!(sin_cos(x).0, sin_cos(Dual64::from(x)).0.re);
            assert_eq!(sin_cos(x).0, sin(x));
            assert_eq!(sin_cos(x).1, cos(x));
            assert_eq!(exp(x), exp(Dual64::from(x)).re);
            assert_eq!(atan2(x, 0.3), atan2(Dual64::from(x), Dual64::from(0.3)).re);
        }
    }

    #[test]
    fn the_last_place_is_the_same_on_every_platform() {
        // Bits as they are on x86-64 Linux: a change of the crate, or a platform that has others, shows here.
        let mut sum = 0_u64;
        for i in 0..1000 {
            let x = 0.001 + f64::from(i) * 1.7e-3;
            let all = [sin(x), cos(x), tan(x), atan(x), atan2(x, 0.7), exp(-x), ln(x), powf(x, -0.2), asin(x * 0.5)];
            sum = all.iter().fold(sum, |sum, value| sum.rotate_left(5) ^ value.to_bits());
        }
        assert_eq!(sum, 0xb9ba_4915_4c68_5915, "{sum:#x}");
    }
}
