//! A glide at constant pitch whose speed changes.
//!
//! The model's speed lags that of the steady glide, `Vs`. The pitch `p` is constant, so at `u = V/Vs` the wing needs
//! another angle of attack, which turns the path and changes the drag; `k` is the share of lift in the steady drag, `e` the exponent of
//! the other share, and `lift` the coefficient of lift over its slope:
//! ```text
//! lift(alpha) / (cos(p + alpha) - y) = lift(alpha_s) / (u^2 cos s)
//! x = sin(p + alpha) - u^2 ((1 - k) u^(2 e) + k (alpha/alpha_s)^2) sin s
//! ```
//! Near `u = 1`, for shallow paths, `x = 2 (1 - u) (b + (a - c) alpha^2) / (b + c alpha^2) sin s`: a difference dies away in
//! ten to thirty seconds where the lift slope `a` is large, and several times as slowly at large angles where it is no larger
//! than `c`. From sample to sample, `Vs` a straight line between them, the decay at one rate has a closed form, which holds for
//! water that changes slowly and for a thermocline that is passed in a moment.
//!
//! `m0 g x` and `m0 g y` are the inertia terms of the force balances along and across the path. Knows one sample and its step to the next.

use rayon::prelude::*;

use super::model::{Inertia, Prediction, or_zero, predict, surroundings, true_pitch_rad};
use crate::dynamics::forces::Flow;
use crate::dynamics::{Parameters, Surroundings};
use crate::glide::SteadyGlider;
use crate::log::Observation;

/// Share of the steady speed below which no beginning is looked for: there the wing stalls.
pub(super) const SLOWEST_BEGINNING: f64 = 0.4;

/// Samples that one thread takes at a time.
const ABREAST: usize = 256;

/// The steady glide of a sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steady {
    /// Vertical velocity and speed \[m/s\].
    pub(super) sink_m_s: f64,
    pub(super) speed_m_s: f64,
    /// Steepness of the path \[rad\], and the angle of attack in it.
    steep_rad: f64,
    attack_rad: f64,
    /// Sine and cosine of the steepness, and of the pitch, nose the way it is driven.
    steep: (f64, f64),
    pitch: (f64, f64),
    coefficients: CoefficientLaws,
    /// Net mass \[kg\].
    pub(super) net_kg: f64,
    /// Time in which the net weight would give this speed to the mass and its added mass along the hull \[s\].
    free_s: f64,
    /// The mass with its added mass across the hull, over that along it.
    across: f64,
}

/// Solves the steady glide of each sample; none where no glide exists.
pub(super) fn steady(parameters: &Parameters<f64>, observations: &[&Observation]) -> Vec<Option<Steady>> {
    let glider = SteadyGlider::new(*parameters);
    let of_one = |guess: &mut Option<[f64; 2]>, observed: &Observation| {
        let found = predict(&glider, observed, &Inertia::NONE, *guess)?;
        *guess = Some(found.guess);
        let water = surroundings(parameters, observed);
        let net_kg = parameters.net_mass_kg(observed.ballast_m3, &water);
        let pitch_rad = true_pitch_rad(parameters, observed.pitch_rad);
        let steep_rad = (pitch_rad - found.angle_of_attack_rad).abs();
        let attack_rad = steep_rad - pitch_rad.abs();
        let moving_kg = parameters.mass_kg() + parameters.carried_mass_kg();
        let [along_kg, across_kg] =
            [parameters.added_mass_1_kg, parameters.added_mass_3_kg].map(|added_kg| moving_kg + added_kg);
        let free_s = along_kg * found.speed_m_s / (net_kg.abs() * parameters.gravity_m_s2);
        let here = Steady {
            sink_m_s: found.sink_m_s,
            speed_m_s: found.speed_m_s,
            steep_rad,
            attack_rad,
            steep: steep_rad.sin_cos(),
            pitch: pitch_rad.abs().sin_cos(),
            coefficients: CoefficientLaws::new(parameters, observed, &water, &found),
            net_kg,
            free_s,
            across: across_kg / along_kg,
        };
        (free_s > 0.0 && steep_rad > 0.0).then_some(here)
    };
    // Each solution begins with that of the sample before, in groups of a fixed size: what is found depends on no number of threads.
    let of_group = |group: &[&Observation]| {
        let mut guess = None;
        group.iter().map(|observed| of_one(&mut guess, observed)).collect::<Vec<Option<Steady>>>()
    };
    observations.par_chunks(ABREAST).flat_map_iter(of_group).collect()
}

