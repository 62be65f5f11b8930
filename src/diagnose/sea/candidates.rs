//! Which mechanisms a log could show.

use super::jumps::Jump;
use crate::diagnose::evidence::{Candidate, Version};
use crate::dynamics::{PARAMETERS, Parameters};
use crate::identify::Bin;
use crate::mechanisms::{AT_SEA, Enters};

/// The mechanisms that these data could show, with the row of their parameter.
pub fn of(bins: &[Bin], jumps: &[Jump], parameters: &Parameters<f64>) -> Vec<(Candidate, usize)> {
    let varies = |value: fn(&Bin) -> f64| bins.iter().any(|bin| value(bin).is_finite() && value(bin).abs() > 1e-4);
    let mut found = Vec::new();
    for mechanism in AT_SEA {
        let Some(index) = crate::mechanisms::size_parameter(mechanism) else {
            continue;
        };
        let missing = match mechanism.name {
            "roll_drag" => !varies(|bin| bin.mean.roll_rad),
            "rudder_drag" => !varies(|bin| bin.mean.rudder_rad),
            "thermal_expansion" => !varies(|bin| bin.mean.temperature_C),
            _ => mechanism.enters == Enters::Consistency,
        };
        if missing {
            continue;
        }
        let row = &PARAMETERS[index];
        let version =
            |jump: &Jump| Some(Version { name: "step_time_s", value: jump.time_s, between: jump.between_s, unit: "s" });
        let versions: Vec<Option<Version>> =
            if mechanism.name == "drag_step" { jumps.iter().map(version).collect() } else { vec![None] };
        for version in versions {
            let candidate = Candidate {
                name: mechanism.name,
                parameters: vec![(row.name, row.unit)],
                neutral: vec![*parameters.clone().at(index)],
                usual: vec![mechanism.usual],
                bounds: vec![(row.min, row.max)],
                least: mechanism.least,
                version,
            };
            found.push((candidate, index));
        }
    }
    found
}
