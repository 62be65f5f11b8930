//! What cannot be used is said with its place; what is merely damaged is corrected and counted.

use super::*;

const HEADER: &str = "time_s,pressure_dbar,pitch_rad,vbd_cc,density_kg_m3\n";

fn problem(text: &str) -> String {
    csv(text).series().expect_err("nothing to be used").to_string()
}

#[test]
fn a_missing_column_is_named() {
    for (header, expected) in [
        ("pressure_dbar,pitch_rad,vbd_cc", "time_s"),
        ("time_s,pitch_rad,vbd_cc", "pressure_dbar"),
        ("time_s,pressure_dbar,vbd_cc", "pitch_rad"),
        ("time_s,pressure_dbar,pitch_rad", "vbd_cc"),
    ] {
        let found = problem(&format!("{header}\n1,2,3\n"));
        assert!(found.contains(expected) && found.contains("log.csv"), "{found}");
    }
}

#[test]
fn cells_that_are_no_numbers_are_named_with_line_and_column() {
    let found = problem(&format!("{HEADER}1,2,-0.4,-200,1025\n2,3,west,-200,1025\n"));
    assert!(found.contains("west") && found.contains("pitch_rad") && found.contains(":3:3"), "{found}");
    let infinite = problem(&format!("{HEADER}1,2,-0.4,inf,1025\n"));
    assert!(infinite.contains("inf"), "{infinite}");
}

#[test]
fn a_line_is_the_files_own_after_comments_and_empty_lines() {
    let (names, row) = (HEADER.trim_end(), "1,2,-0.4,-200,1025");
    for end in ["\n", "\r\n"] {
        let text = |lines: &[&str]| lines.join(end);
        let comments = ["# by hand", "", names, row, "# a gap", "#", "", "2,3,west,-200,1025", row, ""];
        let found = problem(&text(&comments));
        assert!(found.contains("log.csv:8:3:"), "{end:?}: {found}");
        let found = problem(&text(&["sep=,", names, "# a gap", row, "1,2", row, ""]));
        assert!(found.contains("log.csv:5:"), "{end:?}: {found}");
        // A mark of the byte order, and a cell of several lines, which ends where the row does.
        let found = problem(&text(&[
            "\u{feff}time_s,pressure_dbar,pitch_rad,vbd_cc,note",
            "1,2,3,4,\"a",
            "b\"",
            "2,west,3,4,",
            "",
        ]));
        assert!(found.contains("log.csv:4:2:"), "{end:?}: {found}");
        let found = problem(&text(&["#", "", "time_s,pressure_dbar,pitch_rad", row, ""]));
        assert!(found.contains("log.csv:3: no ballast"), "{end:?}: {found}");
    }
}

#[test]
fn semicolons_tabs_decimal_commas_and_dates_are_read() {
    let with = |text: &str| csv(text).series().unwrap();
    // As a spreadsheet writes it where the comma is the decimal mark.
    let log = with("time_s;pressure_dbar;pitch_deg;vbd_cc;\n1,5;2,25;-30,0;-200;\n2;;;;\n");
    assert_eq!((log.at(Channel::Time, 0), log.at(Channel::Pressure, 0)), (1.5, 2.25));
    assert!((log.at(Channel::Pitch, 0) + 30f64.to_radians()).abs() < 1e-12 && log.at(Channel::Pressure, 1).is_nan());
    let log = with("time\tPRES\tPITCH\tvbd_cc\n2023-04-18T16:49:57Z\t2.5\t-30\t-200\n");
    assert_eq!((log.at(Channel::Time, 0), log.at(Channel::Pressure, 0)), (1_681_836_597.0, 2.5));
    assert!((log.at(Channel::Pitch, 0) + 30f64.to_radians()).abs() < 1e-12);
    let log = with("m_present_time,sci_water_pressure,m_pitch,m_ballast_pumped,m_battpos\n1,2.5,-0.4,-200,1\n");
    assert_eq!((log.at(Channel::Pressure, 0), log.at(Channel::Pitch, 0)), (25.0, -0.4));
    assert!((log.at(Channel::BatteryPosition, 0) - 0.0254).abs() < 1e-15);
    let log = with("Timestamp;Depth;Pitch;BallastPos;LinPos;\n22/07/2019 05:24:14;9.5;8;156.4;57;\n");
    assert_eq!((log.at(Channel::Time, 0), log.at(Channel::Ballast, 0)), (1_563_773_054.0, 156.4));
    // Decimal commas between commas: too many cells in the row.
    let found = problem(&format!("{HEADER}1,5,2,0,-0,4,-200,1025,0\n"));
    assert!(found.contains("cells, expected 5"), "{found}");
}

