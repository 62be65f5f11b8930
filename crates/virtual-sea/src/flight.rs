//! One flight: water, hidden effects, pilot and motion, step by step, with the whole truth of every step.

use crate::effects::{Flow, Hidden, Memory};
pub use crate::hidden::Instant;
use crate::lateral::{Lateral, LateralFigures};
use crate::motion::{Imposed, Inertia, Load, Motion, State};
use crate::ocean::{Ocean, Wander, WavesByStep};
use crate::pilot::{Leg, Orders, Pilot, Readings};
use crate::random::{Part, between, stream};
use crate::vehicle::{ATTACHED_RAD, Vehicle, attached_angle};
use std::f64::consts::TAU;

/// Step of the integration and of the control, s.
pub const STEP_S: f64 = 0.25;

/// Half the height over which the hull comes out of the water, m.
const HULL_RADIUS_M: f64 = 0.11;
/// Range of angles over which the axial part of the lift is lost once the flow separates, rad.
const FADING_RAD: f64 = 0.3;
/// Yaw rate per speed and rudder angle, 1/m; a bank turns by two thirds of it.
const TURN_PER_M: f64 = 0.12;

/// All that a flight follows from.
#[derive(Debug, Clone, Copy)]
pub struct Voyage<'a> {
    /// The vehicle as it is, effects apart.
    pub vehicle: &'a Vehicle,
    /// The vehicle as its owner's file has it.
    pub believed: &'a Vehicle,
    /// The water.
    pub ocean: &'a Ocean,
    /// The effects.
    pub hidden: &'a Hidden,
    /// The legs to fly.
    pub legs: &'a [Leg],
    /// Duration, s.
    pub duration_s: f64,
    /// Seed of the unsteady water met on the way.
    pub seed: u64,
    /// Lateral figures, where roll and yaw follow from equations of motion; otherwise they follow the orders.
    pub lateral: Option<LateralFigures>,
}

/// Flies a voyage and shows every step to `observe`.
pub fn fly(voyage: &Voyage, mut observe: impl FnMut(&Instant)) {
    let mut glider = SimulatedGlider::afloat(voyage);
    let steps = (voyage.duration_s / STEP_S).round() as u64;
    for step in 0..=steps {
        let now = glider.look(step as f64 * STEP_S);
        observe(&now);
        glider.advance(&now);
    }
}

struct SimulatedGlider<'a> {
    voyage: &'a Voyage<'a>,
    pilot: Pilot<'a>,
    random: crate::random::Stream,
    state: State,
    imposed: Imposed,
    motion: Motion,
    heave_m: f64,
    waves: WavesByStep<'a>,
    turbulence: [Wander; 2],
    roll_wander: Wander,
    rudder_wander: Wander,
    list_rad: f64,
    engine_cc: f64,
    memory: Memory,
    moving_mass_m: f64,
    moved: f64,
    roll_rad: f64,
    rudder_rad: f64,
    heading_rad: f64,
    dive: u32,
    lateral: Option<Lateral>,
}

impl<'a> SimulatedGlider<'a> {
    fn afloat(voyage: &'a Voyage<'a>) -> Self {
        let mut random = stream(voyage.seed, Part::Path);
        let Ocean { turbulence_m_s, turbulence_time_s, .. } = *voyage.ocean;
        let turbulence = [(); 2].map(|()| Wander::new(&mut random, turbulence_m_s, turbulence_time_s, STEP_S));
        let imposed = Imposed::default();
        let inertia = Inertia::new(voyage.vehicle, voyage.vehicle.mass_kg);
        let state = inertia.state((0.0, HULL_RADIUS_M, 0.0), (0.0, 0.0, 0.0), &imposed);
        let lateral =
            voyage.lateral.map(|figures| Lateral::afloat(figures, stream(voyage.seed, Part::Lateral), STEP_S));
        Self {
            voyage,
            lateral,
            pilot: Pilot::new(voyage.believed, voyage.ocean, voyage.legs),
            state,
            imposed,
            motion: inertia.motion(&state, &imposed, 0.0),
            heave_m: 0.0,
            waves: voyage.ocean.waves_by_step(STEP_S),
            turbulence,
            roll_wander: Wander::new(&mut random, 0.012, 120.0, STEP_S),
            rudder_wander: Wander::new(&mut random, 0.03, 60.0, STEP_S),
            list_rad: between(&mut random, -0.04, 0.04),
            engine_cc: voyage.vehicle.ballast_max_cc,
            memory: Memory::afloat(&voyage.ocean.water(0.0, 0.0)),
            moving_mass_m: 0.0,
            moved: 1.0,
            roll_rad: 0.0,
            rudder_rad: 0.0,
            heading_rad: voyage.legs.first().map_or(0.0, |leg| leg.heading_rad),
            dive: 1,
            random,
        }
    }

