//! Whole campaigns of the virtual tank against their stated truth, and the same campaigns spoilt in every way that a
//! campaign can be.

mod support;

use std::fs;
use std::path::Path;

use glidepolar_tank::virtual_tank::EffectRequest;
use glidepolar_tank::{Options, Results, reduce_campaign};
use support::{Spoilt, campaign, effect, reduce, run_of};

/// One hull, one seed: every coefficient and derivative within five standard errors, and most within two.
#[test]
fn a_campaign_gives_its_stated_truth() {
    let (_folder, results, truth) = campaign(1, &["LDR10.5"], &[]);
    let misses = support::misses(&results.reduction(), &truth);
    assert_eq!(misses.len(), 12, "four coefficients and eight derivatives");
    for miss in &misses {
        assert!(miss.z().abs() < 5.0, "{miss:?}");
    }
    let within = misses.iter().filter(|miss| miss.z().abs() < 2.0).count();
    assert!(within >= 9, "{within} of 12 within two standard errors");
    assert!(results.warnings.is_empty(), "{:?}", results.warnings);
    assert!(results.rejected.is_empty());
}

/// Without noise nothing but the stated physics is left: the coefficients come out to a part in a thousand.
#[test]
fn a_campaign_without_noise_gives_the_truth_itself() {
    let (_folder, results, truth) = support::campaign_with_noise(2, &["LDR8.5"], &[], 0.0);
    for miss in support::misses(&results.reduction(), &truth) {
        let scale = if miss.name.contains("dot") { 2e-5 } else { 1e-3 * miss.truth.abs() };
        assert!((miss.value - miss.truth).abs() < scale, "{miss:?}");
    }
}

/// A zero that drifts is interpolated between the middles of the zero runs: where it drifts steadily, each run has the zero of the
/// middle of its window, to what the files print.
#[test]
fn a_steady_drift_of_the_zeros_is_taken_from_their_middles() {
    let (_folder, results, truth) = support::campaign_with_noise(2, &["LDR8.5"], &[], 0.0);
    let zeros: Vec<(f64, [f64; 3], &str)> = truth
        .runs
        .iter()
        .filter_map(|truth| {
            let run = results.runs.iter().find(|run| run.run.id == truth.id)?;
            Some((run.run.start_time_s?, truth.zero, truth.id.as_str()))
        })
        .collect();
    let mut largest: f64 = 0.0;
    for pair in zeros.windows(2) {
        let [(before_s, before, _), (start_s, zero, id)] = [pair[0], pair[1]];
        let run = results.runs.iter().find(|run| run.run.id == id).unwrap();
        let Some(steps) = run.steps else { continue };
        let middle_s = 0.5 * (run.trace.window_s.0 + run.trace.window_s.1);
        for channel in 0..3 {
            let per_s = (zero[channel] - before[channel]) / (start_s - before_s);
            largest = largest.max((steps.zero[channel] - zero[channel] - middle_s * per_s).abs());
        }
    }
    assert!(largest > 0.0 && largest < 5e-5, "{largest} N or N m");
}

/// The useful window lies within the part that was truly steady, and takes most of it.
#[test]
fn windows_lie_within_the_steady_part() {
    let (_folder, results, truth) = campaign(3, &["LDR9.5"], &[]);
    for run in results.runs.iter().filter(|run| !run.is_zero()) {
        let truth = truth.runs.iter().find(|t| t.id == run.run.id).unwrap();
        let (from, to) = run.trace.window_s;
        assert!(from >= truth.steady_from_s - 0.4, "{}: {from} before {}", truth.id, truth.steady_from_s);
        assert!(to <= truth.steady_to_s + 0.4, "{}: {to} after {}", truth.id, truth.steady_to_s);
        let share = (to - from) / (truth.steady_to_s - truth.steady_from_s);
        assert!(share > 0.45, "{}: {share:.2} of the steady part", truth.id);
    }
}

#[test]
fn a_wrong_sign_is_noticed_and_named() {
    for (name, channel) in [("wrong-sign-sf", "SF"), ("wrong-sign-ym", "YM")] {
        let (_folder, results, _) = campaign(4, &["LDR8.5"], &[effect(name)]);
        let warning = results.warnings.iter().find(|w| w.contains("impossible")).expect("a warning");
        assert!(warning.contains(channel) && warning.contains("opposite sign"), "{warning}");
    }
}

