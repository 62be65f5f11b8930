//! The diagnosis on logs whose hidden effect it does not know: the virtual sea draws size and sign from a seed and hands
//! over files alone. A fixed selection; the whole table of confusions is `confusions.rs`.

use std::path::Path;

use glidepolar::diagnose::Diagnosis;
use glidepolar::diagnose::sea::{Request, SeaDiagnosis, diagnose_vehicle};
use glidepolar::reading;
use glidepolar::vehicle::Vehicle;
use glidepolar_virtual_sea::ocean::Weather;
use glidepolar_virtual_sea::{Options, Sea};

/// Effects that the diagnosis must name with measured speed, in every run of the tests.
const ALWAYS_NAMED: &[&str] = &[
    "ballast_offset",
    "hull_compressibility",
    "thermal_expansion",
    "ballast_scale",
    "pitch_offset",
    "pitch_scale",
    "drag_growth",
    "drag_step",
    "net_mass_step",
    "reynolds_drag",
    "climb_dive_asymmetry",
    "trapped_air",
    "leak",
    "vertical_current",
    "density_at_zero_pressure",
    "density_bias",
];

/// Every mechanism that has a size, and the density at p = 0: the rows of the table.
fn catalogued() -> Vec<&'static str> {
    let has_size = |mechanism: &&glidepolar::mechanisms::Mechanism| !mechanism.parameters.is_empty();
    let all = glidepolar::mechanisms::AT_SEA.iter().chain(glidepolar::mechanisms::LATERAL);
    all.filter(has_size).map(|mechanism| mechanism.name).chain(["density_at_zero_pressure"]).collect()
}

#[test]
fn every_mechanism_that_has_a_size_can_be_hidden() {
    for name in catalogued() {
        let requests = glidepolar_virtual_sea::catalogue::parse_requests(name);
        assert!(requests.is_ok(), "{name} is no effect of the virtual sea: {requests:?}");
    }
}

/// Hides an effect, writes the files, reads them back and asks; with the true parameters of a mechanism that has any.
fn blind(effect: &str, seed: u64, speed: bool) -> (Diagnosis, Vec<(&'static str, f64)>) {
    let effects = glidepolar_virtual_sea::catalogue::parse_requests(effect).expect("an effect of the virtual sea");
    let sea = glidepolar_virtual_sea::generate(&Options { effects, speed, ..Options::seeded(seed) });
    let mechanism = glidepolar::mechanisms::at_sea(effect).filter(|_| catalogued().contains(&effect));
    let parameters = mechanism.iter().flat_map(|mechanism| mechanism.parameters);
    let sizes = parameters.filter_map(|parameter| Some((*parameter, sea.truth.parameter(parameter)?))).collect();
    (diagnosed(&sea), sizes)
}

/// Writes the files, reads them back and asks.
fn diagnosed(sea: &Sea) -> Diagnosis {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("log.csv"), sea.log.to_csv()).expect("the log");
    std::fs::write(folder.path().join("vehicle.toml"), &sea.vehicle_toml).expect("the vehicle");
    ask(folder.path()).expect("a diagnosis")
}

/// What a user's `glidepolar diagnose log.csv --vehicle vehicle.toml` does.
fn ask(folder: &Path) -> Result<Diagnosis, String> {
    in_full(folder).map(|(_, found)| found.outcome.diagnosis)
}

fn in_full(folder: &Path) -> Result<(Vehicle, SeaDiagnosis), String> {
    let vehicle = Vehicle::load(&folder.join("vehicle.toml").to_string_lossy()).expect("a vehicle");
    let log = reading::read(&[folder.join("log.csv")], &vehicle, &reading::Request::default());
    let observations = log.map_err(|error| error.to_string())?.observations;
    diagnose_vehicle(&vehicle, &observations, &Request::default()).map_err(|error| error.to_string())
}

/// The name that stands first, or what is said instead of one.
fn first(found: &Diagnosis) -> String {
    match (found.causes.first(), &found.unexplained) {
        (Some(cause), _) => cause.cause.clone(),
        (None, Some(_)) => "unexplained".to_owned(),
        (None, None) => "none".to_owned(),
    }
}

