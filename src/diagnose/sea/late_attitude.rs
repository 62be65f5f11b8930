//! The attitude on a clock of its own: the bins with the pitch that was read at another time.
//!
//! A clock that differs by half a minute moves the pitch by more than its rate times that time where the glider turns over or hunts. So
//! the readings of the other time are taken, smoothed as those of the log were, and averaged over the same samples. Knows the readings
//! of one instrument; no vehicle.

use std::sync::{Arc, OnceLock};

use super::attitude::Smoother;
use super::is_usable;
use super::leg_rates::LegRates;
use crate::identify::{Bin, Parts};
use crate::log::Observation;

/// The mechanism by which the attitude is late.
pub const MECHANISM: &str = "clock_offset";

/// Step to either side of the difference quotient by a late attitude \[s\]: about the standard error of one. On straight lines between
/// readings, and in parts of bins that come and go, a shorter one would see single corners.
pub const STEP_S: f64 = 1.0;

/// The readings of a log.
#[derive(Debug)]
pub struct LateAttitude {
    log: Vec<Observation>,
    bins: Vec<Bin>,
    smoother: Option<Smoother>,
    /// Time by which the path follows the pitch at each usable sample \[s\].
    follows_s: Vec<f64>,
    leg_rates: LegRates,
    /// A step before and after the clock as it is, which each slope there asks for. Each is made by one thread alone: one that waits for
    /// it must not be given a part of it.
    beside: [OnceLock<Arc<Shifted>>; 2],
}

/// The bins with the pitch of another time.
#[derive(Debug)]
pub struct Shifted {
    /// The bins, of the same samples.
    pub bins: Vec<Bin>,
    /// Rate of the pitch in each bin \[rad/s\].
    pub pitch_rates: Vec<f64>,
    usable: Vec<Observation>,
    log: Vec<Observation>,
    parts: OnceLock<Parts>,
}

impl Shifted {
    /// The same bins in parts.
    pub fn parts(&self) -> &Parts {
        self.parts.get_or_init(|| Parts::new(&self.bins, &self.usable, &self.log))
    }
}

impl LateAttitude {
    /// The readings of this log with the bins that were made of it, and how they are smoothed.
    pub fn new(
        log: &[Observation],
        bins: &[Bin],
        smoother: Option<Smoother>,
        follows_s: Vec<f64>,
        leg_rates: LegRates,
    ) -> LateAttitude {
        LateAttitude {
            log: log.to_vec(),
            bins: bins.to_vec(),
            smoother,
            follows_s,
            leg_rates,
            beside: Default::default(),
        }
    }

    /// The bins as they are where the attitude was written this much late.
    pub fn shifted(&self, late_s: f64) -> Arc<Shifted> {
        let found = || Arc::new(self.shifted_anew(late_s));
        match [-STEP_S, STEP_S].iter().position(|step_s| late_s == *step_s) {
            Some(side) => Arc::clone(self.beside[side].get_or_init(found)),
            None => found(),
        }
    }

    fn shifted_anew(&self, late_s: f64) -> Shifted {
        let (usable, log) = self.at(late_s);
        let mut bins = self.bins.clone();
        for bin in &mut bins {
            let of_bin = &usable[bin.first..bin.first + bin.samples];
            bin.mean.pitch_rad = of_bin.iter().map(|o| o.pitch_rad).sum::<f64>() / of_bin.len() as f64;
        }
        let pitch_rates = bins.iter().map(|bin| pitch_rate(&usable[bin.first..bin.first + bin.samples])).collect();
        Shifted { bins, pitch_rates, usable, log, parts: OnceLock::new() }
    }

    /// Rate of the pitch in each bin as it was read \[rad/s\].
    pub fn pitch_rates(&self) -> Vec<f64> {
        let (usable, _) = self.at(0.0);
        self.bins.iter().map(|bin| pitch_rate(&usable[bin.first..bin.first + bin.samples])).collect()
    }

