//! What differs from tank to tank while nothing is wrong: sampling, lengths of runs and zeros, the programme, how well
//! the rig repeats, the kinds of noise. [`World::phoenix`] is one tank that is always the same; [`World::drawn`] draws
//! every item from the seed. Knows what a crew and a rig decide; no physics of hulls, nothing of a reduction.

use serde::{Deserialize, Serialize};

use super::noise::NoiseLevels;
use super::outline::PHOENIX;
use super::random::{Purpose, Stream};

/// Which tank.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Variety {
    /// The same good tank and programme for every seed.
    #[default]
    Phoenix,
    /// Another tank and programme for every seed.
    Drawn,
}

/// Speed and yaw angle of some runs, m/s and deg.
pub(super) type Points = Vec<(f64, f64)>;

/// In which order a hull's runs are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    Shuffled,
    /// As the programme lists them: one speed after the other, angles rising.
    Listed,
}

/// A tank with its programme of steady runs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct World {
    /// Samples per second: steady runs, oscillating runs.
    pub rates_hz: (f64, f64),
    /// Length of a zero run, s.
    pub zero_s: f64,
    /// Runs between two zero runs.
    pub runs_between_zeros: usize,
    /// Whether zero runs name the hull below the balance.
    pub zeros_name_hull: bool,
    /// Longest steady part of a drift run, s.
    pub hold_s: f64,
    /// Waiting time between runs, s.
    pub wait_s: (f64, f64),
    /// Speed and yaw angle of every drift run.
    pub sweep: Points,
    /// The same for those that are made twice.
    pub repeats: Points,
    /// The same for the strut alone.
    pub tare: Points,
    pub order: Order,
    /// Warming of the water within a day, K/h.
    pub warming_K_per_hour: f64,
    /// Change of the zeros over one hour, a standard deviation of a random walk: AF N, SF N, YM N m.
    pub zero_walk: [f64; 3],
    /// Spread of the even drift of the zeros per hour.
    pub zero_drift: [f64; 3],
    /// Levels of everything random within and between runs.
    pub levels: NoiseLevels,
    /// Which hulls are towed where none are asked for.
    pub hulls: Vec<usize>,
}

const PHOENIX_ANGLES_DEG: [f64; 17] =
    [-20.0, -16.0, -12.0, -10.0, -8.0, -6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0];
const PHOENIX_REPEATS_DEG: [f64; 5] = [-8.0, -4.0, 0.0, 4.0, 8.0];

impl World {
    /// The tank of this kind for a seed, everything random within runs multiplied by `noise`.
    pub(super) fn new(variety: Variety, seed: u64, noise: f64) -> Self {
        match variety {
            Variety::Phoenix => Self::phoenix(noise),
            Variety::Drawn => Self::drawn(&mut Stream::new(seed, Purpose::World), noise),
        }
    }

    /// A good tank with the programme of the Phoenix series.
    fn phoenix(noise: f64) -> Self {
        let mut sweep: Points = PHOENIX_ANGLES_DEG.iter().map(|yaw| (2.0, *yaw)).collect();
        sweep.extend([1.0, 3.0].iter().flat_map(|speed| PHOENIX_REPEATS_DEG.iter().map(|yaw| (*speed, *yaw))));
        sweep.extend([(1.5, 0.0), (2.5, 0.0)]);
        Self {
            rates_hz: (50.0, 100.0),
            zero_s: 20.0,
            runs_between_zeros: 9,
            zeros_name_hull: true,
            hold_s: 25.0,
            wait_s: (360.0, 960.0),
            repeats: PHOENIX_REPEATS_DEG.map(|yaw| (2.0, yaw)).to_vec(),
            tare: sweep.clone(),
            sweep,
            order: Order::Shuffled,
            warming_K_per_hour: 0.02,
            zero_walk: [0.0; 3],
            zero_drift: [0.10, 0.15, 0.06],
            levels: NoiseLevels::good_tank(noise),
            hulls: (0..PHOENIX.len()).collect(),
        }
    }

    /// A tank of a seed. Ranges are those of tanks from a student's flume, sampled fast and zeroed briefly, to a large
    /// facility with long runs.
    fn drawn(stream: &mut Stream, noise: f64) -> Self {
        let mut hulls: Vec<usize> = (0..PHOENIX.len()).collect();
        stream.shuffle(&mut hulls);
        hulls.truncate(1 + stream.index(PHOENIX.len()));
        hulls.sort_unstable();
        let (sweep, repeats) = programme(stream);
        let tare = tare_programme(&sweep, stream);
        let rate_hz = log_between(stream, 10.0, 1000.0).round();
        let hold_s = stream.between(10.0, 40.0);
        let zero_s = log_between(stream, 8.0, 120.0).round();
        let levels = levels(stream, noise);
        let walk = if chance(stream, 0.5) { noise * log_between(stream, 0.003, 0.05) } else { 0.0 };
        let even = if chance(stream, 0.6) { log_between(stream, 0.01, 0.2) } else { 0.0 };
        Self {
            rates_hz: (rate_hz, rate_hz.max(50.0)),
            zero_s,
            runs_between_zeros: 3 + stream.index(13),
            zeros_name_hull: chance(stream, 0.5),
            hold_s,
            wait_s: (240.0, stream.between(400.0, 1200.0)),
            sweep,
            repeats,
            tare,
            order: if chance(stream, 0.7) { Order::Shuffled } else { Order::Listed },
            warming_K_per_hour: stream.between(-0.02, 0.06),
            zero_walk: [0.7, 1.0, 0.4].map(|share| share * walk),
            zero_drift: [0.7, 1.0, 0.4].map(|share| share * even),
            levels,
            hulls,
        }
    }
}

