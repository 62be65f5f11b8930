//! Hull tests: a campaign's folder, a table of points, and the reduction that is handed on.

use glidepolar::hull_tests::Reduction;
use glidepolar_tank::virtual_tank::{self, write_campaign};
use glidepolar_tank::{Options, reduce_campaign, reduce_points};

use super::glidepolar;
use crate::Target;

use crate::files::{Folder, joined, thinned};

pub const CAMPAIGN: Target = Target {
    name: "campaign",
    what: "a campaign: campaign.toml, runs.csv, histories of runs",
    run: campaign,
    seeds: campaigns,
    catches_panics: false,
};

pub const POINTS: Target = Target {
    name: "points",
    what: "a table of points with its hull",
    run: points,
    seeds: tables,
    catches_panics: false,
};

pub const REDUCTION: Target = Target {
    name: "reduction",
    what: "a fits.json, and a vehicle assembled from it",
    run: reduction,
    seeds: reductions,
    catches_panics: false,
};

/// Histories in one input.
const HISTORIES: [&str; 10] = ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9"];

fn campaign(data: &[u8]) {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("data")).expect("a folder in a fresh folder");
    let histories = HISTORIES.map(|id| format!("data/{id}.csv"));
    let names: Vec<&str> =
        ["campaign.toml", "runs.csv"].into_iter().chain(histories.iter().map(String::as_str)).collect();
    folder.write_parts(data, &names);
    let options = Options { range_deg: 10.0, strict: false };
    match reduce_campaign(folder.root(), &options, &|_| ()) {
        Err(error) => drop(error.to_string()),
        Ok(results) => drop(results.reduction()),
    }
}

fn points(data: &[u8]) {
    let folder = Folder::new();
    folder.write_parts(data, &["points.csv", "hull.toml"]);
    match reduce_points(&folder.path("points.csv"), &folder.path("hull.toml"), 10.0) {
        Err(error) => drop(error.to_string()),
        Ok(results) => drop(results.reduction()),
    }
}

fn reduction(data: &[u8]) {
    let folder = Folder::new();
    let path = folder.write("fits.json", data);
    let Ok(reduction) = Reduction::load(&path) else { return };
    let Some(hull) = reduction.hulls.first().filter(|hull| !hull.id.is_empty()) else { return };
    let wing = "span_m=1.01,chord_m=0.12,sweep_deg=43,aft_m=0.95";
    let fin = "span_m=0.25,chord_m=0.12,sweep_deg=30,aft_m=1.75";
    let hull = format!("--hull={}", hull.id);
    glidepolar(folder.root(), &["assemble", &path.to_string_lossy(), &hull, "--wing", wing, "--fin", fin]);
}

/// One small campaign of the virtual tank: a run of every kind, its history thinned out.
fn campaigns() -> Vec<Vec<u8>> {
    const ROWS_OF_A_HISTORY: usize = 60;
    let folder = Folder::new();
    let place = folder.path("runs");
    write_campaign(&place, &virtual_tank::Options { hulls: vec!["LDR8.5".to_owned()], ..Default::default() })
        .expect("room for a temporary folder");
    let read = |name: &str| std::fs::read_to_string(place.join(name)).expect("it was just written");
    let table = read("runs.csv");
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let header = lines.next().unwrap_or_default();
    let runs: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    // Of each kind a few, apart in angle.
    let of_kind = |kind: &'static str, most: usize| {
        let all: Vec<&Vec<&str>> = runs.iter().filter(|run| run.get(2) == Some(&kind)).collect();
        let step = (all.len() / most).max(1);
        all.into_iter().step_by(step).take(most)
    };
    let chosen = of_kind("zero", 2)
        .chain(of_kind("tare", 2))
        .chain(of_kind("static", 4))
        .chain(of_kind("sway", 1))
        .chain(of_kind("arc", 1));
    let (mut rows, mut histories) = (vec![header.to_owned()], Vec::new());
    for (id, run) in HISTORIES.iter().zip(chosen) {
        let mut cells: Vec<&str> = run.clone();
        let history = read(&format!("data/{}.csv", cells[0]));
        histories.push(thinned(&history, history.lines().count() / ROWS_OF_A_HISTORY));
        cells[0] = *id;
        if let Some(file) = cells.iter_mut().find(|cell| cell.starts_with("data/")) {
            *file = "";
        }
        rows.push(cells.join(","));
    }
    let files: Vec<String> = [read("campaign.toml"), rows.join("\n") + "\n"].into_iter().chain(histories).collect();
    vec![joined(&files), joined(&files[..6])]
}

fn tables() -> Vec<Vec<u8>> {
    let hull = include_str!("../../../../tank/data/suboff.toml");
    let coefficients = "yaw_deg,CL,CD,CM,CL_se,speed_m_s,water_temperature_c\n-8,-0.3,0.2,-0.1,0.01,1,15\n-4,-0.12,0.15,-0.05,0.01,1,15\n\
        0,0.01,0.13,0,0.01,1,15\n4,0.13,0.15,0.05,0.01,1,15\n8,0.31,0.2,0.1,0.01,1,15\n";
    let forces = "yaw_deg,AF_N,SF_N,YM_N_m,speed_m_s\n-6,-1,3,0.5,1\n0,-0.8,0,0,1\n6,-1,-3,-0.5,1\n";
    vec![
        joined(&[include_str!("../../../../tank/data/suboff_roddy1990.csv"), hull]),
        joined(&[coefficients, hull]),
        joined(&[forces, hull]),
    ]
}

fn reductions() -> Vec<Vec<u8>> {
    let folder = Folder::new();
    let reduced = |seed: Vec<u8>| {
        folder.write_parts(&seed, &["points.csv", "hull.toml"]);
        let results = reduce_points(&folder.path("points.csv"), &folder.path("hull.toml"), 10.0).ok()?;
        serde_json::to_vec_pretty(&results.reduction()).ok()
    };
    tables().into_iter().filter_map(reduced).collect()
}
