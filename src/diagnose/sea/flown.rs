//! What the model reads in one bin: the steady glide with the past, the inertia and the unknown shear in it, and its slopes.
//!
//! Knows the glide and what acts on it; no fit.

use super::effects_of_past::Effect;
use super::model::{Sloped, Vehicle};
use crate::dynamics::Parameters;
use crate::identify::{Bin, Inside, surroundings};

/// A bin in which forces balance at every moment.
pub struct AtRest<'a> {
    /// The share of the inertia that takes part.
    pub share: f64,
    /// What happens inside of it.
    pub inside: &'a Inside,
}

/// The readings of one bin, with their slopes along every direction.
pub struct Flown {
    /// Vertical velocity that is read \[m/s\].
    pub sink: Sloped,
    /// Speed \[m/s\], before its scale.
    pub speed: Sloped,
    /// What the whole of the inertia changes in the two \[m/s\].
    pub by_inertia: [f64; 2],
    /// What a force along the heading changes in the two \[m/s per N\].
    pub by_force: [f64; 2],
}

impl Flown {
    /// The readings of a bin. `at_rest` is the bin without inertia; none where the inertia is in as it is. `pitch` is the direction of
    /// a pitch offset.
    pub fn new(
        vehicle: &Vehicle,
        pitch: usize,
        bin: &Bin,
        inside: &Inside,
        at_rest: Option<&AtRest>,
        effect: &Effect,
    ) -> Flown {
        let (parameters, reading) = (&vehicle.parameters, 1.0 + effect.reading);
        let acted_on = with_effect(parameters, bin, inside, effect, effect.late_net_mass_kg);
        let (mut sink, mut speed) = vehicle.fly(bin, &acted_on);
        sink.scale(reading);
        let by_force = by_force(parameters, bin, &acted_on, [&sink, &speed], pitch, reading);
        let mut by_inertia = [0.0; 2];
        if let Some(AtRest { share, inside }) = at_rest {
            let [sink_at_rest, speed_at_rest] =
                vehicle.fly_plainly(bin, &with_effect(parameters, bin, inside, effect, effect.net_mass_kg));
            by_inertia = [sink.value - reading * sink_at_rest, speed.value - speed_at_rest];
            sink.value += (share - 1.0) * by_inertia[0];
            speed.value += (share - 1.0) * by_inertia[1];
        }
        Flown { sink, speed, by_inertia, by_force }
    }
}

/// A bin's inside with what acts on it beside the steady glide, and this much added to the net mass.
fn with_effect(parameters: &Parameters<f64>, bin: &Bin, inside: &Inside, effect: &Effect, added_kg: f64) -> Inside {
    let mut inside = *inside;
    inside.inertia.net_mass_kg += added_kg;
    if effect.along_N != 0.0 {
        // A horizontal force and the weight together are a weight that leans.
        let net_kg = net_mass_kg(parameters, bin, &inside);
        let lean = effect.along_N / (net_kg * parameters.gravity_m_s2);
        inside.inertia.net_mass_kg += net_kg * (1.0f64.hypot(lean) - 1.0);
        inside.inertia.pitch_rad -= lean.atan();
    }
    inside
}

fn net_mass_kg(parameters: &Parameters<f64>, bin: &Bin, inside: &Inside) -> f64 {
    parameters.net_mass_kg(bin.mean.ballast_m3, &surroundings(parameters, &bin.mean)) + inside.inertia.net_mass_kg
}

/// What a force along the heading changes in vertical velocity and speed \[m/s per N\].
///
/// The weight leans by the force over the weight. A pitch offset turns the hull against the weight by as much, and turns the path with
/// it, which here stays where it is: `U sin(alpha - pitch)` less that turn is the slope along the offset plus `U cos`.
fn by_force(
    parameters: &Parameters<f64>,
    bin: &Bin,
    inside: &Inside,
    [sink, speed]: [&Sloped; 2],
    pitch: usize,
    reading: f64,
) -> [f64; 2] {
    let weight_N = net_mass_kg(parameters, bin, inside) * parameters.gravity_m_s2;
    let horizontal_m_s = (speed.value.powi(2) - sink.value.powi(2)).max(0.0).sqrt();
    let turned = [sink.slopes[pitch] + reading * horizontal_m_s / parameters.pressure_scale, speed.slopes[pitch]];
    turned.map(|slope| if weight_N == 0.0 { 0.0 } else { -slope / weight_N })
}

#[cfg(test)]
mod tests {
    use crate::diagnose::Problem;
    use crate::diagnose::sea::{DiagnosisSettings, SeaProblem, path_share, steady_log};
    use crate::vehicle::Vehicle;

    /// A log of steady glides whose pitch hunts. Without inertia the path follows the pitch at once: the model without it, by its share
    /// or altogether, reads what the log does. A path that followed it late would leave 0.08 mm/s.
    #[test]
    fn without_inertia_the_path_follows_the_pitch_at_once() {
        let parameters = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        let log = steady_log::log(&parameters);
        let problem = SeaProblem::new(&log, &parameters, DiagnosisSettings::default()).expect("enough bins");
        let rms = |problem: &SeaProblem, shares: &[f64]| {
            let mut point = problem.start();
            point.baseline.truncate(problem.place_of_inertia());
            point.baseline.extend(shares);
            let residual = problem.evidence(&point).residual;
            residual.norm() / (residual.len() as f64).sqrt()
        };
        let mut steady = SeaProblem { parts: problem.parts.without_inertia(), ..problem.clone() };
        steady.baseline.truncate(problem.place_of_inertia());
        let found = [rms(&problem, &[0.0, -path_share::START]), rms(&steady, &[])];
        assert!(found.iter().all(|rms| *rms < 2e-5), "{found:?} m/s");
        assert!(rms(&problem, &[1.0, path_share::START]) > 1e-3 && rms(&problem, &[0.0, path_share::START]) > 5e-5);
    }
}
