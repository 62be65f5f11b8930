//! What a pilot counts on the way for the account of energy: with it the energy that the equations have added up is
//! parted into what took it.

use crate::dynamics::Parameters;
use crate::dynamics::energy::{Energy, Usage, moves_over};

/// The counts so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spent(Usage<f64>);

impl Spent {
    pub fn new() -> Self {
        Spent(Usage::none())
    }

    /// Some time went by, between these depths.
    pub fn carried(&mut self, time_s: f64, depths_m: [f64; 2]) {
        let [from, to] = depths_m;
        let (low, high) = (from.min(to), from.max(to));
        let under_water = if low > 0.0 { 1.0 } else { (high / (high - low)).clamp(0.0, 1.0) };
        self.0.time_s += time_s;
        self.0.under_water_s += if high > 0.0 { under_water * time_s } else { 0.0 };
    }

    /// The moving mass was sent over this way.
    pub fn moved(&mut self, p: &Parameters<f64>, from_m: f64, to_m: f64) {
        let held = |position_m: f64| position_m.clamp(p.moving_mass_min_m, p.moving_mass_max_m);
        self.0.pitch_moves += moves_over((held(to_m) - held(from_m)).abs(), p.moving_mass_rate_m_s);
    }

    /// The glider came to the surface. Returns the energy that takes \[J\].
    pub fn surfaced(&mut self, p: &Parameters<f64>) -> f64 {
        self.0.surfacings += 1.0;
        p.surfacing_J
    }

    /// The energy drawn, term by term: the pump has what the others have not. `steering_J` is that of rudder and roll mass by
    /// their moves, where these are counted.
    pub fn energy(&self, p: &Parameters<f64>, drawn_J: f64, steering_J: Option<f64>) -> Energy<f64> {
        let under_water_s = if steering_J.is_some() { 0.0 } else { self.0.under_water_s };
        let mut energy = Usage { under_water_s, ..self.0 }.energy(p);
        energy.steering_J += steering_J.unwrap_or(0.0);
        // A figure that nobody stated is nothing, not the rounding of the others.
        if p.pump_J_per_m3 > 0.0 || p.pump_J_per_Pa_m3 > 0.0 {
            energy.pump_J = drawn_J - energy.total_J();
        }
        energy
    }
}
