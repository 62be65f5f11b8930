//! What happens inside a bin and does not show in its mean.
//!
//! A glider that passes a thermocline of some metres has another speed some ten seconds later, and a mean of speeds is not the
//! speed at the mean net mass, with which it goes as a square root. So a bin in which the water changes is flown in shorter
//! parts at the present parameters: their inertia, averaged, is the bin's, and what their mean velocity is beside that of the
//! mean is added to it. Slopes are those at the mean.
//!
//! A speed that was measured on some of the samples only is compared at those: the model's speed there, each from what was
//! read some seconds around it, beside the speed at the bin's mean.
//!
//! Left out, it makes a summer's thermocline on a shelf pass for a hull that expands (docs/theory/identification.md has the figures).

use std::ops::Range;

use rayon::prelude::*;

use super::bins::{Bin, mean};
use super::inertia::{Course, courses, gap_s};
use super::model::{Inertia, Prediction, predict};
use crate::Number;
use crate::dynamics::Parameters;
use crate::glide::SteadyGlider;
use crate::log::{DBAR_PA, Observation};

/// Length of a part \[s\], of longer bins the twelfth: what a log of long bins meets, it meets slowly.
const PART_S: f64 = 5.0;
const MOST_PARTS: f64 = 12.0;

/// Range of density below which a bin is one part \[kg/m3\]: five grams of a glider's volume, a few hundredths of what it hangs on.
const EVEN_KG_M3: f64 = 0.1;

/// The same of the ballast \[m3\].
const EVEN_M3: f64 = 5e-6;

/// The same of the pitch \[rad\]: at 25 deg it changes the steady speed by one part in a hundred.
const EVEN_RAD: f64 = 0.01;

/// Length of a part in which the pitch alone changes \[s\]: about the time in which a glider's speed follows.
const TURNING_PART_S: f64 = 15.0;

/// Compressibility of a usual hull, which feels that much less of what pressure does to density \[1/Pa\].
const USUAL_COMPRESSIBILITY_PER_PA: f64 = 4e-10;

/// What is read within this time of a measured speed is the glide at its time \[s\]: less than the 10 to 30 s in which a
/// glider's speed follows, so that what follows is not smoothed once more, and several samples of a pitch that has noise.
const AROUND_S: f64 = 7.5;

/// What is to be known of a bin beside its mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inside {
    /// The inertia of the mean.
    pub inertia: Inertia,
    /// What the mean downward velocity of the parts is beside that of the mean \[m/s\].
    pub sink_m_s: f64,
    /// The same of the speed, at the times of the samples that have a measured one \[m/s\].
    pub speed_m_s: f64,
    /// Where the solution at the mean may start.
    pub guess: Option<[f64; 2]>,
}

impl Inside {
    /// Of a bin in which nothing happens.
    pub const NOTHING: Inside = Inside { inertia: Inertia::NONE, sink_m_s: 0.0, speed_m_s: 0.0, guess: None };

    /// What the instruments should have read on average over the bin; nothing where the glider cannot glide at all.
    pub fn predict<T: Number>(
        &self,
        glider: &SteadyGlider<T>,
        bin: &Bin,
        guess: Option<[f64; 2]>,
    ) -> Option<Prediction<T>> {
        let at_mean = predict(glider, &bin.mean, &self.inertia, guess.or(self.guess))?;
        Some(Prediction {
            sink_m_s: at_mean.sink_m_s + self.sink_m_s,
            speed_m_s: at_mean.speed_m_s + self.speed_m_s,
            ..at_mean
        })
    }
}

/// Bins that one thread takes at a time.
const ABREAST: usize = 64;

/// How far before a stretch of steady glide its speed is followed \[s\]: what it was behind then has decayed to a thousandth
/// with the 10 to 85 s in which a glider's speed follows, the longest of them gliders of little drag near neutral.
const RUN_IN_S: f64 = 600.0;

/// Bins in shorter parts.
#[derive(Debug, Clone, Default)]
pub struct Parts {
    /// In the order of time, between those of the bins the samples that are in no bin, as far as the speed remembers them.
    means: Vec<Observation>,
    /// How many samples of its bin each is the mean of; zero of those that are in no bin.
    samples: Vec<f64>,
    /// First and last part of each bin. Samples that are in no bin may lie between, as where a motor moved.
    of_bin: Vec<Range<usize>>,
    /// A step between parts that is longer is a gap \[s\].
    gap_s: f64,
    /// Where a speed was measured, of the bins in which not every sample has one.
    at_speeds: Vec<AtSpeeds>,
    at_speeds_of_bin: Vec<Range<usize>>,
    /// Whether forces balance at every moment.
    quasi_steady: bool,
}

