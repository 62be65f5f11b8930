//! Files that a command writes: whole or not at all.

use std::io::Write;
use std::path::Path;

use crate::input::InputError;

/// Writes a file so that nobody ever sees half of it: into a temporary file in the same folder, then in one move.
///
/// # Errors
/// Where the folder does not exist or cannot be written to.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), InputError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let failed =
        |error: std::io::Error| InputError::io(path, &error).help("name a file in a folder that you may write to");
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    file.as_file().sync_all().map_err(failed)?;
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}
