//! A log whose columns the calling program holds in memory: the same names and units as in CSV, read in pieces.

use std::sync::Arc;

use super::channels::FlightLog;
use super::columns::Columns;
use super::csv::{Column, find_columns, stated_units};
use super::times;
use glidepolar_input::memory::Table;
use glidepolar_input::{InputError, Place, printable};

/// A log in memory that is being read.
pub struct InMemory {
    table: Arc<Table>,
    columns: Vec<Column>,
    row: usize,
}

impl InMemory {
    /// Finds the channels of a table.
    ///
    /// # Errors
    /// Where a channel is missing without which nothing can be done.
    pub(super) fn open(table: Arc<Table>, columns: &Columns) -> Result<Self, InputError> {
        let names = table.names();
        let found = find_columns(&Place::line(table.path(), 1), &names, &stated_units(&names, None), columns)?;
        Ok(InMemory { table, columns: found, row: 0 })
    }

    /// The next piece of at most `rows` samples; nothing at the end.
    ///
    /// # Errors
    /// A number that is not finite, with its row and column.
    pub fn next_piece(&mut self, rows: usize) -> Result<Option<FlightLog>, InputError> {
        let end = self.table.rows().min(self.row.saturating_add(rows));
        if end == self.row {
            return Ok(None);
        }
        let mut piece = FlightLog::default();
        for column in &self.columns {
            let mut values = Vec::with_capacity(end - self.row);
            for row in self.row..end {
                let value = self.table.at(row, column.cell);
                if value.is_infinite() {
                    let place = Place::line(self.table.path(), row + 1).column(column.cell + 1);
                    let name = printable(&self.table.names()[column.cell]);
                    let error = InputError::new(place, format!("`{name}` is infinite, expected a number or NaN"));
                    return Err(error.help("lines count the rows of the table, from 1"));
                }
                values.push(column.value(value));
            }
            piece.set(column.channel, values);
        }
        if self.row == 0 {
            times::check(self.table.path(), &piece)?;
        }
        self.row = end;
        Ok(Some(piece))
    }
}
