//! Real files: the Seaglider dives of the folder of measured data (`GLIDEPOLAR_DATA`, else `shared/data` beside the checkout),
//! and the SeaExplorer and Slocum files that `cargo xtask fetch-data` fetches. Without them the tests fail where `CI` is set.

use std::path::{Path, PathBuf};

use glidepolar_flightlog::{Channel, Columns, FlightLog, LogFiles, Piece};

/// The folder of some data; `None`, said aloud, where it is not there.
fn folder(path: PathBuf) -> Option<PathBuf> {
    if path.is_dir() {
        return Some(path);
    }
    assert!(std::env::var_os("CI").is_none(), "no {}", path.display());
    eprintln!("SKIPPED: no {}", path.display());
    None
}

fn measured(name: &str) -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let data = std::env::var_os("GLIDEPOLAR_DATA").map_or_else(|| root.join("../shared/data"), PathBuf::from);
    folder(data.join(name))
}

fn fetched(name: &str) -> Option<PathBuf> {
    folder(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name))
}

/// All files of a folder, the last first.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.reverse();
    files
}

fn whole(paths: &[PathBuf], columns: &Columns) -> (FlightLog, LogFiles) {
    let mut files = LogFiles::open(paths, columns).unwrap_or_else(|error| panic!("{error}"));
    let mut log = FlightLog::default();
    while let Some(piece) = files.next_piece(10_000).unwrap_or_else(|error| panic!("{error}")) {
        if let Piece::Series(piece) = piece {
            log.append(&piece);
        }
    }
    (log, files)
}

#[test]
fn dives_with_clocks_of_their_own_are_one_log() {
    for (name, rows) in [("seaglider_sg171", 1818), ("seaglider_sg236", 3645)] {
        let Some(folder) = measured(name) else { return };
        let (log, files) = whole(&files(&folder), &Columns::default());
        // As many as the five files have on the glider's clock, by netCDF4.
        assert_eq!(log.len(), rows, "{name}");
        assert!(log.column(Channel::Time).windows(2).all(|pair| pair[1] > pair[0]));
        assert!(files.warnings().is_empty(), "{:?}", files.warnings());
        assert!(files.fixes().len() >= 6 && files.calibration().is_some_and(|c| c.mass_kg.is_some()));
        // The CTD of SG236 was off on the descent of dive 4; quality control takes salinities away, temperatures hardly any.
        let with_water = log.column(Channel::Temperature).iter().filter(|value| value.is_finite()).count();
        assert!(5 * with_water > 4 * rows && log.has(Channel::Salinity), "{name}: {with_water}");
    }
}

#[test]
fn the_near_cells_of_the_ad2cp_give_the_speed() {
    let Some(folder) = measured("seaglider_sg171") else { return };
    let mut columns = Columns::default();
    columns.choose(Channel::Speed, "ad2cp");
    let (log, _) = whole(&files(&folder), &columns);
    let mean = |descends: bool| {
        let of_leg =
            |row: &usize| (log.at(Channel::Pitch, *row) < 0.0) == descends && log.at(Channel::Dive, *row) < 5.0;
        let speeds = (0..log.len()).filter(of_leg).map(|row| log.at(Channel::Speed, row));
        let speeds: Vec<f64> = speeds.filter(|speed| speed.is_finite()).collect();
        speeds.iter().sum::<f64>() / speeds.len() as f64
    };
    // Another analysis of dives 1 to 4 found .200 and .320 m/s along the heading; the vertical part, .1 to .2 m/s, adds to
    // them by its square.
    let (dive, climb) = (mean(true), mean(false));
    assert!((0.20..0.27).contains(&dive) && (0.30..0.40).contains(&climb), "{dive} {climb}");
}

#[test]
fn a_mission_of_a_seaexplorer_and_one_of_a_slocum_are_read() {
    let Some(folder) = fetched("pyglider/sea035") else { return };
    let (log, _) = whole(&files(&folder), &Columns::default());
    // pyglider's table of the same files has 5521 rows, all of the CTD; 39 more are of times when it was off.
    assert_eq!(log.len(), 5521 + 39);
    let Some(data) = fetched("dbdreader") else { return };
    let mut columns = Columns::default();
    columns.cache(data.join("cac"));
    let paths = ["amadeus-2014-204-05-000.ebd", "amadeus-2014-204-05-000.dbd"].map(|name| data.join(name));
    let (log, files) = whole(&paths, &columns);
    assert!(
        log.len() > 2500 && log.has(Channel::Ballast) && log.has(Channel::Conductivity) && !files.fixes().is_empty()
    );
}
