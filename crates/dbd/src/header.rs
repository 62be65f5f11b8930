//! The text at the beginning of a file: what it is, and the list of its sensors.

use std::path::Path;

use crate::bytes::{Bytes, LABEL};
use crate::error::Error;

/// One sensor of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sensor {
    /// `m_depth`.
    pub name: String,
    /// `m`, `rad`, `nodim`.
    pub unit: String,
    /// Bytes of a value: 1, 2 (whole numbers), 4, 8 (floating point).
    pub bytes: usize,
}

/// What a file says of itself.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Header {
    /// All `key: value` lines, in their order.
    pub lines: Vec<(String, String)>,
    /// Sensors that the glider knows.
    pub total_num_sensors: usize,
    /// Sensors that the file stores.
    pub sensors_per_cycle: usize,
    /// Bytes of the two bits for each of these.
    pub state_bytes_per_cycle: usize,
    /// Checksum of the list of sensors, eight digits of lower case: the name of its cache file.
    pub sensor_list_crc: String,
    /// Whether the list stands in a cache file.
    pub sensor_list_factored: bool,
}

impl Header {
    /// A line of the header, empty where it is not there.
    pub fn get(&self, key: &str) -> &str {
        self.lines.iter().find(|(found, _)| found == key).map_or("", |(_, value)| value)
    }

    /// The glider, from the name that it gave to the file: `unit_887` of `unit_887-2021-321-3-0`.
    pub fn glider(&self) -> &str {
        let name = self.get("full_filename");
        let parts: Vec<&str> = name.rsplitn(5, '-').collect();
        if parts.len() == 5 { parts[4] } else { "" }
    }

    /// The segment, which flight and science file share: `unit_887-2021-321-3-0`.
    pub fn segment(&self) -> &str {
        self.get("full_filename")
    }

    /// When the file was opened, Unix time \[s\]: `Tue_Apr_18_16:49:57_2023`.
    pub fn opened_s(&self) -> Option<f64> {
        let text = self.get("fileopen_time").replace('_', " ");
        let parts: Vec<&str> = text.split_whitespace().collect();
        let [_, month, day, clock, year] = parts[..] else { return None };
        const MONTHS: [&str; 12] = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];
        let month = MONTHS.iter().position(|name| *name == month)? as i64 + 1;
        let clock: Vec<i64> = clock.split(':').map(|part| part.parse().ok()).collect::<Option<_>>()?;
        let [hour, minute, second] = clock[..] else { return None };
        let (year, day): (i64, i64) = (year.parse().ok()?, day.parse().ok()?);
        if !(1970..3000).contains(&year) {
            return None;
        }
        let days = days_since_1970(year, month, day);
        Some((((days * 24 + hour) * 60 + minute) * 60 + second) as f64)
    }
}

/// Days from 1970-01-01 to a date of the Gregorian calendar: the year begins in March, so that leap days are last.
pub fn days_since_1970(year: i64, month: i64, day: i64) -> i64 {
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let days_of_year = (153 * month + 2) / 5 + day - 1;
    let days = 365 * year + year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400) + days_of_year;
    days - 719_468
}

/// Longest line of a header, far beyond any real one.
const LONGEST_LINE: usize = 4096;

/// Most sensors of a glider, far beyond any real one.
const MOST_SENSORS: usize = 100_000;

