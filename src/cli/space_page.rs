//! The page of a run in six degrees of freedom: map, profile, attitude and what steered.

use super::mission_page::energy_table;
use crate::dynamics::Energy;
use crate::report::{Axis, Figure, Layer, Panel, Report, Section, paragraph};
use crate::simulate::mission::{Account, Mission};
use crate::simulate::space::{Row, column};

/// Rows kept for figures at most: more than any figure shows.
const MOST_ROWS: usize = 1 << 16;

/// The rows that figures need, in bounded memory.
#[derive(Debug, Default)]
pub(super) struct Trace {
    rows: Vec<Row>,
    stride: usize,
    count: usize,
}

impl Trace {
    /// Adds a row.
    pub fn add(&mut self, row: &Row) {
        let stride = self.stride.max(1);
        if self.count.is_multiple_of(stride) {
            if self.rows.len() == MOST_ROWS {
                let mut index = 0;
                self.rows.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                self.stride = 2 * stride;
            }
            self.rows.push(*row);
        }
        self.count += 1;
    }

    fn column(&self, name: &str, scale: f64) -> Vec<f64> {
        self.rows.iter().map(|row| column(row, name) * scale).collect()
    }

    fn degrees(&self, name: &str) -> Vec<f64> {
        self.column(name, 180.0 / std::f64::consts::PI)
    }

    /// The way over ground, with the waypoints \[m\].
    fn map(&self, waypoints_m: &[[f64; 2]]) -> Figure {
        let track = Layer::line(self.column("east_m", 1e-3), self.column("north_m", 1e-3)).label("glider");
        let mut panel = Panel::new(Axis::new("North", "y", "km")).layer(track);
        if !waypoints_m.is_empty() {
            let (east, north) = waypoints_m.iter().map(|[north, east]| (east * 1e-3, north * 1e-3)).unzip();
            panel = panel.layer(Layer::points(east, north).label("waypoints"));
        }
        Figure::new("map", Axis::new("East", "x", "km"))
            .panel(panel)
            .map()
            .caption("The way over ground, axes of one scale.")
    }

    fn record(&self) -> Figure {
        let longest_s = self.rows.last().map_or(0.0, |row| column(row, "time"));
        let (scale, unit) = if longest_s < 7200.0 { (1.0, "s") } else { (1.0 / 3600.0, "h") };
        let time = || self.column("time", scale);
        let line = |values: Vec<f64>| Layer::line(time(), values).slot(0);
        Figure::new("record", Axis::new("Time", "t", unit))
            .panel(Panel::new(Axis::new("Depth", "z", "m").reversed()).layer(line(self.column("depth_m", 1.0))))
            .panel(Panel::new(Axis::new("Pitch", "θ", "deg")).layer(line(self.degrees("pitch_rad"))))
            .panel(Panel::new(Axis::new("Roll", "φ", "deg")).layer(line(self.degrees("roll_rad"))))
            .panel(Panel::new(Axis::new("Heading", "ψ", "deg")).layer(line(self.degrees("heading_rad"))))
            .panel(
                Panel::new(Axis::new("Rudder, roll mass", "δ, γ", "deg"))
                    .layer(line(self.degrees("rudder_rad")).label("rudder"))
                    .layer(Layer::line(time(), self.degrees("roll_mass_rad")).slot(1).label("roll mass")),
            )
            .caption("Depth, attitude and what steers against time.")
    }
}

/// The page of a time history.
pub(super) fn history_page(vehicle: &str, trace: &Trace) -> Report {
    let figures = Section::new("Time history").figure(trace.record()).figure(trace.map(&[]));
    Report::new("Simulation in six degrees of freedom", vehicle).section(figures)
}

/// The page of a mission.
pub(super) fn mission_page(vehicle: &str, mission: &Mission, account: &Account, trace: &Trace) -> Report {
    let mut section = Section::new("Flight")
        .text(paragraph(&mission.source))
        .figure(trace.map(&mission.route.waypoints_m))
        .figure(trace.record());
    // A vehicle file may leave energy out, and noughts would claim that nothing was drawn.
    let Account { hotel_J, pump_J, steering_J, surfacing_J, .. } = *account;
    let energy = Energy { hotel_J, pump_J, steering_J, surfacing_J };
    if energy.total_J() > 0.0 {
        section = section.table(energy_table(&energy));
    }
    Report::new("Mission in six degrees of freedom", format!("{vehicle}, {}", mission.name)).section(section)
}
