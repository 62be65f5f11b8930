//! What the water does to a glider that slips and turns, added mass apart.
//!
//! ```text
//! F = R (-D, S, -L),  T = R (T1, T2, T3),  R = [[ca cb, -ca sb, -sa], [sb, cb, 0], [sa cb, -sa sb, ca]]
//! S  = q A (CY_beta beta + CY_r r* + CY_delta delta)
//! T1 = q A l (Cl_beta beta + Cl_p p* + Cl_r r* + Cl_delta delta)
//! T3 = q A l (CN_beta beta + CN_r r* + CN_p p* + CN_delta delta) - (m_f1 - m_f2) V^2 beta,   p* = p l / V, r* = r l / V
//! ```
//! `D`, `L`, `T2` are those of the vertical plane at this speed and angle of attack. The last term of `T3` is the Munk
//! couple, which the equations of motion hold already and a tank's `CN_beta` contains.

use glidepolar_dynamics::empirical::Added;
use glidepolar_dynamics::forces::{Flow, ascent_fraction};
use glidepolar_number::{Number, functions};

use super::lateral::{Body, Lateral, RateLaw};
use super::vector::Vector;

/// Force and moment on the hull in body axes, and the angles that they follow from.
pub struct Hydrodynamics<T> {
    pub speed_m_s: T,
    pub angle_of_attack_rad: T,
    pub sideslip_rad: T,
    pub lift_N: T,
    pub drag_N: T,
    pub side_force_N: T,
    pub force_N: Vector<T>,
    pub moment_N_m: Vector<T>,
}

/// What the forces follow from.
pub struct Motion<T> {
    pub v: Vector<T>,
    pub rates: Vector<T>,
    /// Downward speed through the water \[m/s\].
    pub sink_m_s: T,
    pub density_kg_m3: T,
    pub time_s: T,
    pub roll_rad: T,
    /// The true angle.
    pub rudder_rad: T,
    /// What the empirical table adds in the water here.
    pub empirical: Added<T>,
}

/// The side coefficients on one leg, or between them.
struct Side<T> {
    CY_beta: T,
    Cl_beta: T,
    CN_beta: T,
    CY_r: T,
    CN_r: T,
    Cl_p: T,
    Cl_r: T,
    CN_p: T,
}

impl<T: Number> Lateral<T> {
    fn side(&self, sink_m_s: T) -> Side<T> {
        let ascent = ascent_fraction(sink_m_s);
        let on_leg = |descents: T, ascents: T| descents + (ascents - descents) * ascent;
        Side {
            CY_beta: on_leg(self.CY_beta_per_rad, self.ascent_CY_beta_per_rad),
            Cl_beta: on_leg(self.Cl_beta_per_rad, self.ascent_Cl_beta_per_rad),
            CN_beta: on_leg(self.CN_beta_per_rad, self.ascent_CN_beta_per_rad),
            CY_r: on_leg(self.CY_r, self.ascent_CY_r),
            CN_r: on_leg(self.CN_r, self.ascent_CN_r),
            Cl_p: on_leg(self.Cl_p, self.ascent_Cl_p),
            Cl_r: on_leg(self.Cl_r, self.ascent_Cl_r),
            CN_p: on_leg(self.CN_p, self.ascent_CN_p),
        }
    }
}

impl<T: Number> Body<T> {
    /// Force and moment of the water. At rest only what damps the pitch is left.
    pub fn hydrodynamics(&self, motion: &Motion<T>) -> Hydrodynamics<T> {
        let (p, l) = (&self.plane, &self.lateral);
        let ([v1, v2, v3], [roll_rate, pitch_rate, yaw_rate]) = (motion.v, motion.rates);
        let zero = T::constant(0.0);
        let along_squared = v1 * v1 + v3 * v3;
        let speed_squared = along_squared + v2 * v2;
        let flow = Flow {
            v1_m_s: v1,
            v3_m_s: v3,
            pitch_rate_rad_s: pitch_rate,
            sink_m_s: motion.sink_m_s,
            density_kg_m3: motion.density_kg_m3,
            time_s: motion.time_s,
            roll_rad: motion.roll_rad,
            rudder_rad: motion.rudder_rad,
            empirical: motion.empirical,
        };
        // Below a picometre a second no force is left, and no angle has a value.
        if along_squared.value() < 1e-24 {
            let damping = p.still_water_damping_N_m(pitch_rate);
            return Hydrodynamics {
                speed_m_s: speed_squared.value().sqrt().into(),
                angle_of_attack_rad: zero,
                sideslip_rad: zero,
                lift_N: zero,
                drag_N: zero,
                side_force_N: zero,
                force_N: [zero; 3],
                moment_N_m: [zero, damping, zero],
            };
        }
        let in_plane = p.hydrodynamics_at_speed(speed_squared, &flow);
        let damping = p.still_water_damping_N_m(pitch_rate);
        let (along, speed) = (along_squared.sqrt(), speed_squared.sqrt());
        let beta = functions::atan2(v2, along);
        let side = l.side(motion.sink_m_s);
        let q_area = motion.density_kg_m3 * speed_squared * p.frontal_area_m2 * 0.5;
        let per_rate = match self.rate_law {
            RateLaw::Speed => p.length_m / speed,
            RateLaw::SpeedSquared => T::constant(1.0),
        };
        let (rolling, yawing) = (roll_rate * per_rate, yaw_rate * per_rate);
        let delta = motion.rudder_rad;
        let munk = (p.added_mass_1_kg - l.added_mass_2_kg) * speed_squared * beta;
        let side_force = q_area * (side.CY_beta * beta + side.CY_r * yawing + l.rudder_CY_per_rad * delta);
        let t1 = q_area
            * p.length_m
            * (side.Cl_beta * beta + side.Cl_p * rolling + side.Cl_r * yawing + l.rudder_Cl_per_rad * delta);
        let t2 = in_plane.moment_without_munk_N_m - damping;
        let t3 = q_area
            * p.length_m
            * (side.CN_beta * beta + side.CN_r * yawing + side.CN_p * rolling + l.rudder_CN_per_rad * delta)
            - munk;

        let (sa, ca) = (v3 / along, v1 / along);
        let (sb, cb) = (v2 / speed, along / speed);
        let turn = |[x, y, z]: Vector<T>| {
            [ca * cb * x - ca * sb * y - sa * z, sb * x + cb * y, sa * cb * x - sa * sb * y + ca * z]
        };
        let mut moment = turn([t1, t2, t3]);
        moment[1] += damping;
        Hydrodynamics {
            speed_m_s: speed,
            angle_of_attack_rad: in_plane.angle_of_attack_rad,
            sideslip_rad: beta,
            lift_N: in_plane.lift_N,
            drag_N: in_plane.drag_N,
            side_force_N: side_force,
            force_N: turn([-in_plane.drag_N, side_force, -in_plane.lift_N]),
            moment_N_m: moment,
        }
    }
}
