//! The steady glide of one bin, with its slopes in every direction that a fit may go.

use nalgebra::{Const, U1};
use num_dual::{Derivative, DualSVec64};

use crate::dynamics::{Parameters, parameter_index};
use crate::glide::SteadyGlider;
use crate::identify::{Bin, Inside, felt_density_kg_m3, median_step_s, turns_by_rad};
use crate::log::Observation;

/// Parameters that are varied in one pass; more take another pass.
const WIDE: usize = 24;

/// The same where few are varied, as in the steps of a fit.
const NARROW: usize = 8;

/// Passes of [`NARROW`] that take less time than one of [`WIDE`].
const MOST_NARROW_PASSES: usize = 2;

/// Which rows of the table of parameters are varied, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Directions {
    rows: Vec<usize>,
}

impl Directions {
    pub fn new(baseline: &[usize]) -> Self {
        Directions { rows: baseline.to_vec() }
    }

    /// The direction of a row, a new one where it has none yet.
    pub fn index_of(&mut self, row: usize) -> usize {
        self.rows.iter().position(|known| *known == row).unwrap_or_else(|| {
            self.rows.push(row);
            self.rows.len() - 1
        })
    }

    pub fn len(&self) -> usize {
        self.rows.len()
    }
}

/// A value and its slope in every direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Sloped {
    pub value: f64,
    pub slopes: Vec<f64>,
}

/// The vehicle at one point of a fit, before and after the jump of its drag.
pub struct Vehicle {
    /// Its parameters there.
    pub parameters: Parameters<f64>,
    passes: Passes,
    /// Without slopes, before and after the jump.
    plain: [SteadyGlider<f64>; 2],
    n_directions: usize,
    jump_s: f64,
}

/// The vehicle with the directions in it that are varied, in passes of one width.
enum Passes {
    Narrow(Vec<Pass<NARROW>>),
    Wide(Vec<Pass<WIDE>>),
}

/// The vehicle with some of the directions in it.
struct Pass<const N: usize> {
    before: SteadyGlider<DualSVec64<N>>,
    after: SteadyGlider<DualSVec64<N>>,
    /// Which directions they are.
    directions: Vec<usize>,
}

impl Vehicle {
    /// The vehicle with slopes in the directions that are `varied`; those in others are zero.
    pub fn new(parameters: &Parameters<f64>, directions: &Directions, varied: &[usize]) -> Self {
        let passes = if varied.len() <= MOST_NARROW_PASSES * NARROW {
            Passes::Narrow(Pass::all(parameters, directions, varied))
        } else {
            Passes::Wide(Pass::all(parameters, directions, varied))
        };
        let at = |step_time_s: f64| SteadyGlider::new(Parameters { step_time_s, ..*parameters });
        let plain = [at(f64::INFINITY), at(f64::NEG_INFINITY)];
        Vehicle {
            parameters: *parameters,
            passes,
            plain,
            n_directions: directions.len(),
            jump_s: parameters.step_time_s,
        }
    }

    /// Vertical velocity and speed alone, 0 where no glide balances.
    pub fn fly_plainly(&self, bin: &Bin, inside: &Inside) -> [f64; 2] {
        let glider = &self.plain[usize::from(bin.mean.time_s >= self.jump_s)];
        inside.predict(glider, bin, None).map_or([0.0; 2], |read| [read.sink_m_s, read.speed_m_s])
    }

    /// Vertical velocity and speed as the instruments would read them. Where no glide balances the glider stands still:
    /// no velocity, no slope.
    pub fn fly(&self, bin: &Bin, inside: &Inside) -> (Sloped, Sloped) {
        let still = || Sloped { value: 0.0, slopes: vec![0.0; self.n_directions] };
        let (mut sink, mut speed) = (still(), still());
        let is_before = bin.mean.time_s < self.jump_s;
        match &self.passes {
            Passes::Narrow(passes) => {
                passes.iter().for_each(|pass| pass.fly(is_before, bin, inside, [&mut sink, &mut speed]));
            }
            Passes::Wide(passes) => {
                passes.iter().for_each(|pass| pass.fly(is_before, bin, inside, [&mut sink, &mut speed]));
            }
        }
        (sink, speed)
    }
}

