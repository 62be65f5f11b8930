//! Tables of numbers by the names of their columns.

use std::path::Path;

use csv::{ReaderBuilder, StringRecord};

use crate::input::lines::TextLines;
use crate::input::{InputError, Place, nearest, printable};
use crate::log::{Dates, plain_table};

/// Hands over the named columns of each row with its line, in any dialect of a log; NaN where a cell is empty. What the table has no
/// column for has no cell either.
///
/// # Errors
/// A missing column or a cell that is no finite number, with line and column.
pub(super) fn for_each_row<const N: usize>(
    file: &Path,
    columns: [&str; N],
    mut on_row: impl FnMut(usize, [f64; N]),
) -> Result<(), InputError> {
    let failed = |error: csv::Error| {
        let line = error.position().map(|position| position.line() as usize);
        let place = line.map_or(Place::file(file), |line| Place::line(file, line));
        InputError::new(place, printable(&error.to_string())).help("a table has a header and a cell for each column")
    };
    let text = plain_table(file, Dates::Since1970)?;
    let mut reader = ReaderBuilder::new().from_reader(text.as_bytes());
    let mut lines = TextLines::new(text.as_bytes());
    let header = reader.headers().map_err(failed)?.clone();
    let line_of_names = lines.ending_at(reader.position().byte());
    let mut places = [0; N];
    for (place, name) in places.iter_mut().zip(columns) {
        *place = header.iter().position(|column| column == name).ok_or_else(|| {
            let error = InputError::new(Place::line(file, line_of_names), format!("no column `{name}`"));
            match nearest(name, header.iter()) {
                Some(near) => error.help(format!("is it `{}`?", printable(near))),
                None => error.help(needed(&columns)),
            }
        })?;
    }
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(failed)? {
        let line = lines.ending_at(reader.position().byte());
        let mut row = [0.0; N];
        for (value, &column) in row.iter_mut().zip(&places) {
            let cell = record.get(column).unwrap_or("");
            if cell.is_empty() {
                *value = f64::NAN;
                continue;
            }
            *value = cell.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
                let place = Place::line(file, line).column(column + 1);
                InputError::new(place, format!("`{}` is no finite number", printable(cell)))
            })?;
        }
        on_row(line, row);
    }
    Ok(())
}

/// A warning where rows were left out since a cell of them is empty.
pub(super) fn incomplete(file: &Path, rows: usize) -> Option<String> {
    let name = printable(&file.to_string_lossy());
    match rows {
        0 => None,
        1 => Some(format!("{name}: 1 row lacks a value and was left out")),
        _ => Some(format!("{name}: {rows} rows lack a value and were left out")),
    }
}

/// The columns of a table; one that is read twice is named once.
fn needed(columns: &[&str]) -> String {
    let mut names: Vec<&str> = Vec::new();
    columns.iter().for_each(|name| {
        if !names.contains(name) {
            names.push(name)
        }
    });
    format!("the columns needed are: {}", names.join(", "))
}
