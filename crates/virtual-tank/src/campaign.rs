//! A campaign from the first decision to the finished folder: draw, plan, run every run, write the paperwork.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use rayon::prelude::*;

use super::balance::Balance;
use super::digest::Digest;
use super::folder::NewFolder;
use super::hull::{Hull, draw_hulls};
use super::motion::Kind;
use super::outline::PHOENIX;
use super::paperwork::{self, run_id};
use super::planned_run::PlannedRun;
use super::programme::{Wishes, plan};
use super::random::{Purpose, Stream};
use super::request;
use super::simulate::Tank;
use super::truth::{BalanceTruth, HullTruth, RunTruth, SCHEMA, Trend, Truth};
use super::world::World;
use super::{Error, Options, Progress, io_error};

/// Bytes of one row, on average.
const BYTES_PER_ROW: f64 = 55.0;
/// A campaign may be sampled this much more coarsely than a default one.
const COARSEST: f64 = 0.2;

/// Writes a campaign to the folder `place`, whole or not at all, and returns its truth (also written as `truth.toml`).
///
/// # Errors
/// For options that make no sense, for a folder that holds anything but an earlier virtual campaign, and when the disk
/// refuses; nothing is left half-written.
pub fn write_campaign(place: &Path, options: &Options) -> Result<Truth, Error> {
    write_campaign_watched(place, options, &|_| ())
}

/// [`write_campaign`], telling `watch` after every run; `watch` is called from several threads.
///
/// # Errors
/// As [`write_campaign`].
pub fn write_campaign_watched(
    place: &Path,
    options: &Options,
    watch: &(dyn Fn(Progress) + Sync),
) -> Result<Truth, Error> {
    if !(0.0..=100.0).contains(&options.noise) {
        return Err(Error::Noise { found: options.noise });
    }
    let world = World::new(options.variety, options.seed, options.noise);
    let chosen = choose_hulls(&options.hulls, &world)?;
    let (hidden, stated) = request::hide(&options.effects, options.seed)?;
    let levels = world.levels;
    let hulls = draw_hulls(&mut Stream::new(options.seed, Purpose::Hulls));
    let runs_of = |passes| {
        let wishes = Wishes { hulls: &chosen, passes, statics_only: options.statics_only };
        plan(wishes, &world, &hidden, &mut Stream::new(options.seed, Purpose::Programme))
    };
    let (runs, refinement) = size(options.size_mb, world.rates_hz, runs_of)?;
    let days = runs.last().map_or(1, |run| run.day + 1);
    let mut balance = Balance::draw(&mut Stream::new(options.seed, Purpose::Balance), days, &hidden, world.zero_drift);
    balance.walk(world.zero_walk, &mut Stream::new(options.seed, Purpose::Walk));
    let tank = Tank {
        hulls: &hulls,
        balance: &balance,
        levels: &levels,
        hidden: &hidden,
        intervals_s: (interval(world.rates_hz.0 * refinement), interval(world.rates_hz.1 * refinement)),
    };

    let folder = NewFolder::begin(place, options.force)?;
    let (data_bytes, digest) = write_runs(&tank, &runs, options.seed, folder.path(), watch)?;
    let hulls: Vec<&Hull> = chosen.iter().map(|&index| &hulls[index]).collect();
    paperwork::write_manifest(folder.path(), options.seed, &hulls, &balance, &runs)?;
    paperwork::write_runs_table(folder.path(), &runs)?;
    let digest = digest.plus(Digest::of_paperwork(folder.path())?);
    let truth = Truth {
        schema: SCHEMA.to_owned(),
        synthetic: true,
        seed: options.seed,
        noise: options.noise,
        data_bytes,
        digest: digest.to_string(),
        trend: trend(&tank.hulls[0], &tank.hulls[PHOENIX.len() - 1]),
        noise_levels: levels,
        effects: stated,
        balance: BalanceTruth { interaction: balance.interaction, strut: balance.strut, days: balance.days.clone() },
        hulls: hulls.iter().map(|hull| hull_truth(hull)).collect(),
        runs: runs.iter().enumerate().map(|(number, run)| run_truth(number, run, &tank)).collect(),
    };
    paperwork::write_truth(folder.path(), &truth)?;
    folder.finish()?;
    Ok(truth)
}

