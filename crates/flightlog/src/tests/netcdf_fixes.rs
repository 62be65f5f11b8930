//! Fixes of NetCDF time series: what was received, and not what was written again or reckoned.

use super::segments::{Folder, whole};
use super::*;

const ROWS: usize = 41;

/// A dive of 4000 s: at the surface in the first two rows and the last two.
fn dive() -> classic::File {
    let series = |value: &dyn Fn(f64) -> f64| (0..ROWS).map(|i| value(i as f64)).collect::<Vec<_>>();
    classic::File::new(ROWS)
        .variable("TIME", "seconds since 1970-01-01", &series(&|i| 1.6e9 + 100.0 * i))
        .variable("PRES", "dbar", &series(&|i| 10.0 * (19.0 - (i - 20.0).abs()).max(0.0)))
        .variable("PITCH", "degrees", &series(&|i| if i < 20.0 { -25.0 } else { 25.0 }))
        .variable("vbd_cc", "cc", &series(&|i| if i < 20.0 { -200.0 } else { 200.0 }))
}

/// A value for each row, and what to make of it.
fn rows(value: impl Fn(usize) -> f64) -> Vec<f64> {
    (0..ROWS).map(value).collect()
}

/// Time since the first row and latitude of each fix \[s, deg\].
fn fixes(file: &classic::File) -> Vec<(f64, f64)> {
    let folder = Folder::new();
    let path = folder.write("log.nc", &file.bytes());
    let (_, files) = whole(&[path], &Columns::default()).expect("a log");
    files.fixes().iter().map(|fix| (fix.time_s - 1.6e9, fix.lat_deg)).collect()
}

#[test]
fn a_position_that_stands_in_every_row_is_a_fix_where_it_changes_at_the_surface() {
    let lat = rows(|i| if i < 39 { 50.0 } else { 51.0 });
    let filled = dive().variable("LATITUDE_GPS", "degrees_north", &lat);
    let filled = filled.variable("LONGITUDE_GPS", "degrees_east", &rows(|_| -7.5));
    assert_eq!(fixes(&filled), [(3900.0, 51.0)], "when the first was received is not known");
}

#[test]
fn positions_of_the_receiver_alone_are_all_fixes_but_those_flagged() {
    let sparse = rows(|i| match i {
        0 => 50.0,
        20 => 50.4,
        39 => 51.0,
        _ => f64::NAN,
    });
    let sparse = dive().variable("LATITUDE_GPS", "degrees_north", &sparse);
    let sparse = sparse.variable("LONGITUDE_GPS", "degrees_east", &rows(|_| -7.5));
    assert_eq!(fixes(&sparse), [(0.0, 50.0), (3900.0, 51.0)], "none is received at 190 dbar");
    // EGO: on a dimension of its own.
    let gps = [("TIME_GPS", 3)];
    let ego = dive()
        .variable_on(&gps, "TIME_GPS", "seconds since 1970-01-01", &[1.6e9 - 60.0, 1.6e9 + 50.0, 1.6e9 + 4100.0])
        .variable_on(&gps, "LATITUDE_GPS", "degree_north", &[50.0, 80.0, 51.0])
        .variable_on(&gps, "LONGITUDE_GPS", "degree_east", &[-7.5, -7.5, -7.4])
        .variable_on(&gps, "POSITION_GPS_QC", "", &[1.0, 4.0, 1.0]);
    assert_eq!(fixes(&ego), [(-60.0, 50.0), (4100.0, 51.0)]);
}

#[test]
fn positions_of_all_rows_are_fixes_where_quality_control_calls_them_received() {
    let with_rows = || {
        let lat = rows(|i| 50.0 + 0.025 * i as f64);
        let file = dive().variable("LATITUDE", "degrees_north", &lat);
        file.variable("LONGITUDE", "degrees_east", &rows(|_| -7.5))
    };
    assert_eq!(fixes(&with_rows()), [], "reckoned, for all that is known");
    let judged = with_rows().variable("POSITION_QC", "", &rows(|i| if i % 40 == 0 { 1.0 } else { 8.0 }));
    assert_eq!(fixes(&judged), [(0.0, 50.0), (4000.0, 51.0)]);
}
