//! Which files of a log are read, and in which order: each once, those of a segment together, by time whatever the order in
//! which they are named.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use super::columns::Columns;
use super::source::{Kind, Maker, Source};
use glidepolar_input::memory::Table;
use glidepolar_input::{InputError, Place, printable};

/// The files without those whose content another one before them has.
///
/// # Errors
/// A file that is not there: a name that was mistyped is no damage.
pub(super) fn each_once(paths: &[PathBuf], warnings: &mut Vec<String>) -> Result<Vec<PathBuf>, InputError> {
    let mut once: Vec<(PathBuf, u64)> = Vec::new();
    for path in paths {
        let bytes = match Table::named(path) {
            Some(_) => 0,
            None => {
                let file = File::open(path).map_err(|error| InputError::io(path, &error))?;
                file.metadata().map_or(0, |data| data.len())
            }
        };
        match once.iter().find(|(other, size)| other == path || (*size == bytes && is_copy(other, path))) {
            Some((other, _)) if other == path => {
                warnings.push(format!("left out: {} is named twice", printable(&path.to_string_lossy())));
            }
            Some((other, _)) => warnings.push(format!(
                "left out: {} has the same content as {}, so it is there twice",
                printable(&path.to_string_lossy()),
                printable(&other.to_string_lossy())
            )),
            None => once.push((path.clone(), bytes)),
        }
    }
    Ok(once.into_iter().map(|(path, _)| path).collect())
}

/// Whether two files have the same bytes. Files that cannot be read have none.
fn is_copy(one: &Path, other: &Path) -> bool {
    let (Ok(one), Ok(other)) = (File::open(one), File::open(other)) else { return false };
    let (mut one, mut other) = (BufReader::new(one).bytes(), BufReader::new(other).bytes());
    loop {
        match (one.next(), other.next()) {
            (None, None) => return true,
            (Some(Ok(a)), Some(Ok(b))) if a == b => {}
            _ => return false,
        }
    }
}

/// A segment: whose, its name, which of the sources it became, and the files of both computers with their ranks.
type Known = (Maker, String, usize, [Option<(u8, PathBuf)>; 2]);

/// Puts the files of each segment together: one of each computer, the fullest. Which computer's files all segments lack comes
/// back with them.
pub(super) fn segments(sources: Vec<Source>, warnings: &mut Vec<String>) -> (Vec<Source>, Option<Lacks>) {
    let mut whole: Vec<Source> = Vec::new();
    let mut known: Vec<Known> = Vec::new();
    for source in sources {
        let Kind::Part(part) = &source.kind else {
            whole.push(source);
            continue;
        };
        let found = known.iter().position(|(maker, segment, ..)| *maker == part.maker && *segment == part.segment);
        let index = found.unwrap_or_else(|| {
            known.push((part.maker, part.segment.clone(), whole.len(), [None, None]));
            let kind = Kind::Segment(part.maker, Vec::new());
            whole.push(Source {
                path: source.path.clone(),
                kind,
                glider: source.glider.clone(),
                start_s: source.start_s,
                begins_again: false,
            });
            known.len() - 1
        });
        let (_, _, at, files) = &mut known[index];
        let place = &mut files[usize::from(part.is_science)];
        let mut left_out = Some((part.rank, source.path.clone()));
        if place.as_ref().is_none_or(|(rank, _)| *rank < part.rank) {
            left_out = place.replace((part.rank, source.path.clone()));
        }
        if let Some((_, path)) = left_out {
            let name = printable(&path.to_string_lossy());
            warnings.push(format!("left out: {name}, since a fuller record of the same segment is among the files"));
        }
        whole[*at].start_s = whole[*at].start_s.min(source.start_s);
        whole[*at].kind = Kind::Segment(part.maker, files.iter().flatten().map(|(_, path)| path.clone()).collect());
    }
    let lacks = [Lacks::Flight, Lacks::Science].into_iter().find(|lacks| {
        let without = |(.., files): &&Known| files[usize::from(*lacks == Lacks::Science)].is_none();
        let found: Vec<&Known> = known.iter().filter(without).collect();
        if let Some((_, segment, ..)) = found.first().filter(|_| found.len() < known.len()) {
            warnings.push(format!(
                "{} of {} segments have no file of {}, the first is {}: their rows have none of its sensors",
                found.len(),
                known.len(),
                lacks.computer(),
                printable(segment)
            ));
        }
        !known.is_empty() && found.len() == known.len()
    });
    (whole, lacks)
}

