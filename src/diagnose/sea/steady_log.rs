//! A log of steady glides, for tests: what a model reads in it is known. Knows the steady glide.

use crate::dynamics::{Parameters, Surroundings};
use crate::glide::{Attitude, at_pitch};
use crate::log::{DBAR_PA, Observation};

/// A sample of steady glide in which nothing is read but a vertical velocity known to 2 mm/s.
pub(super) const SAMPLE: Observation = Observation {
    time_s: 0.0,
    pressure_dbar: f64::NAN,
    pressure_rate_dbar_s: 0.0,
    temperature_C: f64::NAN,
    density_kg_m3: f64::NAN,
    teos10_density_kg_m3: f64::NAN,
    teos10_surface_density_kg_m3: f64::NAN,
    pitch_rad: f64::NAN,
    roll_rad: 0.0,
    rudder_rad: 0.0,
    roll_mass_rad: f64::NAN,
    motor_moving: false,
    since_move_s: f64::NAN,
    heading_rad: 0.0,
    ballast_m3: f64::NAN,
    battery_forward_m: f64::NAN,
    sink_m_s: f64::NAN,
    sink_se_m_s: 0.002,
    sink_window_s: [0.0; 2],
    sink_rate_m_s2: 0.0,
    speed_m_s: f64::NAN,
    water_met_m_s2: f64::NAN,
    leg: 0,
    dive: 0,
    stretch: 0,
    steady: true,
};

/// Twelve legs through a thermocline, the pitch hunting, every reading that of the steady glide.
pub(super) fn log(p: &Parameters<f64>) -> Vec<Observation> {
    let sample = |i: u32| {
        let (leg, within) = (i / 60, f64::from(i % 60));
        let descends = leg % 2 == 0;
        let pressure_dbar = 10.0 + 4.0 * if descends { within } else { 59.0 - within };
        let warm = 0.5 - 0.5 * ((pressure_dbar - 90.0) / 25.0).tanh();
        let water = Surroundings {
            density_kg_m3: 1027.0 - 1.5 * warm + 4.5e-3 * pressure_dbar,
            pressure_Pa: pressure_dbar * DBAR_PA,
            temperature_C: 8.0 + 7.0 * warm,
            time_s: 15.0 * f64::from(i),
        };
        let sign = if descends { -1.0 } else { 1.0 };
        let pitch_rad = sign * (24.0 + f64::from(leg % 3)).to_radians() + 0.02 * (water.time_s / 90.0).sin();
        let ballast_m3 = 2.5e-4 * sign;
        let net_mass_kg = p.net_mass_kg(ballast_m3, &water);
        let glide = at_pitch(p, &water, Attitude { pitch_rad, net_mass_kg }).expect("a glide");
        Observation {
            time_s: water.time_s,
            pressure_dbar,
            temperature_C: water.temperature_C,
            density_kg_m3: water.density_kg_m3,
            teos10_density_kg_m3: water.density_kg_m3,
            pitch_rad,
            ballast_m3,
            sink_m_s: glide.vertical_velocity_m_s,
            speed_m_s: glide.speed_m_s,
            leg,
            dive: leg / 2,
            steady: (4..56).contains(&(i % 60)),
            ..SAMPLE
        }
    };
    (0..720).map(sample).collect()
}
