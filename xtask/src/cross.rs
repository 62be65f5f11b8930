//! Libraries for other platforms than this machine's, and a flight of each where an emulator is installed.
//!
//! The linker is zig's, of the Python package `ziglang`, which brings the C libraries of Linux and Windows and a stub of
//! that of macOS; rustup brings Rust's standard library. Nothing is installed here: what is missing is said.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::check_library::{OLDEST_GLIBC, check_exports, check_mathematics, check_portable, is_built_for};
use crate::platform::{PLATFORMS, Platform, rustc_flags};
use crate::python;
use crate::workspace::{Kind, Workspace, capture, run as run_command};

/// How far the numbers of two platforms may lie apart, relative to the largest of their column.
const SAME: f64 = 1e-12;

/// A column with nothing larger is compared as if it had this: what is left of a zero is rounding.
const LEAST_SCALE: f64 = 1e-3;

/// Builds the library for another platform and says where it is.
pub fn library(workspace: &Workspace, platform: &Platform) -> Result<PathBuf> {
    let built = build(workspace, platform, Kind::Release, &["--lib"])?.join(file_of(platform));
    let bytes = fs::read(&built).with_context(|| format!("cargo did not leave {}", workspace.shown(&built)))?;
    check_exports(&bytes)?;
    check_mathematics(&bytes)?;
    if !is_built_for(&bytes, platform) {
        bail!("{} is not for {}", workspace.shown(&built), platform.fmi3);
    }
    if platform.is_linux() {
        check_portable(&workspace.shown(&built).to_string(), &bytes)?;
    }
    Ok(built)
}

/// Flies the library of every other platform that can be built and emulated here, and compares the flight with this
/// machine's. Fails where flights differ, and where a platform of `required` was not flown.
pub fn try_all(workspace: &Workspace, required: &[String], kind: Kind) -> Result<()> {
    let host = Platform::host()?;
    let reference = fly(workspace, host, Kind::Release, None)?;
    let mut faults = Vec::new();
    for platform in PLATFORMS.iter().filter(|platform| *platform != host) {
        let flown = emulator(workspace, platform).and_then(|emulator| fly(workspace, platform, kind, Some(emulator)));
        match flown.and_then(|flown| compare(&reference, &flown)) {
            Ok(parts) => {
                for (part, rows, apart) in parts {
                    println!("{:15} {part:40} {rows:5} rows, {apart:.1e} from {} at most", platform.fmi3, host.fmi3);
                    if apart > SAME {
                        faults.push(format!("{}, {part}: {apart:.1e} from {}", platform.fmi3, host.fmi3));
                    }
                }
            }
            Err(error) => {
                println!("{:15} not flown: {error:#}", platform.fmi3);
                if required.iter().any(|name| name == platform.fmi3) {
                    faults.push(format!("{} was not flown", platform.fmi3));
                }
            }
        }
    }
    if !faults.is_empty() {
        bail!("the limit is {SAME:e} of the largest number of each column:\n  {}", faults.join("\n  "));
    }
    Ok(())
}

/// Builds for a platform and says in which folder the results are.
fn build(workspace: &Workspace, platform: &Platform, kind: Kind, what: &[&str]) -> Result<PathBuf> {
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
    if kind == Kind::Tests {
        let hardly = [("OPT_LEVEL", "1"), ("LTO", "off"), ("CODEGEN_UNITS", "16")];
        command.envs(hardly.map(|(key, value)| (format!("CARGO_PROFILE_RELEASE_{key}"), value)));
    }
    run_command(&mut command)?;
    Ok(workspace.target(target).join("release"))
}

/// What runs a program of that platform here.
fn emulator(workspace: &Workspace, platform: &Platform) -> Result<Command> {
    let (program, package) = match platform.fmi3 {
        "x86_64-windows" => ("wine", "wine wine64"),
        "aarch64-linux" => ("qemu-aarch64", "qemu-user libc6-arm64-cross"),
        _ => bail!("there is no emulator of it"),
    };
    capture(Command::new(program).arg("--version"))
        .with_context(|| format!("{program} does not run; `apt-get install {package}` installs it"))?;
    let mut command = Command::new(program);
    if program == "wine" {
        // A Windows of its own, without the browser and the .NET that wine would offer to fetch.
        command.env("WINEPREFIX", workspace.target("wine")).env("WINEDLLOVERRIDES", "mscoree,mshtml=");
        command.env("WINEDEBUG", "-all");
    } else {
        // Where Debian's cross compiler keeps the C library.
        command.args(["-L", "/usr/aarch64-linux-gnu"]);
    }
    Ok(command)
}

