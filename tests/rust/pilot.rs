//! A pilot's commands as a pilot types them: what they write over, what they say where they do not know, and what comes back
//! from a log that the program itself has flown.

use std::path::Path;
use std::process::{Command, Output};

use glidepolar_tests::Built;
use serde_json::Value;

const MISSION: &str = r#"
name = "A day of dives"
source = "made up"
[voyage]
duration_h = 12.0
[dive]
max_depth_m = 120.0
[glide]
pitch_down_deg = -24.0
pitch_up_deg = 26.0
ballast_down_cc = -150.0
ballast_up_cc = 170.0
[surfacing]
stay_min = 6.0
"#;

fn run(folder: &Path, arguments: &[&str]) -> Option<Output> {
    let program = Built::Glidepolar.path()?;
    Some(Command::new(program).current_dir(folder).args(arguments).output().expect("it starts"))
}

fn ok(folder: &Path, arguments: &[&str]) -> Option<String> {
    let output = run(folder, arguments)?;
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn json(folder: &Path, arguments: &[&str]) -> Option<Value> {
    let text = ok(folder, &[arguments, &["--json", "-"]].concat())?;
    Some(serde_json::from_str(&text).expect("JSON and nothing else"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A log of the vehicle by the simulator, noise of a millimetre of depth and a hundredth of a degree added by its resolution.
fn log_of(folder: &Path, vehicle: &str, more: &str) -> Option<String> {
    std::fs::write(folder.join("mission.toml"), format!("{MISSION}{more}")).expect("a file");
    let log = format!("{}.csv", vehicle.replace(['.', '/'], "_"));
    let arguments =
        ["simulate", vehicle, "--mission", "mission.toml", "--interval", "10", "--log", &log, "--fixes", "fixes.csv"];
    ok(folder, &[&arguments[..], &["-q", "--force"]].concat())?;
    Some(log)
}

/// A built-in Slocum's lift slope is that of its paper, which a real Slocum has not; its own log has it, leg by leg. Another one
/// leaves a drag due to lift of -509 per rad2.
#[test]
fn a_built_in_slocum_on_its_own_log_keeps_the_lift_slope_of_each_leg() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(log) = log_of(folder.path(), "slocum-049", "") else { return };
    let diagnosed = json(folder.path(), &["diagnose", &log, "--vehicle", "slocum-049"]).expect("a diagnosis");
    let warnings = diagnosed["warnings"].to_string();
    assert!(warnings.contains("held at 4.70 per rad, on each leg at its own"), "{warnings}");
    assert!(!warnings.contains("c_per_rad2"), "{warnings}");
    assert_eq!(diagnosed["causes"], serde_json::json!([]));
    let identified = json(folder.path(), &["identify", &log, "--vehicle", "slocum-049"]).expect("a fit");
    assert_eq!(number(&identified["pinned"]["a"]["value"]), 4.7);
}

/// A log without noise, over a seabed that turns the glider ever sooner: the smallest errors of the equations are all that is left.
#[test]
fn nothing_is_wrong_in_a_vehicles_own_log_with_and_without_its_speed() {
    let mission = concat!(env!("CARGO_MANIFEST_DIR"), "/../missions/rising-seabed.toml");
    for vehicle in ["rogue", "slocum-graver", "slocum-049", "adelaide", "seaglider"] {
        let folder = tempfile::tempdir().expect("a folder");
        let flown = ["simulate", vehicle, "--mission", mission, "--log", "log.csv", "--csv", "flown.csv", "-q"];
        if ok(folder.path(), &flown).is_none() {
            return;
        }
        add_speed(folder.path());
        for trim in ["vehicle", "neutral"] {
            for options in [&[][..], &["--speed-column", "speed_m_s"]] {
                let arguments = ["diagnose", "log.csv", "--vehicle", vehicle, "--trim", trim];
                let found = json(folder.path(), &[&arguments[..], options].concat()).expect("a diagnosis");
                assert_eq!(found["verdict"], "none", "{vehicle} {trim} {options:?}: {}", found["causes"]);
            }
        }
    }
}

/// Writes the speed of the time history behind the log of the same flight.
fn add_speed(folder: &Path) {
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).expect("it was written");
    let (log, flown) = (read("log.csv"), read("flown.csv"));
    let mut flown = csv::Reader::from_reader(flown.as_bytes());
    let place = flown.headers().expect("a header").iter().position(|name| name == "speed_m_s").expect("a column");
    let mut speeds = flown.records().map(|row| row.expect("a row")[place].to_owned());
    let with_speed = log.lines().map(|line| match line.chars().next() {
        Some('#') => line.to_owned(),
        Some('t') => format!("{line},speed_m_s"),
        _ => format!("{line},{}", speeds.next().expect("as many rows")),
    });
    std::fs::write(folder.join("log.csv"), with_speed.collect::<Vec<_>>().join("\n")).expect("a file");
}

#[test]
fn the_intervals_hold_what_the_vehicle_of_a_simulated_log_is() {
    for vehicle in ["rogue", "slocum-graver", "slocum-049", "adelaide", "seaglider"] {
        let folder = tempfile::tempdir().expect("a folder");
        let Some(log) = log_of(folder.path(), vehicle, "") else { return };
        let Some(found) = json(folder.path(), &["identify", &log, "--vehicle", vehicle, "--trim", "vehicle"]) else {
            return;
        };
        let text = ok(folder.path(), &["vehicles", vehicle]).expect("the file");
        let own: toml::Table = text.parse().expect("a vehicle file");
        for (name, key) in [("a", "a_per_rad"), ("b", "b"), ("c", "c_per_rad2")] {
            let of_leg = own["hydro"].get("descent").and_then(|leg| leg.get(key));
            let truth = of_leg.unwrap_or(&own["hydro"][key]).as_float().expect("a number");
            let q = &found["parameters"][name];
            let slack = 2e-3 * truth.abs();
            let (low, high) = (number(&q["ci95"][0]) - slack, number(&q["ci95"][1]) + slack);
            assert!((low..=high).contains(&truth), "{vehicle} {name}: {truth} beside {q}");
        }
        // Two glides of one pitch each do not separate Rogue's b and c, beside a ballast offset: that is reported.
        assert!(vehicle != "rogue" || found["pinned"]["c"].is_object(), "{}", found["pinned"]);
        let offset = &found["parameters"]["ballast_offset_kg"];
        assert!(number(&offset["value"]).abs() < 3e-3, "{vehicle}: {offset}");
        // Its own polar comes back with its own speeds, legs and all.
        ok(
            folder.path(),
            &["identify", &log, "--vehicle", vehicle, "--trim", "vehicle", "--write", "identified.toml", "-q"],
        );
        for (net_mass_kg, pitch_deg) in [("0.12", "-24"), ("-0.12", "26")] {
            let speed = |vehicle: &str| {
                let glide = ["glide", vehicle, "--net-mass-kg", net_mass_kg, "--pitch-deg", pitch_deg];
                number(&json(folder.path(), &glide).expect("a glide")["glide"]["speed_m_s"])
            };
            let (identified, truth) = (speed("identified.toml"), speed(vehicle));
            assert!((identified / truth - 1.0).abs() < 5e-3, "{vehicle}: {identified} m/s beside {truth}");
        }
    }
}

/// Battery, pitch and ballast of a simulated log give back what the vehicle has that flew it, also where the pilot's file has
/// another moment and another centre of gravity; the file that is written balances with the battery where it stood.
#[test]
fn the_balance_of_moments_that_a_log_shows_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(text) = ok(folder.path(), &["vehicles", "seaglider"]) else { return };
    let truth = text.replace("nominal_kg = 1.0", "nominal_kg = 1.0\nforward_m = -0.3");
    let own = truth.replace("\nd_per_rad = -0.35", "\nd_per_rad = -0.8").replace("height_m = 0.05", "height_m = 0.08");
    assert!(text != truth && own.contains("-0.8") && own.contains("0.08"));
    for (name, text) in [("truth.toml", &truth), ("own.toml", &own)] {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    let log = log_of(folder.path(), "truth.toml", "").expect("it ran before");
    ok(folder.path(), &["identify", &log, "--vehicle", "own.toml", "--write", "identified.toml", "-q"]);
    let written: toml::Table =
        std::fs::read_to_string(folder.path().join("identified.toml")).expect("a file").parse().expect("TOML");
    let figure = |section: &str, key: &str| written[section][key].as_float().expect("a number");
    // 10 kg of battery 0.05 m below the centre of buoyancy, of 52.5 kg.
    assert!((figure("mass", "cg_below_cb_m") - 10.0 * 0.05 / 52.5).abs() < 2e-5);
    assert!((figure("hydro", "d_per_rad") + 0.35).abs() < 0.01);
    assert!(written["uncertainty"]["hydro.d_per_rad"].as_float().is_some_and(|se| se > 0.0));
    for (pitch, net_mass) in [("-24", "0.17"), ("26", "-0.17")] {
        let battery_m = |vehicle: &str| {
            let glide = ["glide", vehicle, "--pitch-deg", pitch, "--net-mass-kg", net_mass];
            number(&json(folder.path(), &glide).expect("a glide")["glide"]["moving_mass_m"])
        };
        let (truth, written, own) = (battery_m("truth.toml"), battery_m("identified.toml"), battery_m("own.toml"));
        assert!((written - truth).abs() < 1e-4, "{pitch} deg: {written} m beside {truth}");
        assert!((own - truth).abs() > 1e-2, "{pitch} deg: {own} m beside {truth}");
    }
}

#[test]
fn a_track_of_a_simulated_log_finds_the_current_that_it_was_flown_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let current = "[current]\ndepth_m = [0.0, 500.0]\nalong_m_s = [0.1, 0.1]\n";
    let Some(log) = log_of(folder.path(), "seaglider", current) else { return };
    let arguments = ["track", &log, "--vehicle", "seaglider", "--fixes", "fixes.csv", "--out", "track"];
    let Some(found) = json(folder.path(), &arguments) else { return };
    let drifts = found["between_fixes"].as_array().expect("currents");
    let under_way: Vec<&Value> = drifts.iter().filter(|d| number(&d["current"]["duration_s"]) > 1000.0).collect();
    assert!(under_way.len() > 3, "{drifts:?}");
    for drift in under_way {
        // What the steady glide does not follow in the turns is a hundredth of the speed.
        assert!((number(&drift["current"]["north_m_s"]) - 0.1).abs() < 0.012, "{drift}");
        assert!(number(&drift["current"]["east_m_s"]).abs() < 2e-3, "{drift}");
    }
    let page = std::fs::read_to_string(folder.path().join("track/report.html")).expect("a page");
    assert!(page.contains("fixes, over ground") && !page.contains("Without fixes"));
    // Without a second fix within the log the page says so, and not that there are none.
    std::fs::write(folder.path().join("one.csv"), "time_s,lat_deg,lon_deg\n1e9,0,0\n").expect("a file");
    let other = ["track", &log, "--vehicle", "seaglider", "--fixes", "one.csv", "--out", "other", "-q"];
    ok(folder.path(), &other);
    let page = std::fs::read_to_string(folder.path().join("other/report.html")).expect("a page");
    assert!(page.contains("no current follows") && !page.contains("Without fixes"));
}

#[test]
fn nothing_is_replaced_that_this_command_did_not_write_as_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(log) = log_of(folder.path(), "slocum-049", "") else { return };
    let before = std::fs::read(folder.path().join(&log)).expect("the log");
    let of_another = "--force";
    for (arguments, expected) in [
        // An FMU needs the built library: where there is none, that is what is said, and the log stays.
        (&["export-fmu", "slocum-049", "-o", &log][..], ""),
        (&["glide", "slocum-049", "-q", "--json", &log], of_another),
        (&["simulate", "slocum-049", "--stop", "10", "-q", "--csv", &log], of_another),
        (&["identify", &log, "--vehicle", "slocum-049", "-q", "--write", &log], "a file that this command reads"),
    ] {
        let output = run(folder.path(), arguments).expect("it ran before");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success(), "{arguments:?}");
        assert!(said.contains(expected), "{arguments:?}: {said}");
        assert_eq!(std::fs::read(folder.path().join(&log)).expect("the log"), before, "{arguments:?}");
    }
    // The same command replaces its own result, until somebody has edited it.
    let glide = ["glide", "slocum-049", "-q", "--json", "glide.json"];
    ok(folder.path(), &glide);
    ok(folder.path(), &glide);
    let file = folder.path().join("glide.json");
    let edited = std::fs::read_to_string(&file).expect("a result").replace("049", "49");
    std::fs::write(&file, &edited).expect("a file");
    let output = run(folder.path(), &glide).expect("it ran before");
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(std::fs::read_to_string(&file).expect("a result"), edited);
}

