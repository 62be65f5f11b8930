//! The command line.

mod demo_cli;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Hull tests in a towing tank: raw balance runs to coefficients.
#[derive(Debug, Parser)]
#[command(name = "tank-reduce", version, about, args_conflicts_with_subcommands = true, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo_cli::DemoArgs),
}

fn main() -> ExitCode {
    let Command::Demo(args) = Cli::parse().command;
    match demo_cli::run(args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("tank-reduce demo: {error}");
            ExitCode::from(2)
        }
    }
}
