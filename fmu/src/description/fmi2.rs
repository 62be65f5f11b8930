//! modelDescription.xml of FMI 2.0.

use super::structure::{Unknown, structure};
use super::xml::{Document, flag, number, text};
use super::{AUTHOR, COPYRIGHT, DEFAULT_EXPERIMENT, GENERATED, LOG_CATEGORIES, start_value, used_units};
use crate::model::vehicle::Vehicle;
use crate::model::{Causality, Initial, Kind, Model, Slot, Table, Variability, Variable};

/// The model description with the start values of this vehicle.
pub fn model_description(vehicle: &Vehicle) -> String {
    let model = vehicle.glider.model;
    let table = model.table();
    let mut document = Document::new();
    document.open(
        "fmiModelDescription",
        &[
            ("fmiVersion", text("2.0")),
            ("modelName", text(model.name())),
            ("guid", text(table.token)),
            ("description", text(model.description())),
            ("version", text(env!("CARGO_PKG_VERSION"))),
            ("author", text(AUTHOR)),
            ("copyright", text(COPYRIGHT)),
            ("license", text("MIT OR Apache-2.0")),
            ("generationTool", text("glidepolar")),
            ("generationDateAndTime", text(GENERATED)),
            ("variableNamingConvention", text("structured")),
            ("numberOfEventIndicators", text(model.n_events().to_string())),
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
        scalar_variable(&mut document, variable, vehicle);
    }
    document.close();
    model_structure(&mut document, model);
    document.finish()
}

fn capabilities(document: &mut Document, model: Model) {
    let common = [
        ("modelIdentifier", text(model.name())),
        ("canNotUseMemoryManagementFunctions", flag(true)),
        ("canGetAndSetFMUstate", flag(true)),
        ("canSerializeFMUstate", flag(true)),
        ("providesDirectionalDerivative", flag(true)),
    ];
    let with = |more: &[(&'static str, Option<String>)]| [common.as_slice(), more].concat();
    document.leaf("ModelExchange", &with(&[("completedIntegratorStepNotNeeded", flag(true))]));
    document.leaf(
        "CoSimulation",
        &with(&[
            ("canHandleVariableCommunicationStepSize", flag(true)),
            ("canInterpolateInputs", flag(true)),
            ("maxOutputDerivativeOrder", text("1")),
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
        document.open("SimpleType", &[("name", text(choice.name)), ("description", text(choice.description))]);
        document.open("Enumeration", &[]);
        for (value, (name, meaning)) in choice.items.iter().enumerate() {
            let value = text(value.to_string());
            document.leaf("Item", &[("name", text(*name)), ("value", value), ("description", text(*meaning))]);
        }
        document.close();
        document.close();
    }
    document.close();
}

fn scalar_variable(document: &mut Document, variable: &Variable, vehicle: &Vehicle) {
    let may_say_initial = !matches!(variable.causality, Causality::Input | Causality::Independent);
    document.open(
        "ScalarVariable",
        &[
            ("name", text(variable.name)),
            ("valueReference", text(variable.reference.to_string())),
            ("description", text(variable.description)),
            ("causality", text(causality(variable.causality))),
            ("variability", text(variability(variable.variability))),
            ("initial", variable.initial.filter(|_| may_say_initial).map(|i| initial(i).to_owned())),
        ],
    );
    let start = start_value(&vehicle.glider, &vehicle.name, variable);
    let integer = |bound: f64| Some((bound as i64).to_string());
    match variable.kind {
        Kind::Real => document.leaf(
            "Real",
            &[
                ("unit", variable.unit.and_then(|unit| text(unit.name))),
                ("displayUnit", variable.unit.and_then(|unit| unit.display).and_then(|(name, _)| text(name))),
                ("min", variable.bounds.and_then(|(min, _)| number(min))),
                ("max", variable.bounds.and_then(|(_, max)| number(max))),
                ("nominal", variable.nominal.and_then(number)),
                ("start", start),
                ("derivative", derivative_of(vehicle.glider.model.table(), variable).map(|state| state.to_string())),
                ("reinit", flag(variable.jumps)),
            ],
        ),
        Kind::Integer => document.leaf(
            "Integer",
            &[
                ("min", variable.bounds.and_then(|(min, _)| integer(min))),
                ("max", variable.bounds.and_then(|(_, max)| integer(max))),
                ("start", start),
            ],
        ),
        Kind::Choice(choice) => {
            document.leaf("Enumeration", &[("declaredType", text(choice.name)), ("start", start)]);
        }
        Kind::Boolean => document.leaf("Boolean", &[("start", start)]),
        Kind::Text => document.leaf("String", &[("start", start)]),
    }
    document.close();
}

fn model_structure(document: &mut Document, model: Model) {
    let structure = structure(model);
    document.open("ModelStructure", &[]);
    for (name, unknowns) in
        [("Outputs", structure.outputs), ("Derivatives", structure.derivatives), ("InitialUnknowns", structure.initial)]
    {
        document.open(name, &[]);
        for Unknown { reference, dependencies } in unknowns {
            // Elements are counted from one, as value references are.
            let indices = dependencies.iter().map(u32::to_string).collect::<Vec<_>>().join(" ");
            document.leaf("Unknown", &[("index", text(reference.to_string())), ("dependencies", text(indices))]);
        }
        document.close();
    }
    document.close();
}

/// The value reference of the state that this variable is the derivative of.
pub(super) fn derivative_of(table: Table, variable: &Variable) -> Option<u32> {
    match variable.slot {
        Slot::Derivative(i) => Some(table.reference_of(Slot::State(i))),
        _ => None,
    }
}

pub(super) fn causality(causality: Causality) -> &'static str {
    match causality {
        Causality::Independent => "independent",
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
        Causality::Parameter => "parameter",
    }
}

pub(super) fn variability(variability: Variability) -> &'static str {
    match variability {
        Variability::Constant => "constant",
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    }
}

pub(super) fn initial(initial: Initial) -> &'static str {
    match initial {
        Initial::Exact => "exact",
        Initial::Approx => "approx",
        Initial::Calculated => "calculated",
    }
}