#[test]
fn a_polar_begins_with_its_answers_and_an_edge_is_no_optimum() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(text) = ok(folder.path(), &["glide", "slocum-049"]) else { return };
    let first: Vec<&str> = text.lines().take(8).collect();
    for answer in ["Best glide ratio", "Minimum sink"] {
        assert!(first.iter().any(|line| line.starts_with(answer)), "{first:?}");
    }
    assert!(text.lines().count() < 35, "{text}");
    // This glider's best glide lies beyond the angles that its lift and drag were fitted at: that stands beside it.
    ok(folder.path(), &["glide", "slocum-049", "--out", "page"]);
    let page = std::fs::read_to_string(folder.path().join("page/report.html")).expect("a page");
    let (best, next) =
        (first.iter().position(|line| line.starts_with("Best glide ratio")).expect("it"), "extrapolated");
    let alpha = first[best].split("angle of attack ").nth(1).and_then(|rest| rest.split(' ').next());
    let alpha: f64 = alpha.expect("an angle").parse().expect("a number");
    assert_eq!(alpha > 10.0, first[best + 1].contains(next), "{first:?}");
    assert_eq!(alpha > 10.0, page.contains("Best glide ratio (extrapolated, beyond ±10°)"), "{alpha}");
    assert!(alpha > 10.0, "{alpha}: the case is not tested any more, another vehicle is needed");
    let found = json(folder.path(), &["glide", "slocum-049"]).expect("a polar");
    let glides = found["polar"]["glides"].as_array().expect("glides");
    let sink = |row: &Value| number(&row["vertical_velocity_m_s"]).abs();
    let least = glides.iter().map(sink).fold(f64::INFINITY, f64::min);
    let optimum = &found["polar"]["minimum_sink"];
    let is_edge = sink(&glides[0]) <= least || sink(glides.last().expect("glides")) <= least;
    assert_eq!(optimum["is_within_range"].as_bool(), Some(!is_edge), "{optimum}");
}

