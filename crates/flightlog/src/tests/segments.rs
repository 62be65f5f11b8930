//! Segments of Slocum and SeaExplorer gliders: the files of two computers become one log.

use super::*;
use crate::{LogFiles, Piece};

pub(super) struct Folder(tempfile::TempDir);

impl Folder {
    pub(super) fn new() -> Self {
        Folder(tempfile::tempdir().expect("a folder"))
    }

    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).expect("a file");
        path
    }
}

pub(super) fn whole(paths: &[PathBuf], columns: &Columns) -> Result<(FlightLog, LogFiles), InputError> {
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

/// A Slocum's file whose sensors are all new in each row, eight bytes each.
pub(super) fn dbd(name: &str, extension: &str, sensors: &[(&str, &str)], rows: &[Vec<f64>]) -> Vec<u8> {
    let n = sensors.len();
    let list: String =
        sensors.iter().enumerate().map(|(i, (name, unit))| format!("s: T {i:4} {i:4} 8 {name} {unit}\n")).collect();
    let mut crc = u32::MAX;
    for byte in list.bytes() {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
        }
    }
    let mut bytes = format!(
        "dbd_label: DBD(dinkum_binary_data)file\nencoding_ver: 5\nnum_ascii_tags: 14\nall_sensors: F\n\
         the8x3_filename: 01600000\nfull_filename: {name}\nfilename_extension: {extension}\nmission_name: a.mi\n\
         fileopen_time: Sun_Sep_13_12:26:40_2020\ntotal_num_sensors: {n}\nsensors_per_cycle: {n}\n\
         state_bytes_per_cycle: {}\nsensor_list_crc: {crc:08x}\nsensor_list_factored: 0\n{list}",
        n.div_ceil(4)
    )
    .into_bytes();
    bytes.extend(b"sa\x34\x12");
    bytes.extend(123.456f32.to_le_bytes());
    bytes.extend(123_456_789.123_45f64.to_le_bytes());
    for row in rows {
        bytes.push(b'd');
        // Two bits of each sensor: new.
        for byte in 0..n.div_ceil(4) {
            bytes.push((0..4).filter(|i| 4 * byte + i < n).map(|i| 2u8 << (6 - 2 * i)).sum());
        }
        row.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
    }
    bytes.push(b'X');
    bytes
}

pub(super) const START_S: f64 = 1.6e9;

/// Flight and science file of one segment: 4 s and 1 s between rows, the CTD off after 300 s.
pub(super) fn segment(name: &str, start_s: f64) -> (Vec<u8>, Vec<u8>) {
    let flight = [
        ("m_present_time", "timestamp"),
        ("m_pitch", "rad"),
        ("m_ballast_pumped", "cc"),
        ("m_de_oil_vol", "cc"),
        ("m_battpos", "in"),
        ("m_heading", "rad"),
        ("m_pressure", "bar"),
        ("m_gps_lat", "lat"),
        ("m_gps_lon", "lon"),
    ];
    // The first cycle has what was last read before, at the time when the file was opened.
    let stale = vec![start_s - 2.0, 1.3, 0.0, 500.0, 9.0, 1.0, 60.0, 5400.6, -730.0];
    let rows = (0..200).map(|i| {
        let t = 4.0 * f64::from(i);
        vec![start_s + t, -0.4 - 1e-4 * t, 0.0, -200.0 + 0.1 * t, 0.5, 6.2 + 0.001 * t, 0.02 * t, 5430.6, -730.0]
    });
    let rows: Vec<Vec<f64>> = std::iter::once(stale).chain(rows).collect();
    let science = [
        ("sci_m_present_time", "timestamp"),
        ("sci_water_pressure", "bar"),
        ("sci_water_temp", "degC"),
        ("sci_water_cond", "S/m"),
    ];
    let stale = vec![start_s - 1.0, 60.0, 30.0, 0.0];
    let science_rows = (0..300).map(|i| {
        let t = 0.25 + f64::from(i);
        vec![start_s + t, 0.02 * t + 0.01, 15.0 - 0.01 * t, 4.0]
    });
    let science_rows: Vec<Vec<f64>> = std::iter::once(stale).chain(science_rows).collect();
    (dbd(name, "dbd", &flight, &rows), dbd(name, "ebd", &science, &science_rows))
}

