//! Terminals of FMI 3.0: variables that belong together and are connected together.

use super::xml::{Document, number, text};
use crate::model::table::variables;
use crate::model::{Causality, Variable};

/// Name, what it is, which inputs or outputs belong to it.
type Terminal = (&'static str, &'static str, fn(&Variable) -> bool);

const TERMINALS: [Terminal; 4] = [
    ("commands", "Set-points of buoyancy engine and moving mass, what a controller sends", is_command),
    ("forces", "Forces on the moving mass and ballast mass rate, for raw actuation", is_force),
    ("water", "The water at the glider's place and the seabed below, what an ocean model sends", is_water),
    ("motion", "Where the glider is and how it moves, what controllers and ocean models read", is_motion),
];

/// terminalsAndIcons.xml.
pub fn terminals_and_icons() -> String {
    let mut document = Document::new();
    document.open("fmiTerminalsAndIcons", &[("fmiVersion", text("3.0"))]);
    document.open("GraphicalRepresentation", &[]);
    let corners = [("x1", number(-100.0)), ("y1", number(-100.0)), ("x2", number(100.0)), ("y2", number(100.0))];
    let scaled = [corners.as_slice(), &[("suggestedScalingFactorTo_mm", number(0.1))]].concat();
    document.leaf("CoordinateSystem", &scaled);
    document.leaf("Icon", &corners);
    document.close();
    document.open("Terminals", &[]);
    for (name, description, belongs) in TERMINALS {
        document.open(
            "Terminal",
            &[("name", text(name)), ("matchingRule", text("bus")), ("description", text(description))],
        );
        for variable in variables().iter().filter(|v| belongs(v)) {
            let name = || text(variable.name);
            document.leaf(
                "TerminalMemberVariable",
                &[("variableName", name()), ("memberName", name()), ("variableKind", text("signal"))],
            );
        }
        document.close();
    }
    document.finish()
}

fn is_command(variable: &Variable) -> bool {
    variable.causality == Causality::Input && variable.name.contains("command")
}

fn is_force(variable: &Variable) -> bool {
    variable.causality == Causality::Input && variable.name.starts_with('u')
}

fn is_water(variable: &Variable) -> bool {
    let stems = ["water_", "current_", "seabed_"];
    variable.causality == Causality::Input && stems.iter().any(|stem| variable.name.starts_with(stem))
}

fn is_motion(variable: &Variable) -> bool {
    let names = ["x_m", "depth_m", "pitch_rad", "pitch_rate_rad_s", "speed_m_s", "vertical_velocity_m_s"];
    names.contains(&variable.name)
}