#[test]
fn a_plan_says_what_it_took_for_granted() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["plan", "seaglider", "--battery-Wh", "2700", "--depth-m", "1000"];
    let Some(found) = json(folder.path(), &arguments) else { return };
    let duration = &found["plan"]["dive_duration_h"];
    // Real ones last 3 to 4.8 h.
    assert!((3.0..4.8).contains(&number(&duration["value"])), "{duration}");
    assert!(number(&duration["se"]) > 0.0, "{duration}");
    let output = run(folder.path(), &[&arguments[..], &["--days", "36500"]].concat()).expect("it ran before");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("battery is empty after"), "{said}");
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(!printed.contains("e-1") && !printed.contains("(-0 to 0)"), "{printed}");
    // What a vehicle has no figures for is not nothing.
    std::fs::write(folder.path().join("mission.toml"), MISSION).expect("a file");
    for (vehicle, more) in [("slocum-049", &[][..]), ("seawing", &["--3d"])] {
        let mission = [&["simulate", vehicle, "--mission", "mission.toml"], more].concat();
        let text = ok(folder.path(), &mission).expect("a mission");
        assert_eq!(text.matches("not known").count(), 2, "pump and hotel of {vehicle}: {text}");
        assert!(!text.contains(" 0.00 Wh"), "{text}");
    }
}

