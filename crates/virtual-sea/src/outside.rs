//! Effects that gliders and instruments have and that the diagnosis has no name for. What each is stands in
//! [`crate::catalogue::TABLE`]; they test that nothing is named for them.

use crate::hidden::{ATMOSPHERE_PA, About, Flow, Hidden, Instant, TIDE_S, smooth_step};
use crate::ocean::Water;
use std::f64::consts::{PI, TAU};

/// Pressure over which soft foam gives way, Pa.
const FOAM_PA: f64 = 0.5e6;
/// Time in which mud washes off, s.
const WASHED_S: f64 = 600.0;
/// Depth scale of the internal tide: half of its vertical wave length, m.
const MODE_M: f64 = 400.0;
/// Depth above which a glider is at the surface, m.
const SURFACED_M: f64 = 3.0;
/// How late the pressure sensor and the electronics follow the water's temperature, s.
const SENSOR_LAG_S: f64 = 60.0;
const INSIDE_LAG_S: f64 = 1800.0;

/// What the glider keeps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kept {
    /// Direction of the engine's last move: +1 outwards, -1 inwards.
    pub moved: f64,
    /// Pressure at its last move outwards, 0 after one inwards, Pa.
    pub pumped_at_pa: f64,
    /// Mud on the hull, kg.
    pub mud_kg: f64,
}

impl Kept {
    /// At the surface.
    pub fn afloat() -> Self {
        Self { moved: 1.0, pumped_at_pa: 0.0, mud_kg: 0.0 }
    }

    /// A step on; `pumped_cc` is by how much the engine moved in it.
    pub fn step(&mut self, hidden: &Hidden, pressure_pa: f64, pumped_cc: f64, step_s: f64) {
        self.mud_kg *= (-step_s / WASHED_S).exp();
        if pumped_cc > 0.0 {
            // The first stroke outwards after a descent is the one at the bottom.
            if self.moved < 0.0 {
                self.mud_kg = hidden.mud_kg;
                self.pumped_at_pa = pressure_pa;
            }
            self.moved = 1.0;
        } else if pumped_cc < 0.0 {
            (self.moved, self.pumped_at_pa) = (-1.0, 0.0);
        }
    }
}

/// What the instruments feel, late.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Felt {
    sensor_c: Option<f64>,
    inside_c: Option<f64>,
    cell: Option<(f64, f64)>,
    speed_m_s: Option<f64>,
}

impl Felt {
    /// A step on; returns the instant with the water that is in the cell.
    pub fn step(&mut self, hidden: &Hidden, now: &Instant, step_s: f64) -> Instant {
        let (c, psu) = (now.water.temperature_c, now.water.salinity_psu);
        let follow = |felt: Option<f64>, lag_s: f64| {
            let before = felt.unwrap_or(c);
            Some(before + (c - before) * share(step_s, lag_s))
        };
        self.sensor_c = follow(self.sensor_c, SENSOR_LAG_S);
        self.inside_c = follow(self.inside_c, INSIDE_LAG_S);
        let before_m_s = self.speed_m_s.unwrap_or(now.speed_m_s);
        let speed_m_s = before_m_s + (now.speed_m_s - before_m_s) * share(step_s, hidden.speed_lag_s);
        self.speed_m_s = Some(speed_m_s);
        let now = &Instant { speed_m_s, ..*now };
        if hidden.flushing_s == 0.0 {
            return *now;
        }
        let (cell_c, cell_psu) = self.cell.unwrap_or((c, psu));
        let flushed = share(step_s, hidden.flushing_s);
        let cell = (cell_c + (c - cell_c) * flushed, cell_psu + (psu - cell_psu) * flushed);
        self.cell = Some(cell);
        Instant { water: Water { temperature_c: cell.0, salinity_psu: cell.1, ..now.water }, ..*now }
    }
}

/// Means over the part of a flight that is under water: what an effect outside the catalogue does on average an offset of the catalogue
/// does, and would rightly be named.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Means {
    steps: f64,
    temperature_c: f64,
    sine_of_heading: f64,
    net_mass_kg: f64,
}

