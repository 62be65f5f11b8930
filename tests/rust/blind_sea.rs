//! The diagnosis on logs whose hidden effect it is not told: the virtual sea draws size and sign from a seed and hands
//! over files alone. A fixed selection runs always; `cargo test -p glidepolar-tests --release --test blind_sea --
//! --ignored --nocapture` prints the table of confusions over `BLIND_SEEDS` seeds (20) of every effect.

use std::collections::BTreeMap;
use std::path::Path;

use glidepolar::diagnose::sea::{SeaProblem, Settings};
use glidepolar::diagnose::{Diagnosis, diagnose};
use glidepolar::identify::Trim;
use glidepolar::log::{Columns, Opened, Preparation, open};
use glidepolar::vehicle::Vehicle;
use glidepolar_virtual_sea::Options;

/// Effects that the diagnosis must be able to name with measured speed.
const CATALOGUED: &[&str] = &[
    "ballast_offset",
    "hull_compressibility",
    "thermal_expansion",
    "ballast_scale",
    "pitch_offset",
    "pitch_scale",
    "drag_growth",
    "drag_step",
    "reynolds_drag",
    "climb_dive_asymmetry",
    "trapped_air",
    "leak",
    "vertical_current",
];

/// Effects without a name in the catalogue of mechanisms.
const UNCATALOGUED: &[&str] = &[
    "uncatalogued-compass-pitch",
    "uncatalogued-layer",
    "uncatalogued-sloughing",
    "uncatalogued-tide",
    "uncatalogued-wing-stall",
    "uncatalogued-warm-ballast-reading",
];

/// Hides an effect, writes the files, reads them back and asks.
fn blind(effect: &str, seed: u64, speed: bool) -> (Diagnosis, Option<f64>) {
    let effects = glidepolar_virtual_sea::catalogue::parse_requests(effect).expect("an effect of the virtual sea");
    let sea = glidepolar_virtual_sea::generate(&Options { effects, speed, ..Options::seeded(seed) });
    let size = CATALOGUED
        .contains(&effect)
        .then(|| glidepolar::mechanisms::at_sea(effect).and_then(|mechanism| mechanism.parameters.first()))
        .flatten()
        .and_then(|parameter| sea.truth.parameter(parameter));
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("log.csv"), sea.log.to_csv()).expect("the log");
    std::fs::write(folder.path().join("vehicle.toml"), &sea.vehicle_toml).expect("the vehicle");
    (ask(folder.path()), size)
}

/// What a user's `glidepolar diagnose log.csv --vehicle vehicle.toml` does.
fn ask(folder: &Path) -> Diagnosis {
    let vehicle = Vehicle::load(&folder.join("vehicle.toml").to_string_lossy()).expect("a vehicle");
    let Opened::Series(mut series) = open(folder.join("log.csv"), &Columns::default()).expect("a log") else {
        panic!("a time series");
    };
    let mut observations = Vec::new();
    let mut preparation = Preparation::new(glidepolar::log::Settings::default());
    while let Some(piece) = series.next_piece(100_000).expect("a piece") {
        preparation.push(piece, &mut observations);
    }
    preparation.finish(&mut observations);
    let baseline = Trim::Vehicle.baseline(&vehicle.glide_parameters(), &observations);
    diagnose(&SeaProblem::new(&observations, &baseline, Settings::default()).expect("a problem")).0
}

/// The name that stands first, or what is said instead of one.
fn first(found: &Diagnosis) -> String {
    match (found.causes.first(), &found.unexplained) {
        (Some(cause), _) => cause.cause.clone(),
        (None, Some(_)) => "unexplained".to_owned(),
        (None, None) => "none".to_owned(),
    }
}

#[test]
fn with_measured_speed_the_hidden_effect_is_named() {
    let wrong: Vec<String> = CATALOGUED
        .iter()
        .filter_map(|effect| {
            let (found, _) = blind(effect, 11, true);
            let name = first(&found);
            (name != *effect).then(|| format!("{effect} was called {name}"))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("; "));
}

#[test]
fn where_nothing_is_hidden_nothing_is_named() {
    for seed in [21, 22] {
        assert_eq!(first(&blind("none", seed, true).0), "none", "seed {seed}");
    }
}

#[test]
fn an_effect_without_a_name_gets_none() {
    for effect in ["uncatalogued-compass-pitch", "uncatalogued-layer", "uncatalogued-tide"] {
        let name = first(&blind(effect, 31, true).0);
        assert!(["none", "unexplained"].contains(&name.as_str()), "{effect} was called {name}");
    }
}

#[test]
#[ignore = "some 700 logs, half an hour"]
fn the_table_of_confusions() {
    let seeds: u64 = std::env::var("BLIND_SEEDS").ok().and_then(|n| n.parse().ok()).unwrap_or(20);
    for speed in [true, false] {
        println!("measured speed: {speed}");
        for effect in CATALOGUED.iter().chain(UNCATALOGUED).chain(&["none"]) {
            let (mut names, mut in_group, mut covered, mut sized) = (BTreeMap::new(), 0, 0, 0);
            for seed in 0..seeds {
                let (found, size) = blind(effect, seed, speed);
                *names.entry(first(&found)).or_insert(0) += 1;
                let Some(cause) = found.causes.first() else {
                    continue;
                };
                let group = &cause.indistinguishable_from;
                in_group +=
                    usize::from(cause.cause == *effect || (group.len() < 4 && group.iter().any(|n| n == effect)));
                if let (true, Some(size)) = (cause.cause == *effect, size) {
                    let parameter = glidepolar::mechanisms::at_sea(effect).expect("a mechanism").parameters[0];
                    let [low, high] = cause.parameters[parameter].ci95;
                    sized += 1;
                    covered += usize::from(low <= size && size <= high);
                }
            }
            println!(
                "{effect:<36} first {names:?}, in the declared group {in_group}, size covered {covered} of {sized}"
            );
        }
    }
}
