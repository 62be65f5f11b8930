//! The variables of the glider in six degrees of freedom: one row for each, as in the [table of the plane](crate::model::table),
//! whose kinds of rows these are. A row keeps its value reference for good; a further row takes the next free number.

use std::sync::LazyLock;

use glidepolar_dynamics::PARAMETERS;
use glidepolar_dynamics::empirical::PARAMETERS as EMPIRICAL;
use glidepolar_dynamics::parameters::N_PARAMETERS;
use glidepolar_fmu_resources::NOT_PUBLISHED;
use glidepolar_number::Number;
use glidepolar_spatial::{INPUTS, Inputs, LATERAL, N_INPUTS, N_LATERAL, N_STATES, Outputs, STATES};

use super::N_EVENTS;
use crate::model::Model;
use crate::model::table::{
    FIXED, Row, choice, derivative, discrete, indicator, inputs, parameter, power, real, row_of, start_in_trim, time,
    vehicle_name, water_source,
};
use crate::model::variable::{Causality, Choice, Discrete, Initial, Kind, Slot, Table, Token, Variable, in_order};

/// How many parameters are published as numbers.
const N_PUBLISHED: usize = N_PARAMETERS - NOT_PUBLISHED.len() - EMPIRICAL.len() + N_LATERAL;

/// How many variables there are.
const N_VARIABLES: usize = 1 + N_INPUTS + N_STATES + N_OUTPUTS + 1 + 2 + N_STATES + N_EVENTS + 3 + N_PUBLISHED + 1;

/// How many outputs that are neither states nor discrete.
const N_OUTPUTS: usize = OUTPUTS.len();

/// Who gives rudder and roll mass their set-points.
pub static STEERING: Choice = Choice {
    name: "SteeringKind",
    description: "Who gives rudder and roll mass their set-points",
    items: &[
        ("direct", "the commands"),
        ("heading_by_rudder", "the rudder follows heading_command_rad"),
        ("heading_by_roll_mass", "the roll mass follows heading_command_rad"),
    ],
};

/// The variables.
pub fn space() -> Table {
    static ROWS: LazyLock<[Variable; N_VARIABLES]> = LazyLock::new(|| in_order(build()));
    static TOKEN: LazyLock<Token> = LazyLock::new(|| Token::of(&*ROWS));
    Table { rows: &*ROWS, token: TOKEN.text() }
}

/// Value references of the inputs, in the order of the library's table.
const INPUT_REFERENCES: [u32; N_INPUTS] = [2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17];

/// Value references of the states, in the order of the library's table, and whether each is an output too.
const STATE_ROWS: [(u32, Causality); N_STATES] = [
    (18, Causality::Output),
    (19, Causality::Output),
    (20, Causality::Output),
    (21, Causality::Output),
    (22, Causality::Output),
    (23, Causality::Output),
    (24, Causality::Output),
    (25, Causality::Output),
    (26, Causality::Output),
    (27, Causality::Output),
    (28, Causality::Output),
    (29, Causality::Output),
    (30, Causality::Output),
    (31, Causality::Local),
    (32, Causality::Output),
    (33, Causality::Local),
    (34, Causality::Output),
    (35, Causality::Output),
    (36, Causality::Local),
    (37, Causality::Local),
    (211, Causality::Local),
    (38, Causality::Local),
    (39, Causality::Output),
];

/// States that have another name here than in the library.
const RENAMED: [(&str, &str); 2] =
    [("moving_mass_m", "moving_mass_position_m"), ("roll_mass_rate_rad_s", "roll_mass_speed_rad_s")];

macro_rules! outputs {
    (|$outputs:ident, $inputs:ident| $($reference:literal $name:literal [$unit:literal] $min:literal .. $max:literal, $nominal:literal, $meaning:literal, $value:expr;)*) => {
        /// The calculated numbers that are neither states nor their derivatives, in the order of [`output_array`].
        const OUTPUTS: &[Row] = &[$(($reference, $name, $unit, $min, $max, $nominal, $meaning),)*];

        /// Their values, from what the equations give and from the inputs that act.
        pub fn output_array<T: Number>($outputs: &Outputs<T>, $inputs: &Inputs<T>) -> [T; N_OUTPUTS] {
            [$($value,)*]
        }
    };
}

