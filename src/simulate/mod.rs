//! The forward process in time: a glider flown through given inputs, its state and outputs sampled on the way.
//!
//! The equations, the integrator and the names of the columns are those of the FMU. Knows no files but the table of
//! inputs that [`schedule`] reads.

pub mod mission;
pub mod schedule;
pub mod space;

use crate::dynamics::{Actuation, Ends, Glider, IntegrationError, Integrator, Parameters, State};
use crate::glide::{Start, start};

pub use schedule::Schedule;

/// How a time history is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimulationSettings {
    /// Who moves moving mass and ballast.
    pub actuation: Actuation,
    /// End of the history \[s\].
    pub stop_s: f64,
    /// Time between two rows \[s\].
    pub interval_s: f64,
    /// Relative tolerance of the integration.
    pub tolerance: f64,
}

/// The names of the columns of a [`Row`], as in the FMU.
pub const COLUMNS: [&str; 18] = [
    "time",
    "depth_m",
    "x_m",
    "pitch_rad",
    "pitch_rate_rad_s",
    "glide_angle_rad",
    "angle_of_attack_rad",
    "speed_m_s",
    "vertical_velocity_m_s",
    "v1_m_s",
    "v3_m_s",
    "net_mass_kg",
    "ballast_mass_kg",
    "moving_mass_position_m",
    "lift_N",
    "drag_N",
    "pitching_moment_N_m",
    "energy_J",
];

/// One moment of a time history, in the order of [`COLUMNS`].
pub type Row = [f64; COLUMNS.len()];

/// Flies a glider from its usual start ([`start`]) through the schedule and hands over each row; `on_row` ends the
/// flight early by returning `false`.
///
/// # Errors
/// Where the equations give no finite rate of change; the rows up to there have been handed over.
pub fn fly(
    parameters: &Parameters<f64>,
    schedule: &Schedule,
    settings: &SimulationSettings,
    on_row: impl FnMut(&Row) -> bool,
) -> Result<(), IntegrationError> {
    fly_from(&start(parameters), parameters, schedule, settings, on_row)
}

/// The same from another start: that of the vehicle before a parameter of it was changed, as in an FMU.
///
/// # Errors
/// As [`fly`].
pub fn fly_from(
    begin: &Start,
    parameters: &Parameters<f64>,
    schedule: &Schedule,
    settings: &SimulationSettings,
    mut on_row: impl FnMut(&Row) -> bool,
) -> Result<(), IntegrationError> {
    let mut state = begin.state;
    let mut glider = Glider::new(*parameters, settings.actuation, begin.inputs);
    let mut integrator = Integrator::new(settings.tolerance);
    let (mut time, mut rows) = (0.0, 0u64);
    let mut cursor = schedule.cursor(begin.inputs);
    cursor.apply(0.0, &mut glider);
    glider.apply_limits(0.0, &mut state);
    if !on_row(&row(&glider, time, &state)) {
        return Ok(());
    }
    while time < settings.stop_s {
        let next_row = ((rows + 1) as f64 * settings.interval_s).min(settings.stop_s);
        let change = cursor.next_change_s(time).map_or(settings.stop_s, |change| change.min(settings.stop_s));
        let ends_s = Ends { end_s: next_row.min(change), horizon_s: change };
        glider.follow(&mut integrator, &mut time, &mut state, ends_s, |_, _, _| true)?;
        if cursor.apply(time, &mut glider) {
            integrator.restart();
            glider.apply_limits(time, &mut state);
        }
        if time >= next_row {
            rows += 1;
            if !on_row(&row(&glider, time, &state)) {
                return Ok(());
            }
        }
    }
    Ok(())
}

/// One row of a time history: the state and what is looked at in it.
pub fn row(glider: &Glider, time_s: f64, state: &State<f64>) -> Row {
    let out = glider.outputs(time_s, state);
    [
        time_s,
        state.depth_m,
        state.x_m,
        state.pitch_rad,
        state.pitch_rate_rad_s,
        out.glide_angle_rad,
        out.angle_of_attack_rad,
        out.speed_m_s,
        out.vertical_velocity_m_s,
        state.v1_m_s,
        state.v3_m_s,
        out.net_mass_kg,
        state.ballast_mass_kg,
        state.moving_mass_1_m,
        out.lift_N,
        out.drag_N,
        out.pitching_moment_N_m,
        state.energy_J,
    ]
}
