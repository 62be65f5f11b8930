//! The mission flown: the glider's state machine on top of the equations of motion.
//!
//! The water and the seabed are functions of where the glider is, inside the equations; the turns are events, found to
//! a nanosecond. Between events nothing is allocated.

use super::Mission;
use super::account::{Ending, Flight, Leg, LegKind, MissionError, Moment, Turn};
use super::controller::Controller;
use super::course::{ALTIMETER, Course, GROUNDED, INFLECTION, MAX_DEPTH, Phase, UPPER_END, WAY_DONE};
use super::spent::Spent;
use crate::dynamics::limits::N_EVENTS;
use crate::dynamics::{Actuation, Advance, Glider, Integrator, Parameters, State, Surroundings};
use crate::simulate::row;

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
        let next_change = pilot.next_look_s.min(pilot.next_order_s()).min(mission.duration_s);
        let (mut time, mut state) = (pilot.time_s, pilot.state);
        let advance =
            integrator.follow(&pilot.course, &mut time, &mut state, next_row.min(next_change), next_change)?;
        pilot.spent.carried(time - pilot.time_s, [pilot.state.depth_m, state.depth_m]);
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
            glidepolar_progress::one_more("rows");
            rows += 1.0;
            if !on_moment(&pilot.moment()) {
                return Ok(pilot.end(Ending::Stopped));
            }
        }
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
    spent: Spent,
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
            creep_pressure_Pa: 0.0,
            carried_density_kg_m3: 0.0,
            late_temperature_K: 0.0,
            leaked_back_m3: 0.0,
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
            spent: Spent::new(),
        };
        // What it carries, and what is slow in its hull, is as the water in which it starts.
        let inputs = pilot.course.inputs(pilot.time_s, &pilot.state);
        let water = Surroundings {
            density_kg_m3: inputs.water_density_kg_m3,
            pressure_Pa: 0.0,
            temperature_C: inputs.water_temperature_C,
            time_s: 0.0,
        };
        pilot.state.carried_density_kg_m3 = p.carried_from_kg_m3(&water);
        pilot.state.late_temperature_K = p.warmer_than_reference_K(&water);
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
                Turn::Surfaced => {
                    self.state.energy_J += self.spent.surfaced(self.course.parameters);
                    Phase::AtSurface { until_s: self.time_s + surfacing.stay_s }
                }
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
        self.spent.moved(self.course.parameters, self.course.moving_mass_m, position_m);
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
        let inputs = self.course.inputs(self.time_s, &self.state);
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
        Flight {
            ending,
            duration_s: self.time_s,
            distance_m: self.state.x_m,
            legs: self.legs,
            pumpings: self.pumpings,
            pitch_moves: self.pitch_moves,
            groundings: self.groundings,
            energy: self.spent.energy(self.course.parameters, self.state.energy_J, None),
        }
    }
}
