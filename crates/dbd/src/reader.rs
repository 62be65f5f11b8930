//! One file, cycle by cycle.

use std::path::{Path, PathBuf};

use crate::bytes::{Bytes, LABEL, is_compressed};
use crate::cache::Caches;
use crate::cycles::{Layout, NEW, NOT_SET};
use crate::error::{Damage, Error};
use crate::header::{self, Header, Sensor};

/// Whether a file that begins with these bytes, 64 of them or more, is one of a Slocum's, compressed or not.
pub fn is_one(start: &[u8]) -> bool {
    start.starts_with(LABEL) || is_compressed(start)
}

/// The values of one cycle, in the order in which sensors were selected; NaN for what is not set.
pub struct Cycle<'a> {
    /// Values, those that are as before among them.
    pub values: &'a [f64],
    states: &'a [u8],
    /// Whether it is the first of its file, with the last value of every sensor, however old; where another file was put
    /// behind the first, its first cycle as well.
    pub is_first: bool,
}

impl Cycle<'_> {
    /// Whether the value of this selected sensor is new in the cycle.
    pub fn is_new(&self, sensor: usize) -> bool {
        self.states[sensor] == NEW
    }

    /// Whether it is new, or as before.
    pub fn is_set(&self, sensor: usize) -> bool {
        self.states[sensor] != NOT_SET
    }
}

/// A file that is being read.
pub struct Reader {
    path: PathBuf,
    bytes: Bytes,
    caches: Caches,
    header: Header,
    sensors: Vec<Sensor>,
    selected: Vec<String>,
    layout: Layout,
    is_big_endian: bool,
    memory: Vec<f64>,
    values: Vec<f64>,
    states: Vec<u8>,
    /// The time of the last cycle.
    last_s: Option<f64>,
    /// Whether no cycle was read since a file began.
    is_at_first: bool,
    ended: bool,
    /// Bytes of a last cycle that was cut off.
    cut_off: Option<usize>,
}

/// Bytes of the known cycle: `s`, `a`, 0x1234, 123.456, 123456789.12345.
const KNOWN: usize = 16;

/// So many whole cycles one after the other are no accident of damaged bytes.
const CHAIN: usize = 3;

/// Longest time between two cycles around damage \[s\]: a mission lasts no longer.
const LONGEST_S: f64 = 400.0 * 86_400.0;

impl Reader {
    /// Opens a file, reads its header and finds its list of sensors.
    ///
    /// # Errors
    /// A file that is none of a Slocum's, one whose header is damaged, one whose list of sensors is not to be found.
    pub fn open(path: impl AsRef<Path>, caches: &Caches) -> Result<Self, Error> {
        let path = path.as_ref();
        let mut bytes = Bytes::open(path)?;
        let header = header::read(path, &mut bytes)?;
        let sensors = sensors(path, &mut bytes, &header, caches)?;
        let is_big_endian = match known_cycle(path, &mut bytes) {
            Ok(order) => order,
            // A file that ends with its header is whole, and empty.
            Err(_) if bytes.ahead(1)?.is_empty() => false,
            Err(error) => return Err(error),
        };
        let mut reader = Reader {
            path: path.to_owned(),
            bytes,
            caches: caches.clone(),
            header,
            layout: Layout::new(&sensors, &[], is_big_endian),
            sensors,
            selected: Vec::new(),
            is_big_endian,
            memory: Vec::new(),
            values: Vec::new(),
            states: Vec::new(),
            last_s: None,
            is_at_first: true,
            ended: false,
            cut_off: None,
        };
        let all: Vec<String> = reader.sensors.iter().map(|sensor| sensor.name.clone()).collect();
        reader.select(&all);
        Ok(reader)
    }

    /// Reads these sensors only, in this order; names that the file has not are never set. All are read unless it is called.
    pub fn select<T: AsRef<str>>(&mut self, names: &[T]) {
        self.selected = names.iter().map(|name| name.as_ref().to_owned()).collect();
        self.lay_out();
    }

    /// What the file says of itself.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The sensors that it stores.
    pub fn sensors(&self) -> &[Sensor] {
        &self.sensors
    }

    /// What was damaged so far, and what was done about it.
    pub fn damages(&self) -> &[Damage] {
        &self.bytes.damages
    }

    /// Bytes of a last cycle that was cut off, where one was: normal for files that were sent, or written when power failed.
    pub fn cut_off(&self) -> Option<usize> {
        self.cut_off
    }

