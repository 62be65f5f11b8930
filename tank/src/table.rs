//! Tables in CSV files, small enough to be held as text: every complaint with line and cell. Knows no quantity.

use std::path::{Path, PathBuf};

use glidepolar_input::lines::TextLines;
use glidepolar_input::{InputError, Place, nearest, printable};

/// A table as text, rows and cells as the file has them.
#[derive(Debug, Clone)]
pub struct Table {
    file: PathBuf,
    header: Vec<String>,
    header_line: usize,
    rows: Vec<Row>,
}

#[derive(Debug, Clone)]
struct Row {
    line: usize,
    cells: Vec<String>,
}

/// Rows that do not fit the header: first cell, and what is wrong.
pub type Malformed = Vec<(String, InputError)>;

/// One row of a table, to ask for cells by column name.
#[derive(Debug, Clone, Copy)]
pub struct Cells<'a> {
    table: &'a Table,
    row: &'a Row,
}

impl Table {
    /// Reads a file; lines that begin with `#` are remarks.
    ///
    /// # Errors
    /// Where the file cannot be read, is empty, or a row has more or fewer cells than the header.
    pub fn read(file: &Path) -> Result<Table, InputError> {
        let (table, malformed) = Table::read_what_fits(file)?;
        match malformed.into_iter().next() {
            Some((_, error)) => Err(error),
            None => Ok(table),
        }
    }

    /// Reads a file, and keeps apart the rows with more or fewer cells than the header: their first cell, and what is wrong.
    ///
    /// # Errors
    /// Where the file cannot be read or is empty.
    pub fn read_what_fits(file: &Path) -> Result<(Table, Malformed), InputError> {
        let bytes = std::fs::read(file).map_err(|error| InputError::io(file, &error))?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let offset = error.utf8_error().valid_up_to();
            let place = Place::offset(file, &String::from_utf8_lossy(&error.as_bytes()[..offset]), offset);
            InputError::new(place, "not UTF-8 text").help("save the table as CSV in UTF-8")
        })?;
        Table::parse(file, text.trim_start_matches('\u{feff}'))
    }

    fn parse(file: &Path, text: &str) -> Result<(Table, Malformed), InputError> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let (mut rows, mut record) = (Vec::new(), csv::StringRecord::new());
        let mut lines = TextLines::new(text.as_bytes());
        loop {
            let is_row = reader.read_record(&mut record).map_err(|error| {
                let line = error.position().map_or(1, |p| p.line() as usize);
                InputError::new(Place::line(file, line), printable(&error.to_string()))
            })?;
            if !is_row {
                break;
            }
            let line = lines.ending_at(reader.position().byte());
            rows.push(Row { line, cells: record.iter().map(str::to_owned).collect() });
        }
        if rows.is_empty() {
            return Err(InputError::new(
                Place::file(file),
                "the file is empty, expected a header line with column names",
            ));
        }
        let header = rows.remove(0);
        if let [only] = header.cells.as_slice()
            && (only.contains(';') || only.contains('\t'))
        {
            let separator = if only.contains(';') { "semicolons" } else { "tabs" };
            return Err(InputError::new(
                Place::line(file, header.line),
                format!("columns are separated by {separator}, expected commas"),
            )
            .help("write numbers with a decimal point and separate columns with commas"));
        }
        let width = header.cells.len();
        let (rows, malformed): (Vec<Row>, Vec<Row>) = rows.into_iter().partition(|row| row.cells.len() == width);
        let malformed =
            malformed.into_iter().map(|row| (row.cells[0].clone(), wrong_width(file, &row, width))).collect();
        for (i, name) in header.cells.iter().enumerate() {
            if header.cells[..i].contains(name) {
                let place = Place::line(file, header.line).column(i + 1);
                return Err(InputError::new(place, format!("column {} stands twice", printable(name))));
            }
        }
        Ok((Table { file: file.to_owned(), header: header.cells, header_line: header.line, rows }, malformed))
    }

    /// Whether a column of this name is there.
    pub fn has(&self, column: &str) -> bool {
        self.header.iter().any(|name| name == column)
    }

    /// The column names.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// The rows.
    pub fn rows(&self) -> impl Iterator<Item = Cells<'_>> {
        self.rows.iter().map(move |row| Cells { table: self, row })
    }

    /// The file itself as the place of a complaint.
    pub fn place(&self) -> Place {
        Place::file(&self.file)
    }

    /// Complains of the first column that is missing, with the one it may have been meant by.
    ///
    /// # Errors
    /// Where a column is missing.
    pub fn require(&self, columns: &[&str]) -> Result<(), InputError> {
        match columns.iter().find(|column| !self.has(column)) {
            None => Ok(()),
            Some(missing) => Err(missing_column(Place::line(&self.file, self.header_line), missing, &self.header)),
        }
    }
}

fn wrong_width(file: &Path, row: &Row, width: usize) -> InputError {
    let problem = format!("{} cells where the header names {width} columns", row.cells.len());
    let error = InputError::new(Place::line(file, row.line), problem);
    if row.cells.len() > width {
        error.help("decimal commas, or a comma in a note without quotes? write numbers with a decimal point")
    } else {
        error.help("leave cells that do not apply empty, but keep their commas")
    }
}

