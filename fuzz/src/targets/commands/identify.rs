//! A flight log, and the polar from it.

use super::glidepolar;
use crate::Target;
use crate::files::Folder;
use crate::targets::logs::logs;

pub const IDENTIFY: Target = Target {
    name: "identify",
    what: "a flight log in CSV, and the polar from it",
    run: identify,
    seeds: logs,
    catches_panics: false,
};

fn identify(data: &[u8]) {
    let folder = Folder::new();
    let log = folder.write("log.csv", data);
    let log = log.to_string_lossy();
    glidepolar(folder.root(), &["identify", &log, "--vehicle", "slocum-049", "--density", "1026"]);
}
