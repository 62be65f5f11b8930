//! The figures on the page inside an FMU that go by its vehicle: what the page's prose says of the start, and the form in
//! which its tables write a start value. One source for the page that is generated and for one that is filled anew when a
//! vehicle is packed. Knows nothing of archives.

use crate::dynamics::{Parameters, Surroundings, outputs};
use crate::glide::{Start, SteadyGlide, at_path};

/// What marks a place of the prose: `<span data-fill="KEY">`.
pub const PROSE_MARK: &str = "data-fill";

/// What marks the cell of a start value in a table: `<td ... data-start="VARIABLE">`.
pub const CELL_MARK: &str = "data-start";

/// Every figure of the prose by its key, for a vehicle in its start; the page shows a run of `stop_s`.
pub fn figures(parameters: &Parameters<f64>, start: &Start, stop_s: f64) -> [(&'static str, String); 12] {
    let (state, inputs) = (&start.state, &start.inputs);
    let out = outputs(parameters, 0.0, state, inputs);
    let up = mirrored(parameters, start, out.glide_angle_rad, out.speed_m_s);
    let up = up.map_or((0.0, 0.0), |glide| (glide.ballast_m3, glide.moving_mass_m));
    let (depth, sink) = (state.depth_m, out.vertical_velocity_m_s);
    [
        ("start_depth", format!("{depth}")),
        ("start_pitch", format!("{:.1}", state.pitch_rad.to_degrees())),
        ("start_path", format!("{:.1}", out.glide_angle_rad.to_degrees())),
        ("start_speed", format!("{:.2}", out.speed_m_s)),
        ("start_sink", format!("{sink:.3}")),
        ("stop", format!("{stop_s}")),
        ("end_depth", format!("{:.0}", depth + sink * stop_s)),
        ("seabed", format!("{}", inputs.seabed_depth_m)),
        ("down_ballast", format!("{:.4e}", inputs.ballast_command_m3)),
        ("down_mass", format!("{:.5}", inputs.moving_mass_command_m)),
        ("up_ballast", format!("{:.4e}", up.0)),
        ("up_mass", format!("{:.5}", up.1)),
    ]
}

/// A number with six figures, anything else as it is.
pub fn short(value: &str) -> String {
    match value.parse::<f64>() {
        Ok(number) if value.len() > 9 => format!("{number:.5e}"),
        _ => value.to_owned(),
    }
}

/// The glide up that mirrors the one down, in the same water; none for a glider that starts at rest.
fn mirrored(parameters: &Parameters<f64>, start: &Start, path_rad: f64, speed_m_s: f64) -> Option<SteadyGlide<f64>> {
    let p = parameters;
    let density_kg_m3 = start.inputs.water_density_kg_m3;
    let water = Surroundings {
        density_kg_m3,
        pressure_Pa: p.true_density_kg_m3(density_kg_m3) * p.gravity_m_s2 * start.state.depth_m,
        temperature_C: start.inputs.water_temperature_C,
        time_s: 0.0,
    };
    (speed_m_s > 0.0).then(|| at_path(p, &water, -path_rad, speed_m_s).ok()).flatten()
}
