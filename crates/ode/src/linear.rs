//! Dense linear equations of one fixed small size: elimination with partial pivoting, as plain loops over arrays.
//!
//! nalgebra's takes twice as long at this size, and a step solves eight systems with one decomposition. Every loop of
//! [`Decomposition::solve`] runs over whole pieces of a column, zeros included: of a fixed length, each becomes a few vector
//! instructions.

/// A matrix brought to triangular form.
pub struct Decomposition<const F: usize> {
    /// Columns of the multipliers below the diagonal; zero elsewhere.
    lower: [[f64; F]; F],
    /// Columns of the upper factor above the diagonal; zero elsewhere.
    upper: [[f64; F]; F],
    /// Reciprocals of the pivots.
    reciprocals: [f64; F],
    /// Which row of the matrix stands in each row.
    rows: [usize; F],
}

impl<const F: usize> Decomposition<F> {
    /// Of the matrix with these columns; none for one that is singular or not finite.
    pub fn new(mut columns: [[f64; F]; F]) -> Option<Self> {
        const { assert!(F.is_multiple_of(PIECE), "solve takes rows in pieces") };
        let mut rows: [usize; F] = std::array::from_fn(|row| row);
        let mut reciprocals = [0.0; F];
        for pivot in 0..F {
            let column = &columns[pivot];
            let mut largest = pivot;
            for row in pivot + 1..F {
                if column[row].abs() > column[largest].abs() {
                    largest = row;
                }
            }
            if largest != pivot {
                rows.swap(pivot, largest);
                columns.iter_mut().for_each(|column| column.swap(pivot, largest));
            }
            let reciprocal = columns[pivot][pivot].recip();
            if !reciprocal.is_finite() {
                return None;
            }
            reciprocals[pivot] = reciprocal;
            columns[pivot][pivot + 1..].iter_mut().for_each(|value| *value *= reciprocal);
            let multipliers = columns[pivot];
            for column in &mut columns[pivot + 1..] {
                let top = column[pivot];
                if top != 0.0 {
                    for row in pivot + 1..F {
                        column[row] -= multipliers[row] * top;
                    }
                }
            }
        }
        let part = |keep: fn(usize, usize) -> bool| {
            std::array::from_fn(|j| std::array::from_fn(|i| if keep(i, j) { columns[j][i] } else { 0.0 }))
        };
        Some(Decomposition { lower: part(|i, j| i > j), upper: part(|i, j| i < j), reciprocals, rows })
    }

    /// The solution for this right side.
    pub fn solve(&self, right: &[f64; F]) -> [f64; F] {
        let mut solution: [f64; F] = std::array::from_fn(|row| right[self.rows[row]]);
        for (pivot, column) in self.lower.iter().enumerate() {
            let top = solution[pivot];
            let first = pivot - pivot % PIECE;
            subtract(&mut solution[first..], &column[first..], top);
        }
        for (pivot, column) in self.upper.iter().enumerate().rev() {
            let solved = solution[pivot] * self.reciprocals[pivot];
            solution[pivot] = solved;
            let end = pivot.next_multiple_of(PIECE);
            subtract(&mut solution[..end], &column[..end], solved);
        }
        solution
    }
}

/// Rows that are taken at once.
const PIECE: usize = 2;

#[inline]
fn subtract(from: &mut [f64], column: &[f64], times: f64) {
    for (values, multipliers) in from.as_chunks_mut::<PIECE>().0.iter_mut().zip(column.as_chunks::<PIECE>().0) {
        for (value, multiplier) in values.iter_mut().zip(multipliers) {
            *value -= multiplier * times;
        }
    }
}
