//! From parameters to what the instruments should have read: one steady glide for each sample.
//!
//! ```text
//! pitch    = pitch_scale read + pitch_offset               pressure = pressure_scale (read + lag d(read)/dt)
//! net mass = by masses, volumes and the water around       (alpha, V) = the steady glide of that pitch and net mass
//! sink     = V sin(alpha - pitch) + vertical current       sink read = sink / pressure_scale - lag d(sink read)/dt
//! density  = density read (1 + kappa (pressure - pressure read)): a CTD computes it at the pressure that it reads
//! ```

use crate::Number;
use crate::dynamics::buoyancy::WATER_COMPRESSIBILITY_PER_PA;
use crate::dynamics::{Parameters, Surroundings};
use crate::glide::{Attitude, Deflection, SteadyGlider};
use crate::log::{DBAR_PA, Observation};

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

/// What the instruments should have read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction<T> {
    /// Downward velocity as the pressure sensor shows it \[m/s\].
    pub sink_m_s: T,
    /// Speed through the water \[m/s\].
    pub speed_m_s: T,
    /// Angle of attack \[rad\].
    pub angle_of_attack_rad: T,
    /// Where the solution for a nearby parameter set may start.
    pub guess: [f64; 2],
}

/// The prediction for one sample; nothing where the glider cannot glide at all at this pitch and net mass.
pub fn predict<T: Number>(
    glider: &SteadyGlider<T>,
    observed: &Observation,
    inertia: &Inertia,
    guess: Option<[f64; 2]>,
) -> Option<Prediction<T>> {
    let parameters = &glider.parameters;
    let water = surroundings(parameters, observed);
    let pitch_rad = true_pitch_rad(parameters, observed.pitch_rad);
    let net_mass_kg = parameters.net_mass_kg(T::constant(observed.ballast_m3), &water) + inertia.net_mass_kg;
    let turned_rad = pitch_rad + inertia.pitch_rad;
    let deflection = Deflection {
        roll_rad: T::constant(or_zero(observed.roll_rad)),
        rudder_rad: T::constant(or_zero(observed.rudder_rad)),
    };
    let flight = glider.flight(&water, Attitude { pitch_rad: turned_rad, net_mass_kg }, deflection, guess).ok()?;
    let through_water = flight.speed_m_s * (flight.angle_of_attack_rad - pitch_rad).sin();
    Some(Prediction {
        sink_m_s: sink_read_m_s(parameters, through_water, inertia.sink_rate_m_s2),
        speed_m_s: flight.speed_m_s,
        angle_of_attack_rad: flight.angle_of_attack_rad,
        guess: flight.guess,
    })
}

/// The water around a sample, the errors of the pressure sensor taken off.
pub(crate) fn surroundings<T: Number>(parameters: &Parameters<T>, observed: &Observation) -> Surroundings<T> {
    let lag = parameters.pressure_lag_s * or_zero(observed.pressure_rate_dbar_s);
    let temperature_C = if observed.temperature_C.is_finite() {
        T::constant(observed.temperature_C)
    } else {
        parameters.reference_temperature_C
    };
    let read_dbar = or_zero(observed.pressure_dbar);
    let pressure_Pa = parameters.pressure_scale * (lag + read_dbar) * DBAR_PA;
    Surroundings {
        density_kg_m3: density_there(observed.density_kg_m3, pressure_Pa, read_dbar),
        pressure_Pa,
        temperature_C,
        time_s: T::constant(observed.time_s),
    }
}

/// Density at the true pressure of water whose density was computed at the pressure that was read \[kg/m3\].
pub(super) fn density_there<T: Number>(density_kg_m3: f64, pressure_Pa: T, read_dbar: f64) -> T {
    ((pressure_Pa - read_dbar * DBAR_PA) * WATER_COMPRESSIBILITY_PER_PA + 1.0) * density_kg_m3
}

/// The pitch behind the pitch that is read.
pub(super) fn true_pitch_rad<T: Number>(parameters: &Parameters<T>, read_rad: f64) -> T {
    parameters.pitch_scale * read_rad + parameters.pitch_offset_rad
}

/// The downward velocity that the pressure sensor shows when the glider sinks through the water at this rate.
pub(super) fn sink_read_m_s<T: Number>(parameters: &Parameters<T>, through_water_m_s: T, sink_rate_m_s2: f64) -> T {
    (through_water_m_s + parameters.vertical_current_m_s) / parameters.pressure_scale
        - parameters.pressure_lag_s * or_zero(sink_rate_m_s2)
}

pub(super) fn or_zero(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}
