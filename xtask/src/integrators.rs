//! `cargo xtask integrators`: the packed FMUs under other people's integrators in Model Exchange, every method, tolerance
//! and output interval of `tests/python/corners.py`. The tests fly a selection of these.

use anyhow::Result;

use crate::fmu::{self, Scope};
use crate::python;
use crate::workspace::{Workspace, run as run_command};

/// Packs the archives and flies all corners with each. Fails where one flight fails.
pub fn run(workspace: &Workspace) -> Result<()> {
    let fmus = fmu::run(workspace, &[], Scope::Host)?;
    let python = python::ensure(workspace)?;
    let mut command = workspace.command(python.interpreter());
    command.arg(workspace.path("tests/python/corners.py"));
    run_command(command.args([fmus.fmi3, fmus.fmi2, fmus.space3, fmus.space2]))
}
