//! `glidepolar diagnose` on real logs, as a user runs it: what is known of each from outside is named, or not denied.

use std::process::Command;

use glidepolar::mechanisms::LATERAL;
use glidepolar_tests::{Built, measured_data};
use serde_json::Value;

/// The command's JSON; nothing where the program or the data are not there, which is said aloud by the helpers.
fn diagnose(arguments: &[&str]) -> Option<Value> {
    let (program, data) = (Built::Glidepolar.path()?, measured_data()?);
    let output = Command::new(program)
        .current_dir(data)
        .arg("diagnose")
        .args(arguments)
        .args(["--json", "-"])
        .output()
        .expect("it starts");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    Some(serde_json::from_slice(&output.stdout).expect("JSON and nothing else"))
}

/// The built-in Seaglider with these figures of its hull set to 0, as a file.
fn seaglider_without(keys: &[&str]) -> Option<tempfile::NamedTempFile> {
    let shown = Command::new(Built::Glidepolar.path()?).args(["vehicles", "seaglider"]).output().expect("it starts");
    let text: String = String::from_utf8(shown.stdout)
        .expect("text")
        .lines()
        .map(|line| match keys.iter().find(|key| line.starts_with(**key)) {
            Some(key) => format!("{key} = 0.0\n"),
            None => format!("{line}\n"),
        })
        .collect();
    let file = tempfile::Builder::new().suffix(".toml").tempfile().expect("a file");
    std::fs::write(file.path(), text).expect("the vehicle");
    Some(file)
}

fn names(found: &Value) -> Vec<&str> {
    found["causes"].as_array().expect("causes").iter().filter_map(|cause| cause["cause"].as_str()).collect()
}

fn size(found: &Value, cause: usize, parameter: &str) -> f64 {
    found["causes"][cause]["parameters"][parameter]["value"].as_f64().expect("a value")
}

/// The diagnosis of maria's trial from one of its tables, and the ballast offset \[kg\] against the neutral baseline. What is
/// named beside it must be what such a hull has: drag that falls with speed, between the ITTC line's exponent (-0.12) and a
/// laminar one (-0.25), and some trapped air. With them the offset is smaller than alone: the three share the misfit.
fn maria(table: &str) -> Option<(Value, f64)> {
    let found = diagnose(&[table, "--vehicle", "slocum-049"])?;
    for (place, name) in names(&found).iter().enumerate() {
        match *name {
            "ballast_offset" => {}
            "reynolds_drag" => assert!((-0.25..-0.05).contains(&size(&found, place, "drag_exponent"))),
            "trapped_air" => assert!((0.0..120.0).contains(&size(&found, place, "trapped_air_cc"))),
            other => panic!("{other} is named"),
        }
    }
    let offset_kg = found["trim"]["value"].as_f64().expect("a trim");
    Some((found, offset_kg))
}

/// The trial was flown out of trim. An independent least-squares fit to the table, with the build-up's lift slope and the drag
/// of ascents 0.76 of that of descents as the vehicle has it, finds -58 +- 1.4 g and an exponent of -0.12 +- 0.02, 27 to 4.1 mm/s.
#[test]
fn maria_is_heavy() {
    let Some((found, offset_kg)) = maria("maria997_2022_slocum_g3_glides.csv") else { return };
    assert_eq!(names(&found)[0], "ballast_offset");
    assert!((-0.063..-0.053).contains(&offset_kg), "{offset_kg}");
    assert!(found["gain"]["holdout_rms_after"].as_f64().expect("a number") <= 0.0050, "{}", found["gain"]);
    halves_name_what_the_whole_names(&found, "maria997_2022_slocum_g3_glides.csv", &["--vehicle", "slocum-049"]);
}

