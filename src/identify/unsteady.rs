//! The unsteady mode: the glider flown through its measured pitch, ballast and water, so that turns and accelerating
//! samples take part.
//!
//! Pitch is measured, so the equation of its moment is not needed: what is integrated are the first two rows of the
//! equations of motion ([`accelerations`]), with the pitch rate of the record,
//! ```text
//! (v1, v3)' = f(v1, v3; pitch(t), pitch rate(t), ballast(t), water(t)),     sink = v3 cos pitch - v1 sin pitch
//! ```
//! Heave settles within a second, surge within half a minute: TR-BDF2 (Bank et al. 1985), which is L-stable and of second
//! order, takes both at the pace of the samples. Each implicit stage is solved in plain numbers; its slopes by the
//! parameters follow from one evaluation with derivatives (implicit function theorem), so that they are exactly those of
//! the discrete solution. The model's depth passes the very filter that made the vertical velocity of the record.
//!
//! A passage begins at rest where the glider floats, in a steady glide where the record begins under way; after the
//! latter, samples count once the start is forgotten.

use num_dual::{Dual64, DualSVec64};
use rayon::prelude::*;

use super::blocks::Blocks;
use super::data::{ranges, root_weights};
use super::evaluate::{MOST_FREE, Rows, Tally, Weights, with_derivatives};
use super::gram::Gram;
use super::model::{or_zero, sink_read_m_s, surroundings, true_pitch_rad};
use super::residuals::Residual;
use crate::Number;
use crate::dynamics::{Inputs, Parameters, State, accelerations};
use crate::glide::{Attitude, Deflection, Glider};
use crate::log::{Observation, filter_window};

/// Pressure above which the glider is taken to float at rest \[dbar\].
const AFLOAT_DBAR: f64 = 0.5;

/// Time that a dive is flown before its first sample counts \[s\]: five time constants of surge.
const WARM_UP_S: f64 = 120.0;

/// Longest step \[s\].
const LONGEST_STEP_S: f64 = 5.0;

/// One dive with what is needed to fly it: the samples, some of the dive before, and which of them count.
#[derive(Debug, Clone)]
pub struct Passage {
    /// Samples in the order of time, those of the run-up first.
    pub observations: Vec<Observation>,
    /// Whether a sample takes part in the fit.
    pub counts: Vec<bool>,
    pitch_rates_rad_s: Vec<f64>,
    /// First and last sample of the filter around each one.
    windows: Vec<(usize, usize)>,
    root_weights: Vec<f64>,
}

/// The dives of a log as passages. Samples above `from_dbar` do not count; `half_window_s` is that of the filter for the
/// vertical velocity.
pub fn passages(observations: &[Observation], from_dbar: f64, half_window_s: f64) -> Vec<Passage> {
    let mut passages = Vec::new();
    for range in ranges(observations, |o| o.dive) {
        // A gap within a dive ends one passage and begins another.
        let mut start = range.start;
        for end in range.start + 1..=range.end {
            if end < range.end && observations[end].stretch == observations[start].stretch {
                continue;
            }
            let stretch = observations[start].stretch;
            let mut first = start;
            while first > 0
                && observations[first - 1].stretch == stretch
                && observations[start].time_s - observations[first - 1].time_s < WARM_UP_S
            {
                first -= 1;
            }
            // The filter of the last sample looks beyond the dive.
            let mut last = end;
            while last < observations.len()
                && observations[last].stretch == stretch
                && observations[last].time_s - observations[end - 1].time_s <= half_window_s
            {
                last += 1;
            }
            passages.extend(Passage::new(
                &observations[first..last],
                start - first..end - first,
                from_dbar,
                half_window_s,
            ));
            start = end;
        }
    }
    passages
}

impl Passage {
    fn new(
        observations: &[Observation],
        own: std::ops::Range<usize>,
        from_dbar: f64,
        half_window_s: f64,
    ) -> Option<Passage> {
        let n = observations.len();
        if n < 5 {
            return None;
        }
        let time: Vec<f64> = observations.iter().map(|o| o.time_s).collect();
        let windows: Vec<(usize, usize)> = (0..n)
            .map(|i| if i == 0 || i + 1 == n { (i, i) } else { filter_window(&time, i, half_window_s) })
            .collect();
        let mut known_since_s = f64::NAN;
        let counts: Vec<bool> = (0..n)
            .map(|i| {
                if is_start(observations, i) {
                    let rests = observations[i].pressure_dbar < AFLOAT_DBAR;
                    known_since_s = time[i] + if rests { 0.0 } else { 0.5 * WARM_UP_S };
                }
                let o = &observations[i];
                own.contains(&i)
                    && windows[i].0 < windows[i].1
                    && time[i] >= known_since_s
                    && o.pressure_dbar >= from_dbar
                    && o.sink_m_s.is_finite()
            })
            .collect();
        let rate = |i: usize, j: usize| (observations[j].pitch_rad - observations[i].pitch_rad) / (time[j] - time[i]);
        Some(Passage {
            pitch_rates_rad_s: (0..n).map(|i| rate(i.saturating_sub(1), (i + 1).min(n - 1))).collect(),
            root_weights: root_weights(observations),
            windows,
            counts,
            observations: observations.to_vec(),
        })
        .filter(|passage| passage.counts.contains(&true))
    }

