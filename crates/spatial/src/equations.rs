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
//! same in uniform water. The moving mass follows its servos: its acceleration in the hull is known before the hull's.

use glidepolar_dynamics::Surroundings;
use glidepolar_dynamics::contact::Place;
use glidepolar_dynamics::equations::{servo_acceleration, servo_speed};
use glidepolar_number::Number;

use super::forces::{Hydrodynamics, Motion};
use super::inertia::{Inertia, Mover};
use super::lateral::Body;
use super::state::{Inputs, State};
use super::vector::{Attitude, Vector, add, cross, dot, scale};

/// What follows from a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outputs<T> {
    /// Speed through the water \[m/s\].
    pub speed_m_s: T,
    /// Angle of attack \[rad\].
    pub angle_of_attack_rad: T,
    /// Sideslip, flow from starboard positive \[rad\].
    pub sideslip_rad: T,
    /// Angle of the path through the water above the horizontal \[rad\].
    pub glide_angle_rad: T,
    /// Rate of change of the heading \[rad/s\].
    pub turn_rate_rad_s: T,
    /// Rate of change of depth, current included \[m/s\].
    pub vertical_velocity_m_s: T,
    /// Net mass, positive when heavy \[kg\].
    pub net_mass_kg: T,
    /// Power drawn \[W\].
    pub power_W: T,
    /// What an accelerometer at the centre of buoyancy reads, along each axis \[m/s2\]: acceleration less gravity.
    pub imu_m_s2: [T; 3],
}

/// Rates of change of the state. `time_s` is counted from the start; a leak and changes of drag depend on it. Allocates
/// nothing, cannot fail: an impossible state gives NaN.
pub fn derivative<T: Number>(body: &Body<T>, time_s: T, state: &State<T>, inputs: &Inputs<T>) -> State<T> {
    let (p, l) = (&body.plane, &body.lateral);
    let place = |target: T, low: T, high: T, at: T| target.held_within(low, high) - at;
    let sliding = servo_acceleration(
        place(inputs.moving_mass_command_m, p.moving_mass_min_m, p.moving_mass_max_m, state.moving_mass_m),
        state.moving_mass_speed_m_s,
        p.moving_mass_rate_m_s,
    );
    let turning = servo_acceleration(
        place(inputs.roll_mass_command_rad, l.roll_mass_min_rad, l.roll_mass_max_rad, state.roll_mass_rad),
        state.roll_mass_rate_rad_s,
        l.roll_mass_rate_rad_s,
    );
    let rudder_rate = servo_speed(
        place(inputs.rudder_command_rad, l.rudder_min_rad, l.rudder_max_rad, state.rudder_rad),
        l.rudder_rate_rad_s,
    );
    let volume = p.ballast_m3(state.ballast_mass_kg);
    let pumping =
        servo_speed(place(inputs.ballast_command_m3, p.ballast_min_m3, p.ballast_max_m3, volume), p.ballast_rate_m3_s);
    let now = Instant::new(body, time_s, state, inputs);
    let (acceleration, turning_rate) = now.accelerations(sliding, turning);
    let way = now.attitude.to_earth(now.v);
    let [roll_rate, pitch_rate, heading_rate] = now.euler_rates();
    State {
        north_m: way[0] + inputs.current_north_m_s,
        east_m: way[1] + inputs.current_east_m_s,
        depth_m: now.depth_rate_m_s,
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
        energy_J: now.power_W(pumping, rudder_rate),
    }
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

/// What follows from a state, its servos included.
pub fn outputs<T: Number>(body: &Body<T>, time_s: T, state: &State<T>, inputs: &Inputs<T>) -> Outputs<T> {
    let rates = derivative(body, time_s, state, inputs);
    let now = Instant::new(body, time_s, state, inputs);
    let h = &now.hydrodynamics;
    let sink = dot(now.attitude.down(), now.v);
    let path = if h.speed_m_s.value() > 0.0 { -(sink / h.speed_m_s).asin() } else { T::constant(0.0) };
    let own = [rates.v1_m_s, rates.v2_m_s, rates.v3_m_s];
    let carried = add(cross(now.rates, now.v), now.attitude.to_body(now.water_along_the_way()));
    let gravity = scale(body.plane.gravity_m_s2, now.attitude.down());
    Outputs {
        speed_m_s: h.speed_m_s,
        angle_of_attack_rad: h.angle_of_attack_rad,
        sideslip_rad: h.sideslip_rad,
        glide_angle_rad: path,
        turn_rate_rad_s: rates.heading_rad,
        vertical_velocity_m_s: now.depth_rate_m_s,
        net_mass_kg: now.net_mass_kg,
        power_W: rates.energy_J,
        imu_m_s2: std::array::from_fn(|i| own[i] + carried[i] - gravity[i]),
    }
}

/// Everything that follows from one state, computed once.
struct Instant<'a, T> {
    body: &'a Body<T>,
    state: &'a State<T>,
    inputs: &'a Inputs<T>,
    v: Vector<T>,
    rates: Vector<T>,
    attitude: Attitude<T>,
    depth_rate_m_s: T,
    pressure_Pa: T,
    net_mass_kg: T,
    support_N: T,
    hydrodynamics: Hydrodynamics<T>,
}

