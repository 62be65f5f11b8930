//! `cargo xtask wheel`: the extension module, both commands, both FMUs, manual pages and completions as a package for
//! `pip install`; and
//! `cargo xtask man`, the manual pages alone. maturin builds the wheel in a copy of the folder wheel/, with what was
//! built added to it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::check_library::{OLDEST_GLIBC, check_portable};
use crate::fmu::{self, Fmus};
use crate::licences;
use crate::platform::{Platform, rustc_flags};
use crate::python::{self, Python};
use crate::workspace::{Kind, Workspace, capture, run as run_command};

/// The programs in the wheel, and how each is asked for completions and its manual page.
const PROGRAMS: [(&str, &str, &str); 2] =
    [("glidepolar", "completions", "man"), ("tank-reduce", "--completions", "--man")];

/// Shells with completions, and where they look for those of NAME.
const SHELLS: [(&str, &str); 3] = [
    ("bash", "bash-completion/completions/NAME"),
    ("zsh", "zsh/site-functions/_NAME"),
    ("fish", "fish/vendor_completions.d/NAME.fish"),
];

/// Builds the wheel and says where it is.
pub fn run(workspace: &Workspace, kind: Kind) -> Result<PathBuf> {
    let python = python::ensure(workspace)?;
    let scope = if kind == Kind::Release { fmu::Scope::All } else { fmu::Scope::Host };
    let fmus = fmu::run(workspace, &[], scope)?;
    build(workspace, kind, &python, &fmus)
}

/// Builds the wheel around FMUs that are packed already.
pub fn build(workspace: &Workspace, kind: Kind, python: &Python, fmus: &Fmus) -> Result<PathBuf> {
    let (name, out) = match kind {
        Kind::Release => ("release", workspace.target("wheels")),
        Kind::Tests => ("tests", workspace.target("wheel/for-tests")),
    };
    let project = workspace.target("wheel").join(name);
    gather(workspace, &project, kind, fmus)?;

    let mut maturin = workspace.command(python.tool("maturin"));
    maturin.current_dir(&project).arg("build").arg("--out").arg(&out);
    if kind == Kind::Tests {
        maturin.args(["--profile", "dev", "--compatibility", "linux"]);
    } else {
        let host = Platform::host()?;
        maturin.args(["--release", "--target", host.triple]);
        maturin.env("CARGO_ENCODED_RUSTFLAGS", rustc_flags(workspace, host).join("\x1f"));
        if host.is_linux() {
            // maturin then checks that the programs need nothing newer.
            let tag = format!("manylinux_{}", OLDEST_GLIBC.to_string().replace('.', "_"));
            maturin.args(["--zig", "--auditwheel", "check", "--compatibility", &tag]);
        }
    }
    // In the same target folder, where much is there already. zig is the package's, wherever another may be installed.
    maturin.env("CARGO_ZIGBUILD_PYTHON_PATH", python.interpreter()).env("CARGO_TARGET_DIR", workspace.target(""));
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| format!("cannot empty {}", out.display()))?;
    }
    run_command(&mut maturin)?;
    let made = fs::read_dir(&out)?.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    let [wheel] = made.as_slice() else {
        bail!("maturin left {} files in {}, expected one wheel", made.len(), out.display());
    };
    eprintln!("built {} ({} KiB)", workspace.shown(wheel), fs::metadata(wheel)?.len() / 1024);
    Ok(wheel.clone())
}

/// Writes the manual pages of both commands into target/man/.
pub fn man(workspace: &Workspace) -> Result<()> {
    let folder = workspace.target("man/man1");
    build_programs(workspace)?;
    for (name, _, man) in PROGRAMS {
        run_command(program(workspace, name).arg(man).arg(&folder))?;
    }
    eprintln!("the pages are in {}; man -M {} glidepolar", workspace.shown(&folder), workspace.target("man").display());
    Ok(())
}

