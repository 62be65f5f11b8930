//! The files of one log: distinguished by their content, put in order of time whatever the order in which they are named,
//! read one after the other in bounded memory.
//!
//! A file that is damaged is left out with a warning where others are sound. Files of two gliders are no log.
//!
//! Knows the readers of each format; not what is done with the samples.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use super::calibration::Calibration;
use super::channels::{Channel, FlightLog};
use super::columns::Columns;
use super::file_order::Lacks;
use super::fix::{GpsFix, Positions};
use super::observation::Observation;
use super::open::{LogPieces, Opened};
use super::source::{Kind, Maker, Source, probe};
use super::time_again::TimeAgain;
use super::{ad2cp, file_order, og1, open, seaexplorer, seaglider, slocum};
use glidepolar_input::{InputError, Place, printable};

/// The next part of a log.
pub enum Piece {
    /// Samples of a time series.
    Series(Box<FlightLog>),
    /// A table with one row per leg.
    Glides(Vec<Observation>),
}

/// A log in any number of files.
pub struct LogFiles {
    columns: Columns,
    waiting: VecDeque<Source>,
    /// The file or the segment that is being read.
    open: Option<LogPieces>,
    segment: Option<slocum::Segment>,
    /// The last time of the segments so far; NaN before the first.
    last_s: f64,
    time_again: TimeAgain,
    /// The ballast volume counts from these counts of the pump, where several dives count from different ones.
    c_vbd_counts: Option<f64>,
    calibration: Option<Calibration>,
    positions: Positions,
    fixes: Vec<GpsFix>,
    lacks: Option<Lacks>,
    warnings: Vec<String>,
    notes: Vec<String>,
    /// Files that were begun, and why the first of them could not be read.
    begun: usize,
    failed: Option<InputError>,
    has_read: bool,
    has_speed: bool,
}

impl LogFiles {
    /// Looks into each of the files and puts them in order.
    ///
    /// # Errors
    /// A file that is not there, files of two gliders, and where no file is a log.
    pub fn open(paths: &[PathBuf], columns: &Columns) -> Result<Self, InputError> {
        let (mut sources, mut warnings, mut failed) = (Vec::new(), Vec::new(), None);
        let paths = file_order::each_once(paths, &mut warnings)?;
        for path in &paths {
            match probe(path, columns) {
                Ok(source) => sources.push(source),
                Err(error) if paths.len() == 1 => return Err(error),
                Err(error) => {
                    warnings.push(format!("left out: {error}"));
                    failed.get_or_insert(error);
                }
            }
        }
        if let (true, Some(error)) = (sources.is_empty(), &failed) {
            return Err(error.clone().beside(&warnings));
        }
        file_order::one_glider(&sources)?;
        let (mut sources, lacks) = file_order::segments(sources, &mut warnings);
        file_order::in_order(&mut sources, columns, &mut warnings);
        let calibration = sources.iter().rev().find_map(|source| match &source.kind {
            Kind::Seaglider(calibration) => Some((**calibration).clone()),
            _ => None,
        });
        Ok(LogFiles {
            columns: columns.clone(),
            waiting: sources.into(),
            open: None,
            segment: None,
            last_s: f64::NAN,
            time_again: TimeAgain::default(),
            c_vbd_counts: calibration.as_ref().and_then(|calibration| calibration.c_vbd_counts),
            calibration,
            positions: Positions::default(),
            fixes: Vec::new(),
            // Where its files were given and left out, the warnings say why.
            lacks: lacks.filter(|_| failed.is_none()),
            warnings,
            notes: Vec::new(),
            begun: 0,
            failed,
            has_read: false,
            has_speed: false,
        })
    }

    /// The next piece of about `rows` samples; nothing at the end.
    ///
    /// # Errors
    /// What cannot be read, with its place, where no other file is left to go on with.
    pub fn next_piece(&mut self, rows: usize) -> Result<Option<Piece>, InputError> {
        loop {
            if let Some(segment) = &mut self.segment {
                let (positions, fixes) = (&mut self.positions, &mut self.fixes);
                if let Some(mut piece) = segment.next_piece(positions, fixes, &mut self.warnings, &mut self.notes)? {
                    self.last_s = without_overlap(&mut piece, self.last_s);
                    self.has_read |= !piece.is_empty();
                    self.has_speed |= piece.has(Channel::Speed);
                    return Ok(Some(Piece::Series(Box::new(piece))));
                }
                self.segment = None;
            }
            if let Some(pieces) = &mut self.open {
                if let Some(mut piece) = pieces.next_piece(rows)? {
                    self.time_again.lay(&mut piece);
                    self.has_read |= !piece.is_empty();
                    self.has_speed |= piece.has(Channel::Speed);
                    return Ok(Some(Piece::Series(Box::new(piece))));
                }
                self.warnings.append(&mut pieces.take_warnings());
                self.open = None;
            }
            let Some(source) = self.waiting.pop_front() else { return self.end() };
            self.begun += 1;
            match self.begin(&source) {
                Ok(Some(glides)) => {
                    self.has_read = true;
                    return Ok(Some(Piece::Glides(glides)));
                }
                Ok(None) => {}
                Err(error) if matches!(source.kind, Kind::OneFile) => return Err(error),
                Err(error) => {
                    if self.begun > 1 || !self.waiting.is_empty() {
                        self.warnings.push(format!("left out: {error}"));
                    }
                    self.failed.get_or_insert(error);
                }
            }
        }
    }

    /// Files that were begun, and all of them; those of one segment count once.
    pub fn begun_of(&self) -> [usize; 2] {
        [self.begun, self.begun + self.waiting.len()]
    }