    fn look(&mut self, time_s: f64) -> Instant {
        let Voyage { vehicle, ocean, hidden, .. } = *self.voyage;
        let pressure_pa = ocean.pressure_pa(self.state.depth_m);
        let mass_kg = hidden.mass_kg(vehicle.mass_kg, time_s, &self.memory, pressure_pa);
        self.imposed.moving_mass_m = hidden.moving_mass_m(self.moving_mass_m, self.moved);
        self.motion = Inertia::new(vehicle, mass_kg).motion(&self.state, &self.imposed, 0.0);
        let Motion { v1, v3, through_1, through_3, .. } = self.motion;
        let (sin, cos) = self.state.pitch_rad.sin_cos();
        let depth_m = self.state.depth_m;
        let water = ocean.water(depth_m, self.heave_m);
        let volume_m3 = hidden.volume_m3(vehicle, pressure_pa, water.temperature_c, self.engine_cc, &self.memory);
        Instant {
            time_s,
            dive: self.dive,
            depth_m,
            sinking_m_s: v3 * cos - v1 * sin,
            water_sinking_m_s: self.imposed.water_z_m_s,
            speed_m_s: through_1.hypot(through_3),
            angle_rad: through_3.atan2(through_1),
            pitch_rad: self.state.pitch_rad,
            roll_rad: self.roll_rad,
            heading_rad: self.heading_rad,
            rudder_rad: self.rudder_rad,
            rudder_reading_rad: self.lateral.as_ref().map_or(self.rudder_rad, |it| it.rudder_reading_rad()),
            roll_mass_rad: self.lateral.as_ref().map_or(f64::NAN, |it| it.roll_mass_rad()),
            engine_cc: self.engine_cc,
            moving_mass_m: self.moving_mass_m,
            pressure_pa,
            water,
            net_mass_kg: mass_kg - water.density_kg_m3 * volume_m3,
            outside_kg: hidden.outside_kg(&self.memory.outside, pressure_pa, water.density_kg_m3),
        }
    }

    fn advance(&mut self, now: &Instant) {
        let Voyage { vehicle, hidden, .. } = *self.voyage;
        let read = Readings {
            time_s: now.time_s,
            depth_m: hidden.pressure_reading_dbar(now.depth_m),
            pitch_rad: hidden.pitch_reading(now.pitch_rad, now.roll_rad, now.heading_rad),
            heading_rad: now.heading_rad,
        };
        let orders = self.pilot.orders(&read, STEP_S);
        self.dive = orders.dive;
        self.meet_water(now);
        self.steer(now, &orders);

        let pumped_cc = (orders.ballast_cc - self.engine_cc)
            .clamp(-vehicle.ballast_in_cc_s * STEP_S, vehicle.ballast_out_cc_s * STEP_S);
        let most_m = vehicle.moving_mass_rate_m_s * STEP_S;
        let slid_m = (orders.moving_mass_m - self.moving_mass_m).clamp(-most_m, most_m);
        if slid_m != 0.0 {
            self.moved = slid_m.signum();
        }
        self.imposed.moving_mass_m = hidden.moving_mass_m(self.moving_mass_m, self.moved);
        self.imposed.sliding_m_s = slid_m / STEP_S;

        let inertia = Inertia::new(vehicle, hidden.mass_kg(vehicle.mass_kg, now.time_s, &self.memory, now.pressure_pa));
        let forces = Forces {
            voyage: self.voyage,
            time_s: now.time_s,
            heave_m: self.heave_m,
            engine_cc: self.engine_cc + 0.5 * pumped_cc,
            roll_rad: self.roll_rad,
            rudder_rad: self.rudder_rad,
            memory: self.memory,
            lateral: self.lateral.as_ref(),
            forward_kg_m: vehicle.moving_mass_kg * self.imposed.moving_mass_m,
        };
        self.state = inertia.step(&self.state, &self.imposed, STEP_S, |state, motion| forces.load(state, motion));
        self.engine_cc += pumped_cc;
        self.memory.step(hidden, &now.water, now.pressure_pa, pumped_cc, STEP_S);
        self.moving_mass_m += slid_m;
        self.imposed.sliding_m_s = 0.0;
        self.imposed.water_x_m_s += (self.imposed.water_x_m_s2 + self.imposed.met_x_m_s2) * STEP_S;
        self.imposed.water_z_m_s += self.imposed.water_z_m_s2 * STEP_S;
    }

