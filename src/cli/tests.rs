//! What the commands make of arguments that are no sensible numbers, and of tables that lack something.

use std::process::ExitCode;

use clap::{CommandFactory, Parser, builder::ValueParser};

use super::{Cli, run};

/// Why a command ends, which it must do with exit code 2.
fn refused(arguments: &[&str]) -> String {
    let cli = Cli::try_parse_from(["glidepolar"].iter().chain(arguments)).expect("arguments that can be read");
    let error = run(cli).expect_err("an argument that cannot be used");
    assert_eq!(error.exit_code(), ExitCode::from(2), "{arguments:?}: {error}");
    error.to_string()
}

#[test]
fn every_number_may_have_a_sign_so_that_its_own_bounds_answer() {
    let number = ValueParser::from(clap::value_parser!(f64)).type_id();
    let mut numbers = 0;
    for command in Cli::command().get_subcommands() {
        for argument in command.get_arguments().filter(|argument| argument.get_value_parser().type_id() == number) {
            numbers += 1;
            let is_allowed = argument.is_allow_negative_numbers_set() || argument.is_allow_hyphen_values_set();
            assert!(is_allowed, "{} {}", command.get_name(), argument.get_id());
        }
    }
    assert!(numbers > 30, "{numbers}");
}

#[test]
fn numbers_beyond_their_bounds_are_named() {
    for (arguments, expected) in [
        (&["glide", "slocum-graver", "--density", "-5"][..], "--density -5 is no density of water"),
        (&["glide", "slocum-graver", "--net-mass-kg", "nan"], "--net-mass-kg NaN"),
        (&["glide", "slocum-graver", "--net-mass-kg", "0.2", "--pitch-deg", "inf"], "--pitch-deg inf"),
        (&["plan", "seaglider", "--battery-Wh", "2700", "--depth-m", "-5"], "--depth-m -5"),
        (&["plan", "seaglider", "--battery-Wh", "2700", "--depth-m", "500", "--density", "5"], "--density 5"),
        (&["plan", "seaglider", "--battery-Wh", "-5", "--depth-m", "500"], "--battery-Wh -5"),
        (&["plan", "seaglider", "--battery-Ah", "100", "--battery-V", "0", "--depth-m", "500"], "--battery-V 0"),
        (&["identify", "none.csv", "--vehicle", "seaglider", "--pin", "a=-3"], "`a` = -3 is beyond what it can be"),
        (&["simulate", "slocum-graver", "--stop", "-5"], "--stop -5"),
        (&["simulate", "slocum-graver", "--tolerance", "10"], "--tolerance 10"),
        (&["simulate", "slocum-graver", "--csv", "./a.out", "--json", "a.out"], "--csv and --json name the same place"),
        (&["turn", "seawing", "--roll-mass-deg", "nan"], "--roll-mass-deg NaN"),
        (&["turn", "seawing", "--roll-mass-deg", "120"], "--roll-mass-deg 120 is beyond its limits"),
        (&["turn", "seawing", "--rudder-deg", "5"], "--rudder-deg: this vehicle has none"),
        (&["turn", "seawing", "--pitch-deg", "90"], "--pitch-deg 90"),
        (&["turn", "seawing", "--net-mass-kg", "0"], "--net-mass-kg 0"),
        (&["turn", "seawing", "--sweep", "roll-mas=1..2"], "did you mean roll-mass-deg?"),
        (&["turn", "seawing", "--sweep", "roll-mass-deg=1"], "expected NAME=FROM..TO"),
        (&["turn", "rogue"], "lacks what a turn needs"),
        (&["track", "none.csv", "--vehicle", "seaglider", "--density", "-5"], "--density -5"),
        (&["track", "none.csv", "--vehicle", "seaglider", "--fix-error-m", "-5"], "--fix-error-m -5"),
        (&["identify", "none.csv", "--vehicle", "seaglider", "--density", "-5"], "--density -5"),
    ] {
        let found = refused(arguments);
        assert!(found.contains(expected), "{arguments:?}: {found}");
    }
}

#[test]
fn a_place_that_cannot_be_written_is_refused_before_the_log_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = folder.path().join("kept.toml");
    std::fs::write(&place, "mine").expect("a file");
    for (command, option) in [("identify", "--write"), ("diagnose", "--extended")] {
        let arguments = ["glidepolar", command, "none.csv", "--vehicle", "seaglider", option, place.to_str().unwrap()];
        let error = run(Cli::parse_from(arguments)).expect_err("a file of somebody else").to_string();
        assert!(error.contains("kept.toml") && !error.contains("none.csv"), "{command}: {error}");
        let found = refused(&[&arguments[1..], &["--json", place.to_str().unwrap(), "--force"]].concat());
        assert!(found.contains(&format!("{option} and --json name the same place")), "{found}");
    }
}