    /// Measured less predicted, sample by sample; NaN where a sample does not count.
    pub fn residuals(&self, parameters: &Parameters<f64>) -> Vec<Residual> {
        let flight = fly(&Flyer::new(*parameters), self);
        (0..self.observations.len())
            .map(|i| {
                let observed = &self.observations[i];
                match flight.at(self, parameters, i).filter(|_| self.counts[i]) {
                    Some((sink, speed)) => Residual {
                        sink_m_s: observed.sink_m_s - sink,
                        speed_m_s: observed.speed_m_s - speed,
                        angle_of_attack_rad: flight.velocity[i][1].atan2(flight.velocity[i][0]),
                        predicted_speed_m_s: speed,
                    },
                    None => Residual::NONE,
                }
            })
            .collect()
    }
}

/// Whether the flight begins anew at this sample.
fn is_start(observations: &[Observation], i: usize) -> bool {
    i == 0 || observations[i].pressure_dbar < AFLOAT_DBAR
}

impl Blocks for Vec<Passage> {
    fn count(&self) -> usize {
        self.len()
    }

    fn samples(&self) -> usize {
        self.iter().map(|passage| passage.counts.iter().filter(|&&counts| counts).count()).sum()
    }

    fn has_speed(&self) -> bool {
        let counted = self.iter().flat_map(|passage| passage.observations.iter().zip(&passage.counts));
        counted.into_iter().any(|(o, &counts)| counts && o.speed_m_s.is_finite())
    }

    /// Time goes on from sample to sample: all of them are flown whatever `every` says.
    fn evaluate(
        &mut self,
        parameters: &Parameters<f64>,
        free: &[usize],
        weights: Weights,
        grams: &mut [Gram],
        _every: usize,
    ) -> Tally {
        macro_rules! by_size {
            ($($size:literal),*) => {
                $(if free.len() <= $size {
                    let flyer = Flyer::new(with_derivatives::<$size>(parameters, free));
                    let work = |(passage, gram): (&Passage, &mut Gram)| rows(&flyer, free.len(), weights, passage, gram);
                    return self.par_iter().zip(grams.par_iter_mut()).map(work).reduce(Tally::default, Tally::merge);
                })*
            };
        }
        by_size!(4, 6, 10, 32);
        panic!("{} parameters are free, {MOST_FREE} can be", free.len())
    }
}

fn rows<const N: usize>(
    flyer: &Flyer<DualSVec64<N>>,
    n: usize,
    weights: Weights,
    passage: &Passage,
    gram: &mut Gram,
) -> Tally {
    let flight = fly(flyer, passage);
    let mut rows = Rows::new(gram, n, weights);
    for (i, observed) in passage.observations.iter().enumerate().filter(|(i, _)| passage.counts[*i]) {
        rows.glide(observed, flight.at(passage, &flyer.lifted, i), passage.root_weights[i]);
    }
    rows.close()
}

/// The parameters in every kind of number that the flight needs.
struct Flyer<T> {
    lifted: Parameters<T>,
    plain: Parameters<f64>,
    with_slopes: Parameters<Dual64>,
    glider: Glider<T>,
}

impl<T: Number> Flyer<T> {
    fn new(lifted: Parameters<T>) -> Self {
        let plain = lifted.map(T::value);
        Flyer { lifted, plain, with_slopes: plain.map(Dual64::from), glider: Glider::new(lifted) }
    }
}

/// A passage as flown: velocities along axes 1 and 3 at each sample, and the way down since the passage began.
struct Flight<T> {
    velocity: Vec<[T; 2]>,
    way_down_m: Vec<T>,
    /// How often the flight began anew before a sample: a filter does not look across.
    begun: Vec<u32>,
}

