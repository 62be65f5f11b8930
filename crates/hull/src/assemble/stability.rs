//! Whether an assembled vehicle turns into the flow of its own accord.
//!
//! A bare hull turns away from it (Munk); surfaces behind the centre of buoyancy turn it back. What they do not hold, weight
//! below the centre of buoyancy must: at rest in pitch a small change of the angle is held where `m g h` exceeds
//! `rho/2 V^2 A L d`, quasi-steadily and for a path that keeps its direction.

use serde::Serialize;

use super::{Figure, Parts, Term};

/// Moment slopes further than this many standard errors from zero have a sure sign.
const SURE: f64 = 1.96;
/// Standard gravity \[m/s2\].
const GRAVITY_M_S2: f64 = 9.80665;

/// Static stability in pitch, weight apart.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct PitchStability {
    /// Moment slope about the centre of buoyancy on frontal area and length \[1/rad\]: below zero it turns into the flow.
    pub d_per_rad: Figure,
    /// Whether it turns into the flow; none where the standard error leaves that open.
    pub is_stable: Option<bool>,
    /// Where the lift acts, aft of the centre of buoyancy \[m\].
    pub neutral_point_aft_of_cb_m: f64,
    /// Moment per angle that weight below the centre of buoyancy has to hold at the glide speed \[N m/rad\].
    pub holding_moment_N_m_per_rad: f64,
    /// How far below the centre of buoyancy the weight of the displaced water holds it \[m\].
    pub weight_below_cb_m: f64,
}

impl PitchStability {
    pub(super) fn new(parts: &Parts<'_>, total: &Term) -> PitchStability {
        let (d, geometry) = (total.d_per_rad, &parts.hull.geometry);
        let pressure = 0.5 * parts.density_kg_m3 * parts.speed_m_s * parts.speed_m_s;
        let moment = (pressure * geometry.frontal_area_m2() * geometry.loa_m * d.value).max(0.0);
        let weight_N = GRAVITY_M_S2 * parts.density_kg_m3 * parts.volume_m3;
        PitchStability {
            d_per_rad: d,
            is_stable: (d.value.abs() > SURE * d.se).then_some(d.value < 0.0),
            neutral_point_aft_of_cb_m: -d.value / total.a_per_rad.value * geometry.loa_m,
            holding_moment_N_m_per_rad: moment,
            weight_below_cb_m: if weight_N > 0.0 { moment / weight_N } else { 0.0 },
        }
    }

    /// In a sentence, and whether it is a warning.
    pub fn sentence(&self, speed_m_s: f64) -> (bool, String) {
        let slope = format!("moment slope d = {:.3} +- {:.3} per rad", self.d_per_rad.value, self.d_per_rad.se);
        match self.is_stable {
            Some(true) => (
                false,
                format!(
                    "stable in pitch: {slope}; lift acts {:.3} m aft of the centre of buoyancy",
                    self.neutral_point_aft_of_cb_m
                ),
            ),
            Some(false) => (
                true,
                format!(
                    "not stable in pitch by its surfaces: {slope}. At {speed_m_s} m/s weight below the centre of buoyancy must hold {:.2} N m/rad ({:.1} mm below it); or move the wing aft, or add --tail",
                    self.holding_moment_N_m_per_rad,
                    1000.0 * self.weight_below_cb_m
                ),
            ),
            None => (true, format!("stable in pitch or not? {slope} has no sure sign")),
        }
    }
}