/// With one polar for both legs the same independent fit has -76 +- 1.1 g and -0.085 +- 0.019, 33.7 to 4.6 mm/s: the vehicle's
/// legs were measured apart on another glider, whose trim is in them.
#[test]
fn maria_is_heavier_by_what_the_legs_of_the_vehicle_hide() {
    let Some(program) = Built::Glidepolar.path() else { return };
    let shown = Command::new(program).args(["vehicles", "slocum-049"]).output().expect("it starts");
    let mut vehicle: toml::Table = String::from_utf8(shown.stdout).expect("text").parse().expect("a vehicle file");
    let hydro = vehicle["hydro"].as_table_mut().expect("a table");
    assert!(hydro.remove("descent").is_some() && hydro.remove("ascent").is_some());
    let file = tempfile::Builder::new().suffix(".toml").tempfile().expect("a file");
    std::fs::write(file.path(), vehicle.to_string()).expect("the vehicle");
    let path = file.path().to_string_lossy();
    let table = "maria997_2022_slocum_g3_glides.csv";
    let arguments = [table, "--vehicle", &*path, "--trim", "neutral", "--pin-lift=21.1"];
    let Some(found) = diagnose(&arguments) else { return };
    assert_eq!(names(&found)[0], "ballast_offset");
    let offset_kg = size(&found, 0, "ballast_offset_kg");
    assert!((-0.082..-0.070).contains(&offset_kg), "{offset_kg}");
    for (place, name) in names(&found).iter().enumerate().skip(1) {
        assert_eq!(*name, "reynolds_drag");
        let exponent = size(&found, place, "drag_exponent");
        assert!((-0.14..-0.05).contains(&exponent), "{exponent}");
    }
}

/// One sample in 30 s comes to the same trim; what else was thought of for the legs is ruled out there as well.
#[test]
fn maria_sample_by_sample_comes_to_the_same_trim() {
    let Some((found, offset_kg)) = maria("maria997_2022_slocum_g3_samples.csv") else { return };
    assert!((-0.090..-0.040).contains(&offset_kg), "{offset_kg}");
    assert!(found["gain"]["holdout_rms_after"].as_f64().expect("a number") <= 0.009, "{}", found["gain"]);
    for cause in found["causes"].as_array().expect("causes") {
        let group = cause["indistinguishable_from"].as_array().expect("names");
        for other in ["climb_dive_asymmetry", "vertical_current", "pitch_offset"] {
            assert!(!group.contains(&other.into()), "{other} is not ruled out: {group:?}");
        }
    }
}

/// A density that is off by 1.6 kg/m3 would do as much; nobody has seen one.
#[test]
fn sg542_is_light_rather_than_in_denser_water() {
    let Some(found) = diagnose(&["sg542_samples.csv", "--vehicle", "seaglider"]) else { return };
    let turns = |name: &&str| LATERAL.iter().any(|mechanism| mechanism.name == *name);
    let (turning, of_the_plane): (Vec<&str>, Vec<&str>) = names(&found).into_iter().partition(turns);
    assert_eq!(of_the_plane, ["ballast_offset"]);
    // A straight line of curvature against roll and cotangent of the pitch for each leg, fitted apart (numpy, errors by blocks),
    // has -0.0003 +- 0.0005 rad/m at roll 0 on descents and -0.0095 +- 0.0016 on ascents: no one size, hence no name.
    assert!(turning.is_empty(), "{turning:?}");
    halves_name_what_the_whole_names(&found, "sg542_samples.csv", &["--vehicle", "seaglider"]);
}

const COMPRESSIBILITY: (&str, &str) = ("hull_compressibility", "compressibility_per_Pa");
const EXPANSION: (&str, &str) = ("thermal_expansion", "thermal_expansion_per_K");

/// The basestation's figures for this hull: 4.18e-10 1/Pa and 0.705e-4 1/K.
#[test]
fn that_the_hull_of_sg542_is_compressed_is_found_by_name() {
    let Some(found) = sg542_has_a_hull(&[COMPRESSIBILITY], |_, _| ()) else { return };
    let per_pa = size(&found, 0, "hull_compressibility_per_Pa");
    assert!((per_pa / 4.18e-10 - 1.0).abs() < 0.15, "{per_pa}");
}

#[test]
fn that_the_hull_of_sg542_expands_is_found_by_name() {
    sg542_has_a_hull(&[EXPANSION], |_, _| ());
}

