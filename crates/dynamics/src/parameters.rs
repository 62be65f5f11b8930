//! The numbers that the equations of motion read, in one table: name, unit, meaning, value when nothing is said.
//!
//! The table is the only list of them. The vehicle file fills it, the FMU publishes it, the fits vary it, and each
//! mechanism of [`crate::mechanisms`] is one or two of its rows. Knows nothing of files or of the FMI.

use glidepolar_number::quantities;

quantities! {
    /// The parameters of the equations of motion. Units stand in the names; frame and signs as in [`crate`].
    Parameters, N_PARAMETERS, PARAMETERS {
        // surroundings
        gravity_m_s2: "m/s2" = 9.81 in 0.1 .. 30.0, "Acceleration of gravity";
        reference_density_kg_m3: "kg/m3" = 1027.0 in 900.0 .. 1300.0, "Water density at which the displaced mass and the ballast mass are stated";
        reference_temperature_C: "degC" = 15.0 in -5.0 .. 50.0, "Water temperature at which the displaced volume is stated";
        // geometry
        frontal_area_m2: "m2" = 0.03563 in 1e-5 .. 10.0, "Frontal area of the hull, reference area of all coefficients";
        length_m: "m" = 1.8 in 0.05 .. 30.0, "Overall length of the hull, reference length of the moment coefficients";
        // glide polar
        a_per_rad: "1/rad" = 7.242018134559976 in -100.0 .. 1000.0, "Slope of the lift coefficient, CL = CL0 + a alpha";
        b: "1" = 0.11751199237210526 in 0.0 .. 100.0, "Drag coefficient at zero angle of attack, CD = b + c alpha^2";
        c_per_rad2: "1/rad2" = 1.3664185159547124 in -100.0 .. 10000.0, "Growth of the drag coefficient with the square of the angle of attack";
        d_per_rad: "1/rad" = -1.062769956853665 in -1000.0 .. 1000.0, "Slope of the moment coefficient about the centre of buoyancy, Munk moment included as a tank measures it";
        CL0: "1" = 0.0 in -10.0 .. 10.0, "Lift coefficient at zero angle of attack";
        CM0: "1" = 0.0 in -10.0 .. 10.0, "Moment coefficient at zero angle of attack";
        ascent_a_ratio: "1" = 1.0 in 0.01 .. 100.0, "Lift slope on ascents relative to descents";
        ascent_b_ratio: "1" = 1.0 in 0.01 .. 100.0, "b on ascents relative to descents";
        ascent_c_ratio: "1" = 1.0 in 0.01 .. 100.0, "c on ascents relative to descents";
        ascent_d_ratio: "1" = 1.0 in 0.01 .. 100.0, "d on ascents relative to descents";
        pitch_damping_N_m_s: "N.m.s" = -50.0 in -1e6 .. 1e6, "Pitch damping moment per pitch rate, negative when it damps";
        pitch_damping_quadratic_N_m_s2: "N.m.s2" = -50.0 in -1e6 .. 1e6, "Pitch damping moment per pitch rate times its magnitude, negative when it damps";
        pitch_damping_CMq: "1" = 0.0 in -1e4 .. 1e4, "Moment coefficient per pitch rate made dimensionless by length over speed, negative when it damps";
        pitch_damping_V2_kg_s: "kg.s" = 0.0 in -1e6 .. 1e6, "Pitch damping moment per pitch rate and square of the speed, negative when it damps";
        // masses
        hull_mass_kg: "kg" = 40.0 in 0.01 .. 1e5, "Mass of the hull and all that is fixed in it, without moving mass and ballast";
        moving_mass_kg: "kg" = 9.0 in 1e-3 .. 1e4, "Mass that slides along the hull";
        ballast_nominal_kg: "kg" = 1.0 in 0.0 .. 1e4, "Ballast mass on board when the ballast volume is zero";
        displaced_mass_kg: "kg" = 50.0 in 0.01 .. 1e5, "Mass of water displaced at the reference density and temperature, at the surface, ballast volume zero";
        added_mass_1_kg: "kg" = 5.0 in 0.0 .. 1e5, "Added mass along axis 1";
        added_mass_3_kg: "kg" = 70.0 in 0.0 .. 1e5, "Added mass along axis 3";
        pitch_inertia_kg_m2: "kg.m2" = 12.0 in 1e-6 .. 1e6, "Moment of inertia in pitch of hull and added water about the centre of buoyancy, without the moving mass";
        added_Z_qdot_kg_m: "kg.m" = 0.0 in -1e6 .. 1e6, "Added mass that couples heave and pitch: momentum along axis 3 per pitch rate";
        moving_mass_height_m: "m" = 0.05 in -1.0 .. 1.0, "Offset of the moving mass along axis 3, positive below the centre of buoyancy";
        offset_mass_kg: "kg" = 0.0 in 0.0 .. 1e4, "Part of the fixed mass that sits away from the centre of buoyancy";
        offset_mass_forward_m: "m" = 0.0 in -10.0 .. 10.0, "Position of the offset mass forward of the centre of buoyancy";
        offset_mass_below_m: "m" = 0.0 in -10.0 .. 10.0, "Position of the offset mass below the centre of buoyancy";
        ballast_forward_m: "m" = 0.0 in -10.0 .. 10.0, "Position of the ballast forward of the centre of buoyancy";
        ballast_below_m: "m" = 0.0 in -10.0 .. 10.0, "Position of the ballast below the centre of buoyancy";
        // actuators
        ballast_min_m3: "m3" = -0.0005 in -1.0 .. 1.0, "Smallest ballast volume";
        ballast_max_m3: "m3" = 0.0005 in -1.0 .. 1.0, "Largest ballast volume";
        ballast_rate_m3_s: "m3/s" = 2.4342745861733203e-5 in 1e-12 .. 1.0, "Largest rate of change of the ballast volume";
        moving_mass_min_m: "m" = -0.2 in -10.0 .. 10.0, "Aftmost position of the moving mass";
        moving_mass_max_m: "m" = 0.2 in -10.0 .. 10.0, "Foremost position of the moving mass";
        moving_mass_rate_m_s: "m/s" = 0.02 in 1e-9 .. 10.0, "Largest speed of the moving mass along the hull";
        // energy
        hotel_W: "W" = 0.0 in 0.0 .. 1e4, "Power of everything that runs all the time";
        pump_J_per_m3: "J/m3" = 0.0 in 0.0 .. 1e10, "Energy to pump out a volume at the surface";
        pump_J_per_Pa_m3: "1" = 0.0 in 0.0 .. 1e3, "Energy to pump out a volume per pressure; 1 is the ideal pump";
        pitch_move_J: "J" = 0.0 in 0.0 .. 1e6, "Energy of one move of the moving mass by its servo";
        surfacing_J: "J" = 0.0 in 0.0 .. 1e7, "Energy of one surfacing beyond the hotel power: fix and call";
        rudder_W: "W" = 0.0 in 0.0 .. 1e4, "Mean power of steering under water";
        // mechanisms at sea, without effect by default
        ballast_offset_kg: "kg" = 0.0 in -10.0 .. 10.0, "Error of the trim: net mass beyond what masses and volumes say";
        hull_compressibility_per_Pa: "1/Pa" = 0.0 in -1e-9 .. 5e-9, "Relative loss of displaced volume per gauge pressure";
        hull_thermal_expansion_per_K: "1/K" = 0.0 in -1e-3 .. 1e-3, "Relative gain of displaced volume per temperature";
        ballast_scale: "1" = 1.0 in 0.01 .. 100.0, "True ballast volume over the volume that is read and commanded";
        trapped_air_cc: "cm3" = 0.0 in 0.0 .. 5000.0, "Air volume at the surface that is carried down and compressed by Boyle's law";
        leak_kg_per_hour: "kg/h" = 0.0 in -10.0 .. 10.0, "Water taken in per hour";
        drag_growth_per_day: "1/d" = 0.0 in -1.0 .. 10.0, "Relative growth of drag per day, fouling";
        drag_step: "1" = 0.0 in -0.99 .. 20.0, "Relative jump of drag at the step time, something added, caught or lost";
        step_time_s: "s" = 0.0 in -1e10 .. 1e10, "Time of the jump of drag";
        net_mass_step_kg: "kg" = 0.0 in -10.0 .. 10.0, "Step of the net mass at its time, something with weight lost or caught";
        net_mass_step_time_s: "s" = 0.0 in -1e10 .. 1e10, "Time of the step of the net mass";
        drag_exponent: "1" = 0.0 in -1.0 .. 1.0, "Exponent s of b (q/q0)^s, q0 the dynamic pressure at 0.3 m/s in water of the reference density";
        nonlinear_lift_per_rad2: "1/rad2" = 0.0 in -1000.0 .. 1000.0, "Crossflow lift, CL grows by this times alpha |alpha|";
        climb_dive_drag_ratio: "1" = 1.0 in 0.01 .. 100.0, "Drag on ascents over drag on descents";
        climb_dive_lift_ratio: "1" = 1.0 in 0.01 .. 100.0, "Lift slope on ascents over lift slope on descents";
        hull_creep_per_Pa: "1/Pa" = 0.0 in -1e-8 .. 1e-7, "Relative loss of displaced volume per gauge pressure that comes late, a viscoelastic hull";
        creep_time_s: "s" = 0.0 in 0.0 .. 1e8, "Time constant with which the late loss of volume follows the pressure";
        late_expansion_per_K: "1/K" = 0.0 in 0.0 .. 1e-2, "Part of the relative gain of displaced volume per temperature that comes late, a hull whose inside follows the water slowly";
        expansion_time_s: "s" = 0.0 in 0.0 .. 1e8, "Time constant with which the late part of the hull takes the water's temperature";
        carried_water_m3: "m3" = 0.0 in 0.0 .. 10.0, "Flooded volume whose water exchanges slowly with the water around";
        exchange_time_s: "s" = 0.0 in 0.0 .. 1e8, "Time constant with which the carried water becomes the water around";
        pump_leakback_cc_per_hour: "cm3/h" = 0.0 in 0.0 .. 1e6, "Ballast volume lost per hour since the pump last ran, without being read";
        roll_drag_per_rad2: "1/rad2" = 0.0 in 0.0 .. 1000.0, "Relative growth of drag with the square of the roll angle";
        rudder_drag_per_rad2: "1/rad2" = 0.0 in 0.0 .. 1000.0, "Relative growth of drag with the square of the rudder angle";
        vertical_current_m_s: "m/s" = 0.0 in -2.0 .. 2.0, "Steady vertical motion of the water, positive down";
        density_bias_kg_m3: "kg/m3" = 0.0 in -30.0 .. 30.0, "True water density less the density that is read";
        pitch_scale: "1" = 1.0 in 0.1 .. 10.0, "True pitch is this times the pitch that is read, plus the pitch offset";
        pitch_offset_rad: "rad" = 0.0 in -1.0 .. 1.0, "True pitch less the scaled pitch that is read";
        pressure_scale: "1" = 1.0 in 0.1 .. 10.0, "True pressure over the pressure that is read";
        speed_scale: "1" = 1.0 in 0.1 .. 10.0, "Speed through the water that is read over the true one";
        salinity_drift_per_day: "1/d" = 0.0 in -100.0 .. 100.0, "True practical salinity less the one that is read, growth per day";
        thermal_lag_s: "s" = 0.0 in -1000.0 .. 1000.0, "Time by which the temperature in the conductivity cell follows the one that is read";
        clock_offset_s: "s" = 0.0 in -1e4 .. 1e4, "Time by which the record of the attitude is late against that of the pressure";
        pressure_hysteresis: "1" = 0.0 in -1.0 .. 1.0, "Pressure read too much on an ascent in the middle of its range, relative to that range";
        pressure_lag_s: "s" = 0.0 in 0.0 .. 1000.0, "Time constant with which the pressure that is read follows the true one";
        // what a log shows without a known cause
        empirical_acts_on: "1" = 0.0 in 0.0 .. 3.0, "What the empirical table changes: 0 nothing, 1 drag, 2 lift (both in shares), 3 net mass (in kg)";
        empirical_against: "1" = 0.0 in 0.0 .. 2.0, "What the empirical table goes by: 0 pressure in dbar, 1 time in h, 2 temperature in degC";
        empirical_at_1: "1" = 0.0 in -1e9 .. 1e9, "First point of the empirical table; before it the first value holds";
        empirical_at_2: "1" = 1.0 in -1e9 .. 1e9, "Second point of the empirical table";
        empirical_at_3: "1" = 2.0 in -1e9 .. 1e9, "Third point of the empirical table";
        empirical_at_4: "1" = 3.0 in -1e9 .. 1e9, "Fourth point of the empirical table";
        empirical_at_5: "1" = 4.0 in -1e9 .. 1e9, "Fifth point of the empirical table; beyond it the last value holds";
        empirical_value_1: "1" = 0.0 in -100.0 .. 100.0, "Value of the empirical table at its first point";
        empirical_value_2: "1" = 0.0 in -100.0 .. 100.0, "Value of the empirical table at its second point";
        empirical_value_3: "1" = 0.0 in -100.0 .. 100.0, "Value of the empirical table at its third point";
        empirical_value_4: "1" = 0.0 in -100.0 .. 100.0, "Value of the empirical table at its fourth point";
        empirical_value_5: "1" = 0.0 in -100.0 .. 100.0, "Value of the empirical table at its fifth point";
    }
}

/// The row of [`PARAMETERS`] with this name.
pub fn parameter_index(name: &str) -> Option<usize> {
    PARAMETERS.iter().position(|row| row.name == name)
}

/// Speed at which the drag exponent leaves b as it is [m/s]. Any other choice only rescales b.
pub const DRAG_REFERENCE_SPEED_M_S: f64 = 0.3;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_unique_and_every_default_lies_within_its_bounds() {
        for (i, row) in PARAMETERS.iter().enumerate() {
            assert_eq!(parameter_index(row.name), Some(i), "{} twice", row.name);
            assert!(row.min <= row.default && row.default <= row.max, "{}", row.name);
        }
    }

    #[test]
    fn array_and_index_agree() {
        let mut parameters = Parameters::<f64>::default();
        for i in 0..N_PARAMETERS {
            *parameters.at(i) = i as f64;
        }
        assert_eq!(parameters.as_array(), std::array::from_fn(|i| i as f64));
        assert_eq!(Parameters::from_array(parameters.as_array()), parameters);
    }
}
