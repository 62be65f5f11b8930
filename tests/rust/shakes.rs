//! The numbers of `docs/theory/shakes.md`: the Simulink paper's run, and the eigenvalues that its "shakes" are.

#[path = "../../examples/shakes/run.rs"]
mod run;

use std::f64::consts::PI;

use glidepolar::dynamics::{Actuation, Parameters};
use glidepolar::simulate::Row;
use glidepolar::vehicle::Vehicle;
use run::Kept;

fn adelaide() -> Parameters<f64> {
    Vehicle::load("adelaide").unwrap().parameters().unwrap()
}

/// Slope and scatter of a straight line through points.
fn line(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let (xy, xx) = points.iter().fold((0.0, 0.0), |(xy, xx), p| (xy + (p.0 - x) * (p.1 - y), xx + (p.0 - x).powi(2)));
    xy / xx
}

#[test]
fn a_mass_that_is_locked_is_stable_and_one_under_constant_force_is_not() {
    let p = adelaide();
    for angle in [-25.0, 25.0] {
        assert!(run::eigenvalues(&p, angle, Kept::Locked).iter().all(|e| e.0 < -0.02), "{angle}");
        assert!(run::eigenvalues(&p, angle, Kept::ForceAlongAxis1)[0].0 > 0.05, "{angle}");
    }
    assert!(run::eigenvalues(&p, 25.0, Kept::Forces)[0].0 > 0.3);
}

#[test]
fn disturbances_grow_in_flight_as_the_eigenvalues_say() {
    let p = adelaide();
    let (growth, frequency) = run::eigenvalues(&p, -25.0, Kept::ForceAlongAxis1)[0];
    let flown = run::onset(&p, -25.0, 1e-6, 140.0).unwrap();
    let peaks: Vec<(f64, f64)> = flown
        .windows(3)
        .filter(|w| w[1].1.abs() > w[0].1.abs() && w[1].1.abs() >= w[2].1.abs() && w[1].0 > 25.0)
        .map(|w| (w[1].0, w[1].1.abs().ln()))
        .collect();
    assert!(peaks.len() >= 7, "{peaks:?}");
    assert!((line(&peaks) / growth - 1.0).abs() < 0.01, "grows at {} 1/s, eigenvalue {growth}", line(&peaks));
    let half_period = (peaks[peaks.len() - 1].0 - peaks[0].0) / (peaks.len() - 1) as f64;
    assert!((half_period * frequency / PI - 1.0).abs() < 0.01, "{half_period} s, eigenvalue {frequency}");

    let (growth, frequency) = run::eigenvalues(&p, 25.0, Kept::ForceAlongAxis1)[0];
    assert_eq!(frequency, 0.0);
    let flown = run::onset(&p, 25.0, 1e-6, 45.0).unwrap();
    let late: Vec<(f64, f64)> = flown.iter().filter(|p| p.0 > 30.0).map(|p| (p.0, p.1.abs().ln())).collect();
    assert!((line(&late) / growth - 1.0).abs() < 0.01, "grows at {} 1/s, eigenvalue {growth}", line(&late));
}

#[test]
fn without_force_on_the_mass_the_pulses_make_no_glide() {
    let run = run::run(&adelaide(), Actuation::RawAlongAxis1).unwrap();
    assert!(run.stopped_s.is_some_and(|time| time < 60.0), "{:?}", run.stopped_s);
    let (low, high) = extremes(&run.rows, 3);
    assert!(low.to_degrees() < -60.0 && high.to_degrees() > 60.0, "{low} {high}");
}

#[test]
fn with_the_mass_placed_the_same_pulses_make_the_sawtooth_of_the_closed_forms() {
    let run = run::run(&adelaide(), Actuation::Servo).unwrap();
    assert_eq!(run.stopped_s, None);
    for leg in 0..run::LEGS {
        let end = ((leg + 1) as f64 * run::LEG_S) as usize - 2;
        let down = if leg % 2 == 0 { 1.0 } else { -1.0 };
        let row = &run.rows[end];
        // Steady glide at 25 deg and 0.30 m/s: pitch 22.97735 deg, net mass 47.349 g, evaluated independently.
        assert!((row[3].to_degrees() + down * 22.977_35).abs() < 0.02, "leg {leg}: pitch {}", row[3].to_degrees());
        assert!((row[11] - down * 0.047_349).abs() < 2e-6, "leg {leg}: net mass {}", row[11]);
        assert!((row[8] - down * 0.30 * 25f64.to_radians().sin()).abs() < 2e-4, "leg {leg}: sinks at {}", row[8]);
    }
    let deepest = extremes(&run.rows, 1);
    assert!((deepest.1 - deepest.0 - 44.5).abs() < 1.0, "{deepest:?}");
}

fn extremes(rows: &[Row], column: usize) -> (f64, f64) {
    rows.iter()
        .map(|row| row[column])
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}
