//! The balance's zero at the time of every run: what zero runs show, interpolated between those before and after.

use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::campaign::{Kind, Run};
use crate::influence;
use crate::readings::{Readings, Useful};
use crate::series::Mean3;
use crate::zero_noise;

/// Share of the first mode `sin(pi x)` in a walk between two fixed points, per unit of time: `2/pi^2` (Karhunen and Loeve);
/// the others, a third of its variance, scatter from run to run.
const FIRST_MODE: f64 = 0.202_642_367_284_675_54;
/// A pause as long as this ends a stretch of zeros \[s\].
const PAUSE_S: f64 = 4.0 * 3600.0;

/// All zeros of a campaign.
#[derive(Debug, Clone, Default)]
pub struct Zeros {
    /// In the order in which they were taken.
    pub zeros: Vec<Zero>,
    /// Root of the covariance of one zero's means, pooled over all of them: three independent errors of every zero.
    pub root: Matrix3<f64>,
    /// Degrees of freedom of that covariance.
    pub dof: f64,
    /// Variance that a random walk of the zeros gains per unit of `when`: AF, SF, YM.
    pub walk: Vector3<f64>,
    /// Whether time, rather than the order of the runs, was interpolated in.
    pub in_time: bool,
}

/// One zero run.
#[derive(Debug, Clone)]
pub struct Zero {
    /// The run.
    pub run_id: String,
    /// Hull below the balance.
    pub hull: Option<usize>,
    /// When, in the middle of what was averaged: time \[s\] or place in the order.
    pub when: f64,
    /// AF, SF, YM.
    pub reading: Vector3<f64>,
}

/// The zero of one run: a weighted mean of zero runs, or its own rest where there are none.
#[derive(Debug, Clone)]
pub struct ZeroOfRun {
    /// AF, SF, YM.
    pub reading: Vector3<f64>,
    /// Which zero runs it rests on, with their weights.
    pub parts: Vec<(usize, f64)>,
    /// Between which two zeros a walk takes the zero off the line between them, or beyond which one, with the standard
    /// deviation that it has gained there at unit rate.
    pub bridge: Option<(usize, f64)>,
    /// Covariance that this run's zero does not share with others.
    pub own_covariance: Matrix3<f64>,
}