#[test]
fn a_result_in_the_place_of_an_input_is_refused_in_every_command() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, "kept").expect("a file");
        path.to_str().expect("a plain path").to_owned()
    };
    let (log, vehicle, table) = (file("log.csv"), file("v.toml"), file("t.csv"));
    let json = [&log, &vehicle].map(|path| ["--json", path.as_str(), "--force"]);
    let [to_log, to_vehicle] = &json;
    let beside = folder.path().join("./log.csv");
    let of_log = |command| [command, log.as_str(), "--vehicle", vehicle.as_str()];
    let [identify, diagnose, track] = ["identify", "diagnose", "track"].map(of_log);
    let beside = beside.to_str().expect("a plain path");
    let compare = ["compare", &log, "seaglider", "--vehicle", &vehicle];
    for arguments in [
        [&identify[..], to_log].concat(),
        [&diagnose[..], &["--extended", &vehicle, "--force"]].concat(),
        [&track[..], &["--out", beside]].concat(),
        [&track[..], &["--fixes", &table, "--csv", &table, "--force"]].concat(),
        [&compare[..], to_vehicle].concat(),
        [&compare[..], to_log].concat(),
        [&["glide", vehicle.as_str()][..], to_vehicle].concat(),
        [&["turn", vehicle.as_str()][..], to_vehicle].concat(),
        [&["plan", &vehicle, "--depth-m", "500", "--moves", &table, "--dives", &log][..], to_log].concat(),
        vec!["simulate", &vehicle, "--inputs", &table, "--csv", &table, "--force"],
        vec!["assemble", &log, "--hull", "x", "--base", &vehicle, "-o", &vehicle, "--force"],
        vec!["export-fmu", &vehicle, "-o", &vehicle, "--force"],
    ] {
        let found = refused(&arguments);
        assert!(found.contains("names a file that this command reads"), "{arguments:?}: {found}");
    }
    // The name of a built-in vehicle is no file, whatever stands there.
    let page = folder.path().join("seaglider");
    let glide = ["glidepolar", "glide", "seaglider", "--quiet", "--out", page.to_str().expect("a plain path")];
    run(Cli::parse_from(glide)).expect("a page");
}

#[test]
fn a_plan_at_a_pitch_that_no_glider_flies_is_warned_of() {
    let folder = tempfile::tempdir().expect("a folder");
    let warns = |pitch_deg: &str| {
        let json = folder.path().join(format!("{pitch_deg}.json"));
        let plan =
            ["glidepolar", "plan", "seaglider", "--battery-Wh", "2700", "--depth-m", "500", "--quiet", "--pitch-deg"];
        run(Cli::parse_from(plan.into_iter().chain([pitch_deg, "--json", json.to_str().unwrap()]))).expect("a plan");
        std::fs::read_to_string(json).expect("a result").contains("no measured glide is as flat")
    };
    assert!(warns("2") && !warns("20"));
}

#[test]
fn turns_are_written_as_the_contract_names_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let json = folder.path().join("turn.json");
    let page = folder.path().join("page");
    let written = |more: &[&str]| -> serde_json::Value {
        let common = ["glidepolar", "turn", "seawing", "--net-mass-kg", "0.3", "--quiet", "--json"];
        let [json_text, page_text] = [&json, &page].map(|path| path.to_str().expect("a plain path"));
        let arguments = [&common[..], &[json_text, "--out", page_text], more].concat();
        run(Cli::try_parse_from(arguments).expect("arguments that can be read")).expect("a turn");
        serde_json::from_slice(&std::fs::read(&json).expect("a file")).expect("JSON")
    };
    let one = written(&["--roll-mass-deg", "-45", "--moving-mass-m", "0.4216"]);
    assert_eq!(one["schema"], "glidepolar.turn/1");
    let turn = &one["turns"][0];
    for (name, expected) in [("speed_m_s", 0.490_186), ("turn_rate_rad_s", 0.003_853_85), ("radius_m", 101.47)] {
        let found = turn[name].as_f64().expect(name);
        assert!((found / expected - 1.0).abs() < 1e-4, "{name}: {found}");
    }
    assert_eq!(turn["stable"], true);
    assert_eq!(turn["eigenvalues"].as_array().expect("eigenvalues").len(), 8);
    let html = std::fs::read_to_string(page.join("report.html")).expect("a page");
    assert!(html.contains("Turn polar") && html.contains("ascents to starboard"), "the page warns of one leg");
    assert!(page.join("figures/polar-roll-mass.svg").exists());

    // A turn to port is the mirror image of one to starboard, and between them the glide is straight.
    let sweep = written(&["--sweep", "roll-mass-deg=-45..45:3"]);
    let rates: Vec<f64> = sweep["turns"]
        .as_array()
        .expect("turns")
        .iter()
        .map(|t| t["turn_rate_rad_s"].as_f64().expect("a rate"))
        .collect();
    assert_eq!(rates.len(), 3, "{sweep}");
    assert!(rates[0] > 0.003 && (rates[0] + rates[2]).abs() < 1e-12 && rates[1].abs() < 1e-12, "{rates:?}");
    assert!(sweep["turns"][1]["radius_m"].is_null());
}

