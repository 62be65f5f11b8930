//! Lists of sensors that are kept apart from the data: `CRC.cac`, or `CRC.ccc` in LZ4 blocks.

use std::path::{Path, PathBuf};

use crate::bytes::unpacked;
use crate::error::Error;
use crate::header::{Header, List, Sensor};

/// Largest list that is read \[bytes\]; real ones have 120 kB.
const LARGEST: u64 = 16 << 20;

/// Folders in which lists are looked for.
#[derive(Debug, Clone, Default)]
pub struct Caches {
    folders: Vec<PathBuf>,
}

impl Caches {
    /// Looks in these folders, in their order, then beside the data and in folders `cac` and `cache` there.
    pub fn new(folders: impl IntoIterator<Item = PathBuf>) -> Self {
        Caches { folders: folders.into_iter().collect() }
    }

    /// The stored sensors of a file whose list is factored.
    pub(crate) fn find(&self, data: &Path, header: &Header) -> Result<Vec<Sensor>, Error> {
        let crc = &header.sensor_list_crc;
        let beside = data.parent().unwrap_or(Path::new(""));
        let near = ["", "cac", "cache", "../cac", "../cache"].map(|name| beside.join(name));
        for folder in self.folders.iter().cloned().chain(near) {
            for digits in [crc.to_lowercase(), crc.to_uppercase()] {
                for extension in ["cac", "ccc", "CAC", "CCC"] {
                    let path = folder.join(format!("{digits}.{extension}"));
                    if path.is_file() {
                        return read(&path, header);
                    }
                }
            }
        }
        let problem = format!("its list of sensors is kept in a cache file {crc}.cac, which is not there");
        Err(Error::new(data, problem).help("name the folder with the .cac or .ccc files of this glider (--cache DIR)"))
    }
}

/// Reads a list and holds it against its name and against the header of the data.
fn read(path: &Path, header: &Header) -> Result<Vec<Sensor>, Error> {
    let size = std::fs::metadata(path).map_err(|error| Error::io(path, &error))?.len();
    if size > LARGEST {
        return Err(Error::new(path, format!("{size} bytes are no list of sensors")));
    }
    let mut bytes = std::fs::read(path).map_err(|error| Error::io(path, &error))?;
    if !bytes.starts_with(b"s:") {
        bytes = unpacked(path, &bytes)?;
    }
    let mut list = List::default();
    for (number, line) in
        String::from_utf8_lossy(&bytes).lines().enumerate().filter(|(_, line)| !line.trim().is_empty())
    {
        let line = line.trim_end_matches('\r');
        list.take(line).map_err(|problem| Error::new(path, format!("line {}: {problem}", number + 1)))?;
    }
    let (found, wanted) = (list.crc(), &header.sensor_list_crc);
    let sensors = list.finish(path, header)?;
    if found != *wanted {
        let problem = format!("its contents have the checksum {found}, so it is not the list {wanted}");
        return Err(Error::new(path, problem).help("get the file from the glider again"));
    }
    Ok(sensors)
}
