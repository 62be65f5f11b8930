//! The time history of one run: `data/<run_id>.csv` parsed into columns, fast, every complaint with line and cell.
//!
//! Knows columns, not what they mean for a hull.

use std::io::Read;
use std::path::Path;

use glidepolar_input::{InputError, Place, printable};

use crate::table::{missing_column, not_a_number};

/// Columns of a history, in the order in which they are kept.
const COLUMNS: [&str; 7] = ["time_s", "speed_m_s", "yaw_deg", "sway_m", "AF_N", "SF_N", "YM_N_m"];
/// The one that a run without sway may lack.
const OPTIONAL: usize = 3;
/// No run has fewer samples than this.
const MIN_SAMPLES: usize = 32;

/// The samples of one run, column by column.
#[derive(Debug, Default)]
pub struct History {
    columns: [Vec<f64>; 7],
    has_sway: bool,
    /// Names of columns that are not used.
    pub unused: Vec<String>,
    buffer: Vec<u8>,
}

impl History {
    /// Reads a file, keeping the memory of the one read before.
    ///
    /// # Errors
    /// Where the file cannot be read, lacks a column, holds a cell that is no finite number, or its time does not run on.
    pub fn read(&mut self, file: &Path) -> Result<(), InputError> {
        self.columns.iter_mut().for_each(Vec::clear);
        self.unused.clear();
        self.buffer.clear();
        let mut buffer = std::mem::take(&mut self.buffer);
        let read = std::fs::File::open(file).and_then(|mut f| f.read_to_end(&mut buffer));
        let result = match read {
            Ok(_) => self.parse(file, &buffer),
            Err(error) => Err(InputError::io(file, &error)),
        };
        self.buffer = buffer;
        result?;
        self.check_time(file)
    }

    /// Time \[s\].
    pub fn time_s(&self) -> &[f64] {
        &self.columns[0]
    }

    /// Speed of the carriage \[m/s\].
    pub fn speed_m_s(&self) -> &[f64] {
        &self.columns[1]
    }

    /// Yaw angle \[deg\].
    pub fn yaw_deg(&self) -> &[f64] {
        &self.columns[2]
    }

    /// Sway \[m\], where recorded.
    pub fn sway_m(&self) -> Option<&[f64]> {
        self.has_sway.then_some(self.columns[3].as_slice())
    }

    /// The balance's channels: AF \[N\], SF \[N\], YM \[N m\].
    pub fn channels(&self) -> [&[f64]; 3] {
        [&self.columns[4], &self.columns[5], &self.columns[6]]
    }

    /// One of the balance's channels, to be put right.
    pub fn channel_mut(&mut self, channel: usize) -> &mut [f64] {
        &mut self.columns[4 + channel]
    }

    /// Mean interval between samples \[s\].
    pub fn interval_s(&self) -> f64 {
        let time = self.time_s();
        (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.columns[0].len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.columns[0].is_empty()
    }

    fn parse(&mut self, file: &Path, bytes: &[u8]) -> Result<(), InputError> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut lines = Lines { rest: bytes, number: 0 };
        let Some((header_line, header)) = lines.next() else {
            return Err(InputError::new(
                Place::file(file),
                "the file is empty, expected a header line with column names",
            ));
        };
        let places = self.header(file, header_line, header)?;
        let width = places.len();
        for (line, text) in lines {
            let mut cells = 0;
            for cell in text.split(|byte| *byte == b',') {
                if let Some(&place) = places.get(cells)
                    && place < COLUMNS.len()
                {
                    match number(cell) {
                        Some(value) => self.columns[place].push(value),
                        None => return Err(bad_cell(file, line, cells, COLUMNS[place], cell)),
                    }
                }
                cells += 1;
            }
            if cells != width {
                return Err(bad_width(file, line, cells, width));
            }
        }
        if self.len() < MIN_SAMPLES {
            let problem = format!("{} samples, expected at least {MIN_SAMPLES}", self.len());
            return Err(InputError::new(Place::file(file), problem));
        }
        Ok(())
    }

