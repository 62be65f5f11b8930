//! Libraries for other platforms than this machine's, and a flight of each where an emulator is installed.
//!
//! The linker is zig's, of the Python package `ziglang`, which brings the C libraries of Linux and Windows and a stub of
//! that of macOS; rustup brings Rust's standard library. Nothing is installed here: what is missing is said.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::check_library::{OLDEST_GLIBC, check_exports, check_portable, is_built_for};
use crate::platform::{PLATFORMS, Platform, rustc_flags};
use crate::python;
use crate::workspace::{Workspace, capture, run as run_command};

/// How far the numbers of two platforms may lie apart, relative to their size: their mathematical functions differ in the
/// last place.
const SAME: f64 = 1e-12;

/// Builds the library for another platform and says where it is.
pub fn library(workspace: &Workspace, platform: &Platform) -> Result<PathBuf> {
    let built = build(workspace, platform, &["--lib"])?.join(file_of(platform));
    let bytes = fs::read(&built).with_context(|| format!("cargo did not leave {}", workspace.shown(&built)))?;
    check_exports(&bytes)?;
    if !is_built_for(&bytes, platform) {
        bail!("{} is not for {}", workspace.shown(&built), platform.fmi3);
    }
    if platform.is_linux() {
        check_portable(&workspace.shown(&built).to_string(), &bytes)?;
    }
    Ok(built)
}

/// Flies the library of every other platform that can be built and emulated here, and compares the flight with this
/// machine's.
pub fn try_all(workspace: &Workspace) -> Result<()> {
    let host = Platform::host()?;
    let reference = fly(workspace, host, None)?;
    let mut differ = Vec::new();
    for platform in PLATFORMS.iter().filter(|platform| *platform != host) {
        let Some(emulator) = emulator(platform) else {
            eprintln!("{}: no emulator; not run", platform.fmi3);
            continue;
        };
        match fly(workspace, platform, Some(emulator)) {
            Ok(flown) => {
                let apart = distance(&reference, &flown)?;
                eprintln!("{}: {} rows, {apart:.1e} from {} at most", platform.fmi3, flown.len(), host.fmi3);
                if apart > SAME {
                    differ.push(format!("{} by {apart:.1e}", platform.fmi3));
                }
            }
            Err(error) => eprintln!("{}: not run: {error:#}", platform.fmi3),
        }
    }
    if !differ.is_empty() {
        bail!("flights differ from that of {}: {}; the limit is {SAME:e}", host.fmi3, differ.join(", "));
    }
    Ok(())
}

/// Builds for a platform and says in which folder the results are.
fn build(workspace: &Workspace, platform: &Platform, what: &[&str]) -> Result<PathBuf> {
    let target = platform.crossed;
    let sysroot = capture(workspace.command("rustc").args(["--print", "sysroot"]))?;
    if !Path::new(sysroot.trim()).join("lib/rustlib").join(target).is_dir() {
        bail!("Rust's standard library for it is not installed; `rustup target add {target}` fetches it");
    }
    let python = python::ensure(workspace)?;
    let mut command = workspace.command(python.tool("cargo-zigbuild"));
    let version = if platform.is_linux() { format!(".{OLDEST_GLIBC}") } else { String::new() };
    command.args(["zigbuild", "--target", &format!("{target}{version}"), "--release", "--package", "glidepolar-fmu"]);
    command.args(what);
    command.env("CARGO_ZIGBUILD_PYTHON_PATH", python.interpreter());
    command.env("CARGO_PROFILE_RELEASE_STRIP", "symbols");
    command.env("CARGO_ENCODED_RUSTFLAGS", rustc_flags(workspace, platform).join("\x1f"));
    run_command(&mut command)?;
    Ok(workspace.target(target).join("release"))
}

/// What runs a program of that platform here.
fn emulator(platform: &Platform) -> Option<Command> {
    let mut command = match platform.fmi3 {
        "x86_64-windows" => {
            let mut wine = Command::new("wine");
            wine.env("WINEDEBUG", "-all");
            wine
        }
        "aarch64-linux" => {
            let mut qemu = Command::new("qemu-aarch64");
            // Where Debian's cross compiler keeps the C library.
            qemu.args(["-L", "/usr/aarch64-linux-gnu"]);
            qemu
        }
        _ => return None,
    };
    let mut probe = Command::new(command.get_program());
    capture(probe.arg("--version")).is_ok().then(|| std::mem::replace(&mut command, Command::new("true")))
}

/// The rows that the flying program prints.
fn fly(workspace: &Workspace, platform: &Platform, emulator: Option<Command>) -> Result<Vec<Vec<f64>>> {
    let folder = build(workspace, platform, &["--lib", "--example", "fly_library"])?;
    let suffix = if platform.library.1 == ".dll" { ".exe" } else { "" };
    let program = folder.join("examples").join(format!("fly_library{suffix}"));
    let mut command = match emulator {
        Some(mut emulator) => {
            emulator.arg(&program);
            emulator
        }
        None => workspace.command(&program),
    };
    let printed = capture(command.arg(folder.join(file_of(platform))))?;
    let row = |line: &str| line.split(',').map(|cell| cell.trim().parse().map_err(Into::into)).collect();
    printed.lines().map(row).collect()
}

fn distance(one: &[Vec<f64>], other: &[Vec<f64>]) -> Result<f64> {
    if one.len() != other.len() || one.is_empty() {
        bail!("{} rows against {}", other.len(), one.len());
    }
    let pairs = one.iter().flatten().zip(other.iter().flatten());
    Ok(pairs.map(|(a, b)| (a - b).abs() / a.abs().max(1.0)).fold(0.0, f64::max))
}

fn file_of(platform: &Platform) -> String {
    let (prefix, suffix) = platform.library;
    format!("{prefix}glidepolar_fmu{suffix}")
}
