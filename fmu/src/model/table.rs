//! The one table of the variables: names, value references, units, bounds, meanings. Both model descriptions, the
//! documentation and the dispatch of every get and set follow from it; a further variable is one more row.
//!
//! A row begins with its value reference, which it keeps for good: a further row takes the next free number, wherever it
//! stands here, and comes last in the descriptions. The references are 1 to n in the order of modelDescription.xml, so
//! that importers that read dependencies as references and those that count elements from one read the same. Parameters
//! are the rows of the library's own table; their references stand in `references.rs`.

use glidepolar_fmu_resources::NOT_PUBLISHED;
use std::sync::LazyLock;

use glidepolar_dynamics::limits::N_EVENTS;
use glidepolar_dynamics::state::{INPUTS, N_INPUTS, STATES};
use glidepolar_dynamics::{Inputs, N_STATES, Outputs, PARAMETERS};
use glidepolar_number::{Number, Quantity};

use super::Model;
use super::references::parameter_reference;
use super::units::unit_named;
use super::variable::{
    Causality, Choice, Discrete, Initial, Kind, Slot, Table, Token, Variability, Variable, in_order,
};

/// How many variables there are.
const N_VARIABLES: usize = 1 + N_INPUTS + N_STATES + N_OUTPUTS + 1 + 4 + N_STATES + N_EVENTS + 3 + N_PARAMETERS + 1;

/// How many parameters are published as numbers.
const N_PARAMETERS: usize = PARAMETERS.len() - NOT_PUBLISHED.len();

/// How many outputs that are neither states nor discrete.
pub const N_OUTPUTS: usize = OUTPUTS.len();

/// The variables of the glider in the vertical plane.
pub fn plane() -> Table {
    static ROWS: LazyLock<[Variable; N_VARIABLES]> = LazyLock::new(|| in_order(build()));
    static TOKEN: LazyLock<Token> = LazyLock::new(|| Token::of(&*ROWS));
    Table { rows: &*ROWS, token: TOKEN.text() }
}

/// The variables in the plane.
pub fn variables() -> &'static [Variable] {
    plane().rows
}

/// The variable in the plane of this value reference.
pub fn variable(value_reference: u32) -> Option<&'static Variable> {
    plane().variable(value_reference)
}

/// The name of the table of the plane.
pub fn token() -> &'static str {
    plane().token
}

