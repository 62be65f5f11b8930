//! What one external sensor does to a glide: speed, path, descent, way, and the rudder that keeps it straight.
//!
//! The pilot keeps pitch and ballast. A sensor to one side pulls the bow to its side; in a straight path the side
//! forces and yaw moments of hull, fin and rudder (angle `delta`, drift angle `beta`) balance those of the sensor:
//! ```text
//! (a_h + a_f S/A) beta - tau a_f S/A delta                 = 0
//! (d_h - a_f S x/(A L)) beta + tau a_f S x/(A L) delta + n = 0,      n = (CD A)_pod y/(A L)
//! ```
//! `a_h`, `d_h` the bare hull's slopes, the same to the side as in the vertical plane, `x` the fin aft of the centre of
//! buoyancy, `tau` the effectiveness of the rudder, a flap on the fin (thin aerofoil, Glauert 1926). The rudder's own
//! drag is that of the lift it makes. Roll, and the wing's part in yaw, are left out.

use super::{Figure, Pod, Surface};
use glidepolar_dynamics::glide::{Attitude, GlideError, SteadyGlide, at_pitch};
use glidepolar_dynamics::{Parameters, Surroundings};
use glidepolar_inference::estimate::Estimate;

/// The side view: hull slopes, fin and rudder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lateral {
    /// Lift slope of the bare hull on the frontal area \[1/rad\].
    pub hull_a_per_rad: Figure,
    /// Moment slope of the bare hull about the centre of buoyancy \[1/rad\].
    pub hull_d_per_rad: Figure,
    /// The fin; its span is from the hull's axis to the tip, which the hull mirrors.
    pub fin: Surface,
    /// Centre of buoyancy aft of the nose \[m\].
    pub cb_aft_m: f64,
    /// Chord of the rudder over chord of the fin.
    pub rudder_chord: f64,
}

/// The glide that is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Pitch \[rad\].
    pub pitch_rad: f64,
    /// Ballast volume \[m3\].
    pub ballast_m3: f64,
    /// The water.
    pub water: Surroundings<f64>,
}

/// One glide: before, after, and the change, whose interval is the narrower one: both share most of their errors.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[allow(missing_docs, reason = "units and quantities stand in the names")]
pub struct Effect {
    pub speed_m_s: [Estimate; 3],
    /// Negative on a descent.
    pub glide_angle_deg: [Estimate; 3],
    /// Positive down.
    pub vertical_velocity_m_s: [Estimate; 3],
    pub horizontal_velocity_m_s: [Estimate; 3],
    /// Positive to starboard; none without a fin.
    pub rudder_deg: Option<Estimate>,
    /// Drag area of that rudder angle.
    pub rudder_drag_area_m2: f64,
}

/// Before and after a sensor, at the same pitch and ballast.
///
/// `uncertain`: the parameters with one figure after the other moved by its standard error.
///
/// # Errors
/// Where there is no such glide.
pub fn effect(
    parameters: &Parameters<f64>,
    uncertain: &[Parameters<f64>],
    pod: &Pod,
    lateral: Option<&Lateral>,
    look: &Look,
) -> Result<Effect, GlideError> {
    let rudder = lateral.map(|lateral| lateral.rudder_rad(parameters, pod));
    let rudder_drag_area_m2 = match (lateral, &rudder) {
        (Some(lateral), Some(angle)) => lateral.rudder_drag_area_m2(angle.value),
        _ => 0.0,
    };
    let carried = |p: &Parameters<f64>, more: f64| {
        let drag_area_m2 = Figure { value: pod.drag_area_m2.value + rudder_drag_area_m2 + more, se: 0.0 };
        Pod { drag_area_m2, ..*pod }.carried_by(p)
    };
    let both = |p: &Parameters<f64>, more: f64| -> Result<[SteadyGlide<f64>; 2], GlideError> {
        Ok([glide(p, look)?, glide(&carried(p, more), look)?])
    };
    let nominal = both(parameters, 0.0)?;
    let mut moved = vec![both(parameters, pod.drag_area_m2.se)?];
    for parameters in uncertain {
        moved.push(both(parameters, 0.0)?);
    }
    let three = |unit: &str, of: fn(&SteadyGlide<f64>) -> f64| -> [Estimate; 3] {
        let all = |glides: &[SteadyGlide<f64>; 2]| {
            let [before, after] = [of(&glides[0]), of(&glides[1])];
            [before, after, after - before]
        };
        let values = all(&nominal);
        std::array::from_fn(|i| {
            let variance: f64 = moved.iter().map(|glides| (all(glides)[i] - values[i]).powi(2)).sum();
            Estimate::normal(values[i], variance.sqrt(), unit)
        })
    };
    Ok(Effect {
        speed_m_s: three("m/s", |glide| glide.speed_m_s),
        glide_angle_deg: three("deg", |glide| glide.glide_angle_rad.to_degrees()),
        vertical_velocity_m_s: three("m/s", |glide| glide.vertical_velocity_m_s),
        horizontal_velocity_m_s: three("m/s", |glide| glide.horizontal_velocity_m_s),
        rudder_deg: rudder.map(|angle| Estimate::normal(angle.value.to_degrees(), angle.se.to_degrees(), "deg")),
        rudder_drag_area_m2,
    })
}

