//! Tables as data: a cell keeps its numbers, and is shown with as many digits as its uncertainty supports.

use super::number::{estimate, interval, significant, unsigned_zero, with_interval};
use glidepolar_inference::estimate::Estimate;

/// A table of a report.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// One sentence above the table.
    pub caption: String,
    /// Column headings, with units in square brackets: `a [1/rad]`.
    pub columns: Vec<String>,
    /// Rows of as many cells; missing ones stay empty, surplus ones are dropped.
    pub rows: Vec<Vec<Cell>>,
}

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A whole number.
    Count(i64),
    /// A number without a stated uncertainty, shown to so many significant digits.
    Number {
        /// The value, in the column's unit.
        value: f64,
        /// Significant digits to show.
        digits: usize,
    },
    /// A number with so many decimals, where a column's numbers are to stand point under point.
    Fixed {
        /// The value, in the column's unit.
        value: f64,
        /// Decimals to show.
        decimals: usize,
    },
    /// A value and its standard error, `1.543 ± 0.021`.
    Estimate {
        /// The value, in the column's unit.
        value: f64,
        /// Its standard error, in the same unit.
        standard_error: f64,
    },
    /// A value and its interval, `1.54 (1.42 to 1.67)`; the column heading or the caption says which level.
    WithInterval {
        /// The value, in the column's unit.
        value: f64,
        /// Lower end, in the same unit.
        low: f64,
        /// Upper end, in the same unit.
        high: f64,
    },
    /// An interval, `1.50 to 1.59`; the column heading or the caption says which level.
    Interval {
        /// Lower end, in the column's unit.
        low: f64,
        /// Upper end, in the same unit.
        high: f64,
    },
}

impl Table {
    /// A table without rows yet.
    pub fn new<S: Into<String>>(caption: impl Into<String>, columns: impl IntoIterator<Item = S>) -> Self {
        let columns = columns.into_iter().map(Into::into).collect();
        Table { caption: caption.into(), columns, rows: Vec::new() }
    }

    /// With one more row.
    pub fn row(mut self, cells: impl IntoIterator<Item = Cell>) -> Self {
        self.push(cells);
        self
    }

    /// Adds a row.
    pub fn push(&mut self, cells: impl IntoIterator<Item = Cell>) {
        self.rows.push(cells.into_iter().collect());
    }
}

impl Cell {
    /// A value with its standard error.
    pub fn estimate(value: f64, standard_error: f64) -> Self {
        Cell::Estimate { value, standard_error }
    }

    /// An interval.
    pub fn interval((low, high): (f64, f64)) -> Self {
        Cell::Interval { low, high }
    }

    /// A number shown to so many significant digits.
    pub fn number(value: f64, digits: usize) -> Self {
        Cell::Number { value, digits }
    }

    /// A number with so many decimals.
    pub fn fixed(value: f64, decimals: usize) -> Self {
        Cell::Fixed { value, decimals }
    }

    /// Whether the cell is set flush right, as numbers are.
    pub(super) fn is_number(&self) -> bool {
        !matches!(self, Cell::Text(_))
    }
}

impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Cell::Text(text) => f.write_str(text),
            Cell::Count(n) => write!(f, "{n}"),
            Cell::Number { value, digits } => f.write_str(&significant(*value, *digits)),
            Cell::Fixed { value, .. } if !value.is_finite() => f.write_str("-"),
            Cell::Fixed { value, decimals } => f.write_str(&unsigned_zero(format!("{value:.decimals$}"))),
            Cell::Estimate { value, standard_error } => f.write_str(&estimate(*value, *standard_error)),
            Cell::WithInterval { value, low, high } => f.write_str(&with_interval(*value, *low, *high)),
            Cell::Interval { low, high } => f.write_str(&interval(*low, *high)),
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Cell::Text(text)
    }
}

/// With its 95 % interval.
impl From<&Estimate> for Cell {
    fn from(q: &Estimate) -> Self {
        Cell::WithInterval { value: q.value, low: q.ci95[0], high: q.ci95[1] }
    }
}

/// To four significant digits.
impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Cell::number(value, 4)
    }
}

impl From<usize> for Cell {
    fn from(n: usize) -> Self {
        Cell::Count(i64::try_from(n).unwrap_or(i64::MAX))
    }
}
