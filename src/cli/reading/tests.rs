//! Every command that reads logs refuses the same ones in the same words, and says what is merely doubtful.

use std::process::ExitCode;

use clap::Parser;

use crate::cli::{Cli, CliError, run};
use crate::log::in_situ_density_kg_m3;

/// One row: time, pressure, pitch, ballast volume, density.
type Row = [f64; 5];

/// Ten dives to 60 dbar at 0.2 dbar/s, consistent in all they say.
fn rows() -> Vec<Row> {
    (0..3000)
        .map(|i| {
            let (phase, half) = (i % 300, 150);
            let (down, steps) = if phase < half { (true, phase) } else { (false, 300 - phase) };
            let pressure = 1.0 + 0.4 * f64::from(steps);
            let sign = if down { -1.0 } else { 1.0 };
            let density = in_situ_density_kg_m3(35.0, 10.0, pressure, f64::NAN, f64::NAN);
            [2.0 * f64::from(i), pressure, 0.45 * sign, 200.0 * sign, density]
        })
        .collect()
}

/// What a command says of a log: its JSON, or why it ended.
fn run_command(command: &[&str], rows: &[Row]) -> Result<serde_json::Value, CliError> {
    run_on(command, rows, "10,35")
}

/// The same, of a log with this temperature and salinity.
fn run_on(command: &[&str], rows: &[Row], water: &str) -> Result<serde_json::Value, CliError> {
    let folder = tempfile::tempdir().expect("a folder");
    let (log, json) = (folder.path().join("log.csv"), folder.path().join("out.json"));
    let mut text =
        "time_s,pressure_dbar,pitch_rad,vbd_cc,density_kg_m3,temperature_C,salinity_psu,heading_rad\n".to_owned();
    for [time, pressure, pitch, ballast, density] in rows {
        text += &format!("{time},{pressure},{pitch},{ballast},{density},{water},1\n");
    }
    std::fs::write(&log, text).expect("a file");
    let common = ["--vehicle", "seaglider", "--quiet", "--json", json.to_str().unwrap()];
    let arguments = ["glidepolar", command[0], log.to_str().unwrap()].into_iter();
    run(Cli::parse_from(arguments.chain(command[1..].iter().copied()).chain(common)))?;
    Ok(serde_json::from_slice(&std::fs::read(json).expect("a result")).expect("JSON"))
}

fn changed(change: impl Fn(&mut Row)) -> Vec<Row> {
    let mut rows = rows();
    rows.iter_mut().for_each(change);
    rows
}

const COMMANDS: [&[&str]; 4] = [&["identify"], &["identify", "--method", "iterative"], &["track"], &["diagnose"]];

#[test]
fn a_log_that_contradicts_itself_is_refused_by_every_command() {
    let reversed: Vec<Row> = rows().into_iter().rev().collect();
    for (rows, check) in [
        (changed(|row| row[0] *= 1e3), "time base and pressure unit"),
        (changed(|row| row[1] *= -1.0), "sign of pressure"),
        (changed(|row| row[2] = row[2].to_degrees()), "unit of pitch"),
        (changed(|row| row[2] *= -1.0), "sign of pitch"),
        (changed(|row| row[3] *= -1.0), "sign of ballast volume"),
        (changed(|row| row[3] *= 1e-6), "unit of ballast volume"),
        (changed(|row| row[4] -= 1000.0), "unit of density"),
        (changed(|row| row[1] *= 1e4), "unit of pressure or depth"),
        (reversed, "order of time"),
    ] {
        for command in COMMANDS {
            let error = run_command(command, &rows).expect_err(check);
            let text = error.to_string();
            assert!(text.contains("contradicts itself") && text.contains(check), "{command:?}, {check}: {text}");
            assert!(text.contains("log.csv: the log"), "{command:?}, {check}: {text}");
            assert!(text.contains("--column CHANNEL=COLUMN"), "{command:?}, {check}: {text}");
            assert_eq!(error.exit_code(), ExitCode::from(2), "{command:?}, {check}");
        }
    }
}

