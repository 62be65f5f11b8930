//! `cargo xtask fmu`: builds the shared library so that it loads on old and new machines, and packs the archives.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};

use crate::check_library::{OLDEST_GLIBC, check_exports, check_mathematics, check_portable, portability_faults};
use crate::cross;
use crate::licences;
use crate::pack::{self, Binaries, Model, Standard};
use crate::platform::{PLATFORMS, Platform, rustc_flags};
use crate::python::{self, Python};
use crate::workspace::{Workspace, run as run_command};

/// The archives of the glider in the plane and in space, and the library that is in them.
pub struct Fmus {
    pub fmi3: PathBuf,
    pub fmi2: PathBuf,
    pub space3: PathBuf,
    pub space2: PathBuf,
    pub library: PathBuf,
}

/// Programs and library together. What is built in one command has one set of features; a second command with other packages
/// would compile most of it again.
pub const PROGRAMS_AND_LIBRARY: [&str; 5] =
    ["--package=glidepolar", "--package=glidepolar-tank", "--package=glidepolar-fmu", "--bins", "--lib"];

/// For which platforms the library is built here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// For this machine's.
    Host,
    /// For this machine's, in one build with the released programs: what they share is compiled once.
    HostWithPrograms,
    /// For every one whose standard library and linker can be had.
    All,
}

/// Builds the library, packs it for both standards with the binaries that `merge` brings, and says what was made.
pub fn run(workspace: &Workspace, merge: &[PathBuf], scope: Scope) -> Result<Fmus> {
    pack::check_sources(workspace)?;
    let host = Platform::host()?;
    let library = build(workspace, host, scope == Scope::HostWithPrograms)?;
    let mut binaries: Binaries = BTreeMap::new();
    if scope == Scope::All {
        for platform in PLATFORMS.iter().filter(|platform| *platform != host) {
            match cross::library(workspace, platform) {
                Ok(library) => drop(binaries.insert(platform, fs::read(library)?)),
                Err(error) => eprintln!("WARNING: no binary for {}: {error:#}", platform.fmi3),
            }
        }
    }
    for other in merge {
        for (platform, library) in pack::binaries_of(workspace, other)? {
            if platform.is_linux() {
                warn_unless_portable(&other.display().to_string(), &library)?;
            }
            binaries.insert(platform, library);
        }
    }
    binaries.insert(host, fs::read(&library)?);
    let notice = licences::notice(workspace, "glidepolar-fmu", "The library in this FMU is")?;

    let folder = workspace.target("fmu");
    let mut written = Vec::new();
    for of in Model::ALL.into_iter().flat_map(|model| [(model, Standard::Fmi3), (model, Standard::Fmi2)]) {
        let path = folder.join(of.1.archive_name(of.0));
        let archive = pack::assemble(workspace, of, &notice, &binaries)?;
        archive.write(&path)?;
        let platforms: Vec<_> = binaries.keys().map(|platform| platform.fmi3).collect();
        let size = fs::metadata(&path)?.len() / 1024;
        eprintln!("packed {} ({size} KiB; {})", workspace.shown(&path), platforms.join(", "));
        written.push(path);
    }
    let [fmi3, fmi2, space3, space2] =
        <[PathBuf; 4]>::try_from(written).expect("one archive for each model and standard");
    Ok(Fmus { fmi3, fmi2, space3, space2, library })
}

/// Builds the library for this machine's platform and checks it. On Linux it is linked against an old C library; where
/// that cannot be had, the build says aloud that the result is for this machine and newer ones only.
fn build(workspace: &Workspace, host: &Platform, with_programs: bool) -> Result<PathBuf> {
    let (prefix, suffix) = host.library;
    let built = workspace.target(host.triple).join("release").join(format!("{prefix}glidepolar_fmu{suffix}"));

    let packages: &[&str] = if with_programs { &PROGRAMS_AND_LIBRARY } else { &["--package=glidepolar-fmu", "--lib"] };
    let is_portable = build_released(workspace, host, packages)?;

    let bytes = fs::read(&built).with_context(|| format!("cargo did not leave {}", workspace.shown(&built)))?;
    check_exports(&bytes)?;
    check_mathematics(&bytes)?;
    if host.is_linux() {
        let name = workspace.shown(&built).to_string();
        if is_portable { check_portable(&name, &bytes)? } else { warn_unless_portable(&name, &bytes)? }
    }
    Ok(built)
}

/// Builds packages as they are released: optimised, without symbols, on Linux against an old C library where that is to be had;
/// returns whether it was.
pub fn build_released(workspace: &Workspace, host: &Platform, packages: &[&str]) -> Result<bool> {
    let portable = if host.is_linux() { portable_cargo(workspace, host) } else { None };
    let is_portable = portable.is_some();
    let mut command = portable.unwrap_or_else(|| {
        let mut command = workspace.cargo();
        command.args(["build", "--target", host.triple]);
        command
    });
    command.arg("--release").args(packages);
    command.env("CARGO_PROFILE_RELEASE_STRIP", "symbols");
    command.env("CARGO_ENCODED_RUSTFLAGS", rustc_flags(workspace, host).join("\x1f"));
    run_command(&mut command)?;
    Ok(is_portable)
}

/// `cargo zigbuild` from the Python environment, for this platform with the old C library; `None`, said aloud, if that
/// is not to be had here.
fn portable_cargo(workspace: &Workspace, host: &Platform) -> Option<Command> {
    let warn = |reason: String| {
        eprintln!("WARNING: {reason}.\n         The FMU is built against this machine's C library instead.");
    };
    let python: Python = python::ensure_begun(workspace).map_err(|error| warn(format!("{error:#}"))).ok()?;
    let zigbuild = python.tool("cargo-zigbuild");
    if !zigbuild.is_file() {
        warn(format!("cargo-zigbuild is not among the packages in {}", workspace.shown(&zigbuild)));
        return None;
    }
    let mut command = workspace.command(zigbuild);
    command.arg("zigbuild").arg("--target").arg(format!("{}.{OLDEST_GLIBC}", host.triple));
    // The linker is the one of the ziglang package, wherever another may be installed.
    command.env("CARGO_ZIGBUILD_PYTHON_PATH", python.interpreter());
    Some(command)
}

fn warn_unless_portable(name: &str, library: &[u8]) -> Result<()> {
    let faults = portability_faults(library)?;
    if !faults.is_empty() {
        eprintln!("WARNING: {name} does not load on every Linux machine:\n  - {}", faults.join("\n  - "));
    }
    Ok(())
}