#[test]
fn flight_and_science_files_of_a_slocum_are_one_log() {
    let folder = Folder::new();
    let (flight, science) = segment("unit_1-2020-257-0-0", START_S);
    let (flight, science) = (folder.write("a.dbd", &flight), folder.write("a.ebd", &science));
    let (log, files) = whole(&[science, flight], &Columns::default()).unwrap();
    // 300 rows of the CTD; its glider's own sensor where it was off.
    assert_eq!(log.len(), 300 + 1 + 125);
    for row in 0..log.len() {
        let t = log.at(Channel::Time, row) - START_S;
        let own = if (0.2..299.5).contains(&t) { 0.1 } else { 0.0 };
        assert!((log.at(Channel::Pressure, row) - (0.2 * t + own)).abs() < 1e-6, "bar at {t}");
        assert!((log.at(Channel::Pitch, row) - (-0.4 - 1e-4 * t)).abs() < 1e-9);
        // Of two ballast sensors the one that moves.
        assert!((log.at(Channel::Ballast, row) - (-200.0 + 0.1 * t)).abs() < 1e-6);
        assert!((log.at(Channel::BatteryPosition, row) - 0.0127).abs() < 1e-9);
        let heading = (6.2 + 0.001 * t).rem_euclid(std::f64::consts::TAU);
        assert!((log.at(Channel::Heading, row) - heading).abs() < 1e-6);
    }
    assert!((log.at(Channel::Temperature, 100) - (15.0 - 0.01 * (log.at(Channel::Time, 100) - START_S))).abs() < 1e-6);
    let fixes = files.fixes();
    assert_eq!(
        fixes.len(),
        1,
        "the last position is written again and again, and that of the first cycle is of before"
    );
    assert_eq!(fixes[0].time_s, START_S);
    assert!((fixes[0].lat_deg - 54.51).abs() < 1e-9 && (fixes[0].lon_deg + 7.5).abs() < 1e-9);
    assert!(files.warnings().is_empty(), "{:?}", files.warnings());
}

#[test]
fn a_position_that_a_slocum_repeats_from_the_segment_before_is_no_fix() {
    let folder = Folder::new();
    let sensors = [
        ("m_present_time", "s"),
        ("m_depth", "m"),
        ("m_gps_lat", "lat"),
        ("m_gps_lon", "lon"),
        ("m_gps_status", "enum"),
    ];
    let rows = |start_s: f64, positions: &[(f64, f64)]| -> Vec<Vec<f64>> {
        let row = |(i, (lat, status)): (usize, &(f64, f64))| vec![start_s + 4.0 * i as f64, 1.0, *lat, -730.0, *status];
        positions.iter().enumerate().map(row).collect()
    };
    // At first 69696969, which is no position; then the same cycle twice, a bad one, two good ones.
    let first = rows(START_S, &[(69_696_969.0, 69.0), (5430.6, 0.0), (5430.6, 0.0)]);
    let second = rows(START_S + 700.0, &[(5430.6, 0.0), (5430.6, 0.0), (5431.2, 3.0), (5431.8, 0.0), (5431.8, 0.0)]);
    let later = |bytes: Vec<u8>| {
        let text = String::from_utf8_lossy(&bytes[..600]).replace("12:26:40", "12:38:20");
        [text.as_bytes(), &bytes[600..]].concat()
    };
    let paths = [
        folder.write("a.dbd", &dbd("unit_1-2020-257-0-0", "dbd", &sensors, &first)),
        folder.write("b.dbd", &later(dbd("unit_1-2020-257-0-1", "dbd", &sensors, &second))),
    ];
    let (_, files) = whole(&paths, &Columns::default()).unwrap();
    let times: Vec<f64> = files.fixes().iter().map(|fix| fix.time_s - START_S).collect();
    assert_eq!(times, [4.0, 712.0]);
}