impl<const N: usize> Pass<N> {
    fn all(parameters: &Parameters<f64>, directions: &Directions, varied: &[usize]) -> Vec<Self> {
        varied.chunks(N).map(|varied| Pass::new(parameters, directions, varied)).collect()
    }

    fn new(parameters: &Parameters<f64>, directions: &Directions, varied: &[usize]) -> Self {
        let mut p = parameters.map(DualSVec64::<N>::from);
        for (place, direction) in varied.iter().enumerate() {
            let row = directions.rows[*direction];
            let value = p.at(row).re;
            *p.at(row) = DualSVec64::new(value, Derivative::derivative_generic(Const, U1, place));
        }
        // The slope along a jump is wanted on both sides of it: the caller knows which rows a jump reaches.
        p.step_time_s = f64::NEG_INFINITY.into();
        let after = SteadyGlider::new(p);
        if let Some(row) = parameter_index("drag_step") {
            let step = *p.at(row);
            *p.at(row) = step - step.re;
        }
        Pass { before: SteadyGlider::new(p), after, directions: varied.to_vec() }
    }

    /// Sets the value and the slopes of this pass, where a glide balances.
    fn fly(&self, is_before: bool, bin: &Bin, inside: &Inside, [sink, speed]: [&mut Sloped; 2]) {
        let glider = if is_before { &self.before } else { &self.after };
        if let Some(read) = inside.predict(glider, bin, None) {
            sink.take(&read.sink_m_s, &self.directions);
            speed.take(&read.speed_m_s, &self.directions);
        }
    }
}

impl Sloped {
    /// The value and its slopes times a factor.
    pub fn scale(&mut self, factor: f64) {
        self.value *= factor;
        self.slopes.iter_mut().for_each(|slope| *slope *= factor);
    }

    /// Takes the value of a pass, and its slopes in these directions.
    fn take<const N: usize>(&mut self, value: &DualSVec64<N>, directions: &[usize]) {
        self.value = value.re;
        if let Some(slopes) = &value.eps.0 {
            directions.iter().zip(slopes).for_each(|(direction, slope)| self.slopes[*direction] = *slope);
        }
    }
}

/// The vertical velocity of the vehicle's steady glide in a bin \[m/s\]; not a number where it does not glide.
pub fn sink_m_s(parameters: &Parameters<f64>, bin: &Bin) -> f64 {
    let read = Inside::NOTHING.predict(&SteadyGlider::new(*parameters), bin, None);
    read.map_or(f64::NAN, |read| read.sink_m_s)
}

/// Whether the vehicle flies at all as this bin says.
pub fn flies(parameters: &Parameters<f64>, bin: &Bin) -> bool {
    Inside::NOTHING.predict(&SteadyGlider::new(*parameters), bin, None).is_some()
}

/// Largest share of the drag that the inertia may have where a glide counts as steady.
const LARGEST_INERTIA: f64 = 0.2;

/// What net mass is uncertain by where everything is as it should be \[kg\]: a cubic centimetre of ballast, 0.02 kg/m3 of
/// density.
pub const WEIGHING_ERROR_KG: f64 = 1e-3;

/// Drag coefficient of usual gliders on their frontal area, where a rough figure will do: the vehicle's own may be wrong by
/// as much as is to be found out.
const USUAL_DRAG_COEFFICIENT: f64 = 0.3;

/// Samples within this time say how fast a glider goes \[s\]: the 10 to 30 s in which its speed follows.
const ABOUT_S: f64 = 30.0;

/// A speed below which no glide is steady \[m/s\]: internal waves move the water by as much.
const SLOWEST_M_S: f64 = 0.05;

