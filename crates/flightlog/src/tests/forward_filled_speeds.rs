//! Speeds that were repeated until the next one, and those that only look alike.

use super::preparing::saw_tooth;
use crate::{Channel, FlightLog, ForwardFilled};

/// Dives of 300 s each way, a row a second, with these speeds.
fn log(speed_m_s: impl Fn(usize) -> f64) -> FlightLog {
    let mut log = saw_tooth(6);
    let speeds = (0..log.len()).map(speed_m_s).collect();
    log.set(Channel::Speed, speeds);
    log
}

/// A number without any pattern, rounded to so many digits.
fn ping(k: usize, digits: i32) -> f64 {
    let k = k as f64;
    let unit = 10f64.powi(digits);
    ((0.3 + 0.05 * (12.9898 * k).sin() + 0.04 * (78.233 * k * k).sin()) * unit).round() / unit
}

fn kept(mut log: FlightLog, rows: usize) -> (Vec<f64>, Option<String>) {
    let mut filter = ForwardFilled::default();
    let mut speeds = Vec::new();
    while !log.is_empty() {
        let rest = log.part(rows.min(log.len())..log.len());
        log.truncate(rows);
        filter.take_out(&mut log);
        speeds.extend_from_slice(log.column(Channel::Speed));
        log = rest;
    }
    (speeds, filter.report())
}

#[test]
fn a_run_is_one_measurement_at_its_first_time() {
    // Two digits are a step of 1 cm/s, a third of the scatter.
    for (every, digits) in [(2, 4), (5, 15), (30, 4), (60, 3), (60, 2)] {
        let (speeds, said) = kept(log(|i| ping(i / every, digits)), usize::MAX);
        let said = said.expect("repetitions");
        assert!(said.contains("3600 values") && said.contains("each used once"), "{said}");
        for (i, speed) in speeds.iter().enumerate() {
            let is_first = i % every == 0 && (i == 0 || ping(i / every, digits) != ping(i / every - 1, digits));
            assert_eq!(speed.is_finite(), is_first, "row {i}, one in {every}");
            assert!(!is_first || *speed == ping(i / every, digits));
        }
    }
}

#[test]
fn pieces_of_a_log_give_what_the_whole_gives() {
    let whole = kept(log(|i| ping(i / 30, 4)), usize::MAX);
    for rows in [613, 1000, 1800] {
        let pieces = kept(log(|i| ping(i / 30, 4)), rows);
        assert_eq!(format!("{whole:?}"), format!("{pieces:?}"), "{rows}");
    }
}

#[test]
fn gaps_end_a_run() {
    // Repeated for ten seconds at most, then missing.
    let (speeds, said) = kept(log(|i| if i % 60 < 10 { 0.3 + 1e-4 * (i / 600) as f64 } else { f64::NAN }), usize::MAX);
    assert_eq!(said, None, "steps of the last digit");
    assert_eq!(speeds.iter().filter(|speed| speed.is_finite()).count(), 600);
    let (speeds, said) = kept(log(|i| if i % 60 < 40 { ping(i / 20, 4) } else { f64::NAN }), usize::MAX);
    assert!(said.is_some());
    assert_eq!(speeds.iter().filter(|speed| speed.is_finite()).count(), 120);
}

#[test]
fn other_speeds_stay_as_they_are() {
    let noise = |i: usize| 0.01 * ((7919.0 * i as f64).sin() + (3571.3 * i as f64).sin());
    let smooth = |i: usize| 0.3 + 0.1 * (-((i % 300) as f64) / 40.0).exp() - 1e-5 * (i % 300) as f64;
    let rounded = |speed: f64, digits: i32| (speed * 10f64.powi(digits)).round() / 10f64.powi(digits);
    let cases: [(&str, FlightLog); 7] = [
        ("a sensor", log(|i| 0.3 + noise(i))),
        ("a sensor of three digits", log(|i| rounded(0.3 + noise(i), 3))),
        ("a sensor of two digits that repeats itself", log(|i| rounded(0.3 + noise(i), 2))),
        ("a simulation", log(smooth)),
        ("a simulation of two digits", log(|i| rounded(smooth(i), 2))),
        ("one speed on each leg", log(|i| ping(i / 300, 4))),
        ("once a minute", log(|i| if i % 60 == 0 { ping(i / 60, 4) } else { f64::NAN })),
    ];
    for (what, log) in cases {
        let before = log.column(Channel::Speed).to_vec();
        let (speeds, said) = kept(log, usize::MAX);
        assert_eq!(said, None, "{what}");
        assert_eq!(format!("{before:?}"), format!("{speeds:?}"), "{what}");
    }
}
