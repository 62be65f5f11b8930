//! The right-hand side in six degrees of freedom, in velocities through the water.
//!
//! ```text
//! (P, Pi) = M (v, Om) + (momentum of the masses relative to the hull)
//! P'  = P x Om + W k + F - m (dV/dt) + (m - m0) (DV/Dt)
//! Pi' = Pi x Om + P x v + S x (g k - dV/dt) + T
//! ```
//! `M` inertia of masses and added mass ([`Inertia`]), `k` the direction of gravity in body axes, `W` net weight less what
//! surface or seabed carry, `S` the first moment of all masses, `F`, `T` the water's force and moment, `m0` net mass.
//! `dV/dt` is the rate of change of the water's velocity along the glider's way, an inertial force in the frame that moves
//! with the water; `DV/Dt` is the acceleration of the water itself, which the pressure around the hull carries. They are the
//! same in uniform water. Surface and seabed hold, damp and rub as they do in the plane: friction against the way over
//! ground, whatever its direction, and the damping of the pitch about every axis in proportion to its inertia. The moving
//! mass follows its servos: its acceleration in the hull is known before the hull's.

use glidepolar_dynamics::Surroundings;
use glidepolar_dynamics::buoyancy::Memory;
use glidepolar_dynamics::contact::{Contact, Place};
use glidepolar_dynamics::energy::{Usage, moves_1_s, under_water};
use glidepolar_dynamics::servo::{servo_acceleration, servo_speed};
use glidepolar_number::{Number, functions};

use super::forces::{Hydrodynamics, Motion};
use super::inertia::{Inertia, Mover};
use super::lateral::Body;
use super::servos::ways_to_go;
use super::state::{Inputs, State};
use super::vector::{Attitude, Vector, add, cross, scale};

/// Rates of change of the state. `time_s` is counted from the start; a leak and changes of drag depend on it. Allocates
/// nothing, cannot fail: an impossible state gives NaN.
pub fn derivative<T: Number>(body: &Body<T>, time_s: T, state: &State<T>, inputs: &Inputs<T>) -> State<T> {
    Instant::new(body, time_s, state, inputs).rates_of_change()
}

/// The accelerations of a glider whose moving mass and rudder stand still in the hull: along the axes and about them.
pub fn accelerations<T: Number>(
    body: &Body<T>,
    time_s: T,
    state: &State<T>,
    inputs: &Inputs<T>,
) -> (Vector<T>, Vector<T>) {
    Instant::new(body, time_s, state, inputs).accelerations(T::constant(0.0), T::constant(0.0))
}

/// Everything that follows from one state, computed once.
pub(super) struct Instant<'a, T> {
    pub(super) body: &'a Body<T>,
    state: &'a State<T>,
    inputs: &'a Inputs<T>,
    pub(super) v: Vector<T>,
    pub(super) rates: Vector<T>,
    pub(super) attitude: Attitude<T>,
    sink_m_s: T,
    pub(super) depth_rate_m_s: T,
    /// North and east.
    over_ground_m_s: [T; 2],
    /// Of the current, that the hull feels.
    share: T,
    pub(super) water: Surroundings<T>,
    memory: Memory<T>,
    pub(super) net_mass_kg: T,
    pub(super) contact: Contact<T>,
    pub(super) hydrodynamics: Hydrodynamics<T>,
}

