//! An oracle of what the logs can tell: given the true vehicle, the ocean's noise and the exact form of every effect, it
//! fits each catalogued effect beside a, b, c to steady flight and names the best. What it cannot tell apart, no
//! diagnosis can; what it can shows that the sizes drawn are large enough.
//!
//! `cargo run --release --example oracle -p glidepolar-virtual-sea -- [SEEDS] [yes|no] [EFFECT...]` prints how often each
//! hidden effect is named, what is named instead, the least chi-square that the true effect takes away, and its least
//! lead over the best other name. `no` leaves the speed out and pins a. An effect is named beyond a chi-square of 12.
//! With an uncatalogued effect nothing right can be named; the table shows what it looks like.

use glidepolar_virtual_sea::catalogue::{TABLE, parse_requests};
use glidepolar_virtual_sea::ocean::GRAVITY_M_S2;
use glidepolar_virtual_sea::vehicle::Vehicle;
use glidepolar_virtual_sea::{Options, Sea, generate};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

const BLOCK_S: f64 = 60.0;

/// What the log says over a minute of steady flight.
struct Block {
    time_s: f64,
    rows: f64,
    sinking_m_s: f64,
    speed_m_s: f64,
    pitch: f64,
    engine_cc: f64,
    density: f64,
    pressure_pa: f64,
    temperature_c: f64,
    roll2: f64,
    rudder2: f64,
}

/// Parameters of the model: a, b, c and one effect.
#[derive(Clone, Copy)]
struct Model<'a> {
    vehicle: &'a Vehicle,
    polar: [f64; 3],
    effect: &'a str,
    size: f64,
    step_s: f64,
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let seeds: u64 = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(5);
    let speed = arguments.next().as_deref() != Some("no");
    let asked: Vec<String> = arguments.collect();
    let hidden: Vec<&str> = if asked.is_empty() {
        let uncatalogued = TABLE.iter().filter(|effect| !effect.is_catalogued()).map(|effect| effect.name);
        std::iter::once("none").chain(candidates()).chain(uncatalogued).collect()
    } else {
        asked.iter().map(String::as_str).collect()
    };
    println!("{:<34} {:>5}  {:>9} {:>9}  named instead", "hidden", "right", "least", "margin");
    for name in hidden {
        let mut named: BTreeMap<&str, usize> = BTreeMap::new();
        let (mut least, mut margin) = (f64::INFINITY, f64::INFINITY);
        for seed in 0..seeds {
            let effects = parse_requests(name).expect("names of effects");
            let sea = generate(&Options { effects, speed, ..Options::seeded(1000 + seed) });
            let ranking = rank(&sea, speed);
            *named.entry(ranking[0].0).or_default() += 1;
            let of_true = ranking.iter().find(|entry| entry.0 == name).map_or(0.0, |entry| entry.1);
            let other = ranking.iter().find(|entry| entry.0 != name).map_or(0.0, |entry| entry.1);
            least = least.min(of_true);
            margin = margin.min(of_true - other);
        }
        let right = named.remove(name).unwrap_or(0);
        let others: Vec<String> = named.iter().map(|(name, count)| format!("{name} {count}")).collect();
        println!("{name:<34} {right:>2}/{seeds:<2}  {least:>9.1} {margin:>9.1}  {}", others.join(", "));
    }
}

/// The catalogued effects that steady flight shows.
fn candidates() -> impl Iterator<Item = &'static str> {
    let not_identifiable = ["pressure_lag", "inertia", "density_at_zero_pressure", "density_bias"];
    TABLE
        .iter()
        .filter(|effect| effect.is_catalogued())
        .map(|effect| effect.name)
        .filter(move |name| !not_identifiable.contains(name))
}