fn choose_hulls(ids: &[String], world: &World) -> Result<Vec<usize>, Error> {
    if ids.is_empty() {
        return Ok(world.hulls.clone());
    }
    let mut chosen = Vec::new();
    for id in ids {
        let index = PHOENIX
            .iter()
            .position(|row| row.id == id)
            .ok_or_else(|| Error::UnknownHull { id: id.clone(), known: PHOENIX.map(|row| row.id).join(", ") })?;
        if !chosen.contains(&index) {
            chosen.push(index);
        }
    }
    Ok(chosen)
}

/// Plans as many passes, and finds how much finer to sample, as bring the campaign to its size.
fn size(
    size_mb: Option<f64>,
    rates_hz: (f64, f64),
    plan: impl Fn(usize) -> Vec<PlannedRun>,
) -> Result<(Vec<PlannedRun>, f64), Error> {
    let runs = plan(1);
    let Some(size_mb) = size_mb else {
        return Ok((runs, 1.0));
    };
    let once_mb = expected_mb(&runs, rates_hz);
    let passes = (size_mb / once_mb).round().max(1.0);
    if !(COARSEST * once_mb..=1e5).contains(&size_mb) {
        return Err(Error::Size { found_mb: size_mb, least_mb: COARSEST * once_mb });
    }
    let runs = if passes > 1.0 { plan(passes as usize) } else { runs };
    let refinement = size_mb / expected_mb(&runs, rates_hz);
    Ok((runs, refinement))
}

/// Size of the runs' files in a campaign sampled at the usual rates.
fn expected_mb(runs: &[PlannedRun], rates_hz: (f64, f64)) -> f64 {
    let rows = |run: &PlannedRun| {
        let oscillates = matches!(run.command.kind, Kind::Sway | Kind::Yaw);
        run.command.times().end * if oscillates { rates_hz.1 } else { rates_hz.0 }
    };
    runs.iter().map(rows).sum::<f64>() * BYTES_PER_ROW / 1e6
}

/// Whole tenths of a millisecond, as the time column prints them.
fn interval(rate_hz: f64) -> f64 {
    (1e4 / rate_hz).round().max(1.0) / 1e4
}

fn write_runs(
    tank: &Tank,
    runs: &[PlannedRun],
    seed: u64,
    folder: &Path,
    watch: &(dyn Fn(Progress) + Sync),
) -> Result<(u64, Digest), Error> {
    let data = folder.join("data");
    fs::create_dir(&data).map_err(|source| io_error(&data, "create the folder", source))?;
    let (done, bytes, digest) = (AtomicUsize::new(0), AtomicU64::new(0), AtomicU64::new(0));
    runs.par_iter().enumerate().try_for_each_init(Vec::new, |buffer, (number, run)| {
        let mut stream = Stream::new(seed, Purpose::Run(number));
        tank.write_run(run, &mut stream, buffer);
        let name = format!("{}.csv", run_id(number));
        let file = data.join(&name);
        // The sum does not depend on the order in which threads come to their ends.
        digest.fetch_add(Digest::new(&name, buffer).0, Ordering::Relaxed);
        fs::write(&file, &*buffer).map_err(|source| io_error(&file, "write", source))?;
        bytes.fetch_add(buffer.len() as u64, Ordering::Relaxed);
        watch(Progress { runs_done: done.fetch_add(1, Ordering::Relaxed) + 1, runs: runs.len() });
        Ok(())
    })?;
    Ok((bytes.into_inner(), Digest(digest.into_inner())))
}

fn trend(first: &Hull, last: &Hull) -> Trend {
    let span = last.row.ldr - first.row.ldr;
    let (from, to) = (first.coefficients, last.coefficients);
    Trend {
        a_per_ldr: (to.a - from.a) / span,
        b_per_ldr: (to.b - from.b) / span,
        c_per_ldr: (to.c - from.c) / span,
        d_per_ldr: (to.d - from.d) / span,
    }
}

fn hull_truth(hull: &Hull) -> HullTruth {
    HullTruth {
        id: hull.row.id.to_owned(),
        ldr: hull.row.ldr,
        coefficients: hull.coefficients,
        live: hull.live,
        dynamic: hull.derivatives,
    }
}

fn run_truth(number: usize, run: &PlannedRun, tank: &Tank) -> RunTruth {
    let times = run.command.times();
    RunTruth {
        id: run_id(number),
        kind: run.command.kind,
        steady_from_s: times.steady_from,
        steady_to_s: times.steady_to,
        temperature_c: run.temperature_c,
        yaw_setting_error_deg: run.yaw_error_deg,
        speed_setting_ratio: run.speed_ratio,
        zero: tank.balance.zero(run.day, run.hours, tank.hidden),
        wait_s: run.wait_s,
    }
}
