//! What changes: the state of the glider in space and what acts on it from outside.

use glidepolar_number::Number;

macro_rules! numbers {
    ($(#[$top:meta])* $Name:ident, $COUNT:ident, $NAMES:ident { $($(#[$doc:meta])* $name:ident,)* }) => {
        $(#[$top])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $Name<T> {
            $($(#[$doc])* pub $name: T,)*
        }

        const $NAMES: &[&str] = &[$(stringify!($name),)*];

        /// How many there are.
        pub const $COUNT: usize = $NAMES.len();

        impl $Name<f64> {
            /// [`Self::as_array`] where a constant is wanted.
            pub const fn into_array(self) -> [f64; $COUNT] {
                [$(self.$name,)*]
            }
        }

        impl<T: Number> $Name<T> {
            /// Their names, in the order in which they are declared.
            pub const NAMES: &[&str] = $NAMES;

            /// All values, in the order in which they are declared.
            pub fn as_array(&self) -> [T; $COUNT] {
                [$(self.$name,)*]
            }

            /// The inverse of `as_array`.
            pub fn from_array(values: [T; $COUNT]) -> Self {
                let [$($name,)*] = values;
                $Name { $($name,)* }
            }

            /// These with `rates` times `duration_s` added.
            pub fn plus(&self, rates: &$Name<T>, duration_s: T) -> Self {
                let (mut values, rates) = (self.as_array(), rates.as_array());
                for (value, rate) in values.iter_mut().zip(rates) {
                    *value += rate * duration_s;
                }
                $Name::from_array(values)
            }

            /// The same in another kind of number.
            pub fn map<U: Number>(&self, f: impl FnMut(T) -> U) -> $Name<U> {
                $Name::from_array(self.as_array().map(f))
            }
        }
    };
}

numbers! {
    /// The state in space. Velocities and rates are in body axes about the centre of buoyancy, velocities through the water.
    State, N_STATES, STATE_NAMES {
        /// Way north \[m\].
        north_m,
        /// Way east \[m\].
        east_m,
        /// Depth of the centre of buoyancy \[m\].
        depth_m,
        /// Roll, starboard down positive \[rad\].
        roll_rad,
        /// Pitch, nose-up positive, within a quarter turn \[rad\].
        pitch_rad,
        /// Heading, clockwise from north, continuous over full turns \[rad\].
        heading_rad,
        /// Velocity through the water along axis 1 \[m/s\].
        v1_m_s,
        /// Velocity through the water along axis 2 \[m/s\].
        v2_m_s,
        /// Velocity through the water along axis 3 \[m/s\].
        v3_m_s,
        /// Rate about axis 1 \[rad/s\].
        p_rad_s,
        /// Rate about axis 2 \[rad/s\].
        q_rad_s,
        /// Rate about axis 3 \[rad/s\].
        r_rad_s,
        /// Place of the moving mass along axis 1 \[m\].
        moving_mass_m,
        /// Speed of the moving mass along axis 1, in the hull \[m/s\].
        moving_mass_speed_m_s,
        /// Angle of the roll mass, to starboard positive \[rad\].
        roll_mass_rad,
        /// Rate of the roll mass \[rad/s\].
        roll_mass_rate_rad_s,
        /// Rudder angle, positive turns the bow to starboard \[rad\].
        rudder_rad,
        /// Ballast mass at the reference density \[kg\].
        ballast_mass_kg,
        /// Gauge pressure that the late part of the hull has followed so far \[Pa\].
        creep_pressure_Pa,
        /// Density of the carried water brought to p = 0, less the reference density \[kg/m3\].
        carried_density_kg_m3,
        /// Ballast volume that has leaked back \[m3\].
        leaked_back_m3,
        /// Energy drawn from the battery \[J\].
        energy_J,
    }
}

numbers! {
    /// What acts on the glider from outside: set-points and the water at its place.
    Inputs, N_INPUTS, INPUT_NAMES {
        /// Ballast volume, positive = more buoyant \[m3\].
        ballast_command_m3,
        /// Place of the moving mass \[m\].
        moving_mass_command_m,
        /// Angle of the roll mass \[rad\].
        roll_mass_command_rad,
        /// Rudder angle \[rad\].
        rudder_command_rad,
        /// Heading that the autopilot holds, over full turns or within one \[rad\].
        heading_command_rad,
        /// In-situ water density as it is read \[kg/m3\].
        water_density_kg_m3,
        /// Water temperature \[degC\].
        water_temperature_C,
        /// Current to the north \[m/s\].
        current_north_m_s,
        /// Current to the east \[m/s\].
        current_east_m_s,
        /// Current downwards \[m/s\].
        current_down_m_s,
        /// Growth of the current to the north with depth \[1/s\].
        current_north_shear_1_s,
        /// Growth of the current to the east with depth \[1/s\].
        current_east_shear_1_s,
        /// Rate of change of the current to the north at a fixed place \[m/s2\].
        current_north_rate_m_s2,
        /// Rate of change of the current to the east at a fixed place \[m/s2\].
        current_east_rate_m_s2,
        /// Rate of change of the current downwards at a fixed place \[m/s2\].
        current_down_rate_m_s2,
        /// Depth of the seabed \[m\].
        seabed_depth_m,
    }
}

impl State<f64> {
    /// A state of the vertical plane, its moving mass at rest in the hull, as one in space that heads north.
    pub fn in_glide(plane: &glidepolar_dynamics::State<f64>) -> Self {
        State {
            north_m: plane.x_m,
            depth_m: plane.depth_m,
            pitch_rad: plane.pitch_rad,
            q_rad_s: plane.pitch_rate_rad_s,
            v1_m_s: plane.v1_m_s,
            v3_m_s: plane.v3_m_s,
            moving_mass_m: plane.moving_mass_1_m,
            ballast_mass_kg: plane.ballast_mass_kg,
            creep_pressure_Pa: plane.creep_pressure_Pa,
            carried_density_kg_m3: plane.carried_density_kg_m3,
            leaked_back_m3: plane.leaked_back_m3,
            energy_J: plane.energy_J,
            ..State::from_array([0.0; N_STATES])
        }
    }
}

impl Inputs<f64> {
    /// The inputs of the vertical plane as those of a glider that heads north, roll mass and rudder amidships.
    pub fn in_glide(plane: &glidepolar_dynamics::Inputs<f64>) -> Self {
        Inputs {
            ballast_command_m3: plane.ballast_command_m3,
            moving_mass_command_m: plane.moving_mass_command_m,
            current_north_m_s: plane.current_x_m_s,
            current_down_m_s: plane.current_z_m_s,
            current_north_shear_1_s: plane.current_x_shear_1_s,
            current_north_rate_m_s2: plane.current_x_rate_m_s2,
            current_down_rate_m_s2: plane.current_z_rate_m_s2,
            seabed_depth_m: plane.seabed_depth_m,
            ..Inputs::still_water(plane.water_density_kg_m3, plane.water_temperature_C)
        }
    }

    /// Nothing commanded, in still water of the given density and temperature above a seabed out of reach.
    pub fn still_water(density_kg_m3: f64, temperature_C: f64) -> Self {
        let mut inputs = Inputs::from_array([0.0; N_INPUTS]);
        inputs.water_density_kg_m3 = density_kg_m3;
        inputs.water_temperature_C = temperature_C;
        inputs.seabed_depth_m = 6000.0;
        inputs
    }
}

/// The magnitude of each state, the scale on which a tolerance is meant.
pub const NOMINALS: State<f64> = State {
    north_m: 100.0,
    east_m: 100.0,
    depth_m: 10.0,
    roll_rad: 0.1,
    pitch_rad: 0.1,
    heading_rad: 0.1,
    v1_m_s: 0.1,
    v2_m_s: 0.01,
    v3_m_s: 0.01,
    p_rad_s: 0.01,
    q_rad_s: 0.01,
    r_rad_s: 0.01,
    moving_mass_m: 0.01,
    moving_mass_speed_m_s: 0.01,
    roll_mass_rad: 0.1,
    roll_mass_rate_rad_s: 0.1,
    rudder_rad: 0.1,
    ballast_mass_kg: 0.1,
    creep_pressure_Pa: 1e5,
    carried_density_kg_m3: 0.1,
    leaked_back_m3: 1e-5,
    energy_J: 1000.0,
};
