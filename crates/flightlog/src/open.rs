//! Opening a log of any kind: the kind is known by the first bytes and the names of the columns.

use std::io::Read;
use std::path::{Path, PathBuf};

use super::channels::FlightLog;
use super::columns::Columns;
use super::in_memory::InMemory;
use super::{CsvLog, Observation, glide_table, netcdf, og1, seaglider};
use glidepolar_input::memory::Table;
use glidepolar_input::{InputError, Place};

/// What a file turned out to be.
pub enum Opened {
    /// A time series, to be read in pieces.
    Series(Box<LogPieces>),
    /// A table with one row per leg.
    Glides(Vec<Observation>),
}

/// A time series that is read in pieces.
pub enum LogPieces {
    /// CSV, from line to line.
    Csv(Box<CsvLog>),
    /// Columns that the calling program holds.
    InMemory(Box<InMemory>),
    /// NetCDF, whole.
    Whole(Option<Box<FlightLog>>),
}

impl LogPieces {
    /// The next piece of about `rows` samples; nothing at the end.
    ///
    /// # Errors
    /// What cannot be read, with its place.
    pub fn next_piece(&mut self, rows: usize) -> Result<Option<FlightLog>, InputError> {
        match self {
            LogPieces::Csv(log) => log.next_piece(rows),
            LogPieces::InMemory(log) => log.next_piece(rows),
            LogPieces::Whole(log) => Ok(log.take().map(|log| *log)),
        }
    }

    /// What a user should know of what was read so far; it is said once.
    pub fn take_warnings(&mut self) -> Vec<String> {
        match self {
            LogPieces::Csv(log) => log.take_warnings(),
            LogPieces::InMemory(_) | LogPieces::Whole(_) => Vec::new(),
        }
    }
}

/// Opens one file, whatever its kind.
///
/// # Errors
/// Where it cannot be read or is no flight log, with its place and what was expected.
pub fn open(path: impl AsRef<Path>, columns: &Columns) -> Result<Opened, InputError> {
    let path: PathBuf = path.as_ref().to_owned();
    if let Some(table) = Table::named(&path) {
        let log = InMemory::open(table, columns)?;
        return Ok(Opened::Series(Box::new(LogPieces::InMemory(Box::new(log)))));
    }
    if netcdf::is_one(&path)? {
        let is_seaglider = seaglider::is_one(&netcdf::open(&path)?);
        let whole = if is_seaglider {
            seaglider::read(&path, columns)?.log
        } else {
            og1::read(&path, columns, &mut Vec::new())?
        };
        return Ok(Opened::Series(Box::new(LogPieces::Whole(Some(Box::new(whole))))));
    }
    refuse_foreign(&path)?;
    if glide_table::is_one(&path)? {
        return Ok(Opened::Glides(glide_table::read_glide_table(&path, columns)?));
    }
    Ok(Opened::Series(Box::new(LogPieces::Csv(Box::new(CsvLog::open(&path, columns)?)))))
}

/// What is neither NetCDF nor text.
pub(super) fn refuse_foreign(path: &Path) -> Result<(), InputError> {
    let mut magic = [0u8; 256];
    let mut file = std::fs::File::open(path).map_err(|error| InputError::io(path, &error))?;
    let read = file.read(&mut magic).map_err(|error| InputError::io(path, &error))?;
    if magic.starts_with(&[0x1f, 0x8b]) {
        let error =
            InputError::new(Place::file(path), "is a gzip archive, and neither a SeaExplorer file nor NetCDF is in it");
        return Err(error.help("unpack it first"));
    }
    if read == 0 {
        return Err(InputError::new(Place::file(path), "the file is empty, expected a flight log"));
    }
    for (begin, what, help) in FOREIGN {
        if magic.starts_with(begin) {
            return Err(InputError::new(Place::file(path), format!("is {what}")).help(*help));
        }
    }
    if magic.starts_with(b"<") {
        let error = InputError::new(Place::file(path), "is a page of the web (HTML or XML), not a table");
        return Err(error.help("did the download fail? the page says why"));
    }
    // Text has tabs and ends of lines, and no other control character.
    if magic[..read].iter().any(|byte| matches!(byte, 0..=8 | 14..=26)) {
        let error = InputError::new(Place::file(path), "is neither text nor any kind of flight log by its first bytes");
        return Err(error.help("is it damaged? CSV, NetCDF, Slocum's dbd family and SeaExplorer's files are read"));
    }
    Ok(())
}

/// First bytes of files that hold tables of numbers and are not read here: what they are, and what to do.
const FOREIGN: &[(&[u8], &str, &str)] = &[
    (b"PAR1", "a Parquet file, which is not read", "save it as CSV: pandas.read_parquet(FILE).to_csv(\"log.csv\")"),
    (
        b"ARROW1",
        "an Arrow (Feather) file, which is not read",
        "save it as CSV: pandas.read_feather(FILE).to_csv(\"log.csv\")",
    ),
    (
        b"PK\x03\x04",
        "a zip archive or an Excel workbook, which is not read",
        "unpack the archive, or save the sheet as \"CSV UTF-8\"",
    ),
    (b"\xd0\xcf\x11\xe0", "an Excel workbook, which is not read", "save the sheet as \"CSV UTF-8\""),
    (b"MATLAB 5.0", "a Matlab file, which is not read", "write its columns as CSV: writetable(T, \"log.csv\")"),
    (
        b"\x93NUMPY",
        "a NumPy file, which is not read",
        "write its columns as CSV with the names in the first line: numpy.savetxt(..., header=...)",
    ),
    (b"BZh", "a bzip2 archive", "unpack it first"),
    (b"\xfd7zXZ", "an xz archive", "unpack it first"),
    (b"\x28\xb5\x2f\xfd", "a Zstandard archive", "unpack it first"),
    (b"7z\xbc\xaf", "a 7-Zip archive", "unpack it first"),
    (b"\xff\xfe", "text in UTF-16, expected UTF-8", "save it as \"CSV UTF-8\""),
    (b"\xfe\xff", "text in UTF-16, expected UTF-8", "save it as \"CSV UTF-8\""),
    (b"Error {", "the answer of an ERDDAP server that found nothing, not a table", "the text of the file says why"),
    (b"{", "JSON, which is not read", "ask for CSV: ERDDAP writes it for .csv in the place of .json"),
];

#[cfg(test)]
mod tests {
    use super::refuse_foreign;

    #[test]
    fn a_file_that_is_no_text_is_not_read_as_a_table() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |name: &str, content: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, content).expect("a file");
            refuse_foreign(&path).map_err(|error| error.to_string())
        };
        let said = file("damaged.nc", b"\x00\x13\x7fCDX and more").expect_err("no log");
        assert!(said.contains("damaged.nc") && said.contains("neither text"), "{said}");
        for (begin, name) in [
            (&b"PAR1\x15\x04"[..], "Parquet"),
            (b"PK\x03\x04\x14\0", "Excel"),
            (b"MATLAB 5.0 MAT-file", "Matlab"),
            (b"\x93NUMPY\x01\0", "NumPy"),
            (b"\xff\xfet\0i\0", "UTF-16"),
            (b"Error {\n    code=404;", "ERDDAP"),
            (b"<!DOCTYPE html>", "download"),
        ] {
            let said = file("a.log", begin).expect_err("no log");
            assert!(said.contains(name) && said.contains("a.log"), "{said}");
        }
        assert_eq!(file("log.csv", "time_s\tdepth_m;Grad °C\r\n1,2\n".as_bytes()), Ok(()));
    }
}
