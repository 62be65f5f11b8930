//! Roll, sideslip and yaw of a glider that is flown in the vertical plane by [`crate::motion`], and the hidden effects that
//! turn it.
//!
//! Side velocity `v`, roll rate `p`, yaw rate `r` and roll `phi` follow from momentum balances in body axes (x forward, y
//! starboard, z down). Speed, angle of attack, pitch, net mass and the place of the sliding mass are those of the vertical plane:
//!
//! ```text
//! (m + m2) dv/dt = m0 g sin phi cos theta + Y - (m + m1) u r + (m + m3) w p
//! Ix dp/dt       = g cos theta (Sy cos phi - Sz sin phi) + q A l Cl_p p l/V
//! Iz dr/dt       = g (Sx sin phi cos theta + Sy sin theta) + q A l (CN_beta beta + CN_r r l/V + CN_delta delta) + q B
//! dphi/dt        = p + r tan theta / cos phi
//! dpsi/dt        = r / (cos phi cos theta)
//! Y              = q A (CY_beta beta + CY_r r l/V + CY_delta delta)
//! Sy             = M R sin gamma + Sz0 tan(list),    Sz = Sz0 + M R (cos gamma - 1)
//! ```
//!
//! `S` is the first moment of all masses about the centre of buoyancy, `B` drag area times arm of a pod on one side. Roll and roll
//! mass pitch the glider too: [`Lateral::pitching_n_m`] is what the moment of gravity about the starboard axis,
//!
//! ```text
//! -g (Sx cos phi cos theta + Sz sin theta)
//! ```
//!
//! differs by from that of the vertical plane. CN_beta contains Munk's couple. The list
//! is that of a roll mass at rest; the roll mass reads `gamma` less its offset, the rudder `delta` less its own. Gusts from
//! the side and eddies about the vertical axis disturb the heading by some tenths of a degree a
//! second, as readings of real gliders between two moves of their controls do.

use crate::hidden::{Hidden, Instant};
use crate::ocean::{GRAVITY_M_S2, Wander};
use crate::pilot::Orders;
use crate::random::{Stream, between};
use crate::vehicle::{Hull, Vehicle};
use std::f64::consts::{PI, TAU};

/// Steps of this motion in one of the vertical plane: at 0.5 m/s a wing damps the roll within a twentieth of a second.
const SUBSTEPS: u32 = 10;
/// Speed below which coefficients and their rates are those at this speed, m/s.
const SLOWEST_M_S: f64 = 0.08;
/// Friction of a glider that floats or hardly moves, N m s.
const AFLOAT_N_M_S: f64 = 2.0;
/// Rudder angle and roll-mass angle of the heading control, rad: proportional for a rudder, all or nothing for a roll mass.
const RUDDER_LIMIT_RAD: f64 = 0.30;
const ROLL_MASS_STEP_RAD: f64 = 15.0 * PI / 180.0;
/// A roll mass moves where the heading is off by the first, and returns where it is off by less than the second, rad.
const DEAD_BAND_RAD: [f64; 2] = [0.25, 0.12];
/// Distance of a pod's centre from the hull's axis, m.
const POD_ARM_M: f64 = 0.15;

/// Lateral figures of a glider, drawn; coefficients on frontal area and hull length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LateralFigures {
    /// Side force per sideslip, 1/rad.
    pub side_per_rad: f64,
    /// Side force per yaw rate times length over speed.
    pub side_per_rate: f64,
    /// Yawing moment per sideslip, Munk's couple included, 1/rad.
    pub yaw_per_rad: f64,
    /// Yawing moment per yaw rate times length over speed.
    pub yaw_per_rate: f64,
    /// Rolling moment per roll rate times length over speed.
    pub roll_per_rate: f64,
    /// Side force per rudder angle, 1/rad; 0 without a rudder.
    pub side_per_rudder: f64,
    /// Yawing moment per rudder angle, 1/rad; 0 without a rudder.
    pub yaw_per_rudder: f64,
    /// Added mass along axis 2, kg.
    pub added_2_kg: f64,
    /// Moments of inertia about axes 1 and 3, kg m2.
    pub inertia_kg_m2: [f64; 2],
    /// First moment of the mass that rolls, kg m; 0 without one.
    pub rolling_kg_m: f64,
    /// List that the glider has from its yard, rad.
    pub own_list_rad: f64,
    /// Error of its rudder's zero, rad.
    pub own_rudder_rad: f64,
    /// Roll that its attitude sensor reads where there is none, rad.
    pub roll_zero_rad: f64,
    /// Pitch that it reads per roll: it is mounted askew about the vertical axis by so many radians.
    pub pitch_per_roll: f64,
}

