//! The inertia of a glide that is nearly steady, as a change of the weight that it hangs on.
//!
//! Along and across a path of steepness `s`, on which the speed `V` and the angle of attack `alpha` change,
//! ```text
//! D = m0 g (sin s - x),    m0 g x = (M1 cos^2 + M3 sin^2) V' + (M3 - M1) sin cos V alpha'      sin, cos: of alpha
//! L = m0 g (cos s - y),    m0 g y = (M3 - M1) sin cos V' + (M1 sin^2 + M3 cos^2) V alpha'
//! ```
//! with `M1` and `M3` the mass and its added mass along and across the hull. Lift and drag are those of a steady glide that
//! hangs on `m0 hypot(cos s - y, sin s - x)`, turned by `atan2(sin s - x, cos s - y) - s`. The accelerations are those of the
//! model along the leg: the measured ones hold the water's own, which carry the glider along.
//!
//! The model's speed lags that of the steady glide (`constant_pitch`). The vertical velocity follows from the speed and
//! the pitch; a late pressure sensor reads it through a first-order lag.
//!
//! Knows one leg at a time; what is steady, and what a fit does with it, others decide.

use super::constant_pitch::{SLOWEST_BEGINNING, Steady, steady};
use super::model::Inertia;
use crate::dynamics::Parameters;
use crate::log::Observation;

/// A step longer than this, and than one and a half median ones, is a gap \[s\]: what lies beyond it, as where the pump ran, is
/// another glide.
const GAP_S: f64 = 60.0;

/// Where a stretch begins, the glider has been following a straight line through what comes in this time, the next sample at
/// least \[s\]: single samples have the noise of the pitch in them.
const BEGINNING_S: f64 = 30.0;

/// Where a stretch begins before the first sample that counts, as after a turn, the measured vertical velocity in this time says how
/// fast it began \[s\]: enough to average waves, and two or three times what a difference of speed takes to die away.
const MEASURED_S: f64 = 60.0;

/// The inertia of each sample at these parameters; none where no glide exists or the sample is alone.
pub fn inertia<'o>(
    parameters: &Parameters<f64>,
    observations: impl IntoIterator<Item = &'o Observation>,
) -> Vec<Inertia> {
    let observations: Vec<&Observation> = observations.into_iter().collect();
    let gap_s = gap_s(observations.iter().copied());
    courses(parameters, gap_s, observations, |_| false).into_iter().map(|course| course.inertia).collect()
}

/// A sample among those of its leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Course {
    /// The inertia there; none where no glide exists or the sample is alone.
    pub(super) inertia: Inertia,
    /// The same if forces balanced.
    pub(super) at_rest: Inertia,
    /// Vertical velocity and speed if forces balanced \[m/s\], where a glide exists.
    pub(super) steady_m_s: Option<[f64; 2]>,
}

/// A step between these observations beyond which another glide begins \[s\].
pub(super) fn gap_s<'o>(observations: impl Iterator<Item = &'o Observation> + Clone) -> f64 {
    GAP_S.max(1.5 * median_step_s(observations))
}