    /// The next cycle; nothing at the end.
    ///
    /// # Errors
    /// Where the file cannot be read any further.
    pub fn next_cycle(&mut self) -> Result<Option<Cycle<'_>>, Error> {
        while !self.ended {
            let head = 1 + self.layout.state_bytes;
            let ahead = self.bytes.ahead(head.max(LABEL.len()))?;
            match ahead {
                [] => self.end_or_hole()?,
                label if label.starts_with(LABEL) => self.again_header()?,
                [b'X', ..] => {
                    self.bytes.skip(1);
                    let rest = self.bytes.ahead(LABEL.len())?;
                    let (is_end, is_header) = (rest.is_empty(), rest.starts_with(LABEL));
                    if is_end && self.bytes.hole.is_none() {
                        self.ended = true;
                    } else if !is_header {
                        self.find_again("after the end of the data")?;
                    }
                }
                [b'd', ..] if ahead.len() < head => self.cut()?,
                [b'd', states @ ..] => {
                    let Some(data) = self.layout.data_bytes(&states[..self.layout.state_bytes]) else {
                        self.find_again("both bits of a sensor are set")?;
                        continue;
                    };
                    let size = head + data;
                    let ahead = self.bytes.ahead(size + 1)?;
                    if ahead.len() < size {
                        self.cut()?;
                        continue;
                    }
                    // What follows tells a damaged cycle from a sound one before damage.
                    let is_followed = matches!(ahead.get(size), None | Some(b'd' | b'X'));
                    let time = self.layout.time(ahead);
                    if !is_followed && !is_likely(time, self.last_s) {
                        self.find_again("no cycle begins where this one ends")?;
                        continue;
                    }
                    self.layout.read(&ahead[..size], &mut self.memory, &mut self.values, &mut self.states);
                    self.last_s = time.or(self.last_s);
                    self.bytes.skip(size);
                    let is_first = std::mem::replace(&mut self.is_at_first, false);
                    return Ok(Some(Cycle { values: &self.values, states: &self.states, is_first }));
                }
                _ => self.find_again("no cycle begins here")?,
            }
        }
        Ok(None)
    }

    /// The end of the contents, or a hole in them.
    fn end_or_hole(&mut self) -> Result<(), Error> {
        if self.bytes.hole.is_none() {
            self.ended = true;
            return Ok(());
        }
        self.find_again("a block is missing")
    }

    /// A cycle of which the last bytes are not there.
    fn cut(&mut self) -> Result<(), Error> {
        if self.bytes.hole.is_some() {
            return self.find_again("the cycle is cut off by a missing block");
        }
        self.cut_off = Some(self.bytes.ahead(self.layout.most())?.len());
        self.ended = true;
        Ok(())
    }

    /// A header in the place of a cycle: some firmware repeats it; or another file was put behind this one.
    fn again_header(&mut self) -> Result<(), Error> {
        let place = self.bytes.place(0);
        let begin = self.read_header();
        match begin {
            Ok((header, sensors, is_big_endian)) => {
                if !header::same_list(&self.header, &header) || self.header.segment() != header.segment() {
                    let problem = format!(
                        "another file begins here, `{}`; it is read on; split the file here, that each part is merged with \
                         the file of the glider's other computer",
                        header.segment().escape_debug()
                    );
                    self.bytes.damaged(place, problem);
                    self.memory.fill(f64::NAN);
                    self.is_at_first = true;
                }
                (self.header, self.sensors, self.is_big_endian) = (header, sensors, is_big_endian);
                let memory = std::mem::take(&mut self.memory);
                self.lay_out();
                self.memory = memory;
                Ok(())
            }
            Err(error) => {
                let help = error.help.map(|help| format!("; {help}")).unwrap_or_default();
                self.bytes.damaged(error.place, format!("a header in the middle of the file: {}{help}", error.problem));
                self.find_again("no cycle begins here")
            }
        }
    }

    fn read_header(&mut self) -> Result<(Header, Vec<Sensor>, bool), Error> {
        let header = header::read(&self.path, &mut self.bytes)?;
        let sensors = if header::same_list(&self.header, &header) && header.sensor_list_factored {
            self.sensors.clone()
        } else {
            sensors(&self.path, &mut self.bytes, &header, &self.caches)?
        };
        let is_big_endian = known_cycle(&self.path, &mut self.bytes)?;
        Ok((header, sensors, is_big_endian))
    }

    /// Looks for the next place where whole cycles follow one another, by their tags, bits and times.
    fn find_again(&mut self, why: &str) -> Result<(), Error> {
        let place = self.bytes.place(0);
        let mut passed = 0u64;
        // The place itself is wrong, but behind a hole it may be right.
        if self.bytes.hole.is_some() && self.bytes.ahead(1)?.is_empty() {
            self.bytes.pass_hole();
        } else {
            passed += self.step()?;
        }
        let reach = CHAIN * self.layout.most() + 1;
        loop {
            let ahead = self.bytes.ahead(reach)?;
            if ahead.is_empty() {
                if self.bytes.hole.is_none() {
                    self.ended = true;
                    self.report(place, why, passed, "to the end of the file");
                    return Ok(());
                }
                self.bytes.pass_hole();
                continue;
            }
            let is_last = ahead.len() < reach;
            if ahead.starts_with(LABEL) || is_chain(&self.layout, ahead, self.last_s, is_last) {
                self.memory.fill(f64::NAN);
                self.report(place, why, passed, "up to the next whole cycles");
                return Ok(());
            }
            // No cycle begins with anything else than `d`.
            let next = ahead[1..].iter().position(|byte| *byte == b'd').map_or(ahead.len(), |at| at + 1);
            self.bytes.skip(next);
            passed += next as u64;
        }
    }

    fn step(&mut self) -> Result<u64, Error> {
        let is_there = !self.bytes.ahead(1)?.is_empty();
        self.bytes.skip(1);
        Ok(u64::from(is_there))
    }

    fn report(&mut self, place: crate::error::Place, why: &str, passed: u64, what: &str) {
        self.bytes.damaged(place, format!("{why}: {passed} bytes left out {what}"));
    }

    fn lay_out(&mut self) {
        self.layout = Layout::new(&self.sensors, &self.selected, self.is_big_endian);
        self.memory = vec![f64::NAN; self.selected.len()];
        self.values = self.memory.clone();
        self.states = vec![NOT_SET; self.selected.len()];
    }
}