/// A drag that the log contradicts gets a warning, beside its intervals.
#[test]
fn a_fit_that_misses_the_log_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(log) = log_of(folder.path(), "seaglider", "") else { return };
    let warnings = |more: &[&str]| {
        let arguments = [&["identify", &log, "--vehicle", "seaglider"], more].concat();
        json(folder.path(), &arguments).expect("a fit")["warnings"].to_string()
    };
    let said = "the model does not describe the log: it misses the vertical velocity";
    assert!(warnings(&["--pin", "b=0.5"]).contains(said));
    assert!(!warnings(&[]).contains(said));
}

/// A battery is used up to its last joule, whatever its size: nothing is left of it, and no error.
#[test]
fn a_battery_that_is_used_up_has_nothing_left() {
    let folder = tempfile::tempdir().expect("a folder");
    for battery in ["777", "2700", "3333", "4100"] {
        let arguments = ["plan", "seaglider", "--battery-Wh", battery, "--depth-m", "1000", "--out", "page", "--force"];
        let Some(found) = json(folder.path(), &arguments) else { return };
        for key in ["battery_left_Wh", "battery_left_percent"] {
            let left = &found["plan"][key];
            assert_eq!([&left["value"], &left["se"]].map(number), [0.0, 0.0], "{battery} Wh: {left}");
        }
        let page = std::fs::read_to_string(folder.path().join("page/report.html")).expect("a page");
        let (_, row) = page.split_once("Left in the battery").expect("its row");
        let (row, _) = row.split_once("</tr>").expect("its end");
        assert!(!row.contains('('), "{battery} Wh: {row}");
    }
}

