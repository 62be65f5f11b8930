//! The mission flown: the glider's state machine on top of the equations of motion.
//!
//! The water and the seabed are functions of where the glider is, inside the equations; the turns are events, found to
//! a nanosecond. Between events nothing is allocated.

use super::controller::Controller;
use super::{Mission, Profile};
use crate::dynamics::limits::N_EVENTS;
use crate::dynamics::{
    Actuation, Advance, Glider, Inputs, IntegrationError, Integrator, Modes, Parameters, State, derivative, integrate,
};
use crate::glide::GlideError;
use crate::simulate::{Row, row};

/// The names of what a [`Moment`] adds to a row.
pub const MISSION_COLUMNS: [&str; 7] = [
    "ballast_m3",
    "water_density_kg_m3",
    "water_temperature_C",
    "current_x_m_s",
    "seabed_depth_m",
    "pitch_read_rad",
    "pressure_read_dbar",
];

/// One moment of a mission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// As in every time history.
    pub row: Row,
    /// What is read and what is around, in the order of [`MISSION_COLUMNS`].
    pub around: [f64; MISSION_COLUMNS.len()],
    /// What the glider is doing.
    pub leg: LegKind,
}

/// What a glider can be doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LegKind {
    /// On its way down.
    Descent,
    /// On its way up.
    Ascent,
    /// At the surface, for a fix and a call.
    Surface,
}

/// Why a leg ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Turn {
    /// At the largest depth.
    MaxDepth,
    /// At the altimeter's height above the seabed.
    Altimeter,
    /// At the depth of turning down again.
    ClimbTo,
    /// It was time to come up.
    SurfacingDue,
    /// At the surface.
    Surfaced,
    /// The stay at the surface was over.
    StayOver,
    /// The mission was over.
    MissionEnd,
}

/// One leg.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Leg {
    /// Descent, ascent or surface.
    pub kind: LegKind,
    /// Time of its beginning \[s\].
    pub start_s: f64,
    /// Time of its end \[s\].
    pub end_s: f64,
    /// Depth at which it began, the glider still moving as on the leg before \[m\].
    pub start_depth_m: f64,
    /// Depth at which it ended \[m\].
    pub end_depth_m: f64,
    /// Way over ground at its beginning \[m\].
    pub start_x_m: f64,
    /// Way over ground at its end \[m\].
    pub end_x_m: f64,
    /// Deepest (before an ascent) or shallowest (before a descent) depth that was reached after the turn; none
    /// where the leg ended before.
    pub inflection_depth_m: Option<f64>,
    /// Depth of the seabed at its end \[m\].
    pub seabed_depth_m: f64,
    /// Why it ended.
    pub ended_by: Turn,
}

/// How the mission ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// Its time was up.
    Duration,
    /// The way was done.
    Distance,
    /// The water became too shallow to dive.
    TooShallow,
    /// Whoever looked on had seen enough.
    Stopped,
}

/// A mission that was flown.
#[derive(Debug, Clone, PartialEq)]
pub struct Flight {
    /// Why it ended.
    pub ending: Ending,
    /// Time \[s\].
    pub duration_s: f64,
    /// Way over ground \[m\].
    pub distance_m: f64,
    /// Leg by leg.
    pub legs: Vec<Leg>,
    /// Times the buoyancy engine pumped out.
    pub pumpings: u64,
    /// Moves of the moving mass, those at the turns included.
    pub pitch_moves: u64,
    /// Times the glider touched the seabed.
    pub groundings: u64,
    /// Energy of the pump \[J\].
    pub pump_J: f64,
    /// Energy of everything that runs all the time \[J\].
    pub hotel_J: f64,
}

/// Why a mission could not be flown.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MissionError {
    /// Ballast and pitch do not belong to any glide.
    #[error(
        "the {leg} cannot be flown at {depth_m:.0} m: with {ballast_cc:.0} cc of ballast the net mass there is {net_mass_kg:.4} kg, and {error}; change the ballast or the pitch of the mission, or the trim of the vehicle"
    )]
    NoGlide {
        /// Descent or ascent.
        leg: &'static str,
        /// Where \[m\].
        depth_m: f64,
        /// Ballast volume of that leg \[cm3\].
        ballast_cc: f64,
        /// Net mass there \[kg\].
        net_mass_kg: f64,
        /// What the glide says.
        error: GlideError,
    },
    /// The equations gave no finite rate of change.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
}