    /// The usable samples, smoothed, and all of the log with the pitch that was read this much later. The samples are those that are
    /// usable as they were read, whatever their pitch is now.
    fn at(&self, late_s: f64) -> (Vec<Observation>, Vec<Observation>) {
        let mut log = self.log.clone();
        if late_s != 0.0 {
            self.pitches_at(late_s).zip(&mut log).for_each(|(pitch_rad, o)| o.pitch_rad = pitch_rad);
        }
        let is_read = self.log.iter().map(is_usable);
        let mut usable: Vec<Observation> =
            log.iter().zip(is_read).filter(|(_, is_read)| *is_read).map(|(o, _)| *o).collect();
        if let Some(smoother) = self.smoother {
            smoother.smooth(&mut usable, &self.follows_s);
        }
        usable.iter_mut().for_each(|o| self.leg_rates.put_into(o));
        (usable, log)
    }

    /// The pitch that was read this much later than each sample, on straight lines between readings.
    fn pitches_at(&self, late_s: f64) -> impl Iterator<Item = f64> {
        let readings = self.log.iter().map(|o| (o.time_s, o.pitch_rad));
        let read: Vec<(f64, f64)> = readings.filter(|(_, pitch_rad)| pitch_rad.is_finite()).collect();
        self.log.iter().map(move |o| {
            let time_s = o.time_s + late_s;
            let next = read.partition_point(|(read_s, _)| *read_s < time_s);
            let before = next.checked_sub(1).and_then(|before| read.get(before));
            match (before, read.get(next)) {
                (Some((t0, p0)), Some((t1, p1))) => p0 + (p1 - p0) * (time_s - t0) / (t1 - t0),
                (Some((_, pitch_rad)), None) | (None, Some((_, pitch_rad))) => *pitch_rad,
                (None, None) => f64::NAN,
            }
        })
    }
}

/// Least-squares slope of the pitch over these samples \[rad/s\].
fn pitch_rate(samples: &[Observation]) -> f64 {
    let n = samples.len() as f64;
    let mean_s = samples.iter().map(|o| o.time_s).sum::<f64>() / n;
    let spread: f64 = samples.iter().map(|o| (o.time_s - mean_s).powi(2)).sum();
    let moment: f64 = samples.iter().map(|o| (o.time_s - mean_s) * o.pitch_rad).sum();
    if spread > 0.0 { moment / spread } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use crate::diagnose::Problem;
    use crate::diagnose::sea::{DiagnosisSettings, SeaProblem, steady_log};
    use crate::vehicle::Vehicle;

    /// A clock that differs is what is read at another time: at its own size nothing is left of it.
    #[test]
    fn a_clock_that_differs_is_the_pitch_of_another_time() {
        let parameters = Vehicle::load("slocum-graver").expect("a vehicle").glide_parameters();
        let log = steady_log::log(&parameters);
        let problem_of =
            |log: &[_]| SeaProblem::new(log, &parameters, DiagnosisSettings::default()).expect("enough bins");
        let truth = problem_of(&log);
        let place = |problem: &SeaProblem| {
            problem.candidates().iter().position(|candidate| candidate.name == super::MECHANISM).expect("a candidate")
        };
        let residual_at = |problem: &SeaProblem, late_s: f64| {
            let mut point = problem.start();
            point.candidates[place(problem)][0] = late_s;
            problem.evidence(&point).residual
        };
        let clean = residual_at(&truth, 0.0);
        // Read 30 s late, by two samples: the pitch of row i is that of row i - 2.
        let mut late = log.clone();
        (2..log.len()).for_each(|i| late[i].pitch_rad = log[i - 2].pitch_rad);
        let problem = problem_of(&late);
        let as_read = (residual_at(&problem, 0.0) - &clean).norm();
        let corrected = (residual_at(&problem, 30.0) - &clean).norm();
        assert!(corrected < 0.02 * as_read, "{corrected} of {as_read}");

        // Its slope is what whole flights change by, at no size and at this one; a tenth apart at most where half the step sees corners.
        for (problem, late_s) in [(&truth, 0.0), (&problem, 20.0)] {
            let mut point = problem.start();
            point.candidates[place(problem)][0] = late_s;
            let column = problem.evidence(&point).candidates[place(problem)].column(0).into_owned();
            let change = residual_at(problem, late_s - 0.5) - residual_at(problem, late_s + 0.5);
            let (most, off) = (column.amax(), (&change - &column).amax());
            assert!(most > 1e-5 && off < 0.1 * most, "{off} of {most} m/s at {late_s} s");
        }
    }
}