    /// Where each cell of a row goes; cells that are not used go nowhere.
    fn header(&mut self, file: &Path, line: usize, header: &[u8]) -> Result<Vec<usize>, InputError> {
        if header.contains(&0) {
            return Err(InputError::new(
                Place::file(file),
                "the file is no plain text, expected CSV in ASCII or UTF-8",
            )
            .help("exported by a spreadsheet as Unicode text? save it as CSV UTF-8"));
        }
        let text = String::from_utf8_lossy(header);
        if text.contains(';') && !text.contains(',') {
            return Err(InputError::new(
                Place::line(file, line),
                "columns are separated by semicolons, expected commas",
            )
            .help("write numbers with a decimal point and separate columns with commas"));
        }
        let names: Vec<String> = text.split(',').map(|name| name.trim().trim_matches('"').to_owned()).collect();
        let mut places = Vec::new();
        for (i, name) in names.iter().enumerate() {
            let place = COLUMNS.iter().position(|column| column == name).unwrap_or(COLUMNS.len());
            if place < COLUMNS.len() && places.contains(&place) {
                let place = Place::line(file, line).column(i + 1);
                return Err(InputError::new(place, format!("column {} stands twice", printable(name))));
            }
            if place == COLUMNS.len() {
                self.unused.push(name.clone());
            }
            places.push(place);
        }
        self.has_sway = places.contains(&OPTIONAL);
        let missing = (0..COLUMNS.len()).find(|i| *i != OPTIONAL && !places.contains(i));
        match missing {
            Some(missing) => Err(missing_column(Place::line(file, line), COLUMNS[missing], &names)),
            None => Ok(places),
        }
    }

    fn check_time(&self, file: &Path) -> Result<(), InputError> {
        let time = self.time_s();
        let interval = self.interval_s();
        for (i, pair) in time.windows(2).enumerate() {
            let step = pair[1] - pair[0];
            // Header and 1-based counting.
            let place = || Place::line(file, i + 3).column(1);
            if step <= 0.0 {
                let problem = format!("time_s is {} after {}, expected time to run on", pair[1], pair[0]);
                return Err(InputError::new(place(), problem));
            }
            if step > 0.5 && step > 5.0 * interval {
                let problem = format!("a gap of {step:.3} s, where samples come every {interval:.4} s");
                return Err(InputError::new(place(), problem).help("split the record or repeat the run"));
            }
        }
        Ok(())
    }
}

struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    /// The next line that is neither empty nor a remark.
    fn next(&mut self) -> Option<Self::Item> {
        while !self.rest.is_empty() {
            let end = memchr::memchr(b'\n', self.rest).unwrap_or(self.rest.len());
            let line = &self.rest[..end];
            self.rest = self.rest.get(end + 1..).unwrap_or_default();
            self.number += 1;
            let line = line.strip_suffix(b"\r").unwrap_or(line);
            if !line.is_empty() && line[0] != b'#' {
                return Some((self.number, line));
            }
        }
        None
    }
}

/// Powers of ten that a double holds exactly.
const POWERS: [f64; 16] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// A finite number. Up to 15 digits without exponent, the quotient of two exact doubles is the nearest double (Clinger
/// 1990); anything else goes the library's way.
#[inline]
fn number(cell: &[u8]) -> Option<f64> {
    let (negative, digits) = match cell {
        [b'-', rest @ ..] => (true, rest),
        rest => (false, rest),
    };
    if digits.is_empty() || digits.len() > 16 {
        return by_the_library(cell);
    }
    let (mut mantissa, mut count, mut places, mut point) = (0u64, 0, 0, false);
    for &byte in digits {
        let digit = byte.wrapping_sub(b'0');
        if digit < 10 {
            mantissa = mantissa * 10 + u64::from(digit);
            count += 1;
            places += usize::from(point);
        } else if byte == b'.' && !point {
            point = true;
        } else {
            return by_the_library(cell);
        }
    }
    if count == 0 || count > 15 {
        return by_the_library(cell);
    }
    let value = mantissa as f64 / POWERS[places];
    Some(if negative { -value } else { value })
}

#[cold]
fn by_the_library(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?.trim().trim_matches('"');
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

#[cold]
fn bad_cell(file: &Path, line: usize, cell: usize, column: &str, text: &[u8]) -> InputError {
    let text = String::from_utf8_lossy(text);
    not_a_number(Place::line(file, line).column(cell + 1), column, text.trim())
}

#[cold]
fn bad_width(file: &Path, line: usize, cells: usize, width: usize) -> InputError {
    let problem = format!("{cells} cells where the header names {width} columns");
    let error = InputError::new(Place::line(file, line), problem);
    if cells > width {
        error.help("decimal commas? write numbers with a decimal point")
    } else {
        error.help("is the file cut off?")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_standard_library() {
        for text in [
            "0",
            "-0.5",
            "12.3456",
            "-98765.4321",
            "0.00001",
            "123456789012345",
            "1e-3",
            "1.5E2",
            " 7.25 ",
            ".5",
            "5.",
            "0.1",
            "0.30000000000000004",
            "9007199254740993",
            "+3",
            "\"2.5\"",
        ] {
            let expected: f64 = text.trim().trim_matches('"').parse().unwrap();
            assert_eq!(number(text.as_bytes()), Some(expected), "{text}");
        }
        for text in ["", "-", ".", "1,5", "nan", "inf", "1.2.3", "abc", "--1"] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
    }
}
