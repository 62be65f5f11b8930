//! A water column: density and temperature against depth, from a CSV table.
//!
//! Between the rows runs a cubic that keeps to them and is smooth across them (Fritsch and Carlson 1980, with the
//! harmonic mean of the neighbouring slopes): it never swings beyond the measured values, and an integrator meets no
//! corner. Above the first row and below the last the water stays as it is there.

use std::path::Path;

use glidepolar_input::{InputError, Place, nearest, printable};
use glidepolar_number::Number;

/// The columns of the table, in this or another order.
const COLUMNS: [&str; 3] = ["depth_m", "density_kg_m3", "temperature_C"];

/// Bounds of what water can be.
const BOUNDS: [(f64, f64); 3] = [(0.0, 12_000.0), (900.0, 1300.0), (-5.0, 50.0)];

/// Water at one depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaterAt<T> {
    /// In-situ density \[kg/m3\].
    pub density_kg_m3: T,
    /// Temperature \[degC\].
    pub temperature_C: T,
}

/// Density and temperature against depth.
#[derive(Debug, Clone, PartialEq)]
pub struct WaterColumn {
    rows: Vec<Row>,
}

/// Water at one depth of the table, with its change per metre.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Row {
    depth_m: f64,
    values: [f64; 2],
    slopes: [f64; 2],
}

impl WaterColumn {
    /// Reads the text of a table; `origin` is what errors name.
    ///
    /// # Errors
    /// An unknown or missing column, a cell that is no number or out of bounds, a depth that does not grow; with line
    /// and column. A row with an empty cell is left out.
    pub fn parse(text: &str, origin: &Path) -> Result<WaterColumn, InputError> {
        // Spreadsheets begin a CSV file with a byte order mark.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
        let Some((line, header)) = lines.next() else {
            let expected = format!("the file is empty, expected a header `{}`", COLUMNS.join(","));
            return Err(InputError::new(Place::file(origin), expected));
        };
        let order = read_header(header, &Place::line(origin, line + 1))?;
        let mut rows: Vec<Row> = Vec::new();
        for (line, text) in lines {
            let place = Place::line(origin, line + 1);
            let Some([depth_m, density, temperature]) = read_row(text, order, &place)? else { continue };
            if rows.last().is_some_and(|above| depth_m <= above.depth_m) {
                return Err(InputError::new(place, format!("depth {depth_m} m does not lie below the row above it"))
                    .help("sort the rows by depth, one row a depth"));
            }
            rows.push(Row { depth_m, values: [density, temperature], slopes: [0.0; 2] });
        }
        if rows.is_empty() {
            return Err(InputError::new(Place::file(origin), "no row below the header"));
        }
        give_slopes(&mut rows);
        Ok(WaterColumn { rows })
    }

    /// The water at a depth. Allocates nothing.
    pub fn at<T: Number>(&self, depth_m: T) -> WaterAt<T> {
        let below = self.rows.partition_point(|row| row.depth_m <= depth_m.value());
        let [density_kg_m3, temperature_C] = match (below.checked_sub(1), self.rows.get(below)) {
            (Some(above), Some(lower)) => between(&self.rows[above], lower, depth_m),
            (Some(last), None) => self.rows[last].values.map(T::constant),
            (None, _) => self.rows[0].values.map(T::constant),
        };
        WaterAt { density_kg_m3, temperature_C }
    }
}

fn read_header(header: &str, place: &Place) -> Result<[usize; 3], InputError> {
    let names: Vec<&str> = header.split(',').map(|name| name.trim().trim_matches('"')).collect();
    for (column, name) in names.iter().enumerate() {
        if !COLUMNS.contains(name) {
            let error = InputError::new(
                place.clone().column(column + 1),
                format!("unknown column `{}`, expected {}", printable(name), COLUMNS.join(", ")),
            );
            return Err(match nearest(name, COLUMNS) {
                Some(near) => error.help(format!("did you mean `{near}`?")),
                None => error,
            });
        }
    }
    let mut order = [0; 3];
    for (name, place_of) in COLUMNS.iter().zip(&mut order) {
        let mut found = names.iter().enumerate().filter(|(_, known)| known == &name).map(|(column, _)| column);
        *place_of = found.next().ok_or_else(|| InputError::new(place.clone(), format!("no column `{name}`")))?;
        if let Some(again) = found.next() {
            return Err(InputError::new(place.clone().column(again + 1), format!("a second column `{name}`")));
        }
    }
    Ok(order)
}

/// The values of a row; nothing where one of them is missing.
fn read_row(text: &str, order: [usize; 3], place: &Place) -> Result<Option<[f64; 3]>, InputError> {
    let cells: Vec<&str> = text.split(',').map(str::trim).collect();
    if cells.len() != COLUMNS.len() {
        let problem = format!("{} cells where the header has {}", cells.len(), COLUMNS.len());
        return Err(InputError::new(place.clone(), problem).help("a decimal comma splits a cell in two: use a point"));
    }
    if cells.contains(&"") {
        return Ok(None);
    }
    let mut values = [0.0; 3];
    for (i, value) in values.iter_mut().enumerate() {
        let cell = cells[order[i]];
        let (min, max) = BOUNDS[i];
        *value = cell.parse().ok().filter(|value: &f64| (min..=max).contains(value)).ok_or_else(|| {
            let problem = format!("{} = `{}`, expected a number from {min} to {max}", COLUMNS[i], printable(cell));
            InputError::new(place.clone().column(order[i] + 1), problem)
        })?;
    }
    Ok(Some(values))
}

