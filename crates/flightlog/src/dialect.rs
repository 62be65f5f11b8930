//! The dialect of a table: its comments, what separates its cells, and on which line of the file a row stands. Knows no
//! column.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use ::csv::ByteRecord;
use glidepolar_input::lines::LineCounter;
use glidepolar_input::{InputError, Place};

/// The rows of a table, one after the other: `#` comments, blanks around cells allowed, cells separated as in the line of
/// names.
pub(super) struct Rows {
    path: PathBuf,
    reader: ::csv::Reader<File>,
    /// Bytes before the first that the reader sees.
    skipped: u64,
    lines: Lines,
}

impl Rows {
    /// Opens a table, before its line of names.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub(super) fn open(path: &Path) -> Result<Self, InputError> {
        let io = |error: std::io::Error| InputError::io(path, &error);
        let separator = separator(path)?;
        let mut file = File::open(path).map_err(io)?;
        let skipped = skip_separator_line(&mut file).map_err(io)?;
        let mut builder = ::csv::ReaderBuilder::new();
        builder.comment(Some(b'#')).trim(::csv::Trim::All).flexible(true).delimiter(separator);
        Ok(Rows { path: path.to_owned(), reader: builder.from_reader(file), skipped, lines: Lines::default() })
    }

    /// Reads the line of names.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub(super) fn names(&mut self) -> Result<&ByteRecord, InputError> {
        self.reader.byte_headers().map_err(|error| csv_error(&self.path, &error))
    }

    /// Reads the next row; false at the end.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub(super) fn next(&mut self, row: &mut ByteRecord) -> Result<bool, InputError> {
        self.reader.read_byte_record(row).map_err(|error| csv_error(&self.path, &error))
    }

    /// Returns the file's own line of the row that was read last, or of the names; that on which it ends, where quotation
    /// marks hold ends of lines. Comments and empty lines count as any other.
    pub(super) fn line(&mut self) -> usize {
        // The reader's own count lags where it skips lines before a row, and where a line ends in two bytes.
        let end = self.skipped + self.reader.position().byte();
        self.lines.ending_at(&self.path, end).unwrap_or(0)
    }

    /// Returns the place of the row that was read last.
    pub(super) fn place(&mut self) -> Place {
        match self.line() {
            0 => Place::file(&self.path),
            line => Place::line(&self.path, line),
        }
    }
}

/// Counts the lines of a file as far as they are asked for.
#[derive(Default)]
struct Lines {
    file: Option<File>,
    at: u64,
    counter: LineCounter,
}

impl Lines {
    /// The line of a row that ends before a byte, its end of line included; the byte never falls. Nothing where the file
    /// cannot be read again.
    fn ending_at(&mut self, path: &Path, end: u64) -> Option<usize> {
        if self.file.is_none() {
            self.file = Some(File::open(path).ok()?);
        }
        let mut rest = self.file.as_mut()?.take(end.saturating_sub(self.at));
        let mut buffer = [0u8; 1 << 13];
        loop {
            match rest.read(&mut buffer).ok()? {
                0 => return Some(self.counter.line()),
                read => {
                    self.counter.take(&buffer[..read]);
                    self.at += read as u64;
                }
            }
        }
    }
}

/// Skips a spreadsheet's `sep=;` above the names, which is no line of the table; how many bytes it has comes back.
fn skip_separator_line(file: &mut File) -> std::io::Result<u64> {
    let mut start = [0u8; 16];
    let read = file.read(&mut start)?;
    let text = start[..read].strip_prefix(b"\xef\xbb\xbf").unwrap_or(&start[..read]);
    let line = text.iter().position(|byte| *byte == b'\n').filter(|_| text.starts_with(b"sep="));
    let at = line.map_or(0, |line| (read - text.len()) + line + 1);
    file.seek(SeekFrom::Start(at as u64))
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

/// Rows of any length and of any bytes are read: what is left is a file that fails in the reading.
fn csv_error(path: &Path, error: &::csv::Error) -> InputError {
    InputError::new(Place::file(path), error.to_string())
}