// To add an output: one more line here, with the next free value reference.
outputs! {
    |outputs, inputs|
    40 "glide_angle_rad" ["rad"] -1000.0 .. 1000.0, 0.1,
        "Glide path angle through the water, negative when descending", outputs.glide_angle_rad;
    41 "angle_of_attack_rad" ["rad"] -3.2 .. 3.2, 0.01,
        "Angle of attack", outputs.angle_of_attack_rad;
    42 "sideslip_rad" ["rad"] -3.2 .. 3.2, 0.01,
        "Sideslip, flow from starboard positive", outputs.sideslip_rad;
    43 "turn_rate_rad_s" ["rad/s"] -1000000.0 .. 1000000.0, 0.01,
        "Rate of change of the heading", outputs.turn_rate_rad_s;
    44 "speed_m_s" ["m/s"] 0.0 .. 200.0, 0.1,
        "Speed through the water", outputs.speed_m_s;
    45 "vertical_velocity_m_s" ["m/s"] -200.0 .. 200.0, 0.1,
        "Rate of change of depth, current included, positive down", outputs.vertical_velocity_m_s;
    46 "net_mass_kg" ["kg"] -1000000.0 .. 1000000.0, 0.1,
        "Net (excess) mass m0, positive when heavy", outputs.net_mass_kg;
    47 "ballast_m3" ["m3"] -1000.0 .. 1000.0, 0.0001,
        "Ballast volume that an instrument reads, positive = more buoyant", outputs.ballast_m3;
    48 "lift_N" ["N"] -1000000000.0 .. 1000000000.0, 1.0,
        "Lift, normal to the path, upward positive", outputs.lift_N;
    49 "drag_N" ["N"] -1000000000.0 .. 1000000000.0, 0.1,
        "Drag, against the path", outputs.drag_N;
    50 "side_force_N" ["N"] -1000000000.0 .. 1000000000.0, 0.1,
        "Side force, to starboard positive", outputs.side_force_N;
    51 "acceleration_1_m_s2" ["m/s2"] -1000000000.0 .. 1000000000.0, 1.0,
        "What an accelerometer at the centre of buoyancy reads along axis 1: acceleration less gravity", outputs.imu_m_s2[0];
    52 "acceleration_2_m_s2" ["m/s2"] -1000000000.0 .. 1000000000.0, 1.0,
        "What an accelerometer at the centre of buoyancy reads along axis 2", outputs.imu_m_s2[1];
    53 "acceleration_3_m_s2" ["m/s2"] -1000000000.0 .. 1000000000.0, 10.0,
        "What an accelerometer at the centre of buoyancy reads along axis 3", outputs.imu_m_s2[2];
    54 "pitch_read_rad" ["rad"] -10000.0 .. 10000.0, 0.1,
        "Pitch as the glider's own instrument reads it", outputs.pitch_read_rad;
    55 "pressure_read_dbar" ["dbar"] -100000.0 .. 100000.0, 10.0,
        "Gauge pressure as the glider's own instrument reads it, without lag", outputs.pressure_read_dbar;
    56 "surrounding_density_kg_m3" ["kg/m3"] 900.0 .. 1300.0, 1000.0,
        "Density of the water that the glider is in, from input or column", inputs.water_density_kg_m3;
    57 "surrounding_temperature_C" ["degC"] -5.0 .. 50.0, 10.0,
        "Temperature of the water that the glider is in, from input or column", inputs.water_temperature_C;
    58 "emerged_fraction" ["1"] 0.0 .. 1.0, 0.1,
        "Share of its displacement that the hull has lost above the water, 0 below the surface", outputs.emerged_fraction;
    59 "seabed_force_N" ["N"] 0.0 .. 1000000000.0, 1.0,
        "Upward force of the seabed on the hull, 0 above it", outputs.seabed_N;
}

const POWER: u32 = 60;
const AT_SURFACE: u32 = 61;
const ON_SEABED: u32 = 62;

macro_rules! derivatives {
    ($($reference:literal $state:literal : $unit:literal),* $(,)?) => {
        [$(($reference, concat!("der(", $state, ")"), $unit, concat!("Time derivative of ", $state))),*]
    };
}

/// Value reference, name, unit and meaning of the derivatives, in the order of the states.
const DERIVATIVES: [(u32, &str, &str, &str); N_STATES] = derivatives![
    63 "north_m": "m/s",
    64 "east_m": "m/s",
    65 "depth_m": "m/s",
    66 "roll_rad": "rad/s",
    67 "pitch_rad": "rad/s",
    68 "heading_rad": "rad/s",
    69 "v1_m_s": "m/s2",
    70 "v2_m_s": "m/s2",
    71 "v3_m_s": "m/s2",
    72 "p_rad_s": "rad/s2",
    73 "q_rad_s": "rad/s2",
    74 "r_rad_s": "rad/s2",
    75 "moving_mass_position_m": "m/s",
    76 "moving_mass_speed_m_s": "m/s2",
    77 "roll_mass_rad": "rad/s",
    78 "roll_mass_speed_rad_s": "rad/s2",
    79 "rudder_rad": "rad/s",
    80 "ballast_mass_kg": "kg/s",
    81 "creep_pressure_Pa": "Pa/s",
    82 "carried_density_kg_m3": "kg/m3/s",
    212 "late_temperature_K": "K/s",
    83 "leaked_back_m3": "m3/s",
    84 "energy_J": "W",
];

