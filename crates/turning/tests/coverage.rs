//! The 95 % intervals of list, offset of the rudder, offset of the roll mass and curvature by drag on one side hold the sizes that
//! the virtual sea hides. The curvature changes a little with the pitch: its true value is the mean over the samples of the glides.
//!
//! `cargo test -p glidepolar-turning --test coverage -- --ignored --nocapture` prints the table over `TURNING_SEEDS` seeds (40) from
//! `TURNING_FIRST` (7400) on, of the effects whose name
//! contains `TURNING_EFFECT`.

mod hidden;
mod logs;

use glidepolar_flightlog::Observation;
use glidepolar_turning::causes::{KnownTurning, causes};
use glidepolar_virtual_sea::truth::Truth;
use glidepolar_virtual_sea::vehicle::Hull;
use rayon::prelude::*;

/// Hidden effect, glider, the parameter and how many of 40 must be named.
const CASES: [(&str, Hull, &str, usize); 8] = [
    ("static_list=0.0873", Hull::Seaglider, "static_list_rad", 38),
    ("static_list=0.0873", Hull::Slocum200, "static_list_rad", 38),
    ("rudder_offset=0.0524", Hull::Slocum200, "rudder_offset_rad", 38),
    ("yaw_asymmetry=8e-4", Hull::Seaglider, "yaw_asymmetry_rad_per_m", 36),
    ("yaw_asymmetry=8e-4", Hull::Slocum200, "yaw_asymmetry_rad_per_m", 36),
    // Where the roll mass is one of small gain a list does the same: see the theory page.
    ("roll_mass_offset=0.16", Hull::Seaglider, "roll_mass_offset_rad", 0),
    ("none", Hull::Seaglider, "", 0),
    ("none", Hull::Slocum200, "", 0),
];

/// What one log gave: the names, whether the interval holds the size, its error in standard errors.
struct Answer {
    case: usize,
    seed: u64,
    names: Vec<String>,
    size: Option<(bool, f64)>,
}

/// The true curvature, on average over the samples of the glides.
fn mean_curvature(observations: &[Observation], truth: &Truth) -> Option<f64> {
    let of_sample = |o: &Observation| {
        let speed_m_s = (o.sink_m_s / o.pitch_rad.sin()).abs();
        let glides = (0.12..0.9).contains(&o.pitch_rad.abs()) && (0.1..0.8).contains(&speed_m_s);
        if glides { truth.curvature_without_roll(o.pitch_rad, speed_m_s) } else { None }
    };
    let all: Vec<f64> = observations.iter().filter_map(of_sample).collect();
    (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
}

fn answer(case: usize, seed: u64) -> Answer {
    let (effect, hull, parameter, _) = CASES[case];
    let (observations, truth) = hidden::log(effect, hull, seed);
    let found = causes(&observations, KnownTurning::default()).expect("steady stretches");
    let size = found.causes.iter().find_map(|cause| cause.parameters.get(parameter));
    let size = size.zip(match parameter {
        "yaw_asymmetry_rad_per_m" => mean_curvature(&observations, &truth),
        other => truth.lateral_parameter(other),
    });
    let names =
        found.causes.iter().map(|cause| format!("{} {:?}", cause.cause, cause.indistinguishable_from)).collect();
    let size =
        size.map(|(size, known)| ((size.ci95[0]..=size.ci95[1]).contains(&known), (size.value - known) / size.se));
    Answer { case, seed, names, size }
}

#[test]
#[ignore = "320 logs, some minutes"]
fn intervals_of_lateral_sizes_hold() {
    let number = |name: &str, default| std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(default);
    let (first, seeds): (u64, u64) = (number("TURNING_FIRST", 7400), number("TURNING_SEEDS", 40));
    let wanted = std::env::var("TURNING_EFFECT").unwrap_or_default();
    let is_wanted = |case: &usize| CASES[*case].0.contains(&wanted);
    let tasks: Vec<(usize, u64)> = (0..CASES.len())
        .filter(is_wanted)
        .flat_map(|case| (first..first + seeds).map(move |seed| (case, seed)))
        .collect();
    let answers: Vec<Answer> = tasks.into_par_iter().map(|(case, seed)| answer(case, seed)).collect();
    let mut failed = Vec::new();
    for (case, (effect, hull, _, floor)) in CASES.iter().enumerate().filter(|(case, _)| is_wanted(case)) {
        let of_case: Vec<&Answer> = answers.iter().filter(|answer| answer.case == case).collect();
        let sizes: Vec<(bool, f64)> = of_case.iter().filter_map(|answer| answer.size).collect();
        let held = sizes.iter().filter(|(held, _)| *held).count();
        let mean = sizes.iter().map(|(_, z)| z).sum::<f64>() / sizes.len() as f64;
        let spread = (sizes.iter().map(|(_, z)| (z - mean).powi(2)).sum::<f64>() / sizes.len() as f64).sqrt();
        println!(
            "{effect:<22} {:<10} sized {:>2} of {}, interval holds {held}, error over its standard error {mean:.2} +- {spread:.2}",
            format!("{hull:?}"),
            sizes.len(),
            of_case.len()
        );
        for answer in
            of_case.iter().filter(|answer| answer.size.is_none_or(|(held, _)| !held) && !answer.names.is_empty())
        {
            println!("    seed {}: {} {:?}", answer.seed, answer.names.join(" + "), answer.size);
        }
        let named_straight = *effect == "none" && of_case.iter().any(|answer| !answer.names.is_empty());
        let is_low = |count: usize, of: usize, floor: f64| (count as f64) < floor * of as f64;
        if named_straight || is_low(sizes.len(), of_case.len(), *floor as f64 / 40.0) || is_low(held, sizes.len(), 0.9)
        {
            failed.push(format!("{effect} {hull:?}: sized {}, held {held}", sizes.len()));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