/// Reads the lines of a header.
pub(crate) fn read(path: &Path, bytes: &mut Bytes) -> Result<Header, Error> {
    let begin = bytes.place(0);
    let start = bytes.ahead(LABEL.len())?;
    if start.is_empty() {
        if let Some(damage) = bytes.damages.first() {
            let error = Error::new(path, damage.problem.clone()).at(damage.place);
            return Err(error.help("nothing can be read of a file whose first block is not whole"));
        }
        return Err(Error::new(path, "the file is empty, expected a Slocum's binary file").at(begin));
    }
    if !start.starts_with(LABEL) {
        let help = "is it a file of another kind, or cut off before the end of its first block?";
        return Err(Error::new(path, "no `dbd_label` where a header should begin").at(begin).help(help));
    }
    let mut header = Header::default();
    let mut wanted = 14;
    while header.lines.len() < wanted {
        let at = bytes.place(0);
        let line = line(path, bytes)?;
        let (key, value) = line.split_once(':').ok_or_else(|| {
            Error::new(path, format!("`{}` in the header, expected `key: value`", shown(&line))).at(at)
        })?;
        let value = value.trim().to_owned();
        let count = |most: usize| {
            let number = value.parse::<usize>().ok().filter(|number| *number <= most);
            number.ok_or_else(|| Error::new(path, format!("`{key}` is `{}`, expected a number", shown(&value))).at(at))
        };
        match key.trim() {
            "num_ascii_tags" => wanted = count(100)?,
            "encoding_ver" if value != "5" => {
                let problem = format!("encoding version `{}`, only 5 is known", shown(&value));
                return Err(Error::new(path, problem).at(at));
            }
            "total_num_sensors" => header.total_num_sensors = count(MOST_SENSORS)?,
            "sensors_per_cycle" => header.sensors_per_cycle = count(MOST_SENSORS)?,
            "state_bytes_per_cycle" => header.state_bytes_per_cycle = count(MOST_SENSORS)?,
            "sensor_list_crc" => {
                let digits = value.to_lowercase();
                if digits.is_empty() || digits.len() > 8 || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
                    let problem =
                        format!("`sensor_list_crc` is `{}`, expected eight hexadecimal digits", shown(&value));
                    return Err(Error::new(path, problem).at(at));
                }
                header.sensor_list_crc = format!("{digits:0>8}");
            }
            "sensor_list_factored" => header.sensor_list_factored = count(1)? == 1,
            _ => {}
        }
        header.lines.push((key.trim().to_owned(), value));
    }
    let state_bytes = header.sensors_per_cycle.div_ceil(4);
    if header.sensors_per_cycle == 0 || header.state_bytes_per_cycle != state_bytes {
        let problem = format!(
            "{} sensors in {} state bytes, expected {state_bytes} bytes",
            header.sensors_per_cycle, header.state_bytes_per_cycle
        );
        return Err(Error::new(path, problem).at(begin));
    }
    Ok(header)
}

/// Reads the list of sensors that follows a header whose list is not factored; the stored ones come back.
pub(crate) fn read_list(path: &Path, bytes: &mut Bytes, header: &Header) -> Result<Vec<Sensor>, Error> {
    let mut list = List::default();
    for _ in 0..header.total_num_sensors {
        let at = bytes.place(0);
        let text = line(path, bytes)?;
        list.take(&text).map_err(|problem| Error::new(path, problem).at(at))?;
    }
    let at = bytes.place(0);
    if list.crc() != header.sensor_list_crc {
        // Some loggers end lines in another way; what the lines say is what counts.
        let (found, stated) = (list.crc(), &header.sensor_list_crc);
        bytes.damaged(
            at,
            format!("the list of sensors has the checksum {found}, its header says {stated}; it is used as it is"),
        );
    }
    list.finish(path, header).map_err(|error| error.at(at))
}

/// A list of sensors on its way.
#[derive(Default)]
pub(crate) struct List {
    stored: Vec<(usize, Sensor)>,
    lines: usize,
    checksum: crc32fast::Hasher,
}

impl List {
    /// Takes a line, `s: T    0    0 4 m_depth m`.
    pub(crate) fn take(&mut self, line: &str) -> Result<(), String> {
        let wrong = || format!("`{}` in the list of sensors, expected `s: T 0 0 4 NAME UNIT`", shown(line));
        let parts: Vec<&str> = line.split_whitespace().collect();
        let ["s:", flag, _, index, bytes, name, ref unit @ ..] = parts[..] else { return Err(wrong()) };
        self.checksum.update(line.as_bytes());
        self.checksum.update(b"\n");
        self.lines += 1;
        match flag {
            "F" => Ok(()),
            "T" => {
                let index = index.parse().map_err(|_| wrong())?;
                let bytes = bytes.parse().ok().filter(|bytes| [1, 2, 4, 8].contains(bytes)).ok_or_else(wrong)?;
                let unit = unit.first().copied().unwrap_or("").to_owned();
                self.stored.push((index, Sensor { name: name.to_owned(), unit, bytes }));
                Ok(())
            }
            _ => Err(wrong()),
        }
    }

