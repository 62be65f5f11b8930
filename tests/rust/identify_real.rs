//! `glidepolar identify` and `glidepolar track` on real logs, as a user runs them, against figures that were stated
//! before: those of an independent fit, or of another program on the same data.

use std::path::PathBuf;
use std::process::Command;

use glidepolar_tests::{Built, measured_data};
use serde_json::Value;

/// The command's JSON; nothing where the program or the data are not there, which is said aloud by the helpers.
fn run(arguments: &[&str]) -> Option<Value> {
    let (program, data): (PathBuf, PathBuf) = (Built::Glidepolar.path()?, measured_data()?);
    let output =
        Command::new(program).current_dir(data).args(arguments).args(["--json", "-"]).output().expect("it starts");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    Some(serde_json::from_slice(&output.stdout).expect("JSON and nothing else"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

const COMET: [&str; 8] = [
    "identify",
    "comet_2016_baltic_1hz.csv",
    "--vehicle",
    "slocum-graver",
    "--speed-column",
    "U_dvl_m_s",
    "--column",
    "pitch_rad=pitch_corr_rad",
];

#[test]
fn comet_speed_and_vertical_velocity_on_held_out_dives() {
    let Some(found) = run(&COMET) else { return };
    let of = |which: &str| number(&found["fit"][which]);
    // An independent fit has 8.5 to 10.7 and 5.6 to 5.9 mm/s.
    assert!(of("speed_bias_holdout_m_s").abs() <= 0.011, "{}", found["fit"]);
    assert!(of("w_rms_9_point_holdout_m_s") <= 0.006, "{}", found["fit"]);
    assert_eq!(found["identifiable"]["a"], true);
    // The build-up has 21.1 +- 3.0; the descent on which the Doppler log had lost the water would make it 18 +- 2.
    let a = &found["parameters"]["a"];
    assert!((number(&a["value"]) - 21.1).abs() < 3.0 && number(&a["se"]) < 1.0, "{a}");
    // Battery and ballast move together on this glider: the arm of the ballast cannot be identified, and d neither.
    assert_eq!(found["identifiable"]["d"], false);
}

#[test]
fn comet_with_friction_that_falls_along_the_ittc_line_meets_vertical_velocity_no_worse() {
    // d ln Cf/d ln Re = -2/(ln 10 (log10 Re - 2)) at Re = 4e5, halved for the dynamic pressure: from no datum of this log.
    let exponent = -1.0 / (std::f64::consts::LN_10 * (4e5f64.log10() - 2.0));
    let pin = format!("drag_exponent={exponent:.2}");
    let Some(with) = run(&[&COMET[..], &["--pin", &pin]].concat()) else { return };
    let Some(without) = run(&COMET) else { return };
    let [with_it, without_it] = [&with, &without].map(|found| number(&found["fit"]["w_rms_9_point_holdout_m_s"]));
    assert!(with_it <= without_it, "{with_it} against {without_it}");
    assert!(number(&with["fit"]["speed_bias_holdout_m_s"]).abs() <= 0.011);
}

#[test]
fn comet_flown_through_time_beats_steady_glides_where_it_turns() {
    let Some(found) = run(&[&COMET[..], &["--unsteady"]].concat()) else { return };
    let of = |which: &str| number(&found["unsteady"][which]["w_rms_9_point_m_s"]);
    // Below 3 m, inflections included, another program has 10.5 unsteady and 17.7 steady.
    assert!(of("unsteady") <= 0.0105, "{}", of("unsteady"));
    assert!(of("unsteady_where_steady_exists") < 0.85 * of("steady"), "{found}");
    assert!(number(&found["fit"]["speed_bias_holdout_m_s"]).abs() <= 0.011);
}

#[test]
fn comet_without_speed_does_not_tell_the_lift_slope() {
    // The lift slope of that vehicle is its paper's; a winged Slocum has the one that the command names.
    let Some(own) = run(&["identify", COMET[1], "--vehicle", "slocum-graver", COMET[6], COMET[7]]) else { return };
    assert!((number(&own["pinned"]["a"]["value"]) - 7.242).abs() < 1e-3);
    assert!(own["warnings"].to_string().contains("--pin a=21"), "{}", own["warnings"]);
    let pinned = ["identify", COMET[1], "--vehicle", "slocum-graver", COMET[6], COMET[7], "--pin", "a=21.1+-2.9"];
    let Some(found) = run(&pinned) else { return };
    assert_eq!(found["identifiable"]["a"], false);
    let pin = &found["pinned"]["a"];
    // The error of the build-up goes to b and c, most of it to c; b's interval then holds what the measured speed says.
    let Some(with_speed) = run(&COMET) else { return };
    let (b, estimate) = (&found["parameters"]["b"]["ci95"], number(&with_speed["parameters"]["b"]["value"]));
    assert!(number(&b[0]) < estimate && estimate < number(&b[1]), "{estimate} in {b}");
    assert!(number(&pin["se"]) > 2.0 && number(&pin["moves"]["c"]) > 5.0, "{pin}");
    assert!((number(&pin["value"]) - 21.0).abs() < 1.0 && pin["reason"].as_str().is_some(), "{pin}");
    // The profile shows why: from 0.8 to 2.6 times that lift slope w hardly changes while the speed goes.
    let profile = found["lift_slope_profile"].as_array().expect("a profile");
    let flat: Vec<&Value> = profile.iter().filter(|p| number(&p["value"]) >= 16.0).collect();
    let of = |name: &str| -> (f64, f64) {
        let all: Vec<f64> = flat.iter().map(|p| number(&p[name])).collect();
        (all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(0.0, f64::max))
    };
    let (w, speed) = (of("w_rms_m_s"), of("mean_speed_m_s"));
    assert!(w.1 < 1.02 * w.0, "{w:?}");
    assert!(speed.1 - speed.0 > 0.025, "{speed:?}");
}

#[test]
fn maria_one_ballast_offset_joins_descents_and_ascents() {
    let Some(found) = run(&["identify", "maria997_2022_slocum_g3_glides.csv", "--vehicle", "slocum-graver"]) else {
        return;
    };
    assert!(number(&found["fit"]["w_rms_holdout_m_s"]) <= 0.0058, "{}", found["fit"]);
    let legs = &found["legs_apart"];
    let apart = number(&legs["descent_b"]) / number(&legs["ascent_b"]);
    assert!(!(0.6..1.7).contains(&apart), "{legs}");
    assert!(number(&legs["joint_w_rms_m_s"]) < 0.6 * number(&legs["w_rms_m_s"]), "{legs}");
}

#[test]
fn sg542_hull_and_balance_of_moments() {
    let hull = ["--free", "hull_compressibility_per_Pa", "--free", "hull_thermal_expansion_per_K"];
    let Some(found) = run(&[&["identify", "sg542_samples.csv", "--vehicle", "seaglider"][..], &hull].concat()) else {
        return;
    };
    assert!(number(&found["fit"]["w_rms_holdout_m_s"]) <= 0.0095, "{}", found["fit"]);
    let value = |name: &str| number(&found["parameters"][name]["value"]);
    assert!((value("hull_compressibility_per_Pa") / 4.18e-10 - 1.0).abs() <= 0.15);
    assert!(number(&found["fit"]["pitch_rms_rad"]).to_degrees() <= 0.8, "{}", found["fit"]);
    assert!(found["pitch_balance"]["pitch_rms_holdout_rad"].as_f64().is_some_and(|rms| rms.to_degrees() <= 0.8));
    // A Seaglider's oil bladder sits aft.
    assert!(value("ballast_forward_m") < -0.1);
    assert_eq!(found["identifiable"]["d"], true);
    // The expansion comes out half again as large as aluminium's. That it depends on the weighing is said, and both intervals
    // are wide enough to hold the basestation's figures, which no scatter between dives would make them.
    let warnings = found["warnings"].to_string();
    assert!(warnings.contains("`hull_thermal_expansion_per_K` depends on how the data are weighed"), "{warnings}");
    for (name, nominal, widest) in
        [("hull_compressibility_per_Pa", 4.18e-10, 0.35e-10), ("hull_thermal_expansion_per_K", 0.705e-4, 0.5e-4)]
    {
        let q = &found["parameters"][name];
        assert!((number(&q["ci95"][0])..=number(&q["ci95"][1])).contains(&nominal), "{q}");
        assert!(number(&q["se"]) < widest, "{q}");
    }
}

#[test]
fn the_iterative_scheme_says_what_it_depends_on() {
    let arguments =
        ["identify", "maria997_2022_slocum_g3_glides.csv", "--vehicle", "slocum-graver", "--method", "iterative"];
    let Some(found) = run(&arguments) else { return };
    assert_eq!(
        (found["schema"].as_str(), found["method"].as_str()),
        (Some("glidepolar.identify/1"), Some("iterative"))
    );
    for name in ["a", "b", "c"] {
        let q = &found["parameters"][name];
        assert!(number(&q["ci95"][0]) <= number(&q["value"]) && number(&q["value"]) <= number(&q["ci95"][1]), "{q}");
    }
    assert!(found["fit"]["w_rms_m_s"].as_f64().is_some());
    assert!(found["warnings"][0].as_str().is_some_and(|warning| warning.contains("first guess")));
}

#[test]
fn sg542_currents_agree_with_the_stored_ones_once_the_positions_are_taken_for_what_they_are() {
    let arguments = |more: &[&'static str]| {
        [
            &[
                "track",
                "sg542_samples.csv",
                "--vehicle",
                "seaglider",
                "--fixes",
                "sg542_dives.csv",
                "--declination-deg",
                "-24",
            ][..],
            more,
        ]
        .concat()
    };
    let Some(start) = run(&arguments(&[])) else { return };
    assert!(
        start["warnings"][0].as_str().is_some_and(|warning| warning.contains("--fixes-at middle")),
        "{}",
        start["warnings"]
    );
    let Some(middle) = run(&arguments(&["--fixes-at", "middle"])) else { return };
    let rms = |report: &Value| number(&report["comparison"]["rms_difference_m_s"]);
    assert!(rms(&middle) < 0.5 * rms(&start), "{} against {}", rms(&middle), rms(&start));
    // The errors that are printed hold the differences: two components a drift.
    let drifts = middle["between_fixes"].as_array().expect("drifts");
    let se: f64 = drifts
        .iter()
        .map(|d| number(&d["current"]["east_se_m_s"]).powi(2) + number(&d["current"]["north_se_m_s"]).powi(2))
        .sum();
    assert!(
        rms(&middle) < 2.0 * (se / drifts.len() as f64).sqrt(),
        "{} against {}",
        rms(&middle),
        (se / drifts.len() as f64).sqrt()
    );
}

#[test]
fn bad_input_of_every_kind_ends_with_code_2_and_one_message() {
    let Some(program) = Built::Glidepolar.path() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let header = "time_s,pressure_dbar,pitch_rad,vbd_cc,density_kg_m3\n";
    let cases = [
        ("empty.csv", String::new(), "empty"),
        ("header.csv", header.to_owned(), "no row of data"),
        ("no_pitch.csv", "time_s,pressure_dbar,vbd_cc\n1,2,3\n".to_owned(), "no pitch"),
        ("comma.csv", "time_s;pressure_dbar;pitch_rad;vbd_cc\n1,0;2,0;0,1;3\n".to_owned(), "no density"),
        ("text.csv", format!("{header}1,2,down,3,1025\n"), "down"),
        ("short.csv", format!("{header}1,2,0.1\n"), "cells"),
        ("nan.csv", format!("{header}{}", "1,nan,nan,nan,nan\n".repeat(9)), "not a single value"),
        ("binary.nc", "CDF\u{1}\u{0}\u{0}".to_owned(), "NetCDF"),
    ];
    for (name, text, expected) in cases {
        std::fs::write(folder.path().join(name), text).expect("a file");
        for command in ["identify", "track"] {
            let output = Command::new(&program)
                .current_dir(folder.path())
                .args([command, name, "--vehicle", "slocum-graver"])
                .output()
                .expect("it starts");
            let said = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{command} {name}: {said}");
            assert!(output.stdout.is_empty() && said.contains(name), "{command} {name}: {said}");
            assert!(command == "track" || said.contains(expected), "{name}: {said}");
        }
    }
    for arguments in [
        ["track", "x.csv", "--vehicle", "slocum-graver", "--fix-error-m", "-1"],
        ["identify", "x.csv", "--vehicle", "slocum-graver", "--half-window-s", "0"],
        ["identify", "x.csv", "--vehicle", "slocum-graver", "--free", "added_mass"],
    ] {
        let output = Command::new(&program).args(arguments).output().expect("it starts");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    }
}
