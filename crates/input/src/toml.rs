//! What the readers of TOML files share: the same complaints, each with its line and column, whatever the file is.
//!
//! Knows no keys: which exist, what they mean and which numbers they take is the business of each reader.

use std::ops::Range;
use std::path::Path;

use toml_edit::{Document, Item, TableLike};

use super::{InputError, Place, printable};

/// No file that a person writes by hand is longer; a larger one is something else \[bytes\].
const MAX_BYTES: usize = 1 << 20;

/// The text of a TOML file and where it comes from: what every complaint points into.
#[derive(Debug, Clone, Copy)]
pub struct TomlText<'a> {
    text: &'a str,
    origin: &'a Path,
}

/// The numbers that a key takes, and the unit it is in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds<'a> {
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Unit.
    pub unit: &'a str,
}

impl<'a> TomlText<'a> {
    /// A text; `origin` is what complaints name.
    pub fn new(text: &'a str, origin: &'a Path) -> Self {
        TomlText { text, origin }
    }

    /// The document, with the place of everything in it. `kind` names the file in complaints: "vehicle file".
    ///
    /// # Errors
    /// Where the text is far too long or is not TOML.
    pub fn parse(&self, kind: &str) -> Result<Document<&'a str>, InputError> {
        if self.text.len() > MAX_BYTES {
            let problem = format!("{} bytes are too many for a {kind} (at most {MAX_BYTES})", self.text.len());
            return Err(InputError::new(Place::file(self.origin), problem));
        }
        Document::parse(self.text).map_err(|error| {
            let problem = format!("not valid TOML: {}", printable(error.message()));
            InputError::new(self.place(error.span()), problem)
                .help(format!("a {kind} has [sections] of lines `name = number`"))
        })
    }

    /// Where something stands; the file as a whole where that is not known.
    pub fn place(&self, span: Option<Range<usize>>) -> Place {
        span.map_or(Place::file(self.origin), |span| Place::offset(self.origin, self.text, span.start))
    }

    /// Where a key of a table stands.
    pub fn place_of_key(&self, table: &dyn TableLike, name: &str) -> Place {
        let item = table.get(name).and_then(Item::span);
        self.place(table.key(name).and_then(toml_edit::Key::span).or(item))
    }

    /// A number within its bounds.
    ///
    /// # Errors
    /// Anything else, with its place.
    pub fn number(&self, path: &str, item: &Item, bounds: Bounds<'_>) -> Result<f64, InputError> {
        let value = item.as_float().or_else(|| item.as_integer().map(|i| i as f64));
        match value {
            Some(value) => self.within(path, value, item.span(), bounds),
            None => Err(self.wrong_kind(path, item, "a number")),
        }
    }

    /// A list of numbers within their bounds; a single number is a list of one.
    ///
    /// # Errors
    /// Anything else, with its place.
    pub fn numbers(&self, path: &str, item: &Item, bounds: Bounds<'_>) -> Result<Vec<f64>, InputError> {
        let Some(array) = item.as_array() else {
            return self.number(path, item, bounds).map(|value| vec![value]);
        };
        array
            .iter()
            .map(|value| match value.as_float().or_else(|| value.as_integer().map(|i| i as f64)) {
                Some(number) => self.within(path, number, value.span(), bounds),
                None => {
                    let problem = format!("`{}` has a {} in its list of numbers", printable(path), value.type_name());
                    Err(InputError::new(self.place(value.span()), problem))
                }
            })
            .collect()
    }

    /// A text.
    ///
    /// # Errors
    /// Anything else, with its place.
    pub fn string(&self, path: &str, item: &Item) -> Result<String, InputError> {
        item.as_str().map(str::to_owned).ok_or_else(|| self.wrong_kind(path, item, "a text in quotes"))
    }

    /// The complaint about an item of another kind than expected.
    pub fn wrong_kind(&self, path: &str, item: &Item, expected: &str) -> InputError {
        let kind = item.type_name();
        let article = if kind.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
        let problem = format!("`{}` is {article} {kind}, expected {expected}", printable(path));
        InputError::new(self.place(item.span()), problem)
    }

    fn within(
        &self,
        path: &str,
        value: f64,
        span: Option<Range<usize>>,
        bounds: Bounds<'_>,
    ) -> Result<f64, InputError> {
        let Bounds { min, max, unit } = bounds;
        // NaN lies in no range, and an infinite number is none.
        if value.is_finite() && (min..=max).contains(&value) {
            return Ok(value);
        }
        let range = if min == f64::MIN_POSITIVE && max == f64::MAX {
            "above zero".to_owned()
        } else if min == 0.0 && max == f64::MAX {
            "not below zero".to_owned()
        } else if max == f64::MAX {
            "finite".to_owned()
        } else {
            format!("between {min} and {max}")
        };
        let problem = format!("`{path}` is {value}, expected a number {range} [{unit}]");
        Err(InputError::new(self.place(span), problem))
    }
}
