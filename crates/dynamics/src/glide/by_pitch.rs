//! Net mass and pitch given, as a glider measures them: angle of attack and speed by Newton's method.
//!
//! The unknowns are the angle of attack and the dynamic pressure, the residuals the balances along and across the vertical:
//! ```text
//! CD cos xi + CL sin xi = 0,      q A (CL cos xi - CD sin xi) / W = 1,      xi = pitch - alpha
//! ```
//! Steps of the pressure are relative to it. Without a Reynolds exponent the second balance is linear in it.
//!
//! Solved in plain numbers; derivatives follow by one more step with the dual numbers in place (the implicit function
//! theorem), at the cost of a single evaluation.

use super::{GlideError, SteadyGlide, complete, steady_flow};
use crate::forces::Flow;
use crate::{Parameters, Surroundings};
use glidepolar_number::{Number, functions};
use num_dual::Dual64;

/// What a glider in a steady glide measures of itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attitude<T> {
    /// True pitch \[rad\].
    pub pitch_rad: T,
    /// Net mass, positive when heavy \[kg\].
    pub net_mass_kg: T,
}

/// Angles that cost drag and nothing else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deflection<T> {
    /// Roll \[rad\].
    pub roll_rad: T,
    /// Rudder angle \[rad\].
    pub rudder_rad: T,
}

/// Angle of attack and speed of a steady glide, and where the next solution nearby may start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flight<T> {
    /// Angle of attack \[rad\].
    pub angle_of_attack_rad: T,
    /// Speed through the water \[m/s\].
    pub speed_m_s: T,
    /// The solution as a first guess for one nearby: angle of attack \[rad\] and dynamic pressure \[Pa\].
    pub guess: [f64; 2],
}

/// The steady glide of a glider of this net mass at this pitch.
///
/// # Errors
/// Where no glide balances: pitch and net mass of different sign, or a pitch too shallow to fly.
pub fn at_pitch<T: Number>(
    parameters: &Parameters<T>,
    water: &Surroundings<T>,
    attitude: Attitude<T>,
) -> Result<SteadyGlide<T>, GlideError> {
    let straight = Deflection { roll_rad: T::constant(0.0), rudder_rad: T::constant(0.0) };
    let flight = SteadyGlider::new(*parameters).flight(water, attitude, straight, None)?;
    let alpha = flight.angle_of_attack_rad;
    Ok(complete(parameters, water, alpha, attitude.pitch_rad - alpha, flight.speed_m_s))
}

/// A glider that is asked often, as fits do: its parameters in every kind of number that the solution needs.
#[derive(Debug, Clone, Copy)]
pub struct SteadyGlider<T> {
    /// Its parameters.
    pub parameters: Parameters<T>,
    plain: Parameters<f64>,
    with_slopes: Parameters<Dual64>,
}

impl<T: Number> SteadyGlider<T> {
    /// A glider of these parameters.
    pub fn new(parameters: Parameters<T>) -> Self {
        let plain = parameters.map(T::value);
        SteadyGlider { parameters, plain, with_slopes: plain.map(Dual64::from) }
    }

    /// As [`at_pitch`]: rolled and steering, from a first guess where one is known, angle of attack and speed alone.
    /// Allocates nothing.
    ///
    /// # Errors
    /// As [`at_pitch`].
    pub fn flight(
        &self,
        water: &Surroundings<T>,
        attitude: Attitude<T>,
        deflection: Deflection<T>,
        guess: Option<[f64; 2]>,
    ) -> Result<Flight<T>, GlideError> {
        let plain = Asked {
            parameters: &self.plain,
            water: Surroundings {
                density_kg_m3: water.density_kg_m3.value(),
                pressure_Pa: water.pressure_Pa.value(),
                temperature_C: water.temperature_C.value(),
                time_s: water.time_s.value(),
            },
            attitude: Attitude { pitch_rad: attitude.pitch_rad.value(), net_mass_kg: attitude.net_mass_kg.value() },
            deflection: Deflection { roll_rad: deflection.roll_rad.value(), rudder_rad: deflection.rudder_rad.value() },
        };
        let solution = guess
            .and_then(|guess| solve(&plain, &self.with_slopes, guess))
            .or_else(|| solve(&plain, &self.with_slopes, first_guess(&plain)?))
            .ok_or(GlideError::NoBalance {
                pitch_deg: plain.attitude.pitch_rad.to_degrees(),
                net_mass_kg: plain.attitude.net_mass_kg,
            })?;

        let parameters = &self.parameters;
        let [mut alpha, mut q] = solution.unknowns.map(T::constant);
        if T::HAS_DERIVATIVES {
            let asked = Asked { parameters, water: *water, attitude, deflection };
            let residual = balance(&asked, alpha, &Push::new(parameters, q));
            let [step_alpha, step_q] = solve_2(solution.jacobian, residual);
            alpha -= step_alpha;
            q -= q * step_q;
        }
        let density = parameters.true_density_kg_m3(water.density_kg_m3);
        let speed_m_s = (q * 2.0 / density).sqrt();
        Ok(Flight { angle_of_attack_rad: alpha, speed_m_s, guess: solution.unknowns })
    }
}

