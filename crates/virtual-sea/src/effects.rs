//! Where the hidden effects act: on the glider and the water, or on what the instruments say. What each is stands in
//! [`crate::catalogue::TABLE`].

use crate::hidden::{ATMOSPHERE_PA, TIDE_S, smooth_step};
pub use crate::hidden::{Flow, Hidden};
use crate::ocean::Water;
use crate::vehicle::{REFERENCE_DENSITY_KG_M3, Vehicle};
use std::f64::consts::TAU;

/// Speed at which a drag exponent leaves b as it is, m/s.
const DRAG_REFERENCE_SPEED_M_S: f64 = 0.3;

/// What the hull keeps of where it has been.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Memory {
    /// The pressure that the late part of the hull has followed so far, Pa.
    pub creep_pa: f64,
    /// Temperature of what is slow in the hull, degrees Celsius.
    pub inside_c: f64,
    /// Temperature of the water carried within, degrees Celsius.
    pub carried_c: f64,
    /// Its salinity.
    pub carried_psu: f64,
    /// Ballast volume that has leaked back, cc.
    pub leaked_cc: f64,
    /// What the effects outside the catalogue keep.
    pub outside: crate::outside::Kept,
}

impl Memory {
    /// At the surface, in equilibrium with the water there.
    pub fn afloat(water: &Water) -> Self {
        Self {
            creep_pa: 0.0,
            inside_c: water.temperature_c,
            carried_c: water.temperature_c,
            carried_psu: water.salinity_psu,
            leaked_cc: 0.0,
            outside: crate::outside::Kept::afloat(),
        }
    }

    /// A step on: `pumped_cc` is by how much the engine moved in it.
    pub fn step(&mut self, hidden: &Hidden, water: &Water, pressure_pa: f64, pumped_cc: f64, step_s: f64) {
        self.outside.step(hidden, pressure_pa, pumped_cc, step_s);
        let share = |time_s: f64| if time_s > 0.0 { 1.0 - (-step_s / time_s).exp() } else { 1.0 };
        self.creep_pa += (pressure_pa - self.creep_pa) * share(hidden.creep_time_s);
        self.inside_c += (water.temperature_c - self.inside_c) * share(hidden.expansion_time_s);
        self.carried_c += (water.temperature_c - self.carried_c) * share(hidden.exchange_time_s);
        self.carried_psu += (water.salinity_psu - self.carried_psu) * share(hidden.exchange_time_s);
        self.leaked_cc =
            if pumped_cc != 0.0 { 0.0 } else { self.leaked_cc + hidden.leakback_cc_per_hour * step_s / 3600.0 };
    }
}

/// On the glider.
impl Hidden {
    /// True mass, kg, of a vehicle whose file says `mass_kg`, the water that it carries included.
    pub fn mass_kg(&self, mass_kg: f64, time_s: f64, memory: &Memory, pressure_pa: f64) -> f64 {
        let hanging_kg = if time_s < self.lost_or_caught_at_s { 0.0 } else { self.lost_or_caught_kg };
        let taken_in_kg = self.leak_kg_per_hour * time_s / 3600.0;
        let dry_kg = mass_kg + self.ballast_offset_kg + taken_in_kg + hanging_kg + memory.outside.mud_kg
            - self.about.net_mass_kg;
        if self.carried_water_m3 == 0.0 {
            return dry_kg;
        }
        let density_kg_m3 = crate::ocean::density_eos80(memory.carried_psu, memory.carried_c, pressure_pa * 1e-4);
        dry_kg + self.carried_water_m3 * density_kg_m3
    }

    /// True displaced volume, m3, with the engine reading `engine_cc`, the water that it carries included.
    pub fn volume_m3(
        &self,
        vehicle: &Vehicle,
        pressure_pa: f64,
        temperature_c: f64,
        engine_cc: f64,
        memory: &Memory,
    ) -> f64 {
        let hull = Vehicle {
            compressibility_per_pa: self.compressibility_per_pa,
            thermal_expansion_per_k: self.thermal_expansion_per_k,
            ..*vehicle
        };
        let air_cc = self.trapped_air_cc * ATMOSPHERE_PA / (ATMOSPHERE_PA + pressure_pa);
        let crept_m3 = self.hull_creep_per_pa * memory.creep_pa * vehicle.displaced_volume_m3;
        let late_m3 = self.late_expansion_per_k * (memory.inside_c - temperature_c) * vehicle.displaced_volume_m3;
        hull.hull_volume_m3(pressure_pa, temperature_c) - crept_m3
            + late_m3
            + self.carried_water_m3
            + 1e-6 * (self.ballast_scale * engine_cc - memory.leaked_cc + air_cc)
            + 1e-6 * self.outside_cc(&memory.outside, pressure_pa)
    }

    /// Lift coefficient of an attached flow.
    pub fn lift_coefficient(&self, vehicle: &Vehicle, flow: &Flow) -> f64 {
        let angle_rad = flow.angle_rad;
        let stalled = (angle_rad.abs() - self.stall_angle_rad).max(0.0);
        let leg = if flow.rising { self.climb_dive_lift_ratio } else { 1.0 };
        leg * self.lift_left(flow)
            * (vehicle.a_per_rad * (angle_rad - 0.7 * stalled.copysign(angle_rad))
                + self.nonlinear_lift_per_rad2 * angle_rad * angle_rad.abs())
    }