/// Flies a mission, handing over a moment every `interval_s` and each leg when it is complete; `on_moment` ends the
/// mission by returning `false`.
///
/// # Errors
/// Where a leg cannot be flown at all, or the equations give no finite rate of change.
pub fn fly_mission(
    parameters: &Parameters<f64>,
    mission: &Mission,
    interval_s: f64,
    tolerance: f64,
    on_moment: impl FnMut(&Moment) -> bool,
) -> Result<Flight, MissionError> {
    fly_with(parameters, mission, Controller::new(parameters, mission)?, interval_s, tolerance, on_moment)
}

/// The same with a controller made elsewhere.
pub(super) fn fly_with(
    parameters: &Parameters<f64>,
    mission: &Mission,
    controller: Controller,
    interval_s: f64,
    tolerance: f64,
    mut on_moment: impl FnMut(&Moment) -> bool,
) -> Result<Flight, MissionError> {
    let mut pilot = Pilot::new(parameters, mission, controller);
    let mut integrator = Integrator::new(tolerance);
    if !on_moment(&pilot.moment()) {
        return Ok(pilot.end(Ending::Stopped));
    }
    let mut rows = 1.0;
    loop {
        let next_row = rows * interval_s;
        let until = next_row.min(pilot.next_look_s).min(pilot.next_order_s()).min(mission.duration_s);
        let (mut time, mut state) = (pilot.time_s, pilot.state);
        let advance = integrator.advance(&pilot.course, &mut time, &mut state, until)?;
        (pilot.time_s, pilot.state) = (time, state);
        if let Advance::Event(which) = advance {
            pilot.on_event(which);
        }
        if pilot.decide() {
            integrator.restart();
        }
        if let Some(ending) = pilot.ending {
            on_moment(&pilot.moment());
            return Ok(pilot.end(ending));
        }
        if pilot.time_s >= next_row {
            rows += 1.0;
            if !on_moment(&pilot.moment()) {
                return Ok(pilot.end(Ending::Stopped));
            }
        }
    }
}

/// The equations of motion with the orders that hold, in the water and over the seabed of the mission.
#[derive(Debug, Clone, Copy)]
struct Course<'a> {
    parameters: &'a Parameters<f64>,
    mission: &'a Mission,
    ballast_m3: f64,
    moving_mass_m: f64,
    phase: Phase,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Descending,
    Climbing { to_surface: bool },
    AtSurface { until_s: f64 },
}

/// The event indicators of a course.
const MAX_DEPTH: usize = 0;
const ALTIMETER: usize = 1;
const GROUNDED: usize = 2;
const INFLECTION: usize = 3;
const UPPER_END: usize = 4;
const WAY_DONE: usize = 5;

impl Course<'_> {
    fn inputs(&self, state: &State<f64>) -> Inputs<f64> {
        let (p, m) = (self.parameters, self.mission);
        let at =
            |profile: &Option<Profile>, otherwise: f64| profile.as_ref().map_or(otherwise, |it| it.at(state.depth_m));
        Inputs {
            ballast_command_m3: self.ballast_m3,
            moving_mass_command_m: self.moving_mass_m,
            current_x_m_s: m.current.at(state.depth_m),
            seabed_depth_m: m.seabed.at(state.x_m),
            ..Inputs::still_water(
                at(&m.density, p.reference_density_kg_m3),
                at(&m.temperature, p.reference_temperature_C),
            )
        }
    }
}

impl integrate::System for Course<'_> {
    fn derivative(&self, time_s: f64, state: &State<f64>) -> State<f64> {
        derivative(self.parameters, Actuation::Servo, Modes::default(), time_s, state, &self.inputs(state))
    }

    fn event_indicators(&self, _: f64, state: &State<f64>) -> [f64; N_EVENTS] {
        let m = self.mission;
        let seabed = m.seabed.at(state.x_m);
        let mut z = [1.0; N_EVENTS];
        z[GROUNDED] = seabed - state.depth_m;
        z[WAY_DONE] = m.distance_m - state.x_m;
        z[INFLECTION] = state.v3_m_s * state.pitch_rad.cos() - state.v1_m_s * state.pitch_rad.sin();
        match self.phase {
            Phase::Descending => {
                z[MAX_DEPTH] = m.max_depth_m - state.depth_m;
                if m.altimeter_m > 0.0 {
                    z[ALTIMETER] = seabed - m.altimeter_m - state.depth_m;
                }
            }
            Phase::Climbing { to_surface } => {
                z[UPPER_END] = state.depth_m - if to_surface { 0.0 } else { m.climb_to_m };
            }
            Phase::AtSurface { .. } => z[INFLECTION] = 1.0,
        }
        z
    }

    fn next_jump_s(&self, time_s: f64) -> Option<f64> {
        let p = self.parameters;
        (p.drag_step != 0.0 && p.step_time_s > time_s).then_some(p.step_time_s)
    }
}

