//! The quantities that change in time: the state, what acts on the glider from outside, and the modes of its limits.

use glidepolar_number::quantities;

/// How many of them are memory: what the glider keeps of where it has been, at rest where no mechanism needs it.
pub const N_MEMORY: usize = 4;

quantities! {
    /// The state of the glider in the vertical plane (Leonard and Graver's eleven, the memory of
    /// [mechanisms](crate::mechanisms) that go by the past, and the energy drawn).
    ///
    /// Frame: `x_m` and `depth_m` in the inertial frame (depth positive down), the rest in body axes about the centre of
    /// buoyancy. Velocities are relative to the water.
    State, N_STATES, STATES {
        x_m: "m" = 0.0 in -1e9 .. 1e9 ~ 100.0, "Horizontal position";
        depth_m: "m" = 0.0 in -100.0 .. 20000.0 ~ 10.0, "Depth of the centre of buoyancy";
        pitch_rad: "rad" = 0.0 in -1000.0 .. 1000.0 ~ 0.1, "Pitch, nose-up positive";
        pitch_rate_rad_s: "rad/s" = 0.0 in -1000.0 .. 1000.0 ~ 0.01, "Pitch rate";
        v1_m_s: "m/s" = 0.0 in -100.0 .. 100.0 ~ 0.1, "Velocity through the water along axis 1 (forward)";
        v3_m_s: "m/s" = 0.0 in -100.0 .. 100.0 ~ 0.01, "Velocity through the water along axis 3 (down when level)";
        moving_mass_1_m: "m" = 0.0 in -100.0 .. 100.0 ~ 0.01, "Position of the moving mass along axis 1, forward of the centre of buoyancy";
        moving_mass_3_m: "m" = 0.0 in -100.0 .. 100.0 ~ 0.01, "Position of the moving mass along axis 3, below the centre of buoyancy; starts at moving_mass_height_m";
        momentum_1_kg_m_s: "kg.m/s" = 0.0 in -1e9 .. 1e9 ~ 1.0, "Momentum of the moving mass along axis 1; starts with the mass at rest in the hull";
        momentum_3_kg_m_s: "kg.m/s" = 0.0 in -1e9 .. 1e9 ~ 0.1, "Momentum of the moving mass along axis 3; starts with the mass at rest in the hull";
        ballast_mass_kg: "kg" = 0.0 in -1e6 .. 1e6 ~ 0.1, "Ballast mass at the reference density";
        creep_pressure_Pa: "Pa" = 0.0 in -1e9 .. 1e9 ~ 1e5, "Gauge pressure that the late part of the hull has followed so far; rests without hull_creep_per_Pa";
        carried_density_kg_m3: "kg/m3" = 0.0 in -1000.0 .. 1000.0 ~ 0.1, "Density of the carried water brought to p = 0, less the reference density; rests without carried_water_m3";
        late_temperature_K: "K" = 0.0 in -1000.0 .. 1000.0 ~ 1.0, "Temperature of the part of the hull that follows late, less the reference temperature; rests without late_expansion_per_K";
        leaked_back_m3: "m3" = 0.0 in -10.0 .. 10.0 ~ 1e-5, "Ballast volume that has leaked back; rests without pump_leakback_cc_per_hour";
        energy_J: "J" = 0.0 in -1e18 .. 1e18 ~ 1000.0, "Energy drawn from the battery";
    }
}

quantities! {
    /// What acts on the glider from outside: commands and the water at its place. The set-points are those of servo actuation,
    /// forces and ballast rate those of raw actuation ([`Actuation`]).
    Inputs, N_INPUTS, INPUTS {
        ballast_command_m3: "m3" = 0.0 in -10.0 .. 10.0 ~ 1e-4, "Buoyancy-engine set-point, positive = more buoyant (actuation 0)";
        moving_mass_command_m: "m" = 0.0 in -100.0 .. 100.0 ~ 0.01, "Moving-mass set-point along axis 1, positive forward (actuation 0)";
        u1_N: "N" = 0.0 in -1e6 .. 1e6 ~ 1.0, "Force on the moving mass along axis 1: the rate of change of its momentum PP1 (actuation 1 and 2)";
        u3_N: "N" = 0.0 in -1e6 .. 1e6 ~ 1.0, "Force on the moving mass along axis 3: the rate of change of its momentum PP3 (actuation 1)";
        u4_kg_s: "kg/s" = 0.0 in -1000.0 .. 1000.0 ~ 0.01, "Ballast mass rate, positive = heavier (actuation 1 and 2)";
        water_density_kg_m3: "kg/m3" = 1027.0 in 900.0 .. 1300.0 ~ 1000.0, "In-situ water density at the glider (water_source 0)";
        water_temperature_C: "degC" = 15.0 in -5.0 .. 50.0 ~ 10.0, "Water temperature at the glider (water_source 0)";
        current_x_m_s: "m/s" = 0.0 in -10.0 .. 10.0 ~ 0.1, "Horizontal water velocity";
        current_z_m_s: "m/s" = 0.0 in -10.0 .. 10.0 ~ 0.1, "Vertical water velocity, positive down";
        seabed_depth_m: "m" = 6000.0 in 0.0 .. 12000.0 ~ 1000.0, "Depth of the seabed";
        roll_rad: "rad" = 0.0 in -3.2 .. 3.2 ~ 0.1, "Roll angle, for the drag that it costs";
        rudder_rad: "rad" = 0.0 in -3.2 .. 3.2 ~ 0.1, "Rudder angle, for the drag that it costs";
        current_x_shear_1_s: "1/s" = 0.0 in -10.0 .. 10.0 ~ 0.01, "Change of the horizontal water velocity with depth: a glider that sinks through it is accelerated";
        current_x_rate_m_s2: "m/s2" = 0.0 in -10.0 .. 10.0 ~ 0.001, "Change of the horizontal water velocity with time at a fixed depth: the force of accelerating water";
        current_z_rate_m_s2: "m/s2" = 0.0 in -10.0 .. 10.0 ~ 0.001, "Change of the vertical water velocity with time at a fixed depth, positive down: the force of accelerating water";
    }
}

impl Inputs<f64> {
    /// Nothing commanded, in still water of the given density and temperature above a seabed out of reach.
    pub fn still_water(density_kg_m3: f64, temperature_C: f64) -> Self {
        Inputs { water_density_kg_m3: density_kg_m3, water_temperature_C: temperature_C, ..Inputs::default() }
    }
}

/// Who moves the moving mass and the ballast.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Actuation {
    /// Set-points, followed by rate-limited servos; the moving mass slides along axis 1 only.
    #[default]
    Servo,
    /// Forces on the moving mass along both axes and a ballast mass rate, as in Leonard and Graver.
    Raw,
    /// As [`Actuation::Raw`] along axis 1, the offset along axis 3 held: the Simulink paper's moving mass.
    RawAlongAxis1,
}

/// Where a limited quantity stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stop {
    /// Between its limits.
    #[default]
    Free,
    /// At its lower limit and pushed against it.
    AtMin,
    /// At its upper limit and pushed against it.
    AtMax,
}

/// The discrete part of the state. It changes at events only, never between them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Modes {
    /// Ballast volume at one of its limits (raw actuation; a servo never commands beyond them).
    pub ballast: Stop,
    /// Moving mass at one of its stops (raw actuation).
    pub moving_mass: Stop,
}
