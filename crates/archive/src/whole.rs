//! Files that are written whole or not at all.

use std::fs::{self, File};
use std::io;
use std::path::Path;

/// How the names of temporary files begin and end. One that is old was left behind by a run that was killed.
pub const PARTIAL: (&str, &str) = (".glidepolar-", ".part");

/// Writes a file through a temporary one beside it, which takes its place only when `write` has succeeded: a reader
/// sees the old file or the new one, never a half, whatever interrupts the program. Folders on the way are made.
pub fn write_whole(path: &Path, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let folder = folder_of(path);
    fs::create_dir_all(folder)?;
    let mut file = partial_in(folder)?;
    write(file.as_file_mut())?;
    file.persist(path)?;
    Ok(())
}

/// Finds out whether [`write_whole`] could make a file there, and leaves nothing behind: a temporary file is made in the
/// folder, or where folders are missing on the way in the nearest one there is.
pub fn check_place(path: &Path) -> io::Result<()> {
    let mut folder = folder_of(path);
    while !folder.exists() {
        folder = folder_of(folder);
    }
    partial_in(folder).map(drop)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn partial_in(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PARTIAL.0).suffix(PARTIAL.1);
    // A temporary file is private by default; this one is to have the rights of any file the user writes.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    // The message would name the temporary file, of which the user knows nothing.
    builder.tempfile_in(folder).map_err(|error| match error.to_string().split_once(" at path ") {
        Some((what, _)) => io::Error::new(error.kind(), what.to_owned()),
        None => error,
    })
}
