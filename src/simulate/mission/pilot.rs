//! The controller of a mission in space: when a leg ends, the set-points of the masses, the heading from waypoint to waypoint.

use super::Mission;
use super::account::{Ending, LegKind};
use super::controller::Controller;
use super::course::Phase;
use super::route_account::{Account, RouteError, RouteMoment};
use super::space_course::{Course, LOWER, N_EVENTS, Orders, SEABED, UPPER};
use super::spent::Spent;
use crate::dynamics::Energy;
use crate::simulate::space::row;
use crate::spatial::steering::{shortest, with_gains};
use crate::spatial::{Body, N_STATES, SpatialGlider, State, Steering};

/// The state machine and the autopilot.
pub(super) struct Pilot<'a> {
    pub(super) course: Course<'a>,
    controller: Controller,
    steering: Steering,
    pub(super) time_s: f64,
    pub(super) state: State<f64>,
    next_pitch_look_s: f64,
    next_heading_look_s: f64,
    surfacing_due_s: f64,
    /// Where the way was last looked at.
    before_m: [f64; 2],
    reached: usize,
    pub(super) ending: Option<Ending>,
    dives: u64,
    surfacings: u64,
    pumpings: u64,
    pitch_moves: u64,
    steering_moves: u64,
    groundings: u64,
    steering_J: f64,
    pub(super) spent: Spent,
}

impl<'a> Pilot<'a> {
    pub(super) fn new(body: &Body<f64>, mission: &'a Mission) -> Result<Self, RouteError> {
        let body = with_gains(body);
        let (p, l) = (&body.plane, &body.lateral);
        let steering = mission.route.steering.unwrap_or(match l.heading_rudder_gain != 0.0 {
            true => Steering::HeadingByRudder,
            false => Steering::HeadingByRollMass,
        });
        let (gains, what) = match steering {
            Steering::HeadingByRollMass => ([l.heading_roll_gain_descent, l.heading_roll_gain_ascent], "roll mass"),
            _ => ([l.heading_rudder_gain; 2], "rudder"),
        };
        if !mission.route.waypoints_m.is_empty() && gains.contains(&0.0) {
            return Err(RouteError::NothingSteers(what));
        }
        let controller = Controller::new(p, mission)?;
        let ballast_m3 = mission.surfacing.ballast_m3.clamp(p.ballast_min_m3, p.ballast_max_m3);
        let state = State {
            pitch_rad: mission.surfacing.pitch_rad,
            moving_mass_m: controller.surface_m,
            ballast_mass_kg: p.ballast_mass_kg(ballast_m3),
            heading_rad: mission.route.waypoints_m.first().map_or(0.0, |[north, east]| east.atan2(*north)),
            ..State::from_array([0.0; N_STATES])
        };
        let orders = Orders { ballast_m3, moving_mass_m: controller.surface_m, roll_mass_rad: 0.0, rudder_rad: 0.0 };
        let course = Course { body, mission, orders, phase: Phase::AtSurface { until_s: 0.0 }, way_m: 0.0 };
        let mut pilot = Pilot {
            course,
            controller,
            steering,
            time_s: 0.0,
            state,
            next_pitch_look_s: f64::INFINITY,
            next_heading_look_s: 0.0,
            surfacing_due_s: mission.surfacing.first_s.unwrap_or(f64::INFINITY),
            before_m: [0.0; 2],
            reached: 0,
            ending: None,
            dives: 0,
            surfacings: 0,
            pumpings: 0,
            pitch_moves: 0,
            steering_moves: 0,
            groundings: 0,
            steering_J: 0.0,
            spent: Spent::new(),
        };
        pilot.begin(Phase::Descending);
        Ok(pilot)
    }

    /// When the clock alone gives the next order \[s\].
    pub(super) fn next_change_s(&self) -> f64 {
        self.next_pitch_look_s.min(self.next_heading_look_s).min(self.next_order_s())
    }

    fn next_order_s(&self) -> f64 {
        match self.course.phase {
            Phase::AtSurface { until_s } => until_s,
            Phase::Climbing { to_surface: true } => f64::INFINITY,
            Phase::Descending | Phase::Climbing { .. } => self.surfacing_due_s,
        }
    }

