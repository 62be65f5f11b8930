//! The glider in the vertical plane: rows of values to the library's states, inputs and parameters, and back.

use glidepolar_dynamics::glide::{Start, start_in};
use glidepolar_dynamics::limits::{self, N_EVENTS};
use glidepolar_dynamics::{
    self as dynamics, Actuation, Inputs, N_STATES, Parameters, State, next_bend_s, servo_corners,
};
use glidepolar_environment::WaterAt;
use glidepolar_number::Number;

use super::rules::{Glider, Rules};
use super::table::output_array;
use super::values::{MOST_EVENTS, MOST_OUTPUTS, MOST_STATES, Values, head, row};

/// The magnitudes of the states.
pub const NOMINALS: [f64; N_STATES] = State::NOMINALS;

/// State and inputs of these values, and the parameters that the equations must see.
struct Parts<T> {
    active: Parameters<T>,
    state: State<T>,
    inputs: Inputs<T>,
}

fn parts<T: Number>(rules: &Rules<'_>, values: &Values<T>) -> Parts<T> {
    Parts {
        active: rules.active(&Parameters::from_array(head(&values.parameters))),
        state: State::from_array(head(&values.state)),
        inputs: Inputs::from_array(head(&values.inputs)),
    }
}

impl Rules<'_> {
    /// The inputs, with the water of the column at this depth where there is one.
    pub(super) fn in_plane<T: Number>(&self, state: &State<T>, inputs: &Inputs<T>) -> Inputs<T> {
        match self.water(state.depth_m) {
            None => *inputs,
            Some(WaterAt { density_kg_m3, temperature_C }) => {
                Inputs { water_density_kg_m3: density_kg_m3, water_temperature_C: temperature_C, ..*inputs }
            }
        }
    }

    /// Rates of change of the state, from parameters made once: the right-hand side of an integrator.
    pub(super) fn rates_in_plane<T: Number>(
        &self,
        active: &Parameters<T>,
        time_s: T,
        state: &State<T>,
        inputs: &Inputs<T>,
    ) -> State<T> {
        let inputs = self.in_plane(state, inputs);
        dynamics::derivative(active, self.actuation, self.discrete.modes, time_s, state, &inputs)
    }

    /// Functions whose change of sign is an event.
    pub(super) fn indicators_in_plane<T: Number>(
        &self,
        active: &Parameters<T>,
        time_s: T,
        state: &State<T>,
        inputs: &Inputs<T>,
    ) -> [T; N_EVENTS] {
        let inputs = self.in_plane(state, inputs);
        let mut z = limits::event_indicators(active, self.actuation, self.discrete.modes, time_s, state, &inputs);
        self.past_boundaries(&mut z);
        z
    }

    /// When the rates will bend, as far as that can be foreseen.
    pub(super) fn bend_in_plane(
        &self,
        active: &Parameters<f64>,
        time_s: f64,
        state: &State<f64>,
        inputs: &Inputs<f64>,
    ) -> Option<f64> {
        next_bend_s(active, self.actuation, time_s, state, inputs)
    }
}

/// Rates of change of the state.
pub(super) fn derivative<T: Number>(rules: &Rules<'_>, values: &Values<T>) -> [T; MOST_STATES] {
    let Parts { active, state, inputs } = parts(rules, values);
    row(rules.rates_in_plane(&active, values.time_s, &state, &inputs).as_array())
}

/// The indicators that an importer's integrator watches. A servo never reaches the ends of ballast and moving mass; in
/// their places stand its own corners, where the rates of change have a kink.
pub(super) fn published_indicators<T: Number>(rules: &Rules<'_>, values: &Values<T>) -> [T; MOST_EVENTS] {
    let Parts { active, state, inputs } = parts(rules, values);
    let mut z = rules.indicators_in_plane(&active, values.time_s, &state, &inputs);
    if rules.actuation == Actuation::Servo {
        z[2..].copy_from_slice(&servo_corners(&active, &state, &inputs));
        rules.corners.shift(&mut z[2..]);
    }
    row(z)
}

