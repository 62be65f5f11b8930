//! Campaigns of the virtual tank: made, reduced, held against their truth, spoilt.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::fs;
use std::path::{Path, PathBuf};

use glidepolar_hull::hull_tests::{Estimate, Reduction};
use glidepolar_tank::virtual_tank::{self, EffectRequest, Truth};
use glidepolar_tank::{Options, Results, reduce_campaign};
use tempfile::TempDir;

/// One figure against its truth.
#[derive(Debug, Clone)]
pub struct Miss {
    pub name: String,
    pub value: f64,
    pub se: f64,
    pub covered: bool,
    pub truth: f64,
}

impl Miss {
    pub fn new(name: &str, q: &Estimate, truth: f64) -> Self {
        let covered = (q.ci95[0]..=q.ci95[1]).contains(&truth);
        Miss { name: name.to_owned(), value: q.value, se: q.se, covered, truth }
    }

    pub fn z(&self) -> f64 {
        (self.value - self.truth) / self.se
    }
}

pub fn effect(name: &str) -> EffectRequest {
    EffectRequest { name: name.to_owned(), size: None }
}

pub fn campaign(seed: u64, hulls: &[&str], effects: &[EffectRequest]) -> (TempDir, Results, Truth) {
    campaign_with_noise(seed, hulls, effects, 1.0)
}

pub fn campaign_with_noise(
    seed: u64,
    hulls: &[&str],
    effects: &[EffectRequest],
    noise: f64,
) -> (TempDir, Results, Truth) {
    let folder = tempfile::tempdir().unwrap();
    let options = virtual_tank::Options {
        statics_only: false,
        seed,
        effects: effects.to_vec(),
        hulls: hulls.iter().map(|id| (*id).to_owned()).collect(),
        noise,
        size_mb: None,
        variety: virtual_tank::Variety::Phoenix,
        force: false,
    };
    let truth = virtual_tank::write_campaign(&folder.path().join("runs"), &options).unwrap();
    let results = reduce(&folder.path().join("runs"));
    (folder, results, truth)
}

pub fn reduce(folder: &Path) -> Results {
    reduce_campaign(folder, &Options { range_deg: 10.0, strict: false }, &|_| ()).unwrap()
}

/// Every coefficient and derivative of every hull against the truth.
pub fn misses(reduction: &Reduction, truth: &Truth) -> Vec<Miss> {
    let mut misses = Vec::new();
    for (hull, truth) in reduction.hulls.iter().zip(&truth.hulls) {
        assert_eq!(hull.id, truth.id);
        let mut add = |name: &str, q: &Estimate, truth: f64| {
            misses.push(Miss::new(name, q, truth));
        };
        let (fit, t) = (hull.fit.as_ref().unwrap(), truth.coefficients);
        add("a", &fit.a, t.a);
        add("b", &fit.b, t.b);
        add("c", &fit.c, t.c);
        add("d", &fit.d, t.d);
        let (d, t) = (hull.dynamic.as_ref().unwrap(), truth.dynamic);
        add("Yv", &d.yv, t.yv);
        add("Nv", &d.nv, t.nv);
        add("Yr", d.yr.as_ref().unwrap(), t.yr);
        add("Nr", d.nr.as_ref().unwrap(), t.nr);
        add("Yvdot", d.yvdot.as_ref().unwrap(), t.yvdot);
        add("Nvdot", d.nvdot.as_ref().unwrap(), t.nvdot);
        add("Yrdot", d.yrdot.as_ref().unwrap(), t.yrdot);
        add("Nrdot", d.nrdot.as_ref().unwrap(), t.nrdot);
    }
    misses
}

/// The slopes at zero drift that the steady sweep alone gives, against the truth.
pub fn sweep_misses(results: &Results, truth: &Truth) -> Vec<Miss> {
    let mut misses = Vec::new();
    for (hull, truth) in results.hulls.iter().zip(&truth.hulls) {
        let slopes = glidepolar_tank::derivatives::from_sweep(&hull.hull, hull.fit.as_ref().unwrap());
        let truths = [("Yv, sweep", truth.dynamic.yv), ("Nv, sweep", truth.dynamic.nv)];
        misses.extend(slopes.iter().zip(truths).map(|(q, (name, truth))| Miss::new(name, q, truth)));
    }
    misses
}