#[test]
fn a_plan_with_more_ballast_than_the_engine_holds_is_refused() {
    let plan = ["plan", "seaglider", "--battery-Wh", "2700", "--depth-m", "500"];
    for (option, cc) in [("--ballast-up-cc", "5000"), ("--ballast-down-cc", "-900"), ("--surface-ballast-cc", "5000")] {
        let found = refused(&[&plan[..], &[option, cc]].concat());
        assert!(found.contains(option) && found.contains("the ballast engine of"), "{found}");
    }
}

#[test]
fn a_table_of_fixes_that_lacks_columns_is_refused_with_what_it_needs() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("a file");
        path.display().to_string()
    };
    let mut log = "time_s,pressure_dbar,pitch_rad,vbd_cc,density_kg_m3,heading_rad\n".to_owned();
    for i in 0..200 {
        let sign = if i < 100 { -1.0 } else { 1.0 };
        let pressure = 0.8 * f64::from(if i < 100 { i } else { 200 - i });
        log += &format!("{},{pressure},{},{},1025,1\n", 4 * i, 0.4 * sign, 200.0 * sign);
    }
    let log = file("log.csv", &log);
    let track = |fixes: &str| refused(&["track", &log, "--vehicle", "slocum-graver", "--quiet", "--fixes", fixes]);
    let found = track(&file("none.csv", "a,b\n1,2\n"));
    assert!(found.contains("the columns needed are: start_time_s, lat_deg, lon_deg"), "{found}");
    let found = track(&file("empty.csv", ""));
    assert!(found.contains("empty.csv: the file is empty"), "{found}");
}

#[test]
fn an_error_names_the_files_that_were_left_out_before_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("a file");
        path.display().to_string()
    };
    let damaged = file("damaged.csv", "time_s,depth_m\n0,1\n");
    let rows: String = (0..50).map(|i| format!("{},{i},-0.4,-200,1\n", 5 * i)).collect();
    let log = file("log.csv", &format!("time_s,pressure_dbar,pitch_rad,vbd_cc,heading_rad\n{rows}"));
    for command in ["identify", "track"] {
        let found = refused(&[command, &damaged, &log, "--vehicle", "slocum-graver", "--quiet"]);
        assert!(found.contains("no density") && found.contains("damaged.csv"), "{command}: {found}");
    }
}

#[test]
fn tables_of_inputs_are_read_as_logs_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let flown = |name: &str, text: &str| {
        let (inputs, csv) = (folder.path().join(name), folder.path().join(format!("{name}.out")));
        std::fs::write(&inputs, text).expect("a table");
        let (inputs, csv) = (inputs.display().to_string(), csv.display().to_string());
        let arguments =
            ["glidepolar", "simulate", "slocum-graver", "--stop", "60", "--quiet", "--inputs", &inputs, "--csv", &csv];
        run(Cli::try_parse_from(arguments).expect("arguments")).unwrap_or_else(|error| panic!("{name}: {error}"));
        std::fs::read_to_string(csv).expect("a history")
    };
    let plain = flown("plain.csv", "time,current_x_m_s\n0,0.0\n30,0.125\n60,0.25\n");
    for (name, text) in [
        ("semicolons.csv", "\u{feff}time;current_x_m_s\r\n0;0,0\r\n30;0,125\r\n60;0,25\r\n"),
        (
            "dates.csv",
            "time\tcurrent_x_m_s\n2023-04-18T16:49:57Z\t0\n2023-04-18T16:50:27Z\t0.125\n2023-04-18T16:50:57Z\t0.25\n",
        ),
        ("gaps.csv", "time,current_x_m_s\n0,0\n30,NaN\n60,0.25\n"),
    ] {
        assert_eq!(flown(name, text), plain, "{name}");
    }
}