/// Angle of attack of a usual glide \[rad\], where a small term needs the path rather than the pitch.
const USUAL_ANGLE_OF_ATTACK_RAD: f64 = 0.05;

/// Which bins are steady: `M |w'| / sin xi` below a share of the drag `rho A b w^2 / (2 sin^2 xi)`, all as measured. A
/// glider that hangs near neutral is not, whatever the time since its last turn. Nor is one that pitches so fast within the bin that its
/// steady speed, which varies as the root of `sin xi`, needs more: `M V cot xi |xi'| / 2` is that force.
pub fn steady(parameters: &Parameters<f64>, bins: &[Bin], samples: &[Observation]) -> Vec<bool> {
    let mass = parameters.mass_kg() + parameters.added_mass_1_kg;
    let reach_s = reach_s(bins);
    (0..bins.len())
        .map(|i| {
            let most_N = LARGEST_INERTIA * drag_N(parameters, &bins[i]);
            let (sin, cos) = path_rad(&bins[i]).sin_cos();
            let of_bin = &samples[bins[i].first..bins[i].first + bins[i].samples];
            let speed_m_s = bins[i].mean.sink_m_s.abs() / sin;
            if mass * speed_m_s * cos / (2.0 * sin) * pitch_rate_rad_s(of_bin) > most_N {
                return false;
            }
            let (low, high) = neighbours(bins, i, reach_s);
            if high == low {
                return true;
            }
            let [a, b] = [low, high].map(|j| &bins[j].mean);
            let acceleration = (b.sink_m_s - a.sink_m_s) / (b.time_s - a.time_s);
            mass * acceleration.abs() / sin <= most_N
        })
        .collect()
}

/// Rate of the pitch within a bin, of means since single readings have their noise.
fn pitch_rate_rad_s(samples: &[Observation]) -> f64 {
    let (first, last) = (&samples[0], &samples[samples.len() - 1]);
    let between_middles_s = 0.75 * (last.time_s - first.time_s);
    if between_middles_s > 0.0 { turns_by_rad(samples) / between_middles_s } else { 0.0 }
}

/// Adds to the errors of a bin what the uncertainty of its net mass makes of them. By the balance along the path,
/// `dw/dm = g sin xi w / (2 D)`: it grows without bound towards neutral.
pub fn add_mass_error(parameters: &Parameters<f64>, bin: &mut Bin, error_kg: f64) {
    let sin = path_rad(bin).sin();
    let per_kg = parameters.gravity_m_s2 * sin * bin.mean.sink_m_s.abs() / (2.0 * drag_N(parameters, bin));
    bin.sink_sd_m_s = bin.sink_sd_m_s.hypot(per_kg * error_kg);
    bin.speed_sd_m_s = bin.speed_sd_m_s.hypot(per_kg * error_kg / sin);
}

/// Error of a glider's mean net mass over these samples as the water between two of them is not known \[kg\].
///
/// Where the density changes by `drho` within a step of `h`, it may do so at once and at any moment: the mean over the step is known
/// to `drho / sqrt 12`. The vertical velocity of the first and the last sample reaches into the steps beside them: give one sample more at each end.
pub fn sampling_error_kg(parameters: &Parameters<f64>, samples: &[Observation]) -> f64 {
    let (mut square, mut lasts_s) = (0.0, 0.0);
    for pair in samples.windows(2) {
        let step_s = pair[1].time_s - pair[0].time_s;
        square += ((felt_density_kg_m3(&pair[1]) - felt_density_kg_m3(&pair[0])) * step_s).powi(2) / 12.0;
        lasts_s += step_s;
    }
    let volume_m3 = parameters.mass_kg() / samples.first().map_or(f64::INFINITY, |o| o.density_kg_m3);
    if lasts_s > 0.0 { volume_m3 * square.sqrt() / lasts_s } else { 0.0 }
}

