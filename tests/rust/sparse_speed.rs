//! A measured speed that comes once a minute, and logs of a row in half a minute: on logs of the virtual sea, whose truth is
//! known. A few seeds run always; `cargo test -p glidepolar-tests --release --test sparse_speed -- --ignored --nocapture`
//! prints the coverage over forty.

use glidepolar::diagnose::sea::{DiagnosisSettings, diagnose_log};
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

/// What is done with a speed that comes once a minute before it is fitted.
#[derive(Clone, Copy)]
enum Speeds {
    AsTheyCome,
    /// Each value repeated until the next, in the log that is read.
    ForwardFilled,
    /// Straight lines in the log that is read.
    Interpolated,
    /// Straight lines that the fit takes for measured.
    InterpolatedUnnoticed,
}

/// Straight lines between the speeds that are there.
fn straight_lines(times_s: &[f64], speeds: &mut [f64]) {
    let known: Vec<usize> = (0..speeds.len()).filter(|&i| speeds[i].is_finite()).collect();
    for pair in known.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let slope = (speeds[b] - speeds[a]) / (times_s[b] - times_s[a]);
        (a + 1..b).for_each(|i| speeds[i] = speeds[a] + slope * (times_s[i] - times_s[a]));
    }
}

/// Each speed repeated until the next.
fn repeated(speeds: &mut [f64]) {
    let mut last = f64::NAN;
    for speed in speeds {
        last = if speed.is_finite() { *speed } else { last };
        *speed = last;
    }
}

/// Whether the interval of a, fitted to a speed once a minute, has the truth in it, and its error.
fn covers(seed: u64, how: Speeds) -> (bool, bool, f64) {
    let mut sea = sea(seed, MINUTE_S);
    let speeds = sea.log.speed_through_water_m_s.as_mut().expect("a speed");
    match how {
        Speeds::Interpolated => straight_lines(&sea.log.time_s, speeds),
        Speeds::ForwardFilled => repeated(speeds),
        Speeds::AsTheyCome | Speeds::InterpolatedUnnoticed => {}
    }
    let (vehicle, mut observations) = read(&sea, &sea.log.to_csv());
    if let Speeds::InterpolatedUnnoticed = how {
        let (times, mut speeds): (Vec<f64>, Vec<f64>) = observations.iter().map(|o| (o.time_s, o.speed_m_s)).unzip();
        straight_lines(&times, &mut speeds);
        observations.iter_mut().zip(speeds).for_each(|(o, speed_m_s)| o.speed_m_s = speed_m_s);
    }
    let found = identify(&vehicle, &observations, &REQUEST).expect("a fit");
    let truth = sea.truth.vehicle.a_per_rad;
    let (ci95, value, fitted) = lift_slope(&vehicle, &found);
    (ci95[0] <= truth && truth <= ci95[1], fitted, value / truth - 1.0)
}

#[test]
fn a_speed_once_a_minute_fits_the_lift_slope_with_an_interval_that_covers() {
    for how in [Speeds::AsTheyCome, Speeds::ForwardFilled, Speeds::Interpolated] {
        let found: Vec<_> = (301..305).map(|seed| covers(seed, how)).collect();
        assert!(found.iter().all(|(_, fitted, _)| *fitted), "{found:?}");
        assert!(found.iter().filter(|(covers, ..)| *covers).count() >= 3, "{found:?}");
    }
}

/// Between its values a speed that was interpolated is no measurement: the same fit comes of it as without the lines.
#[test]
fn an_interpolated_speed_is_fitted_by_the_values_between_which_it_was_interpolated() {
    let lift_slope = |interpolated: bool| {
        let mut sea = sea(305, MINUTE_S);
        if interpolated {
            straight_lines(&sea.log.time_s, sea.log.speed_through_water_m_s.as_mut().expect("a speed"));
        }
        let (vehicle, observations) = read(&sea, &sea.log.to_csv());
        let found = identify(&vehicle, &observations, &REQUEST).expect("a fit");
        let report = found.report(&vehicle, String::new(), Vec::new());
        let a = report.parameters["a"].clone().expect("a lift slope");
        (a.value, a.se, report.rows["speed"].values)
    };
    let (sparse, interpolated) = (lift_slope(false), lift_slope(true));
    assert!((sparse.0 - interpolated.0).abs() < 0.3 * sparse.1, "{sparse:?} {interpolated:?}");
    assert!(interpolated.2 <= sparse.2, "{sparse:?} {interpolated:?}");
}

/// A value that is repeated until the next one is one measurement: the same fit comes of it as without the repetitions.
#[test]
fn a_repeated_speed_is_fitted_as_the_values_that_were_measured() {
    let fit = |is_repeated: bool| {
        let mut sea = sea(306, MINUTE_S);
        if is_repeated {
            repeated(sea.log.speed_through_water_m_s.as_mut().expect("a speed"));
        }
        let (vehicle, observations) = read(&sea, &sea.log.to_csv());
        let found = identify(&vehicle, &observations, &REQUEST).expect("a fit");
        let report = found.report(&vehicle, String::new(), Vec::new());
        let a = report.parameters["a"].clone().expect("a lift slope");
        (a.value, a.se, report.rows["speed"].values)
    };
    // Two values that are alike and follow one another are one run.
    let (repeated, sparse) = (fit(true), fit(false));
    assert!((repeated.0 - sparse.0).abs() < 0.1 * sparse.1, "{sparse:?} {repeated:?}");
    assert!((repeated.1 / sparse.1 - 1.0).abs() < 0.05, "{sparse:?} {repeated:?}");
    assert!(repeated.2 <= sparse.2 && repeated.2 as f64 > 0.98 * sparse.2 as f64, "{sparse:?} {repeated:?}");
}

#[test]
#[ignore = "some minutes"]
fn coverage_over_forty_logs() {
    for (what, how) in [
        ("once a minute", Speeds::AsTheyCome),
        ("repeated until the next", Speeds::ForwardFilled),
        ("interpolated", Speeds::Interpolated),
        ("interpolated, taken for measured", Speeds::InterpolatedUnnoticed),
    ] {
        let found: Vec<_> = (1300..1340).map(|seed| covers(seed, how)).collect();
        let covered = found.iter().filter(|(covers, ..)| *covers).count();
        let fitted = found.iter().filter(|(_, fitted, _)| *fitted).count();
        let mean = 100.0 * found.iter().map(|(.., off)| off).sum::<f64>() / found.len() as f64;
        let rms = 100.0 * (found.iter().map(|(.., off)| off * off).sum::<f64>() / found.len() as f64).sqrt();
        println!("{what}: {covered} of 40 intervals of a cover, {fitted} fitted, off by {mean:+.1} %, {rms:.1} % rms");
        assert!(covered >= 36 || matches!(how, Speeds::InterpolatedUnnoticed), "{found:?}");
        assert!(fitted == 40 || matches!(how, Speeds::InterpolatedUnnoticed), "{found:?}");
    }
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