impl Means {
    /// Sees the next instant.
    pub fn see(&mut self, now: &Instant) {
        if now.depth_m <= SURFACED_M {
            return;
        }
        self.steps += 1.0;
        let share = 1.0 / self.steps;
        self.temperature_c += share * (now.water.temperature_c - self.temperature_c);
        self.sine_of_heading += share * (now.heading_rad.sin() - self.sine_of_heading);
        self.net_mass_kg += share * (now.outside_kg - self.net_mass_kg);
    }

    /// What effects count from that have no mean over this flight.
    pub fn about(&self) -> About {
        let Means { temperature_c, sine_of_heading, net_mass_kg, .. } = *self;
        About { temperature_c, sine_of_heading, net_mass_kg }
    }
}

impl About {
    /// By how much a part is warmer than where instruments read right, K; 0 before it has felt the water.
    fn warmer_k(&self, part_c: Option<f64>) -> f64 {
        part_c.map_or(0.0, |part_c| part_c - self.temperature_c)
    }
}

impl Hidden {
    /// Net mass that these effects add in water of this density, kg.
    pub(crate) fn outside_kg(&self, kept: &Kept, pressure_pa: f64, density_kg_m3: f64) -> f64 {
        kept.mud_kg - 1e-6 * density_kg_m3 * self.outside_cc(kept, pressure_pa)
    }

    /// Volume beyond that of hull, engine and carried water, cc.
    pub(crate) fn outside_cc(&self, kept: &Kept, pressure_pa: f64) -> f64 {
        let air =
            if kept.moved < 0.0 { self.burped_air_cc * ATMOSPHERE_PA / (ATMOSPHERE_PA + pressure_pa) } else { 0.0 };
        air - 0.5 * self.engine_backlash_cc * kept.moved
            - self.missing_cc_per_100dbar * kept.pumped_at_pa * 1e-6
            - self.foam_cc * (1.0 - (-pressure_pa / FOAM_PA).exp())
    }

    /// Share of the lift that is left.
    pub(crate) fn lift_left(&self, flow: &Flow) -> f64 {
        let lost = if flow.time_s >= self.lift_lost_from_s { self.lift_lost } else { 0.0 };
        // Wings that turn with the flow lose all of it at most.
        (1.0 - self.lift_loss_per_pa * flow.dynamic_pressure_pa).max(0.1) * (1.0 - lost)
    }

    /// Factor on the drag.
    pub(crate) fn drag_beside(&self, flow: &Flow) -> f64 {
        let line = 1.0 + self.line_drag_per_100m * flow.depth_m.max(0.0) / 100.0;
        let inside = smooth_step((flow.depth_m - self.swarm_top_m) / 5.0)
            * smooth_step((self.swarm_bottom_m - flow.depth_m) / 5.0);
        line * (1.0 + self.swarm_drag * inside)
    }

    /// Vertical velocity and displacement of the water by the internal tide, + = down.
    pub(crate) fn internal_tide(&self, depth_m: f64, time_s: f64) -> (f64, f64) {
        let size = self.internal_tide_m_s * (PI * depth_m.max(0.0) / MODE_M).sin();
        let phase = TAU * time_s / TIDE_S + self.internal_tide_phase_rad;
        (size * phase.cos(), size * TIDE_S / TAU * phase.sin())
    }

    /// Zero of the pressure sensor, dbar.
    pub(crate) fn pressure_zero_dbar(&self, felt: &Felt) -> f64 {
        self.zero_dbar_per_k * self.about.warmer_k(felt.sensor_c)
    }

    /// Pitch as it is shown when `pitch_rad` is felt, rad.
    pub(crate) fn pitch_shown(&self, pitch_rad: f64, felt: &Felt) -> f64 {
        let warm = pitch_rad + self.pitch_rad_per_k * self.about.warmer_k(felt.inside_c);
        if self.pitch_step_rad > 0.0 { (warm / self.pitch_step_rad).round() * self.pitch_step_rad } else { warm }
    }
}

/// Share of the way towards its goal that a first-order lag goes in a step.
fn share(step_s: f64, lag_s: f64) -> f64 {
    if lag_s > 0.0 { 1.0 - (-step_s / lag_s).exp() } else { 1.0 }
}
