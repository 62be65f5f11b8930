//! Builds the importers of tests/importers: other people's Rust crates that load an FMU. They are a workspace of their
//! own, since nothing of the project shall depend on what they need.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Result;

use crate::workspace::{Workspace, capture, run as run_command};

/// Builds both importers and returns the folder of their programs. The one that needs libclang is left out where that
/// is missing: `skipped`, the list of what is not tested, then says so, and what would install it.
pub fn build(workspace: &Workspace, skipped: &Path) -> Result<PathBuf> {
    let folder = workspace.target("importers");
    let cargo = || -> Command {
        let mut command = workspace.cargo();
        command.args(["build", "--locked", "--manifest-path", "tests/importers/Cargo.toml", "--bins"]);
        command.arg("--target-dir").arg(&folder);
        command
    };
    eprintln!("building the importers of tests/importers (for the first time this takes a few minutes)");
    // Not on the terminal: where libclang is missing, pages of a build script's complaints would hide the one line
    // that helps.
    if let Err(error) = capture(cargo().args(["--features", "fmi-sim"])) {
        if !format!("{error:#}").contains("libclang") {
            return Err(error);
        }
        let install = match std::env::consts::OS {
            "macos" => "brew install llvm",
            "windows" => "winget install LLVM.LLVM",
            _ => "apt-get install libclang-dev",
        };
        let mut list = OpenOptions::new().append(true).create(true).open(skipped)?;
        writeln!(list, "the `fmi` crate as an importer: it needs libclang ({install})")?;
        run_command(&mut cargo())?;
    }
    Ok(folder.join("debug"))
}