/// Each sample's inertia and steady glide, where a step longer than this is a gap \[s\]. What is measured in samples that count
/// for nothing else, by their places, may say how a stretch begins.
pub(super) fn courses<'o>(
    parameters: &Parameters<f64>,
    gap_s: f64,
    observations: impl IntoIterator<Item = &'o Observation>,
    is_run_in: impl Fn(usize) -> bool,
) -> Vec<Course> {
    let observations: Vec<&Observation> = observations.into_iter().collect();
    let steady = steady(parameters, &observations);
    // From one sample to another the rate of change of the steady speed, and the time between.
    let rate = |i: usize, j: usize| {
        let (a, b) = (observations.get(i)?, observations.get(j)?);
        let (from, to) = (steady[i].as_ref()?, steady[j].as_ref()?);
        let step_s = b.time_s - a.time_s;
        let goes_on = a.leg == b.leg && step_s > 0.0 && step_s <= gap_s;
        goes_on.then(|| ((to.speed_m_s - from.speed_m_s) / step_s, step_s))
    };
    // What a late sensor reads is behind by its lag.
    let true_sink_m_s = |j: usize| {
        let read_m_s = |j: usize| observations[j].sink_m_s;
        let [before, after] =
            [j.saturating_sub(1), j + 1].map(|k| if rate(k.min(j), k.max(j)).is_some() { k } else { j });
        let over_s = observations[after].time_s - observations[before].time_s;
        let slope = if over_s > 0.0 { (read_m_s(after) - read_m_s(before)) / over_s } else { 0.0 };
        read_m_s(j) + parameters.pressure_lag_s * slope
    };
    let mut late_m_s = 0.0;
    let nothing = Course { inertia: Inertia::NONE, at_rest: Inertia::NONE, steady_m_s: None };
    let mut found = vec![nothing; observations.len()];
    let mut sink_m_s = vec![f64::NAN; observations.len()];
    for (i, found) in found.iter_mut().enumerate() {
        let Some(here) = &steady[i] else { continue };
        late_m_s = match rate(i.wrapping_sub(1), i) {
            Some((rate, step_s)) => here.follow(late_m_s, rate, step_s),
            None => {
                let until_s = observations[i].time_s + BEGINNING_S;
                let is_in =
                    |j: &usize| rate(j - 1, *j).is_some() && (*j == i + 1 || observations[*j].time_s <= until_s);
                let end = (i + 1..).take_while(is_in).last().unwrap_or(i);
                let beginning = steady[i..=end].iter().flatten().zip(&observations[i..=end]);
                let behind =
                    here.behind(beginning.map(|(steady, o)| (o.time_s - observations[i].time_s, steady.speed_m_s)));
                let is_in = |j: &usize| {
                    let goes_on = *j == i || rate(j - 1, *j).is_some();
                    goes_on && is_run_in(*j) && observations[*j].time_s <= observations[i].time_s + MEASURED_S
                };
                let measured: Vec<(&Steady, f64, f64)> = (i..steady.len())
                    .take_while(is_in)
                    .filter_map(|j| Some((steady[j].as_ref()?, observations[j].time_s, true_sink_m_s(j))))
                    .collect();
                begun_as_measured(behind, &measured)
            }
        };
        // By the weight alone: from sample to sample the pitch has its noise.
        let growth_per_s = |i: usize, j: usize| {
            let (_, step_s) = rate(i, j)?;
            let (from, to) = (steady[i].as_ref()?, steady[j].as_ref()?);
            Some(0.5 * (to.net_kg / from.net_kg).abs().ln() / step_s)
        };
        let growth_per_s = growth_per_s(i.wrapping_sub(1), i).or_else(|| growth_per_s(i, i + 1)).unwrap_or(0.0);
        let inertia = here.inertia(observations[i].pitch_rad, late_m_s, growth_per_s);
        *found = Course { inertia, at_rest: Inertia::NONE, steady_m_s: Some([here.sink_m_s, here.speed_m_s]) };
        sink_m_s[i] = here.sink_m_s * here.sink_at(here.share(late_m_s));
    }
    let time_s: Vec<f64> = observations.iter().map(|o| o.time_s).collect();
    let goes_on = |i: usize, j: usize| rate(i, j).is_some();
    let read_m_s = |i: usize| is_run_in(i).then(|| observations[i].sink_m_s);
    let late = rates_read(parameters.pressure_lag_s, &time_s, &sink_m_s, goes_on, read_m_s);
    let steady_m_s: Vec<f64> = steady.iter().map(|steady| steady.map_or(f64::NAN, |steady| steady.sink_m_s)).collect();
    let at_rest = rates_read(parameters.pressure_lag_s, &time_s, &steady_m_s, goes_on, read_m_s);
    for (found, (late, at_rest)) in found.iter_mut().zip(late.into_iter().zip(at_rest)) {
        (found.inertia.sink_rate_m_s2, found.at_rest.sink_rate_m_s2) = (late, at_rest);
        if let Some([sink_m_s, _]) = &mut found.steady_m_s {
            *sink_m_s -= parameters.pressure_lag_s * at_rest;
        }
    }
    found
}

