//! The inertia of a glide that is nearly steady, as a change of the weight that it hangs on.
//!
//! Across and along a path of steepness `s`, `L = m0 g cos s` and `D = m0 g sin s - M dV/dt`, with `M` the mass and its
//! added mass along axis 1. Lift and drag are those of a steady glide that hangs on another weight: with
//! `x = M V' / (m0 g)` it is `m0 hypot(cos s, sin s - x)`, turned by `atan2(sin s - x, cos s) - s`. `V'` is that of the model
//! along the leg: the measured one holds the water's own accelerations, which carry the glider along. `w'` likewise is what
//! a late pressure goes by.
//!
//! Knows one leg at a time; what is steady, and what a fit does with it, others decide.

use super::model::{predict, surroundings};
use crate::dynamics::Parameters;
use crate::glide::Glider;
use crate::log::Observation;

/// What the inertia of one sample adds to its balance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia {
    /// Change of the net mass \[kg\].
    pub net_mass_kg: f64,
    /// Change of the pitch at which angle of attack and speed are those of a steady glide \[rad\].
    pub pitch_rad: f64,
    /// Rate of change of the downward velocity \[m/s2\].
    pub sink_rate_m_s2: f64,
}

impl Inertia {
    /// That of a glide which is steady.
    pub const NONE: Inertia = Inertia { net_mass_kg: 0.0, pitch_rad: 0.0, sink_rate_m_s2: 0.0 };
}

/// Rates of change are taken over the neighbours so near, and at least over the next ones \[s\].
const NEAR_S: f64 = 30.0;

/// The inertia of each sample at these parameters; none where no glide exists or the sample is alone.
pub fn inertia<'o>(
    parameters: &Parameters<f64>,
    observations: impl IntoIterator<Item = &'o Observation>,
) -> Vec<Inertia> {
    let observations: Vec<&Observation> = observations.into_iter().collect();
    let glider = Glider::new(*parameters);
    let mut guess = None;
    let flown: Vec<Option<Flown>> = observations
        .iter()
        .map(|observed| {
            let steady = predict(&glider, observed, &Inertia::NONE, guess);
            guess = steady.map(|p| p.guess);
            steady.map(|p| Flown {
                time_s: observed.time_s,
                sink_m_s: p.sink_m_s,
                speed_m_s: p.speed_m_s,
                angle_of_attack_rad: p.angle_of_attack_rad,
            })
        })
        .collect();
    let near_s = NEAR_S.max(1.5 * usual_step_s(observations.iter().copied()));
    let (mut low, mut high) = (0, 0);
    (0..observations.len())
        .map(|i| {
            let is_near = |j: usize| {
                let (here, there) = (observations[i], observations[j]);
                here.leg == there.leg && (here.time_s - there.time_s).abs() <= near_s
            };
            while low < i && !is_near(low) {
                low += 1;
            }
            high = high.max(i + 1);
            while high < observations.len() && is_near(high) {
                high += 1;
            }
            of_one(parameters, observations[i], flown[i].as_ref(), &flown[low..high]).unwrap_or(Inertia::NONE)
        })
        .collect()
}

/// A steady glide as the model has it.
struct Flown {
    time_s: f64,
    sink_m_s: f64,
    speed_m_s: f64,
    angle_of_attack_rad: f64,
}

fn of_one(
    parameters: &Parameters<f64>,
    observed: &Observation,
    here: Option<&Flown>,
    near: &[Option<Flown>],
) -> Option<Inertia> {
    let here = here?;
    let [sink_rate_m_s2, along] = rates(near, here.time_s)?;
    let net_kg = parameters.net_mass_kg(observed.ballast_m3, &surroundings(parameters, observed));
    let mass_kg = parameters.mass_kg() + parameters.added_mass_1_kg;
    let steep =
        (parameters.pitch_scale * observed.pitch_rad + parameters.pitch_offset_rad - here.angle_of_attack_rad).abs();
    // Where it is no small correction any more the glide is not steady, and the sample tells little.
    let most = 0.5 * steep.sin();
    let x = (mass_kg * along / (net_kg.abs() * parameters.gravity_m_s2)).clamp(-most, most);
    let (across, along) = (steep.cos(), steep.sin() - x);
    Some(Inertia {
        net_mass_kg: net_kg * (across.hypot(along) - 1.0),
        pitch_rad: (along.atan2(across) - steep) * observed.pitch_rad.signum(),
        sink_rate_m_s2,
    })
}

