//! What was measured at one moment, and how the velocities change there: the equations of motion with the pitch, ballast and
//! water of the record. Knows no steps.

use super::Passage;
use crate::Number;
use crate::dynamics::{Inputs, Parameters, State, accelerations};
use crate::identify::model::{density_there, or_zero, true_pitch_rad};

/// What was measured at one moment, between two samples by straight lines.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    pub(super) time_s: f64,
    pitch_rad: f64,
    pitch_rate_rad_s: f64,
    pressure_dbar: f64,
    pressure_rate_dbar_s: f64,
    density_kg_m3: f64,
    temperature_C: f64,
    ballast_m3: f64,
    roll_rad: f64,
    rudder_rad: f64,
}

impl Moment {
    pub(super) fn at(passage: &Passage, i: usize) -> Moment {
        let o = &passage.observations[i];
        Moment {
            time_s: o.time_s,
            pitch_rad: o.pitch_rad,
            pitch_rate_rad_s: passage.pitch_rates_rad_s[i],
            pressure_dbar: or_zero(o.pressure_dbar),
            pressure_rate_dbar_s: or_zero(o.pressure_rate_dbar_s),
            density_kg_m3: o.density_kg_m3,
            temperature_C: o.temperature_C,
            ballast_m3: o.ballast_m3,
            roll_rad: or_zero(o.roll_rad),
            rudder_rad: or_zero(o.rudder_rad),
        }
    }

    pub(super) fn between(&self, other: &Moment, share: f64) -> Moment {
        let mix = |a: f64, b: f64| a + share * (b - a);
        Moment {
            time_s: mix(self.time_s, other.time_s),
            pitch_rad: mix(self.pitch_rad, other.pitch_rad),
            pitch_rate_rad_s: mix(self.pitch_rate_rad_s, other.pitch_rate_rad_s),
            pressure_dbar: mix(self.pressure_dbar, other.pressure_dbar),
            pressure_rate_dbar_s: mix(self.pressure_rate_dbar_s, other.pressure_rate_dbar_s),
            density_kg_m3: mix(self.density_kg_m3, other.density_kg_m3),
            temperature_C: mix(self.temperature_C, other.temperature_C),
            ballast_m3: mix(self.ballast_m3, other.ballast_m3),
            roll_rad: mix(self.roll_rad, other.roll_rad),
            rudder_rad: mix(self.rudder_rad, other.rudder_rad),
        }
    }
}

pub(super) fn sink<T: Number>(parameters: &Parameters<T>, at: &Moment, [v1, v3]: [T; 2]) -> T {
    let (sin, cos) = true_pitch_rad(parameters, at.pitch_rad).sin_cos();
    v3 * cos - v1 * sin
}

/// Rates of change of the velocities.
pub(super) fn rates<T: Number>(p: &Parameters<T>, at: &Moment, [v1, v3]: [T; 2]) -> [T; 2] {
    let pressure_Pa =
        p.pressure_scale * (p.pressure_lag_s * at.pressure_rate_dbar_s + at.pressure_dbar) * crate::log::DBAR_PA;
    let read = density_there(at.density_kg_m3, pressure_Pa, at.pressure_dbar);
    let density = p.true_density_kg_m3(read);
    let depth_m = (pressure_Pa / (density * p.gravity_m_s2)).at_least(0.0);
    // What moves the masses and the memory rests: constants, in which no slope is.
    let state = State {
        depth_m,
        pitch_rad: true_pitch_rad(p, at.pitch_rad),
        pitch_rate_rad_s: p.pitch_scale * at.pitch_rate_rad_s,
        v1_m_s: v1,
        v3_m_s: v3,
        moving_mass_3_m: p.moving_mass_height_m,
        ballast_mass_kg: p.ballast_mass_kg(T::constant(at.ballast_m3)),
        ..State::default().map(T::constant)
    };
    let inputs = Inputs {
        water_density_kg_m3: read,
        water_temperature_C: if at.temperature_C.is_finite() {
            T::constant(at.temperature_C)
        } else {
            p.reference_temperature_C
        },
        seabed_depth_m: T::constant(f64::MAX),
        roll_rad: T::constant(at.roll_rad),
        rudder_rad: T::constant(at.rudder_rad),
        ..Inputs::default().map(T::constant)
    };
    accelerations(p, T::constant(at.time_s), &state, &inputs, T::constant(0.0))
}
