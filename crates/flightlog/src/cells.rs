//! Cells of a table as numbers, and what to say of those that are none. Knows no table.

use glidepolar_input::{InputError, Place, printable};

/// What programs write for a value that is missing.
const MISSING: [&str; 13] =
    ["nan", "na", "n/a", "null", "none", "--", "-", "nat", "#n/a", "#na", "#value!", "#div/0!", "#null!"];

/// The number in a cell; NaN for an empty one; nothing where it holds something else.
pub(super) fn number(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?.trim();
    if text.is_empty() || MISSING.iter().any(|missing| text.eq_ignore_ascii_case(missing)) {
        return Some(f64::NAN);
    }
    // A comma in a cell is the decimal mark of half the world, where it does not stand between thousands.
    let parsed = match without_thousands(text) {
        Some(plain) => plain.parse(),
        None if text.contains(',') => text.replacen(',', ".", 1).parse(),
        None => text.parse(),
    };
    parsed.ok().filter(|value: &f64| value.is_finite())
}

/// A number without what separates its thousands: `1,020.0`, `1.020,0`, `1,020,300`. Nothing where nothing does, or where one
/// comma or point alone may as well be the decimal mark.
fn without_thousands(text: &str) -> Option<String> {
    let (comma, point) = (text.rfind(','), text.rfind('.'));
    let (separator, decimal) = match (comma, point) {
        (Some(comma), Some(point)) => (if comma < point { ',' } else { '.' }, Some(comma.max(point))),
        (Some(_), None) if text.matches(',').count() > 1 => (',', None),
        _ => return None,
    };
    let whole = decimal.map_or(text, |at| &text[..at]);
    let mut groups = whole.trim_start_matches(['-', '+']).split(separator);
    let is_digits = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    let is_first = groups.next().is_some_and(|group| (1..=3).contains(&group.len()) && is_digits(group));
    let is_grouped = is_first && groups.all(|group| group.len() == 3 && is_digits(group));
    let fraction = decimal.map_or(String::new(), |at| format!(".{}", &text[at + 1..]));
    is_grouped.then(|| whole.replace(separator, "") + &fraction)
}

pub(super) fn not_a_number(place: Place, column: &str, cell: &[u8]) -> InputError {
    let found = printable(&String::from_utf8_lossy(cell));
    if is_name_again(column, cell) {
        return names_again(place);
    }
    InputError::new(place, format!("`{}` is `{found}`, expected a number or an empty cell", printable(column)))
}

/// Whether a cell holds the name of its own column.
fn is_name_again(column: &str, cell: &[u8]) -> bool {
    cell.trim_ascii() == column.trim().as_bytes()
}

fn names_again(place: Place) -> InputError {
    InputError::new(place, "the line of names again: two files one behind the other")
        .help("take them apart at this line, and give both files")
}

pub(super) fn no_time(place: Place, column: &str, cell: &[u8]) -> InputError {
    if is_name_again(column, cell) {
        return names_again(place);
    }
    let found = printable(&String::from_utf8_lossy(cell));
    let problem = format!("`{}` is `{found}`, neither seconds nor a date that is known", printable(column));
    InputError::new(place, problem).help(
        "dates are 2022-06-13T18:00:00Z or, the day first, 13/06/2022 18:00:00; --unit time_s=month-first reads 06/13/2022",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_programs_and_countries_write_them() {
        for (cell, value) in [
            ("1020.5", 1020.5),
            ("1,020.0", 1020.0),
            ("-1,020.25", -1020.25),
            ("1.020,5", 1020.5),
            ("1,020,300", 1_020_300.0),
            ("1,655,143,200.5", 1_655_143_200.5),
            ("1,5", 1.5),
            ("1.5e3", 1500.0),
        ] {
            assert_eq!(number(cell.as_bytes()), Some(value), "{cell}");
        }
        for cell in ["", "NaN", "#N/A", "#NA", "#VALUE!", "#DIV/0!", "--"] {
            assert!(number(cell.as_bytes()).is_some_and(f64::is_nan), "{cell}");
        }
        for cell in ["1,02,0.0", "1.0.0", "12,0200.5", "abc", "inf", "#5"] {
            assert_eq!(number(cell.as_bytes()), None, "{cell}");
        }
    }
}