/// Adds to the errors of a bin what the error of its mean pitch makes of them. By the balance along the path the speed goes
/// with the root of `sin xi` at a given net mass, so `dU/U = cot xi dxi / 2` and `dw/w = 3/2 cot xi dxi`.
pub fn add_pitch_error(bin: &mut Bin, error_rad: f64) {
    let (sin, cos) = path_rad(bin).sin_cos();
    let sink = bin.mean.sink_m_s.abs();
    bin.sink_sd_m_s = bin.sink_sd_m_s.hypot(1.5 * sink * cos / sin * error_rad);
    bin.speed_sd_m_s = bin.speed_sd_m_s.hypot(0.5 * sink * cos / (sin * sin) * error_rad);
}

/// Time by which the path follows the pitch at each sample \[s\]: a hull that pitches at the rate `q` needs the lift `(m + M1) V q` to turn
/// its path, and so is behind by the angle of attack that carries it, `q (m + M1) / (rho V A (a + b) / 2)`. At the speed of the samples
/// about it: a glider that hangs near neutral for hours follows ten times as late there as elsewhere.
pub fn path_follows_s(parameters: &Parameters<f64>, samples: &[Observation]) -> Vec<f64> {
    let mass_kg = parameters.mass_kg() + parameters.added_mass_1_kg;
    let slope = parameters.a_per_rad + parameters.b;
    let (mut low, mut high) = (0, 0);
    let of_one = |i: usize| {
        let here = &samples[i];
        let is_far = |o: &Observation| o.leg != here.leg || (o.time_s - here.time_s).abs() > ABOUT_S;
        while is_far(&samples[low]) {
            low += 1;
        }
        high = high.max(i + 1);
        while samples.get(high).is_some_and(|o| !is_far(o)) {
            high += 1;
        }
        let sink_m_s = samples[low..high].iter().map(|o| o.sink_m_s.abs()).sum::<f64>() / (high - low) as f64;
        let speed_m_s = sink_m_s / (here.pitch_rad.abs() + USUAL_ANGLE_OF_ATTACK_RAD).sin();
        let force_kg_s = 0.5 * here.density_kg_m3 * parameters.frontal_area_m2 * slope * speed_m_s.max(SLOWEST_M_S);
        mass_kg / force_kg_s
    };
    (0..samples.len()).map(of_one).collect()
}

fn path_rad(bin: &Bin) -> f64 {
    bin.mean.pitch_rad.abs() + USUAL_ANGLE_OF_ATTACK_RAD
}

/// Drag by the measured vertical velocity.
fn drag_N(parameters: &Parameters<f64>, bin: &Bin) -> f64 {
    let speed = bin.mean.sink_m_s / path_rad(bin).sin();
    let size = 0.5 * bin.mean.density_kg_m3 * parameters.frontal_area_m2 * USUAL_DRAG_COEFFICIENT;
    (size * speed * speed).max(f64::MIN_POSITIVE)
}

/// The bins before and after one on the same leg, itself where there is none: what lies beyond a gap, as where the pump
/// ran, is another glide.
fn neighbours(bins: &[Bin], i: usize, reach_s: f64) -> (usize, usize) {
    let is_near = |other: usize| {
        let (here, there) = (&bins[i].mean, &bins[other].mean);
        here.leg == there.leg && (here.time_s - there.time_s).abs() <= reach_s
    };
    let low = if i > 0 && is_near(i - 1) { i - 1 } else { i };
    let high = if i + 1 < bins.len() && is_near(i + 1) { i + 1 } else { i };
    (low, high)
}

