//! Output files: written whole or not at all, and never over something that this program did not write.
//!
//! A file appears under its name only when it is complete: it is written beside its place and renamed. A run that is
//! killed leaves the old file, or none. What may be replaced without being asked for (`--force`):
//! - in an [`OutputFolder`], files that the program wrote there and nobody has changed since;
//! - single files, as [`Replace`] says.
//!
//! What it wrote it remembers in a small file beside it, `.glidepolar`: name, length and checksum.
//!
//! What stands in the way is found before the first file is written: a folder takes all files, and looks at the place of
//! each, before it writes any.

use glidepolar_archive::PARTIAL;
use glidepolar_input::{InputError, Place, printable};
use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Component, Path, PathBuf};
use std::time::{Duration, SystemTime};

/// What a single output file may replace.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Replace {
    /// Nothing: the file must be new. For what people edit afterwards, as vehicle files.
    Never,
    /// A file that this program wrote, that nobody has changed since, and that is of the kind of the new one: an archive for
    /// an archive, a result of the same schema, a table of the same columns.
    Own,
    /// Anything: the user said `--force`.
    Any,
}

/// Results that cannot be written, which is no fault of the input.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(transparent)]
pub struct OutputError(pub InputError);

/// Writes a file whole or not at all. A device or pipe (`/dev/stdout`) is written to as it is; a symbolic link is
/// followed; missing folders are made.
pub fn write_whole(path: impl AsRef<Path>, bytes: &[u8], replace: Replace) -> Result<(), OutputError> {
    let path = path.as_ref();
    let target = may_write(path, bytes, replace)?;
    let is_device = fs::metadata(&target).is_ok_and(|existing| !existing.is_file());
    if is_device {
        let written = File::options().write(true).open(&target).and_then(|mut f| f.write_all(bytes));
        return written.map_err(|e| failed(path, &e));
    }
    place(&target, bytes, || {
        if let (Some(folder), Some(name)) = (folder_of(&target), target.file_name().and_then(|name| name.to_str())) {
            // A folder that keeps no record asks for --force the next time; the result is there all the same.
            let _ = record(folder, &entry_of(name, bytes));
        }
        Ok(())
    })
    .map_err(|e| failed(path, &e))
}

fn folder_of(file: &Path) -> Option<&Path> {
    file.parent().map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder })
}

/// Finds out whether [`write_whole`] will write there, before anything else is written. A device or pipe is not touched:
/// who reads it would take the look for the end.
pub fn check(path: impl AsRef<Path>, bytes: &[u8], replace: Replace) -> Result<(), OutputError> {
    let path = path.as_ref();
    let target = may_write(path, bytes, replace)?;
    match fs::metadata(&target) {
        Ok(existing) if !existing.is_file() => Ok(()),
        _ => glidepolar_archive::check_place(&target).map_err(|e| failed(path, &e)),
    }
}

/// The place behind a name, where writing to it is allowed.
fn may_write(path: &Path, bytes: &[u8], replace: Replace) -> Result<PathBuf, OutputError> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let is_own = || is_own(&target, bytes).map_err(|e| failed(path, &e));
    match fs::metadata(&target) {
        Ok(existing) if existing.is_dir() => return Err(is_folder(path)),
        Ok(existing) if !existing.is_file() => {}
        Ok(_) if replace == Replace::Never || (replace == Replace::Own && !is_own()?) => {
            return Err(refused(
                path,
                match replace {
                    Replace::Never => "exists already",
                    _ => "was not written by this command, or was changed since",
                },
            ));
        }
        _ => {}
    }
    Ok(target)
}

/// A folder for results: it takes its files one by one and writes them together. It remembers what it wrote in a small
/// file, `.glidepolar`, so that a second run may replace the results of the first one but nothing else.
#[derive(Debug)]
pub struct OutputFolder {
    root: PathBuf,
    force: bool,
    /// Checksums of everything written here, by the name relative to the folder.
    written: HashSet<(String, u64, u32)>,
    /// What is to be written, by the name relative to the folder.
    files: Vec<(String, Vec<u8>)>,
}

