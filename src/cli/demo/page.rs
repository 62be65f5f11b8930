//! The demonstration's page.

use serde_json::Value;

use super::flight::{Dive, Flight};
use super::{Demonstration, HULL, Hidden};
use crate::cli::diagnose_words::words;
use crate::report::{Axis, Block, Cell, Dash, Figure, Layer, Panel, Report, Section, Table, significant};

/// What the page shows.
pub(super) struct Shown<'a> {
    pub result: &'a Demonstration<'a>,
    pub tank: &'a Value,
    /// True a, b, c, d of the hull.
    pub tank_truth: Option<[f64; 4]>,
    pub diagnosis: &'a Value,
    pub dive: &'a Dive,
    pub before: &'a Flight,
    pub after: &'a Flight,
    pub commands: Vec<String>,
}

/// The page.
pub(super) fn of(shown: &Shown) -> Report {
    let mut page = Report::new("From the towing tank to the FMU", "synthetic data with known truth");
    page.findings = findings(shown);
    page.section(tank(shown)).section(flight(shown)).section(held_out(shown)).section(
        Section::new("The commands")
            .text("In the folder of this page, in this order:")
            .block(Block::Code(shown.commands.join("\n"))),
    )
}

/// The results in a few sentences.
pub(super) fn findings(shown: &Shown) -> Vec<String> {
    let result = shown.result;
    let named = |causes: &Value| match sizes(causes).as_slice() {
        [] => "nothing is named".to_owned(),
        sizes => sizes.join(", "),
    };
    let truth = |hidden: &[Hidden]| {
        let texts = hidden.iter().map(|hidden| format!("{} {}", hidden.parameter, significant(hidden.value, 3)));
        texts.collect::<Vec<_>>().join(", ")
    };
    let (before, after) = (&result.before, &result.after);
    vec![
        format!("Towing tank: {}. Hidden: {}.", named(result.tank), truth(std::slice::from_ref(&result.tank_hidden))),
        format!("Flight log: {}. Hidden: {}.", named(result.causes), truth(&result.hidden)),
        format!(
            "Held-out dive {}: the vehicle as its file has it is {:.1} m off in depth and {:.1} mm/s in vertical velocity (rms), the extended \
             vehicle {:.1} m and {:.1} mm/s.",
            result.held_out_dive,
            before.depth_rms_m,
            before.vertical_velocity_rms_m_s * 1e3,
            after.depth_rms_m,
            after.vertical_velocity_rms_m_s * 1e3
        ),
    ]
}

/// Each cause with its sizes, as text.
fn sizes(causes: &Value) -> Vec<String> {
    let causes = causes.as_array().into_iter().flatten();
    causes
        .map(|cause| {
            let parameters = cause["parameters"].as_object().into_iter().flatten();
            let sizes: Vec<String> = parameters.map(|(_, quantity)| quantity_text(quantity)).collect();
            format!("{} {}", words(cause["cause"].as_str().unwrap_or_default()), sizes.join(", "))
        })
        .collect()
}

fn quantity_text(quantity: &Value) -> String {
    let number = |key: &str| quantity[key].as_f64().unwrap_or(f64::NAN);
    let unit = match quantity["unit"].as_str().unwrap_or_default() {
        "1" => "",
        unit => unit,
    };
    format!("{} {unit}", Cell::estimate(number("value"), number("se"))).trim_end().to_owned()
}

fn tank(shown: &Shown) -> Section {
    let hull = &shown.tank["hulls"][0];
    let columns = ["Coefficient", "Reduced", "Corrected", "True"];
    let corrected = &hull["extended"];
    let mut table = Table::new(
        format!(
            "Coefficients of {HULL} on the frontal area, with standard errors; corrected: with what the diagnosis names taken out."
        ),
        columns,
    );
    for (i, name) in ["a", "b", "c", "d"].into_iter().enumerate() {
        let of = |fit: &Value| if fit[name].is_object() { quantity_text(&fit[name]) } else { String::new() };
        let truth = shown.tank_truth.map_or(String::new(), |truth| significant(truth[i], 4));
        table =
            table.row([Cell::from(name), Cell::from(of(&hull["fit"])), Cell::from(of(corrected)), Cell::from(truth)]);
    }
    Section::new("In the tank")
        .text(format!(
            "A virtual towing tank with a balance that stands askew: raw runs of one hull, {HULL}, are reduced to lift, drag and moment and \
             diagnosed."
        ))
        .table(table)
        .block(Block::Links(vec![("The report of the hull test".to_owned(), "tank/report.html".to_owned())]))
}