impl Zeros {
    /// Collects the zero runs.
    pub fn new<'a>(runs: impl Iterator<Item = (&'a Run, &'a Readings)> + Clone) -> Zeros {
        let in_time = runs.clone().all(|(run, _)| run.start_time_s.is_some());
        let taken: Vec<(Zero, Mean3)> = runs
            .filter(|(run, _)| run.kind == Kind::Zero)
            .filter_map(|(run, readings)| {
                let rest = readings.rest.filter(|_| matches!(readings.useful, Useful::Rest))?;
                // A drift is where it is in the middle of what was averaged.
                let when = when(run, in_time, rest.middle_s);
                let zero = Zero { run_id: run.id.clone(), hull: run.hull, when, reading: rest.readings.mean };
                Some((zero, rest.readings))
            })
            .collect();
        let mut covariance = Matrix3::zeros();
        for (_, rest) in &taken {
            covariance += rest.covariance / taken.len() as f64;
        }
        let dof = taken.iter().map(|(_, rest)| rest.dof).sum::<f64>().max(1.0);
        let mut zeros: Vec<Zero> = taken.into_iter().map(|(zero, _)| zero).collect();
        zeros.sort_by(|a, b| a.when.total_cmp(&b.when));
        let between = [0, 1, 2].map(|channel| {
            let of_day = stretches(&zeros, in_time);
            let mut stretches: Vec<Vec<(f64, f64)>> = of_day
                .iter()
                .map(|stretch| stretch.iter().map(|i| (zeros[*i].when, zeros[*i].reading[channel])).collect())
                .collect();
            if in_time {
                zero_noise::without_settling(&mut stretches, &since_begin(&zeros, &of_day));
            }
            zero_noise::components(&stretches, covariance[(channel, channel)])
        });
        (0..3).for_each(|channel| covariance[(channel, channel)] += between[channel].repeat);
        let walk = Vector3::from(between.map(|components| components.walk));
        let covariance = DMatrix::from_column_slice(3, 3, covariance.as_slice());
        let root = Matrix3::from_column_slice(influence::root(&covariance).as_slice());
        Zeros { zeros, root, dof, walk, in_time }
    }

    /// The zero at a run, `after_s` after its begin. Zeros with the same hull go before others, since a model's own weight
    /// may lean on the balance.
    pub fn at(&self, run: &Run, readings: &Readings, after_s: f64) -> Option<ZeroOfRun> {
        let when = when(run, self.in_time, after_s);
        let same: Vec<usize> = (0..self.zeros.len()).filter(|i| self.zeros[*i].hull == run.hull).collect();
        let candidates = if same.is_empty() { (0..self.zeros.len()).collect() } else { same };
        let before = candidates.iter().copied().rfind(|i| self.zeros[*i].when <= when);
        let after = candidates.iter().copied().find(|i| self.zeros[*i].when > when);
        let mut bridge = None;
        let parts = match (before, after) {
            (Some(before), Some(after)) => {
                let (from, to) = (self.zeros[before].when, self.zeros[after].when);
                let share = (when - from) / (to - from);
                bridge = Some((before, (FIRST_MODE * (to - from)).sqrt() * (std::f64::consts::PI * share).sin()));
                vec![(before, 1.0 - share), (after, share)]
            }
            (Some(only), None) | (None, Some(only)) => {
                bridge = Some((only, (when - self.zeros[only].when).abs().sqrt()));
                vec![(only, 1.0)]
            }
            (None, None) => {
                let rest = readings.rest?.readings;
                return Some(ZeroOfRun { reading: rest.mean, parts: vec![], bridge, own_covariance: rest.covariance });
            }
        };
        let reading = parts.iter().map(|(i, weight)| self.zeros[*i].reading * *weight).sum();
        Some(ZeroOfRun { reading, parts, bridge, own_covariance: Matrix3::zeros() })
    }

    /// Largest change of a channel between successive zeros of the same hull.
    pub fn largest_drift(&self) -> Vector3<f64> {
        let mut largest = Vector3::zeros();
        for pair in self.zeros.windows(2).filter(|pair| pair[0].hull == pair[1].hull) {
            largest = largest.zip_map(&(pair[1].reading - pair[0].reading), |l: f64, d| l.max(d.abs()));
        }
        largest
    }
}

/// Time of each zero since the first zero of its day.
fn since_begin(zeros: &[Zero], stretches: &[Vec<usize>]) -> Vec<Vec<f64>> {
    let begin = |zero: usize| {
        let before = (1..=zero).rev().find(|i| zeros[*i].when - zeros[i - 1].when > PAUSE_S);
        zeros[before.unwrap_or(0)].when
    };
    stretches.iter().map(|stretch| stretch.iter().map(|zero| zeros[*zero].when - begin(*zero)).collect()).collect()
}

/// Zeros that follow each other with the same hull, on one day.
fn stretches(zeros: &[Zero], in_time: bool) -> Vec<Vec<usize>> {
    let mut found: Vec<Vec<usize>> = Vec::new();
    for (i, zero) in zeros.iter().enumerate() {
        let follows = |stretch: &&mut Vec<usize>| {
            stretch.last().is_some_and(|last| {
                zeros[*last].hull == zero.hull && (!in_time || zero.when - zeros[*last].when < PAUSE_S)
            })
        };
        match found.last_mut().filter(follows) {
            Some(stretch) => stretch.push(i),
            None => found.push(vec![i]),
        }
    }
    found
}

fn when(run: &Run, in_time: bool, after_s: f64) -> f64 {
    match run.start_time_s {
        Some(start) if in_time => start + after_s,
        _ => run.order as f64,
    }
}