impl<'a, T: Number> Instant<'a, T> {
    fn new(body: &'a Body<T>, time_s: T, state: &'a State<T>, inputs: &'a Inputs<T>) -> Self {
        let p = &body.plane;
        let v = [state.v1_m_s, state.v2_m_s, state.v3_m_s];
        let rates = [state.p_rad_s, state.q_rad_s, state.r_rad_s];
        let attitude = Attitude::new(state.roll_rad, state.pitch_rad, state.heading_rad);
        let sink_m_s = dot(attitude.down(), v);
        let depth_rate_m_s = sink_m_s + inputs.current_down_m_s + p.vertical_current_m_s;
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
        };
        Instant {
            body,
            state,
            inputs,
            v,
            rates,
            attitude,
            depth_rate_m_s,
            pressure_Pa,
            net_mass_kg: p.net_mass_kg(p.ballast_m3(state.ballast_mass_kg), &water),
            support_N: Place::new(p, state.depth_m, inputs.seabed_depth_m)
                .contact(
                    p,
                    p.displaced_kg(p.ballast_m3(state.ballast_mass_kg), &water),
                    depth_rate_m_s,
                    T::constant(0.0),
                )
                .support_N,
            hydrodynamics: body.hydrodynamics(&motion),
        }
    }

    /// Accelerations along and about the axes, for an acceleration of the moving mass along the hull and of its turning.
    fn accelerations(&self, sliding: T, turning: T) -> (Vector<T>, Vector<T>) {
        let (p, s) = (&self.body.plane, self.state);
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
        let weight = self.net_mass_kg * p.gravity_m_s2 - self.support_N;
        let displaced = mass - self.net_mass_kg;
        let moments = self.first_moment(&mover);
        let pull: Vector<T> = std::array::from_fn(|i| p.gravity_m_s2 * down[i] - along_the_way[i]);
        let (h, turned, turned_angular) =
            (&self.hydrodynamics, cross(momentum, self.rates), cross(angular, self.rates));
        let (munk, tilt) = (cross(momentum, self.v), cross(moments, pull));
        let force = std::array::from_fn(|i| {
            turned[i] + weight * down[i] + h.force_N[i] + (displaced * of_the_water[i] - mass * along_the_way[i])
                - rate[i]
        });
        let moment = std::array::from_fn(|i| turned_angular[i] + munk[i] + tilt[i] + h.moment_N_m[i] - angular_rate[i]);
        inertia.solve(force, moment)
    }

    /// Inertia of everything but the moving mass.
    fn hull_inertia(&self) -> Inertia<T> {
        let (p, l) = (&self.body.plane, &self.body.lateral);
        let mut inertia = Inertia::zero();
        let hull = p.hull_mass_kg - p.offset_mass_kg;
        for (axis, added) in [p.added_mass_1_kg, l.added_mass_2_kg, p.added_mass_3_kg].into_iter().enumerate() {
            inertia.add(axis, axis, hull + added);
        }
        inertia.add(3, 3, l.roll_inertia_kg_m2);
        // The plane's inertia in pitch contains that of the moving mass about its own centre.
        inertia.add(4, 4, p.pitch_inertia_kg_m2 - l.moving_inertia_2_kg_m2);
        inertia.add(5, 5, l.yaw_inertia_kg_m2);
        inertia.add(1, 5, l.added_Y_rdot_kg_m);
        inertia.add(2, 4, p.added_Z_qdot_kg_m);
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
        inertia.add(0, 5, -moment);
        inertia.add(2, 3, moment);
        inertia.add(3, 3, moment * aside);
        inertia.add(5, 5, moment * aside);
        inertia.add(3, 4, -aside * p.offset_mass_kg * p.offset_mass_forward_m);
        inertia.add(4, 5, -aside * p.offset_mass_kg * p.offset_mass_below_m);
    }

    /// The moving mass. The roll mass is the part of it that turns about the hull's axis: at angle zero their common centre
    /// lies where the vertical plane has it. To starboard is a negative turn about axis 1.
    fn mover(&self, sliding: T, turning: T) -> (Mover<T>, Vector<T>) {
        let (p, l, s) = (&self.body.plane, &self.body.lateral, self.state);
        let radius = l.roll_mass_kg * l.roll_mass_radius_m / p.moving_mass_kg;
        let (sin, cos) = (s.roll_mass_rad + l.roll_mass_offset_rad).sin_cos();
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

    /// How the water's velocity changes along the glider's way, north, east, down.
    fn water_along_the_way(&self) -> Vector<T> {
        self.water_changes(self.depth_rate_m_s)
    }

    /// How the velocity of the water itself changes.
    fn water_itself(&self) -> Vector<T> {
        self.water_changes(self.inputs.current_down_m_s + self.body.plane.vertical_current_m_s)
    }

    fn water_changes(&self, downwards_m_s: T) -> Vector<T> {
        let i = self.inputs;
        [
            i.current_north_rate_m_s2 + i.current_north_shear_1_s * downwards_m_s,
            i.current_east_rate_m_s2 + i.current_east_shear_1_s * downwards_m_s,
            i.current_down_rate_m_s2,
        ]
    }

    /// Rates of change of roll, pitch and heading.
    fn euler_rates(&self) -> Vector<T> {
        let ((sr, cr), (sp, cp)) = (self.state.roll_rad.sin_cos(), self.state.pitch_rad.sin_cos());
        let [p, q, r] = self.rates;
        let heading = (q * sr + r * cr) / cp;
        [p + heading * sp, q * cr - r * sr, heading]
    }

    /// Power drawn: what runs all the time, the pump against the pressure, rudder and roll mass by their speed.
    fn power_W(&self, pumping_m3_s: T, rudder_rate: T) -> T {
        let (p, l) = (&self.body.plane, &self.body.lateral);
        p.hotel_W
            + (p.pump_J_per_m3 + p.pump_J_per_Pa_m3 * self.pressure_Pa) * pumping_m3_s.at_least(0.0)
            + l.rudder_power_W * (rudder_rate / l.rudder_rate_rad_s).abs()
            + l.roll_mass_power_W * (self.state.roll_mass_rate_rad_s / l.roll_mass_rate_rad_s).abs()
    }
}
