//! Speeds that were interpolated, and those that only look alike.

use crate::{Observation, take_out_interpolated_speeds};

use super::condensing::observations;

/// Rows every 5 s with these speeds; times a little off, as clocks are.
fn rows(count: usize, speed_m_s: impl Fn(f64) -> f64) -> Vec<Observation> {
    let any = observations(1)[0];
    let row = |i: usize| {
        let time_s = 5.0 * i as f64 + 0.3 * (i as f64).sin();
        Observation { time_s, speed_m_s: speed_m_s(time_s), steady: true, ..any }
    };
    (0..count).map(row).collect()
}

/// What a profiler has read once a minute, a number without any pattern.
fn ping(k: f64) -> f64 {
    0.3 + 0.05 * (12.9898 * k).sin() + 0.04 * (78.233 * k * k).sin()
}

const EVERY_S: f64 = 60.0;

/// How a file keeps a speed.
type Store<'a> = &'a dyn Fn(f64) -> f64;

fn by_straight_lines(time_s: f64) -> f64 {
    let (before, share) = ((time_s / EVERY_S).floor(), (time_s / EVERY_S).fract());
    ping(before) * (1.0 - share) + ping(before + 1.0) * share
}

fn rounded(speed_m_s: f64, digits: i32) -> f64 {
    (speed_m_s * 10f64.powi(digits)).round() / 10f64.powi(digits)
}

#[test]
fn the_values_between_which_a_speed_was_interpolated_come_back() {
    // As arithmetic leaves it; in the 32 bits of a NetCDF file; and as programs write it, to a millimetre per second at the
    // coarsest: a profiler's own noise is tens of times that, and a third of the bends are too weak to be seen.
    let of_32_bits = |speed_m_s: f64| f64::from(speed_m_s as f32);
    let digits = |digits: i32| move |speed_m_s: f64| rounded(speed_m_s, digits);
    let stored: [(Store<'_>, f64, usize); 5] = [
        (&|speed_m_s| speed_m_s, 1e-9, 90),
        (&of_32_bits, 1e-6, 90),
        (&digits(6), 1e-4, 90),
        (&digits(5), 1e-4, 90),
        (&digits(3), 2e-3, 60),
    ];
    for (store, within, fewest) in stored {
        let mut observations = rows(1200, |time_s| store(by_straight_lines(time_s)));
        let said = take_out_interpolated_speeds(&mut observations).expect("lines");
        assert!(said.contains("1200 values") && said.contains("interpolated"), "{said}");
        let kept: Vec<&Observation> = observations.iter().filter(|o| o.speed_m_s.is_finite()).collect();
        // One a minute, the first and the last not among them.
        assert!((fewest..=99).contains(&kept.len()), "{} of 99, within {within}", kept.len());
        for o in kept {
            let k = (o.time_s / EVERY_S).round();
            assert!((o.time_s - k * EVERY_S).abs() < 3.0, "{} s", o.time_s);
            if within < 1e-5 {
                assert!((o.speed_m_s - ping(k)).abs() < within, "{} beside {}", o.speed_m_s, ping(k));
                continue;
            }
            // Where the line hardly bends, rounded rows leave open where within a step: the value is one on the line.
            let around = (-50..=50).map(|i| by_straight_lines(o.time_s + 0.1 * f64::from(i)));
            let (low, high) = around.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
            assert!((low - within..=high + within).contains(&o.speed_m_s), "{} outside {low} to {high}", o.speed_m_s);
        }
    }
}

#[test]
fn other_speeds_stay_as_they_are() {
    let noise = |time_s: f64| 0.01 * ((7919.0 * time_s).sin() + (3571.3 * time_s).sin());
    let smooth = |time_s: f64| 0.3 - 1e-5 * time_s + 0.1 * (-((time_s / 900.0).fract() * 900.0) / 20.0).exp();
    let cases: [(&str, Vec<Observation>); 6] = [
        ("a sensor", rows(1200, |time_s| 0.3 + noise(time_s))),
        ("a sensor of three digits", rows(1200, |time_s| rounded(0.3 + noise(time_s), 3))),
        ("a sensor of two digits that repeats itself", rows(1200, |time_s| rounded(smooth(time_s), 2))),
        ("a simulation", rows(1200, smooth)),
        ("a simulation, rounded", rows(1200, |time_s| rounded(smooth(time_s), 5))),
        ("once a minute", rows(100, |time_s| ping((time_s / EVERY_S).round()))),
    ];
    for (what, observations) in cases {
        let mut looked_at = observations.clone();
        assert_eq!(take_out_interpolated_speeds(&mut looked_at), None, "{what}");
        assert!(looked_at.iter().zip(&observations).all(|(a, b)| a.speed_m_s == b.speed_m_s), "{what}");
    }
}
