//! Intervals of the lateral sizes hold the hidden ones.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use glidepolar_flightlog::{Columns, LogFiles, Observation, Piece, Preparation, PreparationSettings};
use glidepolar_turning::causes::causes;
use glidepolar_virtual_sea::truth::Truth;
use glidepolar_virtual_sea::vehicle::Hull;
use glidepolar_virtual_sea::{Options, catalogue, generate};

fn observations(effect: &str, hull: Hull, seed: u64) -> (Vec<Observation>, Truth) {
    let effects = catalogue::parse_requests(effect).expect("an effect of the virtual sea");
    let sea = generate(&Options { effects, hull: Some(hull), lateral: true, ..Options::seeded(seed) });
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("log.csv");
    std::fs::write(&path, sea.log.to_csv()).expect("the log");
    let columns = Columns::default();
    let mut log = LogFiles::open(&[path], &columns).expect("a log");
    let mut preparation = Preparation::new(PreparationSettings::default());
    let mut all: Vec<Observation> = Vec::new();
    while let Some(piece) = log.next_piece(50_000).expect("a piece") {
        if let Piece::Series(piece) = piece {
            preparation.push(*piece, &mut all);
        }
    }
    preparation.finish(&mut all);
    (all, sea.truth)
}

const CASES: [(&str, Hull); 8] = [
    ("static_list=0.0873", Hull::Seaglider),
    ("static_list=0.0873", Hull::Slocum200),
    ("rudder_offset=0.0524", Hull::Slocum200),
    ("roll_mass_offset=0.16", Hull::Seaglider),
    ("yaw_asymmetry=8e-4", Hull::Seaglider),
    ("roll_offset=0.0873", Hull::Seaglider),
    ("none", Hull::Seaglider),
    ("none", Hull::Slocum200),
];

#[test]
#[ignore = "some minutes"]
fn table() {
    let number = |name: &str, default| std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(default);
    let (first, seeds): (u64, u64) = (number("TURNING_FIRST", 7000), number("TURNING_SEEDS", 20));
    let only: Option<usize> = std::env::var("TURNING_CASE").ok().and_then(|n| n.parse().ok());
    let jobs: Vec<(usize, u64)> = (0..CASES.len())
        .filter(|case| only.is_none_or(|only| only == *case))
        .flat_map(|case| (first..first + seeds).map(move |seed| (case, seed)))
        .collect();
    let (next, out) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(&(case, seed)) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let (effect, hull) = CASES[case];
                    let (all, truth) = observations(effect, hull, seed);
                    let own = truth.lateral.unwrap();
                    let Some(found) = causes(&all) else {
                        println!("{effect} {seed} none");
                        continue;
                    };
                    let mut line = format!(
                        "{effect} {hull:?} {seed} n {} own_list {:.4} zero {:.4}",
                        found.stretches, own.own_list_rad, own.roll_zero_rad
                    );
                    for c in &found.causes {
                        line += &format!(" | {} {:?}", c.cause, c.indistinguishable_from);
                        for (name, e) in &c.parameters {
                            let t = truth.parameter(name).map(|t| {
                                t + match name.as_str() {
                                    "static_list_rad" => own.own_list_rad,
                                    "rudder_offset_rad" => own.own_rudder_rad,
                                    "roll_offset_rad" => own.roll_zero_rad,
                                    _ => 0.0,
                                }
                            });
                            line += &format!(" {name} {:.5} +- {:.5}", e.value, e.se);
                            if let Some(t) = t {
                                line += &format!(
                                    " true {t:.5} z {:.2} {}",
                                    (e.value - t) / e.se,
                                    (e.ci95[0]..=e.ci95[1]).contains(&t)
                                );
                            }
                        }
                    }
                    out.lock().unwrap().push((case, seed, line));
                }
            });
        }
    });
    let mut out = out.into_inner().unwrap();
    out.sort();
    for (_, _, line) in out {
        println!("{line}");
    }
}