impl<T: Number> Flight<T> {
    /// Downward velocity as the pressure sensor and the filter show it, and speed; nothing where the flight broke off.
    fn at(&self, passage: &Passage, parameters: &Parameters<T>, i: usize) -> Option<(T, T)> {
        let (low, high) = passage.windows[i];
        if low == high || self.begun[low] != self.begun[high] {
            return None;
        }
        // The slope of the least-squares line through the depths of the window.
        let time = |k: usize| passage.observations[k].time_s - passage.observations[i].time_s;
        let n = (high - low + 1) as f64;
        let mean = (low..=high).map(time).sum::<f64>() / n;
        let spread: f64 = (low..=high).map(|k| (time(k) - mean).powi(2)).sum();
        let mut slope = T::constant(0.0);
        for k in low..=high {
            slope += (self.way_down_m[k] - self.way_down_m[i]) * ((time(k) - mean) / spread);
        }
        let [v1, v3] = self.velocity[i];
        let speed = (v1 * v1 + v3 * v3).sqrt();
        let sink = sink_read_m_s(parameters, slope, passage.observations[i].sink_rate_m_s2);
        (sink.value().is_finite() && speed.value().is_finite()).then_some((sink, speed))
    }
}

fn fly<T: Number>(flyer: &Flyer<T>, passage: &Passage) -> Flight<T> {
    let n = passage.observations.len();
    let mut flight =
        Flight { velocity: Vec::with_capacity(n), way_down_m: Vec::with_capacity(n), begun: Vec::with_capacity(n) };
    let mut velocity = [T::constant(0.0); 2];
    let mut down = T::constant(0.0);
    let mut begun = 0;
    // The rates at the end of a step are those at the beginning of the next.
    let mut rates: Option<[T; 2]> = None;
    let mut here = Moment::at(passage, 0);
    for i in 0..n {
        let next = Moment::at(passage, i);
        if is_start(&passage.observations, i) {
            velocity = begin(flyer, &passage.observations[i]);
            rates = None;
            begun += 1;
        } else {
            let before = sink(&flyer.lifted, &here, velocity);
            match advance(flyer, &here, &next, velocity, rates) {
                Some((there, way_down, at_the_end)) => {
                    (velocity, rates) = (there, Some(at_the_end));
                    down += way_down;
                }
                None => {
                    // No solution: the flight goes on from rest, and a gap tells the filter.
                    velocity = [T::constant(REST_M_S), T::constant(0.0)];
                    rates = None;
                    down += before * (next.time_s - here.time_s);
                    begun += 1;
                }
            }
        }
        here = next;
        flight.velocity.push(velocity);
        flight.way_down_m.push(down);
        flight.begun.push(begun);
    }
    flight
}

/// Speed of a glider at rest \[m/s\]: the angle of attack has no value at none.
const REST_M_S: f64 = 1e-3;

/// At rest where it floats, or where no steady glide exists; in a steady glide otherwise.
fn begin<T: Number>(flyer: &Flyer<T>, observed: &Observation) -> [T; 2] {
    let rest = [T::constant(REST_M_S), T::constant(0.0)];
    if observed.pressure_dbar < AFLOAT_DBAR {
        return rest;
    }
    let p = &flyer.lifted;
    let water = surroundings(p, observed);
    let attitude = Attitude {
        pitch_rad: true_pitch_rad(p, observed.pitch_rad),
        net_mass_kg: p.net_mass_kg(T::constant(observed.ballast_m3), &water),
    };
    let straight = Deflection { roll_rad: T::constant(0.0), rudder_rad: T::constant(0.0) };
    match flyer.glider.flight(&water, attitude, straight, None) {
        Ok(glide) => {
            let (sin, cos) = glide.angle_of_attack_rad.sin_cos();
            [glide.speed_m_s * cos, glide.speed_m_s * sin]
        }
        Err(_) => rest,
    }
}

/// What was measured at one moment, between two samples by straight lines.
#[derive(Debug, Clone, Copy)]
struct Moment {
    time_s: f64,
    pitch_rad: f64,
    pitch_rate_rad_s: f64,
    pressure_dbar: f64,
    pressure_rate_dbar_s: f64,
    density_kg_m3: f64,
    temperature_C: f64,
    ballast_m3: f64,
    roll_rad: f64,
    rudder_rad: f64,
}

