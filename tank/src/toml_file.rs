//! TOML files read into structures, every complaint with line and column. Knows no key.

use std::ops::Range;
use std::path::Path;

use glidepolar_input::{InputError, Place, printable};
use serde::de::DeserializeOwned;
use toml::Spanned;

/// No manifest is longer; a larger file is something else \[bytes\].
const MAX_BYTES: usize = 1 << 20;

/// The text of a file and where it came from, to find lines and columns in.
#[derive(Debug)]
pub struct Source<'a> {
    file: &'a Path,
    text: String,
}

impl<'a> Source<'a> {
    /// Reads the file.
    ///
    /// # Errors
    /// Where it cannot be read or is no text.
    pub fn read(file: &'a Path) -> Result<Self, InputError> {
        let text = std::fs::read_to_string(file).map_err(|error| InputError::io(file, &error))?;
        if text.len() > MAX_BYTES {
            let problem = format!("{} bytes are too many (at most {MAX_BYTES})", text.len());
            return Err(InputError::new(Place::file(file), problem));
        }
        if text.trim().is_empty() {
            return Err(InputError::new(Place::file(file), "the file is empty"));
        }
        Ok(Source { file, text })
    }

    /// Makes the structure of it.
    ///
    /// # Errors
    /// Where the text is not TOML, or a key is unknown, missing or of the wrong kind.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, InputError> {
        toml::from_str(&self.text).map_err(|error| {
            let place = error.span().map_or(Place::file(self.file), |span| self.at(span));
            InputError::new(place, printable(error.message()))
        })
    }

    /// The place of a value.
    pub fn place<T>(&self, value: &Spanned<T>) -> Place {
        self.at(value.span())
    }

    /// A value that must be a finite number above zero.
    ///
    /// # Errors
    /// Where it is not.
    pub fn positive(&self, name: &str, value: &Spanned<f64>) -> Result<f64, InputError> {
        self.within(name, value, f64::MIN_POSITIVE, f64::MAX, "a number above zero")
    }

    /// A value that must lie between two numbers; `expected` says so in words.
    ///
    /// # Errors
    /// Where it does not.
    pub fn within(
        &self,
        name: &str,
        value: &Spanned<f64>,
        low: f64,
        high: f64,
        expected: &str,
    ) -> Result<f64, InputError> {
        let number = *value.get_ref();
        if number.is_finite() && (low..=high).contains(&number) {
            return Ok(number);
        }
        Err(InputError::new(self.place(value), format!("{name} is {number}, expected {expected}")))
    }

    fn at(&self, span: Range<usize>) -> Place {
        Place::offset(self.file, &self.text, span.start)
    }
}