const RECORD: &str = ".glidepolar";

impl OutputFolder {
    /// Opens a folder, making it where it does not exist; with `force`, every file in it may be replaced.
    pub fn open(path: impl AsRef<Path>, force: bool) -> Result<Self, OutputError> {
        let root = path.as_ref().to_owned();
        let failed = |e: io::Error| match failed(&root, &e) {
            OutputError(error) if root.is_file() => {
                OutputError(error.help("a folder is needed here, and this is a file"))
            }
            error => error,
        };
        fs::create_dir_all(&root).map_err(failed)?;
        let written = recorded(&root);
        sweep(&root);
        Ok(OutputFolder { root, force, written, files: Vec::new() })
    }

    /// The folder itself.
    pub fn path(&self) -> &Path {
        &self.root
    }

    /// Takes a file to write; refused where something stands in its place that may not be replaced. `name` is relative and
    /// stays inside, `figures/lift.svg`.
    pub fn add(&mut self, name: impl AsRef<Path>, bytes: impl Into<Vec<u8>>) -> Result<(), OutputError> {
        let name = name.as_ref();
        let path = self.root.join(name);
        let inside = name.components().all(|c| matches!(c, Component::Normal(_)));
        let Some(text) = name.to_str().filter(|n| inside && !n.is_empty() && !n.contains(['\n', '\r'])) else {
            let problem = format!("'{}' is not the name of a file in this folder", printable(&name.to_string_lossy()));
            return Err(OutputError(InputError::new(Place::file(&self.root), problem)));
        };
        if fs::symlink_metadata(&path).is_ok_and(|existing| existing.is_dir()) {
            return Err(is_folder(&path));
        }
        let on_the_way = path.ancestors().skip(1).take_while(|folder| *folder != self.root);
        if let Some(file) = on_the_way.filter(|folder| folder.exists()).find(|folder| !folder.is_dir()) {
            let problem = InputError::new(Place::file(file), "is a file, and a folder was to be made");
            return Err(OutputError(problem.help("choose another name, or move it away")));
        }
        let is_free = self.force || fs::symlink_metadata(&path).is_err();
        if !is_free && !self.wrote(text, &path).map_err(|e| failed(&path, &e))? {
            return Err(refused(&path, "was not written by this program, or was changed since"));
        }
        self.files.push((text.to_owned(), bytes.into()));
        Ok(())
    }

    /// Writes the files, each whole or not at all.
    pub fn write(self) -> Result<(), OutputError> {
        for (name, bytes) in &self.files {
            let path = self.root.join(name);
            place(&path, bytes, || self.record(name, bytes)).map_err(|e| failed(&path, &e))?;
        }
        Ok(())
    }

    fn wrote(&self, name: &str, path: &Path) -> io::Result<bool> {
        if !fs::symlink_metadata(path)?.is_file() {
            return Ok(false);
        }
        let (length, sum) = sum_of(path)?;
        Ok(self.written.contains(&(name.to_owned(), length, sum)))
    }

    fn record(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let entry = entry_of(name, bytes);
        if self.written.contains(&entry) { Ok(()) } else { record(&self.root, &entry) }
    }
}

/// Name, length and checksum of a file that was written.
type Entry = (String, u64, u32);

fn entry_of(name: &str, bytes: &[u8]) -> Entry {
    (name.to_owned(), bytes.len() as u64, crc32fast::hash(bytes))
}

/// What the record of a folder has.
fn recorded(folder: &Path) -> HashSet<Entry> {
    match fs::read(folder.join(RECORD)) {
        Ok(record) => String::from_utf8_lossy(&record).lines().filter_map(entry).collect(),
        Err(_) => HashSet::new(),
    }
}

fn record(folder: &Path, entry: &Entry) -> io::Result<()> {
    let line = format!("{:08x} {} {}\n", entry.2, entry.1, entry.0);
    // One short write in append mode, so that several programs do not mix their lines.
    File::options().append(true).create(true).open(folder.join(RECORD))?.write_all(line.as_bytes())
}

