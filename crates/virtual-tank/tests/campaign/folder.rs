//! Where a campaign may be written, and what happens when it may not.

use std::fs;
use std::path::Path;

use glidepolar_virtual_tank::{EffectRequest, Error, Options, write_campaign};

fn small() -> Options {
    Options { hulls: vec!["LDR8.5".to_owned()], size_mb: Some(3.0), ..Options::default() }
}

fn entries(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn somebody_elses_folder_stays_as_it_is() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("measured");
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("runs.csv"), "precious").unwrap();
    let error = write_campaign(&folder, &small()).unwrap_err();
    assert!(matches!(error, Error::FolderInUse { .. }), "{error}");
    assert!(error.to_string().contains("runs.csv"), "{error}");
    assert_eq!(fs::read_to_string(folder.join("runs.csv")).unwrap(), "precious");
    assert_eq!((entries(place.path()), entries(&folder)), (vec!["measured".to_owned()], vec!["runs.csv".to_owned()]));

    let file = place.path().join("file");
    fs::write(&file, "precious").unwrap();
    assert!(matches!(write_campaign(&file, &small()), Err(Error::FolderInUse { .. })));
    assert_eq!(fs::read_to_string(&file).unwrap(), "precious");
}

#[test]
fn an_earlier_campaign_is_replaced_whole() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("deep/er/pmm_runs");
    let first = write_campaign(&folder, &small()).unwrap();
    let untared = Options { effects: vec![EffectRequest { name: "strut_tare".to_owned(), size: None }], ..small() };
    let second = write_campaign(&folder, &untared).unwrap();
    assert!(second.runs.len() < first.runs.len());
    assert_eq!(entries(&folder.join("data")).len(), second.runs.len(), "nothing of the first is left");
    assert_eq!(entries(folder.parent().unwrap()), ["pmm_runs"]);
    // An empty folder is as good as none.
    let empty = place.path().join("empty");
    fs::create_dir(&empty).unwrap();
    write_campaign(&empty, &small()).unwrap();
    assert_eq!(entries(&empty), ["campaign.toml", "data", "runs.csv", "truth.toml"]);
}

#[test]
fn an_edited_campaign_is_replaced_on_demand_only() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("pmm_runs");
    write_campaign(&folder, &small()).unwrap();
    let file = folder.join("runs.csv");
    let edited = fs::read_to_string(&file).unwrap().replacen("synthetic", "repeat this one", 1);
    fs::write(&file, &edited).unwrap();
    let error = write_campaign(&folder, &small()).unwrap_err();
    assert!(error.to_string().contains("edited") && error.to_string().contains("--force"), "{error}");
    assert_eq!(fs::read_to_string(&file).unwrap(), edited);
    write_campaign(&folder, &Options { force: true, ..small() }).unwrap();
    assert_ne!(fs::read_to_string(&file).unwrap(), edited);
}

#[test]
fn a_campaign_with_a_users_own_files_in_it_is_not_replaced() {
    let place = tempfile::tempdir().unwrap();
    for own in ["notes.txt", "data/mine.csv"] {
        let folder = place.path().join(own.replace('/', "_"));
        write_campaign(&folder, &small()).unwrap();
        fs::write(folder.join(own), "mine").unwrap();
        let error = write_campaign(&folder, &small()).unwrap_err();
        assert!(error.to_string().contains(own), "{error}");
        assert_eq!(fs::read_to_string(folder.join(own)).unwrap(), "mine");
    }
}

#[test]
fn impossible_wishes_are_refused_by_name_and_leave_nothing() {
    let place = tempfile::tempdir().unwrap();
    let refuse = |options: Options, words: &[&str]| {
        let message = write_campaign(&place.path().join("new"), &options).unwrap_err().to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    let effects = |text: &str| Options { effects: EffectRequest::parse_list(text).unwrap(), ..small() };
    refuse(effects("crosflow"), &["crosflow", "did you mean crossflow", "yaw_misalignment"]);
    refuse(effects("crossflow,crossflow=3"), &["crossflow", "twice"]);
    refuse(effects("speed_scale=100"), &["speed_scale", "100", "0.5 to 2"]);
    refuse(effects("speed_scale=NaN"), &["speed_scale", "NaN"]);
    refuse(Options { hulls: vec!["LDR9".to_owned()], ..small() }, &["LDR9", "LDR9.5"]);
    refuse(Options { noise: f64::NAN, ..small() }, &["noise", "NaN"]);
    assert!(EffectRequest::parse_list("crossflow=big").unwrap_err().to_string().contains("big"));
    assert!(entries(place.path()).is_empty());
}