/// The glide around some measured speeds that follow one another.
#[derive(Debug, Clone)]
struct AtSpeeds {
    mean: Observation,
    /// How many speeds they are.
    speeds: f64,
    /// The part whose inertia it has.
    part: usize,
}

impl Parts {
    /// The parts of bins that were made of these samples, which were chosen among those of the `log`.
    pub fn new(bins: &[Bin], samples: &[Observation], log: &[Observation]) -> Parts {
        let mut parts = Parts { gap_s: gap_s(bins.iter().map(|bin| &bin.mean)), ..Parts::default() };
        let mut binned_s = f64::NEG_INFINITY;
        for bin in bins {
            let of_bin = &samples[bin.first..bin.first + bin.samples];
            parts.run_in(log, binned_s, &of_bin[0]);
            let begun = parts.means.len();
            let is_even = range(of_bin.iter().map(felt_density_kg_m3)) < EVEN_KG_M3
                && range(of_bin.iter().map(|o| o.ballast_m3)) < EVEN_M3;
            let short_s = PART_S.max(lasts_s(of_bin) / MOST_PARTS);
            let part_s = match is_even {
                false => short_s,
                true if turns_by_rad(of_bin) < EVEN_RAD => f64::INFINITY,
                true => TURNING_PART_S.max(lasts_s(of_bin) / MOST_PARTS),
            };
            for piece in of_bin.chunk_by(|a, b| follows(log, a, b)) {
                if parts.means.len() > begun {
                    parts.run_in(log, binned_s, &piece[0]);
                }
                for part in even_parts(piece, part_s) {
                    parts.means.push(mean(part));
                    parts.samples.push(part.len() as f64);
                }
                binned_s = piece[piece.len() - 1].time_s;
            }
            parts.of_bin.push(begun..parts.means.len());
            let with_speed = parts.at_speeds.len();
            if (1..of_bin.len()).contains(&bin.speeds) {
                parts.look_at_speeds(of_bin, begun, short_s);
            }
            parts.at_speeds_of_bin.push(with_speed..parts.at_speeds.len());
        }
        parts
    }

    /// Takes the samples of the leg since the last that is in a bin, whose speed the next one begins with.
    fn run_in(&mut self, log: &[Observation], since_s: f64, next: &Observation) {
        let since_s = since_s.max(next.time_s - RUN_IN_S);
        let begin = log.partition_point(|o| o.time_s <= since_s);
        let end = log.partition_point(|o| o.time_s < next.time_s);
        let before: Vec<Observation> =
            log[begin.min(end)..end].iter().filter(|o| o.leg == next.leg && is_complete(o)).copied().collect();
        let mut start = 0;
        for end in 1..=before.len() {
            if end == before.len() || before[end].time_s - before[start].time_s >= PART_S {
                self.means.push(mean(&before[start..end]));
                self.samples.push(0.0);
                start = end;
            }
        }
    }

    /// Takes the glide around the speeds of a bin whose parts begin at this one, those within `short_s` together.
    fn look_at_speeds(&mut self, of_bin: &[Observation], first_part: usize, short_s: f64) {
        let of_speeds: Vec<usize> = (0..of_bin.len()).filter(|&i| of_bin[i].speed_m_s.is_finite()).collect();
        for together in of_speeds.chunk_by(|&i, &j| {
            let piece = |i: usize| ((of_bin[i].time_s - of_bin[0].time_s) / short_s).floor();
            piece(i) == piece(j)
        }) {
            let around: Vec<Observation> = together.iter().map(|&i| mean(around(of_bin, i))).collect();
            let mean = mean(&around);
            let is_later = |part: &&Observation| part.time_s <= mean.time_s;
            let begun = self.means[first_part..].iter().take_while(is_later).count();
            // Parts are known by their middles: the nearer one of two.
            let nearest = (begun.saturating_sub(1)..=begun)
                .filter_map(|i| self.means.get(first_part + i).map(|part| (first_part + i, part)))
                .min_by(|a, b| (a.1.time_s - mean.time_s).abs().total_cmp(&(b.1.time_s - mean.time_s).abs()));
            let part = nearest.map_or(first_part, |(part, _)| part);
            self.at_speeds.push(AtSpeeds { mean, speeds: together.len() as f64, part });
        }
    }

    /// The means of the parts in the order of time, those before and between the bins among them.
    pub fn means(&self) -> &[Observation] {
        &self.means
    }

    /// The parts of each bin with their share of its samples.
    #[cfg(test)]
    pub fn of_bins(&self) -> impl Iterator<Item = Vec<(usize, f64)>> {
        self.of_bin.iter().map(|parts| {
            let samples: f64 = parts.clone().map(|part| self.samples[part]).sum();
            parts.clone().map(|part| (part, self.samples[part] / samples)).collect()
        })
    }

