//! The water, the seabed and the orders that hold, as one system of equations with the events that end a phase.
//! Decides nothing: the [pilot](super::flight) does.

use super::{Mission, Profile};
use crate::Number;
use crate::dynamics::integrate::Jet;
use crate::dynamics::limits::N_EVENTS;
use crate::dynamics::{Actuation, Inputs, Modes, Parameters, State, derivative, integrate, next_bend_s};

/// The equations of motion with the orders that hold, in the water and over the seabed of the mission.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course<'a> {
    pub parameters: &'a Parameters<f64>,
    pub mission: &'a Mission,
    pub ballast_m3: f64,
    pub moving_mass_m: f64,
    pub phase: Phase,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Phase {
    Descending,
    Climbing { to_surface: bool },
    AtSurface { until_s: f64 },
}

/// The event indicators of a course.
pub(super) const MAX_DEPTH: usize = 0;
pub(super) const ALTIMETER: usize = 1;
pub(super) const GROUNDED: usize = 2;
pub(super) const INFLECTION: usize = 3;
pub(super) const UPPER_END: usize = 4;
pub(super) const WAY_DONE: usize = 5;

impl Course<'_> {
    /// What acts on the glider. A current that changes with depth or tide accelerates it: what the equations read of that
    /// is the slope of the profile and the rate of the tide.
    pub(super) fn inputs<T: Number>(&self, time_s: T, state: &State<T>) -> Inputs<T> {
        let (p, m) = (self.parameters, self.mission);
        let turn_per_s = std::f64::consts::TAU / m.tide.period_s;
        let (sin, cos) = ((time_s - m.tide.most_at_s) * turn_per_s).sin_cos();
        let at = |profile: &Option<Profile>, otherwise: f64| {
            profile.as_ref().map_or(T::constant(otherwise), |it| it.at(state.depth_m))
        };
        Inputs {
            ballast_command_m3: T::constant(self.ballast_m3),
            moving_mass_command_m: T::constant(self.moving_mass_m),
            current_x_m_s: m.current.at(state.depth_m) + cos * m.tide.along_m_s,
            current_x_shear_1_s: T::constant(m.current.slope(state.depth_m.value())),
            current_x_rate_m_s2: -sin * (m.tide.along_m_s * turn_per_s),
            water_density_kg_m3: at(&m.density, p.reference_density_kg_m3),
            water_temperature_C: at(&m.temperature, p.reference_temperature_C),
            seabed_depth_m: m.seabed.at(state.x_m),
            ..Inputs::still_water(0.0, 0.0).map(T::constant)
        }
    }
}

impl integrate::System for Course<'_> {
    fn derivative(&self, time_s: f64, state: &State<f64>) -> State<f64> {
        derivative(self.parameters, Actuation::Servo, Modes::default(), time_s, state, &self.inputs(time_s, state))
    }

    fn linearised(&self, time_s: Jet, state: &State<Jet>) -> State<Jet> {
        let parameters = self.parameters.map(Jet::constant);
        derivative(&parameters, Actuation::Servo, Modes::default(), time_s, state, &self.inputs(time_s, state))
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
        self.parameters.next_step_s(time_s)
    }

    fn next_bend_s(&self, time_s: f64, state: &State<f64>) -> Option<f64> {
        next_bend_s(self.parameters, Actuation::Servo, time_s, state, &self.inputs(time_s, state))
    }
}
