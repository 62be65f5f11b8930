//! The pilot: what each leg is to be, and the control that flies it from what the instruments read.
//!
//! Legs vary in pitch (steep, medium, shallow), ballast and course, and carry turns by rudder and by bank at separate
//! times, as a pilot flies who means to learn something about the glider.

use crate::ocean::Ocean;
use crate::random::{Stream, between, chance, sign};
use crate::vehicle::Vehicle;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Longest time between surfacing and the next dive, s; the least is half of it.
const SURFACE_S: f64 = 720.0;
/// Depth rate below which the pilot gives a leg all the ballast there is, m/s.
const TOO_SLOW_M_S: f64 = 0.05;
const PITCH_CHECK_S: f64 = 30.0;
const PITCH_DEADBAND_RAD: f64 = 0.021;
const RUDDER_LIMIT_RAD: f64 = 0.30;

/// One descent or ascent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Number of the dive, from 1.
    pub dive: u32,
    /// Whether it is the ascent.
    pub rising: bool,
    /// Ballast volume, cc.
    pub ballast_cc: f64,
    /// Pitch to hold, rad.
    pub pitch_rad: f64,
    /// Depth at which the leg ends, m.
    pub ends_m: f64,
    /// Time spent at the surface after it, s.
    pub surface_s: f64,
    /// Course, rad.
    pub heading_rad: f64,
    turn: Option<Turn>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Turn {
    starts_s: f64,
    lasts_s: f64,
    rudder_rad: f64,
    roll_rad: f64,
}

/// Draws the legs of a log: about `dives` of them in `hours`.
pub fn plan(vehicle: &Vehicle, ocean: &Ocean, random: &mut Stream, hours: f64, dives: u32) -> Vec<Leg> {
    let dive_s = hours * 3600.0 / f64::from(dives);
    let neutral_cc = vehicle.neutral_ballast_cc(ocean);
    let most_cc = vehicle.ballast_max_cc - neutral_cc.abs();
    let mut heading_rad = between(random, 0.0, TAU);
    let mut legs = Vec::new();
    for dive in 1..=4 * dives {
        if dive % 2 == 1 {
            heading_rad = (heading_rad + sign(random) * FRAC_PI_2 * between(random, 0.7, 1.3)).rem_euclid(TAU);
        }
        let (down, up) = (draw_glide(most_cc, random), draw_glide(most_cc, random));
        let surfaces = dive % 3 == 0 || chance(random, 0.3);
        let surface_s = if surfaces { between(random, 0.5, 1.0) * SURFACE_S } else { 0.0 };
        let top_m = if surfaces { 0.4 } else { between(random, 6.0, 12.0) };
        let stretch = between(random, 0.85, 1.15);
        let bottom_m = ((dive_s - surface_s) * stretch * reach(vehicle, ocean, down, up)).min(vehicle.depth_limit_m);
        let mut leg = |rising: bool, (ballast_cc, pitch_rad): (f64, f64)| Leg {
            dive,
            rising,
            ballast_cc: if rising { neutral_cc + ballast_cc } else { neutral_cc - ballast_cc },
            pitch_rad: if rising { pitch_rad } else { -pitch_rad },
            ends_m: if rising { top_m } else { bottom_m },
            surface_s: if rising { surface_s } else { 0.0 },
            heading_rad,
            turn: draw_turn(random, 0.5 * dive_s),
        };
        legs.extend([leg(false, down), leg(true, up)]);
    }
    legs
}

/// Ballast beyond neutral (cc) and pitch (rad) of a glide, without signs.
fn draw_glide(most_cc: f64, random: &mut Stream) -> (f64, f64) {
    let (low, high) = match (3.0 * between(random, 0.0, 1.0)) as u32 {
        0 => (36.0, 44.0),
        1 => (22.0, 29.0),
        _ => (12.0, 15.0),
    };
    (most_cc * between(random, 0.6, 1.0), between(random, low, high) * PI / 180.0)
}

/// Depth reached per second of dive.
fn reach(vehicle: &Vehicle, ocean: &Ocean, down: (f64, f64), up: (f64, f64)) -> f64 {
    let density = ocean.water(0.25 * vehicle.depth_limit_m, 0.0).density_kg_m3;
    let rate = |(ballast_cc, pitch_rad): (f64, f64)| {
        let net_kg = density * ballast_cc * 1e-6;
        let (angle, speed) = vehicle.steady_glide(net_kg, -pitch_rad, density).unwrap_or((0.05, 0.2));
        speed * (pitch_rad + angle.abs()).sin()
    };
    1.0 / (1.0 / rate(down) + 1.0 / rate(up))
}

/// Three legs in four carry a turn of some minutes, by rudder or by bank.
fn draw_turn(random: &mut Stream, leg_s: f64) -> Option<Turn> {
    let turns = chance(random, 0.75);
    let starts_s = leg_s * between(random, 0.15, 0.55);
    let lasts_s = between(random, 200.0, 480.0).min(0.5 * leg_s);
    let side = sign(random);
    let by_rudder = chance(random, 0.5);
    let rudder_rad = if by_rudder { side * between(random, 0.30, 0.50) } else { 0.0 };
    let roll_rad = if by_rudder { -0.12 * rudder_rad } else { side * between(random, 0.28, 0.48) };
    turns.then_some(Turn { starts_s, lasts_s, rudder_rad, roll_rad })
}

/// What the pilot reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Readings {
    /// Time since the start, s.
    pub time_s: f64,
    /// Depth as read, m.
    pub depth_m: f64,
    /// Pitch as read, rad.
    pub pitch_rad: f64,
    /// Heading, rad.
    pub heading_rad: f64,
}

