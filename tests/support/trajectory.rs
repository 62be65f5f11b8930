//! Time histories as every program of the tests writes them: CSV, a column `time` first, one column per variable.

use std::collections::BTreeMap;
use std::path::Path;

/// A time history.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// s, ascending; an event may stand twice.
    pub time_s: Vec<f64>,
    /// Each variable's values, in its own unit.
    pub columns: BTreeMap<String, Vec<f64>>,
}

impl Trajectory {
    /// Reads a file. True is 1 and false is 0.
    ///
    /// # Panics
    /// Where it is no such table; the message says where.
    pub fn read(path: &Path) -> Self {
        let mut reader = csv::Reader::from_path(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let names: Vec<String> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
        assert_eq!(names.first().map(String::as_str), Some("time"), "{}", path.display());
        let mut values = vec![Vec::new(); names.len()];
        for (row, record) in reader.records().enumerate() {
            let record = record.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            for ((cell, column), name) in record.iter().zip(&mut values).zip(&names) {
                let number = match cell.trim() {
                    "true" => Ok(1.0),
                    "false" => Ok(0.0),
                    cell => cell.parse(),
                };
                let number = number.unwrap_or_else(|_| panic!("{}, row {row}, {name}: {cell}", path.display()));
                column.push(number);
            }
        }
        let time_s = values.remove(0);
        Self { time_s, columns: names.into_iter().skip(1).zip(values).collect() }
    }

    /// The variable's values.
    ///
    /// # Panics
    /// Where there is no such variable.
    pub fn column(&self, name: &str) -> &[f64] {
        self.columns.get(name).unwrap_or_else(|| panic!("no column {name} among {:?}", self.columns.keys()))
    }

    /// The largest difference of a variable from `reference`, relative to the largest magnitude that it has there. Rows
    /// are matched by time; where a time stands twice (before and after an event), the better of the two counts.
    ///
    /// # Panics
    /// Where a time of the reference is missing: a run that ended early is not equal.
    pub fn deviation(&self, reference: &Trajectory, name: &str) -> f64 {
        let (mine, theirs) = (self.column(name), reference.column(name));
        let scale = theirs.iter().fold(0.0_f64, |scale, value| scale.max(value.abs()));
        assert!(scale > 0.0, "{name} is 0 throughout the reference: nothing to compare");
        let mut worst = 0.0_f64;
        for (time, wanted) in reference.time_s.iter().zip(theirs) {
            let difference = self
                .time_s
                .iter()
                .zip(mine)
                .filter(|(own, _)| (*own - time).abs() <= 1e-9 * (1.0 + time.abs()))
                .map(|(_, found)| (found - wanted).abs())
                .min_by(f64::total_cmp)
                .unwrap_or_else(|| panic!("no row at {time} s"));
            assert!(difference.is_finite(), "{name} at {time} s is no number");
            worst = worst.max(difference);
        }
        worst / scale
    }
}