/// A heading, and rows of numbers below it.
type Part = (String, Vec<Vec<f64>>);

/// What the flying program prints.
type Parts = Vec<Part>;

fn fly(workspace: &Workspace, platform: &Platform, kind: Kind, emulator: Option<Command>) -> Result<Parts> {
    let folder = build(workspace, platform, kind, &["--lib", "--example", "fly_library"])?;
    let suffix = if platform.library.1 == ".dll" { ".exe" } else { "" };
    if platform.library.1 == ".dll" {
        build_what_wine_lacks(workspace, &folder.join("examples"))?;
    }
    let program = folder.join("examples").join(format!("fly_library{suffix}"));
    let mut command = match emulator {
        Some(mut emulator) => {
            emulator.arg(&program);
            emulator
        }
        None => workspace.command(&program),
    };
    command.current_dir(workspace.path("modelDescription")).arg(folder.join(file_of(platform)));
    let descriptions = ["fmi2", "fmi3", "space/fmi2", "space/fmi3"];
    let printed = capture(command.args(descriptions.map(|folder| format!("{folder}/modelDescription.xml"))))?;
    let mut parts = Parts::new();
    for line in printed.lines() {
        match (line.strip_prefix("# "), parts.last_mut()) {
            (Some(heading), _) => parts.push((heading.to_owned(), Vec::new())),
            (None, Some((_, rows))) => {
                let cell = |cell: &str| cell.trim().parse().with_context(|| format!("{cell:?} is no number"));
                rows.push(line.split(',').map(cell).collect::<Result<_>>()?);
            }
            (None, None) => bail!("{line:?} stands before any heading"),
        }
    }
    Ok(parts)
}

/// The library that Rust's standard library needs and Wine has from version 9 on only, beside the program.
fn build_what_wine_lacks(workspace: &Workspace, folder: &Path) -> Result<()> {
    let python = python::ensure(workspace)?;
    let mut zig = workspace.command(python.interpreter());
    zig.args([
        "-m",
        "ziglang",
        "cc",
        "-target",
        "x86_64-windows-gnu",
        "-shared",
        "-nostdlib",
        "-Wl,--entry=DllMain",
        "-o",
    ]);
    zig.arg(folder.join("bcryptprimitives.dll")).arg(workspace.path("xtask/wine/bcryptprimitives.c")).arg("-ladvapi32");
    run_command(&mut zig)
}

/// For each part its heading, the number of rows and the largest distance, relative to the largest number of its column.
fn compare(one: &Parts, other: &Parts) -> Result<Vec<(String, usize, f64)>> {
    let shape = |parts: &Parts| {
        let of_part = |(heading, rows): &Part| (heading.clone(), rows.iter().map(Vec::len).collect::<Vec<_>>());
        parts.iter().map(of_part).collect::<Vec<_>>()
    };
    if one.is_empty() || shape(one) != shape(other) {
        bail!("the flights have not the same rows");
    }
    let part = |((heading, one), (_, other)): (&Part, &Part)| {
        let scale = |width: usize, column: usize| {
            let of_column = one.iter().filter(|row| row.len() == width).map(|row| row[column].abs());
            of_column.fold(LEAST_SCALE, f64::max)
        };
        let mut largest = 0.0_f64;
        for (row, other) in one.iter().zip(other) {
            for (column, (a, b)) in row.iter().zip(other).enumerate().filter(|(_, (a, b))| a != b) {
                let apart = (a - b).abs() / scale(row.len(), column);
                largest = largest.max(if apart.is_nan() { f64::INFINITY } else { apart });
            }
        }
        (heading.clone(), one.len(), largest)
    };
    Ok(one.iter().zip(other).map(part).collect())
}

fn file_of(platform: &Platform) -> String {
    let (prefix, suffix) = platform.library;
    format!("{prefix}glidepolar_fmu{suffix}")
}
