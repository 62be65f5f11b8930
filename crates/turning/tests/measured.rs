//! Logs of real gliders, against figures that were stated before by an independent analysis of the same files.

mod logs;

use std::path::PathBuf;

use glidepolar_flightlog::{Observation, PreparationSettings};
use glidepolar_inference::estimate::Estimate;
use glidepolar_turning::{Turning, turning};

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

/// On held-out dives the turn rate is predicted no worse than by a second computation over the same stretches, made with numpy
/// from the files (`tests/python/test_turning.py`): descents and ascents, deg/s. The straight line of the other analysis, on
/// stretches of its own choice, has .205/.139 (SG542) and .149/.168 (SG236); .149 lies within what other choices give, .139 is met by none tried.
fn assert_predicts(found: &Turning, limits_deg_s: [f64; 2]) {
    let held_out = found.holdout_rms_rad_s.as_ref().expect("more than four dives");
    for (own, limit) in [held_out.descent, held_out.ascent].into_iter().zip(limits_deg_s) {
        assert!(own.to_degrees() <= limit, "{} deg/s held out, the second computation has {limit}", own.to_degrees());
    }
}

#[test]
fn sg542_turns_against_its_roll_on_dives_and_with_it_on_climbs() {
    let Some(data) = data() else { return };
    let found = read(&[data.join("sg542_samples.csv")]);
    assert!(holds(&found.turn_rate_per_roll_1_s.descent, -0.0424), "{found:#?}");
    assert!(holds(&found.turn_rate_per_roll_1_s.ascent, 0.0204), "{found:#?}");
    let roll = found.roll_per_roll_mass.as_ref().expect("the roll mass is in the log");
    // .561 deg per deg on dives, .551 on climbs: one value for both has to lie between, within its own error.
    assert!((0.551 - 2.0 * roll.se..=0.561 + 2.0 * roll.se).contains(&roll.value), "{roll:?}");
    assert_predicts(&found, [0.206, 0.185]);
}

/// The halves differ by no more than the 95 % interval of their difference.
#[test]
fn odd_and_even_dives_of_sg542_have_one_turn_rate_per_roll() {
    let Some(data) = data() else { return };
    let all = observations(&[data.join("sg542_samples.csv")]);
    let [odd, even] = [1, 0].map(|parity| {
        let half: Vec<Observation> = all.iter().filter(|o| o.dive % 2 == parity).copied().collect();
        turning(&half).expect("seven dives").turn_rate_per_roll_1_s
    });
    for (a, b) in [(odd.descent, even.descent), (odd.ascent, even.ascent)] {
        let (a, b) = a.zip(b).expect("the roll varies in both halves");
        let half_width = ((a.ci95[1] - a.value).powi(2) + (b.ci95[1] - b.value).powi(2)).sqrt();
        eprintln!("odd {:.4}({:.4}), even {:.4}({:.4})", a.value, a.se, b.value, b.se);
        assert!((a.value - b.value).abs() < half_width, "odd {a:?}, even {b:?}");
    }
}

#[test]
fn sg236_turns_likewise() {
    let Some(data) = data() else { return };
    let files: Vec<PathBuf> = (1..=5).map(|dive| data.join(format!("seaglider_sg236/p236000{dive}.nc"))).collect();
    let found = read(&files);
    assert!(holds(&found.turn_rate_per_roll_1_s.descent, -0.0393), "{found:#?}");
    assert!(holds(&found.turn_rate_per_roll_1_s.ascent, 0.0278), "{found:#?}");
    assert_predicts(&found, [0.167, 0.163]);
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