impl LateralFigures {
    /// Draws the figures of a hull: those of a Seaglider or a Slocum within a tenth, hardly any list, offsets of a straight
    /// glider.
    pub fn draw(random: &mut Stream, hull: Hull) -> Self {
        let degree = PI / 180.0;
        let mut about = |value: f64| value * between(random, 0.9, 1.1);
        let rolls = hull == Hull::Seaglider;
        let [side, side_rate, yaw, yaw_rate, roll_rate] =
            if rolls { [-1.23, 0.30, -0.08, -0.40, -0.24] } else { [-2.6, 0.91, -0.38, -0.54, -0.18] };
        let [side_rudder, yaw_rudder] = if rolls { [0.0, 0.0] } else { [-0.47, 0.205] };
        let [added, roll_inertia, yaw_inertia, rolling] =
            if rolls { [48.0, 0.6, 15.0, 0.27] } else { [60.0, 4.0, 11.0, 0.0] };
        Self {
            side_per_rad: about(side),
            side_per_rate: about(side_rate),
            yaw_per_rad: about(yaw),
            yaw_per_rate: about(yaw_rate),
            roll_per_rate: about(roll_rate),
            side_per_rudder: about(side_rudder),
            yaw_per_rudder: about(yaw_rudder),
            added_2_kg: about(added),
            inertia_kg_m2: [about(roll_inertia), about(yaw_inertia)],
            rolling_kg_m: about(rolling),
            own_list_rad: degree * between(random, -0.5, 0.5),
            own_rudder_rad: if rolls { 0.0 } else { degree * between(random, -0.3, 0.3) },
            roll_zero_rad: degree * between(random, -0.5, 0.5),
            pitch_per_roll: degree * between(random, -2.0, 2.0),
        }
    }

    /// Curvature of the way seen from above, turn rate over speed, of a steady turn by a pod and a rudder that stand so while a
    /// list keeps the roll at zero, rad/m: the balances of this module, linear in the sideslip, which is small.
    ///
    /// The roll rate of a turn at a pitch, `-r tan theta`, is damped by the wing; what balances this damping yaws the glider by
    /// the sine of its pitch. So the damping of the roll resists the turn, with the squared tangent of the pitch.
    pub fn curvature_without_roll(
        &self,
        vehicle: &Vehicle,
        pod_m3: f64,
        rudder_rad: f64,
        pitch_rad: f64,
        speed_m_s: f64,
    ) -> Option<f64> {
        let density_kg_m3 = crate::vehicle::REFERENCE_DENSITY_KG_M3;
        let (length, area) = (vehicle.length_m, vehicle.frontal_area_m2);
        let draggier = Vehicle { b: vehicle.b + pod_drag_m2(pod_m3) / area, ..*vehicle };
        let (angle_rad, _) = draggier.steady_glide(-pitch_rad.signum(), pitch_rad, density_kg_m3)?;
        let pressed_n = 0.5 * density_kg_m3 * speed_m_s * speed_m_s * area;
        let per_rate = length / speed_m_s;
        let tan = pitch_rad.tan();
        let inertia = (vehicle.mass_kg + vehicle.added_mass_1_kg) * speed_m_s * angle_rad.cos()
            + (vehicle.mass_kg + vehicle.added_mass_3_kg) * speed_m_s * angle_rad.sin() * tan;
        // Sideslip per yaw rate, and without one.
        let slips = (inertia / pressed_n - self.side_per_rate * per_rate) / self.side_per_rad;
        let slip = -self.side_per_rudder * rudder_rad / self.side_per_rad;
        let damped = self.roll_per_rate * per_rate - AFLOAT_N_M_S * 0.3 / (pressed_n * length);
        let resists = -(self.yaw_per_rad * slips + self.yaw_per_rate * per_rate + damped * tan * tan);
        let turns = self.yaw_per_rad * slip + self.yaw_per_rudder * rudder_rad + pod_m3 / (area * length);
        Some(turns / resists / pitch_rad.cos() / speed_m_s)
    }

    /// Whether the glider has a roll mass.
    pub fn rolls(&self) -> bool {
        self.rolling_kg_m != 0.0
    }
}

/// What moves beside the vertical plane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct State {
    side_m_s: f64,
    roll_rate: f64,
    yaw_rate: f64,
    roll_rad: f64,
    turned_rad: f64,
}

/// The lateral motion of one flight.
#[derive(Debug)]
pub struct Lateral {
    figures: LateralFigures,
    state: State,
    rudder_rad: f64,
    roll_mass_rad: f64,
    turns_to: f64,
    gust: Wander,
    eddy: Wander,
    random: Stream,
}

/// What is given over one step.
struct Given<'a> {
    vehicle: &'a Vehicle,
    figures: &'a LateralFigures,
    speed_m_s: f64,
    angle_rad: f64,
    pitch_rad: f64,
    density_kg_m3: f64,
    net_mass_kg: f64,
    forward_kg_m: f64,
    starboard_kg_m: f64,
    below_kg_m: f64,
    rudder_rad: f64,
    pod_m3: f64,
    gust_m_s: f64,
    eddy: f64,
}