/// Speeds, angles and repeats of a hull's drift runs.
fn programme(stream: &mut Stream) -> (Points, Points) {
    let widest = [10.0, 12.0, 16.0, 20.0][stream.index(4)];
    let steps = 3 + stream.index(6);
    let half: Vec<f64> = (1..=steps).map(|i| (widest * i as f64 / steps as f64 * 2.0).round() / 2.0).collect();
    let mut angles: Vec<f64> = half.iter().rev().map(|angle| -angle).collect();
    angles.push(0.0);
    angles.extend(&half);
    let main = [1.5, 2.0, 2.5][stream.index(3)];
    let mut sweep: Points = angles.iter().map(|yaw| (main, *yaw)).collect();
    let others: Vec<f64> =
        [1.0, 1.5, 2.0, 2.5, 3.0].into_iter().filter(|speed| *speed != main && chance(stream, 0.5)).collect();
    // Now and then the whole sweep at every speed, usually a few angles of it.
    let whole = chance(stream, 0.25);
    for speed in others {
        let some = angles.iter().filter(|yaw| whole || **yaw == 0.0 || half.len() < 4 || half[1] == yaw.abs());
        sweep.extend(some.map(|yaw| (speed, *yaw)));
    }
    let share = [0.0, 0.15, 0.3, 1.0][stream.index(4)];
    let repeats = sweep.iter().copied().filter(|_| chance(stream, share)).collect();
    (sweep, repeats)
}

/// The strut: at every speed and angle, at every speed straight ahead, or not at all.
fn tare_programme(sweep: &[(f64, f64)], stream: &mut Stream) -> Points {
    let kind = stream.between(0.0, 1.0);
    let mut ahead: Points = Vec::new();
    for (speed, _) in sweep {
        if !ahead.contains(&(*speed, 0.0)) {
            ahead.push((*speed, 0.0));
        }
    }
    match kind {
        kind if kind < 0.5 => sweep.to_vec(),
        kind if kind < 0.9 => ahead,
        _ => Vec::new(),
    }
}

/// Noise of a drawn tank: white, first-order, 1/f, now and then with heavy tails; two or three lines of vibration.
fn levels(stream: &mut Stream, noise: f64) -> NoiseLevels {
    let good = NoiseLevels::good_tank(noise);
    let scaled = |levels: [f64; 3], by: f64| levels.map(|level| level * by);
    let (white, slow, under_way) = (stream.between(0.3, 3.0), stream.between(0.2, 4.0), stream.between(0.0, 1.5));
    let flicker = if chance(stream, 0.4) { stream.between(0.3, 3.0) } else { 0.0 };
    let contamination = if chance(stream, 0.25) { 0.05 } else { 0.0 };
    let repeatability = if chance(stream, 0.4) { stream.between(0.2, 1.5) } else { 0.0 };
    let resolution = if chance(stream, 0.4) { log_between(stream, 0.001, 0.05) } else { 0.0 };
    NoiseLevels {
        slow_time_constant_s: log_between(stream, 0.1, 2.0),
        slow_at_rest: scaled(good.slow_at_rest, slow),
        slow_under_way: scaled(good.slow_under_way, under_way),
        white: scaled(good.white, white),
        vibration_hz: [stream.between(1.5, 5.0), stream.between(5.0, 12.0), stream.between(12.0, 40.0)],
        vibration: scaled(good.vibration, stream.between(0.0, 1.5)),
        strut_alone_share: stream.between(0.2, 1.0),
        unevenness: good.unevenness * stream.between(0.2, 2.0),
        speed_setting: good.speed_setting * stream.between(0.2, 2.0),
        yaw_setting_deg: good.yaw_setting_deg * stream.between(0.2, 2.0),
        sensors: scaled(good.sensors, stream.between(0.3, 3.0)),
        flicker: scaled([0.03, 0.05, 0.02], noise * flicker),
        contamination,
        repeatability: scaled([0.02, 0.03, 0.012], noise * repeatability),
        resolution: [1.0, 1.0, 0.5].map(|share: f64| share * resolution),
        ..good
    }
}

fn chance(stream: &mut Stream, share: f64) -> bool {
    stream.between(0.0, 1.0) < share
}

fn log_between(stream: &mut Stream, low: f64, high: f64) -> f64 {
    stream.between(low.ln(), high.ln()).exp()
}