/// All that the question holds.
struct Asked<'a, T> {
    parameters: &'a Parameters<T>,
    water: Surroundings<T>,
    attitude: Attitude<T>,
    deflection: Deflection<T>,
}

struct Solution {
    unknowns: [f64; 2],
    /// By the angle of attack, and by the relative change of the dynamic pressure.
    jacobian: [[f64; 2]; 2],
}

fn solve(asked: &Asked<'_, f64>, with_slopes: &Parameters<Dual64>, guess: [f64; 2]) -> Option<Solution> {
    // Each step squares the error: after one of this size the rest is rounding.
    const TOLERANCE: f64 = 1e-8;
    const MAX_STEPS: usize = 50;
    let Attitude { pitch_rad, net_mass_kg } = asked.attitude;
    let heavy = net_mass_kg.signum();
    if !(pitch_rad.is_finite() && net_mass_kg != 0.0 && net_mass_kg.is_finite()) {
        return None;
    }
    let lifted = Asked {
        parameters: with_slopes,
        water: Surroundings {
            density_kg_m3: asked.water.density_kg_m3.into(),
            pressure_Pa: asked.water.pressure_Pa.into(),
            temperature_C: asked.water.temperature_C.into(),
            time_s: asked.water.time_s.into(),
        },
        attitude: Attitude { pitch_rad: pitch_rad.into(), net_mass_kg: net_mass_kg.into() },
        deflection: Deflection {
            roll_rad: asked.deflection.roll_rad.into(),
            rudder_rad: asked.deflection.rudder_rad.into(),
        },
    };

    let mut unknowns = guess;
    let mut last = f64::INFINITY;
    let mut along_path_before: Option<AlongPath> = None;
    for _ in 0..MAX_STEPS {
        // One slope at a time: two short passes are quicker than one with both. What the speed alone decides is the same in both.
        let [alpha, q] = unknowns;
        let push = Push::new(with_slopes, Dual64::new(q, q));
        let by_alpha = balance(&lifted, Dual64::from(alpha).derivative(), &push.held());
        let residual = by_alpha.map(|r| r.re);
        let by_q = if asked.parameters.drag_exponent == 0.0 {
            [0.0, residual[1] + 1.0]
        } else {
            balance(&lifted, alpha.into(), &push).map(|r| r.eps)
        };
        let jacobian = [[by_alpha[0].eps, by_q[0]], [by_alpha[1].eps, by_q[1]]];
        let along_path = AlongPath { alpha, residual: residual[0], slope: by_alpha[0].eps };
        if let Some(between) = along_path_before.and_then(|before| before.turning_point(&along_path)) {
            let there = balance(&lifted, between.into(), &push.held());
            if there[0].re * residual[0] > 0.0 {
                return None;
            }
        }
        along_path_before = Some(along_path);
        let [step_alpha, step_q] = solve_2(jacobian, residual);
        let size = step_alpha.abs().max(step_q.abs());
        if !size.is_finite() {
            return None;
        }
        // A step at the rounding of the residuals no longer shrinks: that, too, is the end.
        let converged = size < TOLERANCE || (size < 1e-9 && size >= last);
        // A long step would leave the branch of small angles, or the pressures above zero.
        let damping = (0.2 / step_alpha.abs()).min(0.5 / step_q.abs()).min(1.0);
        unknowns = [alpha - damping * step_alpha, q - damping * step_q * q];
        if converged {
            let xi = pitch_rad - unknowns[0];
            // A glide goes down when heavy; the other roots fly backwards.
            return (xi * heavy < 0.0 && unknowns[0].abs() < 0.8).then_some(Solution { unknowns, jacobian });
        }
        last = size;
    }
    None
}

