//! modelDescription.xml of FMI 3.0.

use super::fmi2::{causality, derivative_of, initial, variability};
use super::structure::structure;
use super::xml::{Document, flag, number, text};
use super::{
    AUTHOR, COPYRIGHT, DEFAULT_EXPERIMENT, GENERATED, LOG_CATEGORIES, MODEL_DESCRIPTION, MODEL_NAME, start_value,
};
use crate::model::table::{CHOICES, reference_of, token};
use crate::model::units::UNITS;
use crate::model::vehicle::Vehicle;
use crate::model::{Causality, Kind, Variability, Variable, variables};

/// The model description with the start values of this vehicle.
pub fn model_description(vehicle: &Vehicle) -> String {
    let mut document = Document::new();
    document.open(
        "fmiModelDescription",
        &[
            ("fmiVersion", text("3.0")),
            ("modelName", text(MODEL_NAME)),
            ("instantiationToken", text(token())),
            ("description", text(MODEL_DESCRIPTION)),
            ("version", text(env!("CARGO_PKG_VERSION"))),
            ("author", text(AUTHOR)),
            ("copyright", text(COPYRIGHT)),
            ("license", text("MIT OR Apache-2.0")),
            ("generationTool", text("glidepolar")),
            ("generationDateAndTime", text(GENERATED)),
            ("variableNamingConvention", text("structured")),
        ],
    );
    capabilities(&mut document);
    units(&mut document);
    types(&mut document);
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
    for variable in variables() {
        model_variable(&mut document, variable, vehicle);
    }
    document.close();
    model_structure(&mut document);
    document.finish()
}

fn capabilities(document: &mut Document) {
    let common = [
        ("modelIdentifier", text(MODEL_NAME)),
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

fn units(document: &mut Document) {
    document.open("UnitDefinitions", &[]);
    for unit in UNITS {
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

fn types(document: &mut Document) {
    document.open("TypeDefinitions", &[]);
    for choice in CHOICES {
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
        ("valueReference", text(reference_of(variable.slot).to_string())),
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
                ("derivative", derivative_of(variable).map(|state| state.to_string())),
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

fn model_structure(document: &mut Document) {
    let structure = structure();
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
