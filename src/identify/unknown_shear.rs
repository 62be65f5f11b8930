//! What the shear of a current that the log does not have does to the ballast offset.
//!
//! In water whose velocity changes with depth by `S` a glider of mass `m` needs the force `m S w` along its heading. Along the path it
//! does what a net mass of `m S w cot(xi)/g` does, and has its sign on both legs: the mean shear `U/H` of a current that differs by
//! `U` between the surface and the depth `H` is a ballast offset
//!
//! ```text
//! dm = m U v R / (g H)          v horizontal speed, R = |mean exp(i heading)|
//! ```
//!
//! as long as the glider keeps its heading (R = 1). On other headings the same current has the other sign. A force along the heading also
//! unloads the wing, which takes back a quarter of it at usual pitches: far less than `U` is uncertain by. Polars hardly
//! move: a shear parts the legs, a polar does not. Knows samples of steady glide; nothing of a fit but its free parameters.

use super::considered::{Considered, Propagated};
use super::data::Dive;
use super::joint::JointFit;
use crate::dynamics::{Parameters, parameter_index};
use crate::log::Observation;

/// Difference of the current between the surface and the deepest dive, root mean square of each component \[m/s\]. Drifters at the
/// surface have an rms velocity of 0.2 to 0.3 m/s (Lumpkin and Johnson 2013), 0.15 to 0.2 in each component, and most of it falls off
/// within the depth of a glider's dives.
pub const DIFFERENCE_M_S: f64 = 0.15;

/// Angle of attack of a usual glide \[rad\], where the path is wanted and the pitch is known.
const USUAL_ANGLE_OF_ATTACK_RAD: f64 = 0.05;

/// Name of this error among those that are propagated.
pub(super) const NAME: &str = "unknown_shear";

/// Adds the error of the ballast offset by an unknown shear to a fit that has one.
pub(super) fn consider(fit: &mut JointFit, dives: &[Dive]) {
    let ballast = parameter_index("ballast_offset_kg");
    let Some(place) = fit.free.iter().position(|row| Some(*row) == ballast) else { return };
    let samples = dives.iter().flat_map(|dive| &dive.observations);
    let Some(error_kg) = offset_kg(&fit.parameters, samples) else { return };
    let mut moves = vec![0.0; fit.free.len()];
    moves[place] = error_kg;
    // Nothing is held at a value: the error is that of the equations.
    fit.propagated.push(Propagated { considered: Considered { name: NAME.to_owned(), along: Vec::new() }, moves });
}

/// One standard error \[kg\]; none without samples under way.
fn offset_kg<'a>(parameters: &Parameters<f64>, samples: impl Iterator<Item = &'a Observation>) -> Option<f64> {
    let (mut n, mut horizontal_m_s, mut north, mut east, mut deepest_m) = (0.0, 0.0, 0.0, 0.0, 0.0f64);
    for o in samples.filter(|o| o.sink_m_s.is_finite() && o.pitch_rad.is_finite()) {
        n += 1.0;
        horizontal_m_s += o.sink_m_s.abs() / (o.pitch_rad.abs() + USUAL_ANGLE_OF_ATTACK_RAD).tan();
        // Without a heading it may be the same throughout.
        let heading_rad = if o.heading_rad.is_finite() { o.heading_rad } else { 0.0 };
        (north, east) = (north + heading_rad.cos(), east + heading_rad.sin());
        deepest_m = deepest_m.max(o.pressure_dbar);
    }
    if n == 0.0 || deepest_m <= 0.0 {
        return None;
    }
    let resultant = f64::hypot(north, east) / n;
    let error_kg = parameters.mass_kg() * DIFFERENCE_M_S * (horizontal_m_s / n) * resultant
        / (parameters.gravity_m_s2 * deepest_m);
    error_kg.is_finite().then_some(error_kg)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{glider, sample};
    use super::*;
    use crate::dynamics::Surroundings;
    use crate::glide::{Attitude, at_pitch};

    /// The equivalent net mass moves the vertical velocity as the force along the heading does, but for what that takes off the wing.
    #[test]
    fn a_shear_does_what_its_net_mass_does() {
        let (_, p) = glider();
        let o = sample(&p, -25.0, 0.3, 0, 0.0);
        let water = Surroundings {
            density_kg_m3: o.density_kg_m3,
            pressure_Pa: 0.0,
            temperature_C: o.temperature_C,
            time_s: 0.0,
        };
        let net_mass_kg = p.net_mass_kg(o.ballast_m3, &water);
        let w = |net_mass_kg: f64, lean_rad: f64| {
            // A force along the heading and the weight together are a weight that leans.
            let attitude = Attitude { pitch_rad: o.pitch_rad - lean_rad, net_mass_kg };
            let glide = at_pitch(&p, &water, attitude).expect("a glide");
            glide.speed_m_s * (glide.angle_of_attack_rad - o.pitch_rad).sin()
        };
        let force_N = 1e-3;
        let lean_rad = (force_N / (net_mass_kg * p.gravity_m_s2)).atan();
        let by_force = w(net_mass_kg / lean_rad.cos(), lean_rad) - w(net_mass_kg, 0.0);
        let path_rad = o.pitch_rad.abs() + USUAL_ANGLE_OF_ATTACK_RAD;
        let equivalent_kg = force_N / (path_rad.tan() * p.gravity_m_s2);
        let by_mass = w(net_mass_kg + equivalent_kg, 0.0) - w(net_mass_kg, 0.0);
        assert!((0.65..=1.0).contains(&(by_force / by_mass)), "{by_force} against {by_mass} m/s");
    }

    #[test]
    fn opposite_headings_cancel_it() {
        let (_, p) = glider();
        let at = |heading_rad: f64| Observation { heading_rad, pressure_dbar: 100.0, ..sample(&p, -25.0, 0.3, 0, 0.0) };
        let one = offset_kg(&p, [at(1.0), at(1.0)].iter()).expect("samples");
        let two = offset_kg(&p, [at(1.0), at(1.0 + std::f64::consts::PI)].iter()).expect("samples");
        let v = 0.3 * 25f64.to_radians().cos();
        let expected = p.mass_kg() * DIFFERENCE_M_S * v / (p.gravity_m_s2 * 100.0);
        assert!((one / expected - 1.0).abs() < 0.1 && two < 1e-12, "{one} {two}, expected {expected} kg");
    }
}