/// Whether a time can be that of the next cycle.
fn is_likely(time: Option<f64>, last_s: Option<f64>) -> bool {
    match (time, last_s) {
        (Some(time), Some(last)) => (time - last).abs() < LONGEST_S,
        (time, _) => time.is_some(),
    }
}

/// Whether whole cycles follow one another here.
fn is_chain(layout: &Layout, ahead: &[u8], last_s: Option<f64>, is_last: bool) -> bool {
    let head = 1 + layout.state_bytes;
    let (mut at, mut last_s) = (0, last_s);
    for number in 0..CHAIN {
        let here = &ahead[at..];
        match here {
            [] | [b'X'] => return is_last && number > 0,
            [b'd', states @ ..] if states.len() >= layout.state_bytes => {
                let Some(data) = layout.data_bytes(&states[..layout.state_bytes]) else { return false };
                if here.len() < head + data {
                    return is_last && number > 0;
                }
                if layout.has_clock() {
                    let Some(time) = layout.time(here) else { return false };
                    let follows = |last: f64| (time - last).abs() < LONGEST_S && (number == 0 || time >= last);
                    if !last_s.is_none_or(follows) {
                        return false;
                    }
                    last_s = Some(time);
                }
                at += head + data;
            }
            [b'd', ..] => return is_last && number > 0,
            _ => return false,
        }
    }
    matches!(ahead.get(at), None | Some(b'd' | b'X'))
}

fn sensors(path: &Path, bytes: &mut Bytes, header: &Header, caches: &Caches) -> Result<Vec<Sensor>, Error> {
    if header.sensor_list_factored { caches.find(path, header) } else { header::read_list(path, bytes, header) }
}

/// Reads the cycle of known values; whether the most significant bytes come first.
fn known_cycle(path: &Path, bytes: &mut Bytes) -> Result<bool, Error> {
    let place = bytes.place(0);
    let found = bytes.ahead(KNOWN)?;
    let is = |number: [u8; 2]| found.len() >= KNOWN && found[..2] == *b"sa" && found[2..4] == number;
    let order = if is([0x12, 0x34]) {
        true
    } else if is([0x34, 0x12]) {
        false
    } else {
        let error = Error::new(path, "no cycle of known values behind the header, so the order of bytes is unknown");
        return Err(error.at(place).help("is the file cut off there, or damaged?"));
    };
    bytes.skip(KNOWN);
    Ok(order)
}
