//! Time histories as a page: what `glidepolar simulate --out` writes.

use crate::report::{Axis, Figure, Layer, Panel, Report, Section};
use crate::simulate::Row;

/// Rows kept for figures at most: more than any figure shows.
const MOST_ROWS: usize = 1 << 18;

/// The rows of a time history that its figures need, in bounded memory.
#[derive(Debug, Default)]
pub(super) struct History {
    rows: Vec<Row>,
    count: usize,
    stride: usize,
}

impl History {
    /// Adds a row.
    pub fn add(&mut self, row: &Row) {
        let stride = self.stride.max(1);
        if self.count.is_multiple_of(stride) {
            self.rows.push(*row);
        }
        self.count += 1;
        if self.rows.len() == MOST_ROWS {
            let mut index = 0;
            self.rows.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.stride = 2 * stride;
        }
    }

    /// The page, to which the caller adds what was found.
    pub fn page(&self, subject: &str) -> Report {
        let report = Report::new("Simulation", subject);
        let thinned = self.stride.max(1);
        let figures = Section::new("Time histories").figure(self.vertical()).figure(self.flow());
        let report = report.section(figures).section(Section::new("Track").figure(self.track()));
        if thinned == 1 {
            return report;
        }
        report.warning(format!("The figures show one row in {thinned} of {}; --csv has them all.", self.count))
    }

    fn vertical(&self) -> Figure {
        self.time_figure("depth-pitch", "Depth, pitch, net mass and the place of the moving mass.")
            .panel(Panel::new(Axis::new("Depth", "z", "m").reversed()).layer(self.against_time(|row| row[1])))
            .panel(Panel::new(Axis::new("Pitch", "θ", "deg")).layer(self.against_time(|row| row[3].to_degrees())))
            .panel(Panel::new(Axis::new("Net mass", "m_0", "kg")).layer(self.against_time(|row| row[11])))
            .panel(Panel::new(Axis::new("Moving mass", "r_{p1}", "mm")).layer(self.against_time(|row| row[13] * 1e3)))
    }

    fn flow(&self) -> Figure {
        self.time_figure("flow", "Speed through the water, downward velocity, angle of attack and glide path angle.")
            .panel(Panel::new(Axis::new("Speed", "V", "m/s")).layer(self.against_time(|row| row[7])))
            .panel(Panel::new(Axis::new("Down", "V_z", "m/s")).layer(self.against_time(|row| row[8])))
            .panel(
                Panel::new(Axis::new("Angle of attack", "α", "deg"))
                    .layer(self.against_time(|row| row[6].to_degrees())),
            )
            .panel(Panel::new(Axis::new("Glide path", "ξ", "deg")).layer(self.against_time(|row| row[5].to_degrees())))
    }

    fn track(&self) -> Figure {
        let (xs, zs) = self.rows.iter().map(|row| (row[2] / 1e3, row[1])).unzip();
        let panel = Panel::new(Axis::new("Depth", "z", "m").reversed()).layer(Layer::line(xs, zs));
        Figure::new("track", Axis::new("Distance", "x", "km")).panel(panel).caption("The path in the vertical plane.")
    }

    fn time_figure(&self, name: &str, caption: &str) -> Figure {
        Figure::new(name, Axis::new("Time", "t", self.time_unit().1)).caption(caption)
    }

    fn against_time(&self, of: impl Fn(&Row) -> f64) -> Layer {
        Layer::line(self.rows.iter().map(|row| self.time(row)).collect(), self.rows.iter().map(of).collect()).slot(0)
    }

    fn time(&self, row: &Row) -> f64 {
        row[0] / self.time_unit().0
    }

    /// Seconds in the unit of time that suits the duration, and its name.
    fn time_unit(&self) -> (f64, &'static str) {
        match self.rows.last().map_or(0.0, |row| row[0]) {
            0.0..7200.0 => (1.0, "s"),
            7200.0..345_600.0 => (3600.0, "h"),
            _ => (86_400.0, "d"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::COLUMNS;

    #[test]
    fn a_long_history_is_bounded_and_says_so() {
        let mut history = History::default();
        for i in 0..3 * MOST_ROWS {
            let mut row = [0.0; COLUMNS.len()];
            row[0] = i as f64;
            history.add(&row);
        }
        assert!(history.rows.len() < MOST_ROWS);
        let steps: Vec<f64> = history.rows.windows(2).map(|w| w[1][0] - w[0][0]).collect();
        assert!(steps.iter().all(|step| *step == history.stride as f64), "evenly thinned");
        assert!(history.page("").warnings[0].contains("one row in 4 of"), "{:?}", history.page("").warnings);
    }

    #[test]
    fn the_columns_are_those_that_the_figures_name() {
        let of = |name: &str| COLUMNS.iter().position(|c| *c == name);
        for (name, index) in [
            ("time", 0),
            ("depth_m", 1),
            ("x_m", 2),
            ("pitch_rad", 3),
            ("glide_angle_rad", 5),
            ("angle_of_attack_rad", 6),
            ("speed_m_s", 7),
            ("vertical_velocity_m_s", 8),
            ("net_mass_kg", 11),
            ("moving_mass_position_m", 13),
        ] {
            assert_eq!(of(name), Some(index));
        }
    }
}
