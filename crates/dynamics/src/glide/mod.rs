//! The forward process: how a glider glides, steadily, in the vertical plane.
//!
//! The balance of a steady glide along a path at the angle `xi` (negative when descending) is
//! ```text
//! L = W cos xi,   D = -W sin xi,   so   CD + CL tan xi = 0,   q A (CL cos xi - CD sin xi) = W,   W = m0 g
//! ```
//! - [`at_path`]: angle and speed given; the angle of attack in closed form, then net mass and trim.
//! - [`at_pitch`]: net mass and pitch given; the inverse's own question, solved by Newton's method.
//! - [`shallowest`]: which path angles exist at all.
//! - [`start`]: the glide in which a simulation starts when nothing else is said.
//!
//! Works on [`Parameters`], knows no files.

mod by_pitch;
mod closed_form;
mod start;

use crate::forces::Flow;
use crate::{Parameters, Surroundings};
use glidepolar_number::{Number, functions};

pub use by_pitch::{Attitude, Deflection, Flight, SteadyGlider, at_pitch};
pub use closed_form::{PathLimits, at_path, shallowest};
pub use start::{Start, start, start_in};

/// A steady glide: everything that stays constant along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyGlide<T> {
    /// Glide path angle, negative when descending \[rad\].
    pub glide_angle_rad: T,
    /// Angle of attack \[rad\].
    pub angle_of_attack_rad: T,
    /// Pitch \[rad\].
    pub pitch_rad: T,
    /// Speed through the water \[m/s\].
    pub speed_m_s: T,
    /// Velocity along axis 1 \[m/s\].
    pub v1_m_s: T,
    /// Velocity along axis 3 \[m/s\].
    pub v3_m_s: T,
    /// Horizontal speed through the water \[m/s\].
    pub horizontal_velocity_m_s: T,
    /// Downward speed through the water \[m/s\].
    pub vertical_velocity_m_s: T,
    /// Lift \[N\].
    pub lift_N: T,
    /// Drag \[N\].
    pub drag_N: T,
    /// Hydrodynamic pitching moment about the centre of buoyancy, Munk couple included \[N m\].
    pub moment_N_m: T,
    /// Net mass, positive when heavy \[kg\].
    pub net_mass_kg: T,
    /// Ballast volume that gives this net mass \[m3\].
    pub ballast_m3: T,
    /// Ballast mass that gives this net mass \[kg\].
    pub ballast_mass_kg: T,
    /// Position of the moving mass that balances the pitching moment \[m\].
    pub moving_mass_m: T,
}

/// Why there is no such glide.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GlideError {
    /// The path is shallower than lift and drag allow.
    #[error(
        "no steady glide at a path angle of {asked_deg:.3} deg: this glider descends at {descent_deg:.3} deg or steeper and climbs at {ascent_deg:.3} deg or steeper; choose a steeper path"
    )]
    TooShallow {
        /// The angle that was asked for \[deg\].
        asked_deg: f64,
        /// Shallowest descent \[deg\], negative.
        descent_deg: f64,
        /// Shallowest ascent \[deg\].
        ascent_deg: f64,
    },
    /// The pitch and the net mass do not belong to any glide.
    #[error(
        "no steady glide at a pitch of {pitch_deg:.3} deg with a net mass of {net_mass_kg:.4} kg: the nose must point the way the glider is driven, down when heavy and up when light, and steeply enough"
    )]
    NoBalance {
        /// The pitch that was asked for \[deg\].
        pitch_deg: f64,
        /// The net mass that was asked for \[kg\].
        net_mass_kg: f64,
    },
    /// A number without meaning was given.
    #[error("{name} is {value}, expected {expected}")]
    OutOfRange {
        /// Which quantity.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What can be.
        expected: &'static str,
    },
}

/// The flow of a steady glide: no rotation, the leg known by the sign of the sink rate.
fn steady_flow<T: Number>(parameters: &Parameters<T>, water: &Surroundings<T>, alpha: T, speed: T, xi: T) -> Flow<T> {
    let (sin, cos) = functions::sin_cos(alpha);
    Flow {
        v1_m_s: speed * cos,
        v3_m_s: speed * sin,
        pitch_rate_rad_s: T::constant(0.0),
        sink_m_s: -speed * functions::sin(xi),
        density_kg_m3: parameters.true_density_kg_m3(water.density_kg_m3),
        time_s: water.time_s,
        roll_rad: T::constant(0.0),
        rudder_rad: T::constant(0.0),
        empirical: parameters.empirical(water),
    }
}

/// Everything else that follows once angle of attack, path and speed are known.
fn complete<T: Number>(
    parameters: &Parameters<T>,
    water: &Surroundings<T>,
    alpha: T,
    xi: T,
    speed: T,
) -> SteadyGlide<T> {
    let p = parameters;
    let forces = p.hydrodynamics(&steady_flow(p, water, alpha, speed, xi));
    let (sin, cos) = functions::sin_cos(xi);
    let net_mass_kg = (forces.lift_N * cos - forces.drag_N * sin) / p.gravity_m_s2;
    let without_ballast = p.net_mass_kg(T::constant(0.0), water);
    let ballast_m3 = (without_ballast - net_mass_kg) / (p.true_density_kg_m3(water.density_kg_m3) * p.ballast_scale);
    let ballast_mass_kg = p.ballast_mass_kg(ballast_m3);
    let pitch = xi + alpha;
    let (v1, v3) = (speed * functions::cos(alpha), speed * functions::sin(alpha));
    // Moment balance: g (S1 cos + S3 sin) = M_hydro + (m3 - m1) v1 v3, the hull's own masses drop out of the couple.
    let munk = (p.added_mass_3_kg - p.added_mass_1_kg) * v1 * v3;
    let fixed_1 = p.offset_mass_kg * p.offset_mass_forward_m + ballast_mass_kg * p.ballast_forward_m;
    let moment_3 = p.moving_mass_kg * p.moving_mass_height_m
        + p.offset_mass_kg * p.offset_mass_below_m
        + ballast_mass_kg * p.ballast_below_m;
    let hydrostatic = (forces.moment_without_munk_N_m + munk) / (p.gravity_m_s2 * functions::cos(pitch));
    SteadyGlide {
        glide_angle_rad: xi,
        angle_of_attack_rad: alpha,
        pitch_rad: pitch,
        speed_m_s: speed,
        v1_m_s: v1,
        v3_m_s: v3,
        horizontal_velocity_m_s: speed * cos,
        vertical_velocity_m_s: -speed * sin,
        lift_N: forces.lift_N,
        drag_N: forces.drag_N,
        moment_N_m: forces.moment_N_m,
        net_mass_kg,
        ballast_m3,
        ballast_mass_kg,
        moving_mass_m: (hydrostatic - fixed_1 - moment_3 * functions::tan(pitch)) / p.moving_mass_kg,
    }
}
