//! Times of rows that are written as dates: in one cell, or as a date and a clock in two. Where the year is last, the rows
//! themselves show whether the day or the month is first; where none of them does, the day is, and it is said.
//!
//! Knows the table; no channel but the time.

use std::path::Path;

use super::dates::{DateOrder, Shows, has_year_last, ordered_unix_s, shows_order};
use super::dialect::Rows;
use glidepolar_input::{InputError, printable};

/// Names of a column that holds the date of a clock in another.
const DATES: [&str; 3] = ["date", "date_utc", "date_gmt"];

/// How dates are read from the rows of a table.
pub(super) struct RowDates {
    order: DateOrder,
    /// The column of the clock, or of date and clock.
    time_cell: usize,
    /// The column of the date, where it is one of its own.
    date_cell: Option<usize>,
}

impl RowDates {
    /// Finds how the dates of a table are written. The order of day and month is that which the user states, else what the
    /// rows show; what is assumed is added to the warnings.
    ///
    /// # Errors
    /// A row that cannot be read.
    pub(super) fn find(
        path: &Path,
        header: &[String],
        time_cell: usize,
        stated: Option<DateOrder>,
        warnings: &mut Vec<String>,
    ) -> Result<Self, InputError> {
        let is_date = |name: &String| DATES.iter().any(|date| name.trim().eq_ignore_ascii_case(date));
        let date_cell = header.iter().position(is_date).filter(|cell| *cell != time_cell);
        let mut dates = RowDates { order: DateOrder::DayFirst, time_cell, date_cell };
        match stated {
            Some(order) => dates.order = order,
            None => dates.order_by_rows(path, warnings)?,
        }
        Ok(dates)
    }

    /// Unix time of a row \[s\]; nothing where no date is in it.
    pub(super) fn unix_s(&self, record: &::csv::ByteRecord) -> Option<f64> {
        let text = |cell: usize| std::str::from_utf8(record.get(cell)?).ok();
        let time = text(self.time_cell)?;
        ordered_unix_s(time, self.order).or_else(|| {
            let date = text(self.date_cell?)?;
            let is_clock = time.contains(':') && !date.trim().is_empty();
            is_clock.then(|| ordered_unix_s(&format!("{} {}", date.trim(), time.trim()), self.order))?
        })
    }

    /// Looks through the rows until one of them decides. A table whose first date has the year first, or none, is not read.
    fn order_by_rows(&mut self, path: &Path, warnings: &mut Vec<String>) -> Result<(), InputError> {
        let mut rows = Rows::open(path)?;
        rows.names()?;
        let mut record = ::csv::ByteRecord::new();
        let mut doubtful: Option<String> = None;
        while rows.next(&mut record)? {
            let cell = [self.date_cell, Some(self.time_cell)].into_iter().flatten().find_map(|cell| {
                let text = std::str::from_utf8(record.get(cell)?).ok()?;
                text.contains(['/', '-']).then_some(text)
            });
            let Some(text) = cell else {
                // Empty cells decide nothing; numbers are no dates, and neither are the others of the column.
                match record.get(self.time_cell).is_some_and(|cell| cell.iter().any(u8::is_ascii_digit)) {
                    true => break,
                    false => continue,
                }
            };
            match shows_order(text) {
                Shows::Order(order) => {
                    self.order = order;
                    return Ok(());
                }
                Shows::Either if doubtful.is_none() => doubtful = Some(text.to_owned()),
                Shows::Either => {}
                Shows::Nothing if has_year_last(text) => {}
                Shows::Nothing => break,
            }
        }
        if let Some(text) = doubtful {
            warnings.push(format!(
                "{}: dates as `{}` may have the day or the month first, and no row decides: the day is taken to be first. --unit time_s=month-first reads the month first, --unit time_s=day-first states the other",
                printable(&path.to_string_lossy()),
                printable(&text)
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Channel, Columns, CsvLog};

    /// The times of a table of these names and rows, and the warnings about them.
    fn times(names: &str, rows: &[&str], unit: Option<&str>) -> (Vec<f64>, Vec<String>) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("log.csv");
        let rows: Vec<String> = rows.iter().map(|row| format!("{row},1,0.1,100")).collect();
        std::fs::write(&path, format!("{names},pressure_dbar,pitch_rad,vbd_cc\n{}\n", rows.join("\n")))
            .expect("a file");
        let mut columns = Columns::default();
        unit.iter().for_each(|unit| columns.unit_text(unit).expect("an order"));
        let mut log = CsvLog::open(&path, &columns).expect("a log");
        let piece = log.next_piece(100).expect("rows").expect("a piece");
        (piece.column(Channel::Time).to_vec(), log.take_warnings())
    }

    /// 5 June 2024 and 6 May 2024.
    const JUNE_5: f64 = 1_717_545_600.0;
    const MAY_6: f64 = 1_714_953_600.0;

    #[test]
    fn a_row_decides_which_of_day_and_month_is_first() {
        let (found, said) = times("time", &["05/06/2024", "13/06/2024"], None);
        assert_eq!((found[0], said.len()), (JUNE_5, 0));
        let (found, said) = times("time", &["05/06/2024", "05/13/2024"], None);
        assert_eq!((found[0], said.len()), (MAY_6, 0));
    }

    #[test]
    fn where_no_row_decides_it_is_said_what_was_assumed() {
        let rows = ["05/06/2024 00:00:00", "05/06/2024 00:00:10"];
        let (found, said) = times("time", &rows, None);
        assert_eq!(found[0], JUNE_5);
        assert!(said.len() == 1 && said[0].contains("log.csv") && said[0].contains("time_s=month-first"), "{said:?}");
        let (found, said) = times("time", &rows, Some("time_s=month-first"));
        assert_eq!((found[0], said.len()), (MAY_6, 0));
        let (found, said) = times("time", &rows, Some("time_s=day-first"));
        assert_eq!((found[0], said.len()), (JUNE_5, 0));
    }

    #[test]
    fn date_and_clock_may_stand_in_two_columns() {
        let (found, _) = times("date,time", &["2024-06-05,00:00:30", "2024-06-05,00:01:00"], None);
        assert_eq!(found, [JUNE_5 + 30.0, JUNE_5 + 60.0]);
        let (found, said) = times("Date,Time", &["06/05/2024,00:00:30", "06/13/2024,00:00:30"], None);
        assert_eq!((found[0], said.len()), (JUNE_5 + 30.0, 0));
    }
}
