//! Whatever a stranger's file or a careless importer may bring, one target for each way in.
//!
//! A target takes any bytes and must come back: no panic, no abort, no hang, no memory without bound. What the code under
//! test says of the bytes is its own business. `cargo xtask fuzz` runs targets under libFuzzer, which looks for bytes
//! that reach new code; `tests/replay.rs` runs them on what once went wrong, on the seeds, and on seeds spoilt at random.
//!
//! [`Target::seeds`] are made from the project's own examples. Several files in one input are parted by a line `%%`.

mod files;
mod targets;

pub use targets::{target, targets};

/// One way in.
pub struct Target {
    /// Its name.
    pub name: &'static str,
    /// What comes in there.
    pub what: &'static str,
    /// Takes the bytes. A panic is a finding.
    pub run: fn(&[u8]),
    /// What to begin with.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// Whether the code under test may catch panics of a library below it.
    pub catches_panics: bool,
}
