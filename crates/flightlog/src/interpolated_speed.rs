//! A column of speeds that somebody has interpolated.
//!
//! A profiler that gives a speed once a minute is often brought to the rows of a log by straight lines before anybody else
//! sees it. Between two of its values nothing was measured: where the glider pitched or turned in that minute, the line is
//! another speed than that of the glider, and a fit to it is biased, however many rows it has. Such a column shows what it is:
//! exact straight lines with sharp bends between them. The bends are what was measured, and they alone are kept.
//!
//! Knows samples and their speeds only. A smooth record without noise, as of a simulation, bends over many rows at once; a
//! sensor of few digits repeats its values. Neither is taken for interpolated.

use super::median;
use super::observation::Observation;

/// Rows that can be judged, and bends among them, below which nothing is said.
const FEWEST_ROWS: usize = 50;
const FEWEST_BENDS: usize = 10;

/// Least share of rows that lie on a line, and of these the least share whose line is not level.
const LEAST_ON_LINES: f64 = 0.6;
const LEAST_SLOPING: f64 = 0.5;

/// A bend lies on a row, or between two.
const ROWS_OF_A_BEND: usize = 2;
/// Least share of bends that are as sharp.
const LEAST_SHARP: f64 = 0.9;

/// What arithmetic makes of a straight line \[m/s\].
const ROUNDING_M_S: f64 = 1e-9;
/// By how much a row on a line may lie off it where all three were rounded, in the largest error of one: its own, and at most
/// that of its neighbours.
const ROUNDINGS: f64 = 2.02;
/// A step between rows in which there is one bend at most, in usual steps.
const USUAL_STEPS: f64 = 1.5;

/// Digits after the point of a speed in m/s, at most, of a column that was rounded; one of fewer than the least is too coarse
/// to be judged.
const DIGITS: std::ops::RangeInclusive<i32> = 3..=8;

/// A bend: when, and the speed there.
type Bend = (f64, f64);

/// Keeps of an interpolated speed what was measured, each value in the row nearest to it; what was done, in a sentence.
pub fn take_out_interpolated_speeds(observations: &mut [Observation]) -> Option<String> {
    let rows: Vec<usize> = (0..observations.len()).filter(|&i| observations[i].speed_m_s.is_finite()).collect();
    let speeds: Vec<Bend> = rows.iter().map(|&i| (observations[i].time_s, observations[i].speed_m_s)).collect();
    let bends = bends(&speeds)?;
    rows.iter().for_each(|&i| observations[i].speed_m_s = f64::NAN);
    let mut kept = 0;
    for (time_s, speed_m_s) in bends {
        let after = rows.partition_point(|&i| observations[i].time_s < time_s);
        let near = rows[after.saturating_sub(1)..(after + 1).min(rows.len())].iter().copied();
        let distance = |i: usize| (observations[i].time_s - time_s).abs();
        if let Some(row) = near.min_by(|&a, &b| distance(a).total_cmp(&distance(b))) {
            kept += usize::from(observations[row].speed_m_s.is_nan());
            observations[row].speed_m_s = speed_m_s;
        }
    }
    Some(format!(
        "the measured speed is interpolated: its {} values lie on straight lines between {kept}, which alone are used",
        rows.len()
    ))
}

