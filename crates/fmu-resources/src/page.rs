//! The figures on the page inside an FMU that go by its vehicle: what the page's prose says of the start, and the form in
//! which its tables write a start value. One source for the page that is generated and for one that is filled anew when a
//! vehicle is packed. Knows nothing of archives.

use glidepolar_dynamics::glide::{Start, SteadyGlide, at_path};
use glidepolar_dynamics::integrate::{Advance, DEFAULT_TOLERANCE, IntegrationError, Integrator, Jet, System};
use glidepolar_dynamics::limits::N_EVENTS;
use glidepolar_dynamics::{Actuation, Glider, Inputs, Outputs, Parameters, State, Surroundings, derivative, outputs};
use glidepolar_environment::WaterColumn;
use glidepolar_number::Number;

/// What marks a place of the prose: `<span data-fill="KEY">`.
pub const PROSE_MARK: &str = "data-fill";

/// What marks the cell of a start value in a table: `<td ... data-start="VARIABLE">`.
pub const CELL_MARK: &str = "data-start";

/// Every place of the prose by its key, for a vehicle in its start, in the water of the column where one travels along;
/// the page shows a run of `stop_s`.
pub fn figures(
    parameters: &Parameters<f64>,
    start: &Start,
    column: Option<&WaterColumn>,
    stop_s: f64,
) -> [(&'static str, String); 6] {
    let inputs = &start.inputs;
    let out = outputs(parameters, 0.0, &start.state, inputs);
    let up = mirrored(parameters, start, &out);
    let to_turn = match &up {
        Some(up) => format!(
            "To turn, give the opposite commands: ballast {:.4e} m³ and moving mass {:.5} m make the glide upward that mirrors the start.",
            up.ballast_m3, up.moving_mass_m
        ),
        None => "No glide upward mirrors the start within the limits of ballast and moving mass.".to_owned(),
    };
    let up = up.map_or((inputs.ballast_command_m3, 0.0), |up| (up.ballast_m3, up.moving_mass_m));
    [
        ("first_run", first_run(parameters, start, &out, column, stop_s)),
        ("to_turn", to_turn),
        ("down_ballast", format!("{:.4e}", inputs.ballast_command_m3)),
        ("down_mass", format!("{:.5}", inputs.moving_mass_command_m)),
        ("up_ballast", format!("{:.4e}", up.0)),
        ("up_mass", format!("{:.5}", up.1)),
    ]
}

/// The longest run that the page tells the end of \[s\]: a day.
const LONGEST_RUN_S: f64 = 86_400.0;

/// What the simulation does when it is left alone.
fn first_run(
    parameters: &Parameters<f64>,
    start: &Start,
    out: &Outputs<f64>,
    column: Option<&WaterColumn>,
    stop_s: f64,
) -> String {
    let (state, seabed) = (&start.state, start.inputs.seabed_depth_m);
    let (depth, sink) = (state.depth_m, out.vertical_velocity_m_s);
    let mut prose = if start.is_at_rest() {
        format!(
            "This vehicle has no steady glide down within its limits: the simulation starts {depth} m deep, level and at rest, with a transient as ballast and moving mass go to their set-points."
        )
    } else {
        format!(
            "The simulation starts {depth} m deep in a steady glide down: pitch {:.1} deg, path angle {:.1} deg, {:.2} m/s through the water, so that a coupled simulation begins without a transient. Depth grows by {sink:.3} m/s at first.",
            state.pitch_rad.to_degrees(),
            out.glide_angle_rad.to_degrees(),
            out.speed_m_s
        )
    };
    // Whoever wants a longer run does not look for its end on a page; a template may ask for any.
    if stop_s > LONGEST_RUN_S {
        return prose;
    }
    let Ok(end) = left_alone(parameters, start, column, stop_s) else {
        return prose;
    };
    prose += &format!(" Left alone, it is {:.1} m deep after {stop_s} s", end.depth_m);
    // To the last figure that is shown.
    if (end.depth_m - depth - sink * stop_s).abs() < 0.05 && !start.is_at_rest() {
        prose + &format!(", and goes on like that to the seabed ({seabed} m).")
    } else if start.is_at_rest() {
        prose + "."
    } else {
        prose + ": with depth, water and hull change what carries it."
    }
}

/// The state after a run with the commands of the start.
fn left_alone(
    parameters: &Parameters<f64>,
    start: &Start,
    column: Option<&WaterColumn>,
    stop_s: f64,
) -> Result<State<f64>, IntegrationError> {
    /// More than a hull that bounces on the seabed meets.
    const MOST_EVENTS: usize = 1000;
    let glider = InWater { glider: Glider::new(*parameters, Actuation::Servo, start.inputs), column };
    let (mut time, mut state, mut integrator) = (0.0, start.state, Integrator::new(DEFAULT_TOLERANCE));
    for _ in 0..MOST_EVENTS {
        if integrator.advance(&glider, &mut time, &mut state, stop_s)? == Advance::Reached {
            return Ok(state);
        }
    }
    Err(IntegrationError::StepTooSmall { time_s: time })
}

/// The glider in the water that the archive carries.
struct InWater<'a> {
    glider: Glider,
    column: Option<&'a WaterColumn>,
}

