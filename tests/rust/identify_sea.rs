//! Identification on logs of the virtual sea, whose truth is known: do the intervals hold it? A small selection runs
//! always; `IDENTIFY_SEEDS=100 cargo test -p glidepolar-tests --release --test identify_sea -- --ignored --nocapture`
//! prints the coverage over many seeds.

use std::collections::BTreeMap;

use glidepolar::identify::{Request, Trim, identify};
use glidepolar::log::{Columns, Opened, Preparation, Settings, open};
use glidepolar::vehicle::Vehicle;
use glidepolar_virtual_sea::{Options, generate};

/// Estimate less truth in standard errors, and whether the 95 % interval holds the truth.
struct Judged {
    z: f64,
    held: bool,
}

/// What a user's `glidepolar identify log.csv --vehicle vehicle.toml` finds, against the truth.
fn judge(seed: u64, speed: bool) -> BTreeMap<&'static str, Judged> {
    let sea = generate(&Options { speed, ..Options::seeded(seed) });
    let folder = tempfile::tempdir().expect("a folder");
    let (log, toml) = (folder.path().join("log.csv"), folder.path().join("vehicle.toml"));
    std::fs::write(&log, sea.log.to_csv()).expect("the log");
    std::fs::write(&toml, &sea.vehicle_toml).expect("the vehicle");
    let vehicle = Vehicle::load(&toml.to_string_lossy()).expect("a vehicle");
    let Opened::Series(mut series) = open(&log, &Columns::default()).expect("a log") else { panic!("a time series") };
    let mut preparation = Preparation::new(Settings::default());
    let mut observations = Vec::new();
    while let Some(piece) = series.next_piece(20_000).expect("a piece") {
        preparation.push(piece, &mut observations);
    }
    preparation.finish(&mut observations);
    let request = Request { trim: Trim::Vehicle, free: Vec::new(), pin: Vec::new(), unsteady: None };
    let found = identify(&vehicle, &observations, &request).expect("a fit");
    let report = found.report(&vehicle, preparation.filter(), Vec::new());
    let truth = &sea.truth.vehicle;
    [("a", truth.a_per_rad), ("b", truth.b), ("c", truth.c_per_rad2)]
        .into_iter()
        .filter(|(name, _)| !report.pinned.contains_key(*name))
        .filter_map(|(name, truth)| {
            let q = report.parameters.get(name)?.as_ref()?;
            let held = q.ci95[0] <= truth && truth <= q.ci95[1];
            Some((name, Judged { z: (q.value - truth) / q.se, held }))
        })
        .collect()
}

#[test]
fn with_measured_speed_a_and_b_lie_where_their_errors_say() {
    let mut squares = Vec::new();
    let mut held = 0;
    for seed in 101..107 {
        let found = judge(seed, true);
        for name in ["a", "b"] {
            let judged = found.get(name).unwrap_or_else(|| panic!("seed {seed}: {name} was not told"));
            squares.push(judged.z * judged.z);
            held += u32::from(judged.held);
        }
    }
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    // Student's t with 13 degrees of freedom has a root mean square of 1.09.
    assert!((0.3..2.0).contains(&rms), "root mean square {rms:.2} standard errors");
    assert!(held >= 9, "{held} of 12 intervals hold the truth");
}

#[test]
#[ignore = "some minutes"]
fn coverage_over_many_seeds() {
    let seeds: u64 = std::env::var("IDENTIFY_SEEDS").ok().and_then(|n| n.parse().ok()).unwrap_or(100);
    for speed in [true, false] {
        let mut count: BTreeMap<&str, (u32, u32, f64)> = BTreeMap::new();
        for seed in 1000..1000 + seeds {
            for (name, judged) in judge(seed, speed) {
                let all = count.entry(name).or_default();
                *all = (all.0 + 1, all.1 + u32::from(judged.held), all.2 + judged.z * judged.z);
            }
        }
        println!("measured speed: {speed}");
        for (name, (n, held, squares)) in count {
            println!(
                "{name}: {held} of {n} intervals hold the truth, rms {:.2} standard errors",
                (squares / f64::from(n)).sqrt()
            );
        }
    }
}
