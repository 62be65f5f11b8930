//! From a vehicle's figures to the numbers of the equations of motion.

use super::Vehicle;
use super::keys::{self, KEYS, Need};
use glidepolar_dynamics::limits::reversed;
use glidepolar_dynamics::{Parameters, parameter_index};

/// Keys that time histories or turns need and the vehicle file does not give.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the vehicle `{vehicle}` lacks what {purpose} needs: {}", .keys.join("; "))]
pub struct MissingKeys {
    /// The vehicle's name.
    pub vehicle: String,
    /// What was asked for: a time history, a turn.
    pub purpose: &'static str,
    /// Each missing key with its unit and what it is needed for.
    pub keys: Vec<String>,
}

impl Vehicle {
    /// What is wrong with the limits of ballast or moving mass, where they stand the wrong way round.
    pub(super) fn reversed_limits(&self) -> Option<String> {
        for table in ["rudder", "roll_mass"] {
            let [low, high] = ["min_rad", "max_rad"].map(|end| self.get(&format!("{table}.{end}")));
            if let (Some(low), Some(high)) = (low, high)
                && low > high
            {
                return Some(format!("`{table}.max_rad` = {high} rad lies below `{table}.min_rad` = {low} rad"));
            }
        }
        let [(low, least), (high, largest)] = reversed(&self.glide_parameters())?;
        // In the units of the file, to the figures that a conversion leaves.
        let shown =
            |name: &str, value: f64| match name.strip_suffix("_m3").and_then(|name| name.strip_prefix("ballast_")) {
                Some(end) => format!("`ballast.{end}_cc` = {} cm3", (value * 1e12).round() / 1e6),
                None => format!("`{}` = {value} m", name.replacen("moving_mass_", "moving_mass.", 1)),
            };
        Some(format!("{} lies below {}", shown(high, largest), shown(low, least)))
    }

    /// The numbers of the equations of motion.
    ///
    /// # Errors
    /// Where keys are missing that only a time history needs; steady glides do with [`Vehicle::glide_parameters`].
    pub fn parameters(&self) -> Result<Parameters<f64>, MissingKeys> {
        let missing: Vec<String> = KEYS
            .iter()
            .filter_map(|key| match key.need {
                Need::ForMotion(purpose) if self.get(key.path).is_none() => {
                    Some(format!("`{}` [{}], {purpose}", key.path, key.unit))
                }
                _ => None,
            })
            .collect();
        if missing.is_empty() {
            Ok(self.glide_parameters())
        } else {
            Err(MissingKeys { vehicle: self.name.clone(), purpose: "a time history", keys: missing })
        }
    }

