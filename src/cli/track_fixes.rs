//! A table of fixes, in any dialect of a log: its columns, what its positions can be, and whether they are of the log's time.

use std::path::Path;

use clap::ValueEnum;

use super::table::{for_each_row, incomplete};
use crate::input::{InputError, Place, printable};
use crate::log::{Channel, Dates, column_of, degrees, plain_table, shown_time};
use crate::track::comparison::Stored;
use crate::track::{Fix, Track};

/// Where in a dive the positions of a table were taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FixesAt {
    Start,
    Middle,
}

/// A table of fixes.
#[derive(Default)]
pub(super) struct Fixes {
    pub fixes: Vec<Fix>,
    pub stored: Vec<Stored>,
    /// The same with the times of the middle of the dives, where these are known and were not asked for.
    pub middle: Option<(Vec<Fix>, Vec<Stored>)>,
    pub warnings: Vec<String>,
}

/// Fixes so long before and after a log are those of the surfacings around it \[s\].
const AROUND_S: f64 = 3600.0;

/// Names of positions as a receiver writes them, degrees and minutes in one number.
const RECEIVERS: [&str; 2] = ["m_gps_lat", "m_gps_lon"];

/// Reads a table of fixes.
///
/// # Errors
/// A missing column, a cell that is no number, a position that is none, a table without a fix; with line and column.
pub(super) fn read(file: &Path, at: FixesAt) -> Result<Fixes, InputError> {
    let text = plain_table(file, Dates::Since1970)?;
    let names: Vec<String> = text.trim_start().lines().next().unwrap_or("").split(',').map(str::to_owned).collect();
    let has = |name: &str| names.iter().any(|column| column == name);
    let named = |channel: Channel, otherwise: &str| match column_of(channel, &names) {
        Some(column) if !has(otherwise) => names[column].clone(),
        _ => otherwise.to_owned(),
    };
    let time = if has("time_s") { "time_s".to_owned() } else { named(Channel::Time, "start_time_s") };
    let duration = (time == "start_time_s" && has("duration_s")).then_some("duration_s");
    if at == FixesAt::Middle && duration.is_none() {
        let error = InputError::new(Place::line(file, 1), "no columns `start_time_s` and `duration_s`");
        return Err(error.help("the middle of a dive follows from both; for fixes with a time_s leave --fixes-at out"));
    }
    let is_receivers = RECEIVERS.iter().all(|name| has(name));
    let [lat, lon] = if is_receivers {
        RECEIVERS.map(str::to_owned)
    } else {
        [named(Channel::Latitude, "lat_deg"), named(Channel::Longitude, "lon_deg")]
    };
    let currents = has("dac_east_m_s") && has("dac_north_m_s");
    // Columns that are not there are read as others that are, and not looked at.
    let columns = [
        time.as_str(),
        duration.unwrap_or(&time),
        &lat,
        &lon,
        if currents { "dac_east_m_s" } else { &lat },
        if currents { "dac_north_m_s" } else { &lat },
    ];
    let (mut rows, mut lacking, mut lines, mut wrong): (Vec<[f64; 6]>, _, _, _) = (Vec::new(), 0, Vec::new(), None);
    for_each_row(file, columns, |line, mut row| {
        if row[..4].iter().any(|value| value.is_nan()) {
            lacking += 1;
            return;
        }
        let (lat, lon) = (row[2], row[3]);
        if is_receivers {
            (row[2], row[3]) = (degrees(lat), degrees(lon));
        }
        if let Some((problem, help)) = no_position(row[2], row[3]) {
            wrong.get_or_insert_with(|| {
                InputError::new(Place::line(file, line), format!("latitude {lat} and longitude {lon}: {problem}"))
                    .help(help)
            });
        }
        lines.push(line);
        rows.push(row);
    })?;
    if let Some(wrong) = wrong {
        return Err(wrong);
    }
    let Some(&line) = lines.first() else {
        let error = InputError::new(Place::file(file), "no row with a time, a latitude and a longitude");
        return Err(error.help("give at least two fixes, one before and one after a dive"));
    };
    let mut warnings: Vec<String> = incomplete(file, lacking).into_iter().collect();
    if rows.len() == 1 {
        warnings
            .push(format!("{}: one fix only; a current takes two, before and after a dive", Place::line(file, line)));
    }
    rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let at_times = |share: f64| {
        let later = |row: &[f64; 6]| row[0] + share * row[1];
        let fixes = rows.iter().map(|row| Fix { time_s: later(row), lat_deg: row[2], lon_deg: row[3] }).collect();
        let with_current = rows.iter().filter(|row| currents && row[4].is_finite() && row[5].is_finite());
        (fixes, with_current.map(|row| (later(row), row[4], row[5])).collect())
    };
    let (fixes, stored) = at_times(if at == FixesAt::Middle { 0.5 } else { 0.0 });
    let middle = (at == FixesAt::Start && duration.is_some()).then(|| at_times(0.5));
    Ok(Fixes { fixes, stored, middle, warnings })
}

