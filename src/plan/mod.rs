//! How far and how long on one battery: energy per dive, dives, days, distance, and what is left.
//!
//! A dive is two steady glides, integrated over depth (the hull yields, the water grows denser), and the time of the
//! ballast strokes between them. Its energy is the account of [`crate::dynamics::energy`], as in simulations and the FMU.
//! During a stroke at depth the net mass runs from one sign to the other; speed goes with its root, so the way along is
//! 2/3 of that at full speed, and down and up cancel. At the surface the first half of the stroke is a wait. After each
//! turn the glider starts from rest: against drag that grows with the square of speed it moves at `V tanh(t/tau)`,
//! `tau = m1 V/D`, and loses `tau ln 2` on a glider at full speed. Knows no files; [`calibrate`] finds the constants from
//! battery counters.

pub mod calibrate;
mod outlook;
pub mod plausible;

use crate::dynamics::{Energy, Parameters, Surroundings, Usage};
use crate::glide::{Attitude, GlideError, at_pitch};
use crate::simulate::mission::LegOrder;

pub use crate::assemble::Sensor;
pub use outlook::{Ask, Outlook, PlanError, UNSTATED_SPEED_ERROR, outlook, states_polar_errors};

/// Relative gain of sea water's density per gauge pressure \[1/Pa\]: the adiabatic compressibility of sea water at
/// 10 degC, 35 and 500 dbar by TEOS-10; within 6 % over the open ocean's upper 2000 m.
pub const WATER_COMPRESSIBILITY_PER_PA: f64 = 4.3e-10;

/// One dive of many.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dive {
    /// Depth of the turn \[m\].
    pub depth_m: f64,
    /// The leg down.
    pub descent: LegOrder,
    /// The leg up.
    pub ascent: LegOrder,
    /// Ballast volume at the surface \[m3\].
    pub surface_ballast_m3: f64,
    /// Dives from one surfacing to the next.
    pub dives_per_surfacing: f64,
    /// Stay at the surface \[s\].
    pub stay_s: f64,
    /// Moves of the moving mass.
    pub pitch_moves: f64,
    /// Density of the water at the surface \[kg/m3\]; it grows with pressure by [`WATER_COMPRESSIBILITY_PER_PA`].
    pub surface_density_kg_m3: f64,
}

/// One dive's account, its share of the surfacing included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PerDive {
    /// Time \[s\].
    pub duration_s: f64,
    /// Time on the way down \[s\].
    pub descent_s: f64,
    /// Time on the way up \[s\].
    pub ascent_s: f64,
    /// Way along through the water \[m\].
    pub distance_m: f64,
    /// Strokes of the pump.
    pub pumpings: f64,
    /// Energy.
    pub energy: Energy<f64>,
}

/// The account of one dive.
///
/// # Errors
/// Where a leg has no steady glide at some depth.
pub fn per_dive(parameters: &Parameters<f64>, dive: &Dive) -> Result<PerDive, GlideError> {
    let p = parameters;
    let descent = leg(p, dive, dive.descent)?;
    let ascent = leg(p, dive, dive.ascent)?;
    let stroke = (dive.ascent.ballast_m3 - dive.descent.ballast_m3).max(0.0);
    let extra = (dive.surface_ballast_m3 - dive.ascent.ballast_m3).max(0.0);
    let surfacings = 1.0 / dive.dives_per_surfacing;
    let stroke_s = stroke / p.ballast_rate_m3_s;
    let turning_s = (2.0 - surfacings) * stroke_s;
    let surface_s = surfacings * (dive.stay_s + 0.5 * (stroke + extra) / p.ballast_rate_m3_s);
    let mean_horizontal_m_s = (descent.way_m + ascent.way_m) / (descent.time_s + ascent.time_s);
    let under_way_s = descent.time_s + ascent.time_s + turning_s;
    let bottom_Pa = pressure_Pa(p, dive, dive.depth_m);
    let at_the_turn = Usage {
        time_s: under_way_s + surface_s,
        under_water_s: under_way_s,
        pumped_m3: stroke,
        pressure_Pa: bottom_Pa,
        pitch_moves: dive.pitch_moves,
        surfacings,
    };
    let at_the_surface = Usage { pumped_m3: surfacings * extra, ..Usage::none() };
    Ok(PerDive {
        duration_s: under_way_s + surface_s,
        descent_s: descent.time_s,
        ascent_s: ascent.time_s,
        distance_m: descent.way_m + ascent.way_m + 2.0 / 3.0 * turning_s * mean_horizontal_m_s,
        pumpings: f64::from(u8::from(stroke > 0.0)) + if extra > SMALLEST_STROKE_M3 { surfacings } else { 0.0 },
        energy: at_the_turn.energy(p).plus(&at_the_surface.energy(p)),
    })
}

/// Less is the rounding of two settings that are the same \[m3\].
const SMALLEST_STROKE_M3: f64 = 1e-9;

struct LegTotal {
    time_s: f64,
    way_m: f64,
}

/// Time and way of a leg: Simpson's rule over depth.
fn leg(p: &Parameters<f64>, dive: &Dive, order: LegOrder) -> Result<LegTotal, GlideError> {
    const INTERVALS: usize = 16;
    let step = dive.depth_m / INTERVALS as f64;
    let ballast = order.ballast_m3.clamp(p.ballast_min_m3, p.ballast_max_m3);
    let mut total = LegTotal { time_s: 0.0, way_m: 0.0 };
    for i in 0..=INTERVALS {
        let depth = i as f64 * step;
        let pressure = pressure_Pa(p, dive, depth);
        let water = Surroundings {
            density_kg_m3: dive.surface_density_kg_m3 * (1.0 + WATER_COMPRESSIBILITY_PER_PA * pressure),
            pressure_Pa: pressure,
            temperature_C: p.reference_temperature_C,
            time_s: 0.0,
        };
        let attitude = Attitude { pitch_rad: order.pitch_rad, net_mass_kg: p.net_mass_kg(ballast, &water) };
        let glide = at_pitch(p, &water, attitude)?;
        let weight = match i {
            0 | INTERVALS => 1.0,
            _ if i % 2 == 1 => 4.0,
            _ => 2.0,
        } * step
            / 3.0;
        total.time_s += weight / glide.vertical_velocity_m_s.abs();
        total.way_m += weight * glide.horizontal_velocity_m_s / glide.vertical_velocity_m_s.abs();
        if i == 0 {
            let inertia_kg = p.mass_kg() + p.added_mass_1_kg;
            total.time_s += inertia_kg * glide.speed_m_s / glide.drag_N * std::f64::consts::LN_2;
        }
    }
    Ok(total)
}

fn pressure_Pa(p: &Parameters<f64>, dive: &Dive, depth_m: f64) -> f64 {
    dive.surface_density_kg_m3 * p.gravity_m_s2 * depth_m
}

#[cfg(test)]
mod tests;
