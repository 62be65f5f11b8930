//! Newton and Euler in the inertial frame for a hull, its added mass and a mass that slides inside it.
//!
//! The state holds momenta, not velocities. With v and Om the hull's velocity (body axes) and pitch rate, U the water's
//! velocity, r = (r1, r3) the moving mass and r1' its sliding speed, the momentum of the whole is
//!
//! ```text
//! P = m_s v + diag(mf1, mf3) (v - U) + m_p (v + Om x r + r1' e1)       turned into inertial axes
//! H = J Om + m_p r x (v + Om x r + r1' e1)                              about the centre of buoyancy
//! dP/dt = (m_s + m_p - rho V) g k + rho V dU/dt + lift + drag
//! dH/dt = m_p g r x k + moment - v x P_solid - (v - U) x P_water        (the last is Munk's couple)
//! ```
//!
//! so forces inside the vehicle never appear and the sliding mass exchanges momentum exactly. rho V dU/dt is the
//! pressure gradient of the accelerating water; a shear is met, it accelerates no water and gives no such force. x points forward, z down, pitch is nose up.

use crate::ocean::GRAVITY_M_S2;
use crate::vehicle::Vehicle;

/// Where the vehicle is and what momentum it carries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Horizontal distance, m.
    pub x_m: f64,
    /// Depth of the centre of buoyancy, m.
    pub depth_m: f64,
    /// Pitch, rad, nose up positive.
    pub pitch_rad: f64,
    /// Horizontal momentum, kg m/s.
    pub momentum_x: f64,
    /// Downward momentum, kg m/s.
    pub momentum_z: f64,
    /// Angular momentum about the centre of buoyancy, kg m2/s.
    pub spin: f64,
}

/// Velocities that belong to a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Hull velocity along axis 1 relative to the ground, m/s.
    pub v1: f64,
    /// Hull velocity along axis 3 relative to the ground, m/s.
    pub v3: f64,
    /// Pitch rate, rad/s.
    pub pitch_rate: f64,
    /// Velocity through the water along axis 1, m/s.
    pub through_1: f64,
    /// Velocity through the water along axis 3, m/s.
    pub through_3: f64,
}

/// Inertia of the vehicle at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia {
    /// Mass without the moving mass, centred in the centre of buoyancy, kg.
    pub solid_kg: f64,
    /// Moving mass, kg.
    pub moving_kg: f64,
    /// Its distance below axis 1, m.
    pub height_m: f64,
    /// Added mass along axis 1, kg.
    pub added_1_kg: f64,
    /// Added mass along axis 3, kg.
    pub added_3_kg: f64,
    /// Pitch inertia with added inertia, without the moving mass, kg m2.
    pub pitch_kg_m2: f64,
}

/// What the pilot and the water impose during one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Imposed {
    /// Moving mass forward of the centre of buoyancy at the start of the step, m.
    pub moving_mass_m: f64,
    /// Its sliding speed, m/s.
    pub sliding_m_s: f64,
    /// Horizontal velocity of the water at the start of the step, m/s.
    pub water_x_m_s: f64,
    /// Downward velocity of the water at the start of the step, m/s.
    pub water_z_m_s: f64,
    /// Horizontal acceleration of the water itself, m/s2.
    pub water_x_m_s2: f64,
    /// Downward acceleration of the water, m/s2.
    pub water_z_m_s2: f64,
    /// Change of the horizontal velocity of the water that the glider meets by moving through it, m/s2: a shear.
    pub met_x_m_s2: f64,
}

/// Forces of the water, body axes, besides those of added mass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Load {
    /// Mass of the water displaced, kg.
    pub displaced_kg: f64,
    /// Force along axis 1, N.
    pub force_1_n: f64,
    /// Force along axis 3, N.
    pub force_3_n: f64,
    /// Moment about the centre of buoyancy, nose up, without Munk's couple, N m.
    pub moment_n_m: f64,
}

