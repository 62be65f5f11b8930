//! Terminals of FMI 3.0: variables that belong together and are connected together.

use super::xml::{Document, number, text};
use crate::model::{Causality, Model, Variable};

/// Name, what it is, which inputs or outputs belong to it.
type Terminal = (&'static str, &'static str, fn(&Variable) -> bool);

const TERMINALS: [Terminal; 7] = [
    ("commands", "Set-points of buoyancy engine and moving mass, what a controller sends", is_command),
    ("forces", "Forces on the moving mass and ballast mass rate, for raw actuation", is_force),
    ("water", "The water at the glider's place and the seabed below, what an ocean model sends", is_water),
    ("motion", "Where the glider is and how it moves, what controllers and ocean models read", is_motion),
    ("steering", "Roll and rudder angles, for the drag that they cost", is_steering),
    ("loads", "Forces, moment and net mass, what a design study reads", is_load),
    ("instruments", "Readings of the glider's own instruments, energy and power", is_reading),
];

/// Half the height of a terminal's mark, and the step between two.
const MARK: f64 = 8.0;
const STEP: f64 = 45.0;

/// terminalsAndIcons.xml.
pub fn terminals_and_icons(model: Model) -> String {
    let variables = model.table().rows;
    let mut document = Document::new();
    document.open("fmiTerminalsAndIcons", &[("fmiVersion", text("3.0"))]);
    document.open("GraphicalRepresentation", &[]);
    let corners = [("x1", number(-100.0)), ("y1", number(-100.0)), ("x2", number(100.0)), ("y2", number(100.0))];
    let scaled = [corners.as_slice(), &[("suggestedScalingFactorTo_mm", number(0.1))]].concat();
    document.leaf("CoordinateSystem", &scaled);
    document.leaf("Icon", &corners);
    document.close();
    document.open("Terminals", &[]);
    let (mut taken_left, mut taken_right) = (0.0, 0.0);
    let has_members = |(_, _, belongs): &Terminal| variables.iter().any(belongs);
    for (name, description, belongs) in TERMINALS.into_iter().filter(has_members) {
        document.open(
            "Terminal",
            &[("name", text(name)), ("matchingRule", text("bus")), ("description", text(description))],
        );
        for variable in variables.iter().filter(|v| belongs(v)) {
            let name = || text(variable.name);
            document.leaf(
                "TerminalMemberVariable",
                &[("variableName", name()), ("memberName", name()), ("variableKind", text("signal"))],
            );
        }
        // Inputs to the left of the icon, outputs to the right.
        let sends = variables.iter().filter(|v| belongs(v)).all(|v| v.causality == Causality::Output);
        let (x, taken) = if sends { (108.0, &mut taken_right) } else { (-108.0, &mut taken_left) };
        let y = 70.0 - STEP * *taken;
        *taken += 1.0;
        document.leaf(
            "TerminalGraphicalRepresentation",
            &[
                ("x1", number(x - MARK)),
                ("y1", number(y - MARK)),
                ("x2", number(x + MARK)),
                ("y2", number(y + MARK)),
                ("defaultConnectionColor", text("11 110 168")),
                ("defaultConnectionStrokeSize", number(1.0)),
                ("iconBaseName", text("terminal")),
            ],
        );
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
    const IN_PLANE: [&str; 6] =
        ["x_m", "depth_m", "pitch_rad", "pitch_rate_rad_s", "speed_m_s", "vertical_velocity_m_s"];
    const IN_SPACE: [&str; 5] = ["north_m", "east_m", "heading_rad", "turn_rate_rad_s", "sideslip_rad"];
    IN_PLANE.contains(&variable.name) || IN_SPACE.contains(&variable.name)
}

fn is_steering(variable: &Variable) -> bool {
    variable.causality == Causality::Input && ["roll_rad", "rudder_rad"].contains(&variable.name)
}

fn is_load(variable: &Variable) -> bool {
    let names = ["net_mass_kg", "lift_N", "drag_N", "pitching_moment_N_m", "seabed_force_N", "emerged_fraction"];
    names.contains(&variable.name)
}

fn is_reading(variable: &Variable) -> bool {
    let names = ["ballast_m3", "moving_mass_position_m", "pitch_read_rad", "pressure_read_dbar", "energy_J", "power_W"];
    names.contains(&variable.name)
}