/// The state machine.
struct Pilot<'a> {
    course: Course<'a>,
    controller: Controller,
    time_s: f64,
    state: State<f64>,
    next_look_s: f64,
    surfacing_due_s: f64,
    leg: Leg,
    legs: Vec<Leg>,
    turn: Option<Turn>,
    ending: Option<Ending>,
    pumpings: u64,
    pitch_moves: u64,
    groundings: u64,
}

impl<'a> Pilot<'a> {
    /// Afloat at the start, with the orders of the first descent just given.
    fn new(parameters: &'a Parameters<f64>, mission: &'a Mission, controller: Controller) -> Self {
        let p = parameters;
        let ballast_m3 = mission.surfacing.ballast_m3.clamp(p.ballast_min_m3, p.ballast_max_m3);
        let state = State {
            x_m: 0.0,
            depth_m: 0.0,
            pitch_rad: mission.surfacing.pitch_rad,
            pitch_rate_rad_s: 0.0,
            v1_m_s: 0.0,
            v3_m_s: 0.0,
            moving_mass_1_m: controller.surface_m,
            moving_mass_3_m: p.moving_mass_height_m,
            momentum_1_kg_m_s: 0.0,
            momentum_3_kg_m_s: 0.0,
            ballast_mass_kg: p.ballast_mass_kg(ballast_m3),
            energy_J: 0.0,
        };
        let phase = Phase::AtSurface { until_s: 0.0 };
        let course = Course { parameters, mission, ballast_m3, moving_mass_m: controller.surface_m, phase };
        let mut pilot = Pilot {
            course,
            controller,
            time_s: 0.0,
            state,
            next_look_s: f64::INFINITY,
            surfacing_due_s: mission.surfacing.first_s.unwrap_or(f64::INFINITY),
            leg: Leg {
                kind: LegKind::Surface,
                start_s: 0.0,
                end_s: 0.0,
                start_depth_m: 0.0,
                end_depth_m: 0.0,
                start_x_m: 0.0,
                end_x_m: 0.0,
                inflection_depth_m: None,
                seabed_depth_m: mission.seabed.at(0.0),
                ended_by: Turn::StayOver,
            },
            legs: Vec::new(),
            turn: None,
            ending: None,
            pumpings: 0,
            pitch_moves: 0,
            groundings: 0,
        };
        pilot.begin(Phase::Descending);
        pilot
    }

    /// When the clock alone gives the next order \[s\].
    fn next_order_s(&self) -> f64 {
        match self.course.phase {
            Phase::AtSurface { until_s } => until_s,
            Phase::Climbing { to_surface: true } => f64::INFINITY,
            Phase::Descending | Phase::Climbing { .. } => self.surfacing_due_s,
        }
    }

    fn on_event(&mut self, which: [bool; N_EVENTS]) {
        let seabed = self.course.mission.seabed.at(self.state.x_m);
        if which[GROUNDED] && self.state.depth_m >= seabed {
            self.groundings += 1;
        }
        if which[INFLECTION] && self.leg.inflection_depth_m.is_none() {
            self.leg.inflection_depth_m = Some(self.state.depth_m);
        }
        if which[WAY_DONE] {
            self.ending = Some(Ending::Distance);
        }
        self.turn = match self.course.phase {
            Phase::Descending if which[ALTIMETER] => Some(Turn::Altimeter),
            Phase::Descending if which[MAX_DEPTH] => Some(Turn::MaxDepth),
            Phase::Climbing { to_surface: true } if which[UPPER_END] => Some(Turn::Surfaced),
            Phase::Climbing { to_surface: false } if which[UPPER_END] => Some(Turn::ClimbTo),
            _ => None,
        };
    }