/// The corners of both servos.
pub(super) fn corners(rules: &Rules<'_>, values: &Values<f64>) -> [f64; 4] {
    let Parts { active, state, inputs } = parts(rules, values);
    servo_corners(&active, &state, &inputs)
}

/// The outputs, in the order of the table.
pub(super) fn outputs<T: Number>(rules: &Rules<'_>, values: &Values<T>) -> [T; MOST_OUTPUTS] {
    let Parts { active, state, inputs } = parts(rules, values);
    let inputs = rules.in_plane(&state, &inputs);
    row(output_array(&dynamics::outputs(&active, values.time_s, &state, &inputs), &inputs))
}

/// The moving mass starts at its height, at rest in the hull.
pub(super) fn complete_start<T: Number>(values: &mut Values<T>) {
    let p = Parameters::from_array(head(&values.parameters));
    let mut s = State::from_array(head(&values.state));
    s.moving_mass_3_m = p.moving_mass_height_m;
    s.momentum_1_kg_m_s = p.moving_mass_kg * (s.v1_m_s + s.moving_mass_3_m * s.pitch_rate_rad_s);
    s.momentum_3_kg_m_s = p.moving_mass_kg * (s.v3_m_s - s.moving_mass_1_m * s.pitch_rate_rad_s);
    values.state = row(s.as_array());
}

/// The steady glide down of these parameters, in the water at this depth, if there is one.
pub(super) fn glide(glider: &Glider) -> Option<Start> {
    let Parts { active: _, state, inputs } = parts(&glider.rules(), &glider.values);
    let water = glider.rules().in_plane(&state, &inputs);
    let glide = start_in(&glider.parameters(), |_| WaterAt {
        density_kg_m3: water.water_density_kg_m3,
        temperature_C: water.water_temperature_C,
    });
    (!glide.is_at_rest()).then_some(glide)
}

/// Puts the glider on its glide, if it has one. Where, how deep and how much energy was drawn stays.
pub(super) fn trim(glider: &mut Glider) {
    let Some(glide) = glide(glider) else { return };
    // Where it is and what it has been through is not for the glide to say.
    let State {
        x_m,
        depth_m,
        energy_J,
        creep_pressure_Pa,
        carried_density_kg_m3,
        late_temperature_K,
        leaked_back_m3,
        ..
    } = State::from_array(head(&glider.values.state));
    let memory = State { creep_pressure_Pa, carried_density_kg_m3, late_temperature_K, leaked_back_m3, ..glide.state };
    glider.values.state = row(State { x_m, depth_m, energy_J, ..memory }.as_array());
    let mut inputs = Inputs::from_array(head(&glider.values.inputs));
    inputs.ballast_command_m3 = glide.inputs.ballast_command_m3;
    inputs.moving_mass_command_m = glide.inputs.moving_mass_command_m;
    glider.values.inputs = row(inputs.as_array());
}

/// Brings modes and state in line with everything else. Returns the depth of the seabed \[m\].
pub(super) fn settle(glider: &mut Glider) -> f64 {
    let rules = glider.rules();
    let Parts { active, state, inputs } = parts(&rules, &glider.values);
    let in_water = rules.in_plane(&state, &inputs);
    let (modes, state) =
        limits::apply(&active, rules.actuation, rules.discrete.modes, glider.values.time_s, &state, &in_water);
    glider.discrete.modes = modes;
    glider.values.state = row(state.as_array());
    inputs.seabed_depth_m
}

/// The glider at its start in this water, with the commands that hold it.
pub(super) fn start(parameters: &Parameters<f64>, water: impl Fn(f64) -> WaterAt<f64>) -> Values<f64> {
    let start = start_in(parameters, water);
    Values {
        parameters: row(parameters.as_array()),
        time_s: 0.0,
        state: row(start.state.as_array()),
        inputs: row(start.inputs.as_array()),
    }
}
