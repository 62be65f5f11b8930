//! Worlds: logs of gliders, each in a world of its own, with nothing hidden or with the effects of the catalogue.
//!
//! A diagnosis that is calm in one virtual sea may raise alarms in another one. Here everything is drawn from the seed that
//! a stranger's log may differ in: the kind of motion, the water's motion, the column, the glider, how it is flown, what the
//! instruments read and how often. The equations are other ones than those of [`crate::motion`]: a point mass on its path.
//!
//! Masses, volumes and instruments are as the vehicle file says, effects apart. Its coefficients may be off, by one factor
//! for both legs, since a fit of the polar is no diagnosis. No rudder moves here and the roll is constant: drag that goes
//! with either cannot show.
//!
//! Effects outside the catalogue on weight, ballast and pitch have no mean over the log: a compass that errs by the heading is an
//! offset of the pitch on one heading, and an offset has a name. Such a log is flown twice, the second time about the means of the first.

mod colour;
mod flight;

use std::fmt::Write as _;

use crate::catalogue::{self, Drawn, Request};
use crate::effects::Hidden;
use crate::log::Log;
use crate::ocean::{GRAVITY_M_S2, Water};
use crate::outside::Means;
use crate::random::{Part, Stream, between, chance, stream};
use crate::shown::{Row, Shown};
use crate::truth::effects_json;
pub use colour::{Colour, Noise};
pub use flight::{DrawnGlider, Motion, Plan, Polar, Sea, Shear, Voyage};

/// A log with its vehicle file and what was drawn.
#[derive(Debug, Clone)]
pub struct World {
    /// What the glider recorded.
    pub log: Log,
    /// The vehicle as its owner describes it.
    pub vehicle_toml: String,
    /// The hidden effects with their sizes.
    pub effects: Vec<Drawn>,
    /// The true polars of descents and ascents.
    pub polars: [Polar; 2],
    /// The shear of the current, where there is one.
    pub shear: Option<Shear>,
    /// What was drawn, in a line.
    pub drawn: String,
}

impl World {
    /// The content of `truth.json`.
    pub fn truth_json(&self) -> serde_json::Value {
        let [descent, ascent] = self.polars.map(|polar| [polar.a, polar.b, polar.c]);
        serde_json::json!({
            "effects": effects_json(&self.effects),
            "polar_descent": descent,
            "polar_ascent": ascent,
            "drawn": self.drawn,
        })
    }
}

/// How the instruments read.
#[derive(Debug, Clone)]
struct Instruments {
    interval_s: f64,
    /// Spread of the time between rows, relative to its mean.
    irregular: f64,
    gaps_per_hour: f64,
    clock_jitter_s: f64,
    starts_s: f64,
    pressure: Reading,
    pitch: Reading,
    roll: Reading,
    ballast: Reading,
    temperature: Reading,
    salinity: Reading,
    speed: Option<Speed>,
}

/// How one quantity is read.
#[derive(Debug, Clone)]
struct Reading {
    noise: Noise,
    step: f64,
}

/// How speed is read: every so many rows.
#[derive(Debug, Clone)]
struct Speed {
    reading: Reading,
    every: usize,
}

/// Generates the world of a seed with nothing hidden; `speed` is whether the log has a measured speed.
pub fn generate(seed: u64, speed: bool) -> World {
    generate_with(seed, speed, &[])
}

/// Generates the world of a seed with effects hidden in it; nothing else of it changes with them.
pub fn generate_with(seed: u64, speed: bool, effects: &[Request]) -> World {
    generate_with_noise(seed, speed, effects, 1.0)
}