/// Value reference, name and meaning of the event indicators.
const INDICATORS: [(u32, &str, &str); N_EVENTS] = [
    (85, "indicator_surface", "Event indicator: changes sign at the surface"),
    (86, "indicator_seabed", "Event indicator: changes sign at the seabed"),
    (
        87,
        "indicator_ballast_down",
        "Event indicator: changes sign where the servo of the ballast reaches or leaves its largest rate downwards",
    ),
    (
        88,
        "indicator_ballast_up",
        "Event indicator: changes sign where the servo of the ballast reaches or leaves its largest rate upwards",
    ),
    (
        89,
        "indicator_moving_mass_down",
        "Event indicator: changes sign where the servo of the moving mass reaches or leaves its largest rate downwards",
    ),
    (
        90,
        "indicator_moving_mass_up",
        "Event indicator: changes sign where the servo of the moving mass reaches or leaves its largest rate upwards",
    ),
    (
        91,
        "indicator_roll_mass_down",
        "Event indicator: changes sign where the servo of the roll mass reaches or leaves its largest rate downwards",
    ),
    (
        92,
        "indicator_roll_mass_up",
        "Event indicator: changes sign where the servo of the roll mass reaches or leaves its largest rate upwards",
    ),
    (
        93,
        "indicator_rudder_down",
        "Event indicator: changes sign where the servo of the rudder reaches or leaves its largest rate downwards",
    ),
    (
        94,
        "indicator_rudder_up",
        "Event indicator: changes sign where the servo of the rudder reaches or leaves its largest rate upwards",
    ),
];

const STEERING_REFERENCE: u32 = 95;
const WATER_SOURCE: u32 = 96;
const START_IN_TRIM: u32 = 97;

const VEHICLE_NAME: u32 = 207;

/// Lateral parameters that make the body what it is: they cannot change while it moves.
const FIXED_LATERAL: &[&str] = &[
    "added_mass_2_kg",
    "roll_inertia_kg_m2",
    "yaw_inertia_kg_m2",
    "added_Y_rdot_kg_m",
    "moving_inertia_1_kg_m2",
    "moving_inertia_2_kg_m2",
    "moving_inertia_3_kg_m2",
    "starboard_moment_kg_m",
    "roll_mass_kg",
    "roll_mass_radius_m",
];

fn build() -> Vec<Variable> {
    let mut table = vec![time()];
    table.extend(inputs(&INPUT_REFERENCES, INPUTS));
    table.extend(STATE_ROWS.iter().zip(STATES).enumerate().map(|(i, ((reference, causality), state))| Variable {
        causality: *causality,
        initial: Some(Initial::Exact),
        ..real(&row_of(*reference, state, &RENAMED), Slot::State(i))
    }));
    table.extend(
        OUTPUTS
            .iter()
            .enumerate()
            .map(|(i, row)| Variable { causality: Causality::Output, ..real(row, Slot::Output(i)) }),
    );
    table.push(power(POWER));
    table.extend(discrete([
        (
            AT_SURFACE,
            "at_surface",
            Kind::Boolean,
            Discrete::AtSurface,
            "Whether the centre of buoyancy is above the surface",
        ),
        (ON_SEABED, "on_seabed", Kind::Boolean, Discrete::OnSeabed, "Whether the hull rests on the seabed"),
    ]));
    table.extend((0..N_STATES).map(|i| derivative(DERIVATIVES[i], i, STATES[i].nominal)));
    table.extend((0..N_EVENTS).map(|i| indicator(INDICATORS[i], i)));
    table.push(steering());
    table.push(Variable { reference: WATER_SOURCE, ..water_source() });
    table.push(Variable { reference: START_IN_TRIM, ..start_in_trim() });
    // The empirical table is that of the plane, to which a log is compared.
    let is_published = |name: &&str| !NOT_PUBLISHED.contains(name) && !EMPIRICAL.contains(name);
    let all = PARAMETERS.iter().chain(LATERAL).enumerate().filter(|(_, info)| is_published(&info.name));
    table.extend(all.map(|(i, info)| {
        let is_fixed = FIXED.contains(&info.name) || FIXED_LATERAL.contains(&info.name);
        parameter(info, i, is_fixed, Model::Space)
    }));
    table.push(Variable { reference: VEHICLE_NAME, ..vehicle_name() });
    table
}

fn steering() -> Variable {
    const MEANING: &str =
        "0 direct: rudder and roll mass follow their commands; 1 heading by rudder; 2 heading by roll mass";
    choice(STEERING_REFERENCE, "steering", MEANING, &STEERING, Slot::Steering)
}
