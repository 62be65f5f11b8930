//! Logs of real gliders, against figures that were stated before by an independent analysis of the same files.

mod logs;

use std::path::PathBuf;

use glidepolar_flightlog::{Observation, PreparationSettings};
use glidepolar_inference::estimate::Estimate;
use glidepolar_turning::{Halves, Turning, turning};

/// The folder of measured data: the one that `GLIDEPOLAR_DATA` names, or `shared/data` beside the checkout.
fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("GLIDEPOLAR_DATA")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")), PathBuf::from);
    if !folder.is_dir() {
        eprintln!("skipped: no measured data; set GLIDEPOLAR_DATA to their folder");
        return None;
    }
    Some(folder)
}

fn read(files: &[PathBuf]) -> Turning {
    turning(&observations(files)).expect("it turns")
}

fn observations(files: &[PathBuf]) -> Vec<Observation> {
    logs::read(files, PreparationSettings { density_kg_m3: Some(1027.0), ..PreparationSettings::default() })
}

fn holds(q: &Option<Estimate>, stated: f64) -> bool {
    q.as_ref().is_some_and(|q| (q.ci95[0]..=q.ci95[1]).contains(&stated) && q.value.abs() > 3.0 * q.se)
}

/// The stated figures of a leg: turn rate per roll, and the error on the second, fourth, ... dive of a line through the others, with three
/// digits. The other analysis has the same stretches; `tests/python/test_turning.py` finds its figures from the files.
struct Stated {
    per_roll_1_s: f64,
    held_out_deg_s: f64,
}

fn assert_as_stated(found: &Turning, stated: [Stated; 2]) {
    let per_roll = &found.turn_rate_per_roll_1_s;
    let even = &found.halves.as_ref().expect("more than four dives").even.predicted_rms_rad_s;
    let [descent, ascent] = stated;
    for (own, held_out, stated) in [(&per_roll.descent, even.descent, descent), (&per_roll.ascent, even.ascent, ascent)]
    {
        assert!(holds(own, stated.per_roll_1_s), "{own:?} is not {}", stated.per_roll_1_s);
        let held_out = held_out.to_degrees();
        eprintln!("held out {held_out:.4} deg/s, stated {}", stated.held_out_deg_s);
        assert!(
            held_out < stated.held_out_deg_s + 0.0005,
            "{held_out} deg/s held out, stated {}",
            stated.held_out_deg_s
        );
    }
}

/// The halves differ by no more than the 95 % interval of their difference.
fn assert_halves_agree(found: &Turning) {
    let Halves { odd, even } = found.halves.as_ref().expect("more than four dives");
    let [odd, even] = [odd, even].map(|half| &half.turn_rate_per_roll_1_s);
    for (a, b) in [(&odd.descent, &even.descent), (&odd.ascent, &even.ascent)] {
        let (a, b) = a.as_ref().zip(b.as_ref()).expect("the roll varies in both halves");
        let half_width = (a.ci95[1] - a.value).hypot(b.ci95[1] - b.value);
        eprintln!("odd {:.4}({:.4}), even {:.4}({:.4})", a.value, a.se, b.value, b.se);
        assert!((a.value - b.value).abs() < half_width, "odd {a:?}, even {b:?}");
    }
}

const SG542: [Stated; 2] =
    [Stated { per_roll_1_s: -0.0424, held_out_deg_s: 0.205 }, Stated { per_roll_1_s: 0.0204, held_out_deg_s: 0.139 }];
const SG236: [Stated; 2] =
    [Stated { per_roll_1_s: -0.0393, held_out_deg_s: 0.149 }, Stated { per_roll_1_s: 0.0278, held_out_deg_s: 0.168 }];

#[test]
fn sg542_turns_against_its_roll_on_dives_and_with_it_on_climbs() {
    let Some(data) = data() else { return };
    // The table has no times of moves, and flags for some of them alone: stretches begin later, and there are fewer of them.
    let found = read(&[data.join("sg542_samples.csv")]);
    assert!(holds(&found.turn_rate_per_roll_1_s.descent, -0.0424), "{found:#?}");
    assert!(holds(&found.turn_rate_per_roll_1_s.ascent, 0.0204), "{found:#?}");
    let roll = found.roll_per_roll_mass.as_ref().expect("the roll mass is in the log");
    // .561 deg per deg on dives, .551 on climbs: one value for both has to lie between, within its own error.
    assert!((0.551 - 2.0 * roll.se..=0.561 + 2.0 * roll.se).contains(&roll.value), "{roll:?}");
    assert_halves_agree(&found);
}

/// From the files of its dives, which `cargo xtask fetch-data` puts into `data/sg542`.
#[test]
fn sg542_predicts_held_out_dives_as_stated() {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/sg542"));
    let files: Vec<PathBuf> = (304..=317).map(|dive| folder.join(format!("p5420{dive}.nc"))).collect();
    if !files[0].is_file() {
        eprintln!("skipped: no data/sg542; cargo xtask fetch-data");
        return;
    }
    let found = read(&files);
    assert_as_stated(&found, SG542);
    assert_halves_agree(&found);
}

#[test]
fn sg236_turns_likewise() {
    let Some(data) = data() else { return };
    let files: Vec<PathBuf> = (1..=5).map(|dive| data.join(format!("seaglider_sg236/p236000{dive}.nc"))).collect();
    let found = read(&files);
    assert_as_stated(&found, SG236);
    assert_halves_agree(&found);
}

#[test]
fn comet_turns_alike_on_both_legs_below_the_thermocline_and_not_above() {
    let Some(data) = data() else { return };
    let found = read(&[data.join("comet_2019_spiral.csv")]);
    let layer = |leg: &str, at_dbar: f64| {
        let here = |l: &&glidepolar_turning::Layer| l.leg == leg && (l.from_dbar..=l.to_dbar).contains(&at_dbar);
        found.layers.iter().find(here).unwrap_or_else(|| panic!("{leg} {at_dbar}: {found:#?}")).turn_rate_rad_s.clone()
    };
    let (dive, climb, above) = (layer("descent", 22.0), layer("ascent", 26.0), layer("ascent", 16.0));
    // .0177(5) and .0179(6) rad/s between 19 and 30 dbar: two analyses of the same samples agree within two of their errors.
    assert!((dive.value - 0.0177).abs() < 2.0 * dive.se.hypot(0.0005), "{dive:?}");
    assert!((climb.value - 0.0179).abs() < 2.0 * climb.se.hypot(0.0006), "{climb:?}");
    assert!(above.value < 0.0, "{above:?}");
    assert!(found.warnings.iter().any(|w| w.contains("changes with depth")), "{:?}", found.warnings);
    let list = found.static_list_rad.expect("the roll stands still");
    assert!((list.value.to_degrees() + 10.3).abs() < 0.3, "{list:?}");
}