/// How the coefficients of lift and drag depend on the angle of attack and the speed about a steady glide; angles are positive where the
/// path is steeper than the pitch.
#[derive(Debug, Clone, Copy)]
struct CoefficientLaws {
    /// Share of the drag that goes with the square of the angle of attack.
    induced: f64,
    /// Exponent of the dynamic pressure in the coefficient of the other share.
    drag_exponent: f64,
    /// Lift at no angle of attack \[rad\] and its growth with the squared angle \[1/rad\], over its slope.
    lift_at_zero_rad: f64,
    lift_growth_per_rad: f64,
}

impl CoefficientLaws {
    fn new(
        p: &Parameters<f64>,
        observed: &Observation,
        water: &Surroundings<f64>,
        flown: &Prediction<f64>,
    ) -> CoefficientLaws {
        let angle_rad = flown.angle_of_attack_rad;
        let (sin, cos) = angle_rad.sin_cos();
        let flow = Flow {
            v1_m_s: flown.speed_m_s * cos,
            v3_m_s: flown.speed_m_s * sin,
            pitch_rate_rad_s: 0.0,
            sink_m_s: flown.sink_m_s,
            density_kg_m3: water.density_kg_m3,
            time_s: observed.time_s,
            roll_rad: or_zero(observed.roll_rad),
            rudder_rad: or_zero(observed.rudder_rad),
            empirical: p.empirical(water),
        };
        let pressure_Pa = 0.5 * water.density_kg_m3 * flown.speed_m_s * flown.speed_m_s;
        let [at_zero, here] = [0.0, angle_rad].map(|angle_rad| p.coefficients(angle_rad, pressure_Pa, &flow));
        let growth = p.nonlinear_lift_per_rad2 * (1.0 + flow.empirical.lift);
        let slope = (here.lift - at_zero.lift) / angle_rad - growth * angle_rad.abs();
        // At no angle of attack there is no slope between the two; lift is then taken as proportional.
        let over_slope = |value: f64| if value == 0.0 || !slope.is_normal() { 0.0 } else { value / slope };
        let driven = if flown.sink_m_s > 0.0 { 1.0 } else { -1.0 };
        CoefficientLaws {
            induced: (1.0 - at_zero.drag / here.drag).clamp(0.0, 1.0),
            drag_exponent: p.drag_exponent,
            lift_at_zero_rad: over_slope(driven * at_zero.lift),
            lift_growth_per_rad: over_slope(growth),
        }
    }

    /// Lift over its slope \[rad\], and its rate of change with the angle of attack.
    fn lift(&self, attack_rad: f64) -> (f64, f64) {
        let grown = self.lift_growth_per_rad * attack_rad.abs();
        (self.lift_at_zero_rad + attack_rad * (1.0 + grown), 1.0 + 2.0 * grown)
    }

    /// What multiplies the coefficient of the drag at no angle of attack, at `u` times the steady speed.
    fn drag_at(&self, u: f64) -> f64 {
        if self.drag_exponent == 0.0 { 1.0 } else { u.powf(2.0 * self.drag_exponent) }
    }
}

/// Where inertia is no small correction any more the glide is not steady, and the sample tells little. A trial of a fit may
/// put the path beyond the vertical.
const MOST_OF_DRAG: f64 = 0.5;
const MOST_OF_LIFT: f64 = 0.2;

/// The wing stalls at an angle of attack not far beyond this \[rad\].
const LARGEST_ATTACK_RAD: f64 = 0.35;

/// No difference dies away more slowly than at this share of the rate at constant coefficients: at a held pitch a glide far on the
/// back of its drag curve has no rate at all, and a pilot, or a controller, holds it.
const LEAST_RATE: f64 = 0.1;

/// Change of the angle of attack \[rad\], and of the inertia across the path over the weight, that ends the search for both: a part in a
/// million of what is read.
const CONVERGED: f64 = 1e-9;

/// Steps in which a speed is looked for, of the steady one.
const SEARCH_STEP: f64 = 0.05;

/// A difference of speed too small for a quotient \[1\].
const SMALL: f64 = 1e-3;

