//! The command `tank-reduce`; what it does is in [`glidepolar_tank`].

mod cli;
mod demo_cli;

use std::process::ExitCode;

use clap::Parser;
use glidepolar_terminal::{begin, on_terminal, show};

fn main() -> ExitCode {
    begin();
    let cli = cli::Cli::parse();
    match on_terminal(|| cli.run()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            show(&error);
            error.exit_code()
        }
    }
}