    /// The checksum as the glider makes it: CRC-32 of the lines without the inversion at its end.
    pub(crate) fn crc(&self) -> String {
        format!("{:08x}", !self.checksum.clone().finalize())
    }

    /// The stored sensors in the order of their bits, as many as the header says.
    pub(crate) fn finish(mut self, path: &Path, header: &Header) -> Result<Vec<Sensor>, Error> {
        self.stored.sort_by_key(|(index, _)| *index);
        let is_row = self.stored.iter().enumerate().all(|(i, (index, _))| i == *index);
        if self.lines != header.total_num_sensors || self.stored.len() != header.sensors_per_cycle || !is_row {
            let problem = format!(
                "{} sensors, {} of them stored, the header of the data says {} and {}",
                self.lines,
                self.stored.len(),
                header.total_num_sensors,
                header.sensors_per_cycle
            );
            return Err(Error::new(path, problem).help("is it the list of another file?"));
        }
        Ok(self.stored.into_iter().map(|(_, sensor)| sensor).collect())
    }
}

fn line(path: &Path, bytes: &mut Bytes) -> Result<String, Error> {
    let at = bytes.place(0);
    let mut wanted = 256;
    loop {
        let ahead = bytes.ahead(wanted)?;
        let found = ahead.iter().take(LONGEST_LINE).position(|byte| *byte == b'\n');
        if let Some(length) = found {
            let text = String::from_utf8_lossy(&ahead[..length]).trim_end_matches('\r').to_owned();
            bytes.skip(length + 1);
            return Ok(text);
        }
        if ahead.len() < wanted {
            return Err(Error::new(path, "the file ends inside its header").at(at).help("was it cut off?"));
        }
        if wanted > LONGEST_LINE {
            return Err(Error::new(path, "no end of a line in the header").at(at).help("is the file damaged?"));
        }
        wanted *= 4;
    }
}

/// Text of a file for a message.
pub(crate) fn shown(text: &str) -> String {
    text.chars().take(60).flat_map(char::escape_default).collect()
}

/// Whether two headers stand before data of one kind.
pub(crate) fn same_list(first: &Header, other: &Header) -> bool {
    (&first.sensor_list_crc, first.sensors_per_cycle) == (&other.sensor_list_crc, other.sensors_per_cycle)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(lines: &[(&str, &str)]) -> Header {
        let lines = lines.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        Header { lines, ..Header::default() }
    }

    #[test]
    fn the_time_of_opening_is_a_date() {
        for (text, expected) in [
            ("Thu_Jan__1_00:00:00_1970", Some(0.0)),
            ("Tue_Apr_18_16:49:57_2023", Some(1_681_836_597.0)),
            ("Thu_Feb_29_12:00:00_2024", Some(1_709_208_000.0)),
            ("soon", None),
        ] {
            assert_eq!(header(&[("fileopen_time", text)]).opened_s(), expected, "{text}");
        }
    }

    #[test]
    fn the_glider_is_in_the_name_of_the_file() {
        for (name, glider) in [("unit_887-2021-321-3-0", "unit_887"), ("a-b-2014-204-05-000", "a-b"), ("12345678", "")]
        {
            assert_eq!(header(&[("full_filename", name)]).glider(), glider);
        }
    }

    #[test]
    fn a_line_that_is_no_sensor_is_refused() {
        let mut list = List::default();
        assert!(list.take("s: T    0    0 4 m_depth m").is_ok());
        for wrong in ["", "s: T 0 0 3 m_depth m", "s: X 0 0 4 m_depth m", "t: T 0 0 4 a b", "s: T 0 x 4 a b"] {
            assert!(list.take(wrong).unwrap_err().contains("expected"), "{wrong}");
        }
    }
}