impl Moment {
    fn at(passage: &Passage, i: usize) -> Moment {
        let o = &passage.observations[i];
        Moment {
            time_s: o.time_s,
            pitch_rad: o.pitch_rad,
            pitch_rate_rad_s: passage.pitch_rates_rad_s[i],
            pressure_dbar: or_zero(o.pressure_dbar),
            pressure_rate_dbar_s: or_zero(o.pressure_rate_dbar_s),
            density_kg_m3: o.density_kg_m3,
            temperature_C: o.temperature_C,
            ballast_m3: o.ballast_m3,
            roll_rad: or_zero(o.roll_rad),
            rudder_rad: or_zero(o.rudder_rad),
        }
    }

    fn between(&self, other: &Moment, share: f64) -> Moment {
        let mix = |a: f64, b: f64| a + share * (b - a);
        Moment {
            time_s: mix(self.time_s, other.time_s),
            pitch_rad: mix(self.pitch_rad, other.pitch_rad),
            pitch_rate_rad_s: mix(self.pitch_rate_rad_s, other.pitch_rate_rad_s),
            pressure_dbar: mix(self.pressure_dbar, other.pressure_dbar),
            pressure_rate_dbar_s: mix(self.pressure_rate_dbar_s, other.pressure_rate_dbar_s),
            density_kg_m3: mix(self.density_kg_m3, other.density_kg_m3),
            temperature_C: mix(self.temperature_C, other.temperature_C),
            ballast_m3: mix(self.ballast_m3, other.ballast_m3),
            roll_rad: mix(self.roll_rad, other.roll_rad),
            rudder_rad: mix(self.rudder_rad, other.rudder_rad),
        }
    }
}

fn sink<T: Number>(parameters: &Parameters<T>, at: &Moment, [v1, v3]: [T; 2]) -> T {
    let (sin, cos) = true_pitch_rad(parameters, at.pitch_rad).sin_cos();
    v3 * cos - v1 * sin
}

/// Rates of change of the velocities.
fn rates<T: Number>(p: &Parameters<T>, at: &Moment, [v1, v3]: [T; 2]) -> [T; 2] {
    let zero = T::constant(0.0);
    let density = p.true_density_kg_m3(T::constant(at.density_kg_m3));
    let pressure_dbar = p.pressure_scale * (p.pressure_lag_s * at.pressure_rate_dbar_s + at.pressure_dbar);
    let depth_m = (pressure_dbar * crate::log::DBAR_PA / (density * p.gravity_m_s2)).at_least(0.0);
    let state = State {
        x_m: zero,
        depth_m,
        pitch_rad: true_pitch_rad(p, at.pitch_rad),
        pitch_rate_rad_s: p.pitch_scale * at.pitch_rate_rad_s,
        v1_m_s: v1,
        v3_m_s: v3,
        moving_mass_1_m: zero,
        moving_mass_3_m: p.moving_mass_height_m,
        momentum_1_kg_m_s: zero,
        momentum_3_kg_m_s: zero,
        ballast_mass_kg: p.ballast_mass_kg(T::constant(at.ballast_m3)),
        energy_J: zero,
    };
    let inputs = Inputs {
        ballast_command_m3: zero,
        moving_mass_command_m: zero,
        u1_N: zero,
        u3_N: zero,
        u4_kg_s: zero,
        water_density_kg_m3: T::constant(at.density_kg_m3),
        water_temperature_C: if at.temperature_C.is_finite() {
            T::constant(at.temperature_C)
        } else {
            p.reference_temperature_C
        },
        current_x_m_s: zero,
        current_z_m_s: zero,
        seabed_depth_m: T::constant(f64::MAX),
        roll_rad: T::constant(at.roll_rad),
        rudder_rad: T::constant(at.rudder_rad),
    };
    accelerations(p, T::constant(at.time_s), &state, &inputs, zero)
}