    /// The numbers of a steady glide; what only motion needs and the file leaves out has no effect on it: no added
    /// mass, a moving mass of a fifth of the vehicle at the height of the centre of buoyancy, unlimited actuators.
    pub fn glide_parameters(&self) -> Parameters<f64> {
        let get = |path: &str| self.get(path).unwrap_or(0.0);
        let or = |path: &str, value: f64| self.get(path).unwrap_or(value);
        let s = &self.sections;
        let density = get("mass.reference_density_kg_m3");
        let moving_mass_kg = or("mass.moving_mass_kg", get("mass.mass_kg") / 5.0);
        let ballast_nominal_kg = get("ballast.nominal_kg");
        let hull_mass_kg = get("mass.mass_kg") - moving_mass_kg - ballast_nominal_kg;
        let moving_mass_height_m = get("mass.moving_mass_height_m");

        // The height of the centre of gravity, where known, says more than a single offset mass: all of the hull sits
        // where it gives the whole vehicle that height.
        let offset = get("mass.offset_mass_kg");
        let [forward, below] = ["mass.offset_mass_forward_m", "mass.offset_mass_below_m"].map(get);
        let (offset_mass_kg, offset_mass_forward_m, offset_mass_below_m) = match s.mass {
            keys::Mass { cg_below_cb_m: None, cg_forward_m: None, .. } => (offset, forward, below),
            keys::Mass { cg_below_cb_m, cg_forward_m, .. } => {
                let whole = get("mass.mass_kg");
                let below =
                    cg_below_cb_m.map_or(offset * below, |cg| whole * cg - moving_mass_kg * moving_mass_height_m);
                let forward = cg_forward_m.map_or(offset * forward, |cg| whole * cg);
                (hull_mass_kg, forward / hull_mass_kg, below / hull_mass_kg)
            }
        };
        // Turned by the roll mass, the moving mass's own inertia changes its axes: only the vertical plane has it here.
        let own_inertia = self.moving_mass_inertia_kg_m2.map_or(0.0, |[_, pitch, _]| pitch);

        let mut parameters = Parameters {
            gravity_m_s2: get("mass.gravity_m_s2"),
            reference_density_kg_m3: density,
            reference_temperature_C: get("hull.reference_temperature_C"),
            frontal_area_m2: get("geometry.frontal_area_m2"),
            length_m: get("geometry.length_m"),
            a_per_rad: s.descent.a_per_rad.unwrap_or(get("hydro.a_per_rad")),
            b: s.descent.b.unwrap_or(get("hydro.b")),
            c_per_rad2: s.descent.c_per_rad2.unwrap_or(get("hydro.c_per_rad2")),
            d_per_rad: s.descent.d_per_rad.unwrap_or(get("hydro.d_per_rad")),
            CL0: get("hydro.CL0"),
            CM0: get("hydro.CM0"),
            pitch_damping_N_m_s: get("hydro.pitch_damping"),
            pitch_damping_quadratic_N_m_s2: get("hydro.pitch_damping_quadratic"),
            pitch_damping_CMq: get("hydro.pitch_damping_CMq"),
            pitch_damping_V2_kg_s: get("hydro.pitch_damping_V2"),
            hull_mass_kg,
            moving_mass_kg,
            ballast_nominal_kg,
            displaced_mass_kg: get("mass.displaced_volume_m3") * density,
            added_mass_1_kg: get("added_mass.m1_kg"),
            added_mass_3_kg: get("added_mass.m3_kg"),
            pitch_inertia_kg_m2: or("added_mass.pitch_inertia_kg_m2", 1.0) + own_inertia,
            added_Z_qdot_kg_m: get("lateral.Z_qdot_kg_m"),
            moving_mass_height_m,
            offset_mass_kg,
            offset_mass_forward_m,
            offset_mass_below_m,
            ballast_forward_m: get("ballast.forward_m"),
            ballast_below_m: get("ballast.below_m"),
            ballast_min_m3: or("ballast.min_cc", -1e4) * 1e-6,
            ballast_max_m3: or("ballast.max_cc", 1e4) * 1e-6,
            ballast_rate_m3_s: or("ballast.rate_cc_s", 10.0) * 1e-6,
            moving_mass_min_m: or("moving_mass.min_m", -10.0),
            moving_mass_max_m: or("moving_mass.max_m", 10.0),
            moving_mass_rate_m_s: or("moving_mass.rate_m_s", 0.01),
            hotel_W: get("energy.hotel_W"),
            pump_J_per_m3: get("energy.pump_J_per_cc") * 1e6,
            // 1 dbar is 1e4 Pa, 1 cm3 is 1e-6 m3.
            pump_J_per_Pa_m3: get("energy.pump_J_per_dbar_cc") * 100.0,
            pitch_move_J: get("energy.pitch_move_J"),
            surfacing_J: get("energy.surfacing_J"),
            rudder_W: get("energy.rudder_W"),
            hull_compressibility_per_Pa: get("hull.compressibility_per_Pa"),
            hull_thermal_expansion_per_K: get("hull.thermal_expansion_per_K"),
            ..Parameters::default()
        };
        let ratio = |ascent: Option<f64>, both: f64, descent: f64| {
            let ascent = ascent.unwrap_or(both);
            if descent == ascent { 1.0 } else { ascent / descent }
        };
        parameters.ascent_a_ratio = ratio(s.ascent.a_per_rad, get("hydro.a_per_rad"), parameters.a_per_rad);
        parameters.ascent_b_ratio = ratio(s.ascent.b, get("hydro.b"), parameters.b);
        parameters.ascent_c_ratio = ratio(s.ascent.c_per_rad2, get("hydro.c_per_rad2"), parameters.c_per_rad2);
        parameters.ascent_d_ratio = ratio(s.ascent.d_per_rad, get("hydro.d_per_rad"), parameters.d_per_rad);
        // A mechanism's value is the whole of that parameter: it replaces what [hull] says.
        for (name, value) in &self.mechanisms {
            *parameters.at(parameter_index(name).expect("a mechanism parameter is a parameter")) = *value;
        }
        parameters
    }
}
