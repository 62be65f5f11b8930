//! This program in a process of its own: its memory is then that of one job, and a tool may count its instructions.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::peer::number;

/// Starts this program on a job and returns its line of JSON.
pub fn work(job: &str, n: usize, on: &[&Path]) -> Result<Value> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(arguments(job, n, on));
    answer(&mut command)
}

/// Runs a command that prints one line of JSON.
pub fn answer(command: &mut Command) -> Result<Value> {
    let output = command.output().context("cannot start a job")?;
    let text = String::from_utf8_lossy(&output.stdout);
    let complaint = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        bail!("{}", complaint.lines().last().unwrap_or("the job failed without a word"));
    }
    let line = text.lines().rev().find(|line| line.starts_with('{')).context("the job said nothing")?;
    serde_json::from_str(line).context("the job's answer is no JSON")
}

/// Instructions for one unit of a job, by callgrind: the difference between two sizes, so that the start does not count.
/// They are the same however busy the machine is.
pub fn instructions(job: &str, on: &[&Path]) -> Result<f64> {
    const FEW: usize = 200;
    const MANY: usize = 2200;
    let count = |n: usize| -> Result<f64> {
        let output = Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(std::env::current_exe()?)
            .args(arguments(job, n, on))
            .output()
            .context("valgrind does not run (apt-get install valgrind)")?;
        let text = String::from_utf8_lossy(&output.stderr);
        if !output.status.success() {
            bail!("under valgrind: {}", text.lines().next_back().unwrap_or("failed without a word"));
        }
        let collected = text.lines().find_map(|line| line.split("Collected :").nth(1));
        let collected = collected.with_context(|| format!("valgrind: {}", text.lines().last().unwrap_or("")))?;
        collected.trim().parse().context("callgrind's count is no number")
    };
    Ok((count(MANY)? - count(FEW)?) / (MANY - FEW) as f64)
}

fn arguments(job: &str, n: usize, on: &[&Path]) -> Vec<std::ffi::OsString> {
    let mut words: Vec<std::ffi::OsString> = vec!["work".into(), job.into(), "--n".into(), n.to_string().into()];
    for path in on {
        words.push("--on".into());
        words.push(path.into());
    }
    words
}

/// Most memory that this process has had, bytes; not a number where the system does not tell.
pub fn peak_memory() -> f64 {
    status("VmHWM:")
}

/// Memory that this process has now, bytes.
pub fn memory() -> f64 {
    status("VmRSS:")
}

fn status(key: &str) -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix(key));
    line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok()).map_or(f64::NAN, |kib| kib * 1024.0)
}

/// Seconds and peak memory of an answer.
pub fn time_and_memory(answer: &Value) -> Result<(f64, f64)> {
    Ok((number(answer, "seconds")?, number(answer, "peak_bytes")?))
}