fn flight(shown: &Shown) -> Section {
    let mut section = Section::new("At sea").text(
        "A flight log from a virtual sea, made by equations of its own. The vehicle file does not know what is wrong with the glider. The \
         diagnosis says what the steady glide gets wrong, and why.",
    );
    let wrong: Vec<&Value> = shown.diagnosis["wrong"].as_array().into_iter().flatten().collect();
    if !wrong.is_empty() {
        let mut table = Table::new(
            "What the vehicle of the file gets wrong.",
            ["Quantity", "Depends on", "By, rms [mm/s]", "The measurement explains [mm/s]"],
        );
        for row in wrong {
            let mm_s = |key: &str| Cell::fixed(row[key].as_f64().unwrap_or(f64::NAN) * 1e3, 2);
            let text = |key: &str| Cell::from(words(row[key].as_str().unwrap_or_default()));
            table = table.row([text("quantity"), text("regime"), mm_s("size"), mm_s("expected_rms")]);
        }
        section = section.table(table);
    }
    let mut table = Table::new("What the diagnosis names, and what was hidden.", ["", "Size"]);
    for cause in sizes(shown.result.causes) {
        table = table.row([Cell::from("named"), Cell::from(cause)]);
    }
    for hidden in &shown.result.hidden {
        let text = format!("{} {}", hidden.parameter, significant(hidden.value, 4));
        table = table.row([Cell::from("hidden"), Cell::from(text)]);
    }
    section.table(table).block(Block::Links(vec![
        ("The report of the diagnosis".to_owned(), "diagnosis/report.html".to_owned()),
        ("The extended vehicle".to_owned(), "extended.toml".to_owned()),
    ]))
}

fn held_out(shown: &Shown) -> Section {
    let minutes = |time_s: &[f64]| time_s.iter().map(|t| t / 60.0).collect::<Vec<f64>>();
    let (dive, before, after) = (shown.dive, shown.before, shown.after);
    let curves = [
        ("measured", &dive.time_s, &dive.depth_m, Dash::Solid),
        ("vehicle of the file", &before.time_s, &before.depth_m, Dash::Dotted),
        ("extended vehicle", &after.time_s, &after.depth_m, Dash::Dashed),
    ];
    let depth = curves.iter().fold(Panel::new(Axis::new("Depth", "z", "m").reversed()), |panel, curve| {
        let (label, time_s, depth_m, dash) = *curve;
        panel.layer(Layer::line(minutes(time_s), depth_m.clone()).label(label).dash(dash))
    });
    let less = Panel::new(Axis::new("Less measured", "Δz", "m")).layer(Layer::at_y(0.0));
    let less = curves[1..].iter().fold(less, |panel, curve| {
        let (label, time_s, depth_m, dash) = *curve;
        let less = dive.less_measured(time_s, depth_m);
        panel.layer(Layer::line(minutes(&dive.time_s), less).label(label).dash(dash))
    });
    let figure = Figure::new("held-out", Axis::new("Time", "t", "min")).panel(depth).panel(less).caption(
        "A dive that the diagnosis has not read: measured, and flown with the same ballast, pitch and water by both vehicles; below, \
         their depths less the measured one.",
    );
    let by = if shown.result.flown_by_fmpy {
        "The extended vehicle was flown by FMPy from Extended.fmu, as any importer of FMUs would."
    } else {
        "No Python with FMPy was found (pip install fmpy), so that the FMU's equations were flown without the FMU. Extended.fmu is in this \
         folder."
    };
    Section::new("The held-out dive").text(by).figure(figure)
}
