//! What both kinds of NetCDF log share: a variable by name as numbers in a known unit, errors that name the file. A gzipped
//! file is unpacked into memory.

use std::fs::File;
use std::io::{Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use flate2::read::MultiGzDecoder;
use netcdf_reader::{NcFile, NcOpenOptions};

use super::gzip::is_gzip;

use glidepolar_input::{InputError, Place, printable};

/// Most that is ever read into memory for one variable \[bytes\]: no log of one file is longer, a damaged header may
/// claim anything.
const MAX_READ_BYTES: usize = 1 << 30;

/// Most that a gzipped file may hold \[bytes\].
const MOST_UNPACKED_BYTES: u64 = 1 << 30;

/// As much of a file as its header takes that says how long it is.
const HEADER_BYTES: u64 = 64;

const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

/// The first bytes of a file, gzipped or not; none of what does not unpack.
fn header(path: &Path) -> Result<Vec<u8>, InputError> {
    let is_gzip = is_gzip(path)?;
    let file = File::open(path).map_err(|error| InputError::io(path, &error))?;
    let mut read = Vec::new();
    if is_gzip {
        let _ = MultiGzDecoder::new(file).take(HEADER_BYTES).read_to_end(&mut read);
    } else {
        file.take(HEADER_BYTES).read_to_end(&mut read).map_err(|error| InputError::io(path, &error))?;
    }
    Ok(read)
}

/// Whether the file begins as one.
pub(super) fn is_one(path: &Path) -> Result<bool, InputError> {
    let begin = header(path)?;
    Ok(begin.starts_with(b"CDF") || begin.starts_with(HDF5))
}

pub(super) fn open(path: &Path) -> Result<NcFile, InputError> {
    let options = NcOpenOptions { max_read_bytes: MAX_READ_BYTES, ..NcOpenOptions::default() };
    let file = if is_gzip(path)? {
        let unpacked = unpacked(path)?;
        check_whole(path, &unpacked, unpacked.len() as u64)?;
        check_alone(path, &unpacked, Cursor::new(&unpacked))?;
        NcFile::from_bytes_with_options(&unpacked, options)
    } else {
        let length = std::fs::metadata(path).map_err(|error| InputError::io(path, &error))?.len();
        let begin = header(path)?;
        check_whole(path, &begin, length)?;
        check_alone(path, &begin, File::open(path).map_err(|error| InputError::io(path, &error))?)?;
        NcFile::open_with_options(path, options)
    };
    let file = file.map_err(|error| damaged(path, &format!("not readable as NetCDF: {error}")))?;
    // Else every variable would be missing from it, the time first.
    file.variables().map_err(|error| damaged(path, &format!("its list of variables is not readable: {error}")))?;
    Ok(file)
}

fn damaged(path: &Path, why: &str) -> InputError {
    InputError::new(Place::file(path), format!("the file is damaged, {}", printable(why)))
        .help("was the file cut off while it was written or sent?")
}

fn unpacked(path: &Path) -> Result<Vec<u8>, InputError> {
    let file = File::open(path).map_err(|error| InputError::io(path, &error))?;
    let mut content = Vec::new();
    let mut packed = MultiGzDecoder::new(std::io::BufReader::new(file)).take(MOST_UNPACKED_BYTES + 1);
    packed.read_to_end(&mut content).map_err(|error| damaged(path, &format!("it does not unpack: {error}")))?;
    if content.len() as u64 > MOST_UNPACKED_BYTES {
        let problem = format!("holds more than {} MB", MOST_UNPACKED_BYTES >> 20);
        return Err(InputError::new(Place::file(path), problem).help("unpack it first"));
    }
    Ok(content)
}

/// Refuses an HDF5 file that is shorter than its own first block says it is.
fn check_whole(path: &Path, begin: &[u8], length: u64) -> Result<(), InputError> {
    match stated_length(begin) {
        Some(stated) if stated > length => {
            Err(damaged(path, &format!("it was cut off: {length} of {stated} bytes are there")))
        }
        _ => Ok(()),
    }
}

/// Refuses an HDF5 file behind which another one begins: the library would read the first alone. A classic file does not state its
/// length, and what stands behind it may be an older state of the same dive (the published files of SG542 are such): nothing is said.
fn check_alone(path: &Path, begin: &[u8], mut content: impl Read + Seek) -> Result<(), InputError> {
    let Some(end) = stated_length(begin) else { return Ok(()) };
    let io = |error: std::io::Error| InputError::io(path, &error);
    content.seek(SeekFrom::Start(end)).map_err(io)?;
    let mut behind = Vec::new();
    content.take(HDF5.len() as u64).read_to_end(&mut behind).map_err(io)?;
    if behind != HDF5 {
        return Ok(());
    }
    let problem = format!("two files one behind the other: another NetCDF begins behind byte {end}");
    let help = format!("take them apart: head -c {end} FILE, and tail -c +{} FILE", end + 1);
    Err(InputError::new(Place::file(path), problem).help(help))
}

/// The length of an HDF5 file by its superblock (HDF5 File Format Specification 3.0, II.A), where its addresses take eight bytes.
fn stated_length(begin: &[u8]) -> Option<u64> {
    let (size_at, base_at, end_at) = match begin.strip_prefix(HDF5)?.first()? {
        0 => (13, 24, 40),
        1 => (13, 28, 44),
        2 | 3 => (9, 12, 28),
        _ => return None,
    };
    let number = |at: usize| Some(u64::from_le_bytes(begin.get(at..at + 8)?.try_into().ok()?));
    (*begin.get(size_at)? == 8 && number(base_at)? == 0).then_some(number(end_at)?)
}

pub(super) fn has(file: &NcFile, name: &str) -> bool {
    file.variable(name).is_ok()
}

/// The first of these variables that is there, with fill values as NaN; nothing where none is there.
pub(super) fn first(path: &Path, file: &NcFile, names: &[&str]) -> Result<Option<Vec<f64>>, InputError> {
    match names.iter().find(|name| has(file, name)) {
        Some(name) => values(path, file, name).map(Some),
        None => Ok(None),
    }
}

/// A variable as numbers, packed values unpacked, fill values as NaN.
pub(super) fn values(path: &Path, file: &NcFile, name: &str) -> Result<Vec<f64>, InputError> {
    let array = file.read_variable_unpacked_masked(name).map_err(|error| unreadable(path, name, &error.to_string()))?;
    // Magnitudes that no instrument gives are default fill values that nobody declared; nanoseconds since 1970 are 1e18.
    let unit = units(file, name);
    let most = if unit.starts_with("nanosec") || unit.starts_with("microsec") { 5e18 } else { 1e15 };
    Ok(array.iter().map(|&value| if value.abs() < most { value } else { f64::NAN }).collect())
}

/// What to say of a variable that is not readable: HDF5 has ways to pack that are add-ons of its library.
fn unreadable(path: &Path, name: &str, why: &str) -> InputError {
    const FILTERS: [(&str, &str); 5] =
        [("307", "bzip2"), ("32001", "Blosc"), ("32004", "LZ4"), ("32013", "ZFP"), ("32015", "Zstandard")];
    let is_filter = why.contains("unsupported filter");
    let filter = FILTERS.iter().find(|(id, _)| why.ends_with(&format!("filter id {id}"))).map(|(_, name)| *name);
    if is_filter {
        let by = filter.map_or_else(|| printable(why), |filter| format!("by {filter}"));
        let problem = format!("variable `{}` is packed {by}, which is not read here", printable(name));
        return InputError::new(Place::file(path), problem)
            .help("pack it by deflate, which all programs read: nccopy -F '*,none' IN.nc PLAIN.nc, then nccopy -d 4 PLAIN.nc OUT.nc");
    }
    damaged(path, &format!("variable `{name}` is not readable: {why}"))
}

/// Flags of a variable, as numbers or as characters; nothing where they are neither.
pub(super) fn flags(path: &Path, file: &NcFile, name: &str) -> Option<Vec<f64>> {
    if let Ok(flags) = values(path, file, name) {
        return Some(flags);
    }
    let digit = |byte: u8| if byte.is_ascii_digit() { f64::from(byte - b'0') } else { f64::NAN };
    if let Ok(texts) = file.read_variable_as_strings(name)
        && texts.len() > 1
    {
        return Some(texts.iter().map(|text| text.trim().bytes().next().map_or(f64::NAN, digit)).collect());
    }
    Some(file.read_variable_raw_bytes(name).ok()?.into_iter().map(digit).collect())
}

/// An attribute of a variable as text, lower case.
pub(super) fn attribute_of(file: &NcFile, name: &str, attribute: &str) -> String {
    file.variable(name)
        .ok()
        .and_then(|variable| variable.attribute(attribute)?.value.as_string())
        .unwrap_or_default()
        .trim()
        .to_lowercase()
}

/// The `units` attribute, lower case.
pub(super) fn units(file: &NcFile, name: &str) -> String {
    attribute_of(file, name, "units")
}

pub(super) fn attribute_f64(file: &NcFile, name: &str) -> Option<f64> {
    let value = &file.global_attribute(name).ok()?.value;
    value.as_f64().or_else(|| value.as_string()?.trim().parse().ok())
}

pub(super) fn attribute_text(file: &NcFile, name: &str) -> Option<String> {
    Some(file.global_attribute(name).ok()?.value.as_string()?.trim().to_owned())
}

/// A variable of one number; nothing where it is not there or has no value.
pub(super) fn scalar(file: &NcFile, name: &str) -> Option<f64> {
    file.variable(name).ok()?;
    let array = file.read_variable_unpacked_masked(name).ok()?;
    array.iter().copied().next().filter(|value| value.abs() < 1e15)
}

/// Complains about a variable that is missing or of another length than the time.
pub(super) fn of_length(path: &Path, name: &str, column: Vec<f64>, rows: usize) -> Result<Vec<f64>, InputError> {
    if column.len() == rows {
        return Ok(column);
    }
    let problem = format!("variable `{}` has {} values, the time has {rows}", printable(name), column.len());
    Err(InputError::new(Place::file(path), problem))
}

pub(super) fn missing(path: &Path, what: &str, names: &[&str]) -> InputError {
    InputError::new(Place::file(path), format!("no {what}: expected a variable {}", names.join(" or ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lengths that superblocks of each version state, by the specification's tables.
    #[test]
    fn an_hdf5_file_says_how_long_it_is() {
        let superblock = |version: u8, size_at: usize, end_at: usize| {
            let mut begin = HDF5.to_vec();
            begin.resize(64, 0);
            begin[8] = version;
            begin[size_at] = 8;
            begin[end_at..end_at + 8].copy_from_slice(&4711_u64.to_le_bytes());
            begin
        };
        for (version, size_at, end_at) in [(0, 13, 40), (1, 13, 44), (2, 9, 28), (3, 9, 28)] {
            let begin = superblock(version, size_at, end_at);
            assert_eq!(stated_length(&begin), Some(4711), "version {version}");
            assert!(check_whole(Path::new("a.nc"), &begin, 4711).is_ok());
            let error = check_whole(Path::new("a.nc"), &begin, 4000).unwrap_err().to_string();
            assert!(error.contains("a.nc") && error.contains("cut off: 4000 of 4711 bytes"), "{error}");
            let alone = |behind: &[u8]| {
                let whole = [begin.as_slice(), &vec![0; 4711 - begin.len()], behind].concat();
                check_alone(Path::new("a.nc"), &begin, Cursor::new(whole))
            };
            assert!(alone(&[]).is_ok() && alone(b"padding").is_ok());
            assert!(alone(HDF5).unwrap_err().to_string().contains("begins behind byte 4711"));
        }
        assert_eq!(stated_length(b"CDF\x01"), None);
        assert_eq!(stated_length(&superblock(9, 9, 28)), None);
        assert_eq!(stated_length(HDF5), None);
    }
}
