//! The equations in space with the present set-points, in the water and over the seabed of a mission. Makes no decision.

use glidepolar_ode::{Slopes, System};

use super::course::Phase;
use super::{Mission, Profile};
use crate::Number;
use crate::spatial::glider::{FIRST_FELT, N_FELT, N_MEMORY, NOMINAL_VALUES, slopes};
use crate::spatial::{Body, Inputs, N_STATES, State, derivative, next_bend_s};

/// Events: the lower turn, the upper end, the seabed.
pub(super) const LOWER: usize = 0;
pub(super) const UPPER: usize = 1;
pub(super) const SEABED: usize = 2;
pub(super) const N_EVENTS: usize = 3;

/// The equations with the orders that hold, in the water and over the seabed of the mission.
pub(super) struct Course<'a> {
    pub(super) body: Body<f64>,
    pub(super) mission: &'a Mission,
    pub(super) orders: Orders,
    pub(super) phase: Phase,
    /// Way over ground, by which the seabed is known \[m\].
    pub(super) way_m: f64,
}

/// Set-points of ballast, moving mass, roll mass and rudder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Orders {
    pub(super) ballast_m3: f64,
    pub(super) moving_mass_m: f64,
    pub(super) roll_mass_rad: f64,
    pub(super) rudder_rad: f64,
}

impl Course<'_> {
    pub(super) fn inputs<T: Number>(&self, state: &State<T>) -> Inputs<T> {
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
        self.body.plane.next_step_s(time_s)
    }

    fn next_bend_s(&self, time_s: f64, state: &[f64; N_STATES]) -> Option<f64> {
        let state = State::from_array(*state);
        next_bend_s(&self.body, time_s, &state, &self.inputs(&state))
    }
}