impl Steady {
    /// By how much a glider is behind this glide that has long been following a straight line through these ones, of which this
    /// is the first: times from now on \[s\], and speeds.
    pub(super) fn behind(&self, flown: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
        let n = flown.clone().count() as f64;
        let mean_s = flown.clone().map(|(time_s, _)| time_s).sum::<f64>() / n;
        let spread_s2: f64 = flown.clone().map(|(time_s, _)| (time_s - mean_s).powi(2)).sum();
        let mean_m_s = flown.clone().map(|(_, speed_m_s)| speed_m_s).sum::<f64>() / n;
        let moment: f64 = flown.map(|(time_s, speed_m_s)| (time_s - mean_s) * speed_m_s).sum();
        let rate = if spread_s2 > 0.0 { moment / spread_s2 } else { 0.0 };
        self.speed_m_s - (mean_m_s - rate * mean_s - rate * self.slow_s(1.0))
    }

    /// The glide at `u` times the steady speed and the same pitch, the steady speed growing by this share of itself a second.
    fn at(&self, u: f64, growth_per_s: f64) -> Unsteady {
        let (sin_steep, cos_steep) = self.steep;
        let of_lift = self.coefficients.lift(self.attack_rad).0 / (cos_steep * u * u);
        let (induced, drag_at_zero) = (self.coefficients.induced, self.coefficients.drag_at(u));
        let most_rad = LARGEST_ATTACK_RAD.max(self.attack_rad.abs());
        let mut found = Unsteady { attack_rad: self.attack_rad / (u * u), along: 0.0, across: 0.0, growth_per_s: 0.0 };
        let (_, mut of_path) = self.sines(found.attack_rad);
        for _ in 0..4 {
            let (sin, cos) = of_path;
            let (lift, slope) = self.coefficients.lift(found.attack_rad);
            let step_rad = (lift - of_lift * (cos - found.across)) / (slope + of_lift * sin);
            let before = found;
            found.attack_rad = (found.attack_rad - step_rad).clamp(-most_rad, most_rad);
            let of_attack;
            (of_attack, of_path) = self.sines(found.attack_rad);
            let (sin, cos) = of_path;
            let of_angle = if self.attack_rad == 0.0 { 1.0 } else { (found.attack_rad / self.attack_rad).powi(2) };
            found.along = sin - sin_steep * u * u * ((1.0 - induced) * drag_at_zero + induced * of_angle);
            // The angle of attack goes with the speed over the steady one; the path turns by as much.
            let (lift, slope) = self.coefficients.lift(found.attack_rad);
            let turn = -2.0 * lift / (u * (slope + lift * sin / cos));
            let (sin, cos) = of_attack;
            let mixed = (self.across - 1.0) * sin * cos;
            let forced = found.along + self.free_s * mixed * u * turn * u * growth_per_s;
            let share = forced / (cos * cos + self.across * sin * sin + mixed * u * turn);
            found.growth_per_s = share / self.free_s;
            let turning = u * turn * (share - self.free_s * u * growth_per_s);
            found.across = mixed * share + (sin * sin + self.across * cos * cos) * turning;
            if (found.attack_rad - before.attack_rad).abs().max((found.across - before.across).abs()) < CONVERGED {
                break;
            }
        }
        found
    }

    /// Sine and cosine of an angle of attack, and of the steepness of the path with it at this pitch.
    fn sines(&self, attack_rad: f64) -> ((f64, f64), (f64, f64)) {
        let ((sin_pitch, cos_pitch), (sin, cos)) = (self.pitch, attack_rad.sin_cos());
        ((sin, cos), (sin_pitch * cos + cos_pitch * sin, cos_pitch * cos - sin_pitch * sin))
    }

    /// The time in which the difference from `u` times the steady speed dies away \[s\].
    pub(super) fn slow_s(&self, u: f64) -> f64 {
        let u = if (1.0 - u).abs() < SMALL { 1.0 - SMALL } else { u };
        let at_constant_coefficients = (1.0 + u) * self.steep.0 / self.free_s;
        1.0 / (self.at(u, 0.0).growth_per_s / (1.0 - u)).max(LEAST_RATE * at_constant_coefficients)
    }

