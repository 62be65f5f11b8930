//! Dives of a Seaglider whose instruments have clocks of their own, several of them, and what is wrong with some.

use super::*;
use crate::{LogFiles, Piece};

/// Pressure of the dive at a time: down for 200 s at 0.1 dbar/s.
fn pressure(time: f64) -> f64 {
    2.0 + 0.1 * time
}

/// A dive with a glider's clock of 5 s and a CTD's of 3 s that begins later, and pings of the AD2CP once a minute.
fn dive(number: i32, start_s: f64, c_vbd: f64) -> classic::File {
    let glider: Vec<f64> = (0..41).map(|i| start_s + 5.0 * f64::from(i)).collect();
    let ctd: Vec<f64> = (0..60).map(|i| start_s + 1.5 + 3.0 * f64::from(i)).collect();
    let pings: Vec<f64> = (0..3).map(|i| start_s + 31.0 + 60.0 * f64::from(i)).collect();
    let series =
        |times: &[f64], value: &dyn Fn(f64) -> f64| times.iter().map(|t| value(t - start_s)).collect::<Vec<_>>();
    let since = "seconds since 1970-1-1 00:00:00";
    let on_ctd = [("ctd_data_point", 60)];
    let on_pings = [("ad2cp_data_data_point", 3)];
    let on_cells = [("ad2cp_data_data_point", 3), ("ad2cp_cell_data_point", 5)];
    // Heading 90: the water comes from the east at 0.3 m/s, and from below as fast as the glider sinks. The fifth cell
    // is far off and holds something else.
    let cells = |near: f64| [near, near, near, near, 9.0].repeat(3);
    classic::File::new(41)
        .text("platform_id", "SG171")
        .attribute("dive_number", number)
        .variable("time", since, &glider)
        .variable("pressure", "dbar", &series(&glider, &pressure))
        .variable("eng_pitchAng", "degrees", &series(&glider, &|t| -20.0 - 0.01 * t))
        .variable("eng_rollAng", "degrees", &series(&glider, &|_| 5.0))
        .variable("eng_head", "degrees", &series(&glider, &|t| (359.0 + 0.01 * t) % 360.0))
        .variable("eng_vbdCC", "", &series(&glider, &|_| -150.0))
        .with_moves(&[(start_s + 100.0, start_s + 104.0)])
        .variable_on(&on_ctd, "ctd_time", since, &ctd)
        .variable_on(&on_ctd, "ctd_pressure", "dbar", &series(&ctd, &|t| pressure(t) + 0.4))
        .variable_on(&on_ctd, "temperature", "degrees_Celsius", &series(&ctd, &|t| 12.0 - 0.01 * t))
        .variable_on(&on_ctd, "salinity", "1e-3", &series(&ctd, &|_| 33.0))
        .variable_on(&on_pings, "ad2cp_time", since, &pings)
        .variable_on(&on_pings, "ad2cp_heading", "degrees", &[90.0; 3])
        .variable_on(&on_pings, "ad2cp_pitch", "degrees", &[-20.0, -20.0, -80.0])
        .variable_on(&on_pings, "ad2cp_roll", "degrees", &[5.0; 3])
        .variable_on(&on_cells, "ad2cp_velX", "m/s", &cells(-0.3))
        .variable_on(&on_cells, "ad2cp_velY", "m/s", &cells(0.0))
        .variable_on(&on_cells, "ad2cp_velZ", "m/s", &cells(0.0995))
        .variable_on(&[("gps_info", 2)], "log_gps_time", since, &[start_s - 30.0, start_s + 300.0])
        .variable_on(&[("gps_info", 2)], "log_gps_lat", "degrees_north", &[47.7, 47.8])
        .variable_on(&[("gps_info", 2)], "log_gps_lon", "degrees_east", &[-122.4, -122.5])
        .variable_on(&[], "sg_cal_mass", "kg", &[56.406])
        .variable_on(&[], "sg_cal_volmax", "m^3", &[55_775.4])
        .variable_on(&[], "sg_cal_hd_a", "", &[0.004])
        .variable_on(&[], "log_RHO", "", &[1.023])
        .variable_on(&[], "log_C_VBD", "", &[c_vbd])
        .variable_on(&[], "log_VBD_MIN", "", &[500.0])
        .variable_on(&[], "log_VBD_CNV", "", &[-0.2453])
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Folder(tempfile::tempdir().expect("a folder"))
    }

    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).expect("a file");
        path
    }
}

fn whole(paths: &[PathBuf], columns: &Columns) -> Result<(FlightLog, LogFiles), InputError> {
    let mut files = LogFiles::open(paths, columns)?;
    let mut log = FlightLog::default();
    while let Some(piece) = files.next_piece(1000)? {
        match piece {
            Piece::Series(piece) => log.append(&piece),
            Piece::Glides(_) => panic!("a time series"),
        }
    }
    Ok((log, files))
}