impl<'a, T: Number> Instant<'a, T> {
    pub(super) fn new(body: &'a Body<T>, time_s: T, state: &'a State<T>, inputs: &'a Inputs<T>) -> Self {
        let p = &body.plane;
        let v = [state.v1_m_s, state.v2_m_s, state.v3_m_s];
        let rates = [state.p_rad_s, state.q_rad_s, state.r_rad_s];
        let attitude = Attitude::new(state.roll_rad, state.pitch_rad, state.heading_rad);
        let place = Place::new(p, state.depth_m, inputs.seabed_depth_m);
        let share = place.current_share();
        let [north, east, sink_m_s] = attitude.to_earth(v);
        let depth_rate_m_s = sink_m_s + inputs.current_down_m_s * share + p.vertical_current_m_s * share;
        let over_ground_m_s = [north + inputs.current_north_m_s * share, east + inputs.current_east_m_s * share];
        let density_kg_m3 = p.true_density_kg_m3(inputs.water_density_kg_m3);
        let pressure_Pa = density_kg_m3 * p.gravity_m_s2 * state.depth_m.at_least(0.0);
        let water = Surroundings {
            density_kg_m3: inputs.water_density_kg_m3,
            pressure_Pa,
            temperature_C: inputs.water_temperature_C,
            time_s,
        };
        let motion = Motion {
            v,
            rates,
            sink_m_s,
            density_kg_m3,
            time_s,
            roll_rad: state.roll_rad,
            rudder_rad: state.rudder_rad + body.lateral.rudder_offset_rad,
            empirical: p.empirical(&water),
        };
        let memory = Memory {
            creep_pressure_Pa: state.creep_pressure_Pa,
            carried_density_kg_m3: state.carried_density_kg_m3,
            late_temperature_K: state.late_temperature_K,
            leaked_back_m3: state.leaked_back_m3,
        };
        let ballast_m3 = p.ballast_m3(state.ballast_mass_kg);
        let displaced_kg = p.displaced_kg(ballast_m3, &water);
        let ground_speed_squared = over_ground_m_s[0] * over_ground_m_s[0] + over_ground_m_s[1] * over_ground_m_s[1];
        Instant {
            body,
            state,
            inputs,
            v,
            rates,
            attitude,
            sink_m_s,
            depth_rate_m_s,
            over_ground_m_s,
            share,
            water,
            memory,
            net_mass_kg: p.net_mass_kg(ballast_m3, &water) + p.kept_mass_kg(&memory, &water),
            contact: place.contact(p, displaced_kg, depth_rate_m_s, ground_speed_squared),
            hydrodynamics: body.hydrodynamics(&motion),
        }
    }

    /// Rates of change of the whole state.
    pub(super) fn rates_of_change(&self) -> State<T> {
        let state = self.state;
        let (p, l) = (&self.body.plane, &self.body.lateral);
        let [to_ballast, to_mass, to_roll, to_rudder] = ways_to_go(self.body, state, self.inputs);
        let sliding = servo_acceleration(to_mass, state.moving_mass_speed_m_s, p.moving_mass_rate_m_s);
        let turning = servo_acceleration(to_roll, state.roll_mass_rate_rad_s, l.roll_mass_rate_rad_s);
        let rudder_rate = servo_speed(to_rudder, l.rudder_rate_rad_s);
        let pumping = servo_speed(to_ballast, p.ballast_rate_m3_s);
        let (acceleration, turning_rate) = self.accelerations(sliding, turning);
        let memory = p.memory_rates(&self.memory, &self.water, -pumping / p.ballast_rate_m3_s);
        let [roll_rate, pitch_rate, heading_rate] = self.euler_rates();
        State {
            north_m: self.over_ground_m_s[0],
            east_m: self.over_ground_m_s[1],
            depth_m: self.depth_rate_m_s,
            roll_rad: roll_rate,
            pitch_rad: pitch_rate,
            heading_rad: heading_rate,
            v1_m_s: acceleration[0],
            v2_m_s: acceleration[1],
            v3_m_s: acceleration[2],
            p_rad_s: turning_rate[0],
            q_rad_s: turning_rate[1],
            r_rad_s: turning_rate[2],
            moving_mass_m: state.moving_mass_speed_m_s,
            moving_mass_speed_m_s: sliding,
            roll_mass_rad: state.roll_mass_rate_rad_s,
            roll_mass_rate_rad_s: turning,
            rudder_rad: rudder_rate,
            ballast_mass_kg: -p.reference_density_kg_m3 * pumping,
            creep_pressure_Pa: memory.creep_pressure_Pa,
            carried_density_kg_m3: memory.carried_density_kg_m3,
            late_temperature_K: memory.late_temperature_K,
            leaked_back_m3: memory.leaked_back_m3,
            energy_J: self.power_W(pumping, sliding, rudder_rate),
        }
    }

