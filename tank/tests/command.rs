//! The command as a user or a script meets it: what it prints, where, and with what exit code.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use glidepolar_hull::hull_tests::Reduction;

fn tank_reduce(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tank-reduce")).current_dir(folder).args(arguments).output().unwrap()
}

fn data(name: &str) -> String {
    let path: PathBuf = [env!("CARGO_MANIFEST_DIR"), "data", name].iter().collect();
    path.to_str().unwrap().to_owned()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn json_on_standard_output_is_all_that_stands_there() {
    let folder = tempfile::tempdir().unwrap();
    let (points, hull) = (data("suboff_roddy1990.csv"), data("suboff.toml"));
    let output = tank_reduce(folder.path(), &[&points, "--hull", &hull, "--json", "-", "--range-deg", "10"]);
    assert_eq!(output.status.code(), Some(0));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["schema"], "tank-reduce/1");
    let hull = &json["hulls"][0];
    for (name, unit) in [("a", "1/rad"), ("b", "1"), ("c", "1/rad^2"), ("d", "1/rad")] {
        let q = &hull["fit"][name];
        assert!(q["value"].is_f64() && q["se"].is_f64() && q["ci95"].as_array().unwrap().len() == 2, "{name}");
        assert_eq!(q["unit"], unit);
    }
    assert_eq!((&hull["id"], &hull["n_runs"]), (&"SUBOFF".into(), &24.into()));
    assert!(hull["dynamic"].is_null() && hull["diagnosis"].is_null() && json["campaign_diagnosis"].is_null());
    assert!(json["warnings"].as_array().unwrap().iter().any(|w| w.as_str().unwrap().contains("depend")));
    // The file is the same, and what a vehicle is made from reads it.
    let written = Reduction::load(&folder.path().join("tank_out/fits.json")).unwrap();
    assert_eq!(serde_json::to_value(&written).unwrap(), json);
    for name in ["coefficients.csv", "report.html", "figures/lift.svg", "figures/drag.png", "figures/moment.svg"] {
        assert!(folder.path().join("tank_out").join(name).is_file(), "{name}");
    }
}

#[test]
fn a_campaign_needs_one_command() {
    let folder = tempfile::tempdir().unwrap();
    let demo =
        tank_reduce(folder.path(), &["demo", "pmm_runs", "--hull", "LDR8.5", "--hull", "LDR12.5", "--seed", "21"]);
    assert_eq!(demo.status.code(), Some(0), "{}", text(&demo.stderr));
    let output = tank_reduce(folder.path(), &["pmm_runs"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let table = text(&output.stdout);
    assert!(table.lines().count() == 4 && table.contains("LDR8.5") && table.contains("LDR12.5"), "{table}");
    let page = std::fs::read_to_string(folder.path().join("tank_out/report.html")).unwrap();
    for expected in [
        "Munk 1924",
        "Lamb, spheroid",
        "Uncertainty budget",
        "Run matrix",
        "Yvdot",
        "SYNTHETIC",
        "0.090 %",
        "steady sweep",
    ] {
        assert!(page.contains(expected), "{expected}");
    }
    let runs = std::fs::read_to_string(folder.path().join("tank_out/runs-LDR8.5.html")).unwrap();
    assert!(page.contains("href=\"runs-LDR8.5.html\"") && runs.contains("effective samples"));
    // The names of XML's vocabularies and the notice of the plotting library are no addresses that a browser asks.
    let asked = |page: &str| {
        page.replace("http://www.w3.org/", "").replace("/*! https://github.com/leeoniya/uPlot", "").contains("://")
    };
    assert!(!asked(&page) && !asked(&runs), "the page asks nothing of anybody");
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
    let steps = std::fs::read_to_string(folder.path().join("tank_out/steps.csv")).unwrap();
    assert!(steps.starts_with("run_id,kind,speed_m_s,yaw_deg,window_from_s,window_to_s,reading_AF_N"));
    let quiet = tank_reduce(folder.path(), &["pmm_runs", "--quiet"]);
    assert!(quiet.status.success() && quiet.stdout.is_empty());
    // A run that is left out is said even then.
    let run = std::fs::read_dir(folder.path().join("pmm_runs/data")).unwrap().next().unwrap().unwrap().path();
    std::fs::write(&run, "").unwrap();
    let quiet = tank_reduce(folder.path(), &["pmm_runs", "--quiet"]);
    assert!(quiet.status.success() && quiet.stdout.is_empty() && text(&quiet.stderr).contains("is left out"));
}

#[test]
fn bad_input_ends_with_two_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("points.csv"), "yaw_deg,CL,CD,CM\n1,2,3,x\n").unwrap();
    std::fs::write(folder.path().join("drift.csv"), "beta_deg,CL,CD,CM\n1,2,3,4\n").unwrap();
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    let hull = data("suboff.toml");
    for (arguments, expected) in [
        (vec!["drift.csv", "--hull", &hull], "rename it to yaw_deg"),
        (vec!["points.csv", "--hull", "LDR8.5"], "name the TOML file"),
        (vec!["runs", "--hull", "LDR8.5"], "the hulls of a campaign stand in runs/campaign.toml"),
        (vec!["points.csv", "--hull", &hull], "points.csv:2:4: CM is `x`"),
        (vec!["points.csv", "--hull", "no.toml"], "no.toml"),
        (vec!["points.csv"], "--hull"),
        (vec!["nowhere"], "campaign.toml"),
        (vec!["points.csv", "--hull", &hull, "--range-deg", "-3"], "--range-deg"),
    ] {
        let output = tank_reduce(folder.path(), &arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(expected) && !message.contains("panicked"), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty());
        assert!(!folder.path().join("tank_out").exists(), "{arguments:?}");
    }
}

