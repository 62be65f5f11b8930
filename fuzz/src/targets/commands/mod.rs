//! Ways in through the commands and all that stands behind them: fits, reductions, missions.
//!
//! The command line `glidepolar` is called inside this process. Built only with the feature `commands`.

mod identify;
mod mission;
mod pilot;
mod tank;
mod template;

use std::ffi::OsString;
use std::path::Path;

use clap::Parser;
use glidepolar::cli::Cli;

use crate::Target;

/// Every target of these.
pub const TARGETS: &[Target] = &[
    tank::CAMPAIGN,
    tank::POINTS,
    tank::REDUCTION,
    identify::IDENTIFY,
    pilot::TRACK,
    pilot::CALIBRATION,
    pilot::INPUTS,
    pilot::SWEEP,
    mission::MISSION,
    template::TEMPLATE,
];

/// Does what these words ask; the result goes to a file in `folder`, an error nowhere.
fn glidepolar(folder: &Path, words: &[&str]) {
    let mut line: Vec<OsString> = ["glidepolar"].iter().chain(words).map(OsString::from).collect();
    line.extend(["--force", "--quiet", "--json"].map(OsString::from));
    line.push(folder.join("result.json").into_os_string());
    let cli = Cli::try_parse_from(line).expect("these words are a command");
    if let Err(error) = glidepolar::cli::run(cli) {
        // Messages are made, too.
        drop(error.to_string());
    }
}
