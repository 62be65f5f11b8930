//! modelDescription.xml of FMI 3.0.

use super::fmi2::{causality, derivative_of, initial, variability};
use super::structure::structure;
use super::xml::{Document, flag, number, text};
use super::{AUTHOR, COPYRIGHT, DEFAULT_EXPERIMENT, GENERATED, LOG_CATEGORIES, start_value, used_units};
use crate::model::vehicle::Vehicle;
use crate::model::{Causality, Kind, Model, Table, Variability, Variable};

/// The model description with the start values of this vehicle.
pub fn model_description(vehicle: &Vehicle) -> String {
    let model = vehicle.glider.model;
    let table = model.table();
    let mut document = Document::new();
    document.open(
        "fmiModelDescription",
        &[
            ("fmiVersion", text("3.0")),
            ("modelName", text(model.name())),
            ("instantiationToken", text(table.token)),
            ("description", text(model.description())),
            ("version", text(env!("CARGO_PKG_VERSION"))),
            ("author", text(AUTHOR)),
            ("copyright", text(COPYRIGHT)),
            ("license", text("MIT OR Apache-2.0")),
            ("generationTool", text("glidepolar")),
            ("generationDateAndTime", text(GENERATED)),
            ("variableNamingConvention", text("structured")),
        ],
    );
    capabilities(&mut document, model);
    units(&mut document, table);
    types(&mut document, table);
    document.open("LogCategories", &[]);
    for (name, description) in LOG_CATEGORIES {
        document.leaf("Category", &[("name", text(name)), ("description", text(description))]);
    }
    document.close();
    let (stop, step, tolerance) = DEFAULT_EXPERIMENT;
    document.leaf(
        "DefaultExperiment",
        &[
            ("startTime", number(0.0)),
            ("stopTime", number(stop)),
            ("tolerance", number(tolerance)),
            ("stepSize", number(step)),
        ],
    );
    document.open("ModelVariables", &[]);
    for variable in table.rows {
        model_variable(&mut document, variable, vehicle);
    }
    document.close();
    model_structure(&mut document, model);
    document.finish()
}

fn capabilities(document: &mut Document, model: Model) {
    let common = [
        ("modelIdentifier", text(model.name())),
        ("canGetAndSetFMUState", flag(true)),
        ("canSerializeFMUState", flag(true)),
        ("providesDirectionalDerivatives", flag(true)),
        ("providesAdjointDerivatives", flag(true)),
    ];
    let with = |more: &[(&'static str, Option<String>)]| [common.as_slice(), more].concat();
    document.leaf("ModelExchange", &with(&[("needsCompletedIntegratorStep", text("false"))]));
    document.leaf(
        "CoSimulation",
        &with(&[
            ("canHandleVariableCommunicationStepSize", flag(true)),
            ("maxOutputDerivativeOrder", text("1")),
            ("providesIntermediateUpdate", flag(true)),
            ("mightReturnEarlyFromDoStep", flag(true)),
            ("canReturnEarlyAfterIntermediateUpdate", flag(true)),
            ("hasEventMode", flag(true)),
        ]),
    );
}

fn units(document: &mut Document, table: Table) {
    document.open("UnitDefinitions", &[]);
    for unit in used_units(table) {
        document.open("Unit", &[("name", text(unit.name))]);
        let mut base: Vec<_> = unit.base.iter().map(|(name, power)| (*name, text(power.to_string()))).collect();
        base.push(("factor", number(unit.factor).filter(|_| unit.factor != 1.0)));
        base.push(("offset", number(unit.offset).filter(|_| unit.offset != 0.0)));
        document.leaf("BaseUnit", &base);
        if let Some((name, factor)) = unit.display {
            document.leaf("DisplayUnit", &[("name", text(name)), ("factor", number(factor))]);
        }
        document.close();
    }
    document.close();
}

fn types(document: &mut Document, table: Table) {
    document.open("TypeDefinitions", &[]);
    for choice in table.choices() {
        let attributes = [("name", text(choice.name)), ("description", text(choice.description))];
        document.open("EnumerationType", &attributes);
        for (value, (name, meaning)) in choice.items.iter().enumerate() {
            let value = text(value.to_string());
            document.leaf("Item", &[("name", text(*name)), ("value", value), ("description", text(*meaning))]);
        }
        document.close();
    }
    document.close();
}

fn model_variable(document: &mut Document, variable: &Variable, vehicle: &Vehicle) {
    let may_say_initial = !matches!(variable.causality, Causality::Input | Causality::Independent);
    let reachable_inside_a_step = variable.variability == Variability::Continuous
        && matches!(variable.causality, Causality::Input | Causality::Output);
    let common = [
        ("name", text(variable.name)),
        ("valueReference", text(variable.reference.to_string())),
        ("description", text(variable.description)),
        ("causality", text(causality(variable.causality))),
        ("variability", text(variability(variable.variability))),
        ("intermediateUpdate", flag(reachable_inside_a_step)),
        ("initial", variable.initial.filter(|_| may_say_initial).map(|i| initial(i).to_owned())),
    ];
    let with = |more: &[(&'static str, Option<String>)]| [common.as_slice(), more].concat();
    let start = start_value(&vehicle.glider, &vehicle.name, variable);
    let integer = |bound: f64| Some((bound as i64).to_string());
    match variable.kind {
        Kind::Real => document.leaf(
            "Float64",
            &with(&[
                ("unit", variable.unit.and_then(|unit| text(unit.name))),
                ("displayUnit", variable.unit.and_then(|unit| unit.display).and_then(|(name, _)| text(name))),
                ("min", variable.bounds.and_then(|(min, _)| number(min))),
                ("max", variable.bounds.and_then(|(_, max)| number(max))),
                ("nominal", variable.nominal.and_then(number)),
                ("start", start),
                ("derivative", derivative_of(vehicle.glider.model.table(), variable).map(|state| state.to_string())),
                ("reinit", flag(variable.jumps)),
            ]),
        ),
        Kind::Integer => document.leaf(
            "Int32",
            &with(&[
                ("min", variable.bounds.and_then(|(min, _)| integer(min))),
                ("max", variable.bounds.and_then(|(_, max)| integer(max))),
                ("start", start),
            ]),
        ),
        Kind::Choice(choice) => {
            document.leaf("Enumeration", &with(&[("declaredType", text(choice.name)), ("start", start)]));
        }
        Kind::Boolean => document.leaf("Boolean", &with(&[("start", start)])),
        Kind::Text => document.leaf("String", &common),
    }
}

fn model_structure(document: &mut Document, model: Model) {
    let structure = structure(model);
    document.open("ModelStructure", &[]);
    for (name, unknowns) in [
        ("Output", structure.outputs),
        ("ContinuousStateDerivative", structure.derivatives),
        ("InitialUnknown", structure.initial),
        ("EventIndicator", structure.indicators),
    ] {
        for unknown in unknowns {
            let list = |references: Vec<u32>| references.iter().map(u32::to_string).collect::<Vec<_>>().join(" ");
            document.leaf(
                name,
                &[
                    ("valueReference", text(unknown.reference.to_string())),
                    ("dependencies", text(list(unknown.dependencies))),
                ],
            );
        }
    }
    document.close();
}
