//! One point of the polar for each glide: the tank paper's Figures 11 to 14 for any log.
//!
//! Pitch, sink rate and net weight are means of the steady samples of a leg; the angle of attack is the model's mean. Path
//! angle, speed, lift and drag then follow from the balance of forces alone, as the paper has them:
//! `xi = pitch - alpha`, `V = w / sin |xi|`, `CL = W cos xi / (q A)`, `CD = W sin |xi| / (q A)`.

use std::ops::Range;

use super::inertia::inertia;
use super::model::{Inertia, predict, surroundings};
use super::paper::{MeanGlide, SolvedGlide};
use super::ranges;
use crate::dynamics::Parameters;
use crate::glide::SteadyGlider;
use crate::log::Observation;

/// A glide as a point of the polar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolarPoint {
    /// The means of the leg.
    pub glide: MeanGlide,
    /// Angle of attack, positive on descents \[rad\].
    pub angle_of_attack_rad: f64,
    /// Glide path angle, negative on descents \[rad\].
    pub glide_angle_rad: f64,
    /// Speed through the water \[m/s\].
    pub speed_m_s: f64,
    /// Lift coefficient, with the sign of the angle of attack.
    pub lift_coefficient: f64,
    /// Drag coefficient.
    pub drag_coefficient: f64,
    /// Mean of the measured speed, NaN without one \[m/s\].
    pub measured_speed_m_s: f64,
    /// Mean of measured less predicted downward velocity, NaN where nothing was predicted \[m/s\].
    pub sink_residual_m_s: f64,
    /// Steady samples in it.
    pub samples: usize,
}

impl PolarPoint {
    /// Whether the glide is a descent.
    pub fn descends(&self) -> bool {
        self.glide.sink_m_s > 0.0
    }
}

impl From<&SolvedGlide> for PolarPoint {
    fn from(solved: &SolvedGlide) -> Self {
        PolarPoint {
            glide: solved.glide,
            angle_of_attack_rad: solved.angle_of_attack_rad,
            glide_angle_rad: solved.glide_angle_rad,
            speed_m_s: solved.speed_m_s,
            lift_coefficient: solved.lift_coefficient,
            drag_coefficient: solved.drag_coefficient,
            measured_speed_m_s: f64::NAN,
            sink_residual_m_s: 0.0,
            samples: 0,
        }
    }
}

/// The points of all legs with a steady sample at which a glide exists; where forces balance at every moment, without inertia.
pub fn polar_points(
    parameters: &Parameters<f64>,
    observations: &[Observation],
    is_quasi_steady: bool,
) -> Vec<PolarPoint> {
    let glider = SteadyGlider::new(*parameters);
    let of_leg = |range: Range<usize>| point(&glider, &observations[range], is_quasi_steady);
    ranges(observations, |o| o.leg).into_iter().filter_map(of_leg).collect()
}

fn point(glider: &SteadyGlider<f64>, leg: &[Observation], is_quasi_steady: bool) -> Option<PolarPoint> {
    let p = &glider.parameters;
    let (mut n, mut sums, mut speeds) = (0usize, [0.0; 6], (0usize, 0.0));
    let mut guess = None;
    let steady: Vec<Observation> = leg.iter().filter(|o| o.steady).copied().collect();
    let inertia = if is_quasi_steady { vec![Inertia::NONE; steady.len()] } else { inertia(p, &steady) };
    for (o, inertia) in steady.iter().zip(inertia) {
        let Some(predicted) = predict(glider, o, &inertia, guess) else { continue };
        guess = Some(predicted.guess);
        let weight = p.net_mass_kg(o.ballast_m3, &surroundings(p, o)) * p.gravity_m_s2;
        let pitch: f64 = p.pitch_scale * o.pitch_rad + p.pitch_offset_rad;
        let values = [
            pitch,
            o.sink_m_s,
            weight,
            o.density_kg_m3,
            predicted.angle_of_attack_rad,
            o.sink_m_s - predicted.sink_m_s,
        ];
        n += 1;
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += value;
        }
        if o.speed_m_s.is_finite() {
            speeds = (speeds.0 + 1, speeds.1 + o.speed_m_s);
        }
    }
    let [pitch_rad, sink_m_s, net_weight_N, density_kg_m3, alpha, sink_residual_m_s] =
        (n > 0).then(|| sums.map(|sum| sum / n as f64))?;
    let xi = pitch_rad - alpha;
    let speed_m_s = (sink_m_s / xi.sin()).abs();
    let force = 0.5 * density_kg_m3 * speed_m_s * speed_m_s * p.frontal_area_m2;
    Some(PolarPoint {
        glide: MeanGlide { leg: leg[0].leg, pitch_rad, sink_m_s, net_weight_N, density_kg_m3 },
        angle_of_attack_rad: alpha,
        glide_angle_rad: xi,
        speed_m_s,
        lift_coefficient: net_weight_N * xi.cos() / force,
        drag_coefficient: (net_weight_N * xi.sin()).abs() / force,
        measured_speed_m_s: if speeds.0 > 0 { speeds.1 / speeds.0 as f64 } else { f64::NAN },
        sink_residual_m_s,
        samples: n,
    })
}
