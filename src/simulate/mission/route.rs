//! A mission flown in space: dives as in the plane, and a heading held from waypoint to waypoint.
//!
//! At each look, every `period_s`, the autopilot compares the heading with the course to the next waypoint. Within the dead
//! band rudder or roll mass go amidships; beyond it they take the angle that closes the error within a minute or so
//! ([`with_gains`]). Between looks nothing moves: what pilots call a turn.

use std::fmt;

use glidepolar_ode::{Advance, IntegrationError, Integrator, Slopes, System};

use super::account::{Ending, LegKind, MissionError};
use super::controller::Controller;
use super::course::Phase;
use super::spent::Spent;
use super::{Mission, Profile};
use crate::Number;
use crate::dynamics::Energy;
use crate::simulate::space::{Row, row};
use crate::spatial::glider::{FIRST_FELT, N_FELT, N_MEMORY, NOMINAL_VALUES, slopes};
use crate::spatial::steering::{shortest, with_gains};
use crate::spatial::{Body, Inputs, N_STATES, SpatialGlider, State, Steering, derivative, next_bend_s};

/// Events: the lower turn, the upper end, the seabed.
const LOWER: usize = 0;
const UPPER: usize = 1;
const SEABED: usize = 2;
const N_EVENTS: usize = 3;

/// One moment of a mission in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RouteMoment {
    /// As in every time history in space.
    pub row: Row,
    /// What the glider is doing.
    pub leg: LegKind,
    /// Ballast volume that an instrument reads \[m3\].
    pub ballast_m3: f64,
    /// Density of the water \[kg/m3\].
    pub density_kg_m3: f64,
    /// Its temperature \[degC\].
    pub temperature_C: f64,
    /// Pitch as the instrument reads it \[rad\].
    pub pitch_read_rad: f64,
    /// Pressure as the instrument reads it \[dbar\].
    pub pressure_read_dbar: f64,
}

/// What a mission in space came to.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Account {
    /// Why it ended.
    pub ended_by: Ending,
    /// Time \[s\].
    pub duration_s: f64,
    /// Way over ground, summed from moment to moment of control \[m\].
    pub distance_m: f64,
    /// Waypoints that were reached.
    pub waypoints_reached: usize,
    /// Waypoints that there are.
    pub waypoints: usize,
    /// Descents.
    pub dives: u64,
    /// Stays at the surface.
    pub surfacings: u64,
    /// Times the buoyancy engine pumped out.
    pub pumpings: u64,
    /// Moves of the moving mass.
    pub pitch_moves: u64,
    /// Moves of rudder or roll mass.
    pub steering_moves: u64,
    /// Times the glider touched the seabed.
    pub groundings: u64,
    /// Energy of the pump \[J\].
    pub pump_J: f64,
    /// Energy of rudder, roll mass and moving mass \[J\].
    pub steering_J: f64,
    /// Energy of the surfacings \[J\].
    pub surfacing_J: f64,
    /// Energy of everything that runs all the time \[J\].
    pub hotel_J: f64,
}

/// Why a mission could not be flown in space.
#[derive(Debug, Clone, PartialEq)]
pub enum RouteError {
    /// A leg cannot be flown, or the equations cannot be followed.
    Mission(MissionError),
    /// There are waypoints and nothing that steers.
    NothingSteers(&'static str),
}

impl fmt::Display for RouteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RouteError::Mission(error) => error.fmt(f),
            RouteError::NothingSteers(what) => write!(
                f,
                "the mission has waypoints, but the vehicle does not turn by its {what}: add [rudder] or [roll_mass] to its file, or choose the other by steering.actuator"
            ),
        }
    }
}

impl std::error::Error for RouteError {}

impl From<MissionError> for RouteError {
    fn from(error: MissionError) -> Self {
        RouteError::Mission(error)
    }
}

impl From<IntegrationError> for RouteError {
    fn from(error: IntegrationError) -> Self {
        RouteError::Mission(error.into())
    }
}