fn refused(path: &Path, why: &str) -> OutputError {
    let error = InputError::new(Place::file(path), why);
    OutputError(error.help("choose another name, move it away, or replace it with --force"))
}

fn is_folder(path: &Path) -> OutputError {
    let error = InputError::new(Place::file(path), "is a folder, and a file was to be written");
    OutputError(error.help("give the name of a file in it"))
}

fn failed(path: &Path, error: &io::Error) -> OutputError {
    // Without the hint at a name like it, which is for files to be read.
    OutputError(InputError::new(Place::file(path), format!("cannot be written: {error}")))
}

/// Writes beside the target, lets `record` remember it, and renames. In this order: killed in between, a run leaves a record
/// without its file, which does no harm, and never a file that the next run takes for somebody else's.
fn place(target: &Path, bytes: &[u8], record: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
    glidepolar_archive::write_whole(target, |file| {
        file.write_all(bytes)?;
        record()
    })
}

/// Removes what killed runs left behind: partial files that nobody has touched for an hour.
fn sweep(folder: &Path) {
    let stale = |entry: &fs::DirEntry| {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let modified = entry.metadata().and_then(|m| m.modified()).unwrap_or(SystemTime::now());
        let age = SystemTime::now().duration_since(modified).unwrap_or_default();
        name.starts_with(PARTIAL.0) && name.ends_with(PARTIAL.1) && age > Duration::from_secs(3600)
    };
    for folder in [folder.to_owned(), folder.join("figures")] {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        for entry in entries.filter(stale) {
            // Not being able to tidy up is no reason to stop.
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn entry(line: &str) -> Option<(String, u64, u32)> {
    let (sum, rest) = line.split_once(' ')?;
    let (length, name) = rest.split_once(' ')?;
    Some((name.to_owned(), length.parse().ok()?, u32::from_str_radix(sum, 16).ok()?))
}

fn sum_of(path: &Path) -> io::Result<(u64, u32)> {
    let (mut file, mut sum, mut length, mut buffer) = (File::open(path)?, crc32fast::Hasher::new(), 0, [0; 1 << 14]);
    loop {
        let n = file.read(&mut buffer)?;
        if n == 0 {
            return Ok((length, sum.finalize()));
        }
        sum.update(&buffer[..n]);
        length += n as u64;
    }
}

/// Whether a file was written by this program as it is, and is of the kind of the new content.
fn is_own(path: &Path, new: &[u8]) -> io::Result<bool> {
    let (Some(folder), Some(name)) = (folder_of(path), path.file_name().and_then(|name| name.to_str())) else {
        return Ok(false);
    };
    let written = recorded(folder);
    if !written.iter().any(|(known, ..)| known == name) {
        return Ok(false);
    }
    let (length, sum) = sum_of(path)?;
    if !written.contains(&(name.to_owned(), length, sum)) {
        return Ok(false);
    }
    const HEAD: u64 = 4096;
    let mut head = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut head)?;
    Ok(match (kind(&head), kind(&new[..new.len().min(HEAD as usize)])) {
        // Whoever looks before there is a result asks with an empty one.
        (Kind::Json(_), Kind::Json(None)) => true,
        (old, new) => old == new,
    })
}

/// What a file is, by its beginning.
#[derive(Debug, PartialEq)]
enum Kind<'a> {
    Archive,
    Page,
    /// JSON with its schema, `{}` for one that is to come.
    Json(Option<&'a [u8]>),
    /// A table with its columns.
    Table(&'a [u8]),
    Text,
}

fn kind(head: &[u8]) -> Kind<'_> {
    let text = head.trim_ascii_start();
    if head.starts_with(b"PK") {
        Kind::Archive
    } else if text.starts_with(b"<") {
        Kind::Page
    } else if text.starts_with(b"{") {
        let schema = text.windows(SCHEMA.len()).position(|window| window == SCHEMA);
        Kind::Json(schema.and_then(|at| text[at + SCHEMA.len()..].split(|b| *b == b'"').nth(1)))
    } else {
        let line = head.split(|b| *b == b'\n').find(|line| !line.starts_with(b"#")).unwrap_or(head);
        if line.len() < head.len() && line.contains(&b',') { Kind::Table(line.trim_ascii_end()) } else { Kind::Text }
    }
}

const SCHEMA: &[u8] = b"\"schema\":";

#[cfg(test)]
mod tests {
    use super::*;

    fn write(folder: OutputFolder, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        let mut folder = folder;
        folder.add(name, bytes)?;
        folder.write()
    }

    #[test]
    fn a_second_run_replaces_the_first_ones_results_and_nothing_else() {
        let dir = tempfile::tempdir().unwrap();
        let out = dir.path().join("out");
        write(OutputFolder::open(&out, false).unwrap(), "figures/lift.svg", b"one").unwrap();
        write(OutputFolder::open(&out, false).unwrap(), "figures/lift.svg", b"two").unwrap();
        assert_eq!(fs::read(out.join("figures/lift.svg")).unwrap(), b"two");

        fs::write(out.join("figures/lift.svg"), b"edited by hand").unwrap();
        fs::write(out.join("notes.txt"), b"mine").unwrap();
        let mut third = OutputFolder::open(&out, false).unwrap();
        for name in ["figures/lift.svg", "notes.txt"] {
            let refused = third.add(name, b"three").unwrap_err().to_string();
            assert!(refused.contains("--force"), "{refused}");
        }
        assert_eq!(fs::read(out.join("notes.txt")).unwrap(), b"mine");
        write(OutputFolder::open(&out, true).unwrap(), "notes.txt", b"three").unwrap();
        assert_eq!(fs::read(out.join("notes.txt")).unwrap(), b"three");
    }

    #[test]
    fn one_file_in_the_way_leaves_all_unwritten() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("report.html"), b"mine").unwrap();
        let mut out = OutputFolder::open(dir.path(), false).unwrap();
        out.add("fits.json", b"{}").unwrap();
        assert!(out.add("report.html", b"x").is_err());
        fs::write(dir.path().join("figures"), b"a file").unwrap();
        let error = out.add("figures/lift.svg", b"x").unwrap_err().to_string();
        assert!(error.contains("figures: is a file"), "{error}");
        assert!(!dir.path().join("fits.json").exists() && !dir.path().join(RECORD).exists());
    }

    #[test]
    fn a_look_at_a_place_says_what_writing_would_and_leaves_nothing() {
        let dir = tempfile::tempdir().unwrap();
        check(dir.path().join("new/a.json"), b"{}", Replace::Own).unwrap();
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
        fs::write(dir.path().join("file"), b"foreign").unwrap();
        assert!(check(dir.path().join("file"), b"{}", Replace::Own).is_err());
        let error = check(dir.path().join("file/a.json"), b"{}", Replace::Own).unwrap_err().to_string();
        assert!(error.contains("a.json: cannot be written") && !error.contains(PARTIAL.0), "{error}");
    }

    #[test]
    fn names_stay_inside_the_folder() {
        let dir = tempfile::tempdir().unwrap();
        let mut out = OutputFolder::open(dir.path().join("out"), true).unwrap();
        for name in ["../escaped", "/tmp/escaped", "", ".", "a/../../escaped", "two\nlines"] {
            assert!(out.add(name, b"x").is_err(), "{name:?}");
        }
        assert!(!dir.path().join("escaped").exists());
    }

    #[test]
    fn single_files_are_replaced_as_asked() {
        let dir = tempfile::tempdir().unwrap();
        let own = dir.path().join("own.json");
        write_whole(&own, br#"{"schema": "glidepolar.identify/1"}"#, Replace::Never).unwrap();
        assert!(write_whole(&own, b"x", Replace::Never).is_err());
        write_whole(&own, br#"{"schema": "glidepolar.identify/1", "n": 2}"#, Replace::Own).unwrap();
        // Another command's result, an archive, and a result that was edited stay.
        for other in [&br#"{"schema": "glidepolar.plan/1"}"#[..], b"PK\x03\x04", b"time_s,depth_m\n0,1\n"] {
            assert!(write_whole(&own, other, Replace::Own).is_err());
        }
        fs::write(&own, br#"{"schema": "glidepolar.identify/1", "n": 3}"#).unwrap();
        assert!(write_whole(&own, br#"{"schema": "glidepolar.identify/1"}"#, Replace::Own).is_err());
        write_whole(&own, b"x", Replace::Any).unwrap();
        assert_eq!(fs::read(&own).unwrap(), b"x");
        // A file with the program's name in it is a user's own where this program did not write it.
        fs::write(&own, br#"{"schema": "glidepolar.identify/1", "n": 9}"#).unwrap();
        assert!(write_whole(&own, br#"{"schema": "glidepolar.identify/1"}"#, Replace::Own).is_err());

        let table = dir.path().join("history.csv");
        write_whole(&table, b"time_s,depth_m\n0,1\n", Replace::Own).unwrap();
        write_whole(&table, b"time_s,depth_m\n0,2\n", Replace::Own).unwrap();
        fs::write(&table, b"time_s,pressure_dbar\n0,1\n").unwrap();
        assert!(write_whole(&table, b"time_s,depth_m\n0,2\n", Replace::Own).is_err());
        assert!(write_whole(dir.path(), b"x", Replace::Any).unwrap_err().to_string().contains("folder"));
    }

    #[test]
    fn nothing_is_left_beside_a_file_that_could_not_be_placed() {
        let dir = tempfile::tempdir().unwrap();
        let out = OutputFolder::open(dir.path(), true).unwrap();
        fs::create_dir(dir.path().join("taken")).unwrap();
        fs::write(dir.path().join("taken/inside"), b"").unwrap();
        assert!(write(out, "taken", b"x").is_err());
        let names: Vec<_> = fs::read_dir(dir.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert!(names.iter().all(|n| !n.to_string_lossy().ends_with(PARTIAL.1)), "{names:?}");
    }

    #[test]
    fn a_file_is_recorded_before_it_appears() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("history.csv");
        let mut seen = None;
        place(&target, b"new", || {
            seen = Some(target.exists());
            Ok(())
        })
        .unwrap();
        assert_eq!((seen, fs::read(&target).unwrap()), (Some(false), b"new".to_vec()));
        assert!(place(&target, b"newer", || Err(io::Error::other("no space"))).is_err());
        assert_eq!(fs::read(&target).unwrap(), b"new");
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_written_to_and_a_link_is_followed() {
        use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
        write_whole("/dev/null", b"x", Replace::Never).unwrap();
        assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());

        let dir = tempfile::tempdir().unwrap();
        let (file, link) = (dir.path().join("file"), dir.path().join("link"));
        fs::write(&file, b"old").unwrap();
        symlink(&file, &link).unwrap();
        assert!(write_whole(&link, b"new", Replace::Own).is_err());
        write_whole(&link, b"new", Replace::Any).unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        let mode = |p: &Path| fs::metadata(p).unwrap().permissions().mode() & 0o777;
        let plain = dir.path().join("plain");
        fs::write(&plain, b"").unwrap();
        assert_eq!(mode(&file), mode(&plain));
    }

    #[test]
    fn a_torn_record_is_read_as_far_as_it_goes() {
        let dir = tempfile::tempdir().unwrap();
        write(OutputFolder::open(dir.path(), false).unwrap(), "a.csv", b"1").unwrap();
        let mut record = File::options().append(true).open(dir.path().join(RECORD)).unwrap();
        record.write_all(b"deadbeef 12").unwrap();
        write(OutputFolder::open(dir.path(), false).unwrap(), "a.csv", b"2").unwrap();
    }
}
