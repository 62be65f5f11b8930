//! A sum over a campaign's files by which an edited one is known: no protection, a courtesy.

use std::fmt;
use std::fs;
use std::path::Path;

use super::{Error, io_error};

/// Sum of the files' hashes: in whatever order they are taken, it is the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Digest(pub u64);

/// Files beside the runs that a user may edit.
const PAPERWORK: [&str; 2] = ["campaign.toml", "runs.csv"];

impl Digest {
    /// Of one file: FNV-1a over its name and its bytes (Fowler, Noll and Vo; RFC 9923).
    pub(super) fn new(name: &str, bytes: &[u8]) -> Self {
        let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        Self(name.as_bytes().iter().chain(bytes).fold(0xcbf2_9ce4_8422_2325, step))
    }

    /// Of the files beside the runs.
    pub(super) fn of_paperwork(folder: &Path) -> Result<Self, Error> {
        let mut sum = Self(0);
        for name in PAPERWORK {
            sum = sum.plus(Self::of_file(&folder.join(name), name)?);
        }
        Ok(sum)
    }

    /// Of a whole campaign.
    pub(super) fn of_campaign(folder: &Path, runs: &[String]) -> Result<Self, Error> {
        let mut sum = Self::of_paperwork(folder)?;
        for name in runs {
            sum = sum.plus(Self::of_file(&folder.join("data").join(name), name)?);
        }
        Ok(sum)
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }

    fn of_file(file: &Path, name: &str) -> Result<Self, Error> {
        let bytes = fs::read(file).map_err(|source| io_error(file, "read", source))?;
        Ok(Self::new(name, &bytes))
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}
