//! Path angle and speed given: the angle of attack in closed form.
//!
//! `CD + CL tan xi = 0` is quadratic in the angle of attack as long as the path is known, every mechanism included: the
//! dynamic pressure is given, and the sign of `alpha` in `alpha |alpha|` is that of the lift which the path needs.
//! ```text
//! (c + n s tan xi) alpha^2 + a tan xi alpha + (b + CL0 tan xi) = 0,      s = sign of alpha
//! ```
//! Of the two roots the smaller one is the glide that is flown: less drag for the same path.

use super::{GlideError, SteadyGlide, complete, steady_flow};
use crate::{Parameters, Surroundings};
use glidepolar_number::{Number, functions};

/// The steady glide along a path of angle `glide_angle_rad` (negative when descending) at `speed_m_s`.
///
/// # Errors
/// Where the path is shallower than the glider can fly, or an argument has no meaning.
pub fn at_path<T: Number>(
    parameters: &Parameters<T>,
    water: &Surroundings<T>,
    glide_angle_rad: T,
    speed_m_s: T,
) -> Result<SteadyGlide<T>, GlideError> {
    let xi = glide_angle_rad;
    if !(speed_m_s.value() > 0.0 && speed_m_s.value().is_finite()) {
        return Err(out_of_range("speed_m_s", speed_m_s.value(), "a speed above zero"));
    }
    if !(xi.value().abs() < std::f64::consts::FRAC_PI_2 && xi.value() != 0.0) {
        let expected = "a path angle between -90 and 90 deg that is not zero";
        return Err(out_of_range("glide_angle_deg", xi.value().to_degrees(), expected));
    }
    let law = QuadraticLaw::on_leg(parameters, water, xi, speed_m_s);
    match law.angle_of_attack(functions::tan(xi)) {
        Some(alpha) => Ok(complete(parameters, water, alpha, xi, speed_m_s)),
        None => {
            let limits = shallowest(&parameters.map(T::value), &water_values(water), speed_m_s.value());
            Err(GlideError::TooShallow {
                asked_deg: xi.value().to_degrees(),
                descent_deg: limits.descent_rad.to_degrees(),
                ascent_deg: limits.ascent_rad.to_degrees(),
            })
        }
    }
}

/// The shallowest paths that a glider can hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathLimits {
    /// Shallowest descent, negative \[rad\].
    pub descent_rad: f64,
    /// Shallowest ascent \[rad\].
    pub ascent_rad: f64,
}

/// The shallowest descent and ascent at a speed (which matters with a drag exponent only): the least `|xi|` at which
/// the quadratic has a root, its discriminant zero.
/// ```text
/// (a^2 - 4 s n CL0) tan^2 xi - 4 (c CL0 + s n b) tan xi - 4 b c = 0
/// ```
pub fn shallowest(parameters: &Parameters<f64>, water: &Surroundings<f64>, speed_m_s: f64) -> PathLimits {
    let limit = |xi: f64| {
        let law = QuadraticLaw::on_leg(parameters, water, xi, speed_m_s);
        let n = law.signed_crossflow;
        let (p2, p1, p0) =
            (law.a * law.a - 4.0 * n * law.lift_0, -4.0 * (law.c * law.lift_0 + n * law.b), -4.0 * law.b * law.c);
        let root = (p1 * p1 - 4.0 * p2 * p0).max(0.0).sqrt();
        let tangent = (-p1 + xi.signum() * root) / (2.0 * p2);
        functions::atan(tangent)
    };
    PathLimits { descent_rad: limit(-0.5), ascent_rad: limit(0.5) }
}

/// Lift and drag as quadratics in the angle of attack, on one leg at one dynamic pressure.
struct QuadraticLaw<T> {
    lift_0: T,
    a: T,
    signed_crossflow: T,
    b: T,
    c: T,
}

impl<T: Number> QuadraticLaw<T> {
    /// The law is read off the coefficient functions themselves at -1, 0 and 1 rad on the side that is flown, so that
    /// no mechanism is written twice.
    fn on_leg(parameters: &Parameters<T>, water: &Surroundings<T>, xi: T, speed: T) -> Self {
        let side = if xi.value() < 0.0 { 1.0 } else { -1.0 };
        let plain = Parameters { nonlinear_lift_per_rad2: T::constant(0.0), ..*parameters };
        let flow = steady_flow(&plain, water, T::constant(0.0), speed, xi);
        let q = flow.density_kg_m3 * speed * speed * 0.5;
        let at = |alpha: f64| plain.coefficients(T::constant(alpha), q, &flow);
        let (zero, one) = (at(0.0), at(1.0));
        QuadraticLaw {
            lift_0: zero.lift,
            a: one.lift - zero.lift,
            signed_crossflow: parameters.nonlinear_lift_per_rad2 * side,
            b: zero.drag,
            c: one.drag - zero.drag,
        }
    }

    /// The smaller root, in the form that loses no digits; none where drag exceeds what lift can carry.
    fn angle_of_attack(&self, tangent: T) -> Option<T> {
        let square = self.c + self.signed_crossflow * tangent;
        let linear = self.a * tangent;
        let constant = self.b + self.lift_0 * tangent;
        let discriminant = linear * linear - square * constant * 4.0;
        if !(discriminant.value() >= 0.0 && linear.value() != 0.0) {
            return None;
        }
        let root = discriminant.sqrt();
        let sum = if linear.value() < 0.0 { linear - root } else { linear + root };
        Some(constant * -2.0 / sum)
    }
}

fn water_values<T: Number>(water: &Surroundings<T>) -> Surroundings<f64> {
    Surroundings {
        density_kg_m3: water.density_kg_m3.value(),
        pressure_Pa: water.pressure_Pa.value(),
        temperature_C: water.temperature_C.value(),
        time_s: water.time_s.value(),
    }
}

fn out_of_range(name: &'static str, value: f64, expected: &'static str) -> GlideError {
    GlideError::OutOfRange { name, value, expected }
}