#[test]
fn segments_come_in_order_and_the_fuller_record_of_one_is_taken() {
    let folder = Folder::new();
    let (first, _) = segment("unit_1-2020-257-0-0", START_S);
    let (second, _) = segment("unit_1-2020-257-0-1", START_S + 700.0);
    let later = String::from_utf8_lossy(&second[..600]).replace("12:26:40", "12:38:20").into_bytes();
    let later = [&later[..], &second[600..]].concat();
    let sparse = dbd("unit_1-2020-257-0-0", "sbd", &[("m_present_time", "s"), ("m_depth", "m")], &[vec![START_S, 1.0]]);
    let paths = [folder.write("b.dbd", &later), folder.write("a.sbd", &sparse), folder.write("a.dbd", &first)];
    let (log, files) = whole(&paths, &Columns::default()).unwrap();
    assert!(log.column(Channel::Time).windows(2).all(|pair| pair[1] > pair[0]), "the overlap is taken once");
    assert_eq!(log.at(Channel::Time, 0), START_S);
    assert!(files.warnings().iter().any(|warning| warning.contains("a.sbd")), "{:?}", files.warnings());
    // Another glider.
    let (other, _) = segment("dora-2020-257-0-0", START_S);
    let error =
        whole(&[paths[2].clone(), folder.write("c.dbd", &other)], &Columns::default()).err().expect("two gliders");
    assert!(error.to_string().contains("dora"), "{error}");
}

const GLI: &str = "Timestamp;NavState;SecurityLevel;Heading;Declination;Pitch;Roll;Depth;Temperature;Pa;Lat;Lon;DeadReckoning;\
DesiredH;BallastCmd;BallastPos;LinCmd;LinPos;AngCmd;AngPos;Voltage;Altitude;\n";

/// The vehicle's file: 10 s between rows, at the surface in the first two, with a new position in the second.
fn gli() -> String {
    let row = |i: i32| {
        let (state, reckoned) = if i < 2 { (116, 0) } else { (100, 1) };
        let lat = if i == 0 { "4854.000" } else { "4854.600" };
        let depth = f64::from(i);
        format!(
            "22/07/2019 05:{:02}:{:02};{state};0;359.5;16;-20.5;4.0;{depth};9999;;{lat};-13036.000;{reckoned};\
             270;-500;-250.5;57;40.0;0;-0.5;28.8;-1.0;\n",
            24 + i / 6,
            10 * (i % 6)
        )
    };
    GLI.to_owned() + &(0..30).map(row).collect::<String>()
}

fn pld() -> String {
    let row = |i: i32| {
        format!(
            "22/07/2019 05:{:02}:{:02}.500;100;-13036.000;4854.600;1.0;4.0;{};{};9999.00;\n",
            24 + i / 12,
            5 * (i % 12),
            15.0 - 0.1 * f64::from(i),
            0.5 * f64::from(i)
        )
    };
    "PLD_REALTIMECLOCK;NAV_RESOURCE;NAV_LONGITUDE;NAV_LATITUDE;NAV_DEPTH;GPCTD_CONDUCTIVITY;GPCTD_TEMPERATURE;GPCTD_PRESSURE;GPCTD_DOF;\n"
        .to_owned()
        + &(0..50).map(row).collect::<String>()
}

/// As a Slocum packs its files: blocks of LZ4, each behind its length.
fn packed(bytes: &[u8]) -> Vec<u8> {
    let block = |piece: &[u8]| {
        let packed = lz4_flex::block::compress(piece);
        [&(packed.len() as u16).to_be_bytes()[..], &packed].concat()
    };
    bytes.chunks(16 * 1024).flat_map(block).collect()
}