    /// Accelerations along and about the axes, for an acceleration of the moving mass along the hull and of its turning.
    fn accelerations(&self, sliding: T, turning: T) -> (Vector<T>, Vector<T>) {
        let (p, l, s) = (&self.body.plane, &self.body.lateral, self.state);
        let mut inertia = self.hull_inertia();
        let (mover, acceleration) = self.mover(sliding, turning);
        mover.join(&mut inertia);
        let (momentum, angular) = inertia.times(self.v, self.rates);
        let (extra, extra_angular) = mover.relative();
        let (momentum, angular) = (add(momentum, extra), add(angular, extra_angular));
        let turning_acceleration = [-turning, T::constant(0.0), T::constant(0.0)];
        let (rate, angular_rate) = mover.rate(self.v, self.rates, acceleration, turning_acceleration);

        let down = self.attitude.down();
        let along_the_way = self.attitude.to_body(self.water_along_the_way());
        let of_the_water = self.attitude.to_body(self.water_itself());
        let mass = p.hull_mass_kg + p.moving_mass_kg + s.ballast_mass_kg;
        let weight = self.net_mass_kg * p.gravity_m_s2 - self.contact.support_N;
        let displaced = mass - self.net_mass_kg;
        let moments = self.first_moment(&mover);
        let pull: Vector<T> = std::array::from_fn(|i| p.gravity_m_s2 * down[i] - along_the_way[i]);
        let (h, turned, turned_angular) =
            (&self.hydrodynamics, cross(momentum, self.rates), cross(angular, self.rates));
        let (munk, tilt) = (cross(momentum, self.v), cross(moments, pull));
        let rubbing = self.friction_N();
        let damping = self.contact.pitch_damping_N_m_s;
        let axes = [l.roll_inertia_kg_m2, p.pitch_inertia_kg_m2, l.yaw_inertia_kg_m2];
        let force = std::array::from_fn(|i| {
            turned[i]
                + weight * down[i]
                + h.force_N[i]
                + (displaced * of_the_water[i] - mass * along_the_way[i])
                + rubbing[i]
                - rate[i]
        });
        let moment = std::array::from_fn(|i| {
            turned_angular[i] + munk[i] + tilt[i] + h.moment_N_m[i]
                - damping * (axes[i] / p.pitch_inertia_kg_m2) * self.rates[i]
                - angular_rate[i]
        });
        inertia.solve(force, moment)
    }

    /// Inertia of everything but the moving mass.
    fn hull_inertia(&self) -> Inertia<T> {
        let (p, l) = (&self.body.plane, &self.body.lateral);
        let mut inertia = Inertia::zero();
        let hull = p.hull_mass_kg - p.offset_mass_kg + p.carried_mass_kg();
        for (axis, added) in [p.added_mass_1_kg, l.added_mass_2_kg, p.added_mass_3_kg].into_iter().enumerate() {
            inertia.add_along(axis, hull + added);
        }
        inertia.add_about(0, 0, l.roll_inertia_kg_m2);
        // The plane's inertia in pitch contains that of the moving mass about its own centre.
        inertia.add_about(1, 1, p.pitch_inertia_kg_m2 - l.moving_inertia_2_kg_m2);
        inertia.add_about(2, 2, l.yaw_inertia_kg_m2);
        inertia.add_coupling(1, 2, l.added_Y_rdot_kg_m);
        inertia.add_coupling(2, 1, p.added_Z_qdot_kg_m);
        let zero = T::constant(0.0);
        inertia.add_mass(p.offset_mass_kg, [p.offset_mass_forward_m, zero, p.offset_mass_below_m]);
        inertia.add_mass(self.state.ballast_mass_kg, [p.ballast_forward_m, zero, p.ballast_below_m]);
        self.add_list(&mut inertia);
        inertia
    }

    /// A static list is all of the hull's mass to one side: its first moment there, and the products with its other places.
    fn add_list(&self, inertia: &mut Inertia<T>) {
        let (p, moment) = (&self.body.plane, self.body.lateral.starboard_moment_kg_m);
        let aside = moment / p.hull_mass_kg;
        inertia.add_coupling(0, 2, -moment);
        inertia.add_coupling(2, 0, moment);
        inertia.add_about(0, 0, moment * aside);
        inertia.add_about(2, 2, moment * aside);
        inertia.add_about(0, 1, -aside * p.offset_mass_kg * p.offset_mass_forward_m);
        inertia.add_about(1, 2, -aside * p.offset_mass_kg * p.offset_mass_below_m);
    }