    /// Gives the orders that are due; whether there were any.
    pub(super) fn decide(&mut self, which: [bool; N_EVENTS]) -> bool {
        let mission = self.course.mission;
        if which[SEABED] && self.state.depth_m >= mission.seabed.at(self.course.way_m) {
            self.groundings += 1;
        }
        if self.time_s >= mission.duration_s {
            self.ending = Some(Ending::Duration);
            return false;
        }
        let is_due = self.time_s >= self.next_order_s();
        let next = match self.course.phase {
            Phase::Descending if which[LOWER] => {
                Some(Phase::Climbing { to_surface: self.surfacing_due_s == f64::INFINITY })
            }
            Phase::Climbing { to_surface: true } if which[UPPER] => {
                self.surfacings += 1;
                self.state.energy_J += self.spent.surfaced(&self.course.body.plane);
                Some(Phase::AtSurface { until_s: self.time_s + mission.surfacing.stay_s })
            }
            Phase::Climbing { to_surface: false } if which[UPPER] => Some(Phase::Descending),
            Phase::AtSurface { .. } if is_due => {
                self.surfacing_due_s = mission.surfacing.every_s.map_or(f64::INFINITY, |every| self.time_s + every);
                Some(Phase::Descending)
            }
            Phase::Descending | Phase::Climbing { to_surface: false } if is_due => {
                Some(Phase::Climbing { to_surface: true })
            }
            _ => None,
        };
        let mut changed = next.is_some();
        if let Some(phase) = next {
            self.begin(phase);
        }
        if self.time_s >= self.next_pitch_look_s {
            self.next_pitch_look_s = self.time_s + mission.control.period_s;
            let (p, descending) = (&self.course.body.plane, self.course.phase == Phase::Descending);
            let read = (self.state.pitch_rad - p.pitch_offset_rad) / p.pitch_scale;
            if self.controller.look(descending, read) {
                self.move_mass(self.controller.position_m(descending));
                changed = true;
            }
        }
        if self.time_s >= self.next_heading_look_s {
            self.next_heading_look_s = self.time_s + mission.route.period_s;
            changed |= self.steer();
        }
        changed
    }

    /// Looks at place and heading; whether rudder or roll mass are to move.
    fn steer(&mut self) -> bool {
        let (route, s) = (&self.course.mission.route, &self.state);
        let [north, east] = self.before_m;
        self.course.way_m += (s.north_m - north).hypot(s.east_m - east);
        self.before_m = [s.north_m, s.east_m];
        if self.course.way_m >= self.course.mission.distance_m {
            self.ending = Some(Ending::Distance);
        }
        let to = |[north, east]: [f64; 2]| [north - s.north_m, east - s.east_m];
        while let Some(way) = route.waypoints_m.get(self.reached).map(|waypoint| to(*waypoint)) {
            if way[0].hypot(way[1]) > route.reached_m {
                break;
            }
            self.reached += 1;
        }
        if route.waypoints_m.is_empty() {
            return false;
        }
        let Some(way) = route.waypoints_m.get(self.reached).map(|waypoint| to(*waypoint)) else {
            self.ending = Some(Ending::Distance);
            return false;
        };
        let error = shortest(way[1].atan2(way[0]) - s.heading_rad);
        let is_left_alone = error.abs() <= route.deadband_rad || matches!(self.course.phase, Phase::AtSurface { .. });
        let error = if is_left_alone { 0.0 } else { error };
        let l = &self.course.body.lateral;
        let mut orders = self.course.orders;
        let (moved_rad, rate_rad_s, power_W) = match self.steering {
            Steering::HeadingByRollMass => {
                let descends = self.course.phase == Phase::Descending;
                let gain = if descends { l.heading_roll_gain_descent } else { l.heading_roll_gain_ascent };
                orders.roll_mass_rad = (gain * error).clamp(l.roll_mass_min_rad, l.roll_mass_max_rad);
                let moved = orders.roll_mass_rad - self.course.orders.roll_mass_rad;
                (moved, l.roll_mass_rate_rad_s, l.roll_mass_power_W)
            }
            _ => {
                orders.rudder_rad = (l.heading_rudder_gain * error).clamp(l.rudder_min_rad, l.rudder_max_rad);
                (orders.rudder_rad - self.course.orders.rudder_rad, l.rudder_rate_rad_s, l.rudder_power_W)
            }
        };
        let moves = moved_rad != 0.0;
        self.steering_moves += u64::from(moves);
        // The power goes with the rate: a move costs its angle, however fast.
        self.steering_J += power_W * moved_rad.abs() / rate_rad_s;
        self.course.orders = orders;
        moves
    }

