//! Tables beside a log, in any dialect of logs, and the plain form that their readers get.

use glidepolar_flightlog::{Dates, plain_table};

use crate::Target;
use crate::files::Folder;

pub const TABLE: Target = Target {
    name: "table",
    what: "a table in any dialect, brought into plain form",
    run: table,
    seeds: || SEEDS.iter().map(|seed| seed.as_bytes().to_vec()).collect(),
    catches_panics: false,
};

/// Separators, decimal marks, ends of lines, dates, comments, quotation marks and missing values of all kinds.
const SEEDS: [&str; 6] = [
    "time_s,lat_deg,lon_deg\n0,47.5,-52.5\n210,47.5004,-52.4992\n",
    "# by hand\n\ntime;lat_deg;lon_deg;\r\n2023-04-18T16:49:57Z;54,25;-7,5;\r\n2023-04-18 16:50:57;;nan;\r\n",
    "\u{feff}\"time_s\"\t\"note\"\n0\t\"two\nlines, \"\"one\"\" cell\"\n# a gap\n\n60\t--\n",
    "sep=|\ntime_s | u\r1 | 2e-3\r18/04/2023 16:49:57 | n/a\r",
    "time,u\n2023-04-18T18:49:57+02:00,1\n2023-04-18T16:49:58.250Z,-1,5\n",
    "dive,start_time_s,duration_s,lat_deg,lon_deg\n1,0,100,47.5,-52.5\n2,150,60,,\n",
];

fn table(data: &[u8]) {
    let folder = Folder::new();
    let path = folder.write("table.csv", data);
    let lines = 1 + data.iter().filter(|byte| matches!(byte, b'\n' | b'\r')).count();
    for dates in [Dates::Since1970, Dates::SinceFirst] {
        match plain_table(&path, dates) {
            // Rows keep their lines: those of the file are enough.
            Ok(text) => assert!(text.lines().count() <= lines, "{} lines of {lines}", text.lines().count()),
            Err(error) => {
                assert!(error.place.line.is_none_or(|line| (1..=lines).contains(&line)), "{error}");
                drop(error.to_string());
            }
        }
    }
}
