//! The format, the programme's completeness, determinism and size.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use glidepolar_virtual_tank::{CATALOGUE, Error, Options, SCHEMA, Truth, write_campaign};

use crate::support::{Campaign, requests};

/// A folder's files by relative path.
fn bytes(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for name in ["campaign.toml", "runs.csv", "truth.toml"] {
        files.insert(name.to_owned(), fs::read(folder.join(name)).unwrap());
    }
    for entry in fs::read_dir(folder.join("data")).unwrap() {
        let path = entry.unwrap().path();
        files.insert(path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(&path).unwrap());
    }
    files
}

#[test]
fn a_campaign_is_complete_and_in_the_stated_format() {
    let campaign = Campaign::write(&Options { seed: 3, ..Options::default() });
    let manifest = fs::read_to_string(campaign.folder.join("campaign.toml")).unwrap();
    assert!(manifest.starts_with("# SYNTHETIC") && manifest.contains("name = \"SYNTHETIC"));
    let table: toml::Table = manifest.parse().unwrap();
    assert_eq!(table["hull"].as_array().unwrap().len(), 5);
    for key in ["id", "ldr", "diameter_m", "loa_m", "mc_m", "cb_m", "live_mass_kg", "xg_m", "izz_kg_m2"] {
        assert!(
            table["hull"].as_array().unwrap().iter().all(|hull| hull.as_table().unwrap().contains_key(key)),
            "{key}"
        );
    }
    assert!(campaign.rows.iter().all(|row| row.note.starts_with("synthetic")));
    assert!(campaign.truth.data_bytes < 60_000_000, "{}", campaign.truth.data_bytes);

    // Run order is time order; every day and every hull begins and ends with a zero, and no ten runs go without.
    assert!(campaign.rows.windows(2).all(|pair| pair[0].start_s < pair[1].start_s));
    let session = |i: usize| campaign.rows.get(i).map(|row| ((row.start_s / 86_400.0) as usize, row.hull.clone()));
    let mut since_zero = 0;
    for (i, row) in campaign.rows.iter().enumerate() {
        since_zero = if row.kind == "zero" { 0 } else { since_zero + 1 };
        assert!(since_zero <= 9, "{row:?}");
        let at_an_end = i == 0 || session(i - 1) != session(i) || session(i + 1) != session(i);
        assert!(!at_an_end || row.kind == "zero", "{row:?}");
    }

    for hull in &campaign.truth.hulls {
        let count = |kind: &str| campaign.of_kind(kind).filter(|row| row.hull == hull.id).count();
        assert_eq!([count("static"), count("sway"), count("yaw"), count("arc")], [34, 7, 7, 8]);
        let order: Vec<f64> =
            campaign.of_kind("static").filter(|row| row.hull == hull.id).map(|row| row.yaw_deg.unwrap()).collect();
        assert!(!order.is_sorted(), "random run order");
    }
    for row in campaign.of_kind("static") {
        assert!(
            campaign
                .of_kind("tare")
                .any(|tare| tare.hull.is_empty() && tare.speed == row.speed && tare.yaw_deg == row.yaw_deg)
        );
    }

    for row in &campaign.rows {
        let file = campaign.folder.join(&row.file);
        assert!(fs::read_to_string(&file).unwrap().starts_with("time_s,speed_m_s,yaw_deg,sway_m,AF_N,SF_N,YM_N_m\n"));
        let samples = campaign.samples(row);
        assert!(samples.iter().flatten().all(|value| value.is_finite()));
        let step = if matches!(row.kind.as_str(), "sway" | "yaw") { 0.01 } else { 0.02 };
        assert!(samples.windows(2).all(|pair| (pair[1][0] - pair[0][0] - step).abs() < 1e-9));
        // From rest to rest, at the set speed between, and never through the end of a 90 m tank.
        let run = campaign.run(row);
        assert!(samples[..50].iter().chain(&samples[samples.len() - 50..]).all(|s| s[1].abs() < 0.01));
        let steady = campaign.steady(row);
        let mean = steady.iter().map(|s| s[1]).sum::<f64>() / steady.len() as f64;
        assert!((mean - row.speed).abs() <= 0.006 * row.speed.max(0.1), "{row:?}: {mean}");
        assert!(row.kind == "zero" || run.steady_from_s > 3.0);
        assert!(samples.iter().map(|s| s[1] * step).sum::<f64>() < 80.0);
    }
}

