//! Values of one instrument at the times of another.
//!
//! Straight lines between neighbouring readings, nothing beyond the first and the last, nothing across a gap. Where a
//! reading is missing, its neighbours are the next ones that are there.

use super::channels::Channel;
use super::units::is_angle;

/// Longest gap that is bridged, in intervals of the instrument: as [`Preparation`](super::Preparation) fills slow channels.
const LONGEST_INTERVALS: f64 = 4.0;

/// Longest gap that is bridged however fast the instrument samples \[s\].
const LONGEST_S: f64 = 120.0;

/// The readings of one instrument, in the order of time.
pub(super) struct Readings {
    times: Vec<f64>,
    values: Vec<f64>,
    longest_s: f64,
}

impl Readings {
    /// Keeps what has a time and a value, with time increasing.
    pub(super) fn new(times: &[f64], values: &[f64]) -> Self {
        let (mut kept_times, mut kept): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        for (&time, &value) in times.iter().zip(values) {
            let follows = kept_times.last().is_none_or(|last| time > *last);
            if time.is_finite() && value.is_finite() && follows {
                kept_times.push(time);
                kept.push(value);
            }
        }
        let longest_s = (LONGEST_INTERVALS * super::clean::median_step(&kept_times)).max(LONGEST_S);
        Readings { times: kept_times, values: kept, longest_s }
    }

    /// The same for angles \[rad\]: turned on by whole turns, so that neighbours lie within half a turn.
    pub(super) fn of_angles(times: &[f64], angles: &[f64]) -> Self {
        let turn = std::f64::consts::TAU;
        let mut readings = Readings::new(times, angles);
        for i in 1..readings.values.len() {
            let last = readings.values[i - 1];
            readings.values[i] -= ((readings.values[i] - last) / turn).round() * turn;
        }
        readings
    }

    /// The value at a time; NaN beyond the readings and in gaps.
    pub(super) fn at(&self, time: f64) -> f64 {
        let after = self.times.partition_point(|t| *t < time);
        if after < self.times.len() && self.times[after] == time {
            return self.values[after];
        }
        if after == 0 || after == self.times.len() {
            return f64::NAN;
        }
        let (before_s, after_s) = (self.times[after - 1], self.times[after]);
        if after_s - before_s > self.longest_s {
            return f64::NAN;
        }
        let share = (time - before_s) / (after_s - before_s);
        self.values[after - 1] + share * (self.values[after] - self.values[after - 1])
    }

    /// The values at these times.
    pub(super) fn at_all(&self, times: &[f64]) -> Vec<f64> {
        times.iter().map(|&time| self.at(time)).collect()
    }

    /// Slope of the least-squares line through the readings within so many seconds of a time; NaN where fewer than three.
    pub(super) fn slope(&self, time: f64, within_s: f64) -> f64 {
        let first = self.times.partition_point(|t| *t < time - within_s);
        let end = self.times.partition_point(|t| *t <= time + within_s);
        let n = end.saturating_sub(first);
        if n < 3 {
            return f64::NAN;
        }
        let (times, values) = (&self.times[first..end], &self.values[first..end]);
        let mean_t = times.iter().map(|t| t - time).sum::<f64>() / n as f64;
        let mean_v = values.iter().sum::<f64>() / n as f64;
        let products = times.iter().zip(values).map(|(t, v)| (t - time - mean_t) * (v - mean_v)).sum::<f64>();
        let squares = times.iter().map(|t| (t - time - mean_t).powi(2)).sum::<f64>();
        if squares > 0.0 { products / squares } else { f64::NAN }
    }
}

/// A reading belongs to a row of the log that is no farther off \[s\].
const SAME_ROW_S: f64 = 5.0;

/// The row nearest to a time, none where it is too far off.
pub(super) fn nearest(rows: &[f64], time: f64) -> Option<usize> {
    let after = rows.partition_point(|t| *t < time);
    let distance = |i: usize| (rows[i] - time).abs();
    let near = [after.checked_sub(1), (after < rows.len()).then_some(after)];
    let best = near.into_iter().flatten().min_by(|&a, &b| distance(a).total_cmp(&distance(b)))?;
    (distance(best) <= SAME_ROW_S).then_some(best)
}

