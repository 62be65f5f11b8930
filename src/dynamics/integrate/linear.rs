//! Dense linear equations of one fixed small size: elimination with partial pivoting, as plain loops over arrays.
//!
//! nalgebra's takes twice as long at this size, and a step solves eight systems with one decomposition: together a fifth
//! of its time. Columns are stored, so that each loop runs down one of them.

use super::method::Scaled;
use crate::dynamics::state::N_STATES;

/// A matrix brought to triangular form.
pub struct Decomposition {
    /// Columns: above the diagonal of the upper factor, below it the multipliers, on it the reciprocals of the pivots.
    columns: [Scaled; N_STATES],
    /// Which row was swapped up at each pivot.
    swaps: [usize; N_STATES],
}

impl Decomposition {
    /// Of the matrix with these columns; none for one that is singular or not finite.
    pub fn of(mut columns: [Scaled; N_STATES]) -> Option<Self> {
        let mut swaps = [0; N_STATES];
        for pivot in 0..N_STATES {
            let column = &columns[pivot];
            let mut largest = pivot;
            for row in pivot + 1..N_STATES {
                if column[row].abs() > column[largest].abs() {
                    largest = row;
                }
            }
            swaps[pivot] = largest;
            if largest != pivot {
                columns.iter_mut().for_each(|column| column.swap(pivot, largest));
            }
            let reciprocal = columns[pivot][pivot].recip();
            if !reciprocal.is_finite() {
                return None;
            }
            columns[pivot][pivot] = reciprocal;
            columns[pivot][pivot + 1..].iter_mut().for_each(|value| *value *= reciprocal);
            let multipliers = columns[pivot];
            for column in &mut columns[pivot + 1..] {
                let top = column[pivot];
                if top != 0.0 {
                    subtract_below(pivot, column, &multipliers, top);
                }
            }
        }
        Some(Decomposition { columns, swaps })
    }

    /// The solution for this right side.
    pub fn solve(&self, mut right: Scaled) -> Scaled {
        for (pivot, &swap) in self.swaps.iter().enumerate() {
            right.swap(pivot, swap);
        }
        for pivot in 0..N_STATES - 1 {
            let top = right[pivot];
            subtract_below(pivot, &mut right, &self.columns[pivot], top);
        }
        for pivot in (0..N_STATES).rev() {
            let column = &self.columns[pivot];
            let solved = right[pivot] * column[pivot];
            right[pivot] = solved;
            for row in 0..pivot {
                right[row] -= column[row] * solved;
            }
        }
        right
    }
}

fn subtract_below(pivot: usize, from: &mut Scaled, multipliers: &Scaled, times: f64) {
    for row in pivot + 1..N_STATES {
        from[row] -= multipliers[row] * times;
    }
}