#[test]
fn a_column_without_a_unit_is_pointed_to() {
    let found = problem("time_s,pressure_dbar,pitch,vbd_cc\n1,2,3,4\n");
    assert!(found.contains("is it `pitch`?") && found.contains("--column pitch_rad=pitch"), "{found}");
    // Given with its unit it is read; by --unit, too.
    let file = csv("time_s,pressure_dbar,pitch,vbd_cc\n1,2,-30,4\n");
    for options in [&["pitch_deg=pitch"][..], &["pitch_rad=pitch", "unit"]] {
        let mut columns = Columns::default();
        columns.choose_text(options[0]).unwrap();
        if options.len() > 1 {
            columns.unit_text("pitch_rad=deg").unwrap();
        }
        let Ok(Opened::Series(mut series)) = open(&file.path, &columns) else { panic!("a series") };
        let log = series.next_piece(10).unwrap().unwrap();
        assert!((log.at(Channel::Pitch, 0) + 30f64.to_radians()).abs() < 1e-12);
    }
}

#[test]
fn an_empty_file_a_cut_one_and_a_folder_are_errors() {
    assert!(csv("").series().unwrap_err().to_string().contains("empty"));
    assert!(problem("\n\n").contains("empty") || problem("\n\n").contains("no time"));
    let cut = problem(&format!("{HEADER}1,2,-0.4,-200,1025\n2,3,-0\n3,4,-0.4,-200,1025\n"));
    assert!(cut.contains("cells, expected 5"), "{cut}");
    let folder = tempfile::tempdir().unwrap();
    assert!(open(folder.path(), &Columns::default()).is_err());
    assert!(open(folder.path().join("nothing.csv"), &Columns::default()).is_err());
}

#[test]
fn a_damaged_netcdf_file_is_an_error_whatever_is_left_of_it() {
    let whole = classic::File::new(3)
        .variable("TIME", "seconds since 1970-01-01", &[1.0, 2.0, 3.0])
        .variable("PRES", "dbar", &[1.0, 2.0, 3.0])
        .variable("PITCH", "degrees", &[1.0, 2.0, 3.0])
        .variable("vbd_cc", "cc", &[1.0, 2.0, 3.0])
        .bytes();
    assert!(OneFile::new("whole.nc", &whole).series().is_ok());
    for length in (4..whole.len()).step_by(7) {
        assert!(OneFile::new("cut.nc", &whole[..length]).series().is_err(), "cut at {length}");
    }
    // Any single byte changed: an error or a log, never an abort.
    for i in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[i] ^= 0xFF;
        let _ = OneFile::new("damaged.nc", &bytes).series();
    }
    let foreign = classic::File::new(3)
        .variable("TIME", "fortnights", &[1.0, 2.0, 3.0])
        .variable("PRES", "dbar", &[1.0, 2.0, 3.0])
        .variable("PITCH", "degrees", &[1.0, 2.0, 3.0])
        .variable("vbd_cc", "cc", &[1.0, 2.0, 3.0])
        .bytes();
    let found = OneFile::new("units.nc", &foreign).series().unwrap_err().to_string();
    assert!(found.contains("fortnights"), "{found}");
}

#[test]
fn a_column_that_stands_twice_is_an_error() {
    let found = problem("time_s,pressure_dbar,pitch_rad,vbd_cc,vbd_cc\n1,2,3,4,5\n");
    assert!(found.contains("twice"), "{found}");
}
