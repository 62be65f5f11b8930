//! Identification on logs of the virtual sea, whose truth is known: do the intervals hold it? A small selection runs
//! always; `IDENTIFY_SEEDS=100 cargo test -p glidepolar-tests --release --test identify_sea -- --ignored --nocapture`
//! prints the coverage over many seeds, with a measured speed, without one, and with a held lift slope that is further off
//! than its error says.

use std::collections::BTreeMap;

use glidepolar::identify::{IdentifyError, Request, Trim, identify};
use glidepolar::reading;
use glidepolar::vehicle::Vehicle;
use glidepolar_virtual_sea::{Options, generate};

/// Estimate less truth in standard errors and relative, whether the 95 % interval holds the truth, whether it was held.
struct Judged {
    z: f64,
    off: f64,
    held: bool,
    is_pinned: bool,
}

/// What the owner's file says of the lift slope.
#[derive(Clone, Copy)]
enum Owner {
    /// What the generator wrote, off by 10 to 20 %, no error stated.
    AsWritten,
    /// Off by a normal error of this share, which is stated.
    Stated(f64),
    /// Off by just this share; an error of 15 % is assumed for want of another.
    OffBy(f64),
}

/// What a user's `glidepolar identify log.csv --vehicle vehicle.toml` finds, against the truth.
struct Trial {
    judged: BTreeMap<&'static str, Judged>,
    /// Whether it says that something is missing in the model.
    warns: bool,
}

/// One trial.
///
/// # Errors
/// What it answers where it finds nothing: a glider of half the lift cannot fly as some logs do.
fn judge(seed: u64, speed: bool, owner: Owner) -> Result<Trial, IdentifyError> {
    let sea = generate(&Options { speed, ..Options::seeded(seed) });
    let folder = tempfile::tempdir().expect("a folder");
    let (log, toml) = (folder.path().join("log.csv"), folder.path().join("vehicle.toml"));
    std::fs::write(&log, sea.log.to_csv()).expect("the log");
    std::fs::write(&toml, &sea.vehicle_toml).expect("the vehicle");
    let mut vehicle = Vehicle::load(&toml.to_string_lossy()).expect("a vehicle");
    let truth = &sea.truth.vehicle;
    let mut believe = |share: f64| vehicle.set("hydro.a_per_rad", truth.a_per_rad * (1.0 + share)).expect("a key");
    match owner {
        Owner::AsWritten => (),
        Owner::OffBy(share) => believe(share),
        Owner::Stated(share) => {
            believe(share * normal(seed));
            vehicle.set("uncertainty.hydro.a_per_rad", share * truth.a_per_rad).expect("a key");
        }
    }
    let log = reading::read(&[log], &vehicle, &reading::Request::default()).expect("a log");
    let request = Request { trim: Trim::Vehicle, free: Vec::new(), pin: Vec::new(), unsteady: None };
    let found = identify(&vehicle, &log.observations, &request)?;
    let report = found.report(&vehicle, log.w_filter, log.notes);
    let warns = report.warnings.iter().any(|warning| warning.contains("how the data are weighed"));
    let judged = [("a", truth.a_per_rad), ("b", truth.b), ("c", truth.c_per_rad2), ("d", truth.d_per_rad)]
        .into_iter()
        .filter_map(|(name, truth)| {
            let q = report.parameters.get(name)?.as_ref()?;
            let held = q.ci95[0] <= truth && truth <= q.ci95[1];
            let is_pinned = report.pinned.contains_key(name);
            Some((name, Judged { z: (q.value - truth) / q.se, off: q.value / truth - 1.0, held, is_pinned }))
        })
        .collect();
    Ok(Trial { judged, warns })
}

/// A normal number of unit variance that goes with the seed: Box and Muller on two numbers of a Weyl sequence.
fn normal(seed: u64) -> f64 {
    let at = |step: f64| (seed as f64 * step).fract();
    let (u, v) = (at(0.754_877_666_246_692_8), at(0.569_840_290_998_053_3));
    (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

#[test]
fn with_measured_speed_a_and_b_lie_where_their_errors_say() {
    let mut squares = Vec::new();
    let mut held = 0;
    let mut warned = 0;
    for seed in 101..107 {
        let Trial { judged: found, warns } = judge(seed, true, Owner::AsWritten).expect("a fit");
        warned += u32::from(warns);
        for name in ["a", "b"] {
            let judged = found.get(name).unwrap_or_else(|| panic!("seed {seed}: {name} was not reported"));
            squares.push(judged.z * judged.z);
            held += u32::from(judged.held);
        }
    }
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    // Student's t with 13 degrees of freedom has a root mean square of 1.09.
    assert!((0.3..2.0).contains(&rms), "root mean square {rms:.2} standard errors");
    assert!(held >= 9, "{held} of 12 intervals hold the truth");
    // The model is the sea's own.
    assert!(warned <= 1, "{warned} of 6 fits are said to lack something");
}

#[test]
fn without_speed_the_intervals_know_that_the_held_lift_slope_may_be_off() {
    let mut held = 0;
    let mut squares = Vec::new();
    for seed in 201..207 {
        let found = judge(seed, false, Owner::Stated(0.15)).expect("a fit").judged;
        assert!(found["a"].is_pinned);
        held += u32::from(found["b"].held);
        squares.push(found["b"].z.powi(2));
    }
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!((0.2..2.0).contains(&rms), "root mean square {rms:.2} standard errors");
    assert!(held >= 5, "{held} of 6 intervals hold the truth");
}

#[test]
#[ignore = "some minutes"]
fn coverage_over_many_seeds() {
    let seeds: u64 = std::env::var("IDENTIFY_SEEDS").ok().and_then(|n| n.parse().ok()).unwrap_or(100);
    for (what, speed, owner) in [
        ("measured speed", true, Owner::AsWritten),
        ("no speed, lift slope as the owner has it, 10 to 20 % off", false, Owner::AsWritten),
        ("no speed, lift slope off by a normal 15 %, stated", false, Owner::Stated(0.15)),
        ("no speed, lift slope 30 % too small", false, Owner::OffBy(-0.3)),
        ("no speed, lift slope 30 % too large", false, Owner::OffBy(0.3)),
        ("no speed, lift slope half", false, Owner::OffBy(-0.5)),
        ("no speed, lift slope double", false, Owner::OffBy(1.0)),
    ] {
        println!("{what}");
        let mut all: BTreeMap<(&str, bool), Vec<Judged>> = BTreeMap::new();
        let mut warned = 0;
        for seed in 1000..1000 + seeds {
            match judge(seed, speed, owner) {
                Ok(found) => {
                    warned += u32::from(found.warns);
                    found.judged.into_iter().for_each(|(name, judged)| {
                        all.entry((name, judged.is_pinned)).or_default().push(judged);
                    });
                }
                Err(error) => println!("  seed {seed}: {error}"),
            }
        }
        println!("  said to lack something: {warned} of {seeds}");
        for ((name, is_pinned), judged) in all {
            let n = judged.len();
            let mean = |of: fn(&Judged) -> f64| judged.iter().map(of).sum::<f64>() / n as f64;
            println!(
                "  {name}{}: {} of {n} intervals hold the truth, rms {:.2} standard errors, off by {:+.1} % in the mean, {:.1} % rms",
                if is_pinned { ", held" } else { "" },
                judged.iter().filter(|judged| judged.held).count(),
                mean(|judged| judged.z.powi(2)).sqrt(),
                100.0 * mean(|judged| judged.off),
                100.0 * mean(|judged| judged.off.powi(2)).sqrt(),
            );
        }
    }
}
