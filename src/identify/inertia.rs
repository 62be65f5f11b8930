//! The inertia of a glide that is nearly steady, as a change of the weight that it hangs on.
//!
//! Across and along a path of steepness `s`, `L = m0 g cos s` and `D = m0 g sin s - M dV/dt`, with `M` the mass and its
//! added mass along axis 1. Lift and drag are those of a steady glide that hangs on another weight: with
//! `x = M V' / (m0 g)` it is `m0 hypot(cos s, sin s - x)`, turned by `atan2(sin s - x, cos s) - s`. `V'` is that of the model
//! along the leg: the measured one holds the water's own accelerations, which carry the glider along.
//!
//! The model's speed follows that of the steady glide, `Vs`, late: at drag as the square of the speed `M V' = Ds (1 - u^2)`
//! with `u = V/Vs`, so `V` relaxes to `Vs` in `tau = M Vs / ((1 + u) Ds)`, ten to thirty seconds. From sample to sample, `Vs` a
//! straight line between them, that has a closed form, which holds for water that changes slowly and for a thermocline that
//! is passed in a moment. The vertical velocity relaxes likewise; its rate is what a late pressure goes by.
//!
//! Knows one leg at a time; what is steady, and what a fit does with it, others decide.

use rayon::prelude::*;

use super::model::{Inertia, predict, surroundings, true_pitch_rad};
use crate::dynamics::Parameters;
use crate::glide::SteadyGlider;
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

/// Share of the steady speed below which no beginning is looked for: there the wing stalls.
const SLOWEST_BEGINNING: f64 = 0.4;

/// Samples that one thread takes at a time.
const ABREAST: usize = 256;

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
    // From one sample to another the rates of change of the steady glide, and the time between.
    let rates = |i: usize, j: usize| {
        let (a, b) = (observations.get(i)?, observations.get(j)?);
        let (from, to) = (steady[i].as_ref()?, steady[j].as_ref()?);
        let step_s = b.time_s - a.time_s;
        let goes_on = a.leg == b.leg && step_s > 0.0 && step_s <= gap_s;
        goes_on.then(|| ([0, 1].map(|q| (to.flown_m_s[q] - from.flown_m_s[q]) / step_s), step_s))
    };
    let mut late_m_s = [0.0; 2];
    let mut found = vec![Course { inertia: Inertia::NONE, steady_m_s: None }; observations.len()];
    for (i, found) in found.iter_mut().enumerate() {
        let Some(here) = &steady[i] else { continue };
        late_m_s = match rates(i.wrapping_sub(1), i) {
            Some((rates, step_s)) => here.follow(late_m_s, rates, step_s),
            None => {
                let until_s = observations[i].time_s + BEGINNING_S;
                let is_in =
                    |j: &usize| rates(j - 1, *j).is_some() && (*j == i + 1 || observations[*j].time_s <= until_s);
                let end = (i + 1..).take_while(is_in).last().unwrap_or(i);
                let beginning = steady[i..=end].iter().flatten().zip(&observations[i..=end]);
                let behind =
                    here.behind(beginning.map(|(steady, o)| (o.time_s - observations[i].time_s, steady.flown_m_s)));
                let is_in = |j: &usize| {
                    let goes_on = *j == i || rates(j - 1, *j).is_some();
                    goes_on && is_run_in(*j) && observations[*j].time_s <= observations[i].time_s + MEASURED_S
                };
                let measured: Vec<(&Steady, &Observation)> = (i..steady.len())
                    .take_while(is_in)
                    .filter_map(|j| Some((steady[j].as_ref()?, observations[j])))
                    .collect();
                begun_as_measured(behind, &measured)
            }
        };
        let inertia = here.inertia(observations[i].pitch_rad, late_m_s);
        *found = Course { inertia, steady_m_s: Some(here.flown_m_s) };
    }
    found
}