#[test]
fn a_density_that_the_log_shows_to_be_wrong_is_corrected_by_every_command_and_it_is_said() {
    let warned = |command: &[&str], rows: &[Row]| {
        let result = run_command(command, rows).unwrap_or_else(|error| panic!("{command:?}: {error}"));
        let warnings = result["warnings"].as_array().expect("warnings").clone();
        let texts: Vec<String> = warnings.iter().map(|text| text.as_str().unwrap_or("").to_owned()).collect();
        texts.into_iter().filter(|text| text.starts_with("density against")).collect::<Vec<_>>()
    };
    let surface = in_situ_density_kg_m3(35.0, 10.0, 0.0, f64::NAN, f64::NAN);
    for command in &COMMANDS[..3] {
        assert_eq!(warned(command, &rows()), Vec::<String>::new(), "{command:?}");
        for (rows, expected) in
            [(changed(|row| row[4] = surface), "at p = 0"), (changed(|row| row[4] += 0.5), "constant, +0.500 kg/m3")]
        {
            let found = warned(command, &rows);
            assert!(
                found.len() == 1 && found[0].contains(expected) && found[0].contains("corrected"),
                "{command:?}: {found:?}"
            );
        }
    }
    // What follows is what follows from the density as it should have been.
    let drag =
        |rows: &[Row]| run_command(COMMANDS[0], rows).expect("a fit")["parameters"]["b"]["value"].as_f64().expect("b");
    let true_density = changed(|row| row[4] = in_situ_density_kg_m3(35.0, 10.0, row[1], f64::NAN, f64::NAN));
    let (corrected, expected) = (drag(&changed(|row| row[4] = surface)), drag(&true_density));
    assert!((corrected / expected - 1.0).abs() < 1e-6, "{corrected} beside {expected}");
    let way = |rows: &[Row]| {
        let found = run_command(COMMANDS[2], rows).expect("a track");
        let dives = found["dives"].as_array().expect("dives").clone();
        dives.iter().map(|dive| dive["east_m"].as_f64().expect("a way")).sum::<f64>()
    };
    let (as_read, expected) = (way(&changed(|row| row[4] = surface)), way(&true_density));
    assert!(expected > 100.0 && (as_read / expected - 1.0).abs() < 1e-6, "{as_read} m beside {expected} m");
}

/// The same log without a record of the water.
fn without_water() -> Vec<Row> {
    changed(|row| row[4] = f64::NAN)
}

#[test]
fn what_is_assumed_of_the_water_is_said() {
    let notes = |rows: &[Row], water: &str| {
        let found = run_on(&["identify", "--density", "1026"], rows, water).expect("a fit");
        found["notes"].to_string()
    };
    let said = notes(&without_water(), ",");
    assert!(said.contains("1026 kg/m3 assumed") && said.contains("15 degC assumed"), "{said}");
    let said = notes(&rows(), "10,35");
    assert!(!said.contains("assumed"), "{said}");
}

#[test]
fn a_pressure_or_a_speed_in_another_unit_is_warned_of() {
    let warned = |command: &[&str], factor: f64| {
        // A density of its own would show it: that of temperature and salinity follows the pressure.
        let found =
            run_command(command, &changed(|row| (row[1], row[4]) = (row[1] * factor, f64::NAN))).expect("a result");
        found["warnings"].to_string().contains("ballast and vertical velocity contradict each other")
    };
    for command in [&["identify"][..], &["track"], &["diagnose"]] {
        assert!(!warned(command, 1.0), "{command:?}");
        assert!(warned(command, 3.28), "{command:?}");
    }
}

#[test]
fn a_log_of_one_dive_identifies_nothing_in_any_command() {
    for command in [&["identify"][..], &["compare", "seaglider"]] {
        let error = run_command(command, &rows()[..300]).expect_err("one dive");
        assert!(error.to_string().contains("dives with steady samples: 1, at least 2"), "{command:?}: {error}");
        assert_eq!(error.exit_code(), ExitCode::from(1), "{command:?}");
    }
}

#[test]
fn descents_alone_at_one_ballast_volume_contradict_nothing() {
    let descents: Vec<Row> = rows().into_iter().filter(|row| row[2] < 0.0).collect();
    for command in [COMMANDS[0], COMMANDS[2]] {
        run_command(command, &descents).unwrap_or_else(|error| panic!("{command:?}: {error}"));
    }
}

#[test]
fn a_log_without_a_leg_is_refused_with_what_it_lacks() {
    let one_row = &rows()[..1];
    let constant = changed(|row| row[1] = 50.0);
    for command in [&COMMANDS[0], &COMMANDS[3]] {
        for (rows, expected) in [
            (&[][..], "no row of data"),
            (one_row, "no descent or ascent of more than 4 dbar"),
            (&constant, "no descent or ascent of more than 4 dbar"),
            (&changed(|row| row[2] = f64::NAN), "not a single value of `pitch_rad`"),
        ] {
            let error = run_command(command, rows).expect_err(expected);
            assert!(error.to_string().contains(expected), "{command:?}, {expected}: {error}");
            assert_eq!(error.exit_code(), ExitCode::from(2));
        }
    }
    assert!(run_command(&["track"], &[]).unwrap_err().to_string().contains("no row of data"));
}