/// Why two numbers are no position in degrees, and what to do.
fn no_position(lat: f64, lon: f64) -> Option<(&'static str, &'static str)> {
    // Degrees and minutes in one number: the minutes are below 60.
    let is_ddmm = |value: f64, most_deg: f64| degrees(value).abs() <= most_deg;
    if lat.abs() <= 90.0 && lon.abs() <= 360.0 {
        None
    } else if lat.abs() <= 180.0 && lon.abs() <= 90.0 {
        Some(("no latitude is beyond 90 degrees", "are the two columns swapped?"))
    } else if is_ddmm(lat, 90.0) && is_ddmm(lon, 180.0) {
        Some((
            "no latitude is beyond 90 degrees, no longitude beyond 360",
            "are they degrees and minutes in one number, DDMM.mmm? name the columns m_gps_lat and m_gps_lon, or write degrees",
        ))
    } else {
        Some(("no latitude is beyond 90 degrees, no longitude beyond 360", "write degrees, north and east positive"))
    }
}

impl Fixes {
    /// A warning where no fix is of the time of the log.
    pub(super) fn beside_the_log(&self, file: &Path, track: &Track) -> Option<String> {
        let (begin, end) = (track.points.first()?.time_s, track.points.last()?.time_s);
        let (first, last) = (self.fixes.first()?.time_s, self.fixes.last()?.time_s);
        if self.fixes.iter().any(|fix| (begin - AROUND_S..=end + AROUND_S).contains(&fix.time_s)) {
            return None;
        }
        Some(format!(
            "{}: none of its fixes is of the time of the log: they are from {} to {}, the log is from {} to {}; count both from the \
             same moment, seconds since 1970 or dates",
            printable(&file.to_string_lossy()),
            shown_time(first),
            shown_time(last),
            shown_time(begin),
            shown_time(end)
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::Point;

    fn table(text: &str) -> Result<Fixes, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("fixes.csv");
        std::fs::write(&path, text).expect("a file");
        read(&path, FixesAt::Start).map_err(|error| error.to_string())
    }

    #[test]
    fn positions_that_are_none_are_refused_with_row_and_remedy() {
        for (rows, line, remedy) in [
            ("0,54.2,10.1\n10,-122.4,54.5\n", "fixes.csv:3", "swapped"),
            ("0,54.2,10.1\n# a gap\n\n10,-122.4,54.5\n", "fixes.csv:5", "swapped"),
            ("0,5415.99,724.63\n", "fixes.csv:2", "m_gps_lat"),
            ("0,54.2,-12805.8\n", "fixes.csv:2", "m_gps_lat"),
            ("0,69696969,69696969\n", "fixes.csv:2", "write degrees"),
            ("0,,\n", "fixes.csv", "at least two fixes"),
            ("", "fixes.csv", "at least two fixes"),
        ] {
            let found = table(&format!("time_s,lat_deg,lon_deg\n{rows}")).err().expect(rows);
            assert!(found.contains(line) && found.contains(remedy), "{rows:?}: {found}");
        }
    }

    #[test]
    fn fixes_are_read_in_the_dialects_of_logs() {
        for text in [
            "\u{feff}time;Latitude;Longitude\r\n2023-04-18T16:49:57Z;54,5;-7,25\r\n2023-04-18T17:49:57Z;;NaN\r\n",
            "time_s\tlatitude (degrees_north)\tlon\n1681836597\t54.5\t-7.25\n1681840197\tnan\t\n",
            "time_s,m_gps_lat,m_gps_lon\n1681836597,5430.0,-715.0\n1681840197,,\n",
        ] {
            let table = table(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!(table.fixes, [Fix { time_s: 1_681_836_597.0, lat_deg: 54.5, lon_deg: -7.25 }], "{text}");
            assert!(table.warnings[0].contains("1 row lacks a value"), "{:?}", table.warnings);
            assert!(table.warnings[1].contains("fixes.csv:2: one fix only"), "{:?}", table.warnings);
        }
    }

    #[test]
    fn fixes_of_another_time_than_the_log_are_reported() {
        let fixes = table("time_s,lat_deg,lon_deg\n1681836597,54,10\n1681846597,54,10\n").expect("fixes");
        let track = |start_s: f64| {
            let point = |time_s| Point { time_s, dive: 1, depth_m: 9.0, speed_m_s: 0.3, east_m: 0.0, north_m: 0.0 };
            Track { points: vec![point(start_s), point(start_s + 7200.0)], dives: Vec::new() }
        };
        assert_eq!(fixes.beside_the_log(Path::new("fixes.csv"), &track(1_681_836_597.0)), None);
        let found = fixes.beside_the_log(Path::new("fixes.csv"), &track(0.0)).expect("another epoch");
        assert!(found.contains("fixes.csv") && found.contains("2023-04-18") && found.contains("7200 s"), "{found}");
    }
}
