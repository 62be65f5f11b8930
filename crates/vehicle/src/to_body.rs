//! From a vehicle's figures to the numbers of the equations in six degrees of freedom.

use glidepolar_spatial::{Body, Lateral};

use super::Vehicle;
use super::keys::{KEYS, Need};
use super::to_parameters::MissingKeys;

/// Angle of rudder or roll mass where the file states no limit \[rad\].
const UNLIMITED_RAD: f64 = std::f64::consts::PI;

impl Vehicle {
    /// The numbers of the equations in space.
    ///
    /// # Errors
    /// Where keys are missing that turns need; all of them are listed.
    pub fn body(&self) -> Result<Body<f64>, MissingKeys> {
        let missing: Vec<String> = KEYS
            .iter()
            .filter_map(|key| match key.need {
                Need::ForMotion(purpose) | Need::ForTurns(purpose) if self.get(key.path).is_none() => {
                    Some(format!("`{}` [{}], {purpose}", key.path, key.unit))
                }
                _ => None,
            })
            .collect();
        if !missing.is_empty() {
            return Err(MissingKeys { vehicle: self.name.clone(), purpose: "a turn", keys: missing });
        }
        Ok(Body { plane: self.glide_parameters(), lateral: self.lateral(), rate_law: self.rate_law })
    }

    fn lateral(&self) -> Lateral<f64> {
        let get = |path: &str| self.get(path).unwrap_or(0.0);
        let or = |path: &str, value: f64| self.get(path).unwrap_or(value);
        let on_leg = |leg: &str, name: &str| or(&format!("lateral.{leg}.{name}"), get(&format!("lateral.{name}")));
        let (down, up) = (|name: &str| on_leg("descent", name), |name: &str| on_leg("ascent", name));
        let [i1, i2, i3] = self.moving_mass_inertia_kg_m2.unwrap_or_default();
        Lateral {
            CY_beta_per_rad: down("CY_beta_per_rad"),
            Cl_beta_per_rad: down("Cl_beta_per_rad"),
            CN_beta_per_rad: down("CN_beta_per_rad"),
            CY_r: down("CY_r"),
            CN_r: down("CN_r"),
            Cl_p: down("Cl_p"),
            Cl_r: down("Cl_r"),
            CN_p: down("CN_p"),
            ascent_CY_beta_per_rad: up("CY_beta_per_rad"),
            ascent_Cl_beta_per_rad: up("Cl_beta_per_rad"),
            ascent_CN_beta_per_rad: up("CN_beta_per_rad"),
            ascent_CY_r: up("CY_r"),
            ascent_CN_r: up("CN_r"),
            ascent_Cl_p: up("Cl_p"),
            ascent_Cl_r: up("Cl_r"),
            ascent_CN_p: up("CN_p"),
            added_mass_2_kg: get("lateral.m2_kg"),
            roll_inertia_kg_m2: get("lateral.roll_inertia_kg_m2"),
            yaw_inertia_kg_m2: get("lateral.yaw_inertia_kg_m2"),
            added_Y_rdot_kg_m: get("lateral.Y_rdot_kg_m"),
            moving_inertia_1_kg_m2: i1,
            moving_inertia_2_kg_m2: i2,
            moving_inertia_3_kg_m2: i3,
            starboard_moment_kg_m: get("mass.mass_kg") * get("mass.cg_starboard_m"),
            rudder_CY_per_rad: get("rudder.CY_delta_per_rad"),
            rudder_CN_per_rad: get("rudder.CN_delta_per_rad"),
            rudder_Cl_per_rad: get("rudder.Cl_delta_per_rad"),
            rudder_min_rad: or("rudder.min_rad", -UNLIMITED_RAD),
            rudder_max_rad: or("rudder.max_rad", UNLIMITED_RAD),
            // A rudder or a roll mass that is not there rests whatever its rate.
            rudder_rate_rad_s: or("rudder.rate_rad_s", Lateral::default().rudder_rate_rad_s),
            rudder_power_W: get("rudder.power_W"),
            rudder_offset_rad: get("rudder.offset_rad"),
            roll_mass_kg: get("roll_mass.mass_kg"),
            roll_mass_radius_m: get("roll_mass.radius_m"),
            roll_mass_min_rad: or("roll_mass.min_rad", -UNLIMITED_RAD),
            roll_mass_max_rad: or("roll_mass.max_rad", UNLIMITED_RAD),
            roll_mass_rate_rad_s: or("roll_mass.rate_rad_s", Lateral::default().roll_mass_rate_rad_s),
            roll_mass_power_W: get("roll_mass.power_W"),
            roll_mass_offset_rad: get("roll_mass.offset_rad"),
            ..Lateral::default()
        }
    }
}