/// Rates of the vertical velocity that a sensor reads which follows the true one as a first-order lag \[m/s2\]: what is read is the
/// true one less the lag times this. A stretch begins so that it reads what was `read_m_s` in the samples before the first that counts,
/// as after a turn; without any, as if it had long been going along its first straight line.
fn rates_read(
    lag_s: f64,
    time_s: &[f64],
    sink_m_s: &[f64],
    goes_on: impl Fn(usize, usize) -> bool,
    read_m_s: impl Fn(usize) -> Option<f64>,
) -> Vec<f64> {
    let slope = |i: usize, j: usize| (sink_m_s[j] - sink_m_s[i]) / (time_s[j] - time_s[i]);
    // What is left of being behind at one sample when the next comes, and how far behind the line between them leaves it.
    let follow = |late_m_s: f64, i: usize| {
        let behind_m_s = lag_s * slope(i - 1, i);
        behind_m_s + (late_m_s - behind_m_s) * (-(time_s[i] - time_s[i - 1]) / lag_s.abs()).exp()
    };
    let begin = |i: usize| {
        // From no lag behind at all, what is read says how far behind it began: least squares of what has not died away.
        let (mut late_m_s, mut moment, mut squares) = (0.0, 0.0, 0.0);
        for j in i..time_s.len() {
            if j > i {
                if !goes_on(j - 1, j) {
                    break;
                }
                late_m_s = follow(late_m_s, j);
            }
            let Some(read_m_s) = read_m_s(j) else { break };
            let left = (-(time_s[j] - time_s[i]) / lag_s.abs()).exp();
            moment += left * (sink_m_s[j] - read_m_s - late_m_s);
            squares += left * left;
        }
        let begins_m_s = moment / squares;
        if begins_m_s.is_finite() { begins_m_s } else { lag_s * slope(i, i + 1) }
    };
    let mut late_m_s = 0.0;
    let of_one = |i: usize| {
        let (begins, ends) = (i == 0 || !goes_on(i - 1, i), !goes_on(i, i + 1));
        if lag_s == 0.0 {
            return match (begins, ends) {
                (true, true) => 0.0,
                (true, false) => slope(i, i + 1),
                (false, true) => slope(i - 1, i),
                (false, false) => slope(i - 1, i + 1),
            };
        }
        late_m_s = match (begins, ends) {
            (true, true) => 0.0,
            (true, false) => begin(i),
            (false, _) => follow(late_m_s, i),
        };
        late_m_s / lag_s
    };
    (0..time_s.len()).map(of_one).collect()
}

/// By how much a glider is behind at the first of these samples, each with its time and measured vertical velocity, so that it flies as fast as was measured on them: least squares over
/// the speeds that follow, from the given guess on.
fn begun_as_measured(guess_m_s: f64, samples: &[(&Steady, f64, f64)]) -> f64 {
    let measured: Vec<Option<f64>> = samples.iter().map(|(steady, _, sink_m_s)| steady.speed_at(*sink_m_s)).collect();
    let mut begin_m_s = guess_m_s;
    // What follows depends on the beginning nearly in proportion.
    for _ in 0..2 {
        let (mut late_m_s, mut left) = (begin_m_s, 1.0);
        let (mut moment, mut squares) = (0.0, 0.0);
        for (place, (steady, time_s, _)) in samples.iter().enumerate() {
            if let Some((before, earlier_s, _)) = place.checked_sub(1).map(|before| samples[before]) {
                let step_s = time_s - earlier_s;
                let rate = (steady.speed_m_s - before.speed_m_s) / step_s;
                late_m_s = steady.follow(late_m_s, rate, step_s);
                left *= (-step_s / steady.slow_s(1.0)).exp();
            }
            let Some(speed_m_s) = measured[place] else { continue };
            moment += left * (steady.speed_m_s - late_m_s - speed_m_s);
            squares += left * left;
        }
        if squares == 0.0 {
            return guess_m_s;
        }
        let (first, _, _) = samples[0];
        let most = (1.0 - SLOWEST_BEGINNING) * first.speed_m_s;
        begin_m_s = (begin_m_s + moment / squares).clamp(-most, most);
    }
    begin_m_s
}

