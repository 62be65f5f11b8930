//! A campaign reduced: beside the bare parse of its columns, beside pandas and SciPy, in time and memory.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result};
use glidepolar_tank::virtual_tank::{Options, write_campaign};
use serde_json::Value;

use super::Context;
use crate::arguments::Sized;
use crate::child::{self, time_and_memory};
use crate::contest::{Contender, Outcome, Samples, contest};
use crate::report::{Goal, Part, Row, Unit};

pub fn measure(context: &Context<'_>) -> Result<Part> {
    let mut part = Part::new(
        "Hull tests",
        "Synthetic campaigns of the virtual tank, every run a CSV of seven columns, in the system's file cache. The bare \
         parse turns the same cells into f64 by the csv crate, one record used again and again, on one core. pandas and \
         SciPy do the steady half of the reduction: zeros, interaction, window, strut, coefficients, fits. Each in a \
         process of its own; the time is without the start of the process, the memory with it.",
    );
    let sizes: &[f64] =
        context.choice.size(Sized { quick: &[3.0], standard: &[10.0, 100.0], full: &[10.0, 100.0, 1000.0] });
    for megabytes in sizes {
        if let Err(error) = of_size(context, &mut part, *megabytes) {
            part.row(Row::new(format!("{megabytes:.0} MB"), Unit::Seconds, Err(error)));
        }
    }
    Ok(part)
}

/// A campaign of about this size, written once.
pub fn campaign(context: &Context<'_>, megabytes: f64) -> Result<tempfile::TempDir> {
    let folder = tempfile::tempdir_in(context.work(""))?;
    // Every hull takes 2 MB at least.
    let hulls = if megabytes < 10.0 { vec!["LDR8.5".to_owned()] } else { Vec::new() };
    let options = Options { size_mb: Some(megabytes), hulls, ..Options::default() };
    write_campaign(&folder.path().join("pmm_runs"), &options)?;
    Ok(folder)
}

fn of_size(context: &Context<'_>, part: &mut Part, megabytes: f64) -> Result<()> {
    let folder = campaign(context, megabytes)?;
    let runs = folder.path().join("pmm_runs");
    let rounds = match megabytes {
        size if size > 500.0 => 2,
        size if size > 50.0 => context.choice.size(Sized { quick: 0, standard: 3, full: 5 }),
        _ => context.choice.size(Sized { quick: 0, standard: 5, full: 7 }),
    };
    let mut memories: [Samples; 4] = Default::default();
    let mut values: [Option<Value>; 2] = [None, None];
    let [parse_memory, one_memory, two_memory, pandas_memory] = &mut memories;
    let [ours_values, pandas_values] = &mut values;
    let outcomes: [Outcome; 4] = contest(
        rounds,
        [
            Contender::new("csv", || job("csv-parse", &runs, 1, parse_memory).map(|(seconds, _)| seconds)),
            Contender::new("one core", || {
                let (seconds, answer) = job("tank-reduce", &runs, 1, one_memory)?;
                *ours_values = Some(answer);
                Ok(seconds)
            }),
            Contender::new("two cores", || job("tank-reduce", &runs, 2, two_memory).map(|(seconds, _)| seconds)),
            Contender::new("pandas", || {
                let python = context.python().context("the Python environment with pandas is not there")?;
                let script = context.root().join("benches/peers/tank_pandas.py");
                let answer = child::answer(Command::new(python).arg(script).arg(&runs))?;
                let (seconds, bytes) = time_and_memory(&answer)?;
                pandas_memory.push(bytes);
                *pandas_values = Some(answer);
                Ok(seconds)
            }),
        ],
    );
    let [parse, one, two, pandas] = outcomes;
    let size = format!("{megabytes:.0} MB");
    part.row(
        Row::new(format!("{size}, one core"), Unit::Seconds, one.samples().cloned())
            .against("bare parse by the csv crate, one core", parse.samples().cloned())
            .goal(Goal::Within(1.0 / 0.6)),
    );
    part.row(
        Row::new(format!("{size}, two cores"), Unit::Seconds, two.samples().cloned())
            .against("one core", one.samples().cloned()),
    );
    part.row(
        Row::new(format!("{size}, two cores"), Unit::Seconds, two.samples().cloned())
            .against("pandas and SciPy, the steady half", pandas.samples().cloned()),
    );
    let kept = |outcome: &Outcome, samples: &Samples| outcome.samples().map(|_| samples.clone());
    part.row(
        Row::new(format!("{size}, two cores, peak memory"), Unit::Bytes, kept(&two, &memories[2]))
            .against("pandas and SciPy", kept(&pandas, &memories[3])),
    );
    part.row(
        Row::new(format!("{size}, one core, peak memory"), Unit::Bytes, kept(&one, &memories[1]))
            .against("bare parse by the csv crate", kept(&parse, &memories[0])),
    );
    if let [Some(ours), Some(theirs)] = &values {
        part.remark(format!("{size}: {}", agreement(ours, theirs)?));
    }
    Ok(())
}

/// Seconds and answer; the peak memory is kept aside.
fn job(job: &str, runs: &Path, threads: usize, memory: &mut Samples) -> Result<(f64, Value)> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(["work", job, "--on"]).arg(runs).env("RAYON_NUM_THREADS", threads.to_string());
    let answer = child::answer(&mut command)?;
    let (seconds, bytes) = time_and_memory(&answer)?;
    memory.push(bytes);
    Ok((seconds, answer))
}

/// How far the two reductions are apart: the largest relative difference of a fitted coefficient.
fn agreement(ours: &Value, theirs: &Value) -> Result<String> {
    type Hulls = BTreeMap<String, BTreeMap<String, f64>>;
    let ours: Hulls = serde_json::from_value(ours["hulls"].clone())?;
    let theirs: Hulls = serde_json::from_value(theirs["hulls"].clone())?;
    let mut worst = 0.0_f64;
    for (hull, fit) in &ours {
        for (name, value) in fit {
            let other = theirs.get(hull).and_then(|fit| fit.get(name)).context("a coefficient of the peer")?;
            worst = worst.max((other / value - 1.0).abs());
        }
    }
    Ok(format!("a, b, c, d of pandas and SciPy are within {:.1} % of the reduction's", 100.0 * worst))
}
