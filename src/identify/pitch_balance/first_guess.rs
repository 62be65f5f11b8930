//! Where the fit of the balance begins: the same balance as a linear regression. Knows no errors.

use crate::dynamics::{Parameters, parameter_index};
use crate::glide::SteadyGlider;
use crate::identify::data::Dive;
use crate::identify::joint::Question;
use crate::identify::model::Inertia;
use crate::identify::model::{predict, true_pitch_rad};
use glidepolar_inference::covariance::solve_symmetric;
use glidepolar_inference::gram::Gram;

/// Linear regression of tan pitch on the position of the battery, with the ballast and the hydrodynamic moment where
/// asked for; `S3 = -m_p / slope`.
pub(super) fn first_guess(
    polar: &Parameters<f64>,
    dives: &[Dive],
    ballast: bool,
    moment: bool,
) -> Option<Parameters<f64>> {
    let mut gram = Gram::new(4);
    let glider = SteadyGlider::new(*polar);
    for o in dives.iter().flat_map(|dive| &dive.observations) {
        let pitch: f64 = true_pitch_rad(polar, o.pitch_rad);
        let Some(flown) = predict(&glider, o, &Inertia::NONE, None).filter(|_| pitch.cos() > 0.1) else { continue };
        let force = 0.5 * o.density_kg_m3 * flown.speed_m_s.powi(2) * polar.frontal_area_m2 * polar.length_m;
        let moment_kg_m = force * flown.angle_of_attack_rad / (polar.gravity_m_s2 * pitch.cos());
        let ballast_kg = if ballast { polar.ballast_mass_kg(o.ballast_m3) } else { 0.0 };
        let moment_kg_m = if moment { moment_kg_m } else { 0.0 };
        gram.add_row(&[1.0, o.battery_forward_m, ballast_kg, moment_kg_m, pitch.tan()]);
    }
    let found = solve_symmetric(&gram.normal_matrix(), &gram.gradient());
    // A battery that never moves, or one that lifts the nose when it goes forward, says nothing.
    if !(found[1] < 0.0 && found.iter().all(|value| value.is_finite())) {
        return None;
    }
    let mut start = *polar;
    let moment_3 = -start.moving_mass_kg / found[1];
    start.offset_mass_kg = start.hull_mass_kg;
    let rest = start.moving_mass_kg * start.moving_mass_height_m + start.ballast_nominal_kg * start.ballast_below_m;
    start.offset_mass_below_m = (moment_3 - rest) / start.offset_mass_kg;
    if ballast {
        start.ballast_forward_m = -found[2] * moment_3;
    }
    let ballast_kg_m = if ballast { 0.0 } else { start.ballast_nominal_kg * start.ballast_forward_m };
    start.offset_mass_forward_m = (-found[0] * moment_3 - ballast_kg_m) / start.offset_mass_kg;
    start.d_per_rad = found[3] * moment_3;
    start.ascent_d_ratio = 1.0;
    Some(start)
}

/// Where the fit of this question may begin: the regression with what is free in it.
pub(super) fn start_for(question: &Question, polar: &Parameters<f64>, dives: &[Dive], moment: bool) -> Parameters<f64> {
    let is_free = |name: &str| parameter_index(name).is_some_and(|row| question.free.contains(&row));
    first_guess(polar, dives, is_free("ballast_forward_m"), moment && is_free("d_per_rad")).unwrap_or(question.baseline)
}