#[test]
fn what_the_hull_of_sg542_does_is_found_by_name_and_on_each_half() {
    sg542_has_a_hull(&[COMPRESSIBILITY, EXPANSION], |found, path| {
        halves_name_what_the_whole_names(found, "sg542_samples.csv", &["--vehicle", path]);
    });
}

/// The diagnosis with a vehicle whose hull does nothing of this: it is named in this order. `ask` has the vehicle's file, too.
fn sg542_has_a_hull(hidden: &[(&str, &str)], ask: impl Fn(&Value, &str)) -> Option<Value> {
    let keys: Vec<&str> = hidden.iter().map(|(_, key)| *key).collect();
    let vehicle = seaglider_without(&keys)?;
    let path = vehicle.path().to_string_lossy();
    let found = diagnose(&["sg542_samples.csv", "--vehicle", &path])?;
    for (place, (name, key)) in hidden.iter().enumerate() {
        assert_eq!(names(&found).get(place), Some(name), "{keys:?}: {:?}", names(&found));
        assert!(size(&found, place, &format!("hull_{key}")) > 0.0);
    }
    ask(&found, &path);
    Some(found)
}

/// With the lift slope of the build-up a scale of the pitch is named, or stands in the group of what is.
#[test]
fn comet_with_the_lift_slope_of_the_build_up_has_a_pitch_scale() {
    let options = ["--vehicle", "slocum-graver", "--speed-column", "U_dvl_m_s", "--pin-lift=21"];
    if let Some(found) = comet_has_a_pitch_scale("--pin-lift=21", 0.93) {
        halves_name_what_the_whole_names(&found, "comet_2016_baltic_1hz.csv", &options);
    }
}

/// The owners corrected the pitch: that is the first name.
#[test]
fn comet_with_the_lift_slope_of_the_build_up_has_a_pitch_scale_first() {
    let arguments = ["comet_2016_baltic_1hz.csv", "--vehicle", "slocum-graver", "--speed-column", "U_dvl_m_s"];
    let Some(found) = diagnose(&[&arguments[..], &["--pin-lift=21"]].concat()) else { return };
    assert_eq!(names(&found)[0], "pitch_scale", "{:?}", names(&found));
}

/// With a slope that is a quarter too small.
#[test]
fn comet_with_a_smaller_lift_slope_has_a_pitch_scale() {
    comet_has_a_pitch_scale("--pin-lift=15", 0.87);
}

fn comet_has_a_pitch_scale(pin: &str, most: f64) -> Option<Value> {
    let arguments = ["comet_2016_baltic_1hz.csv", "--vehicle", "slocum-graver", "--speed-column", "U_dvl_m_s", pin];
    let found = diagnose(&arguments)?;
    assert_eq!(found["verdict"], "explained");
    // The Doppler log had lost the water on the last descent.
    assert!(found["warnings"].to_string().contains("measured speed on the descent of dive 18"));
    for gain in found["gains"].as_array().expect("gains") {
        assert!(gain["reduction_percent"].as_f64().expect("a number") > 50.0, "{gain}");
    }
    // Over 40 m of depth a scale of the pressure does what one of the pitch does: either stands first, the other one in its group.
    let first = &found["causes"][0];
    let group = first["indistinguishable_from"].as_array().expect("a group");
    let is_named = first["cause"] == "pitch_scale" || group.iter().any(|name| name == "pitch_scale");
    assert!(is_named, "{first}");
    // The owners' own correction is 0.86; the size goes with the slope that is held.
    let sets = found["alternatives"].as_array().expect("sets").iter().filter_map(|set| set.as_array()).flatten();
    let sizes: Vec<&serde_json::Value> =
        sets.chain([first]).filter_map(|cause| cause["parameters"].get("pitch_scale")).collect();
    let is_near = |size: &&serde_json::Value| {
        let of = |key: &str| size[key].as_f64().expect("a number");
        (0.84..most).contains(&of("value")) && of("se") < 0.01
    };
    assert!(sizes.iter().any(is_near), "{sizes:?}");
    Some(found)
}