/// The computer of which no file is there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Lacks {
    Flight,
    Science,
}

impl Lacks {
    fn computer(self) -> &'static str {
        match self {
            Lacks::Flight => "the flight computer (a Slocum's .dbd, .mbd or .sbd, a SeaExplorer's gli)",
            Lacks::Science => "the science computer (a Slocum's .ebd, .nbd or .tbd, a SeaExplorer's pld1)",
        }
    }

    /// What to do where values are missing that this computer has.
    pub(super) fn help(self) -> String {
        format!("no file is one of {}: give them too", self.computer())
    }
}

pub(super) fn one_glider(sources: &[Source]) -> Result<(), InputError> {
    let mut named = sources.iter().filter(|source| !source.glider.is_empty());
    let Some(first) = named.next() else { return Ok(()) };
    match named.find(|other| !is_same(&other.glider, &first.glider)) {
        None => Ok(()),
        Some(other) => {
            let problem = format!(
                "is of the glider {}, {} is of {}",
                printable(&other.glider),
                printable(&first.path.to_string_lossy()),
                printable(&first.glider)
            );
            Err(InputError::new(Place::file(&other.path), problem).help("give the files of one glider"))
        }
    }
}

/// Whether two names are of one glider. A Slocum whose name was lost calls itself `unit_` and its number.
fn is_same(one: &str, other: &str) -> bool {
    let number = |name: &str| name.chars().rev().take_while(char::is_ascii_digit).collect::<String>();
    let is_unnamed = one.starts_with("unit_") || other.starts_with("unit_");
    one.eq_ignore_ascii_case(other) || (is_unnamed && !number(one).is_empty() && number(one) == number(other))
}

/// Sorts by time where all times are known; a record that is there twice is taken once.
pub(super) fn in_order(sources: &mut Vec<Source>, columns: &Columns, warnings: &mut Vec<String>) {
    if sources.iter().any(|source| source.start_s.is_nan()) {
        return by_own_times(sources, columns, warnings);
    }
    sources.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
    let mut last = f64::NAN;
    sources.retain(|source| {
        let is_new = source.start_s != last;
        if !is_new {
            let name = printable(&source.path.to_string_lossy());
            warnings.push(format!(
                "left out: {name} begins with the same time as the file before it, so it is there twice"
            ));
        }
        last = source.start_s;
        is_new
    });
}

/// Tables whose times count from a start of their own: by these times where they follow one another, as parts of one record do.
/// Where they begin again, nothing says which came first: the order in which they are named is taken, with a warning.
fn by_own_times(sources: &mut [Source], columns: &Columns, warnings: &mut Vec<String>) {
    if sources.iter().filter(|source| source.start_s.is_nan()).count() < 2 {
        return;
    }
    let spans: Vec<Option<[f64; 2]>> = sources.iter().map(|source| source.own_times_s(columns)).collect();
    let mut sorted: Vec<[f64; 2]> = spans.iter().flatten().copied().collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let begins_again = |pair: &[[f64; 2]]| {
        let shorter_s = pair.iter().map(|[first, last]| last - first).fold(f64::INFINITY, f64::min);
        pair[0][1] - pair[1][0] > MOST_OVERLAP * shorter_s
    };
    if !sorted.windows(2).any(begins_again) {
        if sorted.len() == sources.len() {
            let mut first_s = spans.iter().map(|span| span.map_or(f64::NAN, |[first, _]| first));
            sources.iter_mut().for_each(|source| source.start_s = first_s.next().unwrap_or(f64::NAN));
            sources.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
        }
        return;
    }
    let mut names = Vec::new();
    for (source, _) in sources.iter_mut().zip(&spans).filter(|(_, span)| span.is_some()) {
        source.begins_again = !names.is_empty();
        names.push(printable(&source.path.to_string_lossy()));
    }
    let more = names.len().saturating_sub(MOST_NAMES);
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    warnings.push(format!(
        "the times of {}{rest} begin again in each and state no date, so nothing says which came first: they are taken in the order \
         in which they are named, each an hour behind the one before; name them in the order of time, or give dates or seconds since \
         1970 in `time_s`",
        names[..names.len() - more].join(", ")
    ));
}

/// Parts of one record share a few rows at most. Records that share more than this of the shorter one have starts of their own.
const MOST_OVERLAP: f64 = 0.5;

/// Files that a warning names.
const MOST_NAMES: usize = 4;
