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

/// A glide that follows what is around it late changes later than the steady one: the first round takes `V'` from steady
/// glides, the second from glides with the first one's inertia. A third changes nothing that a log could show.
const ROUNDS: usize = 2;

/// The inertia of each sample at these parameters; none where no glide exists or the sample is alone.
pub fn inertia<'o>(
    parameters: &Parameters<f64>,
    observations: impl IntoIterator<Item = &'o Observation>,
) -> Vec<Inertia> {
    let observations: Vec<&Observation> = observations.into_iter().collect();
    let glider = Glider::new(*parameters);
    let near_s = NEAR_S.max(1.5 * usual_step_s(observations.iter().copied()));
    let mut found = vec![Inertia::NONE; observations.len()];
    let mut flown: Vec<Option<Flown>> = vec![None; observations.len()];
    for _ in 0..ROUNDS {
        fly(&glider, &observations, &found, &mut flown);
        let (mut low, mut high) = (0, 0);
        for (i, inertia) in found.iter_mut().enumerate() {
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
            *inertia = of_one(parameters, observations[i], i - low, &flown[low..high]).unwrap_or(Inertia::NONE);
        }
    }
    found
}

/// The glide of each sample with the inertia that is known of it so far.
fn fly(glider: &Glider<f64>, observations: &[&Observation], inertia: &[Inertia], flown: &mut [Option<Flown>]) {
    let mut nearest = None;
    for ((observed, inertia), flown) in observations.iter().zip(inertia).zip(flown) {
        let own = flown.as_ref().map(|flown| flown.guess);
        let found = predict(glider, observed, inertia, own.or(nearest));
        nearest = found.map(|p| p.guess);
        *flown = found.map(|p| Flown {
            time_s: observed.time_s,
            sink_m_s: p.sink_m_s,
            speed_m_s: p.speed_m_s,
            angle_of_attack_rad: p.angle_of_attack_rad,
            guess: p.guess,
        });
    }
}

/// A glide as the model has it.
#[derive(Debug, Clone, Copy)]
struct Flown {
    time_s: f64,
    sink_m_s: f64,
    speed_m_s: f64,
    angle_of_attack_rad: f64,
    guess: [f64; 2],
}

fn of_one(
    parameters: &Parameters<f64>,
    observed: &Observation,
    place: usize,
    near: &[Option<Flown>],
) -> Option<Inertia> {
    let here = near[place]?;
    let [sink_rate_m_s2, along] = rates(near, here.time_s)?;
    let net_kg = parameters.net_mass_kg(observed.ballast_m3, &surroundings(parameters, observed));
    let mass_kg = parameters.mass_kg() + parameters.added_mass_1_kg;
    let steep =
        (parameters.pitch_scale * observed.pitch_rad + parameters.pitch_offset_rad - here.angle_of_attack_rad).abs();
    // Where it is no small correction any more the glide is not steady, and the sample tells little. A trial of a fit may put
    // the path beyond the vertical.
    let most = 0.5 * steep.sin().max(0.0);
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

    /// A leg flown at a course of speeds and its rates: what it must have weighed by the balance of forces.
    ///
    /// L = m0 g cos s, D = m0 g sin s - M V' at a held path s: a alpha tan s = b + c alpha^2 + M V'/(q A), a quadratic.
    fn leg(p: &Parameters<f64>, course: fn(f64) -> (f64, f64)) -> Vec<(Observation, f64)> {
        let path = -27f64.to_radians();
        let water = sample(p, -27.0, 0.3, 0, 0.0);
        let at = |i: i32| {
            let time_s = 5.0 * f64::from(i);
            let (speed_m_s, rate_m_s2) = course(time_s);
            let force = 0.5 * water.density_kg_m3 * speed_m_s * speed_m_s * p.frontal_area_m2;
            let mass_kg = p.mass_kg() + p.added_mass_1_kg;
            let (along, slope) = (p.b + mass_kg * rate_m_s2 / force, p.a_per_rad * path.abs().tan());
            let alpha = (slope - (slope * slope - 4.0 * p.c_per_rad2 * along).sqrt()) / (2.0 * p.c_per_rad2);
            let net_kg = force * p.a_per_rad * alpha / (p.gravity_m_s2 * path.cos());
            let sink_m_s = -speed_m_s * path.sin();
            let mut o = Observation { time_s, pitch_rad: path + alpha, sink_m_s, speed_m_s, ..water };
            let heavier_kg = net_kg - p.net_mass_kg(o.ballast_m3, &surroundings(p, &o));
            o.ballast_m3 -= heavier_kg / p.true_density_kg_m3(o.density_kg_m3);
            assert!((p.net_mass_kg(o.ballast_m3, &surroundings(p, &o)) - net_kg).abs() < 1e-9);
            (o, alpha)
        };
        (0..160).map(at).collect()
    }

    #[test]
    fn a_glide_that_changes_speed_is_the_balance_of_forces_written_out() {
        let (_, p) = glider();
        let glider = Glider::new(p);
        // Steadily slower, and slower through a thermocline that is passed in two minutes.
        let steadily = |t: f64| (0.3 - 1e-4 * t, -1e-4);
        let once = |t: f64| {
            let tanh = ((t - 400.0) / 60.0).tanh();
            (0.3 - 0.05 * tanh, -0.05 / 60.0 * (1.0 - tanh * tanh))
        };
        for course in [steadily, once] {
            let leg = leg(&p, course);
            let inertia = inertia(&p, leg.iter().map(|(o, _)| o));
            let (mut before, mut after) = ([0f64; 2], [0f64; 2]);
            for ((o, alpha), inertia) in leg.iter().zip(&inertia) {
                for (inertia, most) in [(&Inertia::NONE, &mut before), (inertia, &mut after)] {
                    let found = predict(&glider, o, inertia, None).unwrap();
                    let errors = [found.speed_m_s - o.speed_m_s, found.sink_m_s - o.sink_m_s];
                    most.iter_mut().zip(errors).for_each(|(most, error)| *most = most.max(error.abs()));
                    assert!(*inertia == Inertia::NONE || (found.angle_of_attack_rad - alpha).abs() < 2e-4);
                }
            }
            // Nothing is left but the difference between V' of the glide and that of the model's.
            assert!(before[0] > 1e-3 && (0..2).all(|i| after[i] < 0.05 * before[i]), "{before:?} {after:?}");
        }
    }
}