/// The bends of a record of straight lines; nothing where it is no such record.
fn bends(speeds: &[Bend]) -> Option<Vec<Bend>> {
    if speeds.len() < FEWEST_ROWS {
        return None;
    }
    let tolerance = tolerance_m_s(speeds)?;
    // Rows that lie off the line between their neighbours, the first and the last not among them.
    let off: Vec<bool> = speeds.windows(3).map(|three| off_line(three) > tolerance).collect();
    let on_lines = off.iter().filter(|off| !**off).count();
    let is_sloping = |three: &[Bend]| (three[2].1 - three[0].1).abs() > 2.0 * tolerance;
    let sloping = speeds.windows(3).zip(&off).filter(|(three, off)| !**off && is_sloping(three)).count();
    let groups: Vec<(usize, usize)> = groups(&off);
    let sharp = groups.iter().filter(|group| rows_of(**group) <= ROWS_OF_A_BEND).count();
    let is_interpolated = on_lines as f64 >= LEAST_ON_LINES * off.len() as f64
        && sloping as f64 >= LEAST_SLOPING * on_lines as f64
        && groups.len() >= FEWEST_BENDS
        && sharp as f64 >= LEAST_SHARP * groups.len() as f64;
    let mut steps_s: Vec<f64> = speeds.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    let longest_step_s = USUAL_STEPS * median(&mut steps_s);
    let bend = |k: usize| {
        // Row i + 1 of the record is off its line where `off[i]` is true. A line reaches from the last row off its line on
        // one side to the first on the other.
        let begin = k.checked_sub(1).map_or(0, |before| groups[before].1);
        let end = groups.get(k + 1).map_or(speeds.len() - 1, |after| after.0 + 1);
        let (first, last) = (groups[k].0 + 1, groups[k].1);
        bend_between([speeds[begin], speeds[first]], [speeds[last], speeds[end]], tolerance, longest_step_s)
    };
    is_interpolated
        .then(|| (0..groups.len()).filter(|&k| rows_of(groups[k]) <= ROWS_OF_A_BEND).filter_map(bend).collect())
}

/// How many rows off their lines a group has.
fn rows_of((first, end): (usize, usize)) -> usize {
    end - first
}

/// Runs of rows that are off their lines: first, and one behind the last.
fn groups(off: &[bool]) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for i in (0..off.len()).filter(|&i| off[i]) {
        match found.last_mut() {
            Some((_, end)) if *end == i => *end = i + 1,
            _ => found.push((i, i + 1)),
        }
    }
    found
}

/// Where a line through two rows meets the next one, in the step between them; nothing where that does not say where the
/// bend is.
fn bend_between(left: [Bend; 2], right: [Bend; 2], tolerance: f64, longest_step_s: f64) -> Option<Bend> {
    let (before, after) = (left[1], right[0]);
    if before == after {
        return Some(before);
    }
    let [left, right] = [left, right].map(|[a, b]| (b.1 - a.1) / (b.0 - a.0));
    let between_s = after.0 - before.0;
    let since_s = (after.1 - before.1 - right * between_s) / (left - right);
    // In a longer step may be several bends.
    let is_one = between_s <= longest_step_s && (left - right).abs() * between_s > tolerance;
    (is_one && (0.0..=between_s).contains(&since_s)).then_some((before.0 + since_s, before.1 + left * since_s))
}

/// By how much the middle one of three rows lies off the line between the others \[m/s\].
fn off_line(three: &[Bend]) -> f64 {
    let [a, b, c] = [three[0], three[1], three[2]];
    let share = (b.0 - a.0) / (c.0 - a.0);
    (b.1 - a.1 - share * (c.1 - a.1)).abs()
}

/// By how much a row on a line may lie off it by the rounding of its numbers \[m/s\]; nothing where the record is too coarse
/// to say.
fn tolerance_m_s(speeds: &[Bend]) -> Option<f64> {
    let is_rounded_to = |digits: i32| {
        let unit = 10f64.powi(digits);
        speeds.iter().all(|(_, speed)| ((speed * unit).round() - speed * unit).abs() < 1e-5)
    };
    if is_rounded_to(DIGITS.start() - 1) {
        return None;
    }
    if let Some(digits) = DIGITS.into_iter().find(|&digits| is_rounded_to(digits)) {
        return Some(ROUNDINGS * 0.5 * 10f64.powi(-digits));
    }
    // Files of NetCDF keep speeds in 32 bits, of which 24 are the number's.
    let is_of_32_bits = speeds.iter().all(|&(_, speed)| f64::from(speed as f32) == speed);
    let largest = speeds.iter().fold(0.0, |largest: f64, (_, speed)| largest.max(speed.abs()));
    Some(if is_of_32_bits { ROUNDINGS * 0.5 * largest * f64::from(f32::EPSILON) } else { ROUNDING_M_S })
}
