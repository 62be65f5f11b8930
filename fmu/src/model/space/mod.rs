//! The glider in six degrees of freedom: rows of values to the library's states, inputs and body, and back.

pub mod table;

use glidepolar_dynamics::Parameters;
use glidepolar_dynamics::glide::{Start, start_in};
use glidepolar_dynamics::parameters::N_PARAMETERS;
use glidepolar_environment::WaterAt;
use glidepolar_number::Number;
use glidepolar_spatial::{self as spatial, Body, Inputs, Lateral, State, servo_corners};

use super::rules::{Glider, Rules};
use super::values::{MOST_EVENTS, MOST_OUTPUTS, MOST_PARAMETERS, MOST_STATES, Values, head, row};

/// Surface, seabed, and the corners of the four servos.
pub const N_EVENTS: usize = spatial::glider::N_EVENTS + 8;

/// State and inputs of these values, and the body that the equations must see.
struct Parts<T> {
    body: Body<T>,
    state: State<T>,
    inputs: Inputs<T>,
}

fn parts<T: Number>(rules: &Rules<'_>, values: &Values<T>) -> Parts<T> {
    Parts {
        body: rules.body(&values.parameters),
        state: State::from_array(head(&values.state)),
        inputs: Inputs::from_array(head(&values.inputs)),
    }
}

impl Rules<'_> {
    /// The body as the equations must see it until the next event.
    pub(super) fn body<T: Number>(&self, parameters: &[T; MOST_PARAMETERS]) -> Body<T> {
        let plane = self.active(&Parameters::from_array(head(parameters)));
        let lateral = Lateral::from_array(std::array::from_fn(|i| parameters[N_PARAMETERS + i]));
        Body { plane, lateral, rate_law: self.rate_law }
    }

    /// The inputs with what steers, and the water of the column at this depth where there is one.
    pub(super) fn in_space<T: Number>(&self, body: &Body<T>, state: &State<T>, inputs: &Inputs<T>) -> Inputs<T> {
        let inputs = self.steering.steered(body, state, inputs);
        match self.water(state.depth_m) {
            None => inputs,
            Some(WaterAt { density_kg_m3, temperature_C }) => {
                Inputs { water_density_kg_m3: density_kg_m3, water_temperature_C: temperature_C, ..inputs }
            }
        }
    }

    /// Functions of the depth whose change of sign is an event.
    pub(super) fn boundaries<T: Number>(&self, state: &State<T>, inputs: &Inputs<T>) -> [T; spatial::glider::N_EVENTS] {
        let mut z = [state.depth_m, inputs.seabed_depth_m - state.depth_m];
        self.past_boundaries(&mut z);
        z
    }
}

/// Rates of change of the state.
pub(super) fn derivative<T: Number>(rules: &Rules<'_>, values: &Values<T>) -> [T; MOST_STATES] {
    let Parts { body, state, inputs } = parts(rules, values);
    row(spatial::derivative(&body, values.time_s, &state, &rules.in_space(&body, &state, &inputs)).as_array())
}

/// The indicators that an importer's integrator watches: beside surface and seabed the corners of the servos, where the
/// rates of change have a kink.
pub(super) fn published_indicators<T: Number>(rules: &Rules<'_>, values: &Values<T>) -> [T; MOST_EVENTS] {
    let Parts { state, inputs, .. } = parts(rules, values);
    let ([surface, seabed], mut corners) = (rules.boundaries(&state, &inputs), corners(rules, values));
    rules.corners.shift(&mut corners);
    std::array::from_fn(|i| match i {
        0 => surface,
        1 => seabed,
        i => corners[i - 2],
    })
}

/// The corners of the four servos.
pub(super) fn corners<T: Number>(rules: &Rules<'_>, values: &Values<T>) -> [T; 8] {
    let Parts { body, state, inputs } = parts(rules, values);
    servo_corners(&body, &state, &rules.in_space(&body, &state, &inputs))
}

/// The outputs, in the order of the table.
pub(super) fn outputs<T: Number>(rules: &Rules<'_>, values: &Values<T>) -> [T; MOST_OUTPUTS] {
    let Parts { body, state, inputs } = parts(rules, values);
    let inputs = rules.in_space(&body, &state, &inputs);
    row(table::output_array(&spatial::outputs(&body, values.time_s, &state, &inputs), &inputs))
}

/// The steady straight glide down of these parameters, in the water at this depth, if there is one.
pub(super) fn glide(glider: &Glider) -> Option<Start> {
    let rules = glider.rules();
    let Parts { body, state, inputs } = parts(&rules, &glider.values);
    let water = rules.in_space(&body, &state, &inputs);
    let glide = start_in(&glider.parameters(), |_| WaterAt {
        density_kg_m3: water.water_density_kg_m3,
        temperature_C: water.water_temperature_C,
    });
    (!glide.is_at_rest()).then_some(glide)
}

/// Puts the glider on its glide, if it has one. Where it is, where it heads and what it has been through stays.
pub(super) fn trim(glider: &mut Glider) {
    let Some(glide) = glide(glider) else { return };
    let before = State::from_array(head(&glider.values.state));
    glider.values.state = row(State {
        north_m: before.north_m,
        east_m: before.east_m,
        depth_m: before.depth_m,
        heading_rad: before.heading_rad,
        creep_pressure_Pa: before.creep_pressure_Pa,
        carried_density_kg_m3: before.carried_density_kg_m3,
        late_temperature_K: before.late_temperature_K,
        leaked_back_m3: before.leaked_back_m3,
        energy_J: before.energy_J,
        ..State::in_glide(&glide.state)
    }
    .as_array());
    let mut inputs = Inputs::from_array(head(&glider.values.inputs));
    inputs.ballast_command_m3 = glide.inputs.ballast_command_m3;
    inputs.moving_mass_command_m = glide.inputs.moving_mass_command_m;
    glider.values.inputs = row(inputs.as_array());
}

/// Depth of the seabed \[m\].
pub(super) fn seabed_depth_m(glider: &Glider) -> f64 {
    Inputs::from_array(head(&glider.values.inputs)).seabed_depth_m
}

/// The glider at its start in this water, heading north, with the commands that hold it.
pub(super) fn start(body: &Body<f64>, water: impl Fn(f64) -> WaterAt<f64>) -> Values<f64> {
    let start = start_in(&body.plane, water);
    let mut parameters = row(body.plane.as_array());
    parameters[N_PARAMETERS..].copy_from_slice(&body.lateral.as_array());
    let state = State::in_glide(&start.state);
    Values {
        parameters,
        time_s: 0.0,
        state: row(state.as_array()),
        inputs: row(Inputs::in_glide(&start.inputs).as_array()),
    }
}
