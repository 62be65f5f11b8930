//! A ballast that is recorded when it changes, and not between: its last value stands. Knows only times and values.
//!
//! Such a record has a value in row after row while the pump runs, no two of them alike, and none for as long as it rests. One
//! that is sampled rarely has its values at even distances: what lies between those is not known.

use super::clean::median_step;

/// Values from which on a record shows how it was made.
const LEAST_VALUES: usize = 4;

/// Median number of rows from one value to the next, at most: nearly all values are of a running pump.
const ROWS_APART: f64 = 4.0;

/// Share of the time for which a pump runs at most, on the shallowest dives. A sensor that fails for a while has more values.
const MOST_OF_ROWS: f64 = 0.25;

/// Whether these values were recorded when they changed, and rest between for longer than a channel is filled \[s\].
pub(super) fn is_recorded_on_change(time_s: &[f64], values: &[f64], longest_fill_s: f64) -> bool {
    let known: Vec<(f64, f64)> =
        time_s.iter().copied().zip(values.iter().copied()).filter(|(_, v)| v.is_finite()).collect();
    let is_rare = (known.len() as f64) < MOST_OF_ROWS * values.len() as f64;
    if known.len() < LEAST_VALUES || !is_rare || known.windows(2).any(|pair| pair[0].1 == pair[1].1) {
        return false;
    }
    let times: Vec<f64> = known.iter().map(|(time_s, _)| *time_s).collect();
    let rests = times.windows(2).any(|pair| pair[1] - pair[0] > longest_fill_s);
    rests && median_step(&times) <= ROWS_APART * median_step(time_s)
}

/// Gives each row without a value the last one before it; `last` is that before the first row, and becomes that of the last.
pub(super) fn hold(values: &mut [f64], last: &mut f64) {
    for value in values {
        if value.is_finite() {
            *last = *value;
        } else {
            *value = *last;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pump that runs for 20 s every 600 s, recorded by this rule.
    fn pump(keep: impl Fn(usize, bool) -> bool) -> (Vec<f64>, Vec<f64>) {
        let at = |i: usize| (i / 600) as f64 * 100.0 + 5.0 * (i % 600).min(20) as f64;
        let values = (0..3000).map(|i| if keep(i, i == 0 || at(i) != at(i - 1)) { at(i) } else { f64::NAN });
        ((0..3000).map(|i| i as f64).collect(), values.collect())
    }

    #[test]
    fn a_record_of_changes_is_known_by_its_rows_and_one_of_few_samples_is_none() {
        let (time_s, mut values) = pump(|_, changes| changes);
        assert!(is_recorded_on_change(&time_s, &values, 120.0));
        let mut last = f64::NAN;
        hold(&mut values, &mut last);
        assert_eq!(values, pump(|_, _| true).1);
        assert_eq!(last, 500.0);
        let (_, all) = pump(|_, _| true);
        let (_, few) = pump(|i, _| i % 300 == 10);
        assert!(!is_recorded_on_change(&time_s, &all, 120.0) && !is_recorded_on_change(&time_s, &few, 120.0));
        // A sensor whose last digits differ from row to row, out of order for ten minutes.
        let is_read = |i: &usize| !(1000..1600).contains(i);
        let fails: Vec<f64> = (0..3000).map(|i| if is_read(&i) { i as f64 } else { f64::NAN }).collect();
        assert!(!is_recorded_on_change(&time_s, &fails, 120.0));
    }
}
