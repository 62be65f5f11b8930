//! What follows from a state: what a pilot or an instrument reads of it.

use glidepolar_number::{Number, functions};

use super::equations::Instant;
use super::lateral::Body;
use super::state::{Inputs, State};
use super::vector::{add, cross, dot, scale};

/// What follows from a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outputs<T> {
    /// Speed through the water \[m/s\].
    pub speed_m_s: T,
    /// Angle of attack \[rad\].
    pub angle_of_attack_rad: T,
    /// Sideslip, flow from starboard positive \[rad\].
    pub sideslip_rad: T,
    /// Angle of the path through the water above the horizontal \[rad\].
    pub glide_angle_rad: T,
    /// Rate of change of the heading \[rad/s\].
    pub turn_rate_rad_s: T,
    /// Rate of change of depth, current included \[m/s\].
    pub vertical_velocity_m_s: T,
    /// Net mass, positive when heavy \[kg\].
    pub net_mass_kg: T,
    /// Ballast volume that an instrument reads \[m3\].
    pub ballast_m3: T,
    /// Lift \[N\].
    pub lift_N: T,
    /// Drag \[N\].
    pub drag_N: T,
    /// Side force, to starboard positive \[N\].
    pub side_force_N: T,
    /// Pitch as the glider's own instrument reads it \[rad\].
    pub pitch_read_rad: T,
    /// Gauge pressure as the glider's own instrument reads it, its lag left out \[dbar\].
    pub pressure_read_dbar: T,
    /// Share of its displacement that the hull has lost above the water.
    pub emerged_fraction: T,
    /// Upward force of the seabed \[N\].
    pub seabed_N: T,
    /// Power drawn \[W\].
    pub power_W: T,
    /// What an accelerometer at the centre of buoyancy reads, along each axis \[m/s2\]: acceleration less gravity.
    pub imu_m_s2: [T; 3],
}

/// What follows from a state, its servos included.
pub fn outputs<T: Number>(body: &Body<T>, time_s: T, state: &State<T>, inputs: &Inputs<T>) -> Outputs<T> {
    let now = Instant::new(body, time_s, state, inputs);
    let rates = now.rates_of_change();
    let h = &now.hydrodynamics;
    let sink = dot(now.attitude.down(), now.v);
    let path = if h.speed_m_s.value() > 0.0 { -functions::asin(sink / h.speed_m_s) } else { T::constant(0.0) };
    let own = [rates.v1_m_s, rates.v2_m_s, rates.v3_m_s];
    let carried = add(cross(now.rates, now.v), now.attitude.to_body(now.water_along_the_way()));
    let gravity = scale(body.plane.gravity_m_s2, now.attitude.down());
    Outputs {
        speed_m_s: h.speed_m_s,
        angle_of_attack_rad: h.angle_of_attack_rad,
        sideslip_rad: h.sideslip_rad,
        glide_angle_rad: path,
        turn_rate_rad_s: rates.heading_rad,
        vertical_velocity_m_s: now.depth_rate_m_s,
        net_mass_kg: now.net_mass_kg,
        ballast_m3: body.plane.ballast_m3(state.ballast_mass_kg),
        lift_N: h.lift_N,
        drag_N: h.drag_N,
        side_force_N: h.side_force_N,
        pitch_read_rad: (state.pitch_rad - body.plane.pitch_offset_rad) / body.plane.pitch_scale,
        pressure_read_dbar: now.water.pressure_Pa / body.plane.pressure_scale * 1e-4,
        emerged_fraction: now.contact.emerged_fraction,
        seabed_N: now.contact.seabed_N,
        power_W: rates.energy_J,
        imu_m_s2: std::array::from_fn(|i| own[i] + carried[i] - gravity[i]),
    }
}
