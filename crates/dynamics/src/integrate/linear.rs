//! Dense linear equations of one fixed small size: elimination with partial pivoting, as plain loops over arrays.
//!
//! nalgebra's takes twice as long at this size, and a step solves eight systems with one decomposition. Every loop of
//! [`Decomposition::solve`] runs over whole pieces of a column, zeros included: of a fixed length, each becomes a few vector
//! instructions.

use super::method::{Felt, N_FELT};

/// A matrix brought to triangular form.
pub struct Decomposition {
    /// Columns of the multipliers below the diagonal; zero elsewhere.
    lower: [Felt; N_FELT],
    /// Columns of the upper factor above the diagonal; zero elsewhere.
    upper: [Felt; N_FELT],
    /// Reciprocals of the pivots.
    reciprocals: Felt,
    /// Which row of the matrix stands in each row.
    rows: [usize; N_FELT],
}

impl Decomposition {
    /// Of the matrix with these columns; none for one that is singular or not finite.
    pub fn of(mut columns: [Felt; N_FELT]) -> Option<Self> {
        let mut rows: [usize; N_FELT] = std::array::from_fn(|row| row);
        let mut reciprocals = [0.0; N_FELT];
        for pivot in 0..N_FELT {
            let column = &columns[pivot];
            let mut largest = pivot;
            for row in pivot + 1..N_FELT {
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
                    for row in pivot + 1..N_FELT {
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
    pub fn solve(&self, right: &Felt) -> Felt {
        let mut solution: Felt = std::array::from_fn(|row| right[self.rows[row]]);
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
const _: () = assert!(N_FELT.is_multiple_of(PIECE));

fn subtract(from: &mut [f64], column: &[f64], times: f64) {
    for (values, multipliers) in from.as_chunks_mut::<PIECE>().0.iter_mut().zip(column.as_chunks::<PIECE>().0) {
        for (value, multiplier) in values.iter_mut().zip(multipliers) {
            *value -= multiplier * times;
        }
    }
}