/// A log stands in a comparison as the glider that is identified from it.
#[test]
fn a_log_is_compared_as_the_glider_that_flew_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(first) = log_of(folder.path(), "seaglider", "") else { return };
    let second = "second.csv";
    std::fs::copy(folder.path().join(&first), folder.path().join(second)).expect("a copy");
    ok(folder.path(), &["identify", &first, "--vehicle", "seaglider", "--write", "identified.toml", "-q"]);
    let arguments = ["compare", &first, second, "identified.toml", "--vehicle", "seaglider"];
    let found = json(folder.path(), &arguments).expect("a comparison");
    let [one, other, identified] = [0, 1, 2].map(|i| &found["gliders"][i]);
    for key in ["a_per_rad", "b", "c_per_rad2"] {
        assert_eq!(one[key], other[key], "{key}");
        let [log, vehicle] = [one, identified].map(|glider| number(&glider[key]["value"]));
        assert!((log / vehicle - 1.0).abs() < 1e-9, "{key}: {log} beside {vehicle}");
    }
}

#[test]
fn gliders_are_compared_side_by_side() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(found) = json(folder.path(), &["compare", "slocum-049", "seaglider", "seaexplorer", "--out", "page"])
    else {
        return;
    };
    let gliders = found["gliders"].as_array().expect("gliders");
    assert_eq!(gliders.len(), 3);
    // Each speed is the one of `glide` at the same net mass and pitch.
    let net_mass = found["net_mass_kg"].to_string();
    for (glider, name) in gliders.iter().zip(["slocum-049", "seaglider", "seaexplorer"]) {
        let at = &glider["descents"][1];
        let pitch = format!("-{}", number(&at["pitch_deg"]));
        let glide = ["glide", name, "--net-mass-kg", &net_mass, "--pitch-deg", &pitch, "--density", "1027"];
        let speed = number(&json(folder.path(), &glide).expect("a glide")["glide"]["speed_m_s"]);
        assert!((number(&at["speed_m_s"]) - speed).abs() < 1e-9, "{name}: {speed} beside {at}");
    }
    // The page begins with what differs: who glides furthest, who is fastest, who draws least, each with the table's figures.
    let page = std::fs::read_to_string(folder.path().join("page/report.html")).expect("a page");
    let (_, found_on_page) = page.split_once("<h2>What was found</h2>").expect("what was found");
    let (found_on_page, _) = found_on_page.split_once("</section>").expect("its end");
    let ranked = |key: &str| {
        let mut known: Vec<(f64, &str)> = gliders
            .iter()
            .filter_map(|glider| Some((glider[key].as_f64()?, glider["what"].as_str().expect("a name"))))
            .collect();
        known.sort_by(|one, other| one.0.total_cmp(&other.0));
        known
    };
    let ratios = ranked("best_glide_ratio");
    let ((least, last), (best, first)) = (ratios[0], ratios[ratios.len() - 1]);
    let sentence = format!("Best glide: {first} goes {best:.2} along for 1 down, {last} {least:.2}.");
    assert!(found_on_page.contains(&sentence), "{sentence} is not in {found_on_page}");
    assert!(found_on_page.contains("Speed at 25 deg and a net mass of"), "{found_on_page}");
    let costs = ranked("energy_per_km_kJ");
    assert_eq!(costs.len() > 1, found_on_page.contains("Energy per kilometre:"), "{costs:?}: {found_on_page}");
}

