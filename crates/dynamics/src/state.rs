//! The quantities that change in time: the state, what acts on the glider from outside, and the modes of its limits.

use glidepolar_number::Number;

/// How many continuous states there are.
pub const N_STATES: usize = 15;

/// How many of them are memory: what the glider keeps of where it has been, at rest where no mechanism needs it.
pub const N_MEMORY: usize = 3;

/// The state of the glider in the vertical plane (Leonard and Graver's eleven, the memory of
/// [mechanisms](crate::mechanisms) that go by the past, and the energy drawn).
///
/// Frame: `x_m` and `depth_m` in the inertial frame (depth positive down), the rest in body axes about the centre of
/// buoyancy. Velocities are relative to the water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<T> {
    /// Horizontal position \[m\].
    pub x_m: T,
    /// Depth of the centre of buoyancy \[m\].
    pub depth_m: T,
    /// Pitch, nose-up positive \[rad\].
    pub pitch_rad: T,
    /// Pitch rate \[rad/s\].
    pub pitch_rate_rad_s: T,
    /// Velocity through the water along axis 1 \[m/s\].
    pub v1_m_s: T,
    /// Velocity through the water along axis 3 \[m/s\].
    pub v3_m_s: T,
    /// Position of the moving mass along axis 1 \[m\].
    pub moving_mass_1_m: T,
    /// Position of the moving mass along axis 3 \[m\].
    pub moving_mass_3_m: T,
    /// Momentum of the moving mass along axis 1 \[kg m/s\].
    pub momentum_1_kg_m_s: T,
    /// Momentum of the moving mass along axis 3 \[kg m/s\].
    pub momentum_3_kg_m_s: T,
    /// Ballast mass at the reference density \[kg\].
    pub ballast_mass_kg: T,
    /// Gauge pressure that the late part of the hull has followed so far \[Pa\].
    pub creep_pressure_Pa: T,
    /// Density of the carried water brought to p = 0, less the reference density \[kg/m3\].
    pub carried_density_kg_m3: T,
    /// Ballast volume that has leaked back \[m3\].
    pub leaked_back_m3: T,
    /// Energy drawn from the battery \[J\].
    pub energy_J: T,
}

impl<T: Number> State<T> {
    /// All values, in the order in which they are declared.
    pub fn as_array(&self) -> [T; N_STATES] {
        [
            self.x_m,
            self.depth_m,
            self.pitch_rad,
            self.pitch_rate_rad_s,
            self.v1_m_s,
            self.v3_m_s,
            self.moving_mass_1_m,
            self.moving_mass_3_m,
            self.momentum_1_kg_m_s,
            self.momentum_3_kg_m_s,
            self.ballast_mass_kg,
            self.creep_pressure_Pa,
            self.carried_density_kg_m3,
            self.leaked_back_m3,
            self.energy_J,
        ]
    }

    /// The inverse of [`State::as_array`].
    pub fn from_array(values: [T; N_STATES]) -> Self {
        let [
            x_m,
            depth_m,
            pitch_rad,
            pitch_rate_rad_s,
            v1_m_s,
            v3_m_s,
            moving_mass_1_m,
            moving_mass_3_m,
            momentum_1_kg_m_s,
            momentum_3_kg_m_s,
            ballast_mass_kg,
            creep_pressure_Pa,
            carried_density_kg_m3,
            leaked_back_m3,
            energy_J,
        ] = values;
        State {
            x_m,
            depth_m,
            pitch_rad,
            pitch_rate_rad_s,
            v1_m_s,
            v3_m_s,
            moving_mass_1_m,
            moving_mass_3_m,
            momentum_1_kg_m_s,
            momentum_3_kg_m_s,
            ballast_mass_kg,
            creep_pressure_Pa,
            carried_density_kg_m3,
            leaked_back_m3,
            energy_J,
        }
    }

    /// The same state in another kind of number.
    pub fn map<U: Number>(&self, f: impl FnMut(T) -> U) -> State<U> {
        State::from_array(self.as_array().map(f))
    }
}

/// A usual size of each state, the scale on which a tolerance is meant.
pub const STATE_NOMINALS: State<f64> = State {
    x_m: 100.0,
    depth_m: 10.0,
    pitch_rad: 0.1,
    pitch_rate_rad_s: 0.01,
    v1_m_s: 0.1,
    v3_m_s: 0.01,
    moving_mass_1_m: 0.01,
    moving_mass_3_m: 0.01,
    momentum_1_kg_m_s: 1.0,
    momentum_3_kg_m_s: 0.1,
    ballast_mass_kg: 0.1,
    creep_pressure_Pa: 1e5,
    carried_density_kg_m3: 0.1,
    leaked_back_m3: 1e-5,
    energy_J: 1000.0,
};

