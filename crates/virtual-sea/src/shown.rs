//! What instruments without noise show under the hidden effects: errors of scale, lags, hysteresis, and columns that are
//! late. It knows neither noise nor sampling; both virtual seas put theirs on top.

use std::collections::VecDeque;

use crate::effects::Hidden;
use crate::hidden::Instant;
use crate::outside::Felt;

/// What the columns of a row are made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// The instant that attitude and motors are written from.
    pub attitude: Instant,
    /// The instant that water, pressure and speed are written from.
    pub water: Instant,
    /// Pressure shown, dbar.
    pub pressure_dbar: f64,
    /// Temperature in the conductivity cell, degrees Celsius.
    pub cell_c: f64,
    /// What else the instruments feel late.
    pub felt: Felt,
}

/// Instruments without noise on one flight.
#[derive(Debug)]
pub struct Shown<'a> {
    hidden: &'a Hidden,
    step_s: f64,
    pressure_dbar: Option<f64>,
    largest_dbar: f64,
    /// The latest instants with the pressure that the instrument shows, as far back as the latest column is late.
    past: VecDeque<(Instant, f64)>,
    felt: Felt,
}

impl<'a> Shown<'a> {
    /// Instruments under the hidden effects that see an instant every `step_s`.
    pub fn new(hidden: &'a Hidden, step_s: f64) -> Self {
        let felt = Felt::default();
        Self { hidden, step_s, pressure_dbar: None, largest_dbar: 0.0, past: VecDeque::new(), felt }
    }

    /// Sees the next instant.
    pub fn see(&mut self, now: &Instant) {
        let true_dbar = now.pressure_pa * 1e-4;
        // A dive begins anew near the surface; what is less than the largest is on the way up.
        self.largest_dbar = if now.depth_m < 2.0 { 0.0 } else { self.largest_dbar.max(true_dbar) };
        let hysteresis_dbar = self.hidden.hysteresis_dbar(true_dbar, self.largest_dbar);
        let now = self.felt.step(self.hidden, now, self.step_s);
        let zero_dbar = self.hidden.pressure_zero_dbar(&self.felt);
        let goal_dbar = self.hidden.pressure_reading_dbar(true_dbar) + hysteresis_dbar + zero_dbar;
        let late_dbar = self.pressure_dbar.unwrap_or(goal_dbar);
        let pressure_dbar = late_dbar + (goal_dbar - late_dbar) * self.hidden.pressure_catch_up(self.step_s);
        self.pressure_dbar = Some(pressure_dbar);
        self.past.push_front((now, pressure_dbar));
        self.past.truncate(self.delays().into_iter().max().unwrap_or(0) + 1);
    }

    /// The row of the instant seen last; `None` before the first.
    pub fn row(&self) -> Option<Row> {
        let oldest = self.past.len().checked_sub(1)?;
        let [attitude, water, cell] = self.delays().map(|delay| self.past[delay.min(oldest)]);
        let cell_c = cell.0.water.temperature_c;
        Some(Row { attitude: attitude.0, water: water.0, pressure_dbar: water.1, cell_c, felt: self.felt })
    }

    /// How many instants ago attitude, water and cell are written from.
    fn delays(&self) -> [usize; 3] {
        self.hidden.delays_s().map(|delay_s| (delay_s / self.step_s).round() as usize)
    }
}
