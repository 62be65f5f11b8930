//! What the water does to a moving glider: lift, drag and pitching moment, from the coefficients and the mechanisms.
//!
//! Coefficients are the stored form; the papers' K's are derived here, with the local density. Knows nothing of masses
//! but the added ones, which the Munk couple needs.

use super::empirical::Added;
use super::parameters::{DRAG_REFERENCE_SPEED_M_S, Parameters};
use glidepolar_number::{Number, functions};

/// Seconds in a day.
const DAY_S: f64 = 86_400.0;

/// Vertical speed over which the drag passes from that of descents to that of ascents \[m/s\]: far below any glide, so
/// that it only rounds the corner where the glider turns.
const TURN_SPEED_M_S: f64 = 0.01;

/// The flow that the hull meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flow<T> {
    /// Velocity through the water along axis 1 \[m/s\].
    pub v1_m_s: T,
    /// Velocity through the water along axis 3 \[m/s\].
    pub v3_m_s: T,
    /// Pitch rate \[rad/s\].
    pub pitch_rate_rad_s: T,
    /// Downward speed through the water \[m/s\]: negative on an ascent.
    pub sink_m_s: T,
    /// True density of the water \[kg/m3\].
    pub density_kg_m3: T,
    /// Time since the start \[s\].
    pub time_s: T,
    /// Roll angle \[rad\].
    pub roll_rad: T,
    /// Rudder angle \[rad\].
    pub rudder_rad: T,
    /// What the empirical table adds here.
    pub empirical: Added<T>,
}

/// Force and moment of the water, and the angle they follow from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hydrodynamics<T> {
    /// Angle of attack \[rad\].
    pub angle_of_attack_rad: T,
    /// Speed through the water \[m/s\].
    pub speed_m_s: T,
    /// Lift, normal to the path, upward positive \[N\].
    pub lift_N: T,
    /// Drag, against the path \[N\].
    pub drag_N: T,
    /// Pitching moment about the centre of buoyancy as a tank measures it: Munk couple and damping included \[N m\].
    pub moment_N_m: T,
    /// The part of the moment that the equations of motion do not have already: without the Munk couple \[N m\].
    pub moment_without_munk_N_m: T,
}

/// The coefficients at one angle of attack, referred to frontal area and length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients<T> {
    /// Lift coefficient.
    pub lift: T,
    /// Drag coefficient.
    pub drag: T,
    /// Moment coefficient about the centre of buoyancy, without damping.
    pub moment: T,
}

impl<T: Number> Parameters<T> {
    /// Lift, drag and moment coefficients with every mechanism in them.
    ///
    /// `dynamic_pressure_Pa` matters with a drag exponent only, `sink_m_s` where the legs differ.
    pub fn coefficients(&self, angle_of_attack_rad: T, dynamic_pressure_Pa: T, flow: &Flow<T>) -> Coefficients<T> {
        self.coefficients_at(angle_of_attack_rad, self.reynolds_factor(dynamic_pressure_Pa), flow)
    }

    /// The same where the factor on the drag by the Reynolds number is known.
    pub(crate) fn coefficients_at(
        &self,
        angle_of_attack_rad: T,
        reynolds_factor: T,
        flow: &Flow<T>,
    ) -> Coefficients<T> {
        let alpha = angle_of_attack_rad;
        let ascent = ascent_fraction(flow.sink_m_s);
        let on_leg = |ratio: T| (ratio - 1.0) * ascent + 1.0;

        let lift = (self.CL0
            + self.a_per_rad * on_leg(self.ascent_a_ratio) * on_leg(self.climb_dive_lift_ratio) * alpha
            + self.nonlinear_lift_per_rad2 * alpha * alpha.abs())
            * (flow.empirical.lift + 1.0);
        let b = self.b * on_leg(self.ascent_b_ratio) * reynolds_factor;
        let c = self.c_per_rad2 * on_leg(self.ascent_c_ratio);
        let drag = (b + c * alpha * alpha) * on_leg(self.climb_dive_drag_ratio) * self.drag_factor(flow);
        let moment = self.CM0 + self.d_per_rad * on_leg(self.ascent_d_ratio) * alpha;
        Coefficients { lift, drag, moment }
    }

    /// Lift, drag and moment on the moving glider. At rest all are zero.
    pub fn hydrodynamics(&self, flow: &Flow<T>) -> Hydrodynamics<T> {
        self.hydrodynamics_at_speed(flow.v1_m_s * flow.v1_m_s + flow.v3_m_s * flow.v3_m_s, flow)
    }