/// By how much a glider is behind at the first of these samples, so that it flies as fast as was measured on them: least squares over
/// the speeds that follow, from the given guess on.
fn begun_as_measured(guess: [f64; 2], samples: &[(&Steady, &Observation)]) -> [f64; 2] {
    let mut begin = guess;
    // What follows depends on the beginning nearly in proportion.
    for _ in 0..2 {
        let (mut late_m_s, mut left) = (begin, 1.0);
        let (mut moment, mut squares) = (0.0, 0.0);
        for (place, (steady, observed)) in samples.iter().enumerate() {
            if let Some((before, earlier)) = place.checked_sub(1).map(|before| samples[before]) {
                let step_s = observed.time_s - earlier.time_s;
                let rates = [0, 1].map(|q| (steady.flown_m_s[q] - before.flown_m_s[q]) / step_s);
                late_m_s = steady.follow(late_m_s, rates, step_s);
                left *= (-step_s / steady.slow_s).exp();
            }
            let Some(speed_m_s) = steady.speed_at(observed.sink_m_s) else { continue };
            moment += left * (steady.flown_m_s[1] - late_m_s[1] - speed_m_s);
            squares += left * left;
        }
        if squares == 0.0 {
            return guess;
        }
        let (first, _) = samples[0];
        let most = (1.0 - SLOWEST_BEGINNING) * first.flown_m_s[1];
        begin[1] = (begin[1] + moment / squares).clamp(-most, most);
        begin[0] = begin[1] * first.flown_m_s[0] / first.flown_m_s[1];
    }
    begin
}

/// The steady glide of a sample.
#[derive(Debug, Clone, Copy)]
struct Steady {
    /// Vertical velocity and speed \[m/s\].
    flown_m_s: [f64; 2],
    /// Steepness of the path \[rad\], and the angle of attack in it.
    steep_rad: f64,
    attack_rad: f64,
    /// Net mass \[kg\].
    net_kg: f64,
    /// The time in which a small difference of speed dies away \[s\].
    slow_s: f64,
}

fn steady(parameters: &Parameters<f64>, observations: &[&Observation]) -> Vec<Option<Steady>> {
    let glider = SteadyGlider::new(*parameters);
    let mass_kg = parameters.mass_kg() + parameters.added_mass_1_kg;
    let of_one = |guess: &mut Option<[f64; 2]>, observed: &Observation| {
        let found = predict(&glider, observed, &Inertia::NONE, *guess)?;
        *guess = Some(found.guess);
        let net_kg = parameters.net_mass_kg(observed.ballast_m3, &surroundings(parameters, observed));
        let pitch_rad = true_pitch_rad(parameters, observed.pitch_rad);
        let steep_rad = (pitch_rad - found.angle_of_attack_rad).abs();
        let attack_rad = steep_rad - pitch_rad.abs();
        let drag_N = net_kg.abs() * parameters.gravity_m_s2 * steep_rad.sin();
        let slow_s = mass_kg * found.speed_m_s / (2.0 * drag_N);
        let flown_m_s = [found.sink_m_s, found.speed_m_s];
        (slow_s > 0.0).then_some(Steady { flown_m_s, steep_rad, attack_rad, net_kg, slow_s })
    };
    // Each solution begins with that of the sample before, in groups of a fixed size: what is found depends on no number of threads.
    let of_group = |group: &[&Observation]| {
        let mut guess = None;
        group.iter().map(|observed| of_one(&mut guess, observed)).collect::<Vec<Option<Steady>>>()
    };
    observations.par_chunks(ABREAST).flat_map_iter(of_group).collect()
}

/// Where inertia is no small correction any more the glide is not steady, and the sample tells little. A trial of a fit may
/// put the path beyond the vertical.
const MOST_OF_DRAG: f64 = 0.5;