fn glide(p: &Parameters<f64>, look: &Look) -> Result<SteadyGlide<f64>, GlideError> {
    let net_mass_kg = p.net_mass_kg(look.ballast_m3, &look.water);
    at_pitch(p, &look.water, Attitude { pitch_rad: look.pitch_rad, net_mass_kg })
}

impl Lateral {
    /// Rudder angle that keeps the path straight, positive when it turns the bow to starboard \[rad\].
    pub fn rudder_rad(&self, p: &Parameters<f64>, pod: &Pod) -> Figure {
        let nominal = self.balance(p, pod, self.hull_a_per_rad.value, self.hull_d_per_rad.value);
        let (a, d) = (self.hull_a_per_rad, self.hull_d_per_rad);
        let changes = [
            self.balance(p, pod, a.value + a.se, d.value) - nominal,
            self.balance(p, pod, a.value, d.value + d.se) - nominal,
            nominal * pod.drag_area_m2.se / pod.drag_area_m2.value.max(f64::MIN_POSITIVE),
            nominal * EFFECTIVENESS_ERROR,
        ];
        Figure { value: nominal, se: changes.iter().map(|change| change * change).sum::<f64>().sqrt() }
    }

    fn balance(&self, p: &Parameters<f64>, pod: &Pod, a: f64, d: f64) -> f64 {
        let arm = (self.fin.aft_m - self.cb_aft_m) / p.length_m;
        let fin = self.fin_slope(p);
        let rudder = self.effectiveness() * fin;
        // Bow to starboard positive; drag to starboard turns the bow there. A rudder that turns the bow to starboard
        // pushes the tail to port.
        let pod_moment = pod.drag_area_m2.value * pod.starboard_m / (p.frontal_area_m2 * p.length_m);
        let (y_beta, n_beta) = (a + fin, d - fin * arm);
        // Y = y_beta beta - rudder delta = 0,  N = n_beta beta + rudder arm delta + pod = 0
        -pod_moment / (rudder * (arm + n_beta / y_beta))
    }

    /// Lift slope of the fin, mirrored by the hull, on the frontal area \[1/rad\].
    pub(super) fn fin_slope(&self, p: &Parameters<f64>) -> f64 {
        let mirrored = Surface { span_m: 2.0 * self.fin.span_m, ..self.fin };
        mirrored.lift_slope_per_rad().value * self.fin.area_m2() / p.frontal_area_m2
    }

    /// Angle of attack of the fin per rudder angle, `tau = 1 - (theta - sin theta)/pi`, `cos theta = 2 c_f/c - 1`.
    pub(super) fn effectiveness(&self) -> f64 {
        let theta = (2.0 * self.rudder_chord - 1.0).clamp(-1.0, 1.0).acos();
        1.0 - (theta - theta.sin()) / std::f64::consts::PI
    }

    fn rudder_drag_area_m2(&self, rudder_rad: f64) -> f64 {
        let mirrored = Surface { span_m: 2.0 * self.fin.span_m, ..self.fin };
        mirrored.induced_drag_per_rad2().value * (self.effectiveness() * rudder_rad).powi(2) * self.fin.area_m2()
    }
}

/// Relative standard error of the rudder's effectiveness: thin aerofoils have no gaps.
const EFFECTIVENESS_ERROR: f64 = 0.15;
