//! Several tables as one log: each once, in the order of time, and what is said where the files do not state it.

use super::segments::{Folder, START_S, dbd, segment, whole};
use super::*;

/// A table of one dive of 500 s, from a time on.
fn table(start_s: f64, pitch_rad: f64) -> String {
    let row = |i: i32| {
        let t = 5.0 * f64::from(i);
        let pressure = if i < 50 { t } else { 500.0 - t };
        format!("{},{pressure},{pitch_rad},-200,1025,7\n", start_s + t)
    };
    "time_s,pressure_dbar,pitch_rad,vbd_cc,density_kg_m3,dive\n".to_owned() + &(0..100).map(row).collect::<String>()
}

#[test]
fn tables_whose_times_begin_again_are_taken_in_the_order_in_which_they_are_named() {
    let folder = Folder::new();
    let paths = [("second.csv", -0.2), ("first.csv", -0.1), ("third.csv", -0.3)]
        .map(|(name, pitch)| folder.write(name, table(0.0, pitch).as_bytes()));
    let (log, files) = whole(&paths, &Columns::default()).unwrap();
    assert_eq!(log.len(), 300, "no row is lost");
    assert!(log.column(Channel::Time).windows(2).all(|pair| pair[1] > pair[0]));
    assert_eq!([0, 100, 200].map(|row| log.at(Channel::Pitch, row)), [-0.2, -0.1, -0.3]);
    assert_eq!([0, 100, 200].map(|row| log.at(Channel::Dive, row)), [7.0, 8.0, 9.0]);
    let [warning] = files.warnings() else { panic!("{:?}", files.warnings()) };
    assert!(warning.contains("second.csv") && warning.contains("since 1970"), "{warning}");
}

#[test]
fn parts_of_one_record_are_put_in_order_by_its_own_times() {
    let folder = Folder::new();
    let paths = [("late.csv", 500.0), ("early.csv", 0.0)]
        .map(|(name, start_s)| folder.write(name, table(start_s, -0.1).as_bytes()));
    let (log, files) = whole(&paths, &Columns::default()).unwrap();
    assert_eq!((log.len(), log.at(Channel::Time, 0), log.at(Channel::Time, 199)), (200, 0.0, 995.0));
    assert!(files.warnings().is_empty(), "{:?}", files.warnings());
}

#[test]
fn a_file_that_is_named_twice_is_flown_once() {
    let folder = Folder::new();
    let one = folder.write("a.csv", table(0.0, -0.1).as_bytes());
    let copy = folder.write("copy.csv", table(0.0, -0.1).as_bytes());
    for (other, said) in [(&one, "a.csv is named twice"), (&copy, "copy.csv has the same content as")] {
        let (log, files) = whole(&[one.clone(), other.clone()], &Columns::default()).unwrap();
        assert_eq!(log.len(), 100);
        let [warning] = files.warnings() else { panic!("{:?}", files.warnings()) };
        assert!(warning.contains(said) && warning.contains("a.csv"), "{warning}");
    }
}

#[test]
fn what_the_files_of_the_other_computer_would_have_is_asked_for() {
    let folder = Folder::new();
    let (flight, science) = segment("unit_1-2020-257-0-0", START_S);
    let (flight, science) = (folder.write("a.dbd", &flight), folder.write("a.ebd", &science));
    let help = |paths: &[PathBuf], channel: Channel| whole(paths, &Columns::default()).unwrap().1.help(channel);
    let of_flight = [flight.clone()];
    assert!(help(&of_flight, Channel::Density).is_some_and(|help| help.contains(".ebd")));
    assert_eq!(help(&of_flight, Channel::Pitch), None);
    assert!(help(std::slice::from_ref(&science), Channel::Pitch).is_some_and(|help| help.contains(".dbd")));
    assert_eq!(help(&[flight.clone(), science.clone()], Channel::Density), None);
    // One segment of two has both.
    let (other, _) = segment("unit_1-2020-257-0-1", START_S + 900.0);
    let (_, files) = whole(&[flight, science, folder.write("b.dbd", &other)], &Columns::default()).unwrap();
    let found = files.warnings().iter().any(|warning| {
        warning.contains("1 of 2 segments") && warning.contains("science") && warning.contains("unit_1-2020-257-0-1")
    });
    assert!(found, "{:?}", files.warnings());
}

#[test]
fn a_file_whose_list_of_sensors_is_missing_is_named_beside_its_partner() {
    let folder = Folder::new();
    let (_, science) = segment("unit_1-2020-257-0-0", START_S);
    let flight = dbd("unit_1-2020-257-0-0", "dbd", &[("m_present_time", "s"), ("m_depth", "m")], &[vec![START_S, 1.0]]);
    let factored = String::from_utf8_lossy(&flight).replace("sensor_list_factored: 0", "sensor_list_factored: 1");
    let paths = [folder.write("a.dbd", factored.as_bytes()), folder.write("a.ebd", &science)];
    let (_, files) = whole(&paths, &Columns::default()).unwrap();
    let [warning] = files.warnings() else { panic!("{:?}", files.warnings()) };
    assert!(warning.contains("a.dbd") && warning.contains(".cac") && warning.contains("--cache"), "{warning}");
    assert!(files.help(Channel::Pitch).is_some_and(|help| help.contains("left out")));
}
