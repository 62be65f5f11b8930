//! What modelDescription.xml of FMI 2.0 has of its own.

use super::document::{Attributes, Format, common, initial, integer, list, real, start};
use super::structure::{Structure, Unknown};
use super::xml::{Document, flag, text};
use crate::model::Choice;
use crate::model::vehicle::Vehicle;
use crate::model::{Kind, Model, Variable};

/// FMI 2.0.
pub struct Fmi2;

impl Format for Fmi2 {
    const VERSION: &'static str = "2.0";
    const TOKEN: &'static str = "guid";

    fn attributes(model: Model) -> Attributes {
        vec![("numberOfEventIndicators", text(model.n_events().to_string()))]
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

    fn open_choice(document: &mut Document, choice: &Choice) -> usize {
        document.open("SimpleType", &[("name", text(choice.name)), ("description", text(choice.description))]);
        document.open("Enumeration", &[]);
        2
    }

    fn variable(document: &mut Document, variable: &Variable, vehicle: &Vehicle) {
        document.open("ScalarVariable", &[common(variable).as_slice(), &[initial(variable)]].concat());
        let start = start(variable, vehicle);
        match variable.kind {
            Kind::Real => document.leaf("Real", &real(variable, vehicle)),
            Kind::Integer => document.leaf("Integer", &integer(variable, vehicle)),
            Kind::Choice(choice) => document.leaf("Enumeration", &[("declaredType", text(choice.name)), start]),
            Kind::Boolean => document.leaf("Boolean", &[start]),
            Kind::Text => document.leaf("String", &[start]),
        }
        document.close();
    }

    fn structure(document: &mut Document, structure: Structure) {
        for (name, unknowns) in [
            ("Outputs", structure.outputs),
            ("Derivatives", structure.derivatives),
            ("InitialUnknowns", structure.initial),
        ] {
            document.open(name, &[]);
            for Unknown { reference, dependencies } in unknowns {
                // Elements are counted from one, as value references are.
                let index = text(reference.to_string());
                document.leaf("Unknown", &[("index", index), ("dependencies", list(&dependencies))]);
            }
            document.close();
        }
    }
}
