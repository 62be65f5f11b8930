//! Columns of a data frame, read where they lie.

use std::path::Path;
use std::sync::Arc;

use glidepolar_input::memory;
use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Columns of 64-bit floats under a name that stands where a file's name would, as long as this object lives.
#[pyclass(frozen, module = "glidepolar._native")]
pub struct Table(Arc<memory::Table>);

#[pymethods]
impl Table {
    #[new]
    fn new(columns: Vec<(String, Bound<'_, PyArray1<f64>>)>) -> PyResult<Self> {
        let rows = columns.first().map_or(0, |(_, values)| values.len());
        if let Some((name, values)) = columns.iter().find(|(_, values)| values.len() != rows) {
            return Err(PyValueError::new_err(format!("column {name} has {} rows, expected {rows}", values.len())));
        }
        let columns = columns.into_iter().map(|(name, values)| (name, numbers(values))).collect();
        Ok(Table(memory::Table::announce(rows, columns)))
    }

    /// The name that stands for it.
    #[getter]
    fn path(&self) -> &Path {
        self.0.path()
    }
}

fn numbers(values: Bound<'_, PyArray1<f64>>) -> Box<dyn memory::Numbers> {
    let stride = values.strides().first().copied().unwrap_or(0);
    Box::new(Strided { first: values.data().cast(), stride, rows: values.len(), _array: values.unbind() })
}

/// A column of an array, at the place where Python has it.
struct Strided {
    first: *const u8,
    /// From one value to the next, in bytes.
    stride: isize,
    rows: usize,
    /// Keeps the memory.
    _array: Py<PyArray1<f64>>,
}

// SAFETY: the memory lives as long as the array, which is kept, and is only read. A program that writes to the array from
// another thread meanwhile gets old or new numbers, as it does from numpy.
unsafe impl Send for Strided {}
// SAFETY: as above.
unsafe impl Sync for Strided {}

impl memory::Numbers for Strided {
    fn at(&self, row: usize) -> f64 {
        assert!(row < self.rows, "a row of the table");
        // SAFETY: numpy places element `row` this many bytes after the first, and it is inside by the check above. An array
        // may begin anywhere.
        unsafe { self.first.offset(self.stride * row as isize).cast::<f64>().read_unaligned() }
    }
}