    /// The water's velocity at the end of the step, reached by a steady acceleration.
    fn meet_water(&mut self, now: &Instant) {
        let Voyage { ocean, hidden, .. } = *self.voyage;
        let (wave_m_s, heave_m) = ocean.heave(&self.waves.waves(), now.depth_m);
        self.waves.advance();
        self.heave_m = heave_m + hidden.internal_tide(now.depth_m, now.time_s).1;
        let [eddies_x, eddies_z] = &mut self.turbulence;
        let quiet = (now.depth_m / 2.0).tanh().max(0.0);
        let gust_x = -eddies_x.value() + eddies_x.next(&mut self.random);
        let sinking =
            wave_m_s + quiet * eddies_z.next(&mut self.random) + hidden.sinking_water_m_s(now.depth_m, now.time_s);
        let shear = ocean.shear_along(now.depth_m, now.time_s, now.heading_rad);
        // What the glider meets of a sheared current is other water, not water that accelerates.
        self.imposed.met_x_m_s2 = shear * (now.sinking_m_s - now.water_sinking_m_s);
        self.imposed.water_x_m_s2 = shear * now.water_sinking_m_s + gust_x / STEP_S;
        self.imposed.water_z_m_s2 = (sinking - self.imposed.water_z_m_s) / STEP_S;
    }

    fn steer(&mut self, now: &Instant, orders: &Orders) {
        if let Some(lateral) = &mut self.lateral {
            let Voyage { hidden, vehicle, .. } = *self.voyage;
            let wander_rad = self.rudder_wander.next(&mut self.random);
            (self.roll_rad, self.rudder_rad, self.heading_rad) =
                lateral.step(hidden, vehicle, now, orders, wander_rad, STEP_S);
            return;
        }
        let rudder_goal = orders.rudder_rad + self.rudder_wander.next(&mut self.random);
        let roll_goal = self.list_rad + orders.roll_rad + self.roll_wander.next(&mut self.random);
        self.rudder_rad += (rudder_goal - self.rudder_rad) * STEP_S / 3.0;
        self.roll_rad += (roll_goal - self.roll_rad) * STEP_S / 5.0;
        let bank = self.roll_rad - self.list_rad;
        let yaw_rate = TURN_PER_M * now.speed_m_s * (self.rudder_rad + bank * 2.0 / 3.0);
        self.heading_rad = (self.heading_rad + yaw_rate * STEP_S).rem_euclid(TAU);
    }
}

/// What the water's forces depend on beside the motion, over one step.
struct Forces<'a> {
    voyage: &'a Voyage<'a>,
    time_s: f64,
    heave_m: f64,
    engine_cc: f64,
    roll_rad: f64,
    rudder_rad: f64,
    memory: Memory,
    lateral: Option<&'a Lateral>,
    /// First moment of the sliding mass, kg m.
    forward_kg_m: f64,
}

