//! Whether the times of a log are seconds. Spreadsheets and programs count days, or thousandths of a second, and a name
//! says nothing of it: read as seconds such times make a log of a moment, or of a thousand years. Times that were rounded,
//! `1.65514E+09`, make one moment of many rows.
//!
//! Knows times and the file that they are from.

use std::path::Path;

use super::channels::{Channel, FlightLog};
use super::clean::median_step;
use glidepolar_input::{InputError, Place};

/// Rows below which nothing is said.
const FEWEST_ROWS: usize = 20;

/// No glider writes rows faster \[s\].
const SHORTEST_STEP_S: f64 = 1e-3;

/// Later than any log of a glider by thousands of years \[s\].
const LATEST_S: f64 = 1e11;

/// Share of the rows that have the time of the row before: a table that several instruments share has two rows a time.
const MOST_REPEATED: f64 = 0.8;

/// Whether there are enough rows to judge.
pub(super) fn is_enough(log: &FlightLog) -> bool {
    log.len() >= FEWEST_ROWS
}

/// Refuses times that are no seconds.
///
/// # Errors
/// Times of another unit, named where their size shows it, and rounded times.
pub(super) fn check(path: &Path, log: &FlightLog) -> Result<(), InputError> {
    let times: Vec<f64> = log.column(Channel::Time).iter().copied().filter(|time| time.is_finite()).collect();
    if times.len() < FEWEST_ROWS {
        return Ok(());
    }
    let wrong = |problem: String, help: String| Err(InputError::new(Place::file(path), problem).help(help));
    let latest = times.iter().fold(f64::NEG_INFINITY, |most, time| most.max(*time));
    if latest > LATEST_S {
        let unit = match latest {
            ..1e14 => "ms",
            ..1e17 => "us",
            _ => "ns",
        };
        return wrong(
            format!("the times are as large as {latest:.4e}, which are no seconds since 1970 or since the start"),
            format!("are they in {unit}? state it by --unit time_s={unit}"),
        );
    }
    let step_s = median_step(&times);
    if step_s < SHORTEST_STEP_S && latest > times[0] {
        let unit = match latest {
            20_000.0..80_000.0 => "excel",
            600_000.0..900_000.0 => "matlab",
            2_400_000.0..2_600_000.0 => "julian",
            _ => "days",
        };
        return wrong(
            format!("the times advance by {step_s:.3e} from row to row, too little for seconds"),
            format!(
                "are they days? state it by --unit time_s={unit}; known are days, excel, matlab, julian, and `days since DATE`"
            ),
        );
    }
    let repeated = times.windows(2).filter(|pair| pair[0] == pair[1]).count();
    if repeated as f64 > MOST_REPEATED * times.len() as f64 {
        return wrong(
            format!("{repeated} of {} rows have the time of the row before", times.len()),
            "were the times rounded, as `1.65514E+09` in a spreadsheet or as numbers of four bytes? give them with all digits"
                .to_owned(),
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(time: impl Fn(f64) -> f64) -> String {
        let mut log = FlightLog::default();
        log.set(Channel::Time, (0..100).map(|i| time(1_655_143_200.0 + 5.0 * f64::from(i))).collect());
        check(Path::new("log.csv"), &log).map_or_else(|error| error.to_string(), |()| String::new())
    }

    #[test]
    fn times_that_are_no_seconds_are_refused_with_the_unit_that_they_have() {
        for (time, unit) in [
            (&(|t: f64| t * 1e3) as &dyn Fn(f64) -> f64, "time_s=ms"),
            (&|t: f64| t * 1e6, "time_s=us"),
            (&|t: f64| t * 1e9, "time_s=ns"),
            (&|t: f64| t / 86_400.0 + 25_569.0, "time_s=excel"),
            (&|t: f64| t / 86_400.0 + 719_529.0, "time_s=matlab"),
            (&|t: f64| t / 86_400.0 + 2_440_587.5, "time_s=julian"),
            (&|t: f64| t / 86_400.0 - 19_000.0, "time_s=days"),
            (&|t: f64| (t / 1e4).round() * 1e4, "all digits"),
            (&|t: f64| f64::from(t as f32), "all digits"),
        ] {
            let said = said(time);
            assert!(said.contains(unit) && said.contains("log.csv"), "{unit}: {said}");
        }
        for time in [&(|t: f64| t) as &dyn Fn(f64) -> f64, &|t: f64| t - 1_655_143_200.0, &|t: f64| (t / 10.0).floor()]
        {
            assert_eq!(said(time), "");
        }
    }
}
