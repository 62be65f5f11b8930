//! What the glider's own computer does between two turns: it sets the moving mass for the leg from the steady pitch
//! balance, and then corrects it slowly by the pitch that it reads.
//!
//! In a steady glide the moments about the centre of buoyancy balance, `mbar g (r1 cos th + r3 sin th) = M`; about the
//! balance a pitch error `e` needs the mass moved by `dr1/dth e = r3/cos^2 th e`. The correction takes a share of that
//! at each look, outside a dead band, and is remembered from leg to leg of the same kind.

use super::{LegOrder, Mission, PitchControl};
use crate::dynamics::{Parameters, Surroundings};
use crate::glide::{Attitude, GlideError, SteadyGlide, at_pitch};
use crate::simulate::mission::MissionError;

/// Set-points and corrections of the two legs.
#[derive(Debug, Clone)]
pub(super) struct Controller {
    descent: LegTrim,
    ascent: LegTrim,
    /// Position of the moving mass at the surface \[m\].
    pub surface_m: f64,
    control: PitchControl,
}

#[derive(Debug, Clone, Copy)]
struct LegTrim {
    /// Pitch to be read \[rad\].
    pitch_rad: f64,
    /// Position of the moving mass by the steady balance \[m\].
    forward_m: f64,
    /// What the correction has added \[m\].
    correction_m: f64,
    /// Shift of the mass per change of pitch \[m/rad\].
    shift_m_per_rad: f64,
    limits_m: [f64; 2],
}

impl Controller {
    /// The trim of both legs, once it is sure that both can be flown from the surface to the largest depth.
    ///
    /// # Errors
    /// Where the glider has no steady glide with this ballast and pitch in this water.
    pub fn new(parameters: &Parameters<f64>, mission: &Mission) -> Result<Self, MissionError> {
        let trim = |leg: &'static str, order: LegOrder| -> Result<LegTrim, MissionError> {
            let deepest = mission.max_depth_m.min(mission.seabed.largest());
            let mut middle = None;
            for depth_m in [0.0, deepest, 0.5 * (mission.climb_to_m + deepest)] {
                let glide = steady(parameters, mission, order, depth_m).map_err(|(net_mass_kg, error)| {
                    MissionError::NoGlide { leg, depth_m, ballast_cc: order.ballast_m3 * 1e6, net_mass_kg, error }
                })?;
                middle = Some(glide);
            }
            let limits_m = [parameters.moving_mass_min_m, parameters.moving_mass_max_m];
            Ok(LegTrim {
                pitch_rad: order.pitch_rad,
                forward_m: middle.map_or(0.0, |glide| glide.moving_mass_m).clamp(limits_m[0], limits_m[1]),
                correction_m: 0.0,
                shift_m_per_rad: pendulum_m(parameters) / order.pitch_rad.cos().powi(2),
                limits_m,
            })
        };
        Ok(Controller {
            descent: trim("descent", mission.descent)?,
            ascent: trim("ascent", mission.ascent)?,
            surface_m: (-pendulum_m(parameters) * mission.surfacing.pitch_rad.tan())
                .clamp(parameters.moving_mass_min_m, parameters.moving_mass_max_m),
            control: mission.control,
        })
    }

    /// Where the moving mass belongs on a leg \[m\].
    pub fn position_m(&self, descending: bool) -> f64 {
        let trim = if descending { &self.descent } else { &self.ascent };
        (trim.forward_m + trim.correction_m).clamp(trim.limits_m[0], trim.limits_m[1])
    }

    /// Looks at the pitch; whether the moving mass is to move.
    pub fn look(&mut self, descending: bool, pitch_read_rad: f64) -> bool {
        let trim = if descending { &mut self.descent } else { &mut self.ascent };
        let error = pitch_read_rad - trim.pitch_rad;
        if self.control.gain == 0.0 || error.abs() <= self.control.deadband_rad {
            return false;
        }
        // Forward of where it is brings the nose down. Against a stop nothing is gained by asking for more.
        let wanted = trim.forward_m + trim.correction_m + self.control.gain * trim.shift_m_per_rad * error;
        let held = wanted.clamp(trim.limits_m[0], trim.limits_m[1]);
        let moves = held != trim.forward_m + trim.correction_m;
        trim.correction_m = held - trim.forward_m;
        moves
    }
}

/// The steady glide on a leg at a depth, or the net mass with which there is none.
fn steady(
    parameters: &Parameters<f64>,
    mission: &Mission,
    order: LegOrder,
    depth_m: f64,
) -> Result<SteadyGlide<f64>, (f64, GlideError)> {
    let p = parameters;
    let density = mission.density.as_ref().map_or(p.reference_density_kg_m3, |profile| profile.at(depth_m));
    let water = Surroundings {
        density_kg_m3: density,
        pressure_Pa: p.true_density_kg_m3(density) * p.gravity_m_s2 * depth_m,
        temperature_C: mission.temperature.as_ref().map_or(p.reference_temperature_C, |profile| profile.at(depth_m)),
        time_s: 0.0,
    };
    let net_mass_kg = p.net_mass_kg(order.ballast_m3.clamp(p.ballast_min_m3, p.ballast_max_m3), &water);
    let pitch_rad = p.pitch_scale * order.pitch_rad + p.pitch_offset_rad;
    at_pitch(p, &water, Attitude { pitch_rad, net_mass_kg }).map_err(|error| (net_mass_kg, error))
}

/// Height of the pendulum that all masses together make, as if it were the moving mass's alone \[m\].
fn pendulum_m(p: &Parameters<f64>) -> f64 {
    p.moving_mass_height_m
        + (p.offset_mass_kg * p.offset_mass_below_m + p.ballast_nominal_kg * p.ballast_below_m) / p.moving_mass_kg
}
