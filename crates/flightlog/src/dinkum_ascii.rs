//! Slocum files as text, as `dbd2asc` and `dba_merge` write them (`.dba`): lines `key: value`, a line of sensors, one of their
//! units, one of their sizes, then a row a cycle with blanks between, `NaN` where a sensor was not read.
//!
//! As well the tables of CSV that programs make of such a file, one for each of the two computers: a line of sensors, then a
//! row a cycle, an empty cell where a sensor was not read.
//!
//! Knows the text; not what sensors mean.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use super::names;
use glidepolar_input::{InputError, Place, printable};

/// How such a file begins.
const LABEL: &[u8] = b"dbd_label: DBD_ASC";

/// Longest line that is read \[bytes\]: 3000 sensors of 20 characters.
const LONGEST_LINE: u64 = 1 << 20;

/// A text that is being read.
pub(super) struct Table {
    path: PathBuf,
    lines: BufReader<File>,
    keys: Vec<(String, String)>,
    /// Sensors with their units.
    pub(super) sensors: Vec<(String, String)>,
    /// For each wanted sensor its cell.
    cells: Vec<Option<usize>>,
    values: Vec<f64>,
    line: usize,
    /// Rows that are no row of this table.
    pub(super) damages: Vec<String>,
    is_csv: bool,
}

/// Whether a file that begins with these bytes is one.
pub(super) fn is_one(start: &[u8]) -> bool {
    start.starts_with(LABEL)
}

/// Whether a file begins as a table of half of a Slocum's sensors: programs write the files of the flight computer and of the
/// science computer as CSV files of their own. A table that has both is one like any other.
pub(super) fn is_half_a_table(start: &[u8]) -> bool {
    let line = start.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let line = String::from_utf8_lossy(line);
    let has = |name: &str| cells(&line).any(|cell| cell == name);
    let is_flight = has("m_present_time") && has("m_pitch");
    let is_science = has("sci_m_present_time") && has("sci_water_pressure");
    // Where other names hold channels as well, it is a table of somebody's own.
    let is_sensor =
        |name: &str| ["m_", "c_", "sci_", "u_", "x_", "f_", "s_"].iter().any(|begin| name.starts_with(begin));
    is_flight != is_science && !cells(&line).any(|name| !is_sensor(name) && names::is_known(name))
}

/// The cells of a line of CSV in which no cell holds a comma.
fn cells(line: &str) -> impl Iterator<Item = &str> {
    line.trim_start_matches('\u{feff}').trim_end().split(',').map(|cell| cell.trim().trim_matches('"'))
}

impl Table {
    /// Opens a file and reads its header.
    ///
    /// # Errors
    /// A header that is damaged or ends too early.
    pub(super) fn open(path: &Path) -> Result<Self, InputError> {
        let file = File::open(path).map_err(|error| InputError::io(path, &error))?;
        let mut table = Table {
            path: path.to_owned(),
            lines: BufReader::new(file),
            keys: Vec::new(),
            sensors: Vec::new(),
            cells: Vec::new(),
            values: Vec::new(),
            line: 0,
            damages: Vec::new(),
            is_csv: false,
        };
        let mut start = Vec::new();
        File::open(path)
            .and_then(|file| std::io::Read::take(file, LONGEST_LINE).read_to_end(&mut start))
            .map_err(|error| InputError::io(path, &error))?;
        if is_half_a_table(&start) {
            table.is_csv = true;
            let line = table.header_line()?;
            table.sensors = cells(&line).map(|name| (name.to_owned(), String::new())).collect();
            return Ok(table);
        }
        while table.sensors.is_empty() {
            let line = table.header_line()?;
            match line.split_once(": ").or_else(|| line.strip_suffix(':').map(|key| (key, ""))) {
                Some((key, value)) => table.keys.push((key.trim().to_owned(), value.trim().to_owned())),
                None => table.sensors = line.split_whitespace().map(|name| (name.to_owned(), String::new())).collect(),
            }
        }
        let labels = table.get("num_label_lines").parse().unwrap_or(3usize);
        for label in 1..labels {
            let line = table.header_line()?;
            if label == 1 {
                for (sensor, unit) in table.sensors.iter_mut().zip(line.split_whitespace()) {
                    sensor.1 = unit.to_lowercase();
                }
            }
        }
        Ok(table)
    }

    /// What the header says; empty where it says nothing.
    pub(super) fn get(&self, key: &str) -> &str {
        self.keys.iter().find(|(known, _)| known == key).map_or("", |(_, value)| value)
    }

    /// Reads these sensors, in this order.
    pub(super) fn select(&mut self, names: &[String]) {
        let cell = |name: &String| self.sensors.iter().position(|(known, _)| known == name);
        self.cells = names.iter().map(cell).collect();
        self.values = vec![f64::NAN; names.len()];
    }

    /// The values of the next row; nothing at the end.
    ///
    /// # Errors
    /// Where the file cannot be read any further.
    pub(super) fn next_row(&mut self) -> Result<Option<&[f64]>, InputError> {
        while let Some(line) = self.read_line()? {
            let row: Vec<&str> =
                if self.is_csv { cells(&line).collect() } else { line.split_ascii_whitespace().collect() };
            // Files that were put one behind the other without a program for it: their headers stand between.
            if row.is_empty() {
                continue;
            }
            // A sensor that was not read is an empty cell of a CSV file, and `NaN` in the text of dbd2asc.
            let is_row = row.len() == self.sensors.len()
                && if self.is_csv {
                    row.iter().any(|cell| cell.parse::<f64>().is_ok())
                } else {
                    row[0].parse::<f64>().is_ok()
                };
            if line.is_empty() {
                continue;
            }
            if !is_row {
                if self.damages.is_empty() {
                    self.damages.push(format!(
                        "line {}: {} cells where {} sensors were expected; such rows are left out",
                        self.line,
                        row.len(),
                        self.sensors.len()
                    ));
                }
                continue;
            }
            for (value, cell) in self.values.iter_mut().zip(&self.cells) {
                let read = cell.and_then(|cell| row[cell].parse::<f64>().ok());
                *value = read.filter(|read| read.is_finite()).unwrap_or(f64::NAN);
            }
            return Ok(Some(&self.values));
        }
        Ok(None)
    }

    fn header_line(&mut self) -> Result<String, InputError> {
        self.read_line()?.ok_or_else(|| {
            InputError::new(Place::line(&self.path, self.line), "the header ends before the line of sensors")
                .help("was the file cut off?")
        })
    }

    fn read_line(&mut self) -> Result<Option<String>, InputError> {
        let mut bytes = Vec::new();
        let mut limited = std::io::Read::take(&mut self.lines, LONGEST_LINE);
        let read = limited.read_until(b'\n', &mut bytes).map_err(|error| InputError::io(&self.path, &error))?;
        self.line += 1;
        if read as u64 == LONGEST_LINE {
            let start = printable(&String::from_utf8_lossy(&bytes[..40]));
            return Err(InputError::new(Place::line(&self.path, self.line), format!("a line without end: `{start}`")));
        }
        Ok((read > 0).then(|| String::from_utf8_lossy(&bytes).trim_end().to_owned()))
    }
}