impl Steady {
    /// By how much a glider is behind this glide that has long been following a straight line through these ones, of which this
    /// is the first: times from now on \[s\], and velocities.
    fn behind(&self, flown: impl Iterator<Item = (f64, [f64; 2])> + Clone) -> [f64; 2] {
        let n = flown.clone().count() as f64;
        let mean_s = flown.clone().map(|(time_s, _)| time_s).sum::<f64>() / n;
        let spread_s2: f64 = flown.clone().map(|(time_s, _)| (time_s - mean_s).powi(2)).sum();
        [0, 1].map(|q| {
            let mean = flown.clone().map(|(_, flown_m_s)| flown_m_s[q]).sum::<f64>() / n;
            let moment: f64 = flown.clone().map(|(time_s, flown_m_s)| (time_s - mean_s) * flown_m_s[q]).sum();
            let rate = if spread_s2 > 0.0 { moment / spread_s2 } else { 0.0 };
            self.flown_m_s[q] - (mean - rate * mean_s - rate * self.slow_s)
        })
    }

    /// Speed of a glider at this pitch and weight that has this vertical velocity \[m/s\], within what is looked for: the lift of a slower
    /// one takes an angle of attack that grows with the squared ratio of the speeds. None without a vertical velocity.
    fn speed_at(&self, sink_m_s: f64) -> Option<f64> {
        let wanted = sink_m_s * self.flown_m_s[0].signum() / self.flown_m_s[1];
        let pitch_rad = self.steep_rad - self.attack_rad;
        let at = |share: f64| share * (pitch_rad + self.attack_rad / (share * share)).sin();
        let (mut low, mut high) = (SLOWEST_BEGINNING, 2.0 - SLOWEST_BEGINNING);
        for _ in 0..20 {
            let middle = 0.5 * (low + high);
            if at(middle) < wanted { low = middle } else { high = middle }
        }
        wanted.is_finite().then_some(0.5 * (low + high) * self.flown_m_s[1])
    }

    /// By how much the glider is behind this glide, `step_s` after it was `late_m_s` behind one from which velocities went here
    /// at these rates.
    fn follow(&self, late_m_s: [f64; 2], rates: [f64; 2], step_s: f64) -> [f64; 2] {
        let u = (1.0 - late_m_s[1] / self.flown_m_s[1]).clamp(0.0, 2.0);
        let slow_s = 2.0 * self.slow_s / (1.0 + u);
        let left = (-step_s / slow_s).exp();
        [0, 1].map(|q| rates[q] * slow_s + (late_m_s[q] - rates[q] * slow_s) * left)
    }

    /// What being late adds to the balance.
    fn inertia(&self, pitch_rad: f64, late_m_s: [f64; 2]) -> Inertia {
        let u = 1.0 - late_m_s[1] / self.flown_m_s[1];
        let most = MOST_OF_DRAG * self.steep_rad.sin().max(0.0);
        // M V' / (m0 g) with M V' = Ds (1 - u^2) and Ds = m0 g sin s.
        let x = ((1.0 - u * u) * self.steep_rad.sin()).clamp(-most, most);
        let (across, along) = (self.steep_rad.cos(), self.steep_rad.sin() - x);
        Inertia {
            net_mass_kg: self.net_kg * (across.hypot(along) - 1.0),
            pitch_rad: (along.atan2(across) - self.steep_rad) * pitch_rad.signum(),
            sink_rate_m_s2: late_m_s[0] / self.slow_s,
        }
    }
}