    /// Drag coefficient of an attached flow.
    pub fn drag_coefficient(&self, vehicle: &Vehicle, flow: &Flow) -> f64 {
        let reference_pa = 0.5 * REFERENCE_DENSITY_KG_M3 * DRAG_REFERENCE_SPEED_M_S * DRAG_REFERENCE_SPEED_M_S;
        let reynolds = match self.drag_exponent {
            0.0 => 1.0,
            s => (flow.dynamic_pressure_pa.max(0.5) / reference_pa).powf(s),
        };
        let growth = 1.0 + self.drag_growth_per_day * flow.time_s / 86_400.0;
        let step = if flow.time_s >= self.step_time_s { 1.0 + self.drag_step } else { 1.0 };
        let leg = if flow.rising { self.climb_dive_drag_ratio } else { 1.0 };
        let roll = 1.0 + self.roll_drag_per_rad2 * flow.roll_rad * flow.roll_rad;
        let rudder = 1.0 + self.rudder_drag_per_rad2 * flow.rudder_rad * flow.rudder_rad;
        let patch = 1.0 + self.patch_drag * (flow.time_s / self.regrowth_s).fract();
        let plain = vehicle.b * reynolds + vehicle.c_per_rad2 * flow.angle_rad * flow.angle_rad;
        plain * growth * step * leg * roll * rudder * patch * self.drag_beside(flow)
            + crate::lateral::pod_drag_m2(self.pod_m3) / vehicle.frontal_area_m2
            + self.friction_n / (flow.dynamic_pressure_pa.max(0.5) * vehicle.frontal_area_m2)
    }

    /// True position of the moving mass where it reads `reading_m` and last moved in direction `moved` (+1, -1).
    pub fn moving_mass_m(&self, reading_m: f64, moved: f64) -> f64 {
        reading_m - 0.5 * self.backlash_m * moved
    }

    /// Vertical velocity of the water beside its waves, m/s, + = down.
    pub fn sinking_water_m_s(&self, depth_m: f64, time_s: f64) -> f64 {
        let tide = self.tidal_velocity_m_s * (TAU * time_s / TIDE_S + self.tidal_phase_rad).cos();
        let inside =
            smooth_step((depth_m - self.layer_top_m) / 5.0) * smooth_step((self.layer_bottom_m - depth_m) / 5.0);
        (self.vertical_current_m_s + tide) * (depth_m / 5.0).tanh().max(0.0)
            + self.layer_velocity_m_s * inside
            + self.internal_tide(depth_m, time_s).0
    }
}

/// On what the instruments say.
impl Hidden {
    /// Pitch that a perfect instrument would read, rad.
    pub fn pitch_reading(&self, pitch_rad: f64, roll_rad: f64, heading_rad: f64) -> f64 {
        (pitch_rad - self.pitch_offset_rad) / self.pitch_scale
            + self.compass_pitch_rad * (heading_rad.sin() - self.about.sine_of_heading)
            + self.pitch_per_roll * roll_rad
    }

    /// Ballast volume that the engine reads when its own count is `engine_cc`.
    pub fn ballast_reading_cc(&self, engine_cc: f64, temperature_c: f64) -> f64 {
        engine_cc * (1.0 + self.reading_per_k * (temperature_c - self.about.temperature_c))
    }

    /// Pressure that a prompt instrument would read, dbar.
    pub fn pressure_reading_dbar(&self, pressure_dbar: f64) -> f64 {
        pressure_dbar / self.pressure_scale
    }

    /// What hysteresis adds to a pressure on the way up from the largest of the dive, dbar.
    pub fn hysteresis_dbar(&self, pressure_dbar: f64, largest_dbar: f64) -> f64 {
        if largest_dbar <= 0.0 {
            return 0.0;
        }
        self.pressure_hysteresis * 4.0 * pressure_dbar * (1.0 - pressure_dbar / largest_dbar)
    }

    /// Salinity that the instrument reads in water of which the cell feels the temperature `cell_c`.
    ///
    /// The conductivity ratio of the cell, by the ratio of standard sea water to its own at 15 degrees C (PSS-78), and the
    /// power of it with which salinity grows there, 39.16/35.
    pub fn salinity_reading(&self, water: &Water, cell_c: f64, time_s: f64) -> f64 {
        let ratio = |c: f64| 0.676_609_7 + c * (2.005_64e-2 + c * (1.104_259e-4 + c * (-6.969_8e-7 + c * 1.0031e-9)));
        let computed = water.salinity_psu * (ratio(cell_c) / ratio(water.temperature_c)).powf(39.16 / 35.0);
        computed - self.salinity_drift_per_day * time_s / 86_400.0
    }

    /// How late the attitude (first) and the water and pressure (second) are written, and the cell's temperature (third)
    /// behind the water's, s; one of the first two is 0.
    pub fn delays_s(&self) -> [f64; 3] {
        let (late, early) = (self.clock_offset_s.max(0.0), (-self.clock_offset_s).max(0.0));
        // A cell that is ahead of its thermometer: the thermometer, and with it the row, waits for it.
        [
            late + (-self.thermal_lag_s).max(0.0),
            early + (-self.thermal_lag_s).max(0.0),
            early + self.thermal_lag_s.max(0.0),
        ]
    }

    /// Share of the way that the pressure reading goes towards its goal in a step.
    pub fn pressure_catch_up(&self, step_s: f64) -> f64 {
        if self.pressure_lag_s > 0.0 { 1.0 - (-step_s / self.pressure_lag_s).exp() } else { 1.0 }
    }

    /// Density column, kg/m3, from water and pressure as the instruments read them.
    pub fn density_reading(&self, read: &Water, pressure_read_dbar: f64) -> f64 {
        let pressure_dbar = if self.density_at_zero_pressure { 0.0 } else { pressure_read_dbar };
        crate::ocean::density_eos80(read.salinity_psu, read.temperature_c, pressure_dbar) - self.density_bias_kg_m3
    }
}
