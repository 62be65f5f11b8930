//! `cargo xtask demo`: builds programs and FMUs as they are released, and runs `glidepolar demo` with the FMPy of the Python
//! environment: a hidden fault in a log, its cause, the extended vehicle, and its FMU on a held-out dive.
//!
//! The FMU is the released one in any case. The programs can be those of the tests, which are there already: a release build
//! of both is minutes on two cores, and what it would show beyond the tests' build is its linking alone.

use anyhow::Result;

use crate::fmu;
use crate::python;
use crate::wheel;
use crate::workspace::{Kind, Workspace, run as run_command};

/// Runs the demonstration, leaves its page and says where.
pub fn run(workspace: &Workspace, kind: Kind) -> Result<()> {
    let python = python::ensure_begun(workspace)?;
    // In one build for one platform: what programs and library share is built once.
    let programs = wheel::programs(workspace, kind)?;
    let scope = if kind == Kind::Tests { fmu::Scope::Host } else { fmu::Scope::HostWithPrograms };
    let fmus = fmu::run(workspace, &[], scope)?;
    let folder = workspace.target("demo");
    let mut demo = workspace.command(&programs[0]);
    demo.arg("demo").arg(&folder).arg("--python").arg(python.interpreter()).arg("--template").arg(&fmus.fmi3);
    run_command(&mut demo)
}