impl InWater<'_> {
    fn inputs<T: Number>(&self, state: &State<T>) -> Inputs<T> {
        let inputs = self.glider.inputs.map(T::constant);
        match self.column.map(|column| column.at(state.depth_m)) {
            None => inputs,
            Some(water) => {
                Inputs { water_density_kg_m3: water.density_kg_m3, water_temperature_C: water.temperature_C, ..inputs }
            }
        }
    }

    fn here(&self, state: &State<f64>) -> Glider {
        Glider { inputs: self.inputs(state), ..self.glider }
    }
}

impl System for InWater<'_> {
    fn derivative(&self, time_s: f64, state: &State<f64>) -> State<f64> {
        self.here(state).derivative(time_s, state)
    }

    fn linearised(&self, time_s: Jet, state: &State<Jet>) -> State<Jet> {
        let Glider { parameters, actuation, modes, .. } = &self.glider;
        derivative(&parameters.map(Jet::constant), *actuation, *modes, time_s, state, &self.inputs(state))
    }

    fn event_indicators(&self, time_s: f64, state: &State<f64>) -> [f64; N_EVENTS] {
        self.here(state).event_indicators(time_s, state)
    }

    fn next_jump_s(&self, time_s: f64) -> Option<f64> {
        self.glider.next_jump_s(time_s)
    }

    fn next_bend_s(&self, time_s: f64, state: &State<f64>) -> Option<f64> {
        self.here(state).next_bend_s(time_s, state)
    }
}

/// A number with six figures, anything else as it is.
pub fn short(value: &str) -> String {
    match value.parse::<f64>() {
        Ok(number) if value.len() > 9 => format!("{number:.5e}"),
        _ => value.to_owned(),
    }
}

/// The glide up that mirrors the one down, in the same water; none for a glider that starts at rest or cannot reach it.
fn mirrored(parameters: &Parameters<f64>, start: &Start, down: &Outputs<f64>) -> Option<SteadyGlide<f64>> {
    let p = parameters;
    if start.is_at_rest() {
        return None;
    }
    let density_kg_m3 = start.inputs.water_density_kg_m3;
    let water = Surroundings {
        density_kg_m3,
        pressure_Pa: p.true_density_kg_m3(density_kg_m3) * p.gravity_m_s2 * start.state.depth_m,
        temperature_C: start.inputs.water_temperature_C,
        time_s: 0.0,
    };
    at_path(p, &water, -down.glide_angle_rad, down.speed_m_s).ok().filter(|glide| glide.is_within_reach(p))
}