impl Inertia {
    /// The inertia of a vehicle that weighs `mass_kg` in all.
    pub fn new(vehicle: &Vehicle, mass_kg: f64) -> Self {
        Self {
            solid_kg: mass_kg - vehicle.moving_mass_kg,
            moving_kg: vehicle.moving_mass_kg,
            height_m: vehicle.moving_mass_height_m,
            added_1_kg: vehicle.added_mass_1_kg,
            added_3_kg: vehicle.added_mass_3_kg,
            pitch_kg_m2: vehicle.pitch_inertia_kg_m2,
        }
    }

    /// The state of a vehicle moving as commanded.
    pub fn state(&self, place: (f64, f64, f64), motion: (f64, f64, f64), imposed: &Imposed) -> State {
        let (x_m, depth_m, pitch_rad) = place;
        let (v1, v3, pitch_rate) = motion;
        let (sin, cos) = pitch_rad.sin_cos();
        let (u1, u3) = to_body(imposed.water_x_m_s, imposed.water_z_m_s, sin, cos);
        let (r1, r3) = (imposed.moving_mass_m, self.height_m);
        let (q1, q3) = (v1 + r3 * pitch_rate + imposed.sliding_m_s, v3 - r1 * pitch_rate);
        let p1 = self.solid_kg * v1 + self.added_1_kg * (v1 - u1) + self.moving_kg * q1;
        let p3 = self.solid_kg * v3 + self.added_3_kg * (v3 - u3) + self.moving_kg * q3;
        State {
            x_m,
            depth_m,
            pitch_rad,
            momentum_x: p1 * cos + p3 * sin,
            momentum_z: p3 * cos - p1 * sin,
            spin: self.pitch_kg_m2 * pitch_rate + self.moving_kg * (r3 * q1 - r1 * q3),
        }
    }

    /// Velocities of a state, `after_s` into a step.
    pub fn motion(&self, state: &State, imposed: &Imposed, after_s: f64) -> Motion {
        let (sin, cos) = state.pitch_rad.sin_cos();
        let (u1, u3) = imposed.water(after_s, sin, cos);
        let (p1, p3) = to_body(state.momentum_x, state.momentum_z, sin, cos);
        let (r1, r3) = (imposed.moving_mass_m + imposed.sliding_m_s * after_s, self.height_m);
        let slid = imposed.sliding_m_s;
        let mass_1 = self.solid_kg + self.moving_kg + self.added_1_kg;
        let mass_3 = self.solid_kg + self.moving_kg + self.added_3_kg;
        // Velocities the hull would have without pitch rate, then the pitch rate from the angular momentum.
        let still_1 = (p1 + self.added_1_kg * u1 - self.moving_kg * slid) / mass_1;
        let still_3 = (p3 + self.added_3_kg * u3) / mass_3;
        let moved = self.moving_kg * (r3 * (still_1 + slid) - r1 * still_3);
        let about = self.pitch_kg_m2
            + self.moving_kg * (r3 * r3 * (1.0 - self.moving_kg / mass_1) + r1 * r1 * (1.0 - self.moving_kg / mass_3));
        let pitch_rate = (state.spin - moved) / about;
        let v1 = still_1 - self.moving_kg * r3 * pitch_rate / mass_1;
        let v3 = still_3 + self.moving_kg * r1 * pitch_rate / mass_3;
        Motion { v1, v3, pitch_rate, through_1: v1 - u1, through_3: v3 - u3 }
    }