    /// The moving mass. The roll mass is the part of it that turns about the hull's axis: at angle zero their common centre
    /// lies where the vertical plane has it. To starboard is a negative turn about axis 1.
    fn mover(&self, sliding: T, turning: T) -> (Mover<T>, Vector<T>) {
        let (p, l, s) = (&self.body.plane, &self.body.lateral, self.state);
        let radius = l.roll_mass_kg * l.roll_mass_radius_m / p.moving_mass_kg;
        let (sin, cos) = functions::sin_cos(s.roll_mass_rad + l.roll_mass_offset_rad);
        let rate = s.roll_mass_rate_rad_s;
        let zero = T::constant(0.0);
        let place = [s.moving_mass_m, radius * sin, p.moving_mass_height_m - radius * (-cos + 1.0)];
        let speed = [s.moving_mass_speed_m_s, radius * cos * rate, -(radius * sin * rate)];
        let acceleration =
            [sliding, radius * (cos * turning - sin * rate * rate), -(radius * (sin * turning + cos * rate * rate))];
        let [i1, i2, i3] = [l.moving_inertia_1_kg_m2, l.moving_inertia_2_kg_m2, l.moving_inertia_3_kg_m2];
        let product = (i3 - i2) * sin * cos;
        let own = [
            [i1, zero, zero],
            [zero, i2 * cos * cos + i3 * sin * sin, product],
            [zero, product, i2 * sin * sin + i3 * cos * cos],
        ];
        (Mover { mass: p.moving_mass_kg, place, speed, turning: [-rate, zero, zero], own }, acceleration)
    }

    /// First moment of all masses about the centre of buoyancy.
    fn first_moment(&self, mover: &Mover<T>) -> Vector<T> {
        let (p, s) = (&self.body.plane, self.state);
        let moving = scale(mover.mass, mover.place);
        [
            moving[0] + p.offset_mass_kg * p.offset_mass_forward_m + s.ballast_mass_kg * p.ballast_forward_m,
            moving[1] + self.body.lateral.starboard_moment_kg_m,
            moving[2] + p.offset_mass_kg * p.offset_mass_below_m + s.ballast_mass_kg * p.ballast_below_m,
        ]
    }

    /// Friction of the seabed against the way over ground, in body axes.
    fn friction_N(&self) -> Vector<T> {
        let per_speed = -self.contact.friction_N_s_m;
        let [north, east] = self.over_ground_m_s;
        self.attitude.to_body([per_speed * north, per_speed * east, T::constant(0.0)])
    }

    /// How the water's velocity changes along the glider's way, north, east, down.
    pub(super) fn water_along_the_way(&self) -> Vector<T> {
        self.water_changes(self.depth_rate_m_s)
    }

    /// How the velocity of the water itself changes.
    fn water_itself(&self) -> Vector<T> {
        self.water_changes(self.depth_rate_m_s - self.sink_m_s)
    }

    fn water_changes(&self, downwards_m_s: T) -> Vector<T> {
        let (i, share) = (self.inputs, self.share);
        [
            i.current_north_rate_m_s2 * share + i.current_north_shear_1_s * share * downwards_m_s,
            i.current_east_rate_m_s2 * share + i.current_east_shear_1_s * share * downwards_m_s,
            i.current_down_rate_m_s2 * share,
        ]
    }

    /// Rates of change of roll, pitch and heading.
    fn euler_rates(&self) -> Vector<T> {
        let ((sr, cr), (sp, cp)) = (self.attitude.roll, self.attitude.pitch);
        let [p, q, r] = self.rates;
        let heading = (q * sr + r * cr) / cp;
        [p + heading * sp, q * cr - r * sr, heading]
    }

    /// Power drawn: the account of one second as in the plane, and rudder and roll mass by their speed. Where the vehicle has a
    /// figure for these, it stands in place of the mean power of steering.
    fn power_W(&self, pumping_m3_s: T, sliding_m_s2: T, rudder_rate: T) -> T {
        let (p, l) = (&self.body.plane, &self.body.lateral);
        let zero = T::constant(0.0);
        let usage_1_s = Usage {
            time_s: T::constant(1.0),
            under_water_s: if l.counts_steering() { zero } else { under_water(self.state.depth_m) },
            pumped_m3: pumping_m3_s.at_least(0.0),
            pressure_Pa: self.water.pressure_Pa,
            pitch_moves: moves_1_s(sliding_m_s2, self.state.moving_mass_speed_m_s, p.moving_mass_rate_m_s),
            surfacings: zero,
        };
        usage_1_s.energy(p).total_J()
            + l.rudder_power_W * (rudder_rate / l.rudder_rate_rad_s).abs()
            + l.roll_mass_power_W * (self.state.roll_mass_rate_rad_s / l.roll_mass_rate_rad_s).abs()
    }
}