/// A campaign that somebody has edited is not replaced by a made-up one.
#[test]
fn an_edited_campaign_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let demo = ["demo", "runs", "--hull", "LDR8.5", "--quiet"];
    assert!(tank_reduce(folder.path(), &demo).status.success());
    let file = folder.path().join("runs/runs.csv");
    let edited = std::fs::read_to_string(&file).unwrap().replacen("synthetic", "repeat this one", 1);
    std::fs::write(&file, &edited).unwrap();
    let output = tank_reduce(folder.path(), &demo);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("edited") && message.contains("--force"), "{message}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), edited);
}

/// A campaign whose angles are radians, in the records alone or everywhere, has no coefficients: that is no success, whatever
/// its oscillations give.
#[test]
fn a_campaign_in_radians_ends_with_one() {
    let radians = |text: &str, column: &str| {
        let lines: Vec<&str> = text.lines().collect();
        let header = lines.iter().position(|line| !line.starts_with('#')).expect("a header");
        let at = lines[header].split(',').position(|name| name == column).expect("the column");
        let changed = lines.iter().enumerate().map(|(i, line)| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            if let Some(degrees) = cells.get(at).filter(|_| i > header).and_then(|cell| cell.parse::<f64>().ok()) {
                cells[at] = degrees.to_radians().to_string();
            }
            cells.join(",") + "\n"
        });
        changed.collect::<String>()
    };
    let folder = tempfile::tempdir().unwrap();
    let demo = tank_reduce(folder.path(), &["demo", "runs", "--hull", "LDR8.5", "--quiet"]);
    assert!(demo.status.success(), "{}", text(&demo.stderr));
    let runs = folder.path().join("runs");
    let rewrite = |path: &Path| {
        let degrees = std::fs::read_to_string(path).unwrap();
        std::fs::write(path, radians(&degrees, "yaw_deg")).unwrap();
    };
    for entry in std::fs::read_dir(runs.join("data")).unwrap() {
        rewrite(&entry.unwrap().path());
    }
    for everywhere in [false, true] {
        if everywhere {
            rewrite(&runs.join("runs.csv"));
        }
        let output = tank_reduce(folder.path(), &["runs", "--force"]);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("radians") && said.contains("no usable result"), "{said}");
        // One reason, not one line a run.
        assert!(said.lines().filter(|line| line.contains("radians")).count() <= 6, "{said}");
    }
}

#[test]
fn what_stands_in_the_way_leaves_no_half_of_the_results() {
    let folder = tempfile::tempdir().unwrap();
    let (points, hull) = (data("suboff_roddy1990.csv"), data("suboff.toml"));
    let reduce = |more: &[&str]| tank_reduce(folder.path(), &[&[points.as_str(), "--hull", &hull], more].concat());
    for (kept, name) in [("page", "report.html"), ("table", "coefficients.csv")] {
        std::fs::create_dir(folder.path().join(kept)).unwrap();
        std::fs::write(folder.path().join(kept).join(name), "keep").unwrap();
        let output = reduce(&["--out", kept]);
        let message = text(&output.stderr);
        assert!(output.status.code() == Some(1) && message.contains("--force"), "{message}");
        assert_eq!(std::fs::read_dir(folder.path().join(kept)).unwrap().count(), 1, "{kept}");
    }
    std::fs::write(folder.path().join("afile"), "keep").unwrap();
    let output = reduce(&["--json", "afile/fits.json"]);
    let message = text(&output.stderr);
    assert!(output.status.code() == Some(1) && message.contains("afile/fits.json: cannot be written"), "{message}");
    assert_eq!(reduce(&["--out", "afile"]).status.code(), Some(1));
    assert!(!folder.path().join("tank_out").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_ends_with_a_message() {
    let folder = tempfile::tempdir().unwrap();
    let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_tank-reduce"))
        .current_dir(folder.path())
        .args([data("suboff_roddy1990.csv"), "--hull".to_owned(), data("suboff.toml")])
        .stdout(full)
        .output()
        .unwrap();
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("standard output cannot be written") && !message.contains("panicked"), "{message}");
}

#[test]
fn what_is_relevant_is_the_users_to_say() {
    let folder = tempfile::tempdir().unwrap();
    let (points, hull) = (data("suboff_roddy1990.csv"), data("suboff.toml"));
    let reduced = |relevant: &[&str]| {
        let given = relevant.iter().flat_map(|text| ["--relevant", text]);
        let arguments: Vec<&str> =
            [points.as_str(), "--hull", &hull, "--diagnose", "--json", "-"].into_iter().chain(given).collect();
        tank_reduce(folder.path(), &arguments)
    };
    let verdict = |output: &Output| {
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        json["hulls"][0]["diagnosis"]["verdict"].as_str().unwrap().to_owned()
    };
    // SUBOFF's lift departs from a straight line by a fifth of a coefficient at most.
    assert_ne!(verdict(&reduced(&["CL=0.01"])), "none");
    assert_eq!(verdict(&reduced(&["CL=1", "CD=1", "CM=1"])), "none");
    let wrong = reduced(&["lift=1"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(text(&wrong.stderr).contains("--relevant") && text(&wrong.stderr).contains("CL=0.005"));
}