impl Lateral {
    /// Level, at rest, controls in the middle.
    pub fn afloat(figures: LateralFigures, mut random: Stream, step_s: f64) -> Self {
        Self {
            figures,
            state: State::default(),
            rudder_rad: 0.0,
            roll_mass_rad: 0.0,
            turns_to: 0.0,
            gust: Wander::new(&mut random, 0.004, 40.0, step_s),
            eddy: Wander::new(&mut random, 0.0015, 60.0, step_s),
            random,
        }
    }

    /// Reading of the roll mass, rad; missing without one.
    pub fn roll_mass_rad(&self) -> f64 {
        if self.figures.rolls() { self.roll_mass_rad } else { f64::NAN }
    }

    /// Reading of the rudder, rad; missing without one.
    pub fn rudder_reading_rad(&self) -> f64 {
        if self.figures.rolls() { f64::NAN } else { self.rudder_rad }
    }

    /// Moment of gravity, nose up, beyond that of the vertical plane, N m: a leaning glider has its sliding mass on a shorter
    /// lever, and a roll mass that is turned lies less far below. `forward_kg_m` is the first moment of the sliding mass.
    pub fn pitching_n_m(&self, hidden: &Hidden, forward_kg_m: f64, pitch_rad: f64) -> f64 {
        let (sin_pitch, cos_pitch) = pitch_rad.sin_cos();
        let risen_kg_m = self.figures.rolling_kg_m * (1.0 - (self.roll_mass_rad + hidden.roll_mass_offset_rad).cos());
        GRAVITY_M_S2 * (forward_kg_m * (1.0 - self.state.roll_rad.cos()) * cos_pitch + risen_kg_m * sin_pitch)
    }

    /// A step of `step_s`: control of the heading by `orders`, then motion. Returns roll, true rudder angle and heading.
    pub fn step(
        &mut self,
        hidden: &Hidden,
        vehicle: &Vehicle,
        now: &Instant,
        orders: &Orders,
        rudder_wander_rad: f64,
        step_s: f64,
    ) -> (f64, f64, f64) {
        self.control(orders, now.pitch_rad, rudder_wander_rad, step_s);
        let figures = &self.figures;
        let rolling = figures.rolling_kg_m;
        let below = vehicle.moving_mass_kg * vehicle.moving_mass_height_m;
        let true_roll_mass = self.roll_mass_rad + hidden.roll_mass_offset_rad;
        let rudder_rad = self.rudder_rad + figures.own_rudder_rad + hidden.rudder_offset_rad;
        let list_rad = figures.own_list_rad + hidden.static_list_rad;
        let given = Given {
            vehicle,
            figures,
            speed_m_s: now.speed_m_s,
            angle_rad: if now.speed_m_s > SLOWEST_M_S { now.angle_rad.clamp(-0.3, 0.3) } else { 0.0 },
            pitch_rad: now.pitch_rad.clamp(-1.2, 1.2),
            density_kg_m3: now.water.density_kg_m3,
            net_mass_kg: now.net_mass_kg,
            forward_kg_m: vehicle.moving_mass_kg * now.moving_mass_m,
            starboard_kg_m: rolling * true_roll_mass.sin() + below * list_rad.tan(),
            below_kg_m: below + rolling * (true_roll_mass.cos() - 1.0),
            rudder_rad,
            pod_m3: hidden.pod_m3,
            gust_m_s: self.gust.next(&mut self.random),
            eddy: self.eddy.next(&mut self.random),
        };
        let sub_s = step_s / f64::from(SUBSTEPS);
        let mut state = State { turned_rad: 0.0, ..self.state };
        for _ in 0..SUBSTEPS {
            state = given.advance(&state, sub_s);
        }
        if now.depth_m < 1.0 {
            // Afloat the antenna's float and the waves hold it; nothing of the flight is carried over.
            state = State { side_m_s: 0.0, roll_rate: 0.0, yaw_rate: 0.0, ..state };
        }
        self.state = state;
        (state.roll_rad, rudder_rad, (now.heading_rad + state.turned_rad).rem_euclid(TAU))
    }

