//! Tables that the calling program holds in memory, each under a name that stands where a file's name would.
//!
//! A program that has a table already, as a data frame in Python, announces it and names it to the readers. They copy
//! rows piece by piece; the table itself is never copied. Knows nothing of what the columns mean.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// Numbers of one column, wherever they lie.
pub trait Numbers: Send + Sync {
    /// The value in a row; NaN where it is missing. `row` is below the table's number of rows.
    fn at(&self, row: usize) -> f64;
}

/// A table in memory.
pub struct Table {
    rows: usize,
    columns: Vec<(String, Box<dyn Numbers>)>,
    path: PathBuf,
}

static TABLES: Mutex<BTreeMap<PathBuf, Weak<Table>>> = Mutex::new(BTreeMap::new());
static NEXT: AtomicU64 = AtomicU64::new(1);

impl Table {
    /// Announces a table of `rows` rows. It can be named as long as what comes back is kept.
    pub fn announce(rows: usize, columns: Vec<(String, Box<dyn Numbers>)>) -> Arc<Table> {
        let path = PathBuf::from(format!("<table {} in memory>", NEXT.fetch_add(1, Ordering::Relaxed)));
        let table = Arc::new(Table { rows, columns, path: path.clone() });
        let mut tables = TABLES.lock().unwrap_or_else(PoisonError::into_inner);
        tables.retain(|_, table| table.strong_count() > 0);
        tables.insert(path, Arc::downgrade(&table));
        table
    }

    /// The table of this name; nothing where the name is a file's.
    pub fn named(path: &Path) -> Option<Arc<Table>> {
        TABLES.lock().unwrap_or_else(PoisonError::into_inner).get(path).and_then(Weak::upgrade)
    }

    /// The name that stands for it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The columns' names, in order.
    pub fn names(&self) -> Vec<String> {
        self.columns.iter().map(|(name, _)| name.clone()).collect()
    }

    /// A value.
    ///
    /// # Panics
    /// Where there is no such column.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.columns[column].1.at(row)
    }
}

#[cfg(test)]
mod tests {
    use super::{Numbers, Table};
    use std::path::Path;

    struct Ramp;

    impl Numbers for Ramp {
        fn at(&self, row: usize) -> f64 {
            row as f64
        }
    }

    #[test]
    fn a_table_can_be_named_as_long_as_it_is_kept() {
        let table = Table::announce(3, vec![("time_s".to_owned(), Box::new(Ramp))]);
        let path = table.path().to_owned();
        let found = Table::named(&path).expect("it was announced");
        assert_eq!((found.rows(), found.names(), found.at(2, 0)), (3, vec!["time_s".to_owned()], 2.0));
        drop((table, found));
        assert!(Table::named(&path).is_none());
        assert!(Table::named(Path::new("flight.csv")).is_none());
    }
}
