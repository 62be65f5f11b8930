//! documentation/index.html: what a stranger needs to use the FMU, from the archive alone. The prose of both models stands
//! in `page.html`, everything that could differ from the code is filled in here.

use glidepolar_dynamics::glide::{Start, start};
use glidepolar_dynamics::integrate::{DEFAULT_TOLERANCE, IMPLICIT_FROM};
use glidepolar_fmu_resources::page::{CELL_MARK, PROSE_MARK, figures, short};

use super::xml::{escape, number};
use super::{DEFAULT_EXPERIMENT, start_value};
use crate::model::values::head;
use crate::model::vehicle::Vehicle;
use crate::model::{Causality, Model, Slot, Variability, Variable};

/// The prose of a model's page: the lines of the template after `<!-- both -->`, and those after the mark of this model.
fn template(model: Model) -> String {
    let (own, other) = match model {
        Model::Plane => ("<!-- plane -->", "<!-- space -->"),
        Model::Space => ("<!-- space -->", "<!-- plane -->"),
    };
    let mut page = String::new();
    let mut counts = true;
    for line in include_str!("page.html").lines() {
        match line {
            "<!-- both -->" => counts = true,
            mark if mark == own || mark == other => counts = mark == own,
            line if counts => page.extend([line, "\n"]),
            _ => (),
        }
    }
    page
}

/// The start in the plane, which the straight glide of every model is.
fn start_of(vehicle: &Vehicle) -> Start {
    let values = &vehicle.glider.values;
    match vehicle.glider.model {
        Model::Plane => Start {
            state: glidepolar_dynamics::State::from_array(head(&values.state)),
            inputs: glidepolar_dynamics::Inputs::from_array(head(&values.inputs)),
        },
        Model::Space => start(&vehicle.glider.parameters()),
    }
}

/// The page for this vehicle.
pub fn documentation(vehicle: &Vehicle) -> String {
    let (model, start) = (vehicle.glider.model, start_of(vehicle));
    let marked = |(key, value): (&'static str, String)| {
        // Marked, so that the figures can be filled anew when another vehicle is packed.
        (key, format!("<span {PROSE_MARK}=\"{key}\">{value}</span>"))
    };
    let figures = figures(&vehicle.glider.parameters(), &start, None, DEFAULT_EXPERIMENT.0);
    let fill = figures.into_iter().chain([("vehicle", escape(&vehicle.name))]).map(marked).chain([
        ("tolerance", format!("{DEFAULT_TOLERANCE:e}")),
        ("implicit_from", format!("{IMPLICIT_FROM:e}")),
        ("n_states", model.n_states().to_string()),
        ("n_events", model.n_events().to_string()),
        ("tables", tables(vehicle)),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("token", model.table().token.to_owned()),
        ("model", model.name().to_owned()),
    ]);
    let page = fill.fold(template(model), |page, (key, value)| {
        let place = format!("{{{{{key}}}}}");
        assert!(page.contains(&place), "the page has no place for {key}");
        page.replace(&place, &value)
    });
    assert!(!page.contains("{{"), "the page has a place that nothing fills");
    page
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
        for variable in vehicle.glider.model.table().rows.iter().filter(|variable| belongs(variable)) {
            let start = start_value(&vehicle.glider, &vehicle.name, variable).unwrap_or_default();
            let mark =
                if start.is_empty() { String::new() } else { format!(" {CELL_MARK}=\"{}\"", escape(variable.name)) };
            let (min, max) = variable.bounds.map_or((None, None), |(min, max)| (number(min), number(max)));
            html.push_str(&format!(
                "<tr><td class=\"n\">{}</td><td class=\"v\">{}</td><td>{}</td><td class=\"n\"{mark}>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td></tr>\n",
                variable.reference,
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