    /// Vertical velocity over that of the steady glide, at `u` times its speed.
    pub(super) fn sink_at(&self, u: f64) -> f64 {
        let (_, (sin, _)) = self.sines(self.at(u, 0.0).attack_rad);
        u * sin / self.steep.0
    }

    /// Speed of a glider at this pitch and weight that has this vertical velocity \[m/s\], within what is looked for. Below the speed
    /// from which a slower glider sinks faster, its path being steeper, none is looked for. None without a vertical velocity.
    pub(super) fn speed_at(&self, sink_m_s: f64) -> Option<f64> {
        let wanted = sink_m_s / self.sink_m_s;
        if !wanted.is_finite() {
            return None;
        }
        let step = if wanted > 1.0 { SEARCH_STEP } else { -SEARCH_STEP };
        let (mut near, mut at_near) = (1.0_f64, 1.0);
        let found = loop {
            let far = (near + step).clamp(SLOWEST_BEGINNING, 2.0 - SLOWEST_BEGINNING);
            if far == near {
                break near;
            }
            let at_far = self.sink_at(far);
            if step < 0.0 && at_far >= at_near {
                break near;
            }
            if (at_far - wanted) * step >= 0.0 {
                break self.share_between([near, far], [at_near, at_far], wanted);
            }
            (near, at_near) = (far, at_far);
        };
        Some(found * self.speed_m_s)
    }

    /// The share of the steady speed, between two, at which the vertical velocity is as wanted: by false position, which is as good
    /// as its last step where the two are so near that it is nearly straight between them.
    fn share_between(&self, mut u: [f64; 2], mut sink: [f64; 2], wanted: f64) -> f64 {
        let mut found = u[0];
        for _ in 0..4 {
            let slope = (sink[1] - sink[0]) / (u[1] - u[0]);
            found = u[0] + (wanted - sink[0]) / slope;
            let here = self.sink_at(found);
            if (here - wanted).abs() < 1e-12 {
                break;
            }
            let side = usize::from((here - wanted) * (sink[1] - wanted) > 0.0);
            (u[side], sink[side]) = (found, here);
        }
        found
    }

    /// The speed over the steady one of a glider that is so much behind it, within what a glide may be.
    pub(super) fn share(&self, late_m_s: f64) -> f64 {
        (1.0 - late_m_s / self.speed_m_s).clamp(SLOWEST_BEGINNING, 2.0 - SLOWEST_BEGINNING)
    }

    /// By how much the glider is behind this glide, `step_s` after it was `late_m_s` behind one from which the speed went here
    /// at this rate.
    pub(super) fn follow(&self, late_m_s: f64, rate_m_s2: f64, step_s: f64) -> f64 {
        let after =
            |step_s: f64, slow_s: f64| rate_m_s2 * slow_s + (late_m_s - rate_m_s2 * slow_s) * (-step_s / slow_s).exp();
        // The rate is that half way.
        let half_way_m_s = after(0.5 * step_s, self.slow_s(self.share(late_m_s)));
        after(step_s, self.slow_s(self.share(half_way_m_s)))
    }

    /// Returns the inertia of a glider whose speed lags by this much.
    pub(super) fn inertia(&self, pitch_rad: f64, late_m_s: f64, growth_per_s: f64) -> Inertia {
        let u = self.share(late_m_s);
        let found = self.at(u, growth_per_s);
        let steep_rad = self.steep_rad - self.attack_rad + found.attack_rad;
        let (_, (sin, cos)) = self.sines(found.attack_rad);
        let most = MOST_OF_DRAG * self.steep.0;
        let along = sin - found.along.clamp(-most, most);
        let across = cos - found.across.clamp(-MOST_OF_LIFT, MOST_OF_LIFT);
        Inertia {
            net_mass_kg: self.net_kg * (across.hypot(along) - 1.0),
            pitch_rad: (along.atan2(across) - steep_rad) * pitch_rad.signum(),
            sink_rate_m_s2: 0.0,
        }
    }
}

/// A glide at constant pitch whose speed changes.
#[derive(Debug, Clone, Copy)]
struct Unsteady {
    /// Angle of attack \[rad\].
    attack_rad: f64,
    /// Weight less drag along the path, and weight less lift across it, over the weight.
    along: f64,
    across: f64,
    /// Rate of change of the speed over the steady one \[1/s\].
    growth_per_s: f64,
}
