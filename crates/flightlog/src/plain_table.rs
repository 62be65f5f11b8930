//! Tables other than logs, in the dialect of logs: fixes, strokes of a pump, inputs against time, measured water. Their text in
//! one plain form, line for line, for readers that know their columns.

use std::fmt::Write;
use std::path::Path;

use super::csv::{Rows, header, number};
use super::dates::unix_s;
use glidepolar_input::InputError;

/// From when the seconds of a date count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dates {
    /// From 1970.
    Since1970,
    /// From the first date of the column.
    SinceFirst,
}

/// The text of a table as CSV with a comma between cells, decimal points, seconds for dates and nothing for missing values. A
/// row keeps its line and a cell its column, so that errors name places in the file; comments are empty lines. What is neither
/// number nor date stays as it is.
///
/// # Errors
/// A file that cannot be read, is empty, or names a column twice.
pub fn plain_table(path: &Path, dates: Dates) -> Result<String, InputError> {
    let mut rows = Rows::open(path)?;
    let mut names: Vec<String> = header(path, &mut rows)?.iter().map(|name| plain(name)).collect();
    // A separator behind the last name.
    names.truncate(names.iter().rposition(|name| !name.is_empty()).map_or(0, |last| last + 1));
    let mut line = rows.line();
    let mut text = "\n".repeat(line.saturating_sub(1)) + &names.join(",");
    let mut first_dates = vec![None; names.len()];
    let mut record = ::csv::ByteRecord::new();
    while rows.next(&mut record)? {
        let here = rows.line();
        text.push_str(&"\n".repeat(here.saturating_sub(line).max(1)));
        line = here.max(line + 1);
        for (i, cell) in record.iter().enumerate().filter(|(i, cell)| *i < names.len() || !cell.is_empty()) {
            if i > 0 {
                text.push(',');
            }
            let shown = String::from_utf8_lossy(cell);
            match (number(cell), unix_s(&shown)) {
                (Some(value), _) if value.is_nan() => {}
                // Without what separates thousands.
                (Some(value), _) if shown.contains(',') && (shown.contains('.') || shown.matches(',').count() > 1) => {
                    let _ = write!(text, "{value}");
                }
                // The digits as they stand.
                (Some(_), _) => text.push_str(&shown.replacen(',', ".", 1)),
                (None, Some(time_s)) => {
                    let origin_s = match (dates, first_dates.get_mut(i)) {
                        (Dates::SinceFirst, Some(first)) => *first.get_or_insert(time_s),
                        _ => 0.0,
                    };
                    let _ = write!(text, "{}", time_s - origin_s);
                }
                (None, None) => text.push_str(&plain(&shown)),
            }
        }
    }
    text.push('\n');
    Ok(text)
}

/// A text that stays one cell of one line: without the separator, quotation marks and ends of lines, which a cell in
/// quotation marks may hold.
fn plain(text: &str) -> String {
    let replaced = |c: char| match c {
        ',' => ';',
        '"' => '\'',
        '\n' | '\r' => ' ',
        c => c,
    };
    text.chars().map(replaced).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain_text(bytes: &[u8], dates: Dates) -> String {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("table.csv");
        std::fs::write(&path, bytes).expect("a file");
        plain_table(&path, dates).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn every_dialect_of_a_log_gives_the_same_text() {
        let expected = "time_s,lat_deg\n0,54.25\n60,\n";
        for bytes in [
            &b"time_s,lat_deg\n0,54.25\n60,\n"[..],
            b"\xef\xbb\xbftime_s,lat_deg\r\n0,54.25\r\n60,NaN\r\n",
            b"time_s;lat_deg\n0;54,25\n60;nan\n",
            b"\"time_s\"\t\"lat_deg\"\n0\t54,25\n60\t--\n",
            b"time_s;lat_deg;\n0;54,25;\n60;;\n",
            b"time_s , lat_deg\n 0 ,\"54.25\"\n60,n/a",
            b"time_s;lat_deg\n2023-04-18T16:49:57Z;54,25\n2023-04-18 16:50:57;\n",
        ] {
            assert_eq!(plain_text(bytes, Dates::SinceFirst), expected, "{}", String::from_utf8_lossy(bytes));
        }
        assert_eq!(plain_text(b"time\n2023-04-18T16:49:57Z\n", Dates::Since1970), "time\n1681836597\n");
    }

    #[test]
    fn thousands_are_no_cells_of_their_own() {
        let text = plain_text(b"time_s,u\n\"1,655,143,200.5\",\"1,020.25\"\n\"1.020,5\",\"0,5\"\n", Dates::Since1970);
        assert_eq!(text, "time_s,u\n1655143200.5,1020.25\n1020.5,0.5\n");
    }

    #[test]
    fn a_cell_of_several_lines_stays_one_cell() {
        let text =
            plain_text(b"time_s,\"a\nnote\"\n1,\"two\nlines, \"\"one\"\" cell\"\n2,\"\"\"x\"\"\"\n", Dates::Since1970);
        assert_eq!(text.lines().collect::<Vec<_>>(), ["", "time_s,a note", "", "1,two lines; 'one' cell", "2,'x'"]);
    }

    #[test]
    fn rows_keep_their_lines_and_wrong_cells_their_text() {
        let text = plain_text(b"# made by hand\ntime_s;u\n\n1;x,y\n# a remark\n2;3;4\n", Dates::Since1970);
        let expected = ["", "time_s,u", "", "1,x;y", "", "2,3,4"];
        assert_eq!(text.lines().collect::<Vec<_>>(), expected);
        let text = plain_text(b"# made by hand\r\ntime_s;u\r\n\r\n1;x,y\r\n# a remark\r\n2;3;4", Dates::Since1970);
        assert_eq!(text.lines().collect::<Vec<_>>(), expected);
    }
}