#[test]
fn what_the_model_lacks_is_said() {
    let crossflow = EffectRequest { name: "crossflow".to_owned(), size: Some(5.0) };
    let (_folder, results, _) = campaign(5, &["LDR8.5"], &[crossflow]);
    assert!(results.warnings.iter().any(|w| w.contains("depend") && w.contains("range")), "{:?}", results.warnings);
    assert!(results.warnings.iter().any(|w| w.contains("CL departs from its model")), "{:?}", results.warnings);

    let (_folder, results, _) = campaign(6, &["LDR8.5"], &[effect("reynolds_drag")]);
    assert!(results.warnings.iter().any(|w| w.contains("Reynolds number")), "{:?}", results.warnings);

    let (_folder, results, _) = campaign(7, &["LDR8.5"], &[effect("strut_tare")]);
    assert!(results.warnings.iter().any(|w| w.contains("no tare runs")), "{:?}", results.warnings);
}

/// A single bad run is left out by name; the rest of the campaign stands.
#[test]
fn one_bad_run_never_loses_the_campaign() {
    type Spoil = fn(&str) -> String;
    let spoil: [(&str, Spoil, &str); 13] = [
        ("a renamed column", |text| text.replacen("SF_N", "Fy_N", 1), "column SF_N is missing"),
        ("a lost column", |text| support::without_column(text, 6), "column YM_N_m is missing"),
        ("not a number", |text| support::with_cell(text, 500, 5, "NaN"), ":501:5: AF_N is `NaN`"),
        ("decimal commas", |text| support::with_cell(text, 500, 5, "1,5"), ":501: 8 cells"),
        ("semicolons", |text| text.replace(',', ";").replace('.', ","), "separated by semicolons"),
        ("never steady", support::never_steady, "no steady part"),
        ("a clipped channel", support::clipped, "SF_N stands at"),
        ("radians", support::yaw_in_radians, "looks like radians"),
        ("an empty file", |_| String::new(), "the file is empty"),
        ("Unicode text", |text| text.chars().flat_map(|c| [c, '\0']).collect(), "no plain text"),
        ("a dead channel", |text| support::with_columns(text, |cells| cells[5] = 0.0), "the channel is dead"),
        ("milliseconds", |text| support::with_columns(text, |cells| cells[0] *= 1000.0), "in milliseconds"),
        ("knots", |text| support::with_columns(text, |cells| cells[1] *= 1.9438), "looks like knots"),
    ];
    let spoilt = Spoilt::new(8);
    let whole = reduce(&spoilt.folder);
    for (what, spoil, expected) in spoil {
        let run = run_of(&spoilt.folder, "static", 12.0);
        spoilt.change_run(&run, spoil);
        let results = reduce(&spoilt.folder);
        let [rejected] = results.rejected.as_slice() else { panic!("{what}: {:?}", results.rejected) };
        assert_eq!(rejected.run_id, run, "{what}");
        let message = rejected.error.to_string();
        assert!(message.contains(&format!("{run}.csv")) && message.contains(expected), "{what}: {message}");
        assert!(results.warnings.iter().any(|w| w.contains("left out") && w.contains(&run)), "{what}");
        assert_eq!(results.hulls[0].n_runs, whole.hulls[0].n_runs - 1, "{what}");
        let strict = Options { range_deg: 10.0, strict: true };
        assert!(reduce_campaign(&spoilt.folder, &strict, &|_| ()).is_err(), "{what}");
        spoilt.restore_run(&run);
    }
}