/// Generates the same world with this share of its noise: of the errors and steps of instruments, and of the water's random motion.
pub fn generate_with_noise(seed: u64, speed: bool, effects: &[Request], share: f64) -> World {
    let random = &mut stream(seed, Part::Ocean);
    let bottom_m = match (5.0 * between(random, 0.0, 1.0)) as u32 {
        0 => between(random, 20.0, 60.0),
        1 => between(random, 60.0, 200.0),
        2 | 3 => between(random, 200.0, 500.0),
        _ => between(random, 500.0, 1000.0),
    };
    let mut sea = Sea::draw(random, bottom_m);
    sea.wander_m_s *= share;
    sea.waves_m_s *= share;
    let random = &mut stream(seed, Part::Vehicle);
    let glider = DrawnGlider::draw(random, &sea);
    let motion = match (3.0 * between(random, 0.0, 1.0)) as u32 {
        0 => Motion::QuasiSteady,
        1 => Motion::Surge,
        _ => Motion::SurgeAndHeave,
    };
    let random = &mut stream(seed, Part::Mission);
    let plan = Plan::draw(random, &glider, bottom_m);
    let random = &mut stream(seed, Part::Sensors);
    let mut instruments = Instruments::draw(random, bottom_m, speed, share);
    let described = describe(&sea, &glider, motion, &plan, &instruments);

    let vehicle = glider.as_vehicle(&glider.descent);
    let effects = catalogue::draw(effects, &vehicle, seed, plan.hours());
    let mut hidden = Hidden::new(&effects, &vehicle);
    if effects.iter().any(|drawn| !drawn.effect.is_catalogued()) {
        let mut means = Means::default();
        let voyage = Voyage { sea: &sea, glider: &glider, hidden: &hidden, motion, plan: &plan };
        flight::fly(&voyage, &mut stream(seed, Part::Path), |now| means.see(now));
        hidden.about = means.about();
    }

    let mut log = Log { speed_through_water_m_s: speed.then(Vec::new), ..Log::default() };
    let mut shown = Shown::new(&hidden, flight::STEP_S);
    let mut next_row_s = 0.0;
    let mut rows = 0;
    let random_flight = &mut stream(seed, Part::Path);
    let voyage = Voyage { sea: &sea, glider: &glider, hidden: &hidden, motion, plan: &plan };
    flight::fly(&voyage, random_flight, |now| {
        instruments.advance(random, flight::STEP_S);
        shown.see(now);
        if now.time_s >= next_row_s {
            next_row_s = now.time_s + instruments.until_next_s(random);
            if let Some(row) = shown.row() {
                instruments.write(random, &hidden, now.time_s, &row, rows, &mut log);
            }
            rows += 1;
        }
    });
    let vehicle_toml = glider.file(&mut stream(seed, Part::Effect(0)));
    let polars = [glider.descent, glider.ascent];
    World { log, vehicle_toml, effects, polars, shear: sea.shear, drawn: described }
}

impl Instruments {
    fn draw(random: &mut Stream, bottom_m: f64, speed: bool, share: f64) -> Self {
        let degree = std::f64::consts::PI / 180.0;
        // Shallow dives are over before a slow recorder has seen them.
        let slowest_s: f64 = if bottom_m < 60.0 {
            5.0
        } else if bottom_m < 200.0 {
            15.0
        } else {
            60.0
        };
        let interval_s = (between(random, 0.0, 1.0) * slowest_s.ln()).exp();
        let irregular = if chance(random, 0.4) { between(random, 0.1, 0.9) } else { 0.0 };
        let mut reading = |sd: (f64, f64), steps: &[f64], longest_s: f64| {
            // Of one order of magnitude as likely as of another one.
            let sd = sd.0 * (sd.1 / sd.0).powf(between(random, 0.0, 1.0));
            let colour = Colour::draw(random, longest_s);
            let noise = Noise::new(random, colour, share * sd);
            Reading { noise, step: share * steps[(between(random, 0.0, 1.0) * steps.len() as f64) as usize] }
        };
        let pressure = reading((0.002, 0.03), &[0.0, 0.01, 0.03], 0.0);
        let pitch = reading((0.01 * degree, 0.3 * degree), &[0.0, 0.0, 0.001, 0.1 * degree, 0.3 * degree], 60.0);
        let roll = reading((0.05 * degree, 1.2 * degree), &[0.0, 0.1 * degree], 60.0);
        let ballast = reading((0.01, 0.5), &[0.0, 0.1, 1.0], 0.0);
        let temperature = reading((0.0005, 0.005), &[0.0, 0.001], 0.0);
        let salinity = reading((0.0005, 0.005), &[0.0, 0.001], 0.0);
        let of_speed = reading((0.003, 0.04), &[0.0, 0.001, 0.01], 300.0);
        let every = if chance(random, 0.3) { between(random, 3.0, 20.0) as usize } else { 1 };
        Instruments {
            interval_s,
            irregular,
            gaps_per_hour: if chance(random, 0.5) { between(random, 0.0, 2.0) } else { 0.0 },
            clock_jitter_s: if chance(random, 0.3) { share * 0.1 * interval_s } else { 0.0 },
            starts_s: if chance(random, 0.5) { 1.6e9 } else { 0.0 },
            pressure,
            pitch,
            roll,
            ballast,
            temperature,
            salinity,
            speed: speed.then_some(Speed { reading: of_speed, every }),
        }
    }

    fn advance(&mut self, random: &mut Stream, step_s: f64) {
        let Instruments { pressure, pitch, roll, ballast, temperature, salinity, .. } = self;
        for reading in [pressure, pitch, roll, ballast, temperature, salinity] {
            reading.noise.advance(random, step_s);
        }
        if let Some(speed) = &mut self.speed {
            speed.reading.noise.advance(random, step_s);
        }
    }