/// The balance along the path at one angle of attack.
#[derive(Clone, Copy)]
struct AlongPath {
    alpha: f64,
    residual: f64,
    slope: f64,
}

impl AlongPath {
    /// The angle of attack between two at which the balance turns back, where they lie on the same side of zero and on both sides of that
    /// angle. The balance of lift and drag along the path is a parabola in the angle of attack to first order: if it has not
    /// reached zero there it never does, as at a pitch too shallow to fly.
    fn turning_point(&self, next: &AlongPath) -> Option<f64> {
        let turns = self.residual * next.residual > 0.0 && self.slope * next.slope < 0.0;
        turns.then(|| self.alpha + (next.alpha - self.alpha) * self.slope / (self.slope - next.slope))
    }
}

/// Drag over lift at the path angle that the pitch alone suggests, then the speed that carries the weight.
fn first_guess(asked: &Asked<'_, f64>) -> Option<[f64; 2]> {
    let (p, attitude) = (asked.parameters, &asked.attitude);
    let tangent = functions::tan(attitude.pitch_rad);
    let alpha = if p.a_per_rad == 0.0 { 0.0 } else { -(p.b + p.CL0 * tangent) / (p.a_per_rad * tangent) };
    let alpha = alpha.clamp(-0.15, 0.15);
    let xi = attitude.pitch_rad - alpha;
    let flow = steady_flow(p, &asked.water, alpha, 0.3, xi);
    let q = flow.density_kg_m3 * 0.3 * 0.3 * 0.5;
    let coefficients = p.coefficients(alpha, q, &flow);
    let resultant = (coefficients.lift * coefficients.lift + coefficients.drag * coefficients.drag).sqrt();
    let q = attitude.net_mass_kg.abs() * p.gravity_m_s2 / (p.frontal_area_m2 * resultant);
    (q > 0.0 && q.is_finite()).then_some([alpha, q])
}

/// What the speed alone decides.
struct Push<T> {
    dynamic_pressure_Pa: T,
    /// The factor on the drag by the Reynolds number.
    reynolds_factor: T,
}

impl<T: Number> Push<T> {
    fn new(parameters: &Parameters<T>, dynamic_pressure_Pa: T) -> Self {
        Push { dynamic_pressure_Pa, reynolds_factor: parameters.reynolds_factor(dynamic_pressure_Pa) }
    }

    /// The same without its slopes.
    fn held(&self) -> Self {
        Push {
            dynamic_pressure_Pa: T::constant(self.dynamic_pressure_Pa.value()),
            reynolds_factor: T::constant(self.reynolds_factor.value()),
        }
    }
}

fn balance<T: Number>(asked: &Asked<'_, T>, alpha: T, push: &Push<T>) -> [T; 2] {
    let Asked { parameters, water, attitude, deflection } = asked;
    let q = push.dynamic_pressure_Pa;
    let xi = attitude.pitch_rad - alpha;
    let weight = attitude.net_mass_kg * parameters.gravity_m_s2;
    // Which leg it is follows from the weight, not from an iterate's path; the coefficients read no speed but its sign.
    let sink = T::constant(attitude.net_mass_kg.value().signum());
    let flow = Flow {
        v1_m_s: T::constant(1.0),
        v3_m_s: alpha,
        pitch_rate_rad_s: T::constant(0.0),
        sink_m_s: sink,
        density_kg_m3: parameters.true_density_kg_m3(water.density_kg_m3),
        time_s: water.time_s,
        roll_rad: deflection.roll_rad,
        rudder_rad: deflection.rudder_rad,
        empirical: parameters.empirical(water),
    };
    let coefficients = parameters.coefficients_at(alpha, push.reynolds_factor, &flow);
    let (sin, cos) = functions::sin_cos(xi);
    [
        coefficients.drag * cos + coefficients.lift * sin,
        q * parameters.frontal_area_m2 * (coefficients.lift * cos - coefficients.drag * sin) / weight - 1.0,
    ]
}

/// `J^-1 r` for a Jacobian in plain numbers.
fn solve_2<T: Number>(jacobian: [[f64; 2]; 2], [r0, r1]: [T; 2]) -> [T; 2] {
    let [[j00, j01], [j10, j11]] = jacobian;
    let determinant = j00 * j11 - j01 * j10;
    [(r0 * j11 - r1 * j01) / determinant, (r1 * j00 - r0 * j10) / determinant]
}