/// Rows of runs.csv that cannot be used are left out with line and column.
#[test]
fn one_bad_row_never_loses_the_campaign() {
    let spoilt = Spoilt::new(9);
    let run = run_of(&spoilt.folder, "static", 12.0);
    let row = |text: &str| text.lines().find(|line| line.starts_with(&run)).unwrap().to_owned();
    let other = run_of(&spoilt.folder, "static", -12.0);
    for (what, from, to, expected) in [
        ("an unknown hull", "LDR8.5,".to_owned(), "LDR85,".to_owned(), "did you mean LDR8.5"),
        ("an unknown kind", ",static,".to_owned(), ",statc,".to_owned(), "did you mean static"),
        ("a duplicate", run.clone() + ",", other.clone() + ",", "stands in line"),
        ("no speed", ",2.0,".to_owned(), ",,".to_owned(), "speed_m_s is 0"),
        ("a decimal comma", ",2.0,".to_owned(), ",2,0,".to_owned(), "14 cells where the header names 13"),
        (
            "a way out",
            format!("data/{run}.csv"),
            "../../../etc/passwd".to_owned(),
            "leads out of the campaign's folder",
        ),
        ("text for a number", ",12.0,".to_owned(), ",twelve,".to_owned(), "yaw_deg is `twelve`"),
    ] {
        spoilt.change_table(|text| text.replace(&row(text), &row(text).replacen(&from, &to, 1)));
        let results = reduce(&spoilt.folder);
        let [rejected] = results.rejected.as_slice() else { panic!("{what}: {:?}", results.rejected) };
        let message = rejected.error.to_string();
        assert!(message.contains("runs.csv:") && message.contains(expected), "{what}: {message}");
        spoilt.restore_table();
    }
    // A missing file is not likened to another run's, and is to one that no run names.
    let data = spoilt.folder.join("data");
    let missing = data.join(format!("{run}.csv"));
    std::fs::rename(&missing, spoilt.folder.join("kept")).unwrap();
    let message = |results: Results| results.rejected[0].error.to_string();
    let none = message(reduce(&spoilt.folder));
    assert!(none.contains(&format!("{run}.csv: the run's file is missing")) && !none.contains("is it that"), "{none}");
    std::fs::rename(spoilt.folder.join("kept"), data.join(format!("{run}b.csv"))).unwrap();
    let one = message(reduce(&spoilt.folder));
    assert!(one.contains(&format!("no run names {run}b.csv")), "{one}");
    std::fs::rename(data.join(format!("{run}b.csv")), &missing).unwrap();
    spoilt.change_table(|text| {
        text.lines()
            .filter(|line| !line.contains(",static,") || line.contains(",4.0,"))
            .fold(String::new(), |all, line| all + line + "\n")
    });
    let few = reduce(&spoilt.folder).hulls[0].fit.as_ref().unwrap_err().to_string();
    assert!(few.contains("at 1 different angles"), "{few}");
    spoilt.change_table(|text| text.replacen("yaw_deg", "yaw_rad", 1));
    let results = reduce_campaign(&spoilt.folder, &Options { range_deg: 10.0, strict: false }, &|_| ());
    let message = results.unwrap_err().to_string();
    assert!(message.contains("yaw_deg"), "{message}");
}

/// What concerns the whole campaign ends it, with file, line and column, and leaves nothing behind.
#[test]
fn a_manifest_that_cannot_be_right_is_refused() {
    let spoilt = Spoilt::new(10);
    for (what, from, to, expected) in [
        ("a misspelt key", "loa_m", "loa", "unknown field `loa`"),
        ("a missing section", "[water]", "[wat]", "unknown field `wat`"),
        ("a wrong kind", "kind = \"fresh\"", "kind = \"brackish\"", "brackish"),
        ("a negative size", "diameter_m = ", "diameter_m = -", "diameter_m is -0.203"),
        ("hull against itself", "ldr = 8.5", "ldr = 12.5", "ldr is 12.5, but loa_m / diameter_m is 8.49"),
        ("a diameter in millimetres", "diameter_m = ", "diameter_m = 203 # ", "diameter_m is 203"),
        ("millimetres", "loa_m = ", "loa_m = 1724 # ", "expected at most 50 m"),
        ("half a live mass", "xg_m", "# xg_m", "one is missing"),
    ] {
        spoilt.change_manifest(|text| text.replacen(from, to, 1));
        let error = reduce_campaign(&spoilt.folder, &Options { range_deg: 10.0, strict: false }, &|_| ());
        let message = error.unwrap_err().to_string();
        assert!(message.contains("campaign.toml:") && message.contains(expected), "{what}: {message}");
        spoilt.restore_manifest();
    }
    spoilt.change_manifest(|text| {
        let line = text.lines().find(|line| line.starts_with("interaction")).unwrap().to_owned();
        text.replace(&line, "interaction = [[1, 0, 0], [0, 1, 2], [0, 2, 4]]")
    });
    let error = reduce_campaign(&spoilt.folder, &Options { range_deg: 10.0, strict: false }, &|_| ());
    let message = error.unwrap_err().to_string();
    assert!(message.contains("campaign.toml:") && message.contains("singular"), "{message}");
    spoilt.restore_manifest();
    fs::write(spoilt.folder.join("campaign.toml"), "").unwrap();
    let error = reduce_campaign(&spoilt.folder, &Options { range_deg: 10.0, strict: false }, &|_| ());
    assert!(error.unwrap_err().to_string().contains("the file is empty"));
}

