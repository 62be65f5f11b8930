//! Whether a file is gzipped, whatever its name. Knows no format of a log.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use glidepolar_input::InputError;

/// Whether a file is gzipped.
pub(super) fn is_gzip(path: &Path) -> Result<bool, InputError> {
    let mut magic = Vec::new();
    let file = File::open(path).map_err(|error| InputError::io(path, &error))?;
    file.take(2).read_to_end(&mut magic).map_err(|error| InputError::io(path, &error))?;
    Ok(magic == [0x1f, 0x8b])
}