/// A packed file is known by what is in it, not by its name.
#[test]
fn packed_files_of_a_slocum_are_those_that_were_packed() {
    let folder = Folder::new();
    let (flight, science) = segment("unit_1-2020-257-0-0", START_S);
    let plain = [folder.write("a.dbd", &flight), folder.write("a.ebd", &science)];
    let (expected, _) = whole(&plain, &Columns::default()).unwrap();
    for [flight_name, science_name] in [["a.dcd", "a.ecd"], ["flight.bin", "science.bin"]] {
        let paths = [folder.write(flight_name, &packed(&flight)), folder.write(science_name, &packed(&science))];
        let (log, files) = whole(&paths, &Columns::default()).unwrap();
        // As text: a value that is missing is not equal to itself.
        assert_eq!(format!("{log:?}"), format!("{expected:?}"), "{flight_name}");
        assert!(files.warnings().is_empty(), "{:?}", files.warnings());
    }
}

/// Neither tables nor files of a Slocum are read gzipped: the archive is called what it is, its bytes are not shown.
#[test]
fn other_files_in_gzip_are_called_archives() {
    let folder = Folder::new();
    let (flight, _) = segment("unit_1-2020-257-0-0", START_S);
    let table = b"time_s,pressure_dbar,pitch_deg,vbd_cc\n0,5,-25,-200\n10,6,-25,-200\n";
    for (name, content) in [("log.csv.gz", &table[..]), ("a.dbd.gz", &flight)] {
        let path = folder.write(name, &gzipped(content));
        let error = whole(&[path], &Columns::default()).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("is a gzip archive"), "{error}");
        assert!(error.is_ascii() && !error.contains('\u{1f}'), "{error}");
    }
}

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn vehicle_and_payload_files_of_a_seaexplorer_are_one_log_gzipped_or_not() {
    let folder = Folder::new();
    let payload = gzipped(pld().as_bytes());
    let paths =
        [folder.write("sea035.12.pld1.raw.3.gz", &payload), folder.write("sea035.12.gli.sub.3", gli().as_bytes())];
    let (log, files) = whole(&paths, &Columns::default()).unwrap();
    // 2019-07-22T05:24:00Z.
    let start_s = 1_563_773_040.0;
    // The first row is the vehicle's depth, before the CTD began.
    assert_eq!((log.at(Channel::Time, 0), log.at(Channel::Pressure, 0)), (start_s, 0.0));
    for row in 1..45 {
        let t = log.at(Channel::Time, row) - start_s - 0.5;
        assert!((log.at(Channel::Pressure, row) - 0.1 * t).abs() < 1e-6, "{t}");
        assert!((log.at(Channel::Pitch, row) + 20.5f64.to_radians()).abs() < 1e-9);
        assert!((log.at(Channel::Ballast, row) + 250.5).abs() < 1e-9);
        assert!((log.at(Channel::BatteryPosition, row) - 0.04).abs() < 1e-12);
        assert!((log.at(Channel::Temperature, row) - (15.0 - 0.02 * t)).abs() < 1e-6);
    }
    assert_eq!(log.at(Channel::MotorMoving, 0), 1.0);
    assert_eq!(log.at(Channel::MotorMoving, 10), 0.0);
    let fixes = files.fixes();
    assert_eq!(fixes.len(), 1);
    assert_eq!(fixes[0].time_s, start_s + 10.0);
    assert!((fixes[0].lat_deg - 48.91).abs() < 1e-9 && (fixes[0].lon_deg + 130.6).abs() < 1e-9);
}

/// A row of the vehicle's file at a minute and a second, in a state, with a latitude that is reckoned or not.
fn gli_row(minute: u32, second: u32, state: u32, lat: f64, reckoned: u32) -> String {
    format!(
        "22/07/2019 05:{minute:02}:{second:02};{state};0;0;0;0;0;1.0;;;{lat:.3};-13036.000;{reckoned};0;0;0;0;0;0;0;0;0;\n"
    )
}

/// Minutes of the latitudes of fixes, to a hundredth.
fn minutes_north(fixes: &[GpsFix]) -> Vec<f64> {
    fixes.iter().map(|fix| ((fix.lat_deg - 48.0) * 60.0 * 100.0).round() / 100.0).collect()
}

