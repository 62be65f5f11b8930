//! A column of speeds in which each value is repeated until the next one.
//!
//! A profiler that gives a speed once a minute is often merged with the rows of a log so that its last value stands in every
//! row until the next. The repetitions were not measured: counted as rows they make a speed look better known than it is,
//! and each stands beside a pitch of another time. Such a column shows what it is: runs of one value, and from run to run
//! steps of many times its last digit. A run is one measurement, at its first time.
//!
//! Knows columns of a log only. A coarse sensor repeats its values as well, but steps by its last digit; a simulated speed
//! that stays the same on a whole leg is no run between two measurements.

use super::channels::{Channel, FlightLog};
use super::segment::legs;
use super::settings::PreparationSettings;

/// Runs of repeated values below which nothing is said.
const FEWEST_RUNS: usize = 10;

/// Share of values that repeat the one before, beyond what chance gives values of so few digits.
const LEAST_REPEATED: f64 = 0.25;

/// Median step between runs, in units of the smallest: a slow sensor steps by its last digit.
const LEAST_STEP: f64 = 2.5;

/// A run of the median length takes no more than this share of its leg.
const MOST_OF_LEG: f64 = 0.5;

/// What arithmetic makes of one value in other units \[m/s\].
const ROUNDING_M_S: f64 = 1e-12;

/// The repetitions of a log that is read in pieces.
#[derive(Debug, Clone, Default)]
pub struct ForwardFilled {
    /// Whether a piece so far was recognised: then the later ones are of the same kind, however short they are.
    is_recognised: bool,
    values: usize,
    kept: usize,
    /// The last value of the piece before.
    last_m_s: Option<f64>,
}

impl ForwardFilled {
    /// Keeps of each run of repeated speeds the first, where the piece is, or one before it was, of that kind.
    pub fn take_out(&mut self, piece: &mut FlightLog) {
        if !piece.has(Channel::Speed) {
            self.last_m_s = None;
            return;
        }
        let before = self.last_m_s;
        self.last_m_s = piece.column(Channel::Speed).last().copied().filter(|speed| speed.is_finite());
        let speeds = piece.column(Channel::Speed);
        let runs = runs(speeds);
        self.is_recognised |= is_forward_filled(speeds, &runs, piece);
        if !self.is_recognised {
            return;
        }
        let continues = |start: usize| start == 0 && before.is_some_and(|before| is_same(before, speeds[0]));
        self.values += runs.iter().map(|run| run.1 - run.0).sum::<usize>();
        self.kept += runs.iter().filter(|run| !continues(run.0)).count();
        let mut kept = vec![f64::NAN; speeds.len()];
        for &(start, _) in runs.iter().filter(|run| !continues(run.0)) {
            kept[start] = speeds[start];
        }
        piece.set(Channel::Speed, kept);
    }

    /// What was done, in a sentence; nothing where nothing was.
    pub fn report(&self) -> Option<String> {
        self.is_recognised.then(|| {
            format!(
                "the measured speed is repeated until its next value: its {} values are {} measurements, each used once, at its first time",
                self.values, self.kept
            )
        })
    }
}

fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING_M_S
}

/// Runs of one value in neighbouring rows: first, and one behind the last. A single value is a run as well.
fn runs(speeds: &[f64]) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for i in (0..speeds.len()).filter(|&i| speeds[i].is_finite()) {
        match found.last_mut() {
            Some((start, end)) if *end == i && is_same(speeds[*start], speeds[i]) => *end = i + 1,
            _ => found.push((i, i + 1)),
        }
    }
    found
}

/// Whether the runs are those of values that were repeated until the next one.
fn is_forward_filled(speeds: &[f64], runs: &[(usize, usize)], piece: &FlightLog) -> bool {
    let long: Vec<(usize, usize)> = runs.iter().copied().filter(|(start, end)| end - start > 1).collect();
    let values: usize = runs.iter().map(|(start, end)| end - start).sum();
    if long.len() < FEWEST_RUNS {
        return false;
    }
    let repeated = (values - runs.len()) as f64 / values as f64;
    let mut sorted: Vec<f64> = runs.iter().map(|(start, _)| speeds[*start]).collect();
    sorted.sort_by(f64::total_cmp);
    let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    let Some(unit) = steps.filter(|step| *step > ROUNDING_M_S).min_by(f64::total_cmp) else { return false };
    // Were the values drawn one by one, so many would be the one before.
    let mut by_chance = 0.0;
    for same in sorted.chunk_by(|a, b| is_same(*a, *b)) {
        by_chance += (same.len() as f64 / sorted.len() as f64).powi(2);
    }
    let mut steps: Vec<f64> = long
        .windows(2)
        .filter(|pair| pair[0].1 == pair[1].0)
        .map(|pair| (speeds[pair[1].0] - speeds[pair[0].0]).abs())
        .collect();
    steps.len() + 1 >= FEWEST_RUNS
        && repeated >= LEAST_REPEATED + by_chance
        && super::median(&mut steps) >= LEAST_STEP * unit
        && share_of_leg(&long, piece).is_some_and(|share| share <= MOST_OF_LEG)
}

/// The median share that runs have of the legs on which they are; nothing where the pressure shows no legs.
fn share_of_leg(runs: &[(usize, usize)], piece: &FlightLog) -> Option<f64> {
    let depth = [Channel::Pressure, Channel::Depth].into_iter().find(|channel| piece.has(*channel))?;
    let (rows, depths): (Vec<usize>, Vec<f64>) =
        piece.column(depth).iter().copied().enumerate().filter(|(_, depth)| depth.is_finite()).unzip();
    let bounds: Vec<(usize, usize)> = legs(&depths, PreparationSettings::default().least_leg_dbar)
        .into_iter()
        .map(|leg| (rows[leg.first], rows[leg.end - 1] + 1))
        .collect();
    let mut shares: Vec<f64> = Vec::new();
    for &(start, end) in runs {
        // The leg on which the run has its middle.
        let middle = (start + end) / 2;
        let leg = bounds.partition_point(|leg| leg.1 <= middle);
        if let Some(&(first, last)) = bounds.get(leg).filter(|leg| leg.0 <= middle) {
            shares.push((end.min(last) - start.max(first)) as f64 / (last - first) as f64);
        }
    }
    (!shares.is_empty()).then(|| super::median(&mut shares))
}
