//! `cargo xtask bench`: builds what is measured as it is shipped, gets the programs that are measured beside it, and runs
//! the bench. What cannot be had is left out: its rows say so.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::Result;

use crate::workspace::{Workspace, run as run_command};
use crate::{fetch_data, fmu, python};

/// The profile of the manifest, whatever this machine's cargo is set up with: measured is what is shipped.
const RELEASE: [(&str, &str); 3] = [
    ("CARGO_PROFILE_RELEASE_LTO", "false"),
    ("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "1"),
    ("CARGO_PROFILE_RELEASE_INCREMENTAL", "false"),
];

/// What to measure; the bench itself knows more of it.
#[derive(clap::Args)]
pub struct Choice {
    /// Few rounds, small sizes, unoptimised: whether everything runs, not how fast
    #[arg(long)]
    quick: bool,
    /// The large sizes, too: 1 GB, 100,000 missions, a whole fleet-year, the slowest calibration to its end
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// Only these parts: fmu, identify, diagnose, logs, tank, ensembles, fleet, growth
    #[arg(long, value_name = "PARTS")]
    only: Option<String>,
}

/// Builds and measures.
pub fn run(workspace: Workspace, choice: &Choice) -> Result<()> {
    let begin = Instant::now();
    let workspace = workspace.with_environment(&RELEASE);
    let programs = ["--bin=glidepolar-bench", "--bin=glidepolar"];
    let (profile, folder) = if choice.quick { ("dev", "debug") } else { ("release", "release") };
    run_command(workspace.cargo_for_all("build").args(["--profile", profile]).args(programs))?;
    let fmus = or_say("the FMU", fmu::run(&workspace, &[], fmu::Scope::Host));
    let python = or_say("the other programs", python::ensure(&workspace));
    or_say("gliderflight's data", fetch_data::run(&workspace));
    eprintln!("built in {:.0} s", begin.elapsed().as_secs_f64());

    let program = |name: &str| workspace.target(folder).join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    let mut bench = workspace.command(program("glidepolar-bench"));
    bench.arg("run").arg("--root").arg(workspace.path("")).arg("--work").arg(workspace.target("bench"));
    let mut give = |name: &str, path: Option<PathBuf>| {
        if let Some(path) = path {
            bench.arg(name).arg(path);
        }
    };
    give("--command", Some(program("glidepolar")));
    give("--python", python.map(|python| python.interpreter()));
    if let Some(fmus) = fmus {
        give("--fmu3", Some(fmus.fmi3));
        give("--fmu2", Some(fmus.fmi2));
        give("--library", Some(fmus.library));
    }
    if choice.quick {
        bench.arg("--quick");
    }
    if choice.full {
        bench.arg("--full");
    }
    if let Some(parts) = &choice.only {
        bench.args(["--only", parts]);
    }
    run_command(&mut bench)
}

/// What was got; what was not is said, and the rows that need it say it again.
fn or_say<T>(what: &str, result: Result<T>) -> Option<T> {
    result.map_err(|error| eprintln!("WARNING: without {what}: {error:#}")).ok()
}