/// Every candidate with the chi-square it takes away beyond a, b, c alone, best first; `none` enters at 12.
fn rank(sea: &Sea, speed: bool) -> Vec<(&'static str, f64)> {
    let blocks = blocks(sea);
    let whiten = whitening(sea, &blocks, speed);
    let vehicle = &sea.truth.vehicle;
    let fit = |effect: &'static str, step_s: f64| {
        let polar = [vehicle.a_per_rad, vehicle.b, vehicle.c_per_rad2];
        let size = neutral(effect, vehicle);
        fit(Model { vehicle, polar, effect, size, step_s }, &blocks, &whiten, speed)
    };
    let plain = fit("none", 0.0);
    let mut ranking: Vec<(&'static str, f64)> = candidates()
        .map(|effect| {
            let steps = if effect.ends_with("_step") { 4..17 } else { 0..1 };
            let best = steps.map(|hour| fit(effect, f64::from(hour) * 2160.0)).fold(f64::INFINITY, f64::min);
            (effect, plain - best)
        })
        .collect();
    ranking.push(("none", 12.0));
    ranking.sort_by(|x, y| y.1.total_cmp(&x.1));
    ranking
}

fn neutral(effect: &str, vehicle: &Vehicle) -> f64 {
    match effect {
        "hull_compressibility" => vehicle.compressibility_per_pa,
        "thermal_expansion" => vehicle.thermal_expansion_per_k,
        "ballast_scale" | "pitch_scale" | "pressure_scale" | "climb_dive_asymmetry" => 1.0,
        _ => 0.0,
    }
}

/// Minutes away from inflections and surface.
fn blocks(sea: &Sea) -> Vec<Block> {
    let log = &sea.log;
    let mut blocks = Vec::new();
    let mut start = 0;
    while start < log.len() {
        let end = (start..log.len()).find(|&row| log.time_s[row] > log.time_s[start] + BLOCK_S).unwrap_or(log.len());
        let before = (0..start).rev().take_while(|&row| log.time_s[row] > log.time_s[start] - 120.0);
        let still = before.chain(start..end).all(|row| (log.vbd_cc[row] - log.vbd_cc[start]).abs() < 4.0);
        let deep = (start..end).all(|row| log.pressure_dbar[row] > 12.0);
        if still && deep && end - start >= 6 {
            blocks.extend(block(sea, start..end));
        }
        start = end;
    }
    blocks
}

fn block(sea: &Sea, rows: std::ops::Range<usize>) -> Option<Block> {
    let log = &sea.log;
    let mean = |values: &dyn Fn(usize) -> f64| {
        let (sum, count) =
            rows.clone().map(values).filter(|v| v.is_finite()).fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
        sum / count
    };
    let time_s = mean(&|row| log.time_s[row]);
    let spread = mean(&|row| (log.time_s[row] - time_s).powi(2));
    let density = mean(&|row| log.density_kg_m3[row]);
    let slope = mean(&|row| (log.time_s[row] - time_s) * log.pressure_dbar[row]) / spread;
    let speed = |row: usize| log.speed_through_water_m_s.as_ref().map_or(0.0, |speeds| speeds[row]);
    let block = Block {
        time_s,
        rows: rows.len() as f64,
        sinking_m_s: slope * 1e4 / (density * GRAVITY_M_S2),
        speed_m_s: mean(&speed),
        pitch: mean(&|row| log.pitch_rad[row]),
        engine_cc: mean(&|row| log.vbd_cc[row]),
        density,
        pressure_pa: 1e4 * mean(&|row| log.pressure_dbar[row]),
        temperature_c: mean(&|row| log.temperature_c[row]),
        roll2: mean(&|row| log.roll_rad[row].powi(2)),
        rudder2: mean(&|row| log.fin_rad[row].powi(2)),
    };
    (block.speed_m_s.is_finite() && block.sinking_m_s.abs() > 0.03).then_some(block)
}