impl Forces<'_> {
    fn load(&self, state: &State, motion: &Motion) -> Load {
        let Voyage { vehicle, ocean, hidden, .. } = *self.voyage;
        let water = ocean.water(state.depth_m, self.heave_m);
        let volume_m3 = hidden.volume_m3(
            vehicle,
            ocean.pressure_pa(state.depth_m),
            water.temperature_c,
            self.engine_cc,
            &self.memory,
        );
        let immersed = (0.5 + 0.5 * state.depth_m / HULL_RADIUS_M).clamp(0.0, 1.0);
        let Motion { through_1, through_3, pitch_rate, .. } = *motion;
        let flow = Flow {
            time_s: self.time_s,
            angle_rad: through_3.atan2(through_1),
            density_kg_m3: water.density_kg_m3,
            dynamic_pressure_pa: 0.5 * water.density_kg_m3 * (through_1 * through_1 + through_3 * through_3),
            rising: through_3 * state.pitch_rad.cos() - through_1 * state.pitch_rad.sin() < 0.0,
            roll_rad: self.roll_rad,
            rudder_rad: self.rudder_rad,
            depth_m: state.depth_m,
        };
        let force = water_force(vehicle, hidden, &flow, immersed);
        let leans_n_m = self.lateral.map_or(0.0, |it| it.pitching_n_m(hidden, self.forward_kg_m, state.pitch_rad));
        Load {
            displaced_kg: water.density_kg_m3 * volume_m3 * immersed,
            moment_n_m: force.moment_n_m - vehicle.pitch_damping_n_m_s * pitch_rate + leans_n_m,
            ..force
        }
    }
}

/// Lift, drag and moment in body axes. A banked glider's lift leans out of the vertical plane with the cosine of its
/// roll. Munk's couple is taken out of the moment, as the tank's CM contains it.
fn water_force(vehicle: &Vehicle, hidden: &Hidden, flow: &Flow, immersed: f64) -> Load {
    let pressed_n = immersed * flow.dynamic_pressure_pa * vehicle.frontal_area_m2;
    let (axial, normal) = axial_and_normal(vehicle, hidden, flow);
    let speed2 = 2.0 * flow.dynamic_pressure_pa / flow.density_kg_m3;
    let munk = (vehicle.added_mass_3_kg - vehicle.added_mass_1_kg) * speed2;
    let moment = pressed_n * vehicle.length_m * vehicle.d_per_rad - munk;
    Load {
        displaced_kg: 0.0,
        force_1_n: -pressed_n * axial,
        force_3_n: -pressed_n * normal,
        moment_n_m: moment * attached_angle(flow.angle_rad),
    }
}

/// Force coefficients along and across the hull. While the flow is attached they are lift and drag turned into body
/// axes; beyond, as where a glider turns, the force across grows with the sine of the angle and what lift adds along the
/// hull is lost within another [`FADING_RAD`].
fn axial_and_normal(vehicle: &Vehicle, hidden: &Hidden, flow: &Flow) -> (f64, f64) {
    let at = |angle_rad: f64| {
        let lift = hidden.lift_coefficient(vehicle, &Flow { angle_rad, ..*flow }) * flow.roll_rad.cos();
        let drag = hidden.drag_coefficient(vehicle, &Flow { angle_rad, ..*flow });
        let (sin, cos) = angle_rad.sin_cos();
        (drag * cos - lift * sin, lift * cos + drag * sin)
    };
    let size = flow.angle_rad.abs();
    if size <= ATTACHED_RAD {
        return at(flow.angle_rad);
    }
    let (axial, normal) = at(ATTACHED_RAD.copysign(flow.angle_rad));
    let (friction, _) = at(0.0);
    let cos = flow.angle_rad.cos();
    let from_lift = axial - friction * ATTACHED_RAD.cos().powi(2);
    let left = (1.0 - (size - ATTACHED_RAD) / FADING_RAD).max(0.0);
    (friction * cos * cos.abs() + from_lift * left, normal * flow.angle_rad.sin().abs() / ATTACHED_RAD.sin())
}
