//! Files that are written whole or not at all.

use std::fs::{self, File};
use std::io;
use std::path::Path;

/// How the names of temporary files begin and end. One that is old was left behind by a run that was killed.
pub const PARTIAL: (&str, &str) = (".glidepolar-", ".part");

/// Writes a file through a temporary one beside it, which takes its place only when `write` has succeeded: a reader
/// sees the old file or the new one, never a half, whatever interrupts the program. Folders on the way are made.
pub fn write_whole(path: &Path, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    fs::create_dir_all(folder)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(PARTIAL.0).suffix(PARTIAL.1);
    // A temporary file is private by default; this one is to have the rights of any file the user writes.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    write(file.as_file_mut())?;
    file.persist(path)?;
    Ok(())
}
