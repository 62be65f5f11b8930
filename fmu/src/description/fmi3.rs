//! What modelDescription.xml of FMI 3.0 has of its own.

use super::document::{Format, common, initial, integer, list, real, start};
use super::structure::Structure;
use super::xml::{Document, flag, text};
use crate::model::Choice;
use crate::model::vehicle::Vehicle;
use crate::model::{Causality, Kind, Model, Variability, Variable};

/// FMI 3.0.
pub struct Fmi3;

impl Format for Fmi3 {
    const VERSION: &'static str = "3.0";
    const TOKEN: &'static str = "instantiationToken";

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

    fn open_choice(document: &mut Document, choice: &Choice) -> usize {
        document.open("EnumerationType", &[("name", text(choice.name)), ("description", text(choice.description))]);
        1
    }

    fn variable(document: &mut Document, variable: &Variable, vehicle: &Vehicle) {
        let reachable_inside_a_step = variable.variability == Variability::Continuous
            && matches!(variable.causality, Causality::Input | Causality::Output);
        let own = [("intermediateUpdate", flag(reachable_inside_a_step)), initial(variable)];
        let with = |more: &[(&'static str, Option<String>)]| [common(variable).as_slice(), &own, more].concat();
        let start = start(variable, vehicle);
        match variable.kind {
            Kind::Real => document.leaf("Float64", &with(&real(variable, vehicle))),
            Kind::Integer => document.leaf("Int32", &with(&integer(variable, vehicle))),
            Kind::Choice(choice) => document.leaf("Enumeration", &with(&[("declaredType", text(choice.name)), start])),
            Kind::Boolean => document.leaf("Boolean", &with(&[start])),
            Kind::Text => document.leaf("String", &with(&[])),
        }
    }

    fn structure(document: &mut Document, structure: Structure) {
        for (name, unknowns) in [
            ("Output", structure.outputs),
            ("ContinuousStateDerivative", structure.derivatives),
            ("InitialUnknown", structure.initial),
            ("EventIndicator", structure.indicators),
        ] {
            for unknown in unknowns {
                let reference = text(unknown.reference.to_string());
                document.leaf(name, &[("valueReference", reference), ("dependencies", list(&unknown.dependencies))]);
            }
        }
    }
}