    /// What was left out, and other things a user should know of: complete at the end.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// What was found in the files and done about it: complete at the end.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// What to do about a channel without a value, where a file was left out, or the files of that computer are missing which has it.
    pub fn help(&self, channel: Channel) -> Option<String> {
        if self.failed.is_some() {
            return Some("a file that was left out may have it: see to its error".to_owned());
        }
        let of_science = [Channel::Density, Channel::Temperature, Channel::Conductivity, Channel::Salinity];
        let having = if of_science.contains(&channel) { Lacks::Science } else { Lacks::Flight };
        self.lacks.filter(|lacks| *lacks == having).map(Lacks::help)
    }

    /// Positions at the surface that the files hold, the first and the last of each surfacing, in the order of time: complete
    /// at the end.
    pub fn fixes(&self) -> Vec<GpsFix> {
        let mut fixes = self.fixes.clone();
        fixes.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        fixes.dedup();
        let follows = |one: Option<&GpsFix>, other: Option<&GpsFix>| match (one, other) {
            (Some(one), Some(other)) => other.time_s - one.time_s <= SAME_SURFACING_S,
            _ => false,
        };
        let is_between = |i: usize| {
            follows(i.checked_sub(1).and_then(|j| fixes.get(j)), fixes.get(i))
                && follows(fixes.get(i), fixes.get(i + 1))
        };
        (0..fixes.len()).filter(|i| !is_between(*i)).map(|i| fixes[i]).collect()
    }

    /// What the last dive's file says of the vehicle; Seaglider only.
    pub fn calibration(&self) -> Option<&Calibration> {
        self.calibration.as_ref()
    }

    /// Begins with a file; a table of glides comes back whole.
    fn begin(&mut self, source: &Source) -> Result<Option<Vec<Observation>>, InputError> {
        let path = &source.path;
        self.time_again.begin(source.begins_again);
        match &source.kind {
            Kind::Seaglider(calibration) => {
                let mut dive = seaglider::read(path, &self.columns)?;
                self.count_ballast_from_one_zero(path, calibration, &mut dive.log);
                self.fixes.append(&mut dive.fixes);
                let name = printable(&path.to_string_lossy());
                self.notes.extend(dive.notes.iter().map(|note| format!("{name}: {note}")));
                self.open = Some(LogPieces::Whole(Some(Box::new(dive.log))));
            }
            Kind::Segment(Maker::Slocum, paths) => self.segment = Some(slocum::Segment::open(paths, &self.columns)?),
            Kind::Segment(Maker::SeaExplorer, paths) => {
                let (positions, fixes) = (&mut self.positions, &mut self.fixes);
                let mut log = seaexplorer::read(paths, &self.columns, positions, fixes, &mut self.warnings)?;
                self.last_s = without_overlap(&mut log, self.last_s);
                self.open = Some(LogPieces::Whole(Some(Box::new(log))));
            }
            Kind::Part(_) => {}
            Kind::TimeSeries => {
                let log = og1::read(path, &self.columns, &mut self.warnings)?;
                self.fixes.extend(og1::fixes(path)?);
                self.open = Some(LogPieces::Whole(Some(Box::new(log))));
            }
            Kind::OneFile => match open(path, &self.columns)? {
                Opened::Series(pieces) => self.open = Some(*pieces),
                Opened::Glides(glides) => return Ok(Some(glides)),
            },
        }
        Ok(None)
    }

    /// A Seaglider counts its ballast volume from the pilot's `C_VBD`, which changes from dive to dive: the same number is
    /// another volume then. All dives are counted from the `C_VBD` of the last.
    fn count_ballast_from_one_zero(&mut self, path: &Path, calibration: &Calibration, log: &mut FlightLog) {
        let (Some(reference), Some(own)) = (self.c_vbd_counts, calibration.c_vbd_counts) else { return };
        if self.columns.chosen(Channel::Ballast).is_some() || own == reference {
            return;
        }
        let Some(shift) = calibration.ballast_shift_cc(reference) else { return };
        log.column_mut(Channel::Ballast).iter_mut().for_each(|cc| *cc += shift);
        self.notes.push(format!(
            "{}: ballast volume counted from C_VBD {own} in the file, from {reference} as on the last dive here: {shift:+.1} cc",
            printable(&path.to_string_lossy())
        ));
    }

    /// The end, where something was read.
    fn end(&mut self) -> Result<Option<Piece>, InputError> {
        match self.failed.take() {
            Some(error) if !self.has_read => return Err(error),
            failed => self.failed = failed,
        }
        if self.columns.chosen(Channel::Speed) == Some(ad2cp::NAME) && self.has_read && !self.has_speed {
            let why = self.notes.first().map(|note| format!("; {note}")).unwrap_or_default();
            let all =
                InputError::new(Place::file("--speed-column ad2cp"), format!("no speed in any of the files{why}"));
            return Err(all.help("it is read from the files of a Seaglider with an AD2CP"));
        }
        Ok(None)
    }
}

/// Fixes that follow one another within this time are of one surfacing: a dive takes longer \[s\].
const SAME_SURFACING_S: f64 = 300.0;

/// Takes off the rows that the segment before has already: the files of one end some rows after those of the next begin.
/// The last time so far comes back.
fn without_overlap(log: &mut FlightLog, last_s: f64) -> f64 {
    let time = log.column(Channel::Time);
    let Some(&end_s) = time.last() else { return last_s };
    if last_s.is_nan() || end_s <= last_s {
        return end_s;
    }
    let keep: Vec<bool> = time.iter().map(|time| *time > last_s).collect();
    log.retain(&keep);
    end_s
}
