//! Logs of real gliders, against figures that were stated before by an independent analysis of the same files.

use std::path::PathBuf;

use glidepolar_flightlog::{Columns, LogFiles, Observation, Piece, Preparation, Settings};
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

fn of(files: &[PathBuf]) -> Turning {
    let columns = Columns::default();
    let mut log = LogFiles::open(files, &columns).expect("a log");
    let mut preparation = Preparation::new(Settings { density_kg_m3: Some(1027.0), ..Settings::default() });
    let mut all: Vec<Observation> = Vec::new();
    while let Some(piece) = log.next_piece(50_000).expect("a piece") {
        if let Piece::Series(piece) = piece {
            preparation.push(*piece, &mut all);
        }
    }
    preparation.finish(&mut all);
    turning(&all).expect("it turns")
}

fn holds(q: &Option<Estimate>, stated: f64) -> bool {
    q.as_ref().is_some_and(|q| (q.ci95[0]..=q.ci95[1]).contains(&stated) && q.value.abs() > 3.0 * q.se)
}

#[test]
fn sg542_turns_against_its_roll_on_dives_and_with_it_on_climbs() {
    let Some(data) = data() else { return };
    let found = of(&[data.join("sg542_samples.csv")]);
    assert!(holds(&found.turn_rate_per_roll_1_s.descent, -0.0424), "{found:#?}");
    assert!(holds(&found.turn_rate_per_roll_1_s.ascent, 0.0204), "{found:#?}");
    let roll = found.roll_per_roll_mass.expect("the roll mass is in the log");
    assert!((roll.value - 0.556).abs() < 0.01 && roll.se < 0.005, "{roll:?}");
    let held_out = found.holdout_rms_rad_s.expect("fourteen dives");
    assert!(held_out.descent < 0.57 * found.sd_rad_s.descent && held_out.ascent < 0.7 * found.sd_rad_s.ascent);
}

#[test]
fn sg236_turns_likewise() {
    let Some(data) = data() else { return };
    let files: Vec<PathBuf> = (1..=5).map(|dive| data.join(format!("seaglider_sg236/p236000{dive}.nc"))).collect();
    let found = of(&files);
    assert!(holds(&found.turn_rate_per_roll_1_s.descent, -0.0393), "{found:#?}");
    assert!(holds(&found.turn_rate_per_roll_1_s.ascent, 0.0278), "{found:#?}");
}

#[test]
fn comet_turns_alike_on_both_legs_below_the_thermocline_and_not_above() {
    let Some(data) = data() else { return };
    let found = of(&[data.join("comet_2019_spiral.csv")]);
    let layer = |leg: &str, at_dbar: f64| {
        let here = |l: &&glidepolar_turning::Layer| l.leg == leg && (l.from_dbar..=l.to_dbar).contains(&at_dbar);
        found.layers.iter().find(here).unwrap_or_else(|| panic!("{leg} {at_dbar}: {found:#?}")).turn_rate_rad_s.clone()
    };
    let (dive, climb, above) = (layer("descent", 22.0), layer("ascent", 26.0), layer("ascent", 16.0));
    assert!((dive.value - 0.0177).abs() < 3.0 * dive.se && dive.se < 0.001, "{dive:?}");
    assert!((climb.value - 0.0179).abs() < 3.0 * climb.se && climb.se < 0.001, "{climb:?}");
    assert!(above.value < 0.0, "{above:?}");
    assert!(found.warnings.iter().any(|w| w.contains("changes with depth")), "{:?}", found.warnings);
    let list = found.static_list_rad.expect("the roll stands still");
    assert!((list.value.to_degrees() + 10.3).abs() < 0.3, "{list:?}");
}