/// Half an hour of one leg gives figures of which no error is known: that is no result.
#[test]
fn a_log_of_one_dive_ends_with_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(log) = log_of(folder.path(), "seaglider", "") else { return };
    let text = std::fs::read_to_string(folder.path().join(&log)).expect("the log");
    let start: String = text.lines().take(60).map(|line| format!("{line}\n")).collect();
    std::fs::write(folder.path().join("start.csv"), start).expect("a file");
    let arguments = ["identify", "start.csv", "--vehicle", "seaglider", "--json", "one.json"];
    let output = run(folder.path(), &arguments).expect("it ran before");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("dives with steady samples: 1, at least 2"), "{said}");
    // The figures are there for whoever wants them.
    assert!(folder.path().join("one.json").exists());
}

/// A column of density evaluated at p = 0 is corrected in all commands, from the log's own temperature and salinity.
#[test]
fn gravity_follows_the_latitude_of_the_log() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(log) = log_of(folder.path(), "seaglider", "") else { return };
    let text = std::fs::read_to_string(folder.path().join(&log)).expect("the log");
    let with_latitude: Vec<String> = text
        .lines()
        .map(|line| match line {
            line if line.starts_with('#') => line.to_owned(),
            line if line.starts_with("time_s") => format!("{line},lat_deg,lon_deg"),
            line => format!("{line},10.0,60.0"),
        })
        .collect();
    std::fs::write(folder.path().join("tropical.csv"), with_latitude.join("\n")).expect("a file");
    let fit = |log: &str| json(folder.path(), &["identify", log, "--vehicle", "seaglider"]).expect("a fit");
    let (tropical, unknown) = (fit("tropical.csv"), fit(&log));
    // TEOS-10 has 9.7819 m/s2 at 10 degrees.
    assert!(tropical["notes"].to_string().contains("g = 9.7819"), "{}", tropical["notes"]);
    assert!(unknown["notes"].to_string().contains("9.81 m/s2: the log has no position"), "{}", unknown["notes"]);
    // Less weight drives the glider, and the same pressures are further apart in depth: b goes with g / w^2, and w with 1 / g.
    let b = |found: &Value| number(&found["parameters"]["b"]["value"]);
    let (found, expected) = (b(&tropical) / b(&unknown), (9.7819f64 / 9.81).powi(3));
    assert!((found - expected).abs() < 1e-3, "b falls to {found}, by gravity to {expected}");
}