/// A column more is no harm, and is reported once.
#[test]
fn extra_columns_are_ignored_with_a_notice() {
    let spoilt = Spoilt::new(13);
    let run = run_of(&spoilt.folder, "static", 12.0);
    spoilt.change_run(&run, |text| {
        let mut lines = text.lines();
        let header = lines.next().unwrap().to_owned() + ",wave_m\n";
        lines.fold(header, |all, line| all + line + ",not a number\n")
    });
    let results = reduce(&spoilt.folder);
    assert!(results.rejected.is_empty());
    assert!(
        results.warnings.iter().any(|w| w.contains("column wave_m of 1 runs is not used")),
        "{:?}",
        results.warnings
    );
}

/// Without zero runs each run's own rest is its zero, and the report says so.
#[test]
fn without_zero_runs_the_rest_before_each_run_serves() {
    let spoilt = Spoilt::new(11);
    let with = reduce(&spoilt.folder);
    spoilt.change_table(|text| {
        text.lines().filter(|line| !line.contains(",zero,")).fold(String::new(), |all, l| all + l + "\n")
    });
    let without = reduce(&spoilt.folder);
    assert!(without.warnings.iter().any(|w| w.contains("no zero runs")), "{:?}", without.warnings);
    let a = |results: &glidepolar_tank::Results| results.hulls[0].fit.as_ref().unwrap().estimates.a.clone();
    assert!((a(&with).value - a(&without).value).abs() < 5.0 * a(&without).se);
    assert!(a(&without).se >= 0.8 * a(&with).se);
}

/// The manifest says degrees; a table in radians is noticed at every run.
#[test]
fn radians_in_the_table_are_noticed() {
    let spoilt = Spoilt::new(12);
    let run = run_of(&spoilt.folder, "static", 12.0);
    spoilt.change_table(|text| {
        let row = text.lines().find(|line| line.starts_with(&run)).unwrap().to_owned();
        text.replace(&row, &row.replacen(",12.0,", ",0.20944,", 1))
    });
    let results = reduce(&spoilt.folder);
    let message = results.rejected[0].error.to_string();
    assert!(message.contains("runs.csv looks like radians"), "{message}");
}

/// Where both files hold radians they agree with each other, but no hull lifts so.
#[test]
fn radians_everywhere_are_noticed_by_the_slopes() {
    let spoilt = Spoilt::new(14);
    let table = fs::read_to_string(spoilt.folder.join("runs.csv")).unwrap();
    for line in table.lines().filter(|line| line.contains(",static,") || line.contains(",tare,")) {
        let run = line.split(',').next().unwrap();
        spoilt.change_run(run, support::yaw_in_radians);
    }
    spoilt.change_table(|text| {
        let radians = |line: &str| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            if let Ok(degrees) = cells[4].parse::<f64>() {
                cells[4] = degrees.to_radians().to_string();
            }
            cells.join(",") + "\n"
        };
        text.lines().map(radians).collect()
    });
    let results = reduce(&spoilt.folder);
    assert!(results.warnings.iter().any(|w| w.contains("the angles look like radians")), "{:?}", results.warnings);
}

/// Nothing that is not there is read, and a folder without a campaign says what is expected.
#[test]
fn a_folder_without_a_campaign_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let error = reduce_campaign(folder.path(), &Options { range_deg: 10.0, strict: false }, &|_| ());
    assert!(error.unwrap_err().to_string().contains("campaign.toml"));
    fs::write(folder.path().join("campaign.toml"), "[water]\n").unwrap();
    let error = reduce_campaign(folder.path(), &Options { range_deg: 10.0, strict: false }, &|_| ());
    let message = error.unwrap_err().to_string();
    assert!(message.contains("runs.csv: is missing: the table of the campaign's runs"), "{message}");
    assert!(!Path::new("tank_out").exists());
}
