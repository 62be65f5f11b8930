//! Speed, cost and scale, measured side by side with other programs: what `cargo xtask bench` builds and runs.
//!
//! Each part of [`parts`] measures one thing that the project does against what else could be used for it, in rounds in
//! which all take turns ([`contest`]), and leaves rows of medians and ratios in a [`report::Part`]. [`page`] prints them
//! and writes docs/evidence/benchmarks.md. A part that fails, or a program that is not there, is said in its row; the rest goes on.
//!
//! Nothing here is a test: no time makes anything fail. Only a short run fails where a part cannot be measured at all.

mod arguments;
mod child;
mod contest;
mod data;
mod figure;
mod fmi;
mod machine;
mod page;
mod parts;
mod peer;
mod report;
mod workers;

use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Task};

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let done = match &arguments.task {
        Task::Run(run) => parts::run_all(run),
        Task::Work(work) => workers::run(work),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
