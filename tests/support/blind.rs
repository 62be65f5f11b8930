//! What the program answers on a virtual log, as a user would ask: from files.

use glidepolar::diagnose::Diagnosis;
use glidepolar::diagnose::sea::{Request, diagnose_vehicle};
use glidepolar::reading;
use glidepolar::vehicle::Vehicle;

/// What `glidepolar diagnose log.csv --vehicle vehicle.toml` answers; `None` where the log holds too little steady glide.
///
/// # Panics
/// Where the vehicle cannot be read, or nothing can be written below the folder for temporary files.
pub fn diagnosed(log_csv: &str, vehicle_toml: &str) -> Option<Diagnosis> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("log.csv"), log_csv).expect("the log");
    std::fs::write(path("vehicle.toml"), vehicle_toml).expect("the vehicle");
    let vehicle = Vehicle::load(&path("vehicle.toml").to_string_lossy()).expect("a vehicle");
    let log = reading::read(&[path("log.csv")], &vehicle, &reading::Request::default()).ok()?;
    let found = diagnose_vehicle(&vehicle, &log.observations, &Request::default());
    found.ok().map(|(_, found)| found.outcome.diagnosis)
}
