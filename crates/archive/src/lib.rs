//! Zip archives that come out the same byte for byte from the same contents, the careful reading of archives that
//! somebody else made, and files that are written whole or not at all.
//!
//! An archive is held in memory: names and bytes, sorted. It must not know what is packed: gliders, FMUs and their
//! folders are the callers' business.
//!
//! ```
//! use glidepolar_archive::{Archive, Limits};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("notes.zip");
//!
//! let mut archive = Archive::new();
//! archive.insert("documentation/index.html", "<p>A glider</p>")?;
//! archive.write(&path)?;
//!
//! let read = Archive::read(&path, &Limits::default())?;
//! assert_eq!(read.get("documentation/index.html"), Some(b"<p>A glider</p>".as_slice()));
//! # Ok(())
//! # }
//! ```

mod name;
mod read;
mod whole;
mod write;

use std::collections::BTreeMap;
use std::path::PathBuf;

pub use name::{NameFault, check_name};
pub use whole::{PARTIAL, check_place, write_whole};

/// Names and contents of an archive's files, sorted by name. Folders are not kept: they follow from the names.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Archive {
    entries: BTreeMap<String, Vec<u8>>,
}

impl Archive {
    /// An archive with nothing in it.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file, or replaces the one of that name. Names have forward slashes, as in
    /// `binaries/linux64/UnderwaterGlider.so`; a name that would leave the folder it is unpacked to is refused.
    pub fn insert(&mut self, name: &str, contents: impl Into<Vec<u8>>) -> Result<(), NameFault> {
        check_name(name)?;
        self.entries.insert(name.to_owned(), contents.into());
        Ok(())
    }

    /// The contents of a file, `None` if there is no file of that name.
    pub fn get(&self, name: &str) -> Option<&[u8]> {
        self.entries.get(name).map(Vec::as_slice)
    }

    /// Takes a file out and returns its contents.
    pub fn remove(&mut self, name: &str) -> Option<Vec<u8>> {
        self.entries.remove(name)
    }

    /// Names and contents, sorted by name.
    pub fn entries(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.entries.iter().map(|(name, contents)| (name.as_str(), contents.as_slice()))
    }
}

/// How much of somebody else's archive is read at most. What it says of its own sizes is not believed: the limits hold
/// for the bytes that really come out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Number of files and folders.
    pub entries: usize,
    /// Unpacked size of one file, bytes.
    pub entry_bytes: u64,
    /// Unpacked size of all files together, bytes; also the largest size of the archive itself.
    pub total_bytes: u64,
}

impl Default for Limits {
    /// Room for an FMU with binaries for many platforms, and for little more: 10,000 entries, 256 MiB each, 1 GiB in all.
    fn default() -> Self {
        Self { entries: 10_000, entry_bytes: 256 << 20, total_bytes: 1 << 30 }
    }
}

/// Why an archive could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ArchiveError {
    /// The file cannot be opened or read.
    #[error("cannot read {path}: {cause}", path = path.display())]
    Open {
        /// The archive.
        path: PathBuf,
        /// What the operating system says.
        cause: std::io::Error,
    },
    /// The file is no zip archive, or a damaged one.
    #[error("{path} is not a readable zip archive: {cause}", path = path.display())]
    NotAnArchive {
        /// The archive.
        path: PathBuf,
        /// What is wrong.
        cause: zip::result::ZipError,
    },
    /// More, or more bytes, than [`Limits`] allow.
    #[error("{path} holds more than {limit} {what}: not opened further", path = path.display())]
    TooLarge {
        /// The archive.
        path: PathBuf,
        /// The limit that was met.
        limit: u64,
        /// Of what: `files`, `bytes`.
        what: &'static str,
    },
    /// One entry is refused.
    #[error("{path}, entry {entry:?}: {fault}", path = path.display())]
    Entry {
        /// The archive.
        path: PathBuf,
        /// The entry's name as it stands in the archive.
        entry: String,
        /// What is wrong with it.
        fault: EntryFault,
    },
    /// The file cannot be written; what was there before is untouched.
    #[error("cannot write {path}: {cause}", path = path.display())]
    Write {
        /// The archive.
        path: PathBuf,
        /// What the operating system or the packer says.
        cause: std::io::Error,
    },
}

/// Why one entry of an archive is refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EntryFault {
    /// Its name is not a plain relative path.
    #[error(transparent)]
    Name(#[from] NameFault),
    /// It is a link, which may point anywhere.
    #[error("a symbolic link; only plain files and folders are read")]
    Link,
    /// It is encrypted.
    #[error("encrypted; pack the archive without a password")]
    Encrypted,
    /// It unpacks to more than [`Limits::entry_bytes`].
    #[error("unpacks to more than {0} bytes")]
    TooLarge(u64),
    /// It cannot be unpacked, or its checksum is wrong.
    #[error("cannot be unpacked: {0}")]
    Damaged(std::io::Error),
}
