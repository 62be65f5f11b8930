//! What changes: the state of the glider in space and what acts on it from outside.

use glidepolar_number::quantities;

quantities! {
    /// The state in space. Velocities and rates are in body axes about the centre of buoyancy, velocities through the water.
    State, N_STATES, STATES {
        north_m: "m" = 0.0 in -1e9 .. 1e9 ~ 100.0, "Way north";
        east_m: "m" = 0.0 in -1e9 .. 1e9 ~ 100.0, "Way east";
        depth_m: "m" = 0.0 in -100.0 .. 20000.0 ~ 10.0, "Depth of the centre of buoyancy";
        roll_rad: "rad" = 0.0 in -1000.0 .. 1000.0 ~ 0.1, "Roll, starboard down positive";
        pitch_rad: "rad" = 0.0 in -1000.0 .. 1000.0 ~ 0.1, "Pitch, nose-up positive";
        heading_rad: "rad" = 0.0 in -1e6 .. 1e6 ~ 0.1, "Heading, clockwise from north, continuous over full turns";
        v1_m_s: "m/s" = 0.0 in -100.0 .. 100.0 ~ 0.1, "Velocity through the water along axis 1 (forward)";
        v2_m_s: "m/s" = 0.0 in -100.0 .. 100.0 ~ 0.01, "Velocity through the water along axis 2 (to starboard)";
        v3_m_s: "m/s" = 0.0 in -100.0 .. 100.0 ~ 0.01, "Velocity through the water along axis 3 (down when level)";
        p_rad_s: "rad/s" = 0.0 in -1000.0 .. 1000.0 ~ 0.01, "Rate about axis 1";
        q_rad_s: "rad/s" = 0.0 in -1000.0 .. 1000.0 ~ 0.01, "Rate about axis 2";
        r_rad_s: "rad/s" = 0.0 in -1000.0 .. 1000.0 ~ 0.01, "Rate about axis 3";
        moving_mass_m: "m" = 0.0 in -100.0 .. 100.0 ~ 0.01, "Position of the moving mass along axis 1, forward of the centre of buoyancy";
        moving_mass_speed_m_s: "m/s" = 0.0 in -100.0 .. 100.0 ~ 0.01, "Speed of the moving mass in the hull";
        roll_mass_rad: "rad" = 0.0 in -100.0 .. 100.0 ~ 0.1, "Angle of the roll mass, to starboard positive";
        roll_mass_rate_rad_s: "rad/s" = 0.0 in -100.0 .. 100.0 ~ 0.1, "Rate of the roll mass";
        rudder_rad: "rad" = 0.0 in -100.0 .. 100.0 ~ 0.1, "Rudder angle, positive turns the bow to starboard";
        ballast_mass_kg: "kg" = 0.0 in -1e6 .. 1e6 ~ 0.1, "Ballast mass at the reference density";
        creep_pressure_Pa: "Pa" = 0.0 in -1e9 .. 1e9 ~ 1e5, "Gauge pressure that the late part of the hull has followed so far; rests without hull_creep_per_Pa";
        carried_density_kg_m3: "kg/m3" = 0.0 in -1000.0 .. 1000.0 ~ 0.1, "Density of the carried water brought to p = 0, less the reference density; rests without carried_water_m3";
        late_temperature_K: "K" = 0.0 in -1000.0 .. 1000.0 ~ 1.0, "Temperature of the part of the hull that follows late, less the reference temperature; rests without late_expansion_per_K";
        leaked_back_m3: "m3" = 0.0 in -10.0 .. 10.0 ~ 1e-5, "Ballast volume that has leaked back; rests without pump_leakback_cc_per_hour";
        energy_J: "J" = 0.0 in -1e18 .. 1e18 ~ 1000.0, "Energy drawn from the battery, by rudder and roll mass, too";
    }
}

quantities! {
    /// What acts on the glider from outside: set-points and the water at its place.
    Inputs, N_INPUTS, INPUTS {
        ballast_command_m3: "m3" = 0.0 in -10.0 .. 10.0 ~ 1e-4, "Buoyancy-engine set-point, positive = more buoyant";
        moving_mass_command_m: "m" = 0.0 in -100.0 .. 100.0 ~ 0.01, "Moving-mass set-point along axis 1, positive forward";
        roll_mass_command_rad: "rad" = 0.0 in -6.3 .. 6.3 ~ 0.1, "Roll-mass set-point, positive to starboard (steering 0 and 1)";
        rudder_command_rad: "rad" = 0.0 in -3.2 .. 3.2 ~ 0.1, "Rudder set-point, positive turns the bow to starboard (steering 0 and 2)";
        heading_command_rad: "rad" = 0.0 in -1e6 .. 1e6 ~ 1.0, "Heading that is held, clockwise from north, over full turns or within one (steering 1 and 2)";
        water_density_kg_m3: "kg/m3" = 1027.0 in 900.0 .. 1300.0 ~ 1000.0, "In-situ water density at the glider (water_source 0)";
        water_temperature_C: "degC" = 15.0 in -5.0 .. 50.0 ~ 10.0, "Water temperature at the glider (water_source 0)";
        current_north_m_s: "m/s" = 0.0 in -10.0 .. 10.0 ~ 0.1, "Water velocity to the north";
        current_east_m_s: "m/s" = 0.0 in -10.0 .. 10.0 ~ 0.1, "Water velocity to the east";
        current_down_m_s: "m/s" = 0.0 in -10.0 .. 10.0 ~ 0.1, "Vertical water velocity, positive down";
        current_north_shear_1_s: "1/s" = 0.0 in -10.0 .. 10.0 ~ 0.01, "Change of the velocity to the north with depth: a glider that sinks through it is accelerated";
        current_east_shear_1_s: "1/s" = 0.0 in -10.0 .. 10.0 ~ 0.01, "Change of the velocity to the east with depth: a glider that sinks through it is accelerated";
        current_north_rate_m_s2: "m/s2" = 0.0 in -10.0 .. 10.0 ~ 0.001, "Change of the velocity to the north with time at a fixed place: the force of accelerating water";
        current_east_rate_m_s2: "m/s2" = 0.0 in -10.0 .. 10.0 ~ 0.001, "Change of the velocity to the east with time at a fixed place: the force of accelerating water";
        current_down_rate_m_s2: "m/s2" = 0.0 in -10.0 .. 10.0 ~ 0.001, "Change of the vertical velocity with time at a fixed place, positive down: the force of accelerating water";
        seabed_depth_m: "m" = 6000.0 in 0.0 .. 12000.0 ~ 1000.0, "Depth of the seabed";
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
            late_temperature_K: plane.late_temperature_K,
            leaked_back_m3: plane.leaked_back_m3,
            energy_J: plane.energy_J,
            ..State::default()
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
        Inputs { water_density_kg_m3: density_kg_m3, water_temperature_C: temperature_C, ..Inputs::default() }
    }
}
