//! Reading an archive that is not trusted: every name is checked, nothing is followed, sizes are bounded before memory
//! is taken.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use zip::ZipArchive;
use zip::read::ZipFile;
use zip::result::ZipError;

use crate::{Archive, ArchiveError, EntryFault, Limits, check_name};

impl Archive {
    /// Reads a whole archive, or refuses it: no part of a doubtful archive is returned. Links, encrypted entries, names
    /// that lead out of the archive, two entries of one name, entries that share bytes, and anything beyond `limits`
    /// are errors that name the entry.
    pub fn read(path: &Path, limits: &Limits) -> Result<Archive, ArchiveError> {
        let open = |cause| ArchiveError::Open { path: path.to_owned(), cause };
        let broken = |cause| ArchiveError::NotAnArchive { path: path.to_owned(), cause };
        let too_large = |what, limit| ArchiveError::TooLarge { path: path.to_owned(), limit, what };

        let file = File::open(path).map_err(open)?;
        if file.metadata().map_err(open)?.len() > limits.total_bytes {
            return Err(too_large("bytes", limits.total_bytes));
        }
        let mut zip = ZipArchive::new(io::BufReader::new(file)).map_err(broken)?;
        if zip.len() > limits.entries {
            return Err(too_large("files", limits.entries as u64));
        }
        if zip.has_duplicate_names() {
            return Err(broken(ZipError::InvalidArchive("two entries have the same name".into())));
        }
        if zip.has_overlapping_entries().map_err(broken)? {
            return Err(broken(ZipError::InvalidArchive("entries share the same bytes".into())));
        }

        let mut archive = Archive::new();
        let mut left = limits.total_bytes;
        for index in 0..zip.len() {
            let mut entry = zip.by_index_raw(index).map_err(broken)?;
            let name = String::from_utf8_lossy(entry.name_raw()).into_owned();
            let refuse = |fault| ArchiveError::Entry { path: path.to_owned(), entry: name.clone(), fault };
            check_entry(&entry, &name).map_err(&refuse)?;
            if entry.is_dir() {
                continue;
            }
            drop(entry);
            entry = zip.by_index(index).map_err(broken)?;
            let limit = limits.entry_bytes.min(left);
            let contents = match unpack(&mut entry, limit).map_err(|e| refuse(EntryFault::Damaged(e)))? {
                Some(contents) => contents,
                None if left < limits.entry_bytes => {
                    return Err(too_large("bytes", limits.total_bytes));
                }
                None => return Err(refuse(EntryFault::TooLarge(limit))),
            };
            left -= contents.len() as u64;
            archive.insert(&name, contents).map_err(|fault| refuse(fault.into()))?;
        }
        Ok(archive)
    }
}

fn check_entry<R: Read + ?Sized>(entry: &ZipFile<'_, R>, name: &str) -> Result<(), EntryFault> {
    // A folder's name ends with the one slash that makes it a folder.
    let plain = if entry.is_dir() { name.strip_suffix('/').unwrap_or(name) } else { name };
    check_name(plain)?;
    if entry.is_symlink() {
        return Err(EntryFault::Link);
    }
    if entry.encrypted() {
        return Err(EntryFault::Encrypted);
    }
    Ok(())
}

/// The whole contents, or `None` when there are more than `limit` bytes of it. The vector grows with what really comes
/// out, not with what the archive announces.
fn unpack(entry: &mut impl Read, limit: u64) -> io::Result<Option<Vec<u8>>> {
    let mut contents = Vec::new();
    entry.take(limit.saturating_add(1)).read_to_end(&mut contents)?;
    Ok((contents.len() as u64 <= limit).then_some(contents))
}