/// Rates of change of vertical velocity and speed: slopes of the straight lines through the neighbours \[m/s2\].
fn rates(near: &[Option<Flown>], about_s: f64) -> Option<[f64; 2]> {
    let (mut n, mut t, mut tt, mut v, mut tv) = (0.0, 0.0, 0.0, [0.0; 2], [0.0; 2]);
    for flown in near.iter().flatten() {
        let time_s = flown.time_s - about_s;
        n += 1.0;
        t += time_s;
        tt += time_s * time_s;
        for (i, value) in [flown.sink_m_s, flown.speed_m_s].into_iter().enumerate() {
            v[i] += value;
            tv[i] += time_s * value;
        }
    }
    let spread = n * tt - t * t;
    (spread > 0.0).then(|| [0, 1].map(|i| (n * tv[i] - t * v[i]) / spread))
}

/// Median time from one sample to the next of its leg \[s\]; none where no two are on one leg.
pub fn usual_step_s<'o>(observations: impl Iterator<Item = &'o Observation> + Clone) -> f64 {
    let pairs = observations.clone().zip(observations.skip(1));
    let mut steps: Vec<f64> = pairs.filter(|(a, b)| a.leg == b.leg).map(|(a, b)| b.time_s - a.time_s).collect();
    if steps.is_empty() { 0.0 } else { crate::log::median(&mut steps) }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{glider, sample};
    use super::*;

    #[test]
    fn a_glide_that_speeds_up_is_the_balance_of_forces_written_out() {
        // L = m0 g cos s, D = m0 g sin s - M V' at a held path s: a alpha tan s = b + c alpha^2 + M V'/(q A), a quadratic.
        let (_, p) = glider();
        let (path, slower_by): (f64, f64) = (-27f64.to_radians(), 1e-4);
        let water = sample(&p, -27.0, 0.3, 0, 0.0);
        let leg: Vec<Observation> = (0..40)
            .map(|i| {
                let time_s = 5.0 * f64::from(i);
                let speed_m_s = 0.3 - slower_by * time_s;
                let force = 0.5 * water.density_kg_m3 * speed_m_s * speed_m_s * p.frontal_area_m2;
                let mass_kg = p.mass_kg() + p.added_mass_1_kg;
                let (along, slope) = (p.b - mass_kg * slower_by / force, p.a_per_rad * path.abs().tan());
                let alpha = (slope - (slope * slope - 4.0 * p.c_per_rad2 * along).sqrt()) / (2.0 * p.c_per_rad2);
                let net_kg = force * p.a_per_rad * alpha / (p.gravity_m_s2 * path.cos());
                let mut o = Observation {
                    time_s,
                    pitch_rad: path + alpha,
                    sink_m_s: -speed_m_s * path.sin(),
                    speed_m_s,
                    ..water
                };
                let heavier_kg = net_kg - p.net_mass_kg(o.ballast_m3, &surroundings(&p, &o));
                o.ballast_m3 -= heavier_kg / p.true_density_kg_m3(o.density_kg_m3);
                assert!((p.net_mass_kg(o.ballast_m3, &surroundings(&p, &o)) - net_kg).abs() < 1e-9);
                o
            })
            .collect();
        let glider = Glider::new(p);
        for (o, inertia) in leg.iter().zip(inertia(&p, &leg)) {
            let steady = predict(&glider, o, &Inertia::NONE, None).unwrap();
            let found = predict(&glider, o, &inertia, None).unwrap();
            // Nothing is left but the difference between V' of the glide and that of the steady one.
            let [before, after] = [steady, found].map(|f| (f.speed_m_s - o.speed_m_s).abs());
            assert!(before > 1e-3 && after < 0.02 * before, "{before} {after}");
            assert!((found.sink_m_s - o.sink_m_s).abs() < 0.02 * (steady.sink_m_s - o.sink_m_s).abs());
            assert!((found.angle_of_attack_rad - (o.pitch_rad - path)).abs() < 1e-4);
        }
    }
}
