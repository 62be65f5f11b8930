//! A measured speed that comes once a minute, and logs of a row in half a minute: on logs of the virtual sea, whose truth is
//! known. A few seeds run always; `cargo test -p glidepolar-tests --release --test sparse_speed -- --ignored --nocapture`
//! prints the coverage over forty.

use glidepolar::diagnose::sea::{Settings as DiagnosisSettings, diagnose_log};
use glidepolar::dynamics::Parameters;
use glidepolar::identify::{Identification, Request, Trim, identify};
use glidepolar::log::Observation;
use glidepolar::reading;
use glidepolar::vehicle::Vehicle;
use glidepolar_virtual_sea::{Options, Sea, generate};

/// Time from one measured speed to the next \[s\].
const MINUTE_S: f64 = 60.0;

const REQUEST: Request = Request { trim: Trim::Vehicle, free: Vec::new(), pin: Vec::new(), unsteady: None };

/// A log of the sea whose acoustic speed (scatter 3 cm/s a value) is kept once in `every_s` only.
fn sea(seed: u64, every_s: f64) -> Sea {
    let mut sea = generate(&Options::seeded(seed));
    let mut next_s = 0.0;
    let time_s = sea.log.time_s.clone();
    for (time_s, speed) in time_s.iter().zip(sea.log.speed_through_water_m_s.as_mut().expect("a speed")) {
        if *time_s >= next_s && speed.is_finite() {
            next_s = time_s + every_s;
        } else {
            *speed = f64::NAN;
        }
    }
    sea
}

/// The vehicle as its owner has it, and the observations that a user's command would have.
fn read(sea: &Sea, csv: &str) -> (Vehicle, Vec<Observation>) {
    let folder = tempfile::tempdir().expect("a folder");
    let (log, toml) = (folder.path().join("log.csv"), folder.path().join("vehicle.toml"));
    std::fs::write(&log, csv).expect("the log");
    std::fs::write(&toml, &sea.vehicle_toml).expect("the vehicle");
    let vehicle = Vehicle::load(&toml.to_string_lossy()).expect("a vehicle");
    let log = reading::read(&[log], &vehicle, &reading::Request::default()).expect("a log");
    (vehicle, log.observations)
}

/// The identification, a's interval and whether it was fitted.
fn lift_slope(vehicle: &Vehicle, found: &Identification) -> ([f64; 2], f64, bool) {
    let report = found.report(vehicle, String::new(), Vec::new());
    let a = report.parameters["a"].clone().expect("a lift slope");
    (a.ci95, a.value, !report.pinned.contains_key("a"))
}

/// Whether the interval of a, fitted to a speed once a minute, has the truth in it, and its error.
fn covers(seed: u64) -> (bool, bool, f64) {
    let sea = sea(seed, MINUTE_S);
    let (vehicle, observations) = read(&sea, &sea.log.to_csv());
    let found = identify(&vehicle, &observations, &REQUEST).expect("a fit");
    let truth = sea.truth.vehicle.a_per_rad;
    let (ci95, value, fitted) = lift_slope(&vehicle, &found);
    (ci95[0] <= truth && truth <= ci95[1], fitted, value / truth - 1.0)
}

#[test]
fn a_speed_once_a_minute_fits_the_lift_slope_with_an_interval_that_covers() {
    let found: Vec<_> = (301..305).map(covers).collect();
    assert!(found.iter().all(|(_, fitted, _)| *fitted), "{found:?}");
    assert!(found.iter().filter(|(covers, ..)| *covers).count() >= 3, "{found:?}");
}

#[test]
#[ignore = "some minutes"]
fn coverage_over_forty_logs() {
    let found: Vec<_> = (1300..1340).map(covers).collect();
    let covered = found.iter().filter(|(covers, ..)| *covers).count();
    let fitted = found.iter().filter(|(_, fitted, _)| *fitted).count();
    let rms = (found.iter().map(|(.., off)| off * off).sum::<f64>() / found.len() as f64).sqrt();
    println!("{covered} of 40 intervals of a cover, {fitted} fitted, off by {:.1} % rms", 100.0 * rms);
    assert!(covered >= 36, "{found:?}");
    assert_eq!(fitted, 40);
}

#[test]
fn a_diagnosis_uses_a_speed_that_comes_once_a_minute() {
    let sea = sea(302, MINUTE_S);
    let (vehicle, observations) = read(&sea, &sea.log.to_csv());
    let parameters: Parameters<f64> = vehicle.glide_parameters();
    let found = diagnose_log(&parameters, Trim::Vehicle, &observations, DiagnosisSettings::default());
    assert!(found.expect("a diagnosis").problem.has_speed());
}

#[test]
fn a_speed_in_one_dive_of_many_is_no_speed_to_fit_by_and_it_is_said() {
    let mut sea = generate(&Options { hours: 6.0, dives: 8, ..Options::seeded(303) });
    let dives = sea.log.dive.clone();
    let speeds = sea.log.speed_through_water_m_s.as_mut().expect("a speed");
    speeds.iter_mut().zip(&dives).filter(|(_, dive)| **dive != 3).for_each(|(speed, _)| *speed = f64::NAN);
    let (vehicle, observations) = read(&sea, &sea.log.to_csv());
    let found = identify(&vehicle, &observations, &REQUEST).expect("a fit");
    assert!(found.pinned.contains_key("a"));
    assert!(found.warnings.iter().any(|w| w.contains("measured speed is not used")), "{:?}", found.warnings);
}

/// A row in a minute has as long bins as its samples take; before, three rows of a minute were asked for.
#[test]
fn a_log_of_one_row_in_a_minute_is_diagnosed() {
    let sea = generate(&Options::seeded(304));
    let csv = sea.log.to_csv();
    let mut lines = csv.lines();
    let mut thin = vec![lines.next().expect("a header")];
    let mut next_s = 0.0;
    for line in lines {
        let time_s: f64 = line.split(',').next().and_then(|t| t.parse().ok()).expect("a time");
        if time_s >= next_s {
            next_s = time_s + MINUTE_S;
            thin.push(line);
        }
    }
    let (vehicle, observations) = read(&sea, &thin.join("\n"));
    let parameters: Parameters<f64> = vehicle.glide_parameters();
    let found = diagnose_log(&parameters, Trim::Vehicle, &observations, DiagnosisSettings::default());
    assert!(found.expect("a diagnosis").problem.n_bins() > 50);
}