/// Value reference, name, unit, smallest and largest value, usual size, meaning.
pub(super) type Row = (u32, &'static str, &'static str, f64, f64, f64, &'static str);

/// Value references of the inputs, in the order of the library's table.
const INPUT_REFERENCES: [u32; N_INPUTS] = [2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 127, 128, 129];

/// Value references of the states, in the order of the library's table; whether each is an output too, and
/// whether its start follows from other variables.
const STATE_ROWS: [(u32, Causality, Initial); N_STATES] = [
    (14, Causality::Output, Initial::Exact),
    (15, Causality::Output, Initial::Exact),
    (16, Causality::Output, Initial::Exact),
    (17, Causality::Output, Initial::Exact),
    (18, Causality::Output, Initial::Exact),
    (19, Causality::Output, Initial::Exact),
    (20, Causality::Output, Initial::Exact),
    (21, Causality::Local, Initial::Approx),
    (22, Causality::Local, Initial::Approx),
    (23, Causality::Local, Initial::Approx),
    (24, Causality::Output, Initial::Exact),
    (130, Causality::Local, Initial::Exact),
    (131, Causality::Local, Initial::Exact),
    (157, Causality::Local, Initial::Exact),
    (132, Causality::Local, Initial::Exact),
    (25, Causality::Output, Initial::Exact),
];

/// States that have another name here than in the library.
const RENAMED: [(&str, &str); 4] = [
    ("moving_mass_1_m", "moving_mass_position_m"),
    ("moving_mass_3_m", "moving_mass_position_3_m"),
    ("momentum_1_kg_m_s", "PP1_kg_m_s"),
    ("momentum_3_kg_m_s", "PP3_kg_m_s"),
];

/// The row of a quantity of the library's tables.
pub(super) fn row_of(reference: u32, quantity: &Quantity, renamed: &[(&str, &'static str)]) -> Row {
    let name = renamed.iter().find(|(own, _)| *own == quantity.name).map_or(quantity.name, |(_, name)| name);
    (reference, name, quantity.unit, quantity.min, quantity.max, quantity.nominal, quantity.meaning)
}

macro_rules! derivatives {
    ($($reference:literal $state:literal : $unit:literal),*) => {
        [$(($reference, concat!("der(", $state, ")"), $unit, concat!("Time derivative of ", $state))),*]
    };
}

/// Value reference, name, unit and meaning of the derivatives, in the order of the states.
const DERIVATIVES: [(u32, &str, &str, &str); N_STATES] = derivatives![
    43 "x_m": "m/s",
    44 "depth_m": "m/s",
    45 "pitch_rad": "rad/s",
    46 "pitch_rate_rad_s": "rad/s2",
    47 "v1_m_s": "m/s2",
    48 "v3_m_s": "m/s2",
    49 "moving_mass_position_m": "m/s",
    50 "moving_mass_position_3_m": "m/s",
    51 "PP1_kg_m_s": "N",
    52 "PP3_kg_m_s": "N",
    53 "ballast_mass_kg": "kg/s",
    133 "creep_pressure_Pa": "Pa/s",
    134 "carried_density_kg_m3": "kg/m3/s",
    158 "late_temperature_K": "K/s",
    135 "leaked_back_m3": "m3/s",
    54 "energy_J": "W"
];

/// States that an event may change: what the impulse of the moving mass at its stop reaches, and the ballast.
const JUMPING_STATES: [&str; 7] =
    ["pitch_rate_rad_s", "v1_m_s", "v3_m_s", "moving_mass_position_m", "PP1_kg_m_s", "PP3_kg_m_s", "ballast_mass_kg"];

macro_rules! outputs {
    (|$outputs:ident, $inputs:ident| $($reference:literal $causality:ident $name:literal [$unit:literal] $min:literal .. $max:literal, $nominal:literal, $meaning:literal, $value:expr;)*) => {
        /// The calculated numbers that are neither states nor their derivatives, in the order of [`output_array`].
        const OUTPUTS: &[(Row, Causality)] =
            &[$((($reference, $name, $unit, $min, $max, $nominal, $meaning), Causality::$causality),)*];

        /// Their values, from what the equations give and from the inputs that act.
        pub fn output_array<T: Number>($outputs: &Outputs<T>, $inputs: &Inputs<T>) -> [T; N_OUTPUTS] {
            [$($value,)*]
        }
    };
}

// To add an output: one more line here, with the next free value reference.
outputs! {
    |outputs, inputs|
    26 Output "glide_angle_rad" ["rad"] -1e3 .. 1e3, 0.1,
        "Glide path angle through the water, negative when descending", outputs.glide_angle_rad;
    27 Output "angle_of_attack_rad" ["rad"] -3.2 .. 3.2, 0.01,
        "Angle of attack", outputs.angle_of_attack_rad;
    28 Output "speed_m_s" ["m/s"] 0.0 .. 200.0, 0.1,
        "Speed through the water", outputs.speed_m_s;
    29 Output "vertical_velocity_m_s" ["m/s"] -200.0 .. 200.0, 0.1,
        "Rate of change of depth, current included, positive down", outputs.vertical_velocity_m_s;
    30 Output "net_mass_kg" ["kg"] -1e6 .. 1e6, 0.1,
        "Net (excess) mass m0, positive when heavy", outputs.net_mass_kg;
    31 Output "ballast_m3" ["m3"] -1e3 .. 1e3, 1e-4,
        "Ballast volume that an instrument reads, positive = more buoyant", outputs.ballast_m3;
    32 Output "lift_N" ["N"] -1e9 .. 1e9, 1.0,
        "Lift, normal to the path, upward positive", outputs.lift_N;
    33 Output "drag_N" ["N"] -1e9 .. 1e9, 0.1,
        "Drag, against the path", outputs.drag_N;
    34 Output "pitching_moment_N_m" ["N.m"] -1e9 .. 1e9, 0.1,
        "Hydrodynamic pitching moment about the centre of buoyancy, Munk couple and damping included",
        outputs.pitching_moment_N_m;
    35 Output "pitch_read_rad" ["rad"] -1e4 .. 1e4, 0.1,
        "Pitch as the glider's own instrument reads it", outputs.pitch_read_rad;
    36 Output "pressure_read_dbar" ["dbar"] -1e5 .. 1e5, 10.0,
        "Gauge pressure as the glider's own instrument reads it, without lag", outputs.pressure_read_dbar;
    37 Output "surrounding_density_kg_m3" ["kg/m3"] 900.0 .. 1300.0, 1000.0,
        "Density of the water that the glider is in, from input or column", inputs.water_density_kg_m3;
    38 Output "surrounding_temperature_C" ["degC"] -5.0 .. 50.0, 10.0,
        "Temperature of the water that the glider is in, from input or column", inputs.water_temperature_C;
    123 Output "emerged_fraction" ["1"] 0.0 .. 1.0, 0.1,
        "Share of its displacement that the hull has lost above the water, 0 below the surface", outputs.emerged_fraction;
    124 Output "seabed_force_N" ["N"] 0.0 .. 1e9, 1.0,
        "Upward force of the seabed on the hull, 0 above it", outputs.seabed_N;
}

/// Value reference, name and meaning of the event indicators, in the order of the library's. The ends of ballast and moving mass are
/// watched by volume \[m3\] or length \[m\] while free, by flow \[kg/s\] or force \[N\] when held: one unit cannot say so.
const INDICATORS: [(u32, &str, &str); N_EVENTS] = [
    (55, "indicator_surface", "Event indicator: changes sign at the surface"),
    (56, "indicator_seabed", "Event indicator: changes sign at the seabed"),
    (
        57,
        "indicator_ballast_min",
        "Event indicator: changes sign when the ballast comes to its minimum or leaves it (m3 while free, kg/s when held); with servos, where the ballast servo reaches or leaves its largest rate",
    ),
    (
        58,
        "indicator_ballast_max",
        "Event indicator: changes sign when the ballast comes to its maximum or leaves it (m3 while free, kg/s when held); with servos, where the ballast servo reaches or leaves its largest rate",
    ),
    (
        59,
        "indicator_moving_mass_aft",
        "Event indicator: changes sign when the moving mass comes to its aft stop or leaves it (m while free, N when held); with servos, where the servo of the mass reaches or leaves its largest rate",
    ),
    (
        60,
        "indicator_moving_mass_forward",
        "Event indicator: changes sign when the moving mass comes to its forward stop or leaves it (m while free, N when held); with servos, where the servo of the mass reaches or leaves its largest rate",
    ),
];

/// Parameters that make the body what it is: they cannot change while it moves. All others are tunable.
pub(super) const FIXED: &[&str] = &[
    "gravity_m_s2",
    "reference_density_kg_m3",
    "reference_temperature_C",
    "frontal_area_m2",
    "length_m",
    "hull_mass_kg",
    "moving_mass_kg",
    "ballast_nominal_kg",
    "displaced_mass_kg",
    "added_mass_1_kg",
    "added_mass_3_kg",
    "pitch_inertia_kg_m2",
    "moving_mass_height_m",
    "offset_mass_kg",
    "offset_mass_forward_m",
    "offset_mass_below_m",
    "ballast_forward_m",
    "ballast_below_m",
];

fn build() -> Vec<Variable> {
    let mut table = vec![time()];
    table.extend(inputs(&INPUT_REFERENCES, INPUTS));
    table.extend(STATE_ROWS.iter().zip(STATES).enumerate().map(|(i, ((reference, causality, initial), state))| {
        let row = row_of(*reference, state, &RENAMED);
        Variable {
            causality: *causality,
            initial: Some(*initial),
            jumps: JUMPING_STATES.contains(&row.1),
            ..real(&row, Slot::State(i))
        }
    }));
    table.extend(
        OUTPUTS
            .iter()
            .enumerate()
            .map(|(i, (row, causality))| Variable { causality: *causality, ..real(row, Slot::Output(i)) }),
    );
    table.push(power(125));
    table.extend(discrete(FLAGS));
    table.extend((0..N_STATES).map(|i| derivative(DERIVATIVES[i], i, STATES[i].nominal)));
    table.extend((0..N_EVENTS).map(|i| indicator(INDICATORS[i], i)));
    table.push(actuation());
    table.push(water_source());
    table.push(start_in_trim());
    let published = PARAMETERS.iter().enumerate().filter(|(_, info)| !NOT_PUBLISHED.contains(&info.name));
    table.extend(published.map(|(i, info)| parameter(info, i, FIXED.contains(&info.name), Model::Plane)));
    table.push(vehicle_name());
    table
}

/// The inputs of a library's table by their value references.
pub(super) fn inputs(references: &[u32], table: &[Quantity]) -> impl Iterator<Item = Variable> {
    references.iter().zip(table).enumerate().map(|(i, (reference, input))| Variable {
        causality: Causality::Input,
        initial: Some(Initial::Exact),
        ..real(&row_of(*reference, input, &[]), Slot::Input(i))
    })
}

pub(super) fn time() -> Variable {
    Variable {
        causality: Causality::Independent,
        initial: None,
        bounds: None,
        nominal: None,
        ..real(&(1, "time", "s", 0.0, 0.0, 0.0, "Time"), Slot::Time)
    }
}

pub(super) fn real(&(reference, name, unit, min, max, nominal, description): &Row, slot: Slot) -> Variable {
    Variable {
        reference,
        name,
        description,
        kind: Kind::Real,
        causality: Causality::Local,
        variability: Variability::Continuous,
        initial: Some(Initial::Calculated),
        unit: Some(unit_named(unit).expect("the unit of a row is one of UNITS")),
        bounds: Some((min, max)),
        nominal: Some(nominal),
        jumps: false,
        slot,
    }
}

pub(super) fn derivative(
    (reference, name, unit, description): (u32, &'static str, &'static str, &'static str),
    index: usize,
    nominal: f64,
) -> Variable {
    /// Time over which a state changes by its nominal value \[s\].
    const TYPICAL_TIME_S: f64 = 10.0;
    let row = (reference, name, unit, 0.0, 0.0, nominal / TYPICAL_TIME_S, description);
    Variable { bounds: None, ..real(&row, Slot::Derivative(index)) }
}

pub(super) fn power(reference: u32) -> Variable {
    let row = (reference, "power_W", "W", 0.0, 1e9, 1.0, "Power drawn from the battery, the rate of energy_J");
    Variable { causality: Causality::Output, ..real(&row, Slot::Power) }
}

pub(super) fn indicator((reference, name, description): (u32, &'static str, &'static str), index: usize) -> Variable {
    Variable {
        bounds: None,
        nominal: None,
        unit: unit_named(if index < 2 { "m" } else { "1" }),
        ..real(&(reference, name, "m", 0.0, 0.0, 1.0, description), Slot::Indicator(index))
    }
}

/// Value reference, name, type, place and meaning of something that changes at events only.
type Flag = (u32, &'static str, Kind, Discrete, &'static str);

const FLAGS: [Flag; 4] = [
    (39, "at_surface", Kind::Boolean, Discrete::AtSurface, "Whether the centre of buoyancy is above the surface"),
    (40, "on_seabed", Kind::Boolean, Discrete::OnSeabed, "Whether the hull rests on the seabed"),
    (
        41,
        "ballast_stop",
        Kind::Integer,
        Discrete::BallastStop,
        "-1 at the smallest ballast volume, 1 at the largest, 0 between (actuation 1 and 2)",
    ),
    (
        42,
        "moving_mass_stop",
        Kind::Integer,
        Discrete::MovingMassStop,
        "-1 at the aft stop, 1 at the forward stop, 0 between (actuation 1 and 2)",
    ),
];

pub(super) fn discrete<const N: usize>(rows: [Flag; N]) -> impl Iterator<Item = Variable> {
    rows.into_iter().map(|(reference, name, kind, which, description)| Variable {
        kind,
        // Not outputs: block-diagram importers read every output as a number (PathSim, CasADi), and the depth says as much.
        causality: Causality::Local,
        variability: Variability::Discrete,
        unit: None,
        bounds: (kind == Kind::Integer).then_some((-1.0, 1.0)),
        nominal: None,
        ..real(&(reference, name, "1", 0.0, 0.0, 1.0, description), Slot::Discrete(which))
    })
}

/// Who moves the moving mass and the ballast.
pub static ACTUATION: Choice = Choice {
    name: "ActuationKind",
    description: "Who moves the moving mass and the ballast",
    items: &[
        ("servo", "set-points followed by rate-limited servos"),
        ("raw", "forces on the moving mass along both axes and a ballast mass rate"),
        ("raw_axis_1", "raw along axis 1, the axis-3 offset of the moving mass held"),
    ],
};

/// Where density and temperature of the water come from.
pub static WATER_SOURCE: Choice = Choice {
    name: "WaterSourceKind",
    description: "Where density and temperature of the water come from",
    items: &[("inputs", "the inputs"), ("column", "resources/water_column.csv, against depth")],
};

fn actuation() -> Variable {
    const MEANING: &str = "0 servo: set-points followed by rate-limited servos; 1 raw: forces on the moving mass along both axes and a ballast mass rate; 2 raw along axis 1, the axis-3 offset of the moving mass held";
    choice(61, "actuation", MEANING, &ACTUATION, Slot::Actuation)
}

/// A fixed parameter that is one item of a list.
pub(super) fn choice(
    reference: u32,
    name: &'static str,
    meaning: &'static str,
    choice: &'static Choice,
    slot: Slot,
) -> Variable {
    Variable {
        kind: Kind::Choice(choice),
        causality: Causality::Parameter,
        variability: Variability::Fixed,
        initial: Some(Initial::Exact),
        unit: None,
        bounds: Some((0.0, (choice.items.len() - 1) as f64)),
        nominal: None,
        ..real(&(reference, name, "1", 0.0, 0.0, 1.0, meaning), slot)
    }
}

pub(super) fn water_source() -> Variable {
    const MEANING: &str = "0: density and temperature of the water are the inputs; 1: they come from resources/water_column.csv, against depth";
    choice(62, "water_source", MEANING, &WATER_SOURCE, Slot::WaterSource)
}

pub(super) fn start_in_trim() -> Variable {
    const MEANING: &str = "1: the run starts in the steady glide of the parameters and the water that were set, at depth_m; the start values of pitch, velocities, moving mass, ballast and set-points then follow from them. 0: they are as set";
    Variable {
        reference: 126,
        name: "start_in_trim",
        description: MEANING,
        // A number and no Boolean: many a script reads every start value as one.
        kind: Kind::Integer,
        bounds: Some((0.0, 1.0)),
        slot: Slot::StartInTrim,
        ..actuation()
    }
}

pub(super) fn parameter(info: &'static Quantity, index: usize, fixed: bool, model: Model) -> Variable {
    let reference = parameter_reference(model, info.name);
    Variable {
        causality: Causality::Parameter,
        variability: if fixed { Variability::Fixed } else { Variability::Tunable },
        initial: Some(Initial::Exact),
        nominal: (info.default != 0.0).then_some(info.default.abs()),
        ..real(&(reference, info.name, info.unit, info.min, info.max, 0.0, info.meaning), Slot::Parameter(index))
    }
}

pub(super) fn vehicle_name() -> Variable {
    Variable {
        kind: Kind::Text,
        variability: Variability::Fixed,
        // Without a start value: a text with one is beyond some importers (CasADi 3.8 refuses the whole description).
        initial: Some(Initial::Calculated),
        unit: None,
        bounds: None,
        nominal: None,
        ..real(&(122, "vehicle_name", "1", 0.0, 0.0, 1.0, "Name of the vehicle"), Slot::VehicleName)
    }
}
