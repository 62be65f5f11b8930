//! The right-hand side: Leonard and Graver's equations in the vertical plane, written once for every kind of number.
//!
//! With `PP` the momentum of the moving mass, `u = dPP/dt`, `(q1, q3)` the places of masses `q` fixed off the centre of
//! buoyancy (offset mass, ballast), and `m1 = m_h + m_f1`, `m3 = m_h + m_f3`:
//! ```text
//! G = diag(m1, m3, J2) + sum_q q [[1, 0, q3], [0, 1, -q1], [q3, -q1, q1^2 + q3^2]],   ps = G (v1, v3, Om)
//! G (v1', v3', Om')^T = | -(ps3 + PP3) Om - W sin th + L sin a - D cos a - u1
//!                       |  (ps1 + PP1) Om + W cos th - L cos a - D sin a - u3
//!                       |  ps3 v1 - ps1 v3 - (r1 PP1 + r3 PP3) Om - g (S1 cos th + S3 sin th) + M - r3 u1 + r1 u3
//! r1' = PP1/mbar - v1 - r3 Om,   r3' = PP3/mbar - v3 + r1 Om,   PP' = u,   mb' = u4
//! ```
//! Velocities are those through the water. Where the water itself accelerates, so does the frame that they are counted in.
//! With `Vf` the velocity of the water, `v` that of the glider through it, and
//! ```text
//! af = dVf/dt + (Vf . grad) Vf          acceleration of the water
//! ab = af + (v . grad) Vf               of the frame of the water at the glider: the water that it meets next is another
//! ```
//! the masses `mt = m_h + mbar + mb` need `mt ab`, the pressure that accelerates the water gives `m af` with `m` the mass of
//! the displaced water, and the added mass goes with `v'`, which the left side has already. In the right side of `v'` stands
//! ```text
//! m af - mt ab = -m0 af - mt (v . grad) Vf        and in that of Om'        S1 ab3 - S3 ab1
//! ```
//! with `grad` here the change of the horizontal velocity with depth alone. A neutral glider (`m0 = 0`) is carried by water
//! that accelerates alike everywhere; through a steady shear it takes its momentum along. The change of the added momentum by
//! the shear, `-s (M_f v)_x` downward (a few hundredths of the weight in 0.01 1/s), and the turning of the flow along the
//! hull are left out.
//!
//! `W` net weight less what the surface or the seabed carries (their friction and damping: [`super::contact`]), `S1`, `S3` the first moments of all masses off the
//! centre, `M` the hydrodynamic moment without the Munk couple, which `ps3 v1 - ps1 v3` holds. With every offset zero
//! these are the papers' equations, their printing errors corrected.
//!
//! Where the moving mass is held along an axis, `u` there is whatever gives it the acceleration `w` relative to the
//! hull: `u1 = mbar (v1' + r3 Om' + r3' Om + w1)`, `u3 = mbar (v3' - r1 Om' - r1' Om + w3)`. Put into the rows above,
//! the moving mass joins `G`, and the system stays symmetric.

use super::buoyancy::{Memory, Surroundings};
use super::contact::{Contact, Place};
use super::energy::{Usage, moves_1_s, under_water};
use super::forces::{Flow, Hydrodynamics};
use super::parameters::Parameters;
use super::servo::{servo_acceleration, servo_bend_s, servo_corner, servo_speed, slow_servo_bend_s};
use super::state::{Actuation, Inputs, Modes, State, Stop};
use glidepolar_number::{Number, functions};

/// Rate at which a held offset returns to its place, should rounding move it \[1/s\].
const HOLD_RATE_1_S: f64 = 2.0;

/// What is looked at: the FMU's outputs and the columns of a time history.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outputs<T> {
    /// Glide path angle through the water, negative when descending \[rad\].
    pub glide_angle_rad: T,
    /// Angle of attack \[rad\].
    pub angle_of_attack_rad: T,
    /// Speed through the water \[m/s\].
    pub speed_m_s: T,
    /// Rate of change of depth, current included, positive down \[m/s\].
    pub vertical_velocity_m_s: T,
    /// Net mass, positive when heavy \[kg\].
    pub net_mass_kg: T,
    /// Ballast volume that an instrument reads \[m3\].
    pub ballast_m3: T,
    /// Lift \[N\].
    pub lift_N: T,
    /// Drag \[N\].
    pub drag_N: T,
    /// Hydrodynamic pitching moment about the centre of buoyancy, Munk couple and damping included \[N m\].
    pub pitching_moment_N_m: T,
    /// Pitch as the glider's own instrument reads it \[rad\].
    pub pitch_read_rad: T,
    /// Gauge pressure as the glider's own instrument reads it, its lag left out \[dbar\].
    pub pressure_read_dbar: T,
    /// Share of its displacement that the hull has lost above the water.
    pub emerged_fraction: T,
    /// Upward force of the seabed \[N\].
    pub seabed_N: T,
}

