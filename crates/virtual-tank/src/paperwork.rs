//! The campaign's paperwork: `campaign.toml`, `runs.csv` and `truth.toml`, each marked as synthetic.

use std::fs;
use std::path::Path;

use serde::Serialize;

use super::balance::Balance;
use super::hull::Hull;
use super::motion::Kind;
use super::outline::{DIAMETER_M, PHOENIX};
use super::planned_run::PlannedRun;
use super::truth::Truth;
use super::{Error, io_error};

/// Name of the run made `number`-th, from 0.
pub(super) fn run_id(number: usize) -> String {
    format!("R{:05}", number + 1)
}

/// `truth.toml`.
pub(super) fn write_truth(folder: &Path, truth: &Truth) -> Result<(), Error> {
    write_toml(folder, "truth.toml", TRUTH_NOTE, truth)
}

/// `campaign.toml`.
pub(super) fn write_manifest(
    folder: &Path,
    seed: u64,
    hulls: &[&Hull],
    balance: &Balance,
    runs: &[PlannedRun],
) -> Result<(), Error> {
    write_toml(folder, "campaign.toml", "", &manifest(seed, hulls, balance, runs))
}

/// `runs.csv`.
pub(super) fn write_runs_table(folder: &Path, runs: &[PlannedRun]) -> Result<(), Error> {
    let file = folder.join("runs.csv");
    let fail = |source: csv::Error| io_error(&file, "write", source.into());
    let mut writer = csv::Writer::from_path(&file).map_err(fail)?;
    for (number, run) in runs.iter().enumerate() {
        writer.serialize(RunRow::new(number, run)).map_err(fail)?;
    }
    writer.flush().map_err(|source| io_error(&file, "write", source))
}

const BANNER: &str = "# SYNTHETIC. Written by the virtual tank of tank-reduce; nothing here was measured.\n";

const TRUTH_NOTE: &str = "# What is true; for tests and for people. The reduction never reads this file.\n";

/// `campaign.toml`.
#[derive(Serialize)]
struct Manifest {
    campaign: CampaignSection,
    water: WaterSection,
    tank: TankSection,
    balance: BalanceSection,
    hull: Vec<HullSection>,
}

#[derive(Serialize)]
struct CampaignSection {
    name: String,
    facility: &'static str,
}

#[derive(Serialize)]
struct WaterSection {
    kind: &'static str,
    temperature_c: f64,
}

#[derive(Serialize)]
struct TankSection {
    width_m: f64,
    depth_m: f64,
}

#[derive(Serialize)]
struct BalanceSection {
    interaction: [[f64; 3]; 3],
}

#[derive(Serialize)]
struct HullSection {
    id: &'static str,
    ldr: f64,
    diameter_m: f64,
    loa_m: f64,
    mc_m: f64,
    cb_m: f64,
    live_mass_kg: f64,
    xg_m: f64,
    izz_kg_m2: f64,
}

fn manifest(seed: u64, hulls: &[&Hull], balance: &Balance, runs: &[PlannedRun]) -> Manifest {
    let mean_temperature = runs.iter().map(|run| run.recorded_temperature_c).sum::<f64>() / runs.len() as f64;
    Manifest {
        campaign: CampaignSection {
            name: format!("SYNTHETIC: Phoenix hulls, seed {seed}"),
            facility: "virtual tank (synthetic, nothing measured)",
        },
        water: WaterSection { kind: "fresh", temperature_c: (mean_temperature * 10.0).round() / 10.0 },
        tank: TankSection { width_m: 12.0, depth_m: 3.0 },
        balance: BalanceSection { interaction: balance.interaction },
        hull: hulls.iter().map(|hull| hull_section(hull)).collect(),
    }
}

fn hull_section(hull: &Hull) -> HullSection {
    HullSection {
        id: hull.row.id,
        ldr: hull.row.ldr,
        diameter_m: DIAMETER_M,
        loa_m: hull.row.loa_m,
        mc_m: hull.row.mc_m,
        cb_m: hull.row.cb_m,
        live_mass_kg: hull.live.live_mass_kg,
        xg_m: hull.live.xg_m,
        izz_kg_m2: hull.live.izz_kg_m2,
    }
}

/// A row of `runs.csv`; cells that do not apply are empty.
#[derive(Serialize)]
struct RunRow {
    run_id: String,
    hull: &'static str,
    kind: &'static str,
    speed_m_s: f64,
    yaw_deg: Option<f64>,
    sway_amplitude_m: Option<f64>,
    yaw_amplitude_deg: Option<f64>,
    frequency_hz: Option<f64>,
    radius_m: Option<f64>,
    water_temperature_c: f64,
    file: String,
    note: String,
    start_time_s: f64,
}

impl RunRow {
    fn new(number: usize, run: &PlannedRun) -> Self {
        let command = &run.command;
        let kind = command.kind;
        let oscillates = matches!(kind, Kind::Sway | Kind::Yaw);
        let note = if run.note.is_empty() { "synthetic".to_owned() } else { format!("synthetic; {}", run.note) };
        Self {
            run_id: run_id(number),
            hull: run.hull.map_or("", |index| PHOENIX[index].id),
            kind: kind.name(),
            speed_m_s: command.speed_m_s,
            yaw_deg: matches!(kind, Kind::Static | Kind::Tare).then_some(command.yaw_deg),
            sway_amplitude_m: oscillates.then_some(command.sway_amplitude_m),
            yaw_amplitude_deg: (kind == Kind::Yaw).then(|| (command.yaw_amplitude_deg() * 1e4).round() / 1e4),
            frequency_hz: oscillates.then_some(command.frequency_hz),
            radius_m: (kind == Kind::Arc).then_some(command.radius_m),
            water_temperature_c: run.recorded_temperature_c,
            file: format!("data/{}.csv", run_id(number)),
            note,
            start_time_s: run.start_time_s().round(),
        }
    }
}

fn write_toml(folder: &Path, name: &str, note: &str, content: &impl Serialize) -> Result<(), Error> {
    let file = folder.join(name);
    let body = toml::to_string(content).map_err(|source| io_error(&file, "write", std::io::Error::other(source)))?;
    fs::write(&file, format!("{BANNER}{note}\n{body}")).map_err(|source| io_error(&file, "write", source))
}