/// Longest time between neighbours \[s\]: one and a half times the median.
fn reach_s(bins: &[Bin]) -> f64 {
    1.5 * median_step_s(bins.iter().map(|bin| &bin.mean))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::Problem;
    use crate::diagnose::sea::SeaProblem;
    use crate::diagnose::sea::steady_log::SAMPLE;
    use crate::dynamics::PARAMETERS;

    fn observation(parameters: &Parameters<f64>) -> Observation {
        Observation {
            time_s: 100.0,
            pressure_dbar: 50.0,
            temperature_C: parameters.reference_temperature_C,
            density_kg_m3: 1025.0,
            teos10_density_kg_m3: 1025.0,
            teos10_surface_density_kg_m3: 1025.0,
            pitch_rad: -0.4,
            roll_rad: 0.1,
            rudder_rad: 0.1,
            ballast_m3: -2e-4,
            sink_m_s: 0.15,
            speed_m_s: 0.35,
            ..SAMPLE
        }
    }

    /// A mechanism is fitted by its slope wherever its parameter stands: with more directions than one pass has, each slope is
    /// that of the same parameter varied alone.
    #[test]
    fn slopes_do_not_depend_on_how_many_parameters_are_varied() {
        let vehicle = crate::vehicle::Vehicle::load("slocum-049").unwrap();
        let parameters = vehicle.glide_parameters();
        let mean = observation(&parameters);
        let bin = Bin { mean, first: 0, samples: 10, speeds: 10, sink_sd_m_s: 0.002, speed_sd_m_s: 0.03 };
        let rows: Vec<usize> = (0..PARAMETERS.len()).collect();
        assert!(rows.len() > WIDE, "the test needs more than one pass");
        let fly = |directions: &[usize], varied: &[usize]| {
            Vehicle::new(&parameters, &Directions::new(directions), varied).fly(&bin, &Inside::NOTHING)
        };
        let (sink, speed) = fly(&rows, &rows);
        assert!(sink.value.is_finite() && sink.value != 0.0 && sink.slopes.len() == rows.len());
        for row in rows.clone() {
            let (alone, speed_alone) = fly(&[row], &[0]);
            assert_eq!(sink.slopes[row], alone.slopes[0], "{}", PARAMETERS[row].name);
            assert_eq!(speed.slopes[row], speed_alone.slopes[0], "{}", PARAMETERS[row].name);
            // Alone among all directions.
            let (one, speed_one) = fly(&rows, &[row]);
            assert_eq!((one.value, speed_one.value), (sink.value, speed.value));
            for (among, all) in [(one, &sink), (speed_one, &speed)] {
                let expected = |place: usize| if place == row { all.slopes[row] } else { 0.0 };
                assert!(among.slopes.iter().enumerate().all(|(place, slope)| *slope == expected(place)));
            }
        }
        let moving = |name: &str| sink.slopes[parameter_index(name).unwrap()] != 0.0;
        assert!(moving("b") && moving("ballast_offset_kg"), "{sink:?}");
    }

    /// A glide whose pitch hunts, by Newton's and Kirchhoff's laws along the hull's axes:
    /// `(m + M1) v1' = F1 - (m + M3) q v3`, `(m + M3) v3' = F3 + (m + M1) q v1`.
    fn hunting(p: &Parameters<f64>, amplitude_rad: f64, period_s: f64) -> Vec<Observation> {
        let mean = observation(p);
        let net_kg = p.net_mass_kg(mean.ballast_m3, &crate::identify::surroundings(p, &mean));
        let [m1, m3] = [p.added_mass_1_kg, p.added_mass_3_kg].map(|added_kg| p.mass_kg() + added_kg);
        let per_s = std::f64::consts::TAU / period_s;
        let pitch_rad = |t: f64| mean.pitch_rad + amplitude_rad * (per_s * t).sin();
        let rates = |t: f64, [v1, v3]: [f64; 2]| {
            let (alpha, q) = (v3.atan2(v1), amplitude_rad * per_s * (per_s * t).cos());
            let force = 0.5 * mean.density_kg_m3 * (v1 * v1 + v3 * v3) * p.frontal_area_m2;
            let (lift, drag) = (force * p.a_per_rad * alpha, force * (p.b + p.c_per_rad2 * alpha * alpha));
            let (sin, cos) = pitch_rad(t).sin_cos();
            let f1 = -net_kg * p.gravity_m_s2 * sin + lift * alpha.sin() - drag * alpha.cos();
            let f3 = net_kg * p.gravity_m_s2 * cos - lift * alpha.cos() - drag * alpha.sin();
            [(f1 - m3 * q * v3) / m1, (f3 + m1 * q * v1) / m3]
        };
        let (mut v, h) = ([0.3, 0.01], 0.05);
        let mut log = Vec::new();
        for i in 0..80_000 {
            let t = h * f64::from(i) - 600.0;
            if i % 100 == 0 && t >= 0.0 {
                let sink_m_s = v[1] * pitch_rad(t).cos() - v[0] * pitch_rad(t).sin();
                let speed_m_s = v[0].hypot(v[1]);
                log.push(Observation { time_s: t, pitch_rad: pitch_rad(t), sink_m_s, speed_m_s, ..mean });
            }
            let half = [0, 1].map(|k| v[k] + 0.5 * h * rates(t, v)[k]);
            let there = rates(t + 0.5 * h, half);
            v = [0, 1].map(|k| v[k] + h * there[k]);
        }
        log
    }

    /// Where the pitch hunts, the model reads what the glider does to a hundredth of how the hunting moves it; also in a log of a glider
    /// that then hangs near neutral for three times as long, where its path would follow a minute late.
    #[test]
    fn a_path_follows_a_hunting_pitch_as_newtons_law_has_it() {
        let parameters = crate::vehicle::Vehicle::load("slocum-graver").unwrap().glide_parameters();
        for (amplitude_rad, period_s) in [(0.015, 240.0), (0.03, 900.0), (0.03, 300.0)] {
            let log = hunting(&parameters, amplitude_rad, period_s);
            let hanging = |i: usize| {
                let o = log[i % log.len()];
                Observation { time_s: 4600.0 + 5.0 * i as f64, sink_m_s: 0.005, leg: 1, ..o }
            };
            let hangs_later: Vec<Observation> = log.iter().copied().chain((0..3 * log.len()).map(hanging)).collect();
            for whole in [&log, &hangs_later] {
                let settings = crate::diagnose::sea::DiagnosisSettings::default();
                let problem = SeaProblem::new(whole, &parameters, settings).unwrap();
                let residual = problem.evidence(&problem.start()).residual;
                let n = (0..problem.n_bins()).take_while(|i| problem.bins[*i].mean.leg == 0).count();
                // What the first bins did before is a guess.
                let rms = |values: &mut dyn Iterator<Item = f64>| {
                    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), v| (sum + v * v, n + 1.0));
                    (sum / n).sqrt()
                };
                let left = rms(&mut (3..n).map(|i| residual[i]));
                let sinks = log.iter().map(|o| o.sink_m_s);
                let mean = sinks.clone().sum::<f64>() / log.len() as f64;
                let moved = rms(&mut sinks.map(|sink| sink - mean));
                assert!(left < 0.01 * moved, "{amplitude_rad} rad in {period_s} s: {left} of {moved} m/s");
            }
        }
    }

    /// A pitch that turns by half a radian in a minute is no steady glide; one that hunts by two degrees is.
    #[test]
    fn a_bin_that_turns_fast_is_not_steady() {
        let parameters = crate::vehicle::Vehicle::load("slocum-graver").unwrap().glide_parameters();
        let mean = observation(&parameters);
        let is_steady = |turned_rad: f64| {
            let at = |i: u32| Observation {
                time_s: 5.0 * f64::from(i),
                pitch_rad: mean.pitch_rad + turned_rad * (f64::from(i) / 11.0 - 0.5),
                ..mean
            };
            let samples: Vec<Observation> = (0..12).map(at).collect();
            let bin = Bin { mean, first: 0, samples: 12, speeds: 12, sink_sd_m_s: 0.002, speed_sd_m_s: 0.03 };
            steady(&parameters, &[bin], &samples)[0]
        };
        assert!(is_steady(0.0) && is_steady(0.03) && !is_steady(0.5) && !is_steady(-0.5));
    }
}