/// Flies a mission in space, handing over a moment every `interval_s`; `on_moment` ends it by returning `false`.
///
/// # Errors
/// Where a leg cannot be flown at all, nothing steers to the waypoints, or the equations give no finite rate of change.
pub fn fly_route(
    body: &Body<f64>,
    mission: &Mission,
    interval_s: f64,
    tolerance: f64,
    mut on_moment: impl FnMut(&RouteMoment) -> bool,
) -> Result<Account, RouteError> {
    let mut pilot = Pilot::new(body, mission)?;
    let mut integrator = Integrator::new(tolerance);
    let mut rows = 1.0;
    if !on_moment(&pilot.moment()) {
        return Ok(pilot.end(Ending::Stopped));
    }
    loop {
        let next_row = rows * interval_s;
        let next_change = pilot.next_change_s().min(mission.duration_s);
        let (mut time_s, mut state) = (pilot.time_s, pilot.state.as_array());
        let advance =
            integrator.follow(&pilot.course, &mut time_s, &mut state, next_row.min(next_change), next_change)?;
        let before = (pilot.time_s, pilot.state.depth_m);
        (pilot.time_s, pilot.state) = (time_s, State::from_array(state));
        pilot.spent.carried(pilot.time_s - before.0, [before.1, pilot.state.depth_m]);
        let which = match advance {
            Advance::Reached => [false; N_EVENTS],
            Advance::Event(which) => which,
        };
        if pilot.decide(which) {
            integrator.restart();
        }
        if let Some(ending) = pilot.ending {
            on_moment(&pilot.moment());
            return Ok(pilot.end(ending));
        }
        if pilot.time_s >= next_row {
            glidepolar_progress::one_more("rows");
            rows += 1.0;
            if !on_moment(&pilot.moment()) {
                return Ok(pilot.end(Ending::Stopped));
            }
        }
    }
}

/// The equations with the orders that hold, in the water and over the seabed of the mission.
struct Course<'a> {
    body: Body<f64>,
    mission: &'a Mission,
    orders: Orders,
    phase: Phase,
    /// Way over ground, by which the seabed is known \[m\].
    way_m: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Orders {
    ballast_m3: f64,
    moving_mass_m: f64,
    roll_mass_rad: f64,
    rudder_rad: f64,
}

impl Course<'_> {
    fn inputs<T: Number>(&self, state: &State<T>) -> Inputs<T> {
        let (p, m, r) = (&self.body.plane, self.mission, &self.mission.route);
        let at = |profile: &Option<Profile>, otherwise: f64| {
            profile.as_ref().map_or(T::constant(otherwise), |it| it.at(state.depth_m))
        };
        let depth_m = state.depth_m.value();
        Inputs {
            ballast_command_m3: T::constant(self.orders.ballast_m3),
            moving_mass_command_m: T::constant(self.orders.moving_mass_m),
            roll_mass_command_rad: T::constant(self.orders.roll_mass_rad),
            rudder_command_rad: T::constant(self.orders.rudder_rad),
            current_north_m_s: r.current_north.at(state.depth_m),
            current_east_m_s: r.current_east.at(state.depth_m),
            current_north_shear_1_s: T::constant(r.current_north.slope(depth_m)),
            current_east_shear_1_s: T::constant(r.current_east.slope(depth_m)),
            water_density_kg_m3: at(&m.density, p.reference_density_kg_m3),
            water_temperature_C: at(&m.temperature, p.reference_temperature_C),
            seabed_depth_m: T::constant(m.seabed.at(self.way_m)),
            ..Inputs::still_water(0.0, 0.0).map(T::constant)
        }
    }

    fn rates<T: Number>(&self, time_s: T, state: &State<T>) -> State<T> {
        derivative(&self.body.map(T::constant), time_s, state, &self.inputs(state))
    }
}

impl System<N_STATES, N_FELT, N_EVENTS> for Course<'_> {
    const NOMINALS: [f64; N_STATES] = NOMINAL_VALUES;
    const FIRST_FELT: usize = FIRST_FELT;
    const COUNTED_IN_ERROR: usize = N_STATES - N_MEMORY;

    fn derivative(&self, time_s: f64, state: &[f64; N_STATES]) -> [f64; N_STATES] {
        self.rates(time_s, &State::from_array(*state)).as_array()
    }

    fn slopes(&self, time_s: f64, state: &[f64; N_STATES]) -> Slopes<N_STATES, N_FELT> {
        slopes(time_s, state, |time_s, state| self.rates(time_s, &state))
    }

    fn event_indicators(&self, _: f64, state: &[f64; N_STATES]) -> [f64; N_EVENTS] {
        let (depth_m, m) = (State::from_array(*state).depth_m, self.mission);
        let mut z = [1.0; N_EVENTS];
        z[SEABED] = m.seabed.at(self.way_m) - depth_m;
        match self.phase {
            Phase::Descending => z[LOWER] = m.turning_depth_m(self.way_m) - depth_m,
            Phase::Climbing { to_surface } => z[UPPER] = depth_m - if to_surface { 0.0 } else { m.climb_to_m },
            Phase::AtSurface { .. } => {}
        }
        z
    }

    fn next_jump_s(&self, time_s: f64) -> Option<f64> {
        let p = &self.body.plane;
        (p.drag_step != 0.0 && p.step_time_s > time_s).then_some(p.step_time_s)
    }

    fn next_bend_s(&self, time_s: f64, state: &[f64; N_STATES]) -> Option<f64> {
        let state = State::from_array(*state);
        next_bend_s(&self.body, time_s, &state, &self.inputs(&state))
    }
}

