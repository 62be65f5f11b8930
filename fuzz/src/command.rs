//! The command line `glidepolar`, called inside this process.

use std::ffi::OsString;
use std::path::Path;

use clap::Parser;
use glidepolar::cli::Cli;

/// Does what these words ask; the result goes to a file in `folder`, an error nowhere.
pub fn glidepolar(folder: &Path, words: &[&str]) {
    let mut line: Vec<OsString> = ["glidepolar"].iter().chain(words).map(OsString::from).collect();
    line.extend(["--force", "--quiet", "--json"].map(OsString::from));
    line.push(folder.join("result.json").into_os_string());
    let cli = Cli::try_parse_from(line).expect("these words are a command");
    if let Err(error) = glidepolar::cli::run(cli) {
        // Messages are made, too.
        drop(error.to_string());
    }
}
