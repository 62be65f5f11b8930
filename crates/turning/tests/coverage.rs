//! The 95 % intervals of list, offset of the rudder and offset of the roll mass hold the sizes that the virtual sea hides. The curvature
//! by drag on one side changes with the pitch, so that a log has no one true value of it.
//!
//! `cargo test -p glidepolar-turning --test coverage -- --ignored --nocapture` prints the table over `TURNING_SEEDS` seeds (40) from
//! `TURNING_FIRST` (7400) on.

mod hidden;
mod logs;

use glidepolar_turning::causes::causes;
use glidepolar_virtual_sea::vehicle::Hull;
use rayon::prelude::*;

/// Hidden effect, glider, the parameter and how many of 40 must be named.
const CASES: [(&str, Hull, &str, usize); 6] = [
    ("static_list=0.0873", Hull::Seaglider, "static_list_rad", 38),
    ("static_list=0.0873", Hull::Slocum200, "static_list_rad", 38),
    ("rudder_offset=0.0524", Hull::Slocum200, "rudder_offset_rad", 38),
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

fn answer(case: usize, seed: u64) -> Answer {
    let (effect, hull, parameter, _) = CASES[case];
    let (observations, truth) = hidden::log(effect, hull, seed);
    let found = causes(&observations).expect("steady stretches");
    let size = found.causes.iter().find_map(|cause| cause.parameters.get(parameter));
    let size = size.zip(truth.lateral_parameter(parameter));
    let names =
        found.causes.iter().map(|cause| format!("{} {:?}", cause.cause, cause.indistinguishable_from)).collect();
    let size =
        size.map(|(size, known)| ((size.ci95[0]..=size.ci95[1]).contains(&known), (size.value - known) / size.se));
    Answer { case, seed, names, size }
}

#[test]
#[ignore = "240 logs, some minutes"]
fn intervals_of_lateral_sizes_hold() {
    let number = |name: &str, default| std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(default);
    let (first, seeds): (u64, u64) = (number("TURNING_FIRST", 7400), number("TURNING_SEEDS", 40));
    let tasks: Vec<(usize, u64)> =
        (0..CASES.len()).flat_map(|case| (first..first + seeds).map(move |seed| (case, seed))).collect();
    let answers: Vec<Answer> = tasks.into_par_iter().map(|(case, seed)| answer(case, seed)).collect();
    let mut failed = Vec::new();
    for (case, (effect, hull, _, floor)) in CASES.iter().enumerate() {
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