    /// The same parts of a glider whose net mass is larger by this much in each of them \[kg\].
    pub fn heavier(&self, parameters: &Parameters<f64>, added_kg: &[f64]) -> Parts {
        let mut parts = self.clone();
        for (mean, added_kg) in parts.means.iter_mut().zip(added_kg) {
            make_heavier(mean, parameters, *added_kg);
        }
        for at in &mut parts.at_speeds {
            make_heavier(&mut at.mean, parameters, added_kg[at.part]);
        }
        parts
    }

    /// The same for a glider whose forces balance at every moment.
    pub fn without_inertia(&self) -> Parts {
        Parts { quasi_steady: true, ..self.clone() }
    }

    /// Whether forces are taken to balance at every moment.
    pub fn is_quasi_steady(&self) -> bool {
        self.quasi_steady
    }

    /// What happens inside each bin at these parameters; `bins` are those of [`new`](Self::new).
    pub fn inside(&self, parameters: &Parameters<f64>, bins: &[Bin]) -> Vec<Inside> {
        let courses = courses(parameters, self.gap_s, &self.means, |part| self.samples[part] == 0.0);
        if self.quasi_steady { self.steady(&courses, parameters, bins) } else { self.late(&courses, parameters, bins) }
    }

    /// What happens inside each bin with inertia, and with forces that balance at every moment.
    pub fn inside_and_at_rest(&self, parameters: &Parameters<f64>, bins: &[Bin]) -> (Vec<Inside>, Vec<Inside>) {
        let courses = courses(parameters, self.gap_s, &self.means, |part| self.samples[part] == 0.0);
        (self.late(&courses, parameters, bins), self.steady(&courses, parameters, bins))
    }

    fn late(&self, courses: &[Course], parameters: &Parameters<f64>, bins: &[Bin]) -> Vec<Inside> {
        let glider = SteadyGlider::new(*parameters);
        let fly = |part: usize, guess: &mut Option<[f64; 2]>| {
            let found = predict(&glider, &self.means[part], &courses[part].inertia, *guess)?;
            *guess = Some(found.guess);
            Some([found.sink_m_s, found.speed_m_s])
        };
        self.inside_with(|part| courses[part].inertia, fly, parameters, bins)
    }

    fn steady(&self, courses: &[Course], parameters: &Parameters<f64>, bins: &[Bin]) -> Vec<Inside> {
        self.inside_with(|part| courses[part].at_rest, |part, _| courses[part].steady_m_s, parameters, bins)
    }

    /// The bins, from the inertia of each part and its vertical velocity and speed.
    fn inside_with(
        &self,
        inertia: impl Fn(usize) -> Inertia + Sync,
        velocities: impl Fn(usize, &mut Option<[f64; 2]>) -> Option<[f64; 2]> + Sync,
        parameters: &Parameters<f64>,
        bins: &[Bin],
    ) -> Vec<Inside> {
        let glider = SteadyGlider::new(*parameters);
        let of_bin = |guess: &mut Option<[f64; 2]>, bin: &Bin, parts: &Range<usize>, at_speeds: &Range<usize>| {
            let fly = |guess: &mut Option<[f64; 2]>, observed: &Observation, inertia: &Inertia| {
                let found = predict(&glider, observed, inertia, *guess)?;
                *guess = Some(found.guess);
                Some([found.sink_m_s, found.speed_m_s])
            };
            let samples = bin.samples as f64;
            let in_bin =
                || parts.clone().map(|part| (part, self.samples[part] / samples)).filter(|(_, share)| *share > 0.0);
            let of =
                |value: fn(Inertia) -> f64| in_bin().map(|(part, share)| share * value(inertia(part))).sum::<f64>();
            let of_mean = Inertia {
                net_mass_kg: of(|i| i.net_mass_kg),
                pitch_rad: of(|i| i.pitch_rad),
                sink_rate_m_s2: of(|i| i.sink_rate_m_s2),
            };
            let at_mean = fly(guess, &bin.mean, &of_mean)?;
            let guess_at_mean = *guess;
            let mut beside = [0.0; 2];
            for (part, share) in in_bin() {
                let flown = velocities(part, guess)?;
                (0..2).for_each(|i| beside[i] += share * (flown[i] - at_mean[i]));
            }
            let at_speeds = &self.at_speeds[at_speeds.clone()];
            if !at_speeds.is_empty() {
                let speeds: f64 = at_speeds.iter().map(|at| at.speeds).sum();
                beside[1] = 0.0;
                for at in at_speeds {
                    beside[1] += (fly(guess, &at.mean, &inertia(at.part))?[1] - at_mean[1]) * at.speeds / speeds;
                }
            }
            Some(Inside { inertia: of_mean, sink_m_s: beside[0], speed_m_s: beside[1], guess: guess_at_mean })
        };
        // Each solution begins with that of the bin before, in groups of a fixed size: what is found depends on no number of threads.
        let of_group = |first: usize| {
            let mut guess = None;
            let places = first..(first + ABREAST).min(bins.len());
            let inside = places.map(|i| of_bin(&mut guess, &bins[i], &self.of_bin[i], &self.at_speeds_of_bin[i]));
            inside.map(|inside| inside.unwrap_or(Inside::NOTHING)).collect::<Vec<Inside>>()
        };
        let firsts: Vec<usize> = (0..bins.len()).step_by(ABREAST).collect();
        firsts.into_par_iter().flat_map_iter(of_group).collect()
    }
}

