//! The dialect of a table: its comments, what separates its cells, and errors with their line. Knows no column.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use glidepolar_input::{InputError, Place};

/// A reader for the dialect: `#` comments, blanks around cells allowed, cells separated as in the line of names.
pub(super) fn reader(path: &Path) -> Result<::csv::Reader<File>, InputError> {
    let separator = separator(path)?;
    let mut file = File::open(path).map_err(|error| InputError::io(path, &error))?;
    skip_separator_line(&mut file).map_err(|error| InputError::io(path, &error))?;
    let mut builder = ::csv::ReaderBuilder::new();
    builder.comment(Some(b'#')).trim(::csv::Trim::All).flexible(true).delimiter(separator);
    Ok(builder.from_reader(file))
}

/// A spreadsheet's `sep=;` above the names is no line of the table.
fn skip_separator_line(file: &mut File) -> std::io::Result<()> {
    let mut start = [0u8; 16];
    let read = file.read(&mut start)?;
    let text = start[..read].strip_prefix(b"\xef\xbb\xbf").unwrap_or(&start[..read]);
    let line = text.iter().position(|byte| *byte == b'\n').filter(|_| text.starts_with(b"sep="));
    let at = line.map_or(0, |line| (read - text.len()) + line + 1);
    file.seek(SeekFrom::Start(at as u64)).map(|_| ())
}

/// What separates the names in the first line that is no comment: tabs before semicolons before bars before commas, since a
/// name may hold the latter.
fn separator(path: &Path) -> Result<u8, InputError> {
    /// Longest beginning that is looked into.
    const LONGEST: u64 = 1 << 16;
    let mut start = Vec::new();
    let file = File::open(path).map_err(|error| InputError::io(path, &error))?;
    file.take(LONGEST).read_to_end(&mut start).map_err(|error| InputError::io(path, &error))?;
    let lines = start.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let is_names = |line: &&[u8]| !line.is_empty() && !line.starts_with(b"#") && !line.starts_with(b"sep=");
    let names = lines.into_iter().find(is_names).unwrap_or_default();
    Ok([b'\t', b';', b'|'].into_iter().find(|separator| names.contains(separator)).unwrap_or(b','))
}

pub(super) fn csv_error(path: &Path, error: &::csv::Error) -> InputError {
    let place = match error.position() {
        Some(position) => Place::line(path, position.line() as usize),
        None => Place::file(path),
    };
    InputError::new(place, error.to_string())
}