    /// Rudder or roll mass as the pilot orders them, or towards the course.
    fn control(&mut self, orders: &Orders, pitch_rad: f64, rudder_wander_rad: f64, step_s: f64) {
        if self.figures.rolls() {
            // Against its roll on descents, with it on ascents.
            let sense = if pitch_rad < 0.0 { -1.0 } else { 1.0 };
            if orders.off_course_rad.abs() > DEAD_BAND_RAD[0] {
                self.turns_to = orders.off_course_rad.signum();
            } else if orders.off_course_rad.abs() < DEAD_BAND_RAD[1] || orders.off_course_rad * self.turns_to < 0.0 {
                self.turns_to = 0.0;
            }
            let goal = match orders.turn {
                Some([rudder_rad, roll_rad]) => 1.4 * (roll_rad + rudder_rad),
                None => sense * self.turns_to * ROLL_MASS_STEP_RAD,
            };
            self.roll_mass_rad += (goal - self.roll_mass_rad).clamp(-0.35 * step_s, 0.35 * step_s);
        } else {
            let goal = match orders.turn {
                Some([rudder_rad, roll_rad]) => 0.5 * (rudder_rad + roll_rad),
                None => (0.4 * orders.off_course_rad).clamp(-RUDDER_LIMIT_RAD, RUDDER_LIMIT_RAD),
            };
            self.rudder_rad += (goal + rudder_wander_rad - self.rudder_rad) * step_s / 3.0;
        }
    }
}

/// Drag area of a pod with this drag area times arm, m2.
pub(crate) fn pod_drag_m2(pod_m3: f64) -> f64 {
    pod_m3.abs() / POD_ARM_M
}

impl Given<'_> {
    fn rate(&self, state: &State) -> [f64; 5] {
        let Self { vehicle, figures, .. } = *self;
        let speed = self.speed_m_s.max(SLOWEST_M_S);
        let (length, area) = (vehicle.length_m, vehicle.frontal_area_m2);
        let pressed_n = 0.5 * self.density_kg_m3 * self.speed_m_s * self.speed_m_s * area;
        let slip = ((state.side_m_s + self.gust_m_s) / speed).clamp(-0.5, 0.5).asin();
        let (roll_star, yaw_star) = (state.roll_rate * length / speed, state.yaw_rate * length / speed);
        let (sin_pitch, cos_pitch) = self.pitch_rad.sin_cos();
        let (sin_roll, cos_roll) = state.roll_rad.sin_cos();
        let (along, down) = (self.speed_m_s * self.angle_rad.cos(), self.speed_m_s * self.angle_rad.sin());
        let side_n = pressed_n
            * (figures.side_per_rad * slip
                + figures.side_per_rate * yaw_star
                + figures.side_per_rudder * self.rudder_rad);
        let roll_n_m = GRAVITY_M_S2 * cos_pitch * (self.starboard_kg_m * cos_roll - self.below_kg_m * sin_roll)
            + pressed_n * length * figures.roll_per_rate * roll_star
            - AFLOAT_N_M_S * 0.3 * state.roll_rate;
        let yaw_n_m = GRAVITY_M_S2 * (self.forward_kg_m * sin_roll * cos_pitch + self.starboard_kg_m * sin_pitch)
            + pressed_n
                * length
                * (figures.yaw_per_rad * slip
                    + figures.yaw_per_rate * yaw_star
                    + figures.yaw_per_rudder * self.rudder_rad
                    + self.eddy)
            + pressed_n / area * self.pod_m3
            - if self.speed_m_s < SLOWEST_M_S { AFLOAT_N_M_S * state.yaw_rate } else { 0.0 };
        let mass = vehicle.mass_kg;
        let sway_n = self.net_mass_kg * GRAVITY_M_S2 * sin_roll * cos_pitch + side_n
            - (mass + vehicle.added_mass_1_kg) * along * state.yaw_rate
            + (mass + vehicle.added_mass_3_kg) * down * state.roll_rate;
        [
            sway_n / (mass + figures.added_2_kg),
            roll_n_m / figures.inertia_kg_m2[0],
            yaw_n_m / figures.inertia_kg_m2[1],
            state.roll_rate + state.yaw_rate * sin_pitch / (cos_pitch * cos_roll),
            state.yaw_rate / (cos_roll * cos_pitch),
        ]
    }

    /// One step of the Runge-Kutta method of fourth order.
    fn advance(&self, state: &State, step_s: f64) -> State {
        let first = self.rate(state);
        let second = self.rate(&state.along(&first, 0.5 * step_s));
        let third = self.rate(&state.along(&second, 0.5 * step_s));
        let fourth = self.rate(&state.along(&third, step_s));
        let mean = std::array::from_fn(|i| (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]) / 6.0);
        let next = state.along(&mean, step_s);
        State { roll_rad: next.roll_rad.clamp(-1.2, 1.2), ..next }
    }
}

impl State {
    fn along(&self, rate: &[f64; 5], step_s: f64) -> State {
        State {
            side_m_s: self.side_m_s + rate[0] * step_s,
            roll_rate: self.roll_rate + rate[1] * step_s,
            yaw_rate: self.yaw_rate + rate[2] * step_s,
            roll_rad: self.roll_rad + rate[3] * step_s,
            turned_rad: self.turned_rad + rate[4] * step_s,
        }
    }
}

#[cfg(test)]
mod tests;