impl Model<'_> {
    /// Vertical velocity as the pressure sensor shows it, and speed through the water, of the steady glide.
    fn predict(&self, block: &Block) -> (f64, f64) {
        let v = self.vehicle;
        let size_of = |name: &str, neutral: f64| if self.effect == name { self.size } else { neutral };
        let pressure = block.pressure_pa * size_of("pressure_scale", 1.0);
        let strain = size_of("thermal_expansion", v.thermal_expansion_per_k) * (block.temperature_c - 15.0)
            - size_of("hull_compressibility", v.compressibility_per_pa) * pressure;
        let air = size_of("trapped_air", 0.0) * 101_325.0 / (101_325.0 + pressure);
        let volume =
            v.displaced_volume_m3 * (1.0 + strain) + 1e-6 * (size_of("ballast_scale", 1.0) * block.engine_cc + air);
        let hanging = if block.time_s >= self.step_s { size_of("net_mass_step", 0.0) } else { 0.0 };
        let mass = v.mass_kg + size_of("ballast_offset", 0.0) + size_of("leak", 0.0) * block.time_s / 3600.0 + hanging;
        // The log's density was evaluated at the pressure read: 4.5e-3 kg/m3 per dbar are missing or too much.
        let density = block.density + 4.5e-7 * (pressure - block.pressure_pa);
        let net = mass - density * volume;
        let pitch = size_of("pitch_scale", 1.0) * block.pitch + size_of("pitch_offset", 0.0);
        let climbing = if net < 0.0 { size_of("climb_dive_asymmetry", 1.0) } else { 1.0 };
        let stepped = if block.time_s >= self.step_s { 1.0 + size_of("drag_step", 0.0) } else { 1.0 };
        let factor = climbing
            * stepped
            * (1.0 + size_of("drag_growth", 0.0) * block.time_s / 86_400.0)
            * (1.0 + size_of("roll_drag", 0.0) * block.roll2)
            * (1.0 + size_of("rudder_drag", 0.0) * block.rudder2);
        let (angle, speed) = self.glide(net, pitch.abs(), block, factor, &size_of);
        let sinking = net.signum() * speed * (pitch.abs() + angle).sin() + size_of("vertical_current", 0.0);
        (sinking / size_of("pressure_scale", 1.0), speed)
    }

    fn glide(
        &self,
        net: f64,
        pitch: f64,
        block: &Block,
        factor: f64,
        size_of: &dyn Fn(&str, f64) -> f64,
    ) -> (f64, f64) {
        let [a, b, c] = self.polar;
        let (mut angle, mut speed) = (0.05_f64, 0.35_f64);
        let lean = 1.0 - 0.5 * block.roll2;
        for _ in 0..25 {
            let pressure = 0.5 * block.density * speed * speed;
            let reynolds = (pressure / (0.5 * 1025.0 * 0.09)).powf(size_of("reynolds_drag", 0.0));
            let drag = factor * (b * reynolds + c * angle * angle);
            let slope = lean * (a + size_of("nonlinear_lift", 0.0) * angle);
            let path = pitch + angle;
            angle = (0.5 * (angle + drag / (slope * path.tan()))).clamp(0.0, 0.4);
            let weight = GRAVITY_M_S2 * net.abs() * path.sin();
            speed = (2.0 * weight / (block.density * self.vehicle.frontal_area_m2 * drag)).sqrt().max(0.02);
        }
        (angle, speed)
    }
}

/// Inverse square roots of the covariances of vertical velocity and speed, from the known noise.
fn whitening(sea: &Sea, blocks: &[Block], speed: bool) -> Vec<DMatrix<f64>> {
    let truth = &sea.truth;
    let ocean = &truth.ocean;
    let averaged = |sd: f64, time_s: f64| sd * sd * (2.0 * time_s / BLOCK_S).min(1.0);
    let eddies = averaged(ocean.turbulence_m_s, ocean.turbulence_time_s);
    let slope = |block: &Block| 12.0 * 1.2e-4 / (block.rows * BLOCK_S * BLOCK_S);
    let tilt = |block: &Block| (0.4 * truth.quality.pitch_rad).powi(2) / block.rows;
    let mut covariances = vec![covariance(blocks, (0.7 * ocean.wave_rms_m_s, 400.0), (0.0015, 7200.0), &|block| {
        eddies + slope(block) + tilt(block)
    })];
    if speed {
        let sd = truth.quality.speed_m_s;
        let wander = averaged(truth.quality.speed_wander_m_s, 60.0);
        covariances.push(covariance(blocks, (0.003, 300.0), (0.0015, 7200.0), &|block| {
            sd * sd / block.rows + eddies + wander
        }));
    }
    covariances
        .into_iter()
        .map(|covariance| {
            let lower = covariance.cholesky().expect("a positive definite covariance").l();
            lower.try_inverse().expect("a regular factor")
        })
        .collect()
}

