//! `cargo xtask fuzz`: the targets of `fuzz/` under libFuzzer, each for a while. What is found is kept in
//! `target/fuzz/found/TARGET/`; what reached new code in `target/fuzz/corpus/TARGET/`, where the next run goes on.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::platform::Platform;
use crate::workspace::{Workspace, capture, run as run_command};

/// Coverage as libFuzzer reads it. rustc's own name for these is unstable, LLVM's are not.
const COVERAGE: [&str; 6] = [
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    "--cfg=fuzzing",
];

/// Where the targets stand. Those of a folder below are built with the feature of its name.
const TARGETS: &str = "fuzz/src/targets";

/// Longer than this for one input is a hang \[s\].
const PATIENCE_S: u32 = 20;

/// More memory than this is too much for inputs of a few kB \[MB\].
const MOST_MEMORY_MB: u32 = 2048;

/// What to run.
#[derive(clap::Args)]
pub struct Choice {
    /// How long to run each target
    #[arg(long, value_name = "N", default_value_t = 60)]
    seconds: u32,
    /// Unoptimised: whether a target runs, not how far it comes
    #[arg(long)]
    quick: bool,
    /// Only print the names of the targets
    #[arg(long)]
    list: bool,
    /// Run this target once on the files that follow, in place of looking for new ones
    #[arg(long, value_name = "FILE", num_args = 1.., requires = "targets")]
    replay: Vec<PathBuf>,
    /// Targets; all where none is named
    #[arg(value_name = "TARGET")]
    targets: Vec<String>,
}

/// Builds the targets and runs them, one after the other.
pub fn run(workspace: &Workspace, choice: &Choice) -> Result<()> {
    let known = known_targets(workspace)?;
    if choice.list {
        known.keys().for_each(|name| println!("{name}"));
        return Ok(());
    }
    let names = || known.keys().map(String::as_str).collect::<Vec<_>>();
    if let Some(unknown) = choice.targets.iter().find(|name| !known.contains_key(*name)) {
        bail!("there is no target {unknown}; the targets are {}", names().join(", "));
    }
    let targets = if choice.targets.is_empty() { names() } else { choice.targets.iter().map(String::as_str).collect() };
    let features: BTreeSet<&str> = targets.iter().filter_map(|name| known[*name].as_deref()).collect();
    let program = build(workspace, choice.quick, &features)?;
    let mut failed = Vec::new();
    for target in targets {
        if let Err(error) = fuzz(workspace, &program, target, choice) {
            eprintln!("{error:#}");
            failed.push(target);
        }
    }
    if !failed.is_empty() {
        bail!("found something in {}: see target/fuzz/found/", failed.join(", "));
    }
    Ok(())
}

/// The names of all targets, with the feature that each is built with.
fn known_targets(workspace: &Workspace) -> Result<BTreeMap<String, Option<String>>> {
    let mut known = BTreeMap::new();
    let mut folders = vec![(workspace.path(TARGETS), None)];
    while let Some((folder, feature)) = folders.pop() {
        for entry in fs::read_dir(&folder).with_context(|| format!("cannot read {}", folder.display()))? {
            let entry = entry?;
            if entry.path().is_dir() {
                folders.push((entry.path(), Some(entry.file_name().to_string_lossy().into_owned())));
            } else {
                known.extend(names_in(&entry.path())?.into_iter().map(|name| (name, feature.clone())));
            }
        }
    }
    Ok(known)
}

/// The names of the targets of a file.
fn names_in(file: &Path) -> Result<Vec<String>> {
    let text = fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?;
    let mut names = Vec::new();
    let mut rest = text.as_str();
    while let Some((_, after)) = rest.split_once(": Target =") {
        let name = after.split_once("name: \"").and_then(|(_, name)| name.split_once('"'));
        let (name, after) = name.context("an unnamed target")?;
        names.push(name.to_owned());
        rest = after;
    }
    Ok(names)
}

/// Builds the targets of these features.
fn build(workspace: &Workspace, quick: bool, features: &BTreeSet<&str>) -> Result<PathBuf> {
    let host = Platform::host()?;
    let folder = workspace.target("fuzz");
    eprintln!("building the targets with coverage (for the first time this takes some minutes)");
    let mut command = workspace.cargo();
    let (profile, built) = if quick { ("dev", "debug") } else { ("release", "release") };
    command.args(["build", "--profile", profile, "--locked", "--manifest-path", "fuzz/libfuzzer/Cargo.toml"]);
    command.arg("--no-default-features").args(features.iter().map(|feature| format!("--features={feature}")));
    // A target of its own keeps coverage out of what runs while building.
    command.args(["--target", host.triple]).arg("--target-dir").arg(&folder);
    command.env("CARGO_ENCODED_RUSTFLAGS", COVERAGE.join("\x1f"));
    run_command(&mut command).context(
        "cannot build the targets; where cargo missed one, libFuzzer needs a C++ compiler (apt-get install g++)",
    )?;
    Ok(folder.join(host.triple).join(built).join("glidepolar-libfuzzer"))
}

fn fuzz(workspace: &Workspace, program: &Path, target: &str, choice: &Choice) -> Result<()> {
    let corpus = workspace.target(format!("fuzz/corpus/{target}"));
    let found = workspace.target(format!("fuzz/found/{target}"));
    let known = workspace.path(format!("fuzz/regressions/{target}"));
    for folder in [&corpus, &found] {
        fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    }
    let mut command = workspace.command(program);
    // One thread: the same input reaches the same code in the same order.
    command.env("GLIDEPOLAR_FUZZ_TARGET", target).env("RAYON_NUM_THREADS", "1");
    command.arg(format!("-timeout={PATIENCE_S}")).arg(format!("-rss_limit_mb={MOST_MEMORY_MB}"));
    if !choice.replay.is_empty() {
        return run_command(command.args(&choice.replay));
    }
    if fs::read_dir(&corpus)?.next().is_none() {
        command.env("GLIDEPOLAR_FUZZ_SEEDS", &corpus);
    }
    command.arg(format!("-artifact_prefix={}/", found.display()));
    command.arg(format!("-max_total_time={}", choice.seconds)).args(["-print_final_stats=1", "-verbosity=0"]);
    command.arg(&corpus);
    if known.is_dir() {
        command.arg(&known);
    }
    eprintln!("\n{target}, {} s", choice.seconds);
    let log = found.join("log.txt");
    command.stderr(fs::File::create(&log)?).stdout(std::process::Stdio::null());
    let result = capture(&mut command);
    let text = String::from_utf8_lossy(&fs::read(&log)?).into_owned();
    let wanted = |line: &&str| line.starts_with("stat::number_of_executed") || line.starts_with("stat::peak_rss");
    text.lines().filter(wanted).for_each(|line| eprintln!("  {}", line.trim_start_matches("stat::")));
    if result.is_err() {
        let from = text.lines().count().saturating_sub(40);
        text.lines().skip(from).for_each(|line| eprintln!("  {line}"));
        bail!("{target}: the input is in {}", workspace.shown(&found));
    }
    Ok(())
}