    fn begin(&mut self, phase: Phase) {
        let mission = self.course.mission;
        self.course.phase = phase;
        let (ballast_m3, moving_mass_m) = match phase {
            Phase::Descending => (mission.descent.ballast_m3, self.controller.position_m(true)),
            Phase::Climbing { .. } => (mission.ascent.ballast_m3, self.controller.position_m(false)),
            Phase::AtSurface { .. } => (mission.surfacing.ballast_m3, self.controller.surface_m),
        };
        self.dives += u64::from(phase == Phase::Descending);
        self.next_pitch_look_s = match phase {
            Phase::AtSurface { .. } => f64::INFINITY,
            _ => self.time_s + mission.control.period_s,
        };
        // A roll turns the other way on the other leg.
        self.next_heading_look_s = self.time_s;
        self.pumpings += u64::from(ballast_m3 > self.course.orders.ballast_m3);
        self.course.orders.ballast_m3 = ballast_m3;
        self.move_mass(moving_mass_m);
        let too_shallow = mission.turning_depth_m(self.course.way_m) <= self.state.depth_m;
        if phase == Phase::Descending && too_shallow {
            self.ending = Some(Ending::TooShallow);
        }
    }

    fn move_mass(&mut self, position_m: f64) {
        self.pitch_moves += u64::from(position_m != self.course.orders.moving_mass_m);
        self.spent.moved(&self.course.body.plane, self.course.orders.moving_mass_m, position_m);
        self.course.orders.moving_mass_m = position_m;
    }

    pub(super) fn moment(&self) -> RouteMoment {
        let inputs = self.course.inputs(&self.state);
        let glider = SpatialGlider::new(self.course.body, Steering::Direct, inputs);
        let out = glider.outputs(self.time_s, &self.state);
        RouteMoment {
            row: row(&glider, self.time_s, &self.state, self.course.mission.route.origin),
            leg: match self.course.phase {
                Phase::Descending => LegKind::Descent,
                Phase::Climbing { .. } => LegKind::Ascent,
                Phase::AtSurface { .. } => LegKind::Surface,
            },
            ballast_m3: out.ballast_m3,
            density_kg_m3: inputs.water_density_kg_m3,
            temperature_C: inputs.water_temperature_C,
            pitch_read_rad: out.pitch_read_rad,
            pressure_read_dbar: out.pressure_read_dbar,
        }
    }

    pub(super) fn end(&self, ended_by: Ending) -> Account {
        let body = &self.course.body;
        let steering_J = body.lateral.counts_steering().then_some(self.steering_J);
        let Energy { hotel_J, pump_J, steering_J, surfacing_J } =
            self.spent.energy(&body.plane, self.state.energy_J, steering_J);
        let [north, east] = self.before_m;
        Account {
            ended_by,
            duration_s: self.time_s,
            distance_m: self.course.way_m + (self.state.north_m - north).hypot(self.state.east_m - east),
            waypoints_reached: self.reached,
            waypoints: self.course.mission.route.waypoints_m.len(),
            dives: self.dives,
            surfacings: self.surfacings,
            pumpings: self.pumpings,
            pitch_moves: self.pitch_moves,
            steering_moves: self.steering_moves,
            groundings: self.groundings,
            pump_J,
            steering_J,
            surfacing_J,
            hotel_J,
        }
    }
}