/// Median time from one sample to the next of its leg \[s\]; none where no two are on one leg.
pub fn median_step_s<'o>(observations: impl Iterator<Item = &'o Observation> + Clone) -> f64 {
    let pairs = observations.clone().zip(observations.skip(1));
    let mut steps: Vec<f64> = pairs.filter(|(a, b)| a.leg == b.leg).map(|(a, b)| b.time_s - a.time_s).collect();
    if steps.is_empty() { 0.0 } else { crate::log::median(&mut steps) }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{glider, sample};
    use super::*;

    /// A leg flown at a course of speeds and its rates: what it must have weighed by the balance of forces.
    ///
    /// L = m0 g cos s, D = m0 g sin s - M V' at a held path s: a alpha tan s = b + c alpha^2 + M V'/(q A), a quadratic.
    fn leg(p: &Parameters<f64>, step_s: f64, course: fn(f64) -> (f64, f64)) -> Vec<(Observation, f64)> {
        let path = -27f64.to_radians();
        let water = sample(p, -27.0, 0.3, 0, 0.0);
        let at = |i: i32| {
            let time_s = step_s * f64::from(i);
            let (speed_m_s, rate_m_s2) = course(time_s);
            let force = 0.5 * water.density_kg_m3 * speed_m_s * speed_m_s * p.frontal_area_m2;
            let mass_kg = p.mass_kg() + p.added_mass_1_kg;
            let (along, slope) = (p.b + mass_kg * rate_m_s2 / force, p.a_per_rad * path.abs().tan());
            let alpha = (slope - (slope * slope - 4.0 * p.c_per_rad2 * along).sqrt()) / (2.0 * p.c_per_rad2);
            let net_kg = force * p.a_per_rad * alpha / (p.gravity_m_s2 * path.cos());
            let sink_m_s = -speed_m_s * path.sin();
            let mut o = Observation { time_s, pitch_rad: path + alpha, sink_m_s, speed_m_s, ..water };
            let heavier_kg = net_kg - p.net_mass_kg(o.ballast_m3, &surroundings(p, &o));
            o.ballast_m3 -= heavier_kg / p.true_density_kg_m3(o.density_kg_m3);
            assert!((p.net_mass_kg(o.ballast_m3, &surroundings(p, &o)) - net_kg).abs() < 1e-9);
            (o, alpha)
        };
        (0..(800.0 / step_s) as i32).map(at).collect()
    }

    #[test]
    fn a_glide_that_changes_speed_is_the_balance_of_forces_written_out() {
        let (_, p) = glider();
        let glider = SteadyGlider::new(p);
        // Steadily slower, and slower through a thermocline that is passed in two minutes.
        let steadily = |t: f64| (0.3 - 1e-4 * t, -1e-4);
        let once = |t: f64| {
            let tanh = ((t - 400.0) / 60.0).tanh();
            (0.3 - 0.05 * tanh, -0.05 / 60.0 * (1.0 - tanh * tanh))
        };
        for (step_s, course) in [(5.0, steadily as fn(f64) -> (f64, f64)), (5.0, once), (50.0, steadily)] {
            let leg = leg(&p, step_s, course);
            let inertia = inertia(&p, leg.iter().map(|(o, _)| o));
            let (mut before, mut after) = ([0f64; 2], [0f64; 2]);
            for ((o, alpha), inertia) in leg.iter().zip(&inertia) {
                for (inertia, most) in [(&Inertia::NONE, &mut before), (inertia, &mut after)] {
                    let found = predict(&glider, o, inertia, None).unwrap();
                    let errors = [found.speed_m_s - o.speed_m_s, found.sink_m_s - o.sink_m_s];
                    most.iter_mut().zip(errors).for_each(|(most, error)| *most = most.max(error.abs()));
                    assert!(*inertia == Inertia::NONE || (found.angle_of_attack_rad - alpha).abs() < 2e-4);
                }
            }
            // Nothing is left but the difference between V' of the glide and that of the model's.
            assert!(before[0] > 1e-3 && (0..2).all(|i| after[i] < 0.01 * before[i]), "{before:?} {after:?}");
        }
    }

    /// After a turn a glider is slow, whatever the water and the ballast do: how slow it began is measured.
    #[test]
    fn a_glider_that_begins_slowly_is_followed_from_its_measured_speed() {
        let (_, p) = glider();
        let glider = SteadyGlider::new(p);
        let leg = leg(&p, 5.0, |t| {
            let behind = 0.12 * (-t / 40.0).exp();
            (0.3 - behind, behind / 40.0)
        });
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

    /// A thermocline of some metres: the mean over a minute is not the glide at the minute's mean.
    #[test]
    fn a_bin_in_which_the_speed_changes_is_the_mean_of_what_happened_in_it() {
        let (_, p) = glider();
        let glider = SteadyGlider::new(p);
        let leg = leg(&p, 5.0, |t| {
            let tanh = ((t - 390.0) / 15.0).tanh();
            (0.3 - 0.06 * tanh, -0.06 / 15.0 * (1.0 - tanh * tanh))
        });
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
}
