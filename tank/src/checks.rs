//! What cannot be right: signs that no bare hull shows.

use glidepolar::hull_tests::{Estimate, HullFit};

/// Whether the slopes have signs that physics forbids, and which entry of the manifest would explain them.
///
/// A hull lifts to the side to which it drifts, and a bare one is turned further by the Munk moment; no towed body pushes
/// itself forward.
pub fn signs(id: &str, fit: &HullFit) -> Vec<String> {
    let negative = |q: &Estimate| q.ci95[1] < 0.0;
    let mut warnings = Vec::new();
    let told = |what: &str, cause: &str| format!("{id}: {what}: impossible for a bare hull; {cause}");
    match (negative(&fit.a), negative(&fit.d)) {
        (true, true) => warnings.push(told(
            &format!("lift slope a = {:.3} and moment slope d = {:.3} per rad are both negative", fit.a.value, fit.d.value),
            "is the yaw angle counted the other way? Expected: yaw_deg positive bow to starboard, SF positive to starboard, YM positive bow to starboard",
        )),
        (true, false) => warnings.push(told(
            &format!("lift slope a = {:.3} per rad is negative", fit.a.value),
            "is SF recorded with the opposite sign? Expected: positive to starboard, the force of the water on the model",
        )),
        (false, true) => warnings.push(told(
            &format!("moment slope d = {:.3} per rad is negative", fit.d.value),
            "is YM recorded with the opposite sign, or are mc_m and cb_m exchanged? Expected: YM positive bow to starboard, both distances aft of the nose",
        )),
        (false, false) => {}
    }
    if negative(&fit.b) {
        warnings.push(told(
            &format!("drag b = {:.4} is negative", fit.b.value),
            "is AF recorded with the opposite sign? Expected: positive aft, the force of the water on the model",
        ));
    }
    warnings
}