/// Puts together what maturin packs.
fn gather(workspace: &Workspace, project: &Path, kind: Kind, fmus: &Fmus) -> Result<()> {
    if project.exists() {
        fs::remove_dir_all(project).with_context(|| format!("cannot empty {}", project.display()))?;
    }
    let copy = |from: PathBuf, to: PathBuf| -> Result<()> {
        fs::create_dir_all(to.parent().unwrap_or(project))?;
        fs::copy(&from, &to).with_context(|| format!("cannot copy {}", from.display()))?;
        Ok(())
    };
    copy(workspace.path("wheel/README.md"), project.join("README.md"))?;
    let sources = workspace.path("wheel/python/glidepolar");
    for file in fs::read_dir(&sources)? {
        let file = file?;
        if file.file_type()?.is_file() {
            copy(file.path(), project.join("python/glidepolar").join(file.file_name()))?;
        }
    }
    for file in ["LICENSE-MIT", "LICENSE-APACHE"] {
        copy(workspace.path(file), project.join(file))?;
    }
    let parts = "The programs and the extension module in this package are";
    fs::write(project.join("LICENSES.txt"), licences::notice(workspace, "glidepolar-wheel", parts)?)?;
    // The sources stay where they are; only their description moves.
    let manifest = format!("manifest-path = {:?}", workspace.path("wheel/Cargo.toml").display().to_string());
    let description = fs::read_to_string(workspace.path("wheel/pyproject.toml"))?;
    let description = description.replace("manifest-path = \"Cargo.toml\"", &manifest);
    fs::write(project.join("pyproject.toml"), description)?;

    let share = project.join("data/data/share");
    for fmu in [&fmus.fmi3, &fmus.fmi2, &fmus.space3, &fmus.space2] {
        copy(fmu.clone(), share.join("glidepolar").join(fmu.file_name().unwrap_or_default()))?;
    }
    build_programs(workspace)?;
    for program in programs(workspace, kind)? {
        copy(program.clone(), project.join("data/scripts").join(program.file_name().unwrap_or_default()))?;
    }
    for (name, completions, man) in PROGRAMS {
        capture(program(workspace, name).arg(man).arg(share.join("man/man1")))?;
        for (shell, place) in SHELLS {
            let place = share.join(place.replace("NAME", name));
            fs::create_dir_all(place.parent().unwrap_or(&share))?;
            fs::write(place, capture(program(workspace, name).args([completions, shell]))?)?;
        }
    }
    Ok(())
}

/// Builds both programs as they are packed for those people, `glidepolar` first.
pub fn programs(workspace: &Workspace, kind: Kind) -> Result<Vec<PathBuf>> {
    if kind == Kind::Tests {
        build_programs(workspace)?;
        return Ok(PROGRAMS.iter().map(|(name, ..)| workspace.target("debug").join(executable(name))).collect());
    }
    release_programs(workspace)
}

fn executable(name: &str) -> String {
    format!("{name}{}", std::env::consts::EXE_SUFFIX)
}

/// Builds both programs for others: optimised, without symbols, on Linux against an old C library.
fn release_programs(workspace: &Workspace) -> Result<Vec<PathBuf>> {
    let host = Platform::host()?;
    let is_portable = fmu::build_released(workspace, host, &fmu::PROGRAMS_AND_LIBRARY)?;
    let folder = workspace.target(host.triple).join("release");
    let programs: Vec<PathBuf> = PROGRAMS.iter().map(|(name, ..)| folder.join(executable(name))).collect();
    for program in programs.iter().filter(|_| is_portable) {
        let bytes = fs::read(program).with_context(|| format!("cargo did not leave {}", workspace.shown(program)))?;
        check_portable(&workspace.shown(program).to_string(), &bytes)?;
    }
    Ok(programs)
}

/// Builds both programs as the tests have them.
pub fn build_programs(workspace: &Workspace) -> Result<()> {
    run_command(workspace.cargo_for_all("build").args(["--bin=glidepolar", "--bin=tank-reduce"]))
}

/// One of them, to be run at the checkout's root.
pub fn program(workspace: &Workspace, name: &str) -> Command {
    workspace.command(workspace.target("debug").join(executable(name)))
}