/// Level at the ends and at every turning point, between the neighbouring slopes elsewhere.
fn give_slopes(rows: &mut [Row]) {
    let secant = |a: &Row, b: &Row, i: usize| (b.values[i] - a.values[i]) / (b.depth_m - a.depth_m);
    for middle in 1..rows.len().saturating_sub(1) {
        let (above, here, below) = (rows[middle - 1], rows[middle], rows[middle + 1]);
        let (h1, h2) = (here.depth_m - above.depth_m, below.depth_m - here.depth_m);
        for i in 0..2 {
            let (s1, s2) = (secant(&above, &here, i), secant(&here, &below, i));
            if s1 * s2 > 0.0 {
                let (w1, w2) = (2.0 * h2 + h1, h2 + 2.0 * h1);
                rows[middle].slopes[i] = (w1 + w2) / (w1 / s1 + w2 / s2);
            }
        }
    }
}

fn between<T: Number>(above: &Row, below: &Row, depth_m: T) -> [T; 2] {
    let h = below.depth_m - above.depth_m;
    let t = (depth_m - above.depth_m) / h;
    std::array::from_fn(|i| {
        let rise = below.values[i] - above.values[i];
        let (s1, s2) = (above.slopes[i] * h, below.slopes[i] * h);
        // Hermite's cubic, in powers of t.
        t * (t * (t * (s1 + s2 - 2.0 * rise) + (3.0 * rise - 2.0 * s1 - s2)) + s1) + above.values[i]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::Dual64;

    const TABLE: &str = "# a summer's day\ndepth_m,temperature_C,density_kg_m3\n0,18,1024.0\n20,17.5,1024.2\n35,9,1026.4\n100,8,1027.0\n500,6,1029.5\n";

    fn column() -> WaterColumn {
        WaterColumn::parse(TABLE, Path::new("water.csv")).unwrap()
    }

    #[test]
    fn it_keeps_to_its_rows_and_swings_nowhere() {
        let column = column();
        assert_eq!(column.at(35.0), WaterAt { density_kg_m3: 1026.4, temperature_C: 9.0 });
        assert_eq!(column.at(-3.0), column.at(0.0));
        assert_eq!(column.at(4000.0), WaterAt { density_kg_m3: 1029.5, temperature_C: 6.0 });
        let samples: Vec<_> = (0..6000).map(|i| column.at(0.1 * f64::from(i))).collect();
        for pair in samples.windows(2) {
            assert!(pair[1].density_kg_m3 >= pair[0].density_kg_m3 && pair[1].temperature_C <= pair[0].temperature_C);
        }
    }

    #[test]
    fn its_slope_is_that_of_differences_and_continuous_across_rows() {
        let column = column();
        for depth in [5.0, 20.0, 27.0, 35.0, 99.9, 100.0, 300.0] {
            let exact = column.at(Dual64::new(depth, 1.0)).density_kg_m3.eps;
            let h = 1e-4;
            let above = (column.at(depth).density_kg_m3 - column.at(depth - h).density_kg_m3) / h;
            let below = (column.at(depth + h).density_kg_m3 - column.at(depth).density_kg_m3) / h;
            assert!((exact - above).abs() < 1e-5 && (exact - below).abs() < 1e-5, "{depth}: {above} {exact} {below}");
        }
    }

    #[test]
    fn one_row_is_water_that_is_the_same_everywhere() {
        let column = WaterColumn::parse("depth_m,density_kg_m3,temperature_C\n0,1025,10\n", Path::new("w")).unwrap();
        assert_eq!(column.at(77.0).density_kg_m3, 1025.0);
    }

    #[test]
    fn a_byte_order_mark_is_no_part_of_the_table() {
        let marked = WaterColumn::parse(&format!("\u{feff}{TABLE}"), Path::new("w")).unwrap();
        assert_eq!(marked, column());
    }

    #[test]
    fn a_row_that_lacks_a_value_is_left_out() {
        let gap = TABLE.trim_end().to_owned() + "\n9000,,2\n";
        assert_eq!(WaterColumn::parse(&gap, Path::new("w")).unwrap(), column());
    }

    #[test]
    fn bad_tables_are_refused_with_line_and_column() {
        for (text, expected) in [
            ("", "w.csv: the file is empty"),
            ("depth_m,density_kg_m3\n0,1025\n", "w.csv:1: no column `temperature_C`"),
            ("depth_m,density_kg_m3,temperature_c\n", "w.csv:1:3: unknown column `temperature_c`"),
            ("depth_m,density_kg_m3,temperature_C\n", "no row below the header"),
            ("depth_m,density_kg_m3,temperature_C\n0,1025\n", "w.csv:2: 2 cells where the header has 3"),
            ("depth_m,density_kg_m3,temperature_C\n0,1.025,10\n", "w.csv:2:2: density_kg_m3 = `1.025`"),
            ("depth_m,density_kg_m3,temperature_C\n0,1025,nan\n", "w.csv:2:3: temperature_C = `nan`"),
            ("depth_m,density_kg_m3,temperature_C\n5,1025,9\n5,1026,9\n", "w.csv:3: depth 5 m does not lie below"),
        ] {
            let error = WaterColumn::parse(text, Path::new("w.csv")).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