fn speed_of_ad2cp() -> Columns {
    let mut columns = Columns::default();
    columns.choose(Channel::Speed, "ad2cp");
    columns
}

#[test]
fn each_instrument_is_read_by_its_own_clock() {
    let file = OneFile::new("p1710003.nc", &dive(3, 1.7e9, 3230.0).bytes());
    let log = file.series().unwrap();
    assert_eq!(log.len(), 41);
    for row in 1..36 {
        let t = log.at(Channel::Time, row) - 1.7e9;
        assert!((log.at(Channel::Pressure, row) - pressure(t)).abs() < 1e-9, "the glider's own pressure");
        assert!((log.at(Channel::Temperature, row) - (12.0 - 0.01 * t)).abs() < 1e-6, "row {row}");
        assert!((log.at(Channel::Pitch, row) - (-20.0 - 0.01 * t).to_radians()).abs() < 1e-9);
        assert!((log.at(Channel::Salinity, row) - 33.0).abs() < 1e-12);
    }
    // The CTD began later and ended earlier: nothing is made up there.
    assert!(log.at(Channel::Temperature, 0).is_nan() && log.at(Channel::Temperature, 40).is_nan());
    assert_eq!(log.column(Channel::MotorMoving).iter().filter(|moving| **moving > 0.5).count(), 4);
    let since = log.column(Channel::SinceMove);
    assert!(since[19].is_nan(), "before the first move");
    assert_eq!(since[20..23], [0.0, 1.0, 6.0], "a move of four seconds");
}

#[test]
fn pressure_on_the_ctds_clock_only_makes_that_the_clock_of_the_log() {
    let start_s = 1.7e9;
    let glider: Vec<f64> = (0..41).map(|i| start_s + 5.0 * f64::from(i)).collect();
    let ctd: Vec<f64> = (0..60).map(|i| start_s + 1.5 + 3.0 * f64::from(i)).collect();
    let heading: Vec<f64> = glider.iter().map(|t| (359.0 + 0.01 * (t - start_s)) % 360.0).collect();
    let ballast: Vec<f64> = glider.iter().map(|t| -150.0 + (t - start_s)).collect();
    let bytes = classic::File::new(41)
        .variable("time", "seconds since 1970-1-1", &glider)
        .variable("eng_pitchAng", "degrees", &[-20.0; 41])
        .variable("eng_head", "degrees", &heading)
        .variable("eng_vbdCC", "", &ballast)
        .variable_on(&[("ctd_data_point", 60)], "ctd_time", "seconds since 1970-1-1", &ctd)
        .variable_on(
            &[("ctd_data_point", 60)],
            "ctd_pressure",
            "dbar",
            &ctd.iter().map(|t| t - start_s).collect::<Vec<_>>(),
        )
        .bytes();
    let log = OneFile::new("p1710003.nc", &bytes).series().unwrap();
    assert_eq!(log.column(Channel::Time), ctd);
    for (row, time) in ctd.iter().enumerate() {
        let t = time - start_s;
        assert!((log.at(Channel::Ballast, row) - (-150.0 + t)).abs() < 1e-6);
        let found = log.at(Channel::Heading, row).to_degrees();
        assert!((found - (359.0 + 0.01 * t) % 360.0).abs() < 1e-6, "{found} at {t}: the short way round");
    }
}

#[test]
fn the_speed_of_the_near_cells_stands_at_its_own_times() {
    let file = OneFile::new("p1710003.nc", &dive(3, 1.7e9, 3230.0).bytes());
    let (log, files) = whole(std::slice::from_ref(&file.path), &speed_of_ad2cp()).unwrap();
    let speeds: Vec<(f64, f64)> = (0..log.len())
        .map(|row| (log.at(Channel::Time, row) - 1.7e9, log.at(Channel::Speed, row)))
        .filter(|(_, speed)| speed.is_finite())
        .collect();
    // Three pings, the last of a glider that stands on its nose; 31 s and 91 s are nearest to rows at 30 s and 90 s.
    assert_eq!(speeds.iter().map(|(t, _)| *t).collect::<Vec<_>>(), [30.0, 90.0]);
    for (_, speed) in speeds {
        assert!((speed - 0.3f64.hypot(0.0995)).abs() < 1e-9, "{speed}");
    }
    assert!(
        files.notes().iter().any(|note| note.contains("1 of 3 pings") && note.contains("tilted")),
        "{:?}",
        files.notes()
    );
}

#[test]
fn an_ad2cp_whose_beams_are_wrong_is_reported() {
    let mut file = dive(3, 1.7e9, 3230.0).bytes();
    // Vertical velocity of the other sign: the glider would climb while it sinks.
    let (from, to) = (0.0995f64.to_be_bytes(), (-0.0405f64).to_be_bytes());
    for at in 0..file.len() - 8 {
        if file[at..at + 8] == from {
            file[at..at + 8].copy_from_slice(&to);
        }
    }
    let file = OneFile::new("p1710003.nc", &file);
    let error = whole(std::slice::from_ref(&file.path), &speed_of_ad2cp()).err().expect("no speed is left");
    assert!(error.to_string().contains("no speed"), "{error}");
}