/// With the pitch as read the lift slope runs to what no glider has; that is said, with what would help.
#[test]
fn comet_with_its_raw_pitch_is_warned_of() {
    let arguments = ["comet_2016_baltic_1hz.csv", "--vehicle", "slocum-graver", "--speed-column", "U_dvl_m_s"];
    let Some(found) = diagnose(&arguments) else { return };
    let warnings = found["warnings"].to_string();
    assert!(
        warnings.contains("a_per_rad") && warnings.contains("scale of the pitch cannot be distinguished"),
        "{warnings}"
    );
    // No mechanism of the vertical plane is blamed instead. Beside it the glider leans: its mean roll with the fin within 0.02 rad
    // of zero is 0.0653 rad on descents (398 rows) and 0.0674 on ascents (399), a list or a sensor mounted askew.
    assert_eq!(names(&found), ["static_list"]);
    let list = &found["causes"][0];
    assert_eq!(list["indistinguishable_from"], serde_json::json!(["roll_offset"]));
    let interval = list["parameters"]["static_list_rad"]["ci95"].as_array().expect("an interval");
    let [low, high] = [0, 1].map(|end| interval[end].as_f64().expect("a number"));
    assert!(low < 0.0653 && 0.0674 < high, "{low} to {high}");
}

/// The two halves of a table, by dives where it has them and by time otherwise.
fn halves(table: &str) -> Option<[tempfile::NamedTempFile; 2]> {
    let text = std::fs::read_to_string(measured_data()?.join(table)).expect("the table");
    let (head, rows) = text.split_once('\n').expect("a line of names");
    let column = |name: &str| head.split(',').position(|column| column.trim() == name);
    let by = ["dive", "start_s", "time_s"].into_iter().find_map(column).expect("dives or times");
    let value =
        |row: &str| row.split(',').nth(by).and_then(|value| value.trim().parse::<f64>().ok()).expect("a number");
    let rows: Vec<&str> = rows.lines().filter(|row| !row.starts_with('#')).collect();
    let middle = 0.5 * (value(rows[0]) + value(rows[rows.len() - 1]));
    let half = |is_first: bool| {
        let of_half = rows.iter().filter(|row| (value(row) < middle) == is_first);
        let file = tempfile::Builder::new().suffix(".csv").tempfile().expect("a file");
        let lines: Vec<&str> = std::iter::once(head).chain(of_half.copied()).collect();
        std::fs::write(file.path(), lines.join("\n")).expect("a half");
        file
    };
    Some([half(true), half(false)])
}

/// A cause that only the whole of a log has, and neither half, is none that a pilot could act on. Asked of each log beside what
/// else is known of it: the whole is diagnosed once.
fn halves_name_what_the_whole_names(whole: &Value, table: &str, options: &[&str]) {
    let Some(halves) = halves(table) else { return };
    assert!(!names(whole).is_empty(), "{table}");
    for half in &halves {
        let found = diagnose(&[&[&*half.path().to_string_lossy()], options].concat()).expect("a diagnosis");
        for cause in whole["causes"].as_array().expect("causes") {
            let name = &cause["cause"];
            let stands_for =
                |a: &Value, b: &Value| a["indistinguishable_from"].as_array().is_some_and(|g| g.contains(&b["cause"]));
            let again = found["causes"]
                .as_array()
                .expect("causes")
                .iter()
                .find(|other| other["cause"] == *name || stands_for(other, cause) || stands_for(cause, other));
            let again = again.unwrap_or_else(|| panic!("{table}: no {name} on a half: {}", found["causes"]));
            if again["cause"] != *name {
                continue;
            }
            for (parameter, size) in cause["parameters"].as_object().expect("sizes") {
                let of = |size: &Value, key: &str| size[key].as_f64().expect("a number");
                let other = &again["parameters"][parameter];
                let apart = (of(size, "value") - of(other, "value")).abs();
                let most = 1.96 * of(size, "se").hypot(of(other, "se"));
                assert!(apart < most, "{table}: {name} {size} on the whole, {other} on a half");
            }
        }
    }
}