/// What acts on the glider from outside: commands and the water at its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inputs<T> {
    /// Buoyancy-engine set-point, positive = more buoyant \[m3\] (servo actuation).
    pub ballast_command_m3: T,
    /// Moving-mass set-point along axis 1, positive forward \[m\] (servo actuation).
    pub moving_mass_command_m: T,
    /// Rate of change of the moving mass's momentum along axis 1 \[N\] (raw actuation).
    pub u1_N: T,
    /// Rate of change of the moving mass's momentum along axis 3 \[N\] (raw actuation).
    pub u3_N: T,
    /// Ballast mass rate, positive = heavier \[kg/s\] (raw actuation).
    pub u4_kg_s: T,
    /// In-situ water density as it is read \[kg/m3\].
    pub water_density_kg_m3: T,
    /// Water temperature \[degC\].
    pub water_temperature_C: T,
    /// Horizontal water velocity \[m/s\].
    pub current_x_m_s: T,
    /// Vertical water velocity, positive down \[m/s\].
    pub current_z_m_s: T,
    /// Depth of the seabed \[m\].
    pub seabed_depth_m: T,
    /// Roll angle, for the drag that it costs \[rad\].
    pub roll_rad: T,
    /// Rudder angle, for the drag that it costs \[rad\].
    pub rudder_rad: T,
    /// Change of the horizontal water velocity with depth \[1/s\].
    pub current_x_shear_1_s: T,
    /// Change of the horizontal water velocity with time at a fixed depth \[m/s2\].
    pub current_x_rate_m_s2: T,
    /// Change of the vertical water velocity with time at a fixed depth, positive down \[m/s2\].
    pub current_z_rate_m_s2: T,
}

impl Inputs<f64> {
    /// Nothing commanded, in still water of the given density and temperature above a seabed out of reach.
    pub fn still_water(density_kg_m3: f64, temperature_C: f64) -> Self {
        Inputs {
            ballast_command_m3: 0.0,
            moving_mass_command_m: 0.0,
            u1_N: 0.0,
            u3_N: 0.0,
            u4_kg_s: 0.0,
            water_density_kg_m3: density_kg_m3,
            water_temperature_C: temperature_C,
            current_x_m_s: 0.0,
            current_z_m_s: 0.0,
            seabed_depth_m: 6000.0,
            roll_rad: 0.0,
            rudder_rad: 0.0,
            current_x_shear_1_s: 0.0,
            current_x_rate_m_s2: 0.0,
            current_z_rate_m_s2: 0.0,
        }
    }
}

/// How many inputs there are.
pub const N_INPUTS: usize = 15;

impl<T: Number> Inputs<T> {
    /// All values, in the order in which they are declared.
    pub fn as_array(&self) -> [T; N_INPUTS] {
        [
            self.ballast_command_m3,
            self.moving_mass_command_m,
            self.u1_N,
            self.u3_N,
            self.u4_kg_s,
            self.water_density_kg_m3,
            self.water_temperature_C,
            self.current_x_m_s,
            self.current_z_m_s,
            self.seabed_depth_m,
            self.roll_rad,
            self.rudder_rad,
            self.current_x_shear_1_s,
            self.current_x_rate_m_s2,
            self.current_z_rate_m_s2,
        ]
    }

    /// The inverse of [`Inputs::as_array`].
    pub fn from_array(values: [T; N_INPUTS]) -> Self {
        let [
            ballast_command_m3,
            moving_mass_command_m,
            u1_N,
            u3_N,
            u4_kg_s,
            water_density_kg_m3,
            water_temperature_C,
            current_x_m_s,
            current_z_m_s,
            seabed_depth_m,
            roll_rad,
            rudder_rad,
            current_x_shear_1_s,
            current_x_rate_m_s2,
            current_z_rate_m_s2,
        ] = values;
        Inputs {
            ballast_command_m3,
            moving_mass_command_m,
            u1_N,
            u3_N,
            u4_kg_s,
            water_density_kg_m3,
            water_temperature_C,
            current_x_m_s,
            current_z_m_s,
            seabed_depth_m,
            roll_rad,
            rudder_rad,
            current_x_shear_1_s,
            current_x_rate_m_s2,
            current_z_rate_m_s2,
        }
    }

    /// The same inputs in another kind of number.
    pub fn map<U: Number>(&self, f: impl FnMut(T) -> U) -> Inputs<U> {
        Inputs::from_array(self.as_array().map(f))
    }

    /// These inputs with `rates` times `duration_s` added.
    pub fn plus(&self, rates: &Inputs<T>, duration_s: T) -> Self {
        let (mut values, rates) = (self.as_array(), rates.as_array());
        for (value, rate) in values.iter_mut().zip(rates) {
            *value += rate * duration_s;
        }
        Inputs::from_array(values)
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
