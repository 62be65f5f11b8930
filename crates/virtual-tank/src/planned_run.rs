//! One run as it was made: what was ordered, when, and what was true of it. Knows nothing of how runs follow each other.

use super::motion::Command;

/// A run as it was made.
#[derive(Debug, Clone)]
pub(super) struct PlannedRun {
    /// Index of the hull; none for the strut alone.
    pub hull: Option<usize>,
    pub command: Command,
    pub day: usize,
    /// After the begin of the day.
    pub hours: f64,
    /// True temperature of the water, and the one written down.
    pub temperature_c: f64,
    pub recorded_temperature_c: f64,
    /// Time since the end of the run before, and its speed.
    pub wait_s: f64,
    pub speed_before_m_s: f64,
    /// The last run of the day that loaded the balance: its hull and its command.
    pub loaded_before: Option<(Option<usize>, Command)>,
    /// True yaw less set yaw, this run's own.
    pub yaw_error_deg: f64,
    /// True speed over set speed, this run's own.
    pub speed_ratio: f64,
    /// Drag coefficient of something caught on the model.
    pub extra_cd: f64,
    /// This run's own draw for a speed that is wrongly recorded, of unit standard deviation.
    pub speed_slip: f64,
    pub note: String,
}

impl PlannedRun {
    /// Since the begin of the campaign's first day, s.
    pub(super) fn start_time_s(&self) -> f64 {
        self.day as f64 * 86_400.0 + self.hours * 3600.0
    }
}