/// Other names of the yaw angle of a steady run.
const DRIFT_ANGLES: [&str; 8] =
    ["beta_deg", "beta", "drift_deg", "drift_angle_deg", "alpha_deg", "alpha", "aoa_deg", "angle_of_attack_deg"];

/// A column that should be there and is not, with the one that may have been meant.
pub fn missing_column(place: Place, missing: &str, header: &[String]) -> InputError {
    let error = InputError::new(place, format!("column {missing} is missing"));
    let other_name = header
        .iter()
        .find(|name| missing == "yaw_deg" && DRIFT_ANGLES.contains(&name.trim().to_ascii_lowercase().as_str()));
    if let Some(name) = other_name {
        return error.help(format!(
            "{} is a drift angle or an angle of attack: rename it to yaw_deg, degrees, positive bow to starboard (drift angles beta are often counted the other way: turn their sign)",
            printable(name)
        ));
    }
    match nearest(missing, header.iter().map(String::as_str)) {
        Some(near) => error.help(format!("is it the one named {}? rename it to {missing}", printable(near))),
        None => error.help(format!("found the columns {}", printable(&header.join(", ")))),
    }
}

impl<'a> Cells<'a> {
    /// Where a column of this row stands.
    pub fn place(&self, column: &str) -> Place {
        let line = Place::line(&self.table.file, self.row.line);
        match self.index(column) {
            Some(index) => line.column(index + 1),
            None => line,
        }
    }

    /// The line of this row.
    pub fn line(&self) -> usize {
        self.row.line
    }

    /// A cell as text; empty where the column is missing or the cell empty.
    pub fn text(&self, column: &str) -> &'a str {
        self.index(column).map_or("", |index| self.row.cells[index].as_str())
    }

    /// A number that has to be there.
    ///
    /// # Errors
    /// Where the cell is empty or no finite number.
    pub fn number(&self, column: &str) -> Result<f64, InputError> {
        self.optional_number(column)?
            .ok_or_else(|| InputError::new(self.place(column), format!("{column} is empty, expected a number")))
    }

    /// A number, if the cell holds one.
    ///
    /// # Errors
    /// Where the cell holds something else.
    pub fn optional_number(&self, column: &str) -> Result<Option<f64>, InputError> {
        let text = self.text(column);
        if text.is_empty() {
            return Ok(None);
        }
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Some(number)),
            _ => Err(not_a_number(self.place(column), column, text)),
        }
    }

    fn index(&self, column: &str) -> Option<usize> {
        self.table.header.iter().position(|name| name == column)
    }
}

/// A cell that should hold a number and does not.
pub fn not_a_number(place: Place, column: &str, text: &str) -> InputError {
    let error = InputError::new(place, format!("{column} is {}, expected a finite number", quoted(text)));
    if text.contains(',') { error.help("write a decimal point instead of the comma") } else { error }
}

fn quoted(text: &str) -> String {
    if text.is_empty() { "empty".to_owned() } else { format!("`{}`", printable(text)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Table, String> {
        let (table, malformed) = Table::parse(Path::new("t.csv"), text).map_err(|error| error.to_string())?;
        malformed.first().map_or(Ok(table), |(_, error)| Err(error.to_string()))
    }

    #[test]
    fn complaints_name_line_and_cell() {
        assert!(parse("").unwrap_err().contains("t.csv: the file is empty"));
        let error = parse("a;b\n1,5;2\n").unwrap_err();
        assert!(error.contains("t.csv:1") && error.contains("semicolons"), "{error}");
        let error = parse("a,b\n1,5,2\n").unwrap_err();
        assert!(error.contains("t.csv:2") && error.contains("decimal commas"), "{error}");
        assert!(parse("a,a\n1,2\n").unwrap_err().contains("t.csv:1:2"));
        let table = parse("# remark\nyaw_deg,b\n1,x\n\"1,5\",nan\n").unwrap();
        let row = table.rows().next().unwrap();
        assert_eq!(row.number("yaw_deg").unwrap(), 1.0);
        let error = row.number("b").unwrap_err().to_string();
        assert!(error.contains("t.csv:3:2") && error.contains("`x`"), "{error}");
        let table_with_gap = parse("yaw_deg,b\n1,2\n# a gap\n\n3,x\n").unwrap();
        let error = table_with_gap.rows().nth(1).unwrap().number("b").unwrap_err().to_string();
        assert!(error.contains("t.csv:5:2"), "{error}");
        let row = table.rows().nth(1).unwrap();
        assert!(row.number("yaw_deg").unwrap_err().to_string().contains("decimal point"));
        assert!(row.number("b").unwrap_err().to_string().contains("finite"));
        let error = table.require(&["yaw_degs"]).unwrap_err().to_string();
        assert!(error.contains("yaw_degs is missing") && error.contains("yaw_deg"), "{error}");
    }
}
