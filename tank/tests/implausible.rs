//! Readings and runs that cannot be right though every cell is a number: reported by name, and kept from doing harm where that
//! is safe.

mod support;

use glidepolar_tank::Results;
use support::{Spoilt, reduce, run_of, with_cell, with_columns};

fn warned(results: &Results, words: &[&str]) -> bool {
    results.warnings.iter().any(|warning| words.iter().all(|word| warning.contains(word)))
}

#[test]
fn one_spike_is_left_out_and_reported() {
    let spoilt = Spoilt::new(12);
    let whole = reduce(&spoilt.folder);
    assert!(!warned(&whole, &["spike"]) && !warned(&whole, &["lead to expect"]), "{:?}", whole.warnings);
    let run = run_of(&spoilt.folder, "static", 8.0);
    // In the middle of the window; columns are time, speed, yaw, sway, AF, SF, YM.
    spoilt.change_run(&run, |text| with_cell(text, text.lines().count() / 2, 7, "500"));
    let results = reduce(&spoilt.folder);
    assert!(warned(&results, &[&run, "YM_N_m is 500 at", "spike"]), "{:?}", results.warnings);
    let d = |results: &Results| results.hulls[0].fit.as_ref().unwrap().estimates.d.clone();
    assert!((d(&results).value - d(&whole).value).abs() < 0.05 * d(&whole).se, "{:?}", d(&results));

    spoilt.restore_run(&run);
    spoilt.change_run(&run, |text| with_cell(text, text.lines().count() / 2, 7, "1e300"));
    let results = reduce(&spoilt.folder);
    assert!(warned(&results, &[&run, "left out", "YM_N_m is 1e300"]), "{:?}", results.warnings);
    assert!(d(&results).ci95.iter().all(|end| end.is_finite()));
}

#[test]
fn a_run_in_other_units_is_named() {
    let spoilt = Spoilt::new(13);
    let run = run_of(&spoilt.folder, "static", 4.0);
    spoilt.change_run(&run, |text| {
        with_columns(text, |cells| {
            cells[4] *= 1000.0;
            cells[5] *= 1000.0;
        })
    });
    let results = reduce(&spoilt.folder);
    for coefficient in ["CL", "CD"] {
        assert!(warned(&results, &[&run, coefficient, "lead to expect"]), "{:?}", results.warnings);
    }
}

#[test]
fn two_runs_of_one_file_are_no_repeats() {
    let spoilt = Spoilt::new(14);
    let (one, other) = (run_of(&spoilt.folder, "static", 4.0), run_of(&spoilt.folder, "static", 6.0));
    spoilt.change_table(|text| text.replace(&format!("data/{other}.csv"), &format!("data/{one}.csv")));
    assert!(warned(&reduce(&spoilt.folder), &[&one, &other, "the same file"]));
}

/// Every force in kgf, or far too large: the sweep is as smooth as before.
#[test]
fn a_campaign_in_other_units_is_named() {
    assert!(!warned(&reduce(&Spoilt::new(15).folder), &["impossible"]));
    for (factor, words) in [(1.0 / 9.81, ["laminar", "newtons"]), (25.0, ["disk", "newtons"])] {
        let spoilt = Spoilt::new(15);
        for file in std::fs::read_dir(spoilt.folder.join("data")).unwrap() {
            let path = file.unwrap().path();
            let text = std::fs::read_to_string(&path).unwrap();
            let scaled = with_columns(&text, |cells| (4..7).for_each(|i| cells[i] *= factor));
            std::fs::write(&path, scaled).unwrap();
        }
        let results = reduce(&spoilt.folder);
        assert!(warned(&results, &words), "{:?}", results.warnings);
    }
}