/// The state machine and the autopilot.
struct Pilot<'a> {
    course: Course<'a>,
    controller: Controller,
    steering: Steering,
    time_s: f64,
    state: State<f64>,
    next_pitch_look_s: f64,
    next_heading_look_s: f64,
    surfacing_due_s: f64,
    /// Where the way was last looked at.
    before_m: [f64; 2],
    reached: usize,
    ending: Option<Ending>,
    dives: u64,
    surfacings: u64,
    pumpings: u64,
    pitch_moves: u64,
    steering_moves: u64,
    groundings: u64,
    steering_J: f64,
    spent: Spent,
}

impl<'a> Pilot<'a> {
    fn new(body: &Body<f64>, mission: &'a Mission) -> Result<Self, RouteError> {
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
    fn next_change_s(&self) -> f64 {
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
    fn decide(&mut self, which: [bool; N_EVENTS]) -> bool {
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

    fn moment(&self) -> RouteMoment {
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

    fn end(&self, ended_by: Ending) -> Account {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::space::COLUMNS;
    use crate::vehicle::Vehicle;
    use std::path::Path;

    const SQUARE: &str = "name = \"Square\"\n[voyage]\nduration_h = 30.0\n[dive]\nmax_depth_m = 100.0\n[glide]\n\
        pitch_down_deg = -25.0\npitch_up_deg = 25.0\nballast_down_cc = -220.0\nballast_up_cc = 220.0\n[surfacing]\n\
        every_h = 3.0\n";

    fn fly(vehicle: &str, more: &str) -> (Account, Vec<RouteMoment>) {
        let mission = Mission::parse(&format!("{SQUARE}{more}"), Path::new("square.toml")).unwrap();
        let body = Vehicle::load(vehicle).unwrap().body().unwrap();
        let mut moments = Vec::new();
        let account = fly_route(&body, &mission, 30.0, 1e-7, |moment| {
            moments.push(*moment);
            true
        })
        .unwrap();
        (account, moments)
    }

    fn value(moment: &RouteMoment, name: &str) -> f64 {
        moment.row[COLUMNS.iter().position(|column| *column == name).unwrap()]
    }

    #[test]
    fn every_waypoint_is_reached_against_a_current_across_it() {
        let way = "[route]\nnorth_km = [2.0, 2.0, 0.0]\neast_km = [0.0, 2.0, 2.0]\n[current]\n\
            depth_m = [0.0, 100.0]\neast_m_s = [0.06, 0.02]\n";
        let (account, moments) = fly("slocum-049", way);
        assert_eq!((account.ended_by, account.waypoints_reached), (Ending::Distance, 3), "{account:?}");
        for (north, east) in [(2e3, 0.0), (2e3, 2e3), (0.0, 2e3)] {
            let nearest = moments
                .iter()
                .map(|moment| (value(moment, "north_m") - north).hypot(value(moment, "east_m") - east))
                .fold(f64::INFINITY, f64::min);
            assert!(nearest < 215.0, "{nearest} m from {north} {east}");
        }
        // From circle to circle about the waypoints it is 5.4 km.
        assert!(account.distance_m > 5.2e3 && account.steering_moves > 0 && account.dives > 5, "{account:?}");
    }

    #[test]
    fn a_roll_mass_steers_on_both_legs() {
        let (account, _) = fly("seaglider", "[route]\nnorth_km = [0.5, -1.0]\neast_km = [1.5, 1.0]\n");
        assert_eq!((account.ended_by, account.waypoints_reached), (Ending::Distance, 2), "{account:?}");
    }

    #[test]
    fn without_waypoints_it_goes_straight_and_what_does_not_turn_says_so() {
        let (account, moments) = fly("slocum-049", "[route]\nstart_latitude_deg = 50.0\n");
        assert_eq!((account.ended_by, account.steering_moves, account.waypoints), (Ending::Duration, 0, 0));
        let last = moments.last().unwrap();
        assert!(value(last, "east_m").abs() < 1e-9 && value(last, "lat_deg") > 50.1);
        let mission = format!("{SQUARE}[route]\nnorth_km = 1.0\neast_km = 0.0\n[steering]\nactuator = 2\n");
        let mission = Mission::parse(&mission, Path::new("square.toml")).unwrap();
        let body = Vehicle::load("slocum-049").unwrap().body().unwrap();
        let refused = fly_route(&body, &mission, 30.0, 1e-7, |_| true).unwrap_err();
        assert_eq!(refused, RouteError::NothingSteers("roll mass"));
    }
}
