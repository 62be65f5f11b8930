//! Binary files of Slocum gliders: `.dbd .ebd .sbd .tbd .mbd .nbd` and the compressed `.dcd .ecd .scd .tcd .mcd .ncd`.
//!
//! ```text
//! file -> bytes (LZ4 blocks unpacked) -> header, list of sensors (in the file, or in a cache file) -> cycles
//! ```
//! - [`Reader`]: one file, cycle by cycle, in bounded memory.
//! - [`Header`], [`Sensor`]: what the file says of itself.
//! - [`Caches`]: folders with lists of sensors, `CRC.cac` or `CRC.ccc`.
//! - [`Error`], [`Damage`]: what could not be read, with file, block and byte.
//!
//! A file holds a header of text lines, then the list of its sensors unless that is *factored*, which means kept in a cache
//! file; then a cycle of known values, from which the order of bytes follows; then a cycle for each step of the glider's
//! computer: `d`, two bits for each sensor (0 not set, 1 as before, 2 new), the new values. `X` ends the file. A file that
//! was cut off is normal. Where bytes are damaged, reading goes on with the next cycles that are whole, and says so.
//!
//! Knows nothing of what sensors mean but the clock, by which whole cycles are known again after damage.

mod bytes;
mod cache;
mod cycles;
mod error;
mod header;
mod reader;

pub use cache::Caches;
pub use error::{Damage, Error};
pub use header::{Header, Sensor, days_since_1970};
pub use reader::{Cycle, Reader, is_one};
