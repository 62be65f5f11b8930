//! The instruments: what of a flight reaches the log, when, and how well.
//!
//! Noise and resolution follow published glider logs: pressure to a centimetre, attitude to a tenth of a degree, an
//! acoustic speed that scatters by 3 cm/s a sample, rows every four to ten seconds with gaps.

use crate::effects::Hidden;
use crate::flight::{Instant, STEP_S};
use crate::log::Log;
use crate::ocean::{Wander, Water};
use crate::random::{Stream, between, chance, normal};
use crate::shown::{Row, Shown};

/// Depth above which the acoustic speed is missing, m.
const SPEED_FROM_M: f64 = 8.0;

/// How well a drawn set of instruments measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// Mean time between rows, s.
    pub interval_s: f64,
    /// Gaps expected in the log, per hour.
    pub gaps_per_hour: f64,
    /// Pressure noise, dbar.
    pub pressure_dbar: f64,
    /// Pressure resolution, dbar.
    pub pressure_step_dbar: f64,
    /// Pitch noise, rad.
    pub pitch_rad: f64,
    /// Slow wander of the pitch reading over hours, rad.
    pub pitch_wander_rad: f64,
    /// Roll and heading noise, rad.
    pub attitude_rad: f64,
    /// Rudder noise, rad.
    pub rudder_rad: f64,
    /// Ballast noise, cc.
    pub ballast_cc: f64,
    /// Ballast resolution, cc.
    pub ballast_step_cc: f64,
    /// Moving-mass noise, m.
    pub moving_mass_m: f64,
    /// Temperature noise, K.
    pub temperature_k: f64,
    /// Salinity noise.
    pub salinity_psu: f64,
    /// Scatter of the acoustic speed, m/s.
    pub speed_m_s: f64,
    /// Scatter of the acoustic speed that lasts about a minute, m/s.
    pub speed_wander_m_s: f64,
}

impl Quality {
    /// Draws a set of instruments.
    pub fn draw(random: &mut Stream) -> Self {
        let degree = std::f64::consts::PI / 180.0;
        Self {
            interval_s: between(random, 4.5, 7.5),
            gaps_per_hour: 0.3,
            pressure_dbar: 0.01,
            pressure_step_dbar: between(random, 0.002, 0.010),
            pitch_rad: degree * between(random, 0.1, 0.3),
            pitch_wander_rad: degree * between(random, 0.02, 0.06),
            attitude_rad: degree * between(random, 0.2, 0.6),
            rudder_rad: degree * 0.3,
            ballast_cc: 0.4,
            ballast_step_cc: 0.5,
            moving_mass_m: 2e-5,
            temperature_k: 0.002,
            salinity_psu: 0.003,
            speed_m_s: 0.03,
            speed_wander_m_s: 0.008,
        }
    }

    /// Instruments without noise or gaps, of fine resolution.
    pub fn perfect(interval_s: f64) -> Self {
        Self {
            interval_s,
            gaps_per_hour: 0.0,
            pressure_dbar: 0.0,
            pressure_step_dbar: 1e-9,
            pitch_rad: 0.0,
            pitch_wander_rad: 0.0,
            attitude_rad: 0.0,
            rudder_rad: 0.0,
            ballast_cc: 0.0,
            ballast_step_cc: 1e-9,
            moving_mass_m: 0.0,
            temperature_k: 0.0,
            salinity_psu: 0.0,
            speed_m_s: 0.0,
            speed_wander_m_s: 0.0,
        }
    }

    fn is_perfect(&self) -> bool {
        self.gaps_per_hour == 0.0
    }
}

/// Instruments at work on one flight.
pub struct Instruments<'a> {
    hidden: &'a Hidden,
    quality: Quality,
    random: Stream,
    shown: Shown<'a>,
    pitch_wander: Wander,
    speed_wander: Wander,
    next_row_s: f64,
    log: Log,
}

impl<'a> Instruments<'a> {
    /// Instruments under the hidden effects; `speed` adds the acoustic speed.
    pub fn new(hidden: &'a Hidden, quality: Quality, mut random: Stream, speed: bool) -> Self {
        Self {
            hidden,
            quality,
            shown: Shown::new(hidden, STEP_S),
            pitch_wander: Wander::new(&mut random, quality.pitch_wander_rad, 7200.0, STEP_S),
            speed_wander: Wander::new(&mut random, quality.speed_wander_m_s, 60.0, STEP_S),
            next_row_s: 0.0,
            log: Log { speed_through_water_m_s: speed.then(Vec::new), ..Log::default() },
            random,
        }
    }