    /// Moment that a pitch rate gives in still water \[N m\].
    pub fn still_water_damping_N_m(&self, pitch_rate_rad_s: T) -> T {
        self.pitch_damping_N_m_s * pitch_rate_rad_s
            + self.pitch_damping_quadratic_N_m_s2 * pitch_rate_rad_s * pitch_rate_rad_s.abs()
    }

    /// The same where the speed is not that of the vertical plane alone: a glider that slips sideways has more of it
    /// than `flow` says. `speed_squared` in m2/s2.
    pub fn hydrodynamics_at_speed(&self, speed_squared: T, flow: &Flow<T>) -> Hydrodynamics<T> {
        let damping = self.still_water_damping_N_m(flow.pitch_rate_rad_s);
        // The angle has no value at rest, nor a slope; the forces vanish with the square of the speed.
        if speed_squared.value() < 1e-24 {
            let zero = T::constant(0.0);
            return Hydrodynamics {
                angle_of_attack_rad: zero,
                speed_m_s: zero,
                lift_N: zero,
                drag_N: zero,
                moment_N_m: damping,
                moment_without_munk_N_m: damping,
            };
        }
        let speed = speed_squared.sqrt();
        let alpha = functions::atan2(flow.v3_m_s, flow.v1_m_s);
        let q = flow.density_kg_m3 * speed_squared * 0.5;
        let q_area = q * self.frontal_area_m2;
        let coefficients = self.coefficients(alpha, q, flow);
        let rotary = flow.density_kg_m3
            * speed
            * self.frontal_area_m2
            * self.length_m
            * self.length_m
            * 0.5
            * self.pitch_damping_CMq
            * flow.pitch_rate_rad_s
            + self.pitch_damping_V2_kg_s * speed_squared * flow.pitch_rate_rad_s;
        let moment = q_area * self.length_m * coefficients.moment + damping + rotary;
        // K_M = rho A LOA d / 2 - (m_f3 - m_f1): the couple stands in the equations of motion already.
        let munk = (self.added_mass_3_kg - self.added_mass_1_kg) * alpha * speed_squared;
        Hydrodynamics {
            angle_of_attack_rad: alpha,
            speed_m_s: speed,
            lift_N: q_area * coefficients.lift,
            drag_N: q_area * coefficients.drag,
            moment_N_m: moment,
            moment_without_munk_N_m: moment - munk,
        }
    }

    /// What multiplies all drag: fouling, something caught, roll and rudder.
    fn drag_factor(&self, flow: &Flow<T>) -> T {
        let growth = self.drag_growth_per_day * flow.time_s / DAY_S + 1.0;
        let step =
            if flow.time_s.value() >= self.step_time_s.value() { self.drag_step + 1.0 } else { T::constant(1.0) };
        let roll = self.roll_drag_per_rad2 * flow.roll_rad * flow.roll_rad + 1.0;
        let rudder = self.rudder_drag_per_rad2 * flow.rudder_rad * flow.rudder_rad + 1.0;
        growth * step * roll * rudder * (flow.empirical.drag + 1.0)
    }

    /// `(q/q0)^s`, and exactly 1 for s = 0, where it has a slope along s alone.
    pub(crate) fn reynolds_factor(&self, dynamic_pressure_Pa: T) -> T {
        if self.drag_exponent.is_constant_zero() {
            return T::constant(1.0);
        }
        let reference = self.reference_density_kg_m3 * (0.5 * DRAG_REFERENCE_SPEED_M_S * DRAG_REFERENCE_SPEED_M_S);
        // A glider at rest has no logarithm of q; at a micropascal the drag is nothing in any case.
        let q = if dynamic_pressure_Pa.value() > 1e-6 { dynamic_pressure_Pa } else { T::constant(1e-6) };
        functions::exp(functions::ln(q / reference) * self.drag_exponent)
    }
}

/// 0 on a descent, 1 on an ascent, with a smooth passage where the glider turns.
pub fn ascent_fraction<T: Number>(sink_m_s: T) -> T {
    let x = (sink_m_s / TURN_SPEED_M_S).held_within(T::constant(-1.0), T::constant(1.0));
    // Cubic with level ends, 1/2 at the turn.
    x * (x * x * 0.25 - 0.75) + 0.5
}