/// Readings with their times, each in the row nearest to it; means where a row has several.
pub(super) fn in_nearest_rows(rows: &[f64], readings: impl Iterator<Item = (f64, f64)>) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); rows.len()];
    for (time, value) in readings.filter(|(time, value)| time.is_finite() && value.is_finite()) {
        if let Some(row) = nearest(rows, time) {
            sums[row] = (sums[row].0 + value, sums[row].1 + 1.0);
        }
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

/// A channel at the rows of a log: by straight lines, angles the short way round, headings from 0 to a turn. A speed stays at its own times, in the rows
/// nearest to them: between two of its values nothing was measured, and the glider may have turned there.
pub(super) fn at_rows(channel: Channel, rows: &[f64], times: &[f64], values: &[f64]) -> Vec<f64> {
    let by_lines = |readings: Readings| readings.at_all(rows);
    let mut column = match channel {
        _ if rows == times => values.to_vec(),
        Channel::Speed => in_nearest_rows(rows, times.iter().copied().zip(values.iter().copied())),
        _ if is_angle(channel) => by_lines(Readings::of_angles(times, values)),
        _ => by_lines(Readings::new(times, values)),
    };
    if channel == Channel::Heading {
        column.iter_mut().for_each(|angle| *angle = angle.rem_euclid(std::f64::consts::TAU));
    }
    column
}

/// Times with their values.
type Column = (Vec<f64>, Vec<f64>);

/// The times of the rows of a log, and the pressure there: that of the CTD, and of the vehicle where the CTD was off.
pub(super) fn pressure_rows(ctd: Option<Column>, own: Option<Column>) -> Option<Column> {
    let (ctd, own) = match (ctd, own) {
        (Some(ctd), Some(own)) => (ctd, own),
        (ctd, own) => return ctd.or(own),
    };
    let by_ctd = Readings::new(&ctd.0, &ctd.1);
    let in_gaps = own.0.iter().zip(&own.1).filter(|(time, _)| by_ctd.at(**time).is_nan());
    let mut rows: Vec<(f64, f64)> = ctd.0.iter().zip(&ctd.1).chain(in_gaps).map(|(t, p)| (*t, *p)).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    Some(rows.into_iter().unzip())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_between_readings_and_nothing_beyond_them() {
        let readings = Readings::new(&[0.0, 10.0, 20.0, 30.0], &[1.0, 2.0, f64::NAN, 4.0]);
        assert_eq!(readings.at_all(&[0.0, 5.0, 20.0, 30.0]), [1.0, 1.5, 3.0, 4.0]);
        assert!(readings.at(-1.0).is_nan() && readings.at(30.1).is_nan());
    }

    #[test]
    fn a_speed_stays_in_the_row_of_its_time() {
        let rows: Vec<f64> = (0..30).map(|i| 5.0 * f64::from(i)).collect();
        let (times, speeds) = ([1.0, 61.0, 121.0, 900.0], [0.2, 0.4, 0.3, 0.5]);
        let column = at_rows(Channel::Speed, &rows, &times, &speeds);
        let there: Vec<(usize, f64)> = column.into_iter().enumerate().filter(|(_, v)| v.is_finite()).collect();
        assert_eq!(there, [(0, 0.2), (12, 0.4), (24, 0.3)]);
        assert_eq!(at_rows(Channel::Temperature, &rows, &times, &speeds)[6], 0.2 + 0.2 * 29.0 / 60.0);
    }

    #[test]
    fn a_gap_is_not_bridged() {
        let times = [0.0, 10.0, 20.0, 400.0, 410.0];
        let readings = Readings::new(&times, &[0.0; 5]);
        assert!(readings.at(200.0).is_nan());
        assert_eq!(readings.at(15.0), 0.0);
    }

    #[test]
    fn angles_take_the_short_way_round() {
        let degrees = |x: f64| x.to_radians();
        let readings = Readings::of_angles(&[0.0, 10.0], &[degrees(350.0), degrees(20.0)]);
        let found = readings.at(5.0).rem_euclid(std::f64::consts::TAU);
        assert!((found - degrees(5.0)).abs() < 1e-12, "{found}");
    }

    #[test]
    fn the_slope_is_that_of_the_line() {
        let times: Vec<f64> = (0..20).map(|i| 1.7e9 + 5.0 * f64::from(i)).collect();
        let values: Vec<f64> = times.iter().map(|t| 3.0 - 0.2 * (t - times[0])).collect();
        let readings = Readings::new(&times, &values);
        assert!((readings.slope(times[10], 12.0) + 0.2).abs() < 1e-9);
        assert!(readings.slope(times[0] - 100.0, 12.0).is_nan());
    }
}
