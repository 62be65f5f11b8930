//! Causes of turning that the virtual sea hides, each in a log that is read as any other.

use glidepolar_flightlog::{Observation, PreparationSettings};
use glidepolar_virtual_sea::truth::Truth;
use glidepolar_virtual_sea::vehicle::Hull;
use glidepolar_virtual_sea::{Options, catalogue, generate};

use super::logs;

/// A log in which the virtual sea hides an effect (`static_list=0.0873`), and its truth.
pub fn log(effect: &str, hull: Hull, seed: u64) -> (Vec<Observation>, Truth) {
    let effects = catalogue::parse_requests(effect).expect("an effect of the virtual sea");
    let sea = generate(&Options { effects, hull: Some(hull), lateral: true, ..Options::seeded(seed) });
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("log.csv");
    std::fs::write(&path, sea.log.to_csv()).expect("the log");
    (logs::read(&[path], PreparationSettings::default()), sea.truth)
}
