//! Writing an archive so that the same contents give the same bytes, whenever and wherever they are packed.

use std::io::{self, Seek, Write};
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::{Archive, ArchiveError, write_whole};

impl Archive {
    /// Writes the archive to a file, whole or not at all: a file that was there before is replaced only by a complete
    /// one.
    pub fn write(&self, path: &Path) -> Result<(), ArchiveError> {
        write_whole(path, |file| self.write_to(io::BufWriter::new(file)))
            .map_err(|cause| ArchiveError::Write { path: path.to_owned(), cause })
    }

    /// Writes the archive's bytes: entries sorted by name, the first moment that a zip archive can express (1980) as
    /// their time, deflated.
    pub fn write_to(&self, sink: impl Write + Seek) -> io::Result<()> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .compression_level(Some(9))
            .last_modified_time(DateTime::default())
            .unix_permissions(0o644);
        let mut zip = ZipWriter::new(sink);
        for (name, contents) in self.entries() {
            zip.start_file(name, options)?;
            zip.write_all(contents)?;
        }
        zip.finish()?.flush()
    }
}
