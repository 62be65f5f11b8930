//! What cannot be used is said with its place; what is merely damaged is mended and counted.

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
fn decimal_commas_and_foreign_separators_are_told() {
    // With semicolons, as a spreadsheet writes them where the comma is the decimal mark.
    let found = problem("time_s;pressure_dbar;pitch_rad;vbd_cc\n1,5;2,0;-0,4;-200\n");
    assert!(found.contains("comma"), "{found}");
    // Decimal commas between commas: too many cells in the row.
    let found = problem(&format!("{HEADER}1,5,2,0,-0,4,-200,1025,0\n"));
    assert!(found.contains("cells, expected 5"), "{found}");
}

#[test]
fn an_empty_file_a_cut_one_and_a_folder_are_errors() {
    assert!(csv("").series().unwrap_err().to_string().contains("empty"));
    assert!(problem("\n\n").contains("empty") || problem("\n\n").contains("no time"));
    let cut = problem(&format!("{HEADER}1,2,-0.4,-200,1025\n2,3,-0"));
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