    /// Sees one instant; writes a row when one is due.
    pub fn see(&mut self, now: &Instant) {
        self.shown.see(now);
        let pitch_error_rad = self.pitch_wander.next(&mut self.random);
        let speed_error_m_s = self.speed_wander.next(&mut self.random);
        if now.time_s >= self.next_row_s {
            self.schedule(now.time_s);
            if let Some(row) = self.shown.row() {
                // The row's own clock is that of the water.
                self.write(now.time_s, &row, pitch_error_rad, speed_error_m_s);
            }
        }
    }

    /// The finished log.
    pub fn into_log(self) -> Log {
        self.log
    }

    fn schedule(&mut self, time_s: f64) {
        let Quality { interval_s, gaps_per_hour, .. } = self.quality;
        self.next_row_s =
            time_s + interval_s * if self.quality.is_perfect() { 1.0 } else { between(&mut self.random, 0.7, 1.3) };
        if chance(&mut self.random, gaps_per_hour * interval_s / 3600.0) {
            self.next_row_s += between(&mut self.random, 45.0, 400.0);
        }
    }

    fn write(&mut self, time_s: f64, row: &Row, pitch_error_rad: f64, speed_error_m_s: f64) {
        let (now, flown) = (&row.attitude, &row.water);
        let quality = self.quality;
        let mut noise = |sd: f64| sd * normal(&mut self.random);
        let pressure = to_step(row.pressure_dbar + noise(quality.pressure_dbar), quality.pressure_step_dbar);
        let read = Water {
            temperature_c: flown.water.temperature_c + noise(quality.temperature_k),
            salinity_psu: self.hidden.salinity_reading(&flown.water, row.cell_c, time_s) + noise(quality.salinity_psu),
            ..flown.water
        };
        let pitch = self.hidden.pitch_reading(now.pitch_rad, now.roll_rad, now.heading_rad)
            + pitch_error_rad
            + noise(quality.pitch_rad);
        let pitch = self.hidden.pitch_shown(pitch, &row.felt);
        let late_s = if self.hidden.clock_jitter > 0.0 {
            self.hidden.clock_jitter * quality.interval_s * between(&mut self.random, -1.0, 1.0)
        } else {
            0.0
        };
        let mut noise = |sd: f64| sd * normal(&mut self.random);
        let ballast =
            self.hidden.ballast_reading_cc(now.engine_cc, now.water.temperature_c) + noise(quality.ballast_cc);
        let log = &mut self.log;
        log.time_s.push(time_s + late_s);
        log.pressure_dbar.push(pressure);
        log.pitch_rad.push(pitch);
        log.roll_rad.push(now.roll_rad + self.hidden.roll_offset_rad + noise(quality.attitude_rad));
        log.heading_rad.push((now.heading_rad + noise(quality.attitude_rad)).rem_euclid(std::f64::consts::TAU));
        log.fin_rad.push(now.rudder_reading_rad + noise(quality.rudder_rad));
        if now.roll_mass_rad.is_finite() {
            let reading = now.roll_mass_rad + noise(quality.rudder_rad);
            log.roll_mass_rad.get_or_insert_default().push(reading);
        }
        log.vbd_cc.push(to_step(ballast, quality.ballast_step_cc));
        log.battpos_m.push(now.moving_mass_m + noise(quality.moving_mass_m));
        log.temperature_c.push(read.temperature_c);
        log.salinity_psu.push(read.salinity_psu);
        log.density_kg_m3.push(self.hidden.density_reading(&read, pressure));
        log.dive.push(now.dive);
        let speed = flown.speed_m_s * self.hidden.speed_scale + speed_error_m_s + noise(quality.speed_m_s);
        self.lose(flown, speed);
    }

    /// A few values go missing, as they do: the water's now and then, the acoustic speed near the surface and by chance.
    fn lose(&mut self, now: &Instant, speed_m_s: f64) {
        let dropouts = !self.quality.is_perfect();
        let speed_lost = dropouts && (now.depth_m < SPEED_FROM_M || chance(&mut self.random, 0.05));
        let water_lost = dropouts && chance(&mut self.random, 0.01);
        let pitch_lost = dropouts && chance(&mut self.random, 0.002);
        if let Some(speeds) = &mut self.log.speed_through_water_m_s {
            speeds.push(if speed_lost { f64::NAN } else { speed_m_s.abs() });
        }
        if water_lost {
            for column in [&mut self.log.temperature_c, &mut self.log.salinity_psu, &mut self.log.density_kg_m3] {
                column.pop();
                column.push(f64::NAN);
            }
        }
        if pitch_lost {
            self.log.pitch_rad.pop();
            self.log.pitch_rad.push(f64::NAN);
        }
    }
}

fn to_step(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}