/// Rates of change of the state.
///
/// `time_s` is counted from the start; only a leak and changes of drag go by it. Allocates nothing, cannot fail: an
/// impossible state gives NaN, which an integrator must look for.
pub fn derivative<T: Number>(
    parameters: &Parameters<T>,
    actuation: Actuation,
    modes: Modes,
    time_s: T,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> State<T> {
    Motion::new(parameters, time_s, state, inputs).rates(actuation, modes)
}

/// Accelerations along axes 1 and 3 of a glider whose turning is known: pitch and pitch rate as in `state`, pitch
/// acceleration as given, the moving mass resting on the hull where `state` has it.
///
/// The first two rows of [`derivative`], for a glider of which the pitch was measured and the moment was not.
pub fn accelerations<T: Number>(
    parameters: &Parameters<T>,
    time_s: T,
    state: &State<T>,
    inputs: &Inputs<T>,
    pitch_acceleration_rad_s2: T,
) -> [T; 2] {
    let (m, r1, r3) = (parameters.moving_mass_kg, state.moving_mass_1_m, state.moving_mass_3_m);
    let resting = State {
        momentum_1_kg_m_s: m * (state.v1_m_s + r3 * state.pitch_rate_rad_s),
        momentum_3_kg_m_s: m * (state.v3_m_s - r1 * state.pitch_rate_rad_s),
        ..*state
    };
    let motion = Motion::new(parameters, time_s, &resting, inputs);
    let mut inertia = motion.hull_inertia();
    let [ps1, ps3, _] = inertia.times([state.v1_m_s, state.v3_m_s, state.pitch_rate_rad_s]);
    let force = motion.force_without_actuation(ps1, ps3);
    inertia.carry_along_1(m, r3);
    inertia.carry_along_3(m, r1);
    [
        (force[0] - inertia.g15 * pitch_acceleration_rad_s2) / inertia.g11,
        (force[1] - inertia.g35 * pitch_acceleration_rad_s2) / inertia.g33,
    ]
}

/// What is looked at in this state.
pub fn outputs<T: Number>(parameters: &Parameters<T>, time_s: T, state: &State<T>, inputs: &Inputs<T>) -> Outputs<T> {
    let motion = Motion::new(parameters, time_s, state, inputs);
    let hydrodynamics = &motion.hydrodynamics;
    Outputs {
        glide_angle_rad: state.pitch_rad - hydrodynamics.angle_of_attack_rad,
        angle_of_attack_rad: hydrodynamics.angle_of_attack_rad,
        speed_m_s: hydrodynamics.speed_m_s,
        vertical_velocity_m_s: motion.depth_rate_m_s,
        net_mass_kg: motion.net_mass_kg,
        ballast_m3: parameters.ballast_m3(state.ballast_mass_kg),
        lift_N: hydrodynamics.lift_N,
        drag_N: hydrodynamics.drag_N,
        pitching_moment_N_m: hydrodynamics.moment_N_m,
        pitch_read_rad: (state.pitch_rad - parameters.pitch_offset_rad) / parameters.pitch_scale,
        pressure_read_dbar: motion.pressure_Pa / parameters.pressure_scale * 1e-4,
        emerged_fraction: motion.contact.emerged_fraction,
        seabed_N: motion.contact.seabed_N,
    }
}

/// When the next of the servos comes so near to its set-point that it leaves its largest rate, if one runs at it \[s\]: there
/// the rates of change bend. Foreseen as if the set-points stood still.
pub fn next_bend_s(
    parameters: &Parameters<f64>,
    actuation: Actuation,
    time_s: f64,
    state: &State<f64>,
    inputs: &Inputs<f64>,
) -> Option<f64> {
    if actuation != Actuation::Servo {
        return None;
    }
    let p = parameters;
    let volume = p.ballast_m3(state.ballast_mass_kg);
    let to_go_m3 = inputs.ballast_command_m3.held_within(p.ballast_min_m3, p.ballast_max_m3) - volume;
    let ballast_s = servo_bend_s(to_go_m3, p.ballast_rate_m3_s);
    let ahead = [ballast_s, moving_mass_bend_s(p, state, inputs)].into_iter().filter(|in_s| *in_s > 0.0);
    ahead.min_by(f64::total_cmp).map(|in_s| time_s + in_s)
}

/// Functions that are zero where a servo reaches or leaves its largest rate, in either direction: of the ballast, and of the
/// moving mass. There the rates of change have a kink.
pub fn servo_corners<T: Number>(parameters: &Parameters<T>, state: &State<T>, inputs: &Inputs<T>) -> [T; 4] {
    let p = parameters;
    let ballast =
        inputs.ballast_command_m3.held_within(p.ballast_min_m3, p.ballast_max_m3) - p.ballast_m3(state.ballast_mass_kg);
    let mass =
        inputs.moving_mass_command_m.held_within(p.moving_mass_min_m, p.moving_mass_max_m) - state.moving_mass_1_m;
    let [[a, b], [c, d]] = [servo_corner(ballast, p.ballast_rate_m3_s), servo_corner(mass, p.moving_mass_rate_m_s)];
    [a, b, c, d]
}

/// In which time the moving mass leaves its largest speed \[s\]; zero or less where it does not run at it.
fn moving_mass_bend_s(p: &Parameters<f64>, state: &State<f64>, inputs: &Inputs<f64>) -> f64 {
    let target_m = inputs.moving_mass_command_m.held_within(p.moving_mass_min_m, p.moving_mass_max_m);
    let speed =
        state.momentum_1_kg_m_s / p.moving_mass_kg - state.v1_m_s - state.moving_mass_3_m * state.pitch_rate_rad_s;
    slow_servo_bend_s(target_m - state.moving_mass_1_m, speed, p.moving_mass_rate_m_s)
}

/// Force along axis 1 that the moving mass would need to stay where it is on the hull \[N\]. Against a stop, the
/// difference to the commanded force is what the stop carries.
pub(super) fn holding_force_1_N<T: Number>(
    parameters: &Parameters<T>,
    actuation: Actuation,
    time_s: T,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> T {
    let motion = Motion::new(parameters, time_s, state, inputs);
    let held = Modes { moving_mass: Stop::AtMax, ..Modes::default() };
    motion.rates(actuation, held).momentum_1_kg_m_s
}

/// Everything that follows from one state, computed once.
struct Motion<'a, T> {
    parameters: &'a Parameters<T>,
    state: &'a State<T>,
    inputs: &'a Inputs<T>,
    sin_pitch: T,
    cos_pitch: T,
    depth_rate_m_s: T,
    ground_speed_m_s: T,
    pressure_Pa: T,
    net_mass_kg: T,
    water: Surroundings<T>,
    memory: Memory<T>,
    contact: Contact<T>,
    hydrodynamics: Hydrodynamics<T>,
    /// Acceleration of the frame of the water at the glider, along axes 1 and 3 \[m/s2\].
    frame_m_s2: [T; 2],
    /// Force of accelerating water on body and displaced volume, along axes 1 and 3 \[N\].
    carrying_N: [T; 2],
}

impl<'a, T: Number> Motion<'a, T> {
    fn new(parameters: &'a Parameters<T>, time_s: T, state: &'a State<T>, inputs: &'a Inputs<T>) -> Self {
        let (sin_pitch, cos_pitch) = functions::sin_cos(state.pitch_rad);
        let sink = state.v3_m_s * cos_pitch - state.v1_m_s * sin_pitch;
        let place = Place::new(parameters, state.depth_m, inputs.seabed_depth_m);
        let share = place.current_share();
        let depth_rate_m_s = sink + inputs.current_z_m_s * share + parameters.vertical_current_m_s * share;
        let ground_speed_m_s = state.v1_m_s * cos_pitch + state.v3_m_s * sin_pitch + inputs.current_x_m_s * share;

        let density_kg_m3 = parameters.true_density_kg_m3(inputs.water_density_kg_m3);
        let pressure_Pa = density_kg_m3 * parameters.gravity_m_s2 * state.depth_m.at_least(0.0);
        let water = Surroundings {
            density_kg_m3: inputs.water_density_kg_m3,
            pressure_Pa,
            temperature_C: inputs.water_temperature_C,
            time_s,
        };
        let flow = Flow {
            v1_m_s: state.v1_m_s,
            v3_m_s: state.v3_m_s,
            pitch_rate_rad_s: state.pitch_rate_rad_s,
            sink_m_s: sink,
            density_kg_m3,
            time_s,
            roll_rad: inputs.roll_rad,
            rudder_rad: inputs.rudder_rad,
            empirical: parameters.empirical(&water),
        };
        let memory = Memory {
            creep_pressure_Pa: state.creep_pressure_Pa,
            carried_density_kg_m3: state.carried_density_kg_m3,
            late_temperature_K: state.late_temperature_K,
            leaked_back_m3: state.leaked_back_m3,
        };
        let ballast_m3 = parameters.ballast_m3(state.ballast_mass_kg);
        let displaced_kg = parameters.displaced_kg(ballast_m3, &water);
        let net_mass_kg = parameters.net_mass_kg(ballast_m3, &water) + parameters.kept_mass_kg(&memory, &water);
        let mass_kg = parameters.hull_mass_kg + parameters.moving_mass_kg + state.ballast_mass_kg;
        let shear_1_s = inputs.current_x_shear_1_s * share;
        let water_x_m_s2 = inputs.current_x_rate_m_s2 * share + shear_1_s * (depth_rate_m_s - sink);
        let water_z_m_s2 = inputs.current_z_rate_m_s2 * share;
        let met_x_m_s2 = shear_1_s * sink;
        let to_body = |x: T, z: T| [x * cos_pitch - z * sin_pitch, x * sin_pitch + z * cos_pitch];
        Motion {
            parameters,
            state,
            inputs,
            sin_pitch,
            cos_pitch,
            depth_rate_m_s,
            ground_speed_m_s,
            pressure_Pa,
            net_mass_kg,
            water,
            memory,
            frame_m_s2: to_body(water_x_m_s2 + met_x_m_s2, water_z_m_s2),
            carrying_N: to_body(-net_mass_kg * water_x_m_s2 - mass_kg * met_x_m_s2, -net_mass_kg * water_z_m_s2),
            contact: place.contact(parameters, displaced_kg, depth_rate_m_s, ground_speed_m_s * ground_speed_m_s),
            hydrodynamics: parameters.hydrodynamics(&flow),
        }
    }

    fn rates(&self, actuation: Actuation, modes: Modes) -> State<T> {
        let (p, s, i) = (self.parameters, self.state, self.inputs);
        let (m, r1, r3) = (p.moving_mass_kg, s.moving_mass_1_m, s.moving_mass_3_m);
        let (v1, v3, rate) = (s.v1_m_s, s.v3_m_s, s.pitch_rate_rad_s);
        let (pp1, pp3) = (s.momentum_1_kg_m_s, s.momentum_3_kg_m_s);
        let r1_rate = pp1 / m - v1 - r3 * rate;
        let r3_rate = pp3 / m - v3 + r1 * rate;

        let mut inertia = self.hull_inertia();
        let [ps1, ps3, _] = inertia.times([v1, v3, rate]);
        let mut force = self.force_without_actuation(ps1, ps3);

        let held_1 = self.prescribed_acceleration_1(actuation, modes, r1_rate);
        let held_3 = match actuation {
            Actuation::Raw => None,
            Actuation::Servo | Actuation::RawAlongAxis1 => Some(hold(r3 - p.moving_mass_height_m, r3_rate)),
        };
        let pushed_1 = held_1.map(|w1| m * (w1 + r3_rate * rate));
        let pushed_3 = held_3.map(|w3| m * (w3 - r1_rate * rate));
        if pushed_1.is_some() {
            inertia.carry_along_1(m, r3);
        }
        if pushed_3.is_some() {
            inertia.carry_along_3(m, r1);
        }
        let (push_1, push_3) = (pushed_1.unwrap_or(i.u1_N), pushed_3.unwrap_or(i.u3_N));
        force[0] -= push_1;
        force[1] -= push_3;
        force[2] = force[2] - r3 * push_1 + r1 * push_3;

        let [v1_dot, v3_dot, pitch_acceleration] = inertia.solve(force);
        let u1 = match pushed_1 {
            Some(push) => push + m * (v1_dot + r3 * pitch_acceleration),
            None => i.u1_N,
        };
        let u3 = match pushed_3 {
            Some(push) => push + m * (v3_dot - r1 * pitch_acceleration),
            None => i.u3_N,
        };
        let ballast_rate = self.ballast_mass_rate_kg_s(actuation, modes);
        let pumping = ballast_rate / (p.reference_density_kg_m3 * p.ballast_rate_m3_s);
        let memory = p.memory_rates(&self.memory, &self.water, pumping);

        State {
            x_m: self.ground_speed_m_s,
            depth_m: self.depth_rate_m_s,
            pitch_rad: rate,
            pitch_rate_rad_s: pitch_acceleration,
            v1_m_s: v1_dot,
            v3_m_s: v3_dot,
            moving_mass_1_m: r1_rate,
            moving_mass_3_m: r3_rate,
            momentum_1_kg_m_s: u1,
            momentum_3_kg_m_s: u3,
            ballast_mass_kg: ballast_rate,
            creep_pressure_Pa: memory.creep_pressure_Pa,
            carried_density_kg_m3: memory.carried_density_kg_m3,
            late_temperature_K: memory.late_temperature_K,
            leaked_back_m3: memory.leaked_back_m3,
            energy_J: self.power_W(ballast_rate, held_1.filter(|_| actuation == Actuation::Servo), r1_rate),
        }
    }

    /// Inertia of everything but the moving mass.
    fn hull_inertia(&self) -> Inertia<T> {
        let p = self.parameters;
        // Carried water goes along in every direction; what it adds in pitch is not known.
        let hull = p.hull_mass_kg - p.offset_mass_kg + p.carried_mass_kg();
        let mut inertia = Inertia {
            g11: hull + p.added_mass_1_kg,
            g33: hull + p.added_mass_3_kg,
            g55: p.pitch_inertia_kg_m2,
            g15: T::constant(0.0),
            g35: p.added_Z_qdot_kg_m,
        };
        inertia.add_mass(p.offset_mass_kg, p.offset_mass_forward_m, p.offset_mass_below_m);
        inertia.add_mass(self.state.ballast_mass_kg, p.ballast_forward_m, p.ballast_below_m);
        inertia
    }

    /// The right side of the momentum equations, the forces on the moving mass left out.
    fn force_without_actuation(&self, ps1: T, ps3: T) -> [T; 3] {
        let (p, s, h) = (self.parameters, self.state, &self.hydrodynamics);
        let (sin, cos) = (self.sin_pitch, self.cos_pitch);
        let (v1, v3, rate) = (s.v1_m_s, s.v3_m_s, s.pitch_rate_rad_s);
        let (lift, drag) = self.lift_and_drag_per_speed();
        let weight = self.net_mass_kg * p.gravity_m_s2 - self.contact.support_N;
        let friction_N = -self.contact.friction_N_s_m * self.ground_speed_m_s;
        let moment_1 = p.moving_mass_kg * s.moving_mass_1_m
            + p.offset_mass_kg * p.offset_mass_forward_m
            + s.ballast_mass_kg * p.ballast_forward_m;
        let moment_3 = p.moving_mass_kg * s.moving_mass_3_m
            + p.offset_mass_kg * p.offset_mass_below_m
            + s.ballast_mass_kg * p.ballast_below_m;
        [
            -(ps3 + s.momentum_3_kg_m_s) * rate - weight * sin + lift * v3 - drag * v1
                + friction_N * cos
                + self.carrying_N[0],
            (ps1 + s.momentum_1_kg_m_s) * rate + weight * cos - lift * v1 - drag * v3
                + friction_N * sin
                + self.carrying_N[1],
            ps3 * v1
                - ps1 * v3
                - (s.moving_mass_1_m * s.momentum_1_kg_m_s + s.moving_mass_3_m * s.momentum_3_kg_m_s) * rate
                - p.gravity_m_s2 * (moment_1 * cos + moment_3 * sin)
                + h.moment_without_munk_N_m
                - self.contact.pitch_damping_N_m_s * rate
                + moment_1 * self.frame_m_s2[1]
                - moment_3 * self.frame_m_s2[0],
        ]
    }

    /// Lift and drag over speed, which turn with the velocity itself: no angle is needed, and rest is no exception.
    fn lift_and_drag_per_speed(&self) -> (T, T) {
        let h = &self.hydrodynamics;
        if h.speed_m_s.value() == 0.0 {
            return (T::constant(0.0), T::constant(0.0));
        }
        (h.lift_N / h.speed_m_s, h.drag_N / h.speed_m_s)
    }

    /// The acceleration along axis 1 that a servo or a stop imposes on the moving mass, if one does.
    fn prescribed_acceleration_1(&self, actuation: Actuation, modes: Modes, r1_rate: T) -> Option<T> {
        let p = self.parameters;
        let position = self.state.moving_mass_1_m;
        match (actuation, modes.moving_mass) {
            (Actuation::Servo, _) => {
                let target = self.inputs.moving_mass_command_m.held_within(p.moving_mass_min_m, p.moving_mass_max_m);
                let limit = p.moving_mass_rate_m_s;
                Some(servo_acceleration(target - position, r1_rate, limit))
            }
            (_, Stop::Free) => None,
            (_, Stop::AtMin | Stop::AtMax) => Some(-r1_rate * (2.0 * HOLD_RATE_1_S)),
        }
    }

    fn ballast_mass_rate_kg_s(&self, actuation: Actuation, modes: Modes) -> T {
        let p = self.parameters;
        match (actuation, modes.ballast) {
            (Actuation::Servo, _) => {
                let target = self.inputs.ballast_command_m3.held_within(p.ballast_min_m3, p.ballast_max_m3);
                let limit = p.ballast_rate_m3_s;
                let volume = p.ballast_m3(self.state.ballast_mass_kg);
                -p.reference_density_kg_m3 * servo_speed(target - volume, limit)
            }
            (_, Stop::Free) => self.inputs.u4_kg_s,
            (_, Stop::AtMin | Stop::AtMax) => T::constant(0.0),
        }
    }

    /// Power drawn: the account of one second. A surfacing is no matter of seconds: whoever meets the surface counts it.
    fn power_W(&self, ballast_mass_rate_kg_s: T, servo_m_s2: Option<T>, mass_m_s: T) -> T {
        let p = self.parameters;
        let zero = T::constant(0.0);
        let usage_1_s = Usage {
            time_s: T::constant(1.0),
            under_water_s: under_water(self.state.depth_m),
            pumped_m3: (-ballast_mass_rate_kg_s / p.reference_density_kg_m3).at_least(0.0),
            pressure_Pa: self.pressure_Pa,
            pitch_moves: servo_m_s2
                .map_or(zero, |acceleration| moves_1_s(acceleration, mass_m_s, p.moving_mass_rate_m_s)),
            surfacings: zero,
        };
        usage_1_s.energy(p).total_J()
    }
}

/// Acceleration that brings a held offset back to zero without overshoot.
fn hold<T: Number>(offset: T, rate: T) -> T {
    -rate * (2.0 * HOLD_RATE_1_S) - offset * (HOLD_RATE_1_S * HOLD_RATE_1_S)
}

/// The symmetric inertia of surge, heave and pitch (axes 1, 3, 5); surge and heave never couple directly.
struct Inertia<T> {
    g11: T,
    g33: T,
    g55: T,
    g15: T,
    g35: T,
}

impl<T: Number> Inertia<T> {
    fn add_mass(&mut self, mass: T, forward: T, below: T) {
        self.carry_along_1(mass, below);
        self.carry_along_3(mass, forward);
    }

    /// A mass at `below` that must follow the hull along axis 1.
    fn carry_along_1(&mut self, mass: T, below: T) {
        self.g11 += mass;
        self.g15 += mass * below;
        self.g55 += mass * below * below;
    }

    /// A mass at `forward` that must follow the hull along axis 3.
    fn carry_along_3(&mut self, mass: T, forward: T) {
        self.g33 += mass;
        self.g35 -= mass * forward;
        self.g55 += mass * forward * forward;
    }

    fn times(&self, [v1, v3, rate]: [T; 3]) -> [T; 3] {
        [
            self.g11 * v1 + self.g15 * rate,
            self.g33 * v3 + self.g35 * rate,
            self.g15 * v1 + self.g35 * v3 + self.g55 * rate,
        ]
    }

    fn solve(&self, [f1, f3, f5]: [T; 3]) -> [T; 3] {
        let (s1, s3) = (self.g15 / self.g11, self.g35 / self.g33);
        let pitch = (f5 - s1 * f1 - s3 * f3) / (self.g55 - s1 * self.g15 - s3 * self.g35);
        [f1 / self.g11 - s1 * pitch, f3 / self.g33 - s3 * pitch, pitch]
    }
}