/// What the pilot commands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orders {
    /// Count of the buoyancy engine, cc.
    pub ballast_cc: f64,
    /// Reading of the moving mass, m.
    pub moving_mass_m: f64,
    /// Rudder, rad.
    pub rudder_rad: f64,
    /// Bank, rad.
    pub roll_rad: f64,
    /// Course less heading, the shorter way, rad.
    pub off_course_rad: f64,
    /// Rudder and bank of a turn that the leg prescribes, rad; none while it is on course.
    pub turn: Option<[f64; 2]>,
    /// Number of the dive.
    pub dive: u32,
}

/// The control that flies the legs.
#[derive(Debug, Clone)]
pub struct Pilot<'a> {
    vehicle: &'a Vehicle,
    density_kg_m3: f64,
    neutral_cc: f64,
    legs: &'a [Leg],
    place: Place,
    since_s: f64,
    next_check_s: f64,
    moving_mass_m: f64,
    last_depth_m: f64,
    depth_rate_m_s: f64,
    full_ballast: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// Floating until a time, then leg `next`.
    Surface {
        until_s: f64,
        next: usize,
    },
    On(usize),
}

impl<'a> Pilot<'a> {
    /// A pilot who believes the vehicle file and waits two minutes before the first dive.
    pub fn new(believed: &'a Vehicle, ocean: &Ocean, legs: &'a [Leg]) -> Self {
        Self {
            vehicle: believed,
            density_kg_m3: ocean.water(100.0, 0.0).density_kg_m3,
            neutral_cc: believed.neutral_ballast_cc(ocean),
            legs,
            place: Place::Surface { until_s: 120.0, next: 0 },
            since_s: 0.0,
            next_check_s: 0.0,
            moving_mass_m: 0.0,
            last_depth_m: 0.0,
            depth_rate_m_s: 0.0,
            full_ballast: false,
        }
    }

    /// The orders of this moment, `step_s` after the last.
    pub fn orders(&mut self, read: &Readings, step_s: f64) -> Orders {
        self.depth_rate_m_s += ((read.depth_m - self.last_depth_m) / step_s - self.depth_rate_m_s) * step_s / 60.0;
        self.last_depth_m = read.depth_m;
        self.change_leg(read);
        match self.place {
            Place::Surface { next, .. } => Orders {
                ballast_cc: self.vehicle.ballast_max_cc,
                moving_mass_m: 0.0,
                rudder_rad: 0.0,
                roll_rad: 0.0,
                off_course_rad: 0.0,
                turn: None,
                dive: self.legs[next.saturating_sub(1)].dive,
            },
            Place::On(number) => self.fly(read, &self.legs[number]),
        }
    }

    fn change_leg(&mut self, read: &Readings) {
        match self.place {
            Place::Surface { until_s, next } if read.time_s >= until_s => self.begin(next, read.time_s),
            Place::On(number) => {
                let leg = self.legs[number];
                let done = if leg.rising { read.depth_m <= leg.ends_m } else { read.depth_m >= leg.ends_m };
                if done && leg.surface_s > 0.0 {
                    self.place = Place::Surface { until_s: read.time_s + leg.surface_s, next: number + 1 };
                } else if done {
                    self.begin(number + 1, read.time_s);
                }
            }
            Place::Surface { .. } => {}
        }
    }

    fn begin(&mut self, number: usize, time_s: f64) {
        let number = number.min(self.legs.len() - 1);
        let leg = &self.legs[number];
        let net_kg = -self.density_kg_m3 * (leg.ballast_cc - self.neutral_cc) * 1e-6;
        let glide = self.vehicle.steady_glide(net_kg, leg.pitch_rad, self.density_kg_m3);
        let (angle, speed) = glide.unwrap_or((0.0, 0.2));
        self.moving_mass_m = self.vehicle.moving_mass_for(leg.pitch_rad, angle, speed, self.density_kg_m3);
        self.place = Place::On(number);
        self.since_s = time_s;
        self.next_check_s = time_s + 120.0;
        self.full_ballast = false;
    }

    fn fly(&mut self, read: &Readings, leg: &Leg) -> Orders {
        let gone_s = read.time_s - self.since_s;
        self.full_ballast |= gone_s > 300.0 && self.depth_rate_m_s.abs() < TOO_SLOW_M_S;
        if read.time_s >= self.next_check_s {
            self.next_check_s = read.time_s + PITCH_CHECK_S;
            let error = leg.pitch_rad - read.pitch_rad;
            if error.abs() > PITCH_DEADBAND_RAD {
                let cos = leg.pitch_rad.cos();
                self.moving_mass_m -= 0.6 * self.vehicle.moving_mass_height_m * error / (cos * cos);
            }
        }
        let travel = self.vehicle.moving_mass_travel_m;
        self.moving_mass_m = self.moving_mass_m.clamp(-travel, travel);
        let ballast_cc = match (self.full_ballast, leg.rising) {
            (false, _) => leg.ballast_cc,
            (true, true) => self.vehicle.ballast_max_cc,
            (true, false) => self.vehicle.ballast_min_cc,
        };
        let turn = leg.turn.filter(|turn| (turn.starts_s..turn.starts_s + turn.lasts_s).contains(&gone_s));
        let off_course_rad = (leg.heading_rad - read.heading_rad + PI).rem_euclid(TAU) - PI;
        let turn = turn.map(|turn| [turn.rudder_rad, turn.roll_rad]);
        let on_course = || [(0.4 * off_course_rad).clamp(-RUDDER_LIMIT_RAD, RUDDER_LIMIT_RAD), 0.0];
        let [rudder_rad, roll_rad] = turn.unwrap_or_else(on_course);
        let moving_mass_m = self.moving_mass_m;
        Orders { ballast_cc, moving_mass_m, rudder_rad, roll_rad, off_course_rad, turn, dive: leg.dive }
    }
}