#[test]
fn with_measured_speed_the_hidden_effect_is_named() {
    let wrong: Vec<String> = ALWAYS_NAMED
        .iter()
        .filter_map(|effect| {
            let (found, _) = blind(effect, 11, true);
            let name = first(&found);
            (name != *effect).then(|| format!("{effect} was called {name}"))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("; "));
}

#[test]
fn a_jump_in_the_middle_of_a_leg_is_found_to_some_minutes() {
    for (step, time, seed) in [
        ("drag_step", "step_time_s", 12),
        ("drag_step", "step_time_s", 13),
        ("net_mass_step", "net_mass_step_time_s", 12),
        ("net_mass_step", "net_mass_step_time_s", 13),
    ] {
        let (found, sizes) = blind(step, seed, true);
        let cause = found.causes.first().expect("a cause");
        assert_eq!(cause.cause, step, "seed {seed}");
        for (parameter, size) in sizes {
            let estimate = &cause.parameters[parameter];
            assert!((estimate.value - size).abs() < 3.0 * estimate.se, "seed {seed}: {parameter} {size}: {estimate:?}");
        }
        // A leg takes some 25 minutes.
        let [from_s, to_s] = cause.parameters[time].ci95;
        assert!(to_s - from_s < 600.0, "seed {seed}: {from_s} to {to_s}");
    }
}

#[test]
fn where_nothing_is_hidden_nothing_is_named() {
    for seed in [21, 22] {
        assert_eq!(first(&blind("none", seed, true).0), "none", "seed {seed}");
    }
}

/// A thermocline of some metres, passed in half a minute on every leg, is no effect.
#[test]
fn on_a_shelf_in_summer_nothing_is_named_either() {
    for seed in [2, 4] {
        let weather = Weather { shelf: true, ..Weather::default() };
        let options = Options { weather, hours: 36.0, dives: 260, ..Options::seeded(seed) };
        let name = first(&diagnosed(&glidepolar_virtual_sea::generate(&options)));
        assert_eq!(name, "none", "seed {seed}");
    }
}

/// A log some of whose columns are spoilt: what the way from the glider to the desk could have done to it.
fn spoilt(effect: &str, hours: f64, change: impl Fn(&str, &str) -> String) -> Result<Diagnosis, String> {
    let effects = glidepolar_virtual_sea::catalogue::parse_requests(effect).expect("an effect of the virtual sea");
    let dives = (hours * 14.0 / 12.0) as u32;
    let sea = glidepolar_virtual_sea::generate(&Options { effects, hours, dives, ..Options::seeded(41) });
    let csv = sea.log.to_csv();
    let header: Vec<&str> = csv.lines().next().expect("a header").split(',').collect();
    let mut spoilt = header.join(",") + "\n";
    for line in csv.lines().skip(1) {
        let cells: Vec<String> = line.split(',').zip(&header).map(|(cell, name)| change(name, cell)).collect();
        spoilt += &(cells.join(",") + "\n");
    }
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("log.csv"), spoilt).expect("the log");
    std::fs::write(folder.path().join("vehicle.toml"), &sea.vehicle_toml).expect("the vehicle");
    ask(folder.path())
}

/// A cell of one column, times a factor.
fn times(column: &'static str, factor: f64) -> impl Fn(&str, &str) -> String {
    move |name, cell| match cell.parse::<f64>() {
        Ok(value) if name == column => (value * factor).to_string(),
        _ => cell.to_owned(),
    }
}

#[test]
fn a_log_that_contradicts_itself_is_refused_with_what_is_wrong() {
    let cases = [
        ("pitch_rad", 57.3, "unit of pitch"),
        ("pitch_rad", 0.01, "unit of pitch"),
        ("pitch_rad", -1.0, "sign of pitch"),
        ("vbd_cc", -1.0, "sign of ballast volume"),
        ("vbd_cc", 1e-6, "unit of ballast volume"),
        ("time_s", 1e3, "time base"),
        ("pressure_dbar", 0.1, "density"),
        ("salinity_psu", 0.5, "density"),
    ];
    let failed: Vec<String> = cases
        .into_iter()
        .filter_map(|(column, factor, expected)| match spoilt("none", 3.0, times(column, factor)) {
            Err(error) if error.contains("contradicts itself") && error.contains(expected) => None,
            other => Some(format!("{column} times {factor}: {:?}", other.map(|found| first(&found)))),
        })
        .collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn without_salinity_a_density_at_zero_pressure_is_grouped_with_the_hull() {
    let blank = |name: &str, cell: &str| if name == "salinity_psu" { String::new() } else { cell.to_owned() };
    let found = spoilt("density_at_zero_pressure", 12.0, blank).expect("a diagnosis");
    let cause = found.causes.first().expect("a cause");
    assert_eq!(cause.cause, "hull_compressibility");
    assert!(cause.indistinguishable_from.iter().any(|name| name == "density_at_zero_pressure"), "{cause:?}");
}

/// A line that reaches to the surface adds drag with depth, for which the catalogue has no name. The extension carries it as a
/// table, predicts held-out glides better by it, and is itself without that fault: the vehicle file, the simulation and the
/// FMU read the same parameters.
#[test]
fn what_has_no_name_is_carried_as_a_table() {
    let effects = glidepolar_virtual_sea::catalogue::parse_requests("uncatalogued-tether=0.4").expect("an effect");
    let sea = glidepolar_virtual_sea::generate(&Options { effects, ..Options::seeded(51) });
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("log.csv"), sea.log.to_csv()).expect("the log");
    std::fs::write(folder.path().join("vehicle.toml"), &sea.vehicle_toml).expect("the vehicle");
    let (vehicle, found) = in_full(folder.path()).expect("a diagnosis");
    let diagnosis = &found.outcome.diagnosis;
    let table = diagnosis.empirical.as_ref().unwrap_or_else(|| panic!("no table: {diagnosis:?}"));
    assert!(table.gain.reduction_percent > 10.0 && table.gain.ci95[0] > 0.0, "{table:?}");
    assert!(diagnosis.gain.reduction_percent > 5.0, "{:?}", diagnosis.gain);

    let extended = glidepolar::diagnose::sea::extended(&vehicle, &found).expect("an extended vehicle");
    std::fs::write(folder.path().join("vehicle.toml"), extended.to_toml()).expect("the extended vehicle");
    let read = Vehicle::load(&folder.path().join("vehicle.toml").to_string_lossy()).expect("the same vehicle");
    assert_eq!(read.glide_parameters().empirical_value_5, table.values[4]);
    assert_ne!(read.parameters().expect("all keys").empirical_acts_on, 0.0);
}