fn covariance(blocks: &[Block], fast: (f64, f64), slow: (f64, f64), own: &dyn Fn(&Block) -> f64) -> DMatrix<f64> {
    DMatrix::from_fn(blocks.len(), blocks.len(), |i, j| {
        let apart = (blocks[i].time_s - blocks[j].time_s).abs();
        let shared = fast.0.powi(2) * (-apart / fast.1).exp() + slow.0.powi(2) * (-apart / slow.1).exp();
        shared + if i == j { own(&blocks[i]) } else { 0.0 }
    })
}

/// Chi-square of the best fit of a (with speed only), b, c and the effect's size.
fn fit(mut model: Model, blocks: &[Block], whiten: &[DMatrix<f64>], speed: bool) -> f64 {
    let residuals = |model: &Model| {
        let both: Vec<(f64, f64)> = blocks
            .iter()
            .map(|block| {
                let (sinking, speed) = model.predict(block);
                (block.sinking_m_s - sinking, block.speed_m_s - speed)
            })
            .collect();
        let mut all =
            (&whiten[0] * DVector::from_iterator(blocks.len(), both.iter().map(|r| r.0))).data.as_vec().clone();
        if speed {
            all.extend((&whiten[1] * DVector::from_iterator(blocks.len(), both.iter().map(|r| r.1))).iter());
        }
        DVector::from_vec(all)
    };
    let free: Vec<usize> = (usize::from(!speed)..if model.effect == "none" { 3 } else { 4 }).collect();
    let mut now = residuals(&model);
    for _ in 0..12 {
        let columns: Vec<DVector<f64>> = free
            .iter()
            .map(|&which| {
                let step = small(&model, which);
                (residuals(&moved(&model, which, step)) - &now) / step
            })
            .collect();
        let scales: Vec<f64> = columns.iter().map(|column| column.norm().max(1e-300)).collect();
        let columns: Vec<DVector<f64>> = columns.iter().zip(&scales).map(|(column, scale)| column / *scale).collect();
        let jacobian = DMatrix::from_columns(&columns);
        let Ok(change) = jacobian.svd(true, true).solve(&-&now, 1e-9) else { break };
        let mut share = 1.0;
        let before = now.norm_squared();
        loop {
            let mut trial = model;
            for (place, &which) in free.iter().enumerate() {
                trial = moved(&trial, which, share * change[place] / scales[place]);
            }
            let then = residuals(&trial);
            if then.norm_squared() <= before {
                (model, now) = (trial, then);
                break;
            }
            share *= 0.5;
            if share < 1e-3 {
                return before;
            }
        }
        if before - now.norm_squared() < 1e-3 {
            break;
        }
    }
    now.norm_squared()
}

fn small(model: &Model, which: usize) -> f64 {
    match which {
        3 => match model.effect {
            "hull_compressibility" => 1e-12,
            "thermal_expansion" => 1e-6,
            "nonlinear_lift" | "trapped_air" => 0.1,
            "leak" => 1e-4,
            _ => 1e-3,
        },
        _ => 1e-4 * model.polar[which],
    }
}

fn moved<'a>(model: &Model<'a>, which: usize, by: f64) -> Model<'a> {
    let mut model = *model;
    if which < 3 {
        model.polar[which] += by;
    } else {
        model.size += by;
    }
    model
}