#[test]
fn dives_in_any_order_are_one_log_counted_from_one_ballast_zero() {
    let folder = Folder::new();
    let first = folder.write("p1710001.nc", &dive(1, 1.7e9, 3000.0).bytes());
    let second = folder.write("p1710002.nc", &dive(2, 1.7e9 + 1000.0, 3230.0).bytes());
    let (log, files) = whole(&[second.clone(), first, second.clone()], &Columns::default()).unwrap();
    assert_eq!(log.len(), 82);
    assert!(log.column(Channel::Time).windows(2).all(|pair| pair[1] > pair[0]));
    assert_eq!((log.at(Channel::Dive, 0), log.at(Channel::Dive, 81)), (1.0, 2.0));
    // 230 counts of 0.2453 cc lie between the two zeros.
    assert!((log.at(Channel::Ballast, 0) - (-150.0 + 230.0 * 0.2453)).abs() < 1e-9);
    assert_eq!(log.at(Channel::Ballast, 81), -150.0);
    assert!(
        files.notes().iter().any(|note| note.contains("C_VBD 3000") && note.contains("+56.4")),
        "{:?}",
        files.notes()
    );
    assert!(files.warnings().iter().any(|warning| warning.contains("named twice")), "{:?}", files.warnings());
    let calibration = files.calibration().unwrap();
    assert_eq!((calibration.glider.as_str(), calibration.dive), ("SG171", Some(2.0)));
    assert_eq!((calibration.mass_kg, calibration.hd_a), (Some(56.406), Some(0.004)));
    assert!((calibration.volmax_m3.unwrap() - 0.055_775_4).abs() < 1e-12);
    assert_eq!(files.fixes().len(), 4);
    assert_eq!((files.fixes()[0].lat_deg, files.fixes()[0].lon_deg), (47.7, -122.4));
}

#[test]
fn files_of_two_gliders_are_refused_and_a_damaged_one_among_sound_ones_is_left_out() {
    let folder = Folder::new();
    let own = folder.write("p1710001.nc", &dive(1, 1.7e9, 3000.0).bytes());
    let bytes: Vec<u8> = dive(1, 1.8e9, 3000.0).bytes();
    let at = bytes.windows(5).position(|window| window == b"SG171").unwrap();
    let mut renamed = bytes.clone();
    renamed[at..at + 5].copy_from_slice(b"SG542");
    let other = folder.write("p5420001.nc", &renamed);
    let error = whole(&[own.clone(), other], &Columns::default()).err().expect("two gliders").to_string();
    assert!(error.contains("SG542") && error.contains("SG171") && error.contains("p5420001.nc"), "{error}");

    let cut = folder.write("p1710002.nc", &bytes[..bytes.len() / 2]);
    let empty = folder.write("p1710004.nc", b"");
    let (log, files) = whole(&[cut.clone(), own, empty.clone()], &Columns::default()).unwrap();
    assert_eq!(log.len(), 41, "what is sound is read");
    for name in ["p1710002.nc", "p1710004.nc"] {
        assert!(files.warnings().iter().any(|warning| warning.contains(name)), "{:?}", files.warnings());
    }
    let error = whole(&[cut, empty], &Columns::default()).err().expect("nothing sound");
    assert!(error.to_string().contains("p1710002.nc"), "{error}");
    assert!(whole(&[folder.0.path().join("p9990001.nc")], &Columns::default()).is_err());
}

#[test]
fn a_dive_without_a_ctd_is_reported_and_keeps_the_rest() {
    let glider: Vec<f64> = (0..41).map(|i| 1.7e9 + 5.0 * f64::from(i)).collect();
    let bytes = classic::File::new(41)
        .variable("time", "seconds since 1970-1-1", &glider)
        .variable("eng_depth", "cm", &glider.iter().map(|t| 10.0 * (t - 1.7e9)).collect::<Vec<_>>())
        .variable("eng_pitchAng", "degrees", &[-20.0; 41])
        .variable("eng_vbdCC", "", &[-100.0; 41])
        .bytes();
    let file = OneFile::new("p1710009.nc", &bytes);
    let (log, files) = whole(std::slice::from_ref(&file.path), &Columns::default()).unwrap();
    assert!((log.at(Channel::Pressure, 40) - 20.0 * 1.0055).abs() < 1e-9);
    assert!(!log.has(Channel::Temperature));
    assert!(
        files.notes().iter().any(|note| note.contains("p1710009.nc") && note.contains("CTD")),
        "{:?}",
        files.notes()
    );
}