#[test]
fn of_each_surfacing_the_first_and_the_last_fix_are_kept() {
    let folder = Folder::new();
    let mut text = GLI.to_owned() + &gli_row(0, 0, 117, 4853.5, 0);
    (1..6).for_each(|i| text += &gli_row(0, 10 * i, 116, 4854.0 + 0.01 * f64::from(i), 0));
    text += &gli_row(20, 0, 100, 4854.5, 1);
    (0..3).for_each(|i| text += &gli_row(40, 20 * i, 116, 4855.0 + 0.01 * f64::from(i), 0));
    let path = folder.write("sea035.12.gli.sub.3", text.as_bytes());
    let (_, files) = whole(std::slice::from_ref(&path), &Columns::default()).unwrap();
    assert_eq!(minutes_north(&files.fixes()), [54.01, 54.05, 55.0, 55.02]);
}

#[test]
fn a_position_from_before_the_dive_is_no_fix_of_a_seaexplorer() {
    let folder = Folder::new();
    // Each file begins while climbing. The vehicle does not reckon: the position stays that of the last surfacing, at the
    // surface too, until there is a new one.
    let first = GLI.to_owned()
        + &gli_row(0, 0, 117, 4853.0, 0)
        + &gli_row(0, 20, 116, 4853.0, 0)
        + &gli_row(0, 40, 116, 4854.0, 0)
        + &gli_row(1, 0, 110, 4854.0, 0);
    // Here it reckons, and shows the last position of the receiver once more at the surface.
    let second = GLI.to_owned()
        + &gli_row(40, 0, 117, 4854.3, 1)
        + &gli_row(40, 20, 116, 4854.3, 0)
        + &gli_row(40, 40, 116, 4854.0, 0)
        + &gli_row(41, 0, 116, 4855.0, 0)
        + &gli_row(41, 20, 110, 4855.0, 0);
    let paths = [("3", first), ("4", second)]
        .map(|(number, text)| folder.write(&format!("sea035.12.gli.sub.{number}"), text.as_bytes()));
    let (_, files) = whole(&paths, &Columns::default()).unwrap();
    let fixes = files.fixes();
    assert_eq!(minutes_north(&fixes), [54.0, 55.0]);
    let start_s = 1_563_773_040.0 - 24.0 * 60.0;
    assert_eq!([fixes[0].time_s - start_s, fixes[1].time_s - start_s], [40.0, 41.0 * 60.0]);
}

#[test]
fn damaged_seaexplorer_files_are_read_as_far_as_they_go() {
    let folder = Folder::new();
    let text = gli();
    let cut = folder.write("sea035.12.gli.sub.3", &text.as_bytes()[..text.len() - 40]);
    let (log, files) = whole(std::slice::from_ref(&cut), &Columns::default()).unwrap();
    assert_eq!(log.len(), 30);
    assert!(files.warnings().iter().any(|warning| warning.contains("cut off")), "{:?}", files.warnings());
    let wrong = folder.write("sea035.12.gli.sub.4", text.replace("-20.5;4.0;7;", "west;4.0;7;").as_bytes());
    let (_, files) = whole(std::slice::from_ref(&wrong), &Columns::default()).unwrap();
    assert!(files.warnings().iter().any(|warning| warning.contains("`west` in `Pitch`")), "{:?}", files.warnings());
    let no_archive = folder.write("sea035.12.gli.sub.5.gz", &[0x1f, 0x8b, 8, 0, 0, 0, 0]);
    let error = whole(&[no_archive], &Columns::default()).err().expect("no archive").to_string();
    assert!(error.contains("sub.5.gz") && error.contains("gzip"), "{error}");
    let other = folder.write("sea063.22.gli.sub.9", text.as_bytes());
    let error = whole(&[cut, other], &Columns::default()).err().expect("two gliders").to_string();
    assert!(error.contains("sea063") && error.contains("sea035"), "{error}");
}