    /// Kinetic energy of hull, moving mass and added water in still water plus potential energy, J.
    pub fn energy_j(&self, state: &State, imposed: &Imposed, displaced_kg: f64) -> f64 {
        let motion = self.motion(state, imposed, 0.0);
        let (r1, r3) = (imposed.moving_mass_m, self.height_m);
        let (q1, q3) = (motion.v1 + r3 * motion.pitch_rate + imposed.sliding_m_s, motion.v3 - r1 * motion.pitch_rate);
        let kinetic = (self.solid_kg + self.added_1_kg) * motion.v1 * motion.v1
            + (self.solid_kg + self.added_3_kg) * motion.v3 * motion.v3
            + self.pitch_kg_m2 * motion.pitch_rate * motion.pitch_rate
            + self.moving_kg * (q1 * q1 + q3 * q3);
        let (sin, cos) = state.pitch_rad.sin_cos();
        let mass_depth = (self.solid_kg + self.moving_kg - displaced_kg) * state.depth_m;
        0.5 * kinetic - GRAVITY_M_S2 * (mass_depth + self.moving_kg * (r3 * cos - r1 * sin))
    }

    /// One Runge-Kutta step of fourth order; `load` gives the water's forces for a state and its motion.
    pub fn step(
        &self,
        state: &State,
        imposed: &Imposed,
        step_s: f64,
        mut load: impl FnMut(&State, &Motion) -> Load,
    ) -> State {
        let mut rate = |state: &State, after_s: f64| self.rate(state, imposed, after_s, &mut load);
        let first = rate(state, 0.0);
        let second = rate(&along(state, &first, 0.5 * step_s), 0.5 * step_s);
        let third = rate(&along(state, &second, 0.5 * step_s), 0.5 * step_s);
        let fourth = rate(&along(state, &third, step_s), step_s);
        let mean = std::array::from_fn(|i| (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]) / 6.0);
        along(state, &mean, step_s)
    }

    fn rate(
        &self,
        state: &State,
        imposed: &Imposed,
        after_s: f64,
        load: &mut impl FnMut(&State, &Motion) -> Load,
    ) -> [f64; 6] {
        let motion = self.motion(state, imposed, after_s);
        let load = load(state, &motion);
        let Motion { v1, v3, pitch_rate, through_1, through_3 } = motion;
        let (sin, cos) = state.pitch_rad.sin_cos();
        let (r1, r3) = (imposed.moving_mass_m + imposed.sliding_m_s * after_s, self.height_m);
        let (q1, q3) = (v1 + r3 * pitch_rate + imposed.sliding_m_s, v3 - r1 * pitch_rate);
        let net_kg = self.solid_kg + self.moving_kg - load.displaced_kg;
        let pendulum = -self.moving_kg * GRAVITY_M_S2 * (r1 * cos + r3 * sin);
        let carried = self.moving_kg * (v3 * q1 - v1 * q3);
        let munk = (self.added_3_kg - self.added_1_kg) * through_1 * through_3;
        [
            v1 * cos + v3 * sin,
            v3 * cos - v1 * sin,
            pitch_rate,
            load.force_1_n * cos + load.force_3_n * sin + load.displaced_kg * imposed.water_x_m_s2,
            load.force_3_n * cos - load.force_1_n * sin
                + load.displaced_kg * imposed.water_z_m_s2
                + net_kg * GRAVITY_M_S2,
            pendulum + load.moment_n_m - carried + munk,
        ]
    }
}

impl Imposed {
    fn water(&self, after_s: f64, sin: f64, cos: f64) -> (f64, f64) {
        let x = self.water_x_m_s + (self.water_x_m_s2 + self.met_x_m_s2) * after_s;
        let z = self.water_z_m_s + self.water_z_m_s2 * after_s;
        to_body(x, z, sin, cos)
    }
}

fn to_body(x: f64, z: f64, sin: f64, cos: f64) -> (f64, f64) {
    (x * cos - z * sin, x * sin + z * cos)
}

fn along(state: &State, rate: &[f64; 6], step_s: f64) -> State {
    State {
        x_m: state.x_m + rate[0] * step_s,
        depth_m: state.depth_m + rate[1] * step_s,
        pitch_rad: state.pitch_rad + rate[2] * step_s,
        momentum_x: state.momentum_x + rate[3] * step_s,
        momentum_z: state.momentum_z + rate[4] * step_s,
        spin: state.spin + rate[5] * step_s,
    }
}
