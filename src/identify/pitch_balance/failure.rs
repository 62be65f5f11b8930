//! Whether a balance that was fitted is one: a residual that beats the spread of the pitch itself, and arms inside of the
//! hull. Knows the fit and its samples; no start and no error.

use super::PitchBalance;
use crate::identify::data::Dive;
use crate::log::Observation;

/// Accuracy of a glider's attitude sensor \[rad\]: makers state 0.5 to 1 degree. A residual below it is good, whatever the pitch does.
const SENSOR_RAD: f64 = 0.0175;

/// Returns why the balance identifies nothing; nothing where it does.
pub(super) fn failure(balance: &PitchBalance, dives: &[Dive]) -> Option<String> {
    let (p, free) = (&balance.fit.parameters, |name: &str| balance.fit.position(name).is_some());
    let spread_rad = spread_rad(dives);
    if balance.pitch_rms_rad > SENSOR_RAD && balance.pitch_rms_rad >= spread_rad {
        return Some(format!(
            "it predicts the pitch within {:.1} deg rms, no better than the mean pitch of descents and that of ascents do, {:.1} deg: battery position, its sign or unit, or the moving mass is another",
            balance.pitch_rms_rad.to_degrees(),
            spread_rad.to_degrees()
        ));
    }
    let arms = [("ballast_forward_m", p.ballast_forward_m), ("offset_mass_forward_m", p.offset_mass_forward_m)];
    if let Some((name, arm_m)) = arms.iter().find(|(name, arm_m)| free(name) && arm_m.abs() > p.length_m) {
        return Some(format!(
            "`{name}` = {arm_m:.2} m would lie outside of the hull of {:.2} m: battery position or its unit, the ballast volume or the moving mass is another",
            p.length_m
        ));
    }
    let diameter_m = (4.0 * p.frontal_area_m2 / std::f64::consts::PI).sqrt();
    let (below_m, se_m) = balance.cg_below_cb_m();
    if below_m.abs() > diameter_m || below_m + 2.0 * se_m < 0.0 {
        return Some(format!(
            "the centre of gravity would lie {:.0} mm below the centre of buoyancy, in a hull of {:.0} mm diameter: battery position, its sign or unit, or the moving mass is another",
            below_m * 1e3,
            diameter_m * 1e3
        ));
    }
    None
}

/// Root mean square of the pitch about its mean on descents and about that on ascents \[rad\].
fn spread_rad(dives: &[Dive]) -> f64 {
    let of = |descends: bool| {
        let of_leg = |o: &&Observation| o.descends() == descends;
        let pitches = || dives.iter().flat_map(|dive| &dive.observations).filter(of_leg).map(|o| o.pitch_rad);
        let n = pitches().count();
        let mean = pitches().sum::<f64>() / n.max(1) as f64;
        (n, pitches().map(|pitch| (pitch - mean).powi(2)).sum::<f64>())
    };
    let ((down, down_squares), (up, up_squares)) = (of(true), of(false));
    ((down_squares + up_squares) / (down + up).max(1) as f64).sqrt()
}
