//! The days of a campaign, and what a zero that settles in the course of each does to runs whose zeros are interpolated.

use super::data::{Data, ZeroTimes};

/// A pause as long as this ends a day \[s\].
const PAUSE_S: f64 = 4.0 * 3600.0;
/// Times count from the begin of the first day: a first run within this long of a whole day was made that long after
/// switching on \[s\].
const MORNING_S: f64 = 2.0 * 3600.0;
const DAY_S: f64 = 86_400.0;

/// The days of a campaign.
#[derive(Debug, Clone, Default)]
pub struct Days {
    /// When each began: the rig was switched on \[s\].
    begins_s: Vec<f64>,
    /// For each steady run: its day, hours since its begin, speed of the run before.
    runs: Vec<(Option<usize>, Option<f64>, Option<f64>)>,
}

/// A zero that runs away at a rate and settles exponentially.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Time constant \[h\].
    pub time_constant_h: f64,
}

impl Days {
    /// From the begins of all runs; without times there are none.
    pub fn new(data: &Data) -> Days {
        if !data.in_time {
            return Days { begins_s: Vec::new(), runs: vec![(None, None, None); data.runs.len()] };
        }
        let mut times: Vec<f64> = data.runs.iter().map(|run| run.zeros.time_s).collect();
        times.extend(data.runs.iter().chain([]).flat_map(|run| run.zeros.zeros.iter().map(|(time, _)| *time)));
        times.extend(data.tare_zeros.iter().flat_map(|z| z.zeros.iter().map(|(t, _)| *t).chain([z.time_s])));
        times.sort_by(f64::total_cmp);
        let mut begins_s = Vec::new();
        for (i, time) in times.iter().enumerate() {
            if i == 0 || time - times[i - 1] > PAUSE_S {
                let midnight = (time / DAY_S).floor() * DAY_S;
                begins_s.push(if time - midnight < MORNING_S { midnight } else { *time });
            }
        }
        let mut days = Days { begins_s, runs: Vec::new() };
        let mut order: Vec<usize> = (0..data.runs.len()).collect();
        order.sort_by(|a, b| data.runs[*a].time_s.total_cmp(&data.runs[*b].time_s));
        let mut before = vec![None; data.runs.len()];
        for pair in order.windows(2) {
            let (earlier, later) = (&data.runs[pair[0]], &data.runs[pair[1]]);
            // Runs of another kind between them would have stirred the water otherwise.
            let adjacent = later.point.order == earlier.point.order + 1;
            before[pair[1]] = earlier.point.speed_m_s.filter(|_| adjacent);
        }
        days.runs = (0..data.runs.len())
            .map(|i| {
                let time = data.runs[i].zeros.time_s;
                let day = days.day_at(time);
                (day, day.map(|day| (time - days.begins_s[day]) / 3600.0), before[i])
            })
            .collect();
        days
    }

    /// How many.
    pub fn count(&self) -> usize {
        self.begins_s.len()
    }

    /// The day of a run.
    pub fn of_run(&self, run: usize) -> Option<usize> {
        self.runs[run].0
    }

    /// Hours of a run since the begin of its day.
    pub fn hours(&self, run: usize) -> Option<f64> {
        self.runs[run].1
    }

    /// Speed of the run just before, where that was a steady one as well \[m/s\].
    pub fn speed_before(&self, run: usize) -> Option<f64> {
        self.runs[run].2
    }

    /// When a day began \[s\].
    pub fn begin_s(&self, day: usize) -> f64 {
        self.begins_s[day]
    }

    /// The day of a time.
    pub fn day_at(&self, time_s: f64) -> Option<usize> {
        self.begins_s.iter().rposition(|begin| *begin <= time_s)
    }

    /// What a drift at unit rate leaves in a run once its zero is taken off, and its slope against the time constant.
    pub fn net(&self, drift: &Drift, run: &ZeroTimes) -> (f64, f64) {
        let at = |time_s: f64| {
            let hours = self.day_at(time_s).map_or(0.0, |day| (time_s - self.begins_s[day]) / 3600.0);
            drift.at(hours)
        };
        run.zeros.iter().fold(at(run.time_s), |sum, (time_s, weight)| {
            let zero = at(*time_s);
            (sum.0 - weight * zero.0, sum.1 - weight * zero.1)
        })
    }
}

impl Drift {
    /// How far the zero has run at unit rate, and its slope against the time constant.
    pub fn at(&self, hours: f64) -> (f64, f64) {
        let tau = self.time_constant_h.max(0.02);
        let left = (-hours / tau).exp();
        (tau * (1.0 - left), 1.0 - left - hours / tau * left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_drift_between_two_zeros_leaves_nothing_and_a_settling_one_bends() {
        let days = Days { begins_s: vec![0.0], runs: vec![] };
        let run = ZeroTimes { time_s: 5400.0, zeros: vec![(3600.0, 0.5), (7200.0, 0.5)] };
        let (even, _) = days.net(&Drift { time_constant_h: 1e6 }, &run);
        assert!(even.abs() < 1e-6, "{even}");
        // 1 - exp(-1.5), less the mean of 1 - exp(-1) and 1 - exp(-2).
        let (settling, slope) = days.net(&Drift { time_constant_h: 1.0 }, &run);
        let expected = 0.5 * ((-1.0f64).exp() + (-2.0f64).exp()) - (-1.5f64).exp();
        assert!((settling - expected).abs() < 1e-12);
        let h = 1e-6;
        let moved = days.net(&Drift { time_constant_h: 1.0 + h }, &run).0;
        assert!(((moved - settling) / h - slope).abs() < 1e-5);
    }
}
