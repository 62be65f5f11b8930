//! What really happened, kept apart from what the analyst is given.

use crate::catalogue::Drawn;
use crate::lateral::LateralFigures;
use crate::ocean::Ocean;
use crate::sensors::Quality;
use crate::vehicle::{Hull, Vehicle};
use serde_json::{Value, json};

/// The truth behind one log.
#[derive(Debug, Clone)]
pub struct Truth {
    /// The seed.
    pub seed: u64,
    /// The hidden effects with their sizes.
    pub effects: Vec<Drawn>,
    /// The kind of glider.
    pub hull: Hull,
    /// The vehicle as it is, effects apart.
    pub vehicle: Vehicle,
    /// The vehicle as the vehicle file has it.
    pub believed: Vehicle,
    /// The water.
    pub ocean: Ocean,
    /// The instruments.
    pub quality: Quality,
    /// Number of dives begun.
    pub dives: u32,
    /// Lateral figures, where roll and yaw follow from equations of motion.
    pub lateral: Option<LateralFigures>,
}

impl Truth {
    /// Names of the hidden effects; empty where nothing is hidden.
    pub fn names(&self) -> Vec<&'static str> {
        self.effects.iter().map(|drawn| drawn.effect.name).collect()
    }

    /// True value of a parameter that is hidden in the log.
    pub fn parameter(&self, name: &str) -> Option<f64> {
        let parameters = self.effects.iter().flat_map(|drawn| &drawn.parameters);
        parameters.into_iter().find(|(parameter, _)| *parameter == name).map(|(_, value)| *value)
    }

    /// True value of a lateral parameter, the glider's own small imperfection in it; of the roll mass with the glider's own list
    /// as that angle of the roll mass which leans it alike.
    pub fn lateral_parameter(&self, name: &str) -> Option<f64> {
        let own = self.lateral?;
        let imperfection = match name {
            "static_list_rad" => own.own_list_rad,
            "rudder_offset_rad" => own.own_rudder_rad,
            "roll_offset_rad" => own.roll_zero_rad,
            "roll_mass_offset_rad" => {
                let below_kg_m = self.vehicle.moving_mass_kg * self.vehicle.moving_mass_height_m;
                own.own_list_rad * below_kg_m / own.rolling_kg_m
            }
            _ => return None,
        };
        Some(self.parameter(name)? + imperfection)
    }

    /// True curvature without roll, of a pod and a rudder off its zero, at a pitch and speed, rad/m; the glider's own small
    /// imperfection in it.
    pub fn curvature_without_roll(&self, pitch_rad: f64, speed_m_s: f64) -> Option<f64> {
        let own = self.lateral?;
        let hidden = |name: &str| self.parameter(name).unwrap_or(0.0);
        let rudder_rad = own.own_rudder_rad + hidden("rudder_offset_rad");
        own.curvature_without_roll(&self.vehicle, hidden("yaw_asymmetry_m3"), rudder_rad, pitch_rad, speed_m_s)
    }

    /// The content of `truth.json`.
    pub fn to_json(&self) -> Value {
        let effects = effects_json(&self.effects);
        json!({
            "seed": self.seed,
            "effects": effects,
            "hull": format!("{:?}", self.hull),
            "vehicle": vehicle_json(&self.vehicle),
            "vehicle_file": vehicle_json(&self.believed),
            "ocean": {
                "wave_rms_m_s": self.ocean.wave_rms_m_s,
                "turbulence_m_s": self.ocean.turbulence_m_s,
                "turbulence_time_s": self.ocean.turbulence_time_s,
                "temperature_range_K": self.ocean.temperature_range_k(),
            },
            "instruments": {
                "interval_s": self.quality.interval_s,
                "pressure_dbar": self.quality.pressure_dbar,
                "pitch_rad": self.quality.pitch_rad,
                "pitch_wander_rad": self.quality.pitch_wander_rad,
                "speed_m_s": self.quality.speed_m_s,
                "speed_wander_m_s": self.quality.speed_wander_m_s,
            },
            "dives": self.dives,
            "lateral": self.lateral.as_ref().map(lateral_json),
        })
    }
}

fn lateral_json(figures: &LateralFigures) -> Value {
    json!({
        "CY_beta_per_rad": figures.side_per_rad,
        "CY_r": figures.side_per_rate,
        "CN_beta_per_rad": figures.yaw_per_rad,
        "CN_r": figures.yaw_per_rate,
        "Cl_p": figures.roll_per_rate,
        "CY_delta_per_rad": figures.side_per_rudder,
        "CN_delta_per_rad": figures.yaw_per_rudder,
        "own_list_rad": figures.own_list_rad,
        "own_rudder_rad": figures.own_rudder_rad,
        "roll_zero_rad": figures.roll_zero_rad,
        "pitch_per_roll": figures.pitch_per_roll,
    })
}

/// The hidden effects with their parameters and definitions.
pub(crate) fn effects_json(effects: &[Drawn]) -> Vec<Value> {
    effects.iter().map(effect_json).collect()
}

fn effect_json(drawn: &Drawn) -> Value {
    let parameters: serde_json::Map<String, Value> =
        drawn.parameters.iter().map(|&(name, value)| (name.to_owned(), json!(value))).collect();
    json!({
        "name": drawn.effect.name,
        "catalogued": drawn.effect.is_catalogued(),
        "definition": drawn.effect.definition,
        "parameters": parameters,
    })
}

fn vehicle_json(vehicle: &Vehicle) -> Value {
    json!({
        "frontal_area_m2": vehicle.frontal_area_m2,
        "length_m": vehicle.length_m,
        "mass_kg": vehicle.mass_kg,
        "displaced_volume_m3": vehicle.displaced_volume_m3,
        "moving_mass_kg": vehicle.moving_mass_kg,
        "moving_mass_height_m": vehicle.moving_mass_height_m,
        "added_mass_1_kg": vehicle.added_mass_1_kg,
        "added_mass_3_kg": vehicle.added_mass_3_kg,
        "pitch_inertia_kg_m2": vehicle.pitch_inertia_kg_m2,
        "a_per_rad": vehicle.a_per_rad,
        "b": vehicle.b,
        "c_per_rad2": vehicle.c_per_rad2,
        "d_per_rad": vehicle.d_per_rad,
        "compressibility_per_Pa": vehicle.compressibility_per_pa,
        "thermal_expansion_per_K": vehicle.thermal_expansion_per_k,
    })
}