/// One thread or four, the files are the same; another seed, and they are not.
#[test]
fn a_seed_means_the_same_files() {
    let options = |seed| Options {
        seed,
        hulls: vec!["LDR8.5".to_owned()],
        effects: requests("crossflow,zero_drift"),
        ..Options::default()
    };
    let write = |seed, threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        bytes(&pool.install(|| Campaign::write(&options(seed))).folder)
    };
    let first = write(5, 1);
    assert!(first == write(5, 4));
    let other = write(6, 4);
    let mut common = first.iter().filter(|(name, _)| name.starts_with('R') && other.contains_key(*name));
    assert!(common.clone().count() > 90 && common.all(|(name, text)| *text != other[name]));
}

/// The returned truth is the written truth.
#[test]
fn truth_is_written_as_returned() {
    let campaign = Campaign::write(&Options {
        hulls: vec!["LDR8.5".to_owned()],
        effects: requests("speed_scale=1.03"),
        ..Options::default()
    });
    assert_eq!(Truth::read(&campaign.folder).unwrap(), campaign.truth);
    assert_eq!(campaign.truth.schema, SCHEMA);
    assert_eq!((campaign.truth.effects[0].name.as_str(), campaign.truth.effects[0].value), ("speed_scale", 1.03));
    assert_eq!(campaign.truth.runs.len(), campaign.rows.len());
}

/// Setting errors are of their stated size over a campaign, and independent of each other.
#[test]
fn setting_errors_have_their_stated_size() {
    let campaign = Campaign::write(&Options { seed: 8, size_mb: Some(9.0), ..Options::default() });
    let moving: Vec<_> = campaign.truth.runs.iter().filter(|run| run.steady_from_s > 0.0).collect();
    let n = moving.len() as f64;
    let yaw: f64 = moving.iter().map(|run| run.yaw_setting_error_deg.powi(2)).sum::<f64>() / n;
    let speed: f64 = moving.iter().map(|run| (run.speed_setting_ratio - 1.0).powi(2)).sum::<f64>() / n;
    // Four standard errors of a standard deviation from n draws.
    let margin = 4.0 / (2.0 * n).sqrt();
    assert!((yaw.sqrt() / 0.02 - 1.0).abs() < margin, "{}", yaw.sqrt());
    assert!((speed.sqrt() / 0.001 - 1.0).abs() < margin, "{}", speed.sqrt());
}

#[test]
fn a_campaign_has_the_size_asked_for() {
    let write = |size_mb| {
        Campaign::write(&Options { hulls: vec!["LDR8.5".to_owned()], size_mb: Some(size_mb), ..Options::default() })
    };
    for size_mb in [4.0, 14.0, 60.0] {
        let campaign = write(size_mb);
        let on_disk: usize =
            bytes(&campaign.folder).iter().filter(|(name, _)| name.starts_with('R')).map(|(_, text)| text.len()).sum();
        assert_eq!(on_disk as u64, campaign.truth.data_bytes);
        assert!((on_disk as f64 / 1e6 / size_mb - 1.0).abs() < 0.08, "{on_disk} bytes for {size_mb} MB");
    }
    let place = tempfile::tempdir().unwrap();
    for size_mb in [0.01, f64::NAN, -3.0, 1e9] {
        let options = Options { size_mb: Some(size_mb), ..Options::default() };
        assert!(matches!(write_campaign(&place.path().join("new"), &options), Err(Error::Size { .. })), "{size_mb}");
    }
    assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0);
}

/// The virtual tank is worth something as a test only while it shares nothing with what it tests.
#[test]
fn nothing_is_shared_with_the_reduction() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for entry in fs::read_dir(source).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        for forbidden in ["glidepolar_", "glidepolar::"] {
            assert!(!text.contains(forbidden), "{} contains {forbidden}", path.display());
        }
    }
}

/// Every effect stands in the documentation, with its parameter.
#[test]
fn documentation_names_every_effect() {
    let page =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/virtual-tank.md")).unwrap();
    for entry in CATALOGUE {
        assert!(page.contains(&format!("`{}`", entry.name)), "{}", entry.name);
        assert!(page.contains(entry.parameter), "{}", entry.parameter);
    }
}