/// A campaign of one hull to be spoilt, and put right again.
pub struct Spoilt {
    _holder: TempDir,
    pub folder: PathBuf,
    manifest: String,
    table: String,
    kept: std::cell::RefCell<String>,
}

impl Spoilt {
    pub fn new(seed: u64) -> Self {
        let (holder, _, _) = campaign(seed, &["LDR8.5"], &[]);
        let folder = holder.path().join("runs");
        let manifest = fs::read_to_string(folder.join("campaign.toml")).unwrap();
        let table = fs::read_to_string(folder.join("runs.csv")).unwrap();
        Spoilt { _holder: holder, folder, manifest, table, kept: String::new().into() }
    }

    pub fn change_run(&self, run: &str, spoil: fn(&str) -> String) {
        let file = self.folder.join(format!("data/{run}.csv"));
        let text = fs::read_to_string(&file).unwrap();
        fs::write(&file, spoil(&text)).unwrap();
        *self.kept.borrow_mut() = text;
    }

    pub fn restore_run(&self, run: &str) {
        fs::write(self.folder.join(format!("data/{run}.csv")), self.kept.borrow().as_str()).unwrap();
    }

    pub fn change_table(&self, spoil: impl Fn(&str) -> String) {
        let spoilt = spoil(&self.table);
        assert_ne!(spoilt, self.table, "nothing was spoilt");
        fs::write(self.folder.join("runs.csv"), spoilt).unwrap();
    }

    pub fn restore_table(&self) {
        fs::write(self.folder.join("runs.csv"), &self.table).unwrap();
    }

    pub fn change_manifest(&self, spoil: impl Fn(&str) -> String) {
        let spoilt = spoil(&self.manifest);
        assert_ne!(spoilt, self.manifest, "nothing was spoilt");
        fs::write(self.folder.join("campaign.toml"), spoilt).unwrap();
    }

    pub fn restore_manifest(&self) {
        fs::write(self.folder.join("campaign.toml"), &self.manifest).unwrap();
    }
}

/// The first run of a kind at 2 m/s and an angle.
pub fn run_of(folder: &Path, kind: &str, yaw_deg: f64) -> String {
    let table = fs::read_to_string(folder.join("runs.csv")).unwrap();
    let row = table.lines().find(|line| line.contains(&format!(",LDR8.5,{kind},2.0,{yaw_deg:?},"))).unwrap();
    row.split(',').next().unwrap().to_owned()
}

/// Replaces a cell; row and column count from 1, the header being row 0.
pub fn with_cell(text: &str, row: usize, column: usize, cell: &str) -> String {
    let change = |(i, line): (usize, &str)| {
        if i != row {
            return line.to_owned();
        }
        let mut cells: Vec<&str> = line.split(',').collect();
        cells[column - 1] = cell;
        cells.join(",")
    };
    text.lines().enumerate().map(change).collect::<Vec<_>>().join("\n") + "\n"
}

pub fn without_column(text: &str, column: usize) -> String {
    let drop = |line: &str| {
        let cells: Vec<&str> = line.split(',').enumerate().filter(|(i, _)| *i != column).map(|(_, c)| c).collect();
        cells.join(",") + "\n"
    };
    text.lines().map(drop).collect()
}

pub fn with_columns(text: &str, change: impl Fn(&mut [f64])) -> String {
    let mut lines = text.lines();
    let mut out = lines.next().unwrap().to_owned() + "\n";
    for line in lines {
        let mut cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        change(&mut cells);
        out += &cells.iter().map(|x| format!("{x:.5}")).collect::<Vec<_>>().join(",");
        out.push('\n');
    }
    out
}

/// The carriage never stops accelerating or braking.
pub fn never_steady(text: &str) -> String {
    with_columns(text, |cells| cells[1] *= 1.0 + 0.3 * (0.7 * cells[0]).sin())
}

/// The highest 1.5 N of the side force are cut off.
pub fn clipped(text: &str) -> String {
    let mut highest = f64::NEG_INFINITY;
    for line in text.lines().skip(1) {
        highest = highest.max(line.split(',').nth(5).unwrap().parse().unwrap());
    }
    with_columns(text, move |cells| cells[5] = cells[5].min(highest - 1.5))
}

pub fn yaw_in_radians(text: &str) -> String {
    with_columns(text, |cells| cells[2] = cells[2].to_radians())
}