/// Median time from one sample to the next of its leg \[s\]; none where no two are on one leg.
pub fn median_step_s<'o>(observations: impl Iterator<Item = &'o Observation> + Clone) -> f64 {
    let pairs = observations.clone().zip(observations.skip(1));
    let mut steps: Vec<f64> = pairs.filter(|(a, b)| a.leg == b.leg).map(|(a, b)| b.time_s - a.time_s).collect();
    if steps.is_empty() { 0.0 } else { crate::log::median(&mut steps) }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::model::{predict, surroundings};
    use super::super::tests::{glider, sample};
    use super::*;
    use crate::glide::SteadyGlider;

    /// A first-order lag of a ramp that has long been going on is late by the lag; of a hunting, `1/sqrt(1 + (w tau)^2)` of it is left,
    /// `atan(w tau)` late.
    #[test]
    fn what_a_late_sensor_reads_is_the_closed_form_of_a_first_order_lag() {
        let lag_s = 20.0;
        let time_s: Vec<f64> = (0..600).map(|i| 2.0 * f64::from(i)).collect();
        let goes_on = |i: usize, j: usize| j < 600 && i < j;
        let read = |sink: &[f64]| -> Vec<f64> {
            let rates = rates_read(lag_s, &time_s, sink, goes_on, |_| None);
            sink.iter().zip(rates).map(|(sink, rate)| sink - lag_s * rate).collect()
        };
        let ramp: Vec<f64> = time_s.iter().map(|t| 0.1 + 1e-4 * t).collect();
        for (i, read) in read(&ramp).iter().enumerate() {
            assert!((read - (ramp[i] - 1e-4 * lag_s)).abs() < 1e-12, "{i}: {read}");
        }
        let per_s = std::f64::consts::TAU / 120.0;
        let hunting: Vec<f64> = time_s.iter().map(|t| 0.01 * (per_s * t).sin()).collect();
        let (left, late_rad) = (1.0 / 1.0f64.hypot(per_s * lag_s), (per_s * lag_s).atan());
        // Ten lags on, nothing of the beginning is left.
        for (t, read) in time_s.iter().zip(read(&hunting)).filter(|(t, _)| **t > 200.0) {
            let expected = 0.01 * left * (per_s * t - late_rad).sin();
            assert!((read - expected).abs() < 2e-5, "{t} s: {read} against {expected}");
        }
        // After a turn it still reads the other leg: what it read in the first minute says how far behind it began.
        let sinks = vec![0.1; 600];
        let turned = |t: f64| 0.1 - 0.2 * (-(t + 10.0) / lag_s).exp();
        let rates = rates_read(lag_s, &time_s, &sinks, goes_on, |i| (i < 30).then(|| turned(time_s[i])));
        for (t, rate) in time_s.iter().zip(rates) {
            assert!((0.1 - lag_s * rate - turned(*t)).abs() < 1e-12, "{t} s");
        }
        // Without a lag the rate is that of the velocity itself.
        let rates = rates_read(0.0, &time_s, &hunting, goes_on, |_| None);
        for (t, rate) in time_s.iter().zip(rates).skip(1).take(598) {
            assert!((rate - 0.01 * per_s * (per_s * t).cos()).abs() < 2e-6, "{t} s: {rate}");
        }
    }

    /// Rates of the velocities along the axes 1 and 3 at a held pitch by Newton's law, `CL = a alpha + n alpha |alpha|` and
    /// `CD = b (q/q0)^e + c alpha^2` with `q0` at 0.3 m/s.
    fn newton(p: &Parameters<f64>, pitch_rad: f64, net_kg: f64, density_kg_m3: f64, [v1, v3]: [f64; 2]) -> [f64; 2] {
        let alpha = v3.atan2(v1);
        let force = 0.5 * density_kg_m3 * (v1 * v1 + v3 * v3) * p.frontal_area_m2;
        let lift = force * (p.a_per_rad * alpha + p.nonlinear_lift_per_rad2 * alpha * alpha.abs());
        let reference = p.reference_density_kg_m3 * 0.3 * 0.3;
        let b = p.b * (density_kg_m3 * (v1 * v1 + v3 * v3) / reference).powf(p.drag_exponent);
        let drag = force * (b + p.c_per_rad2 * alpha * alpha);
        let along = -net_kg * p.gravity_m_s2 * pitch_rad.sin() + lift * alpha.sin() - drag * alpha.cos();
        let across = net_kg * p.gravity_m_s2 * pitch_rad.cos() - lift * alpha.cos() - drag * alpha.sin();
        [along / (p.mass_kg() + p.added_mass_1_kg), across / (p.mass_kg() + p.added_mass_3_kg)]
    }

    /// A dive at a held pitch with this course of the net mass over that of a steady glide at 0.3 m/s, begun at this share of
    /// the steady speed with the wing carrying the weight: what was flown, and the angle of attack.
    pub(in crate::identify) fn leg(
        p: &Parameters<f64>,
        step_s: f64,
        begin: f64,
        course: fn(f64) -> f64,
    ) -> Vec<(Observation, f64)> {
        let steady = sample(p, -27.0, 0.3, 0, 0.0);
        let pitch_rad = steady.pitch_rad;
        let steady_kg = p.net_mass_kg(steady.ballast_m3, &surroundings(p, &steady));
        let alpha = (pitch_rad + 27f64.to_radians()) / (begin * begin);
        let mut v = [begin * 0.3 * alpha.cos(), begin * 0.3 * alpha.sin()];
        const SUBSTEPS: i32 = 200;
        let h = step_s / f64::from(SUBSTEPS);
        let mut found = Vec::new();
        for i in 0..(800.0 / step_s) as i32 {
            let time_s = step_s * f64::from(i);
            let mut o = Observation { time_s, speed_m_s: v[0].hypot(v[1]), ..steady };
            o.sink_m_s = v[1] * pitch_rad.cos() - v[0] * pitch_rad.sin();
            o.ballast_m3 -= steady_kg * (course(time_s) - 1.0) / p.true_density_kg_m3(o.density_kg_m3);
            found.push((o, v[1].atan2(v[0])));
            for j in 0..SUBSTEPS {
                let at = |t: f64, v: [f64; 2]| newton(p, pitch_rad, steady_kg * course(t), o.density_kg_m3, v);
                let on = |v: [f64; 2], k: [f64; 2], h: f64| [v[0] + h * k[0], v[1] + h * k[1]];
                let t = time_s + h * f64::from(j);
                let k1 = at(t, v);
                let k2 = at(t + 0.5 * h, on(v, k1, 0.5 * h));
                let k3 = at(t + 0.5 * h, on(v, k2, 0.5 * h));
                let k4 = at(t + h, on(v, k3, h));
                v = [0, 1].map(|q| v[q] + h / 6.0 * (k1[q] + 2.0 * k2[q] + 2.0 * k3[q] + k4[q]));
            }
        }
        found
    }

    /// A glider with a large wing, and one whose lift slope is no larger than `c`, at 6 deg of angle of attack; drag that falls with
    /// speed, and lift that grows faster than its angle.
    fn gliders() -> [Parameters<f64>; 4] {
        let (_, large) = glider();
        let small = Parameters { a_per_rad: 4.5, b: 0.18, c_per_rad2: 6.2, ..large };
        let falling = Parameters { drag_exponent: -0.35, ..large };
        let crossflow = Parameters { a_per_rad: 3.0, nonlinear_lift_per_rad2: 20.0, ..small };
        [large, small, falling, crossflow]
    }

    #[test]
    fn a_glide_that_changes_speed_is_the_balance_of_forces_written_out() {
        // Steadily lighter, and lighter through a thermocline that is passed in two minutes.
        let steadily = |t: f64| 1.0 - 5e-4 * t;
        let once = |t: f64| 0.85 - 0.15 * ((t - 400.0) / 60.0).tanh();
        // What is left of the error: what the path turns as its steepness goes with the weight is not in the balance.
        for (p, most_left) in gliders().into_iter().zip([0.01, 0.1, 0.01, 0.1]) {
            let glider = SteadyGlider::new(p);
            for (step_s, course) in [(5.0, steadily as fn(f64) -> f64), (5.0, once), (50.0, steadily)] {
                let leg = leg(&p, step_s, 1.0, course);
                let inertia = inertia(&p, leg.iter().map(|(o, _)| o));
                let (mut before, mut after) = ([0f64; 3], [0f64; 3]);
                // The beginning follows from a guess.
                for ((o, alpha), inertia) in leg.iter().zip(&inertia).filter(|((o, _), _)| o.time_s >= 100.0) {
                    for (inertia, most) in [(&Inertia::NONE, &mut before), (inertia, &mut after)] {
                        let found = predict(&glider, o, inertia, None).unwrap();
                        let turned_rad = found.angle_of_attack_rad - alpha;
                        let errors = [found.speed_m_s - o.speed_m_s, found.sink_m_s - o.sink_m_s, turned_rad];
                        most.iter_mut().zip(errors).for_each(|(most, error)| *most = most.max(error.abs()));
                    }
                }
                assert!(before[0] > 1e-3 && (0..3).all(|i| after[i] < most_left * before[i]), "{before:?} {after:?}");
            }
        }
    }

    /// After a turn a glider is slow, whatever the water and the ballast do: how slow it began is measured.
    #[test]
    fn a_glider_that_begins_slowly_is_followed_from_its_measured_speed() {
        for p in gliders() {
            let glider = SteadyGlider::new(p);
            let leg = leg(&p, 5.0, 0.6, |_| 1.0);
            let samples: Vec<&Observation> = leg.iter().map(|(o, _)| o).collect();
            // The first half minute is no bin; the two minutes behind it are looked at.
            let error_m_s = |is_run_in: fn(usize) -> bool| {
                let courses = courses(&p, GAP_S, samples.iter().copied(), is_run_in);
                let of_one = |i: usize| {
                    let flown = predict(&glider, samples[i], &courses[i].inertia, None).unwrap();
                    (flown.speed_m_s - samples[i].speed_m_s).abs()
                };
                (6..30).map(of_one).fold(0.0, f64::max)
            };
            let (guessed, measured) = (error_m_s(|_| false), error_m_s(|i| i < 6));
            assert!(guessed > 1e-3 && measured < 0.25 * guessed, "{guessed} {measured}");
        }
    }

    /// A thermocline of some metres: the mean over a minute is not the glide at the minute's mean.
    #[test]
    fn a_bin_in_which_the_speed_changes_is_the_mean_of_what_happened_in_it() {
        let (_, p) = glider();
        let glider = SteadyGlider::new(p);
        let leg = leg(&p, 5.0, 1.0, |t| 0.75 - 0.25 * ((t - 390.0) / 15.0).tanh());
        let samples: Vec<Observation> = leg.into_iter().map(|(o, _)| o).collect();
        let bins = super::super::bins(&samples, usize::MAX, 1);
        let inside = super::super::Parts::new(&bins, &samples, &samples).inside(&p, &bins);
        let means: Vec<&Observation> = bins.iter().map(|bin| &bin.mean).collect();
        let (mut before, mut after) = (0f64, 0f64);
        for ((bin, inside), of_means) in bins.iter().zip(&inside).zip(inertia(&p, means)) {
            let sink = |found: Option<super::super::Prediction<f64>>| found.unwrap().sink_m_s - bin.mean.sink_m_s;
            before = before.max(sink(predict(&glider, &bin.mean, &of_means, None)).abs());
            after = after.max(sink(inside.predict(&glider, bin, None)).abs());
        }
        assert!(before > 2e-3 && after < 0.25 * before, "{before} {after}");
    }

    /// Rows at which a motor moves are in no bin, and the glider gathers speed in them all the same.
    #[test]
    fn rows_left_out_inside_a_bin_are_flown_through() {
        let (_, p) = glider();
        let leg = leg(&p, 5.0, 1.0, |t| 0.75 - 0.25 * ((t - 380.0) / 4.0).tanh());
        let log: Vec<Observation> = leg.into_iter().map(|(o, _)| o).collect();
        let is_moving = |o: &&Observation| (370.0..=395.0).contains(&o.time_s);
        let steady: Vec<Observation> = log.iter().filter(|o| !is_moving(o)).copied().collect();
        let bins = super::super::bins(&steady, usize::MAX, 1);
        let error_m_s = |log: &[Observation]| {
            let inside = super::super::Parts::new(&bins, &steady, log).inside(&p, &bins);
            let errors = bins.iter().zip(&inside).map(|(bin, inside)| {
                (inside.predict(&SteadyGlider::new(p), bin, None).unwrap().sink_m_s - bin.mean.sink_m_s).abs()
            });
            errors.fold(0.0, f64::max)
        };
        let (left_out, flown) = (error_m_s(&steady), error_m_s(&log));
        assert!(left_out > 1e-3 && flown < 0.25 * left_out, "{left_out} {flown}");
    }
}
