//! What modelDescription.xml of both standards says in the same way; a [`Format`] adds what each says in its own.

use super::structure::{Structure, structure};
use super::xml::{Document, flag, number, text};
use super::{AUTHOR, COPYRIGHT, DEFAULT_EXPERIMENT, GENERATED, LOG_CATEGORIES, start_value, used_units};
use crate::model::Choice;
use crate::model::vehicle::Vehicle;
use crate::model::{Causality, Initial, Model, Slot, Table, Variability, Variable};

/// Attributes in their order; one without a value is left out.
pub type Attributes = Vec<(&'static str, Option<String>)>;

/// How a standard writes what the other writes otherwise.
pub trait Format {
    /// Its version.
    const VERSION: &'static str;
    /// What it calls the token of the table.
    const TOKEN: &'static str;

    /// Further attributes of the description.
    fn attributes(_model: Model) -> Attributes {
        Vec::new()
    }
    /// The interfaces, with what each can do.
    fn capabilities(document: &mut Document, model: Model);
    /// Opens the type of a list of choices, and says how many elements it opened.
    fn open_choice(document: &mut Document, choice: &Choice) -> usize;
    /// A variable.
    fn variable(document: &mut Document, variable: &Variable, vehicle: &Vehicle);
    /// Which variable follows from which.
    fn structure(document: &mut Document, structure: Structure);
}

/// The model description with the start values of this vehicle.
pub fn model_description<F: Format>(vehicle: &Vehicle) -> String {
    let model = vehicle.glider.model;
    let table = model.table();
    let mut document = Document::new();
    let mut attributes = vec![
        ("fmiVersion", text(F::VERSION)),
        ("modelName", text(model.name())),
        (F::TOKEN, text(table.token)),
        ("description", text(model.description())),
        ("version", text(env!("CARGO_PKG_VERSION"))),
        ("author", text(AUTHOR)),
        ("copyright", text(COPYRIGHT)),
        ("license", text("MIT OR Apache-2.0")),
        ("generationTool", text("glidepolar")),
        ("generationDateAndTime", text(GENERATED)),
        ("variableNamingConvention", text("structured")),
    ];
    attributes.extend(F::attributes(model));
    document.open("fmiModelDescription", &attributes);
    F::capabilities(&mut document, model);
    units(&mut document, table);
    types::<F>(&mut document, table);
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
        F::variable(&mut document, variable, vehicle);
    }
    document.close();
    document.open("ModelStructure", &[]);
    F::structure(&mut document, structure(model));
    document.close();
    document.finish()
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

fn types<F: Format>(document: &mut Document, table: Table) {
    document.open("TypeDefinitions", &[]);
    for choice in table.choices() {
        let opened = F::open_choice(document, choice);
        for (value, (name, meaning)) in choice.items.iter().enumerate() {
            let value = text(value.to_string());
            document.leaf("Item", &[("name", text(*name)), ("value", value), ("description", text(*meaning))]);
        }
        (0..opened).for_each(|_| document.close());
    }
    document.close();
}

/// Name, reference, causality and the like.
pub fn common(variable: &Variable) -> [(&'static str, Option<String>); 5] {
    [
        ("name", text(variable.name)),
        ("valueReference", text(variable.reference.to_string())),
        ("description", text(variable.description)),
        ("causality", text(causality(variable.causality))),
        ("variability", text(variability(variable.variability))),
    ]
}

/// Where the value at the start comes from, where the standards let a variable say it.
pub fn initial(variable: &Variable) -> (&'static str, Option<String>) {
    let may_say = !matches!(variable.causality, Causality::Input | Causality::Independent);
    let name = |initial| match initial {
        Initial::Exact => "exact",
        Initial::Approx => "approx",
        Initial::Calculated => "calculated",
    };
    ("initial", variable.initial.filter(|_| may_say).and_then(|initial| text(name(initial))))
}

/// What a variable with numbers says beside [`common`].
pub fn real(variable: &Variable, vehicle: &Vehicle) -> Attributes {
    let (unit, bounds) = (variable.unit, variable.bounds);
    let derivative_of = match variable.slot {
        Slot::Derivative(i) => text(vehicle.glider.model.table().reference_of(Slot::State(i)).to_string()),
        _ => None,
    };
    vec![
        ("unit", unit.and_then(|unit| text(unit.name))),
        ("displayUnit", unit.and_then(|unit| unit.display).and_then(|(name, _)| text(name))),
        ("min", bounds.and_then(|(min, _)| number(min))),
        ("max", bounds.and_then(|(_, max)| number(max))),
        ("nominal", variable.nominal.and_then(number)),
        start(variable, vehicle),
        ("derivative", derivative_of),
        ("reinit", flag(variable.jumps)),
    ]
}

/// What a variable with integers says beside [`common`].
pub fn integer(variable: &Variable, vehicle: &Vehicle) -> Attributes {
    let whole = |bound: f64| text((bound as i64).to_string());
    vec![
        ("min", variable.bounds.and_then(|(min, _)| whole(min))),
        ("max", variable.bounds.and_then(|(_, max)| whole(max))),
        start(variable, vehicle),
    ]
}

/// The start value, if the variable has one.
pub fn start(variable: &Variable, vehicle: &Vehicle) -> (&'static str, Option<String>) {
    ("start", start_value(&vehicle.glider, &vehicle.name, variable))
}

/// Value references as the standards list them.
pub fn list(references: &[u32]) -> Option<String> {
    text(references.iter().map(u32::to_string).collect::<Vec<_>>().join(" "))
}

fn causality(causality: Causality) -> &'static str {
    match causality {
        Causality::Independent => "independent",
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
        Causality::Parameter => "parameter",
    }
}

fn variability(variability: Variability) -> &'static str {
    match variability {
        Variability::Constant => "constant",
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    }
}
