//! What a line of the catalogue says of an effect, and how its size is drawn.

use super::effects::Hidden;
use super::random::Stream;

/// One line of the catalogue.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Name on the command line.
    pub name: &'static str,
    /// Name of the size.
    pub parameter: &'static str,
    /// Unit of the size; empty for ratios.
    pub unit: &'static str,
    /// What the size means, with its sign.
    pub meaning: &'static str,
    /// Sizes outside are refused.
    pub bounds: (f64, f64),
    pub(super) draw: Draw,
    pub(super) act: fn(&mut Hidden, f64, &mut Stream) -> String,
}

/// How a size is drawn when none is given.
#[derive(Debug, Clone, Copy)]
pub(super) enum Draw {
    /// Uniform between the two.
    Between(f64, f64),
    /// Uniform between the two, of either sign.
    EitherSign(f64, f64),
    /// One plus a number between the two, of either sign.
    AboutOne(f64, f64),
}

impl Draw {
    pub(super) fn size(self, stream: &mut Stream) -> f64 {
        let drawn = match self {
            Self::Between(low, high) => stream.between(low, high),
            Self::EitherSign(low, high) => stream.sign() * stream.between(low, high),
            Self::AboutOne(low, high) => 1.0 + stream.sign() * stream.between(low, high),
        };
        // Six significant digits: what the truth prints is what was used.
        format!("{drawn:.5e}").parse().unwrap_or(drawn)
    }
}
