//! Vertical velocities of logs that have a depth, alone or beside pressures.

use super::preparing::{SINK_DBAR_S, prepared, saw_tooth};
use super::*;

/// Metres that a saw-tooth's pressure stands for.
const M_PER_DBAR: f64 = 0.9945;

/// The largest difference between the vertical velocity and that of the saw-tooth, in steady rows \[m/s\].
fn largest_error(found: &[Observation], sink_m_s: f64) -> f64 {
    let steady: Vec<&Observation> = found.iter().filter(|o| o.steady).collect();
    assert!(steady.len() > 100, "{} steady rows", steady.len());
    let error = |o: &&Observation| (o.sink_m_s.abs() - sink_m_s).abs();
    steady.iter().map(error).fold(0.0, f64::max)
}

/// A saw-tooth with a depth in each row, off by this much, with a pressure in the rows that `pressure` says, and with this density.
fn with_depth(offset_m: f64, pressure: fn(usize) -> bool, density: fn(usize) -> Option<f64>) -> FlightLog {
    let mut log = saw_tooth(3);
    let read = log.column(Channel::Pressure).to_vec();
    log.set(Channel::Depth, read.iter().map(|p| p * M_PER_DBAR + offset_m).collect());
    log.set(Channel::Pressure, (0..read.len()).map(|i| if pressure(i) { read[i] } else { f64::NAN }).collect());
    log.set(Channel::Density, (0..read.len()).map(|i| density(i).unwrap_or(f64::NAN)).collect());
    log
}

/// Water that is light above and dense below, of which only every fourth row has a density.
#[test]
fn a_depth_has_its_own_velocity_whatever_density_a_row_has() {
    let density =
        |i: usize| i.is_multiple_of(4).then(|| 1022.0 + 6.0 * f64::from(u8::from(i % 600 > 100 && i % 600 < 500)));
    let found = prepared(with_depth(0.0, |_| false, density)).0;
    assert!(largest_error(&found, SINK_DBAR_S * M_PER_DBAR) < 1e-9);
}

/// A depth between two pressures is another sensor's: mixed, the two would jump.
#[test]
fn depths_between_pressures_change_nothing() {
    let expected = SINK_DBAR_S * 1e4 / (1025.0 * 9.81);
    let found = prepared(with_depth(0.3, |i| i.is_multiple_of(3), |_| Some(1025.0))).0;
    assert!(largest_error(&found, expected) < 1e-9);
}

/// Where the pressure fails for two whole ascents its depths stand in, though their zero is another.
#[test]
fn depths_stand_in_where_the_pressure_fails_for_long() {
    let expected = SINK_DBAR_S * 1e4 / (1025.0 * 9.81);
    let found = prepared(with_depth(0.3, |i| i % 600 < 300 || i > 1500, |_| Some(1025.0))).0;
    let ascending = found.iter().filter(|o| o.steady && o.sink_m_s < 0.0).count();
    assert!(ascending > 3 * 180, "{ascending}");
    // A zero of 0.3 m on one of them, in depths of 30 to 60 m, is 0.7 % of the scale.
    assert!(largest_error(&found, expected) < 0.01 * expected);
}

/// A record of two computers, row by row in turn: pressure and water of one, attitude and ballast of the other.
#[test]
fn rows_of_two_computers_are_one_record() {
    let mut log = saw_tooth(3);
    for channel in [Channel::Pitch, Channel::Ballast] {
        log.column_mut(channel).iter_mut().step_by(2).for_each(|value| *value = f64::NAN);
    }
    for channel in [Channel::Pressure, Channel::Density] {
        log.column_mut(channel).iter_mut().skip(1).step_by(2).for_each(|value| *value = f64::NAN);
    }
    let found = prepared(log).0;
    assert!(largest_error(&found, SINK_DBAR_S * 1e4 / (1025.0 * 9.81)) < 1e-9);
}

/// A ballast with a value only where it changes: the saw-tooth's pump turns at once.
#[test]
fn a_ballast_recorded_when_it_changes_stands_between() {
    let mut log = saw_tooth(3);
    let whole = prepared(log.clone()).0;
    let mut last = f64::NAN;
    for (i, value) in log.column_mut(Channel::Ballast).iter_mut().enumerate() {
        // The pump takes three rows.
        let ran = *value + if i % 300 < 3 { 10.0 * (2 - i % 300) as f64 } else { 0.0 };
        *value = if ran == last { f64::NAN } else { ran };
        last = ran;
    }
    let found = prepared(log).0;
    let steady = |found: &[Observation]| found.iter().filter(|o| o.steady).count();
    // A few rows after each turn are those of a pump that runs.
    assert!(steady(&found) + 20 > steady(&whole), "{} of {} rows", steady(&found), steady(&whole));
    for o in found.iter().filter(|o| o.steady) {
        let ballast_m3 = if o.sink_m_s > 0.0 { -2e-4 } else { 2e-4 };
        assert!((o.ballast_m3 - ballast_m3).abs() < 1e-12, "{o:?}");
    }
}