    /// Gives the orders that are due; whether there were any.
    fn decide(&mut self) -> bool {
        if self.ending.is_none() && self.time_s >= self.course.mission.duration_s {
            self.ending = Some(Ending::Duration);
        }
        if self.ending.is_some() {
            return false;
        }
        let turn = self.turn.take().or_else(|| {
            (self.time_s >= self.next_order_s()).then_some(match self.course.phase {
                Phase::AtSurface { .. } => Turn::StayOver,
                _ => Turn::SurfacingDue,
            })
        });
        if let Some(turn) = turn {
            self.end_leg(turn);
            let surfacing = self.course.mission.surfacing;
            let phase = match turn {
                Turn::MaxDepth | Turn::Altimeter => {
                    Phase::Climbing { to_surface: self.surfacing_due_s == f64::INFINITY }
                }
                Turn::SurfacingDue => Phase::Climbing { to_surface: true },
                Turn::Surfaced => Phase::AtSurface { until_s: self.time_s + surfacing.stay_s },
                Turn::StayOver => {
                    self.surfacing_due_s = surfacing.every_s.map_or(f64::INFINITY, |every| self.time_s + every);
                    Phase::Descending
                }
                Turn::ClimbTo | Turn::MissionEnd => Phase::Descending,
            };
            self.begin(phase);
            return true;
        }
        if self.time_s >= self.next_look_s {
            self.next_look_s = self.time_s + self.course.mission.control.period_s;
            let descending = self.course.phase == Phase::Descending;
            let p = self.course.parameters;
            let read = (self.state.pitch_rad - p.pitch_offset_rad) / p.pitch_scale;
            if self.controller.look(descending, read) {
                self.move_mass(self.controller.position_m(descending));
                return true;
            }
        }
        false
    }

    fn begin(&mut self, phase: Phase) {
        let mission = self.course.mission;
        self.course.phase = phase;
        let (kind, ballast_m3, moving_mass_m) = match phase {
            Phase::Descending => (LegKind::Descent, mission.descent.ballast_m3, self.controller.position_m(true)),
            Phase::Climbing { .. } => (LegKind::Ascent, mission.ascent.ballast_m3, self.controller.position_m(false)),
            Phase::AtSurface { .. } => (LegKind::Surface, mission.surfacing.ballast_m3, self.controller.surface_m),
        };
        self.leg = Leg {
            kind,
            start_s: self.time_s,
            start_depth_m: self.state.depth_m,
            start_x_m: self.state.x_m,
            inflection_depth_m: None,
            ..self.leg
        };
        self.next_look_s = match kind {
            LegKind::Surface => f64::INFINITY,
            LegKind::Descent | LegKind::Ascent => self.time_s + mission.control.period_s,
        };
        self.pumpings += u64::from(ballast_m3 > self.course.ballast_m3);
        self.course.ballast_m3 = ballast_m3;
        self.move_mass(moving_mass_m);
        // Nothing to dive into: the turn would lie above the glider.
        let too_shallow = mission.turning_depth_m(self.state.x_m) <= self.state.depth_m;
        if phase == Phase::Descending && too_shallow {
            self.ending = Some(Ending::TooShallow);
        }
    }

    fn move_mass(&mut self, position_m: f64) {
        self.pitch_moves += u64::from(position_m != self.course.moving_mass_m);
        self.course.moving_mass_m = position_m;
    }

    fn end_leg(&mut self, turn: Turn) {
        self.leg = Leg {
            end_s: self.time_s,
            end_depth_m: self.state.depth_m,
            end_x_m: self.state.x_m,
            seabed_depth_m: self.course.mission.seabed.at(self.state.x_m),
            ended_by: turn,
            ..self.leg
        };
        self.legs.push(self.leg);
    }

    fn moment(&self) -> Moment {
        let inputs = self.course.inputs(&self.state);
        let p = self.course.parameters;
        let glider = Glider::new(*p, Actuation::Servo, inputs);
        let out = glider.outputs(self.time_s, &self.state);
        Moment {
            row: row(&glider, self.time_s, &self.state),
            around: [
                out.ballast_m3,
                inputs.water_density_kg_m3,
                inputs.water_temperature_C,
                inputs.current_x_m_s,
                inputs.seabed_depth_m,
                out.pitch_read_rad,
                out.pressure_read_dbar,
            ],
            leg: self.leg.kind,
        }
    }

    fn end(mut self, ending: Ending) -> Flight {
        if self.time_s > self.leg.start_s {
            self.end_leg(Turn::MissionEnd);
        }
        let hotel_J = self.course.parameters.hotel_W * self.time_s;
        Flight {
            ending,
            duration_s: self.time_s,
            distance_m: self.state.x_m,
            legs: self.legs,
            pumpings: self.pumpings,
            pitch_moves: self.pitch_moves,
            groundings: self.groundings,
            pump_J: self.state.energy_J - hotel_J,
            hotel_J,
        }
    }
}
