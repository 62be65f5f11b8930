//! The added mass along the hull, held against what a body can have. A file whose `m1_kg` has the glider's own mass in it makes
//! the glider twice as slow to follow its ballast; no fit says so.

use crate::dynamics::Parameters;

/// Added mass along its axis of a sphere over the mass of the water it displaces (Lamb 1932, art. 92). That of any body which is longer
/// than it is wide is smaller: a tenth at a length of three diameters.
const SPHERE: f64 = 0.5;

/// Returns a warning where the added mass along the hull is larger than a body longer than wide can have.
pub(super) fn contradiction(parameters: &Parameters<f64>) -> Option<String> {
    let (added_kg, mass_kg) = (parameters.added_mass_1_kg, parameters.mass_kg());
    (added_kg > SPHERE * mass_kg).then(|| {
        format!(
            "the vehicle's added mass along the hull, `added_mass.m1_kg` = {added_kg:.1} kg, is more than half of its mass of {mass_kg:.1} kg, which no body longer than wide has: it is the water's part alone; is the glider's own mass in it, and in `added_mass.m3_kg`?"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::{Vehicle, builtin};

    #[test]
    fn an_added_mass_that_includes_the_mass_gives_a_warning() {
        for name in builtin::NAMES.iter().copied() {
            let mut vehicle = Vehicle::load(name).expect("a built-in vehicle");
            assert_eq!(contradiction(&vehicle.glide_parameters()), None, "{name}");
            let p = vehicle.glide_parameters();
            vehicle.set("added_mass.m1_kg", p.added_mass_1_kg + p.mass_kg()).expect("a key of a vehicle");
            let warning = contradiction(&vehicle.glide_parameters()).expect("a warning");
            assert!(warning.contains("added_mass.m1_kg"), "{name}: {warning}");
        }
    }
}
