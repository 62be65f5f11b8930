//! documentation/index.html: what a stranger needs to use the FMU, from the archive alone. The prose stands in
//! `page.html`, everything that could differ from the code is filled in here.

use glidepolar::dynamics::integrate::DEFAULT_TOLERANCE;
use glidepolar::dynamics::limits::N_EVENTS;
use glidepolar::dynamics::{N_STATES, Parameters, Surroundings};
use glidepolar::glide::{SteadyGlide, at_path};

use super::xml::{escape, number};
use super::{DEFAULT_EXPERIMENT, start_value};
use crate::model::table::{reference_of, token};
use crate::model::vehicle::Vehicle;
use crate::model::{Causality, Slot, Variability, Variable, variables};

const TEMPLATE: &str = include_str!("page.html");

/// The page for this vehicle.
pub fn documentation(vehicle: &Vehicle) -> String {
    let values = &vehicle.glider.values;
    let mut reading = vehicle.glider.read();
    let mut output = |name: &str| {
        let variable = variables().iter().find(|variable| variable.name == name).expect("a variable of the table");
        reading.real(variable.slot).expect("a number")
    };
    let (path_rad, speed, sink) = (output("glide_angle_rad"), output("speed_m_s"), output("vertical_velocity_m_s"));
    let up = mirrored(&values.parameters, path_rad, speed);
    let depth = values.state.depth_m;
    let fill = [
        ("vehicle", escape(&vehicle.name)),
        ("start_depth", format!("{depth}")),
        ("start_pitch", format!("{:.1}", values.state.pitch_rad.to_degrees())),
        ("start_path", format!("{:.1}", path_rad.to_degrees())),
        ("start_speed", format!("{speed:.2}")),
        ("start_sink", format!("{sink:.3}")),
        ("end_depth", format!("{:.0}", depth + sink * DEFAULT_EXPERIMENT.0)),
        ("seabed", format!("{}", values.inputs.seabed_depth_m)),
        ("down_ballast", format!("{:.4e}", values.inputs.ballast_command_m3)),
        ("down_mass", format!("{:.5}", values.inputs.moving_mass_command_m)),
        ("up_ballast", format!("{:.4e}", up.ballast_m3)),
        ("up_mass", format!("{:.5}", up.moving_mass_m)),
        ("tolerance", format!("{DEFAULT_TOLERANCE:e}")),
        ("n_states", N_STATES.to_string()),
        ("n_events", N_EVENTS.to_string()),
        ("tables", tables(vehicle)),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("token", token().to_owned()),
    ];
    let page = fill.iter().fold(TEMPLATE.to_owned(), |page, (key, value)| {
        let place = format!("{{{{{key}}}}}");
        assert!(page.contains(&place), "the page has no place for {key}");
        page.replace(&place, value)
    });
    assert!(!page.contains("{{"), "the page has a place that nothing fills");
    page
}

/// The glide up that mirrors the one down.
fn mirrored(parameters: &Parameters<f64>, path_rad: f64, speed_m_s: f64) -> SteadyGlide<f64> {
    let water = Surroundings {
        density_kg_m3: parameters.reference_density_kg_m3,
        pressure_Pa: 0.0,
        temperature_C: parameters.reference_temperature_C,
        time_s: 0.0,
    };
    at_path(parameters, &water, -path_rad, speed_m_s).expect("what glides down at this angle glides up at it")
}

type Group = (&'static str, fn(&Variable) -> bool);

const GROUPS: [Group; 8] = [
    ("Inputs", |v| v.causality == Causality::Input),
    ("Outputs", |v| v.causality == Causality::Output && !matches!(v.slot, Slot::State(_))),
    ("States", |v| matches!(v.slot, Slot::State(_))),
    ("Flags and stops", |v| matches!(v.slot, Slot::Discrete(_))),
    ("Fixed parameters", |v| v.causality == Causality::Parameter && v.variability == Variability::Fixed),
    ("Tunable parameters", |v| v.causality == Causality::Parameter && v.variability == Variability::Tunable),
    ("Derivatives of the states", |v| matches!(v.slot, Slot::Derivative(_))),
    ("Event indicators, time and name", |v| matches!(v.slot, Slot::Indicator(_) | Slot::Time | Slot::VehicleName)),
];

fn tables(vehicle: &Vehicle) -> String {
    let mut html = String::new();
    for (title, belongs) in GROUPS {
        html.push_str(&format!(
            "<h3>{title}</h3>\n<table>\n<tr><th>ref</th><th>name</th><th>unit</th><th>start</th><th>min</th><th>max</th><th>what it is</th></tr>\n"
        ));
        for variable in variables().iter().filter(|variable| belongs(variable)) {
            let start = start_value(&vehicle.glider, &vehicle.name, variable).unwrap_or_default();
            let (min, max) = variable.bounds.map_or((None, None), |(min, max)| (number(min), number(max)));
            html.push_str(&format!(
                "<tr><td class=\"n\">{}</td><td class=\"v\">{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td></tr>\n",
                reference_of(variable.slot),
                escape(variable.name),
                variable.unit.map_or("", |unit| unit.name),
                escape(&short(&start)),
                min.unwrap_or_default(),
                max.unwrap_or_default(),
                escape(variable.description),
            ));
        }
        html.push_str("</table>\n");
    }
    html
}

/// A number with six figures, anything else as it is.
fn short(value: &str) -> String {
    match value.parse::<f64>() {
        Ok(number) if value.len() > 9 => format!("{number:.5e}"),
        _ => value.to_owned(),
    }
}
