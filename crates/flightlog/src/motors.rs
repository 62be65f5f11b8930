//! When the motors run: moves of ballast and battery, separated from the noise of their readings.
//!
//! At one row a second a noise of a few tenths of a cubic centimetre looks like a pump at work, whose rate is hardly more. So
//! a motor runs where a reading changes fast from one row to the next **and** stays changed: its means over some seconds
//! before and after differ by as much as that rate makes of these seconds, and by five of their standard errors.
//!
//! Knows the channels and their rates; not what else makes a glide unsteady.

use super::channels::{Channel, FlightLog};
use super::median;
use super::settings::PreparationSettings;

/// Rate of the ballast volume from which on its pump is taken to run \[cc/s\].
const BALLAST_MOVES_CC_S: f64 = 0.5;

/// Over so long before and after a change of the ballast volume its means are taken \[s\].
const BALLAST_OVER_S: f64 = 10.0;

/// Rate of the battery from which on its motor is taken to run \[m/s\].
const BATTERY_MOVES_M_S: f64 = 0.0005;

/// Over so long before and after a change of its position the battery's means are taken \[s\]: its moves are short.
const BATTERY_OVER_S: f64 = 2.0;

/// Standard errors of the difference of two means beyond which it is no noise: looked for in every row of a log.
const BEYOND_NOISE: f64 = 5.0;

/// Median of the difference of two readings without sign, over their standard deviation: `sqrt(2) 0.6745`.
const MEDIAN_DIFFERENCE: f64 = 0.953_9;

/// Rows at which a motor moves or has just moved.
pub(super) fn motors(log: &FlightLog, settings: &PreparationSettings) -> Vec<bool> {
    let time = log.column(Channel::Time);
    let mut moving = vec![false; log.len()];
    let mut mark = |from_s: f64, to_s: f64| {
        let first = time.partition_point(|&t| t < from_s);
        let end = time.partition_point(|&t| t <= to_s);
        moving[first..end].fill(true);
    };
    let (before, after) = (settings.motor_margin_s, settings.after_turn_s.max(settings.motor_margin_s));
    for i in moves(time, log.column(Channel::Ballast), BALLAST_MOVES_CC_S, BALLAST_OVER_S) {
        mark(time[i - 1] - before, time[i] + after);
    }
    for battery in [Channel::BatteryPosition, Channel::PitchMass] {
        for i in moves(time, log.column(battery), BATTERY_MOVES_M_S, BATTERY_OVER_S) {
            mark(time[i - 1] - before, time[i] + before);
        }
    }
    for (i, &time_s) in time.iter().enumerate() {
        if log.at(Channel::MotorMoving, i) > 0.5 {
            mark(time_s, time_s);
        }
    }
    moving
}

/// The rows up to which a reading moved from the row before.
fn moves(time: &[f64], reading: &[f64], least_rate: f64, over_s: f64) -> Vec<usize> {
    let n = reading.len();
    let mut differences: Vec<f64> =
        reading.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|difference| difference.is_finite()).collect();
    if differences.is_empty() {
        return Vec::new();
    }
    let sd = median(&mut differences) / MEDIAN_DIFFERENCE;
    // Sums before each row of the readings that are there, about the first of them so that little is lost by rounding.
    let origin = reading.iter().copied().find(|value| value.is_finite()).unwrap_or(0.0);
    let (mut counts, mut sums) = (vec![0.0; n + 1], vec![0.0; n + 1]);
    for (i, value) in reading.iter().enumerate() {
        let is_there = value.is_finite();
        counts[i + 1] = counts[i] + f64::from(u8::from(is_there));
        sums[i + 1] = sums[i] + if is_there { value - origin } else { 0.0 };
    }
    let (mut low, mut high) = (0, 0);
    let mut found = Vec::new();
    for i in 1..n {
        let step_s = time[i] - time[i - 1];
        while time[low] < time[i - 1] - over_s {
            low += 1;
        }
        while high < n && time[high] <= time[i] + over_s {
            high += 1;
        }
        if (reading[i] - reading[i - 1]).abs() / step_s <= least_rate {
            continue;
        }
        let [before, after] = [low..i, i..high].map(|rows| {
            let count = counts[rows.end] - counts[rows.start];
            ((sums[rows.end] - sums[rows.start]) / count, count)
        });
        let noise = BEYOND_NOISE * sd * (1.0 / before.1 + 1.0 / after.1).sqrt();
        if (after.0 - before.0).abs() > noise.max(least_rate * over_s.max(step_s)) {
            found.push(i);
        }
    }
    found
}
