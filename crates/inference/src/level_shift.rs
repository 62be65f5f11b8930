//! A level that is another one for a part of a record: a step, or a change that goes again.
//!
//! A smooth curve follows a step badly, a slow noise takes it up. So each of a list of parts is held against no shift, by the F test of
//! one more parameter and what both leave, times the number of parts that are tried (Bonferroni). Knows rows that err independently and
//! a model of them.

use nalgebra::{DMatrix, DVector, DVectorView};

use super::noise::orthonormal;
use super::regression::f_p_value;
use super::relevance::ONE_SIDED;

/// The clearest of several shifts.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelShift {
    /// Root mean square of what it changes in the rows beside the model, the share of the noise removed.
    pub size: f64,
    /// Mean square of what it leaves.
    pub mean_square: f64,
    /// Probability of such a shift by chance, corrected for the number that was tried.
    pub p_value: f64,
    rows: usize,
}

impl LevelShift {
    /// The shift, one of the columns, that explains most of the residuals of a fit whose model has these columns; none without rows to
    /// spare. Its mean square is no less than the `least`.
    pub fn clearest(
        model: &DMatrix<f64>,
        shifts: &DMatrix<f64>,
        residual: &DVector<f64>,
        least: f64,
    ) -> Option<LevelShift> {
        let basis = orthonormal(model.clone());
        let rows = residual.len();
        let free = rows.checked_sub(basis.ncols() + 1).filter(|free| *free > 0)? as f64;
        let residual = residual - &basis * basis.tr_mul(residual);
        let beside = shifts - &basis * basis.tr_mul(shifts);
        let explained = |shift: DVectorView<'_, f64>| {
            let square = shift.norm_squared();
            // A shift that the model has as well changes nothing beside it.
            if square > f64::EPSILON * rows as f64 { shift.dot(&residual).powi(2) / square } else { 0.0 }
        };
        let most = beside.column_iter().map(explained).fold(0.0, f64::max);
        let mean_square = ((residual.norm_squared() - most) / free).max(least);
        (most > 0.0).then(|| LevelShift {
            size: ((most - mean_square).max(0.0) / rows as f64).sqrt(),
            mean_square,
            p_value: (shifts.ncols() as f64 * f_p_value(most / mean_square, 1.0, free)).min(1.0),
            rows,
        })
    }

    /// The size less what chance may have added: below the true one in 95 of 100.
    pub fn least_size(&self) -> f64 {
        (self.size - ONE_SIDED * (self.mean_square / self.rows as f64).sqrt()).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Student's t of two samples, by hand: 1, 3 and 7, 9 are 6 apart, their variance is 2, t^2 = 36/2 = 18 on 2.
    #[test]
    fn a_shift_beside_a_mean_is_the_test_of_two_means() {
        let model = DMatrix::from_element(4, 1, 1.0);
        let shifts = DMatrix::from_column_slice(4, 1, &[0.0, 0.0, 1.0, 1.0]);
        let values = DVector::from_column_slice(&[1.0, 3.0, 7.0, 9.0]);
        let found = LevelShift::clearest(&model, &shifts, &values, 0.0).expect("rows to spare");
        assert!((found.mean_square - 2.0).abs() < 1e-12);
        // P(|t| > s) on two degrees of freedom is 1 - s / sqrt(2 + s^2).
        let expected = 1.0 - (18.0f64 / 20.0).sqrt();
        assert!((found.p_value - expected).abs() < 1e-9, "{} against {expected}", found.p_value);
        let twice = DMatrix::from_columns(&[shifts.column(0), shifts.column(0)]);
        let of_two = LevelShift::clearest(&model, &twice, &values, 0.0).expect("rows to spare");
        assert!((of_two.p_value - 2.0 * expected).abs() < 1e-9);
        let stated = LevelShift::clearest(&model, &shifts, &values, 18.0).expect("rows to spare");
        assert!(stated.p_value > 0.2, "no better than stated");
        assert_eq!(LevelShift::clearest(&model, &model, &values, 0.0), None);
    }
}