/// Gives this observation a ballast with which its glider has a net mass larger by this \[kg\].
pub fn make_heavier(observed: &mut Observation, parameters: &Parameters<f64>, added_kg: f64) {
    observed.ballast_m3 -=
        added_kg / (parameters.true_density_kg_m3(observed.density_kg_m3) * parameters.ballast_scale);
}

/// Whether a glide can be computed at a row of the log.
fn is_complete(o: &Observation) -> bool {
    [o.pitch_rad, o.ballast_m3, o.density_kg_m3, o.pressure_dbar].iter().all(|value| value.is_finite())
}

/// Whether no row of the log at which a glide can be computed lies between two samples.
fn follows(log: &[Observation], a: &Observation, b: &Observation) -> bool {
    let after = log.partition_point(|o| o.time_s <= a.time_s);
    !log[after..].iter().take_while(|o| o.time_s < b.time_s).any(is_complete)
}

/// The samples within [`AROUND_S`] of one.
fn around(samples: &[Observation], i: usize) -> &[Observation] {
    let is_near = |other: &&Observation| (other.time_s - samples[i].time_s).abs() <= AROUND_S;
    let before = samples[..i].iter().rev().take_while(is_near).count();
    let after = samples[i..].iter().take_while(is_near).count();
    &samples[i - before..i + after.max(1)]
}

/// Density as a hull feels it that yields to pressure itself.
pub(crate) fn felt_density_kg_m3(o: &Observation) -> f64 {
    o.density_kg_m3 / (1.0 + USUAL_COMPRESSIBILITY_PER_PA * DBAR_PA * o.pressure_dbar)
}

fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), v| (v.min(least), v.max(most)));
    most - least
}

/// Range of the mean pitches of the quarters of a bin: of means, since single readings have their noise.
pub(crate) fn turns_by_rad(samples: &[Observation]) -> f64 {
    let quarter = samples.len().div_ceil(4);
    range(samples.chunks(quarter).map(|part| part.iter().map(|o| o.pitch_rad).sum::<f64>() / part.len() as f64))
}

/// The samples in parts of this length or somewhat more, with nearly as many in each. Each sample stands for a step.
fn even_parts(samples: &[Observation], part_s: f64) -> impl Iterator<Item = &[Observation]> {
    let stand_for_s = lasts_s(samples) * samples.len() as f64 / (samples.len() as f64 - 1.0).max(1.0);
    // Steps that are a part long are not to be one rounding short of it.
    let count = ((stand_for_s / part_s * (1.0 + 1e-9)) as usize).clamp(1, samples.len().max(1));
    let begin = move |part: usize| part * samples.len() / count;
    (0..count).map(move |part| &samples[begin(part)..begin(part + 1)])
}

fn lasts_s(samples: &[Observation]) -> f64 {
    samples.last().map_or(0.0, |last| last.time_s - samples[0].time_s)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{glider, sample};
    use super::*;

    #[test]
    fn parts_hold_as_many_samples_each_and_all_of_them() {
        let (_, p) = glider();
        let samples: Vec<Observation> = (0..13).map(|i| sample(&p, -27.0, 0.3, 0, 5.0 * f64::from(i))).collect();
        let lengths = |part_s: f64| even_parts(&samples, part_s).map(<[Observation]>::len).collect::<Vec<_>>();
        assert_eq!(lengths(15.0), [3, 3, 3, 4]);
        assert_eq!(lengths(f64::INFINITY), [13]);
        assert_eq!(lengths(1.0), [1; 13]);
        assert_eq!(even_parts(&samples[..1], 15.0).map(<[Observation]>::len).sum::<usize>(), 1);
    }
}