/// From one sample to the next: velocity, the way down meanwhile, and the rates at the end.
fn advance<T: Number>(
    flyer: &Flyer<T>,
    here: &Moment,
    next: &Moment,
    velocity: [T; 2],
    known: Option<[T; 2]>,
) -> Option<([T; 2], T, [T; 2])> {
    // gamma = 2 - sqrt 2: both stages have the same matrix 1 - d h f'.
    const GAMMA: f64 = 2.0 - std::f64::consts::SQRT_2;
    const D: f64 = 0.5 * GAMMA;
    const FROM_STAGE: f64 = 1.0 / (GAMMA * (2.0 - GAMMA));
    const FROM_START: f64 = (1.0 - GAMMA) * (1.0 - GAMMA) / (GAMMA * (2.0 - GAMMA));
    let duration = next.time_s - here.time_s;
    let steps = (duration / LONGEST_STEP_S).ceil().max(1.0);
    let h = duration / steps;
    let mut x = velocity;
    let mut f = known.unwrap_or_else(|| rates(&flyer.lifted, here, x));
    let mut down = T::constant(0.0);
    let mut matrix = [[f64::INFINITY, 0.0], [0.0, f64::INFINITY]];
    for step in 0..steps as usize {
        let at = |share: f64| here.between(next, (step as f64 + share) / steps);
        let (start, middle, end) = (at(0.0), at(GAMMA), at(1.0));
        let guess = [x[0].value() + GAMMA * h * f[0].value(), x[1].value()];
        let base = [x[0] + f[0] * (D * h), x[1] + f[1] * (D * h)];
        let stage = implicit(flyer, &middle, base, D * h, guess, &mut matrix)?;
        let base = [0, 1].map(|k| stage[k] * FROM_STAGE - x[k] * FROM_START);
        let there = implicit(flyer, &end, base, D * h, stage.map(T::value), &mut matrix)?;
        // Simpson's weights for the three places of the stage, exact for parabolas.
        let sinks =
            [sink(&flyer.lifted, &start, x), sink(&flyer.lifted, &middle, stage), sink(&flyer.lifted, &end, there)];
        let middle_weight = 1.0 / (6.0 * GAMMA * (1.0 - GAMMA));
        let end_weight = 0.5 - GAMMA * middle_weight;
        let start_weight = 1.0 - middle_weight - end_weight;
        down += (sinks[0] * start_weight + sinks[1] * middle_weight + sinks[2] * end_weight) * h;
        f = [0, 1].map(|k| (there[k] - base[k]) / (D * h));
        x = there;
    }
    Some((x, down, f))
}

/// The solution of `x = base + s f(x)`, with its derivatives. `matrix` is `1 - s f'` nearby, and that of the solution
/// afterwards.
fn implicit<T: Number>(
    flyer: &Flyer<T>,
    at: &Moment,
    base: [T; 2],
    s: f64,
    guess: [f64; 2],
    matrix: &mut [[f64; 2]; 2],
) -> Option<[T; 2]> {
    // The last step is Newton's own and squares the error: after one of this size the rest is rounding.
    const TOLERANCE_M_S: f64 = 1e-6;
    const MOST_ROUNDS: usize = 25;
    const MOST_CHEAP_STEPS: usize = 3;
    let plain_base = base.map(T::value);
    let mut x = guess;
    for _ in 0..MOST_ROUNDS {
        // A few steps with the matrix at hand cost a fraction of a new one.
        for _ in 0..MOST_CHEAP_STEPS {
            let f = rates(&flyer.plain, at, x);
            let step = solve_2(*matrix, [0, 1].map(|k| x[k] - plain_base[k] - s * f[k]));
            let size = step[0].abs().max(step[1].abs());
            if size.is_nan() || size >= 0.05 {
                break;
            }
            x = [x[0] - step[0], x[1] - step[1]];
            if size < 10.0 * TOLERANCE_M_S {
                break;
            }
        }
        let by_1 = rates(&flyer.with_slopes, at, [Dual64::from(x[0]).derivative(), x[1].into()]);
        let by_3 = rates(&flyer.with_slopes, at, [x[0].into(), Dual64::from(x[1]).derivative()]);
        *matrix = [[1.0 - s * by_1[0].eps, -s * by_3[0].eps], [-s * by_1[1].eps, 1.0 - s * by_3[1].eps]];
        let step = solve_2(*matrix, [0, 1].map(|k| x[k] - plain_base[k] - s * by_1[k].re));
        let size = step[0].abs().max(step[1].abs());
        if !size.is_finite() {
            return None;
        }
        // Where the flow turns over, a full step overshoots.
        let damping = (0.2 / size).min(1.0);
        x = [x[0] - damping * step[0], x[1] - damping * step[1]];
        if size < TOLERANCE_M_S {
            let mut solution = x.map(T::constant);
            if T::HAS_DERIVATIVES {
                let f = rates(&flyer.lifted, at, solution);
                let step = solve_2(*matrix, [0, 1].map(|k| solution[k] - base[k] - f[k] * s));
                solution = [0, 1].map(|k| solution[k] - step[k]);
            }
            return Some(solution);
        }
    }
    None
}

/// `A^-1 r` for a matrix of plain numbers.
fn solve_2<T: Number>([[a, b], [c, d]]: [[f64; 2]; 2], [r, s]: [T; 2]) -> [T; 2] {
    let determinant = a * d - b * c;
    [(r * d - s * b) / determinant, (s * a - r * c) / determinant]
}