    fn until_next_s(&mut self, random: &mut Stream) -> f64 {
        let gap = chance(random, self.gaps_per_hour * self.interval_s / 3600.0);
        let spread = self.irregular * between(random, -1.0, 1.0);
        self.interval_s * (1.0 + spread) + if gap { between(random, 60.0, 400.0) } else { 0.0 }
    }

    fn write(&mut self, random: &mut Stream, hidden: &Hidden, time_s: f64, row: &Row, number: usize, log: &mut Log) {
        let (now, flown) = (&row.attitude, &row.water);
        let mut read = |reading: &mut Reading, value: f64| reading.read(random, value);
        let pressure_dbar = read(&mut self.pressure, row.pressure_dbar);
        let water = Water {
            temperature_c: read(&mut self.temperature, flown.water.temperature_c),
            salinity_psu: read(&mut self.salinity, hidden.salinity_reading(&flown.water, row.cell_c, time_s)),
            ..flown.water
        };
        log.pressure_dbar.push(pressure_dbar);
        log.temperature_c.push(water.temperature_c);
        log.salinity_psu.push(water.salinity_psu);
        log.density_kg_m3.push(hidden.density_reading(&water, pressure_dbar));
        let pitch_rad = read(&mut self.pitch, hidden.pitch_reading(now.pitch_rad, now.roll_rad, now.heading_rad));
        log.pitch_rad.push(hidden.pitch_shown(pitch_rad, &row.felt));
        log.roll_rad.push(read(&mut self.roll, now.roll_rad));
        let ballast_cc = hidden.ballast_reading_cc(now.engine_cc, now.water.temperature_c);
        log.vbd_cc.push(read(&mut self.ballast, ballast_cc));
        if let (Some(speed), Some(column)) = (&mut self.speed, &mut log.speed_through_water_m_s) {
            let value = speed.reading.read(random, flown.speed_m_s * hidden.speed_scale).abs();
            column.push(if number.is_multiple_of(speed.every) { value } else { f64::NAN });
        }
        let jitter_s = self.clock_jitter_s * between(random, -1.0, 1.0);
        let hidden_jitter_s = match hidden.clock_jitter {
            0.0 => 0.0,
            share => share * self.interval_s * between(random, -1.0, 1.0),
        };
        log.time_s.push(((self.starts_s + time_s + jitter_s + hidden_jitter_s) * 100.0).round() / 100.0);
        log.heading_rad.push(now.heading_rad);
        log.fin_rad.push(f64::NAN);
        log.battpos_m.push(f64::NAN);
        log.dive.push(now.dive);
    }
}

impl Reading {
    fn read(&mut self, random: &mut Stream, value: f64) -> f64 {
        let noisy = value + self.noise.value(random);
        if self.step > 0.0 { (noisy / self.step).round() * self.step } else { noisy }
    }
}

fn describe(sea: &Sea, glider: &DrawnGlider, motion: Motion, plan: &Plan, instruments: &Instruments) -> String {
    let mut text = format!("{motion:?}; ");
    let _ = write!(
        text,
        "{:.0} m, {} legs, hunting {:.2} deg in {:.0} s; ",
        plan.bottom_m,
        plan.legs.len(),
        plan.hunting_rad.to_degrees(),
        plan.hunting_s
    );
    let _ = write!(
        text,
        "water {:.1} mm/s in {:.0} s, waves {:.1} mm/s, shear {:.2} m/s in {:.0} m, thermocline {:.0} m; ",
        sea.wander_m_s * 1e3,
        sea.wander_s,
        sea.waves_m_s * 1e3,
        sea.shear.as_ref().map_or(0.0, |shear| 2.0 * shear.half_jump_m_s),
        sea.shear.as_ref().map_or(0.0, |shear| shear.thickness_m),
        sea.thickness_m
    );
    let _ = write!(
        text,
        "legs' polars {}; row {:.1} s +-{:.0} %, pitch {:.3} deg {:?}, pressure {:.4} dbar {:?}",
        if glider.ascent == glider.descent { "alike" } else { "apart" },
        instruments.interval_s,
        instruments.irregular * 100.0,
        instruments.pitch.noise.sd.to_degrees(),
        instruments.pitch.noise.colour,
        instruments.pressure.noise.sd,
        instruments.pressure.noise.colour
    );
    if let Some(speed) = &instruments.speed {
        let Noise { sd, colour, .. } = &speed.reading.noise;
        let _ = write!(text, ", speed {:.1} mm/s {colour:?} every {}", sd * 1e3, speed.every);
    }
    text
}

/// Weight of a mass, N.
fn weight_n(mass_kg: f64) -> f64 {
    mass_kg * GRAVITY_M_S2
}
