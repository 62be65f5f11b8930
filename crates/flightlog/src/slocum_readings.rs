//! What the sensors of a Slocum's two computers read, each at its times, and the positions that the receiver had new.

use super::fix::{GpsFix, Positions, degrees};

/// What the sensors of both computers read, each at its times.
pub(super) struct Sensors {
    pub(super) values: Vec<Vec<(f64, f64)>>,
    positions: Vec<Position>,
}

/// A position as the receiver writes it.
struct Position {
    time_s: f64,
    lat: f64,
    lon: f64,
    /// Whether the receiver does not call it bad.
    is_good: bool,
}

impl Position {
    fn of(time_s: f64, values: &[f64]) -> Self {
        let (lat, lon, status) = (values[LAT], values[LON], values[STATUS]);
        let is_good = lat.is_finite() && lon.is_finite() && !(status.is_finite() && status != 0.0);
        Position { time_s, lat, lon, is_good }
    }
}

/// Places among the names.
const LAT: usize = 2;
const LON: usize = 3;
const STATUS: usize = 4;

impl Sensors {
    pub(super) fn new(sensors: usize) -> Self {
        Sensors { values: vec![Vec::new(); sensors], positions: Vec::new() }
    }

    /// Takes the position of a file's first cycle: what comes after it is new where it differs, and where there is none.
    pub(super) fn begin(&mut self, time_s: f64, values: &[f64]) {
        self.positions.push(Position::of(time_s, values));
    }

    pub(super) fn take(&mut self, time_s: f64, values: &[f64]) {
        for (readings, value) in self.values.iter_mut().zip(values).filter(|(_, value)| value.is_finite()) {
            readings.push((time_s, *value));
        }
        if values[LAT].is_finite() && values[LON].is_finite() {
            self.positions.push(Position::of(time_s, values));
        }
    }

    pub(super) fn is_some(&self) -> bool {
        self.values.iter().any(|readings| !readings.is_empty())
    }

    pub(super) fn sort(&mut self) {
        for readings in &mut self.values {
            readings.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
    }

    pub(super) fn series(&self, sensor: usize) -> (Vec<f64>, Vec<f64>) {
        self.values[sensor].iter().copied().unzip()
    }

    /// Positions that the receiver had new.
    pub(super) fn fixes(&self, positions: &mut Positions) -> Vec<GpsFix> {
        let received = self.positions.iter().filter(|p| positions.is_received(p.lat, p.lon, p.is_good));
        received.filter_map(|p| GpsFix::new(p.time_s, degrees(p.lat), degrees(p.lon))).collect()
    }
}
