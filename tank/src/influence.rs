//! What independent errors do to numbers: each kind of error taken apart into parts of one standard error, and a number
//! carries only the parts that it feels. Knows no error's origin.

use nalgebra::{DMatrix, DVector};

/// What one standard error of each part does to some numbers.
#[derive(Debug, Clone)]
pub struct Influence {
    /// Which parts of the kind are felt, in rising order.
    pub parts: Vec<usize>,
    /// Numbers by parts.
    pub on: DMatrix<f64>,
}

impl Influence {
    /// On numbers that feel nothing.
    pub fn none(numbers: usize) -> Self {
        Influence { parts: Vec::new(), on: DMatrix::zeros(numbers, 0) }
    }

    /// On numbers that may feel every part.
    pub fn of_all(on: DMatrix<f64>) -> Self {
        Influence { parts: (0..on.ncols()).collect(), on }
    }

    /// On numbers made of these by a linear map.
    pub fn through(self, map: &DMatrix<f64>) -> Self {
        Influence { parts: self.parts, on: map * self.on }
    }

    /// Of one number as one of AF, SF, YM, the other two feeling nothing.
    pub fn on_channel(self, channel: usize) -> Self {
        let mut on = DMatrix::zeros(3, self.on.ncols());
        on.row_mut(channel).copy_from(&self.on.row(0));
        Influence { parts: self.parts, on }
    }

    /// On one number of each of many, one below the other.
    pub fn stacked<'a>(of: impl Iterator<Item = &'a Influence> + Clone, number: usize) -> Self {
        let mut parts: Vec<usize> = of.clone().flat_map(|one| one.parts.iter().copied()).collect();
        parts.sort_unstable();
        parts.dedup();
        let mut on = DMatrix::zeros(of.clone().count(), parts.len());
        for (row, one) in of.enumerate() {
            for (column, part) in one.parts.iter().enumerate() {
                let place = parts.partition_point(|known| known < part);
                on[(row, place)] = one.on[(number, column)];
            }
        }
        Influence { parts, on }
    }

    /// On some of the numbers, and of the parts those that these feel.
    pub fn of_rows(&self, rows: &[usize]) -> Self {
        let on = self.on.select_rows(rows);
        let felt: Vec<usize> = (0..on.ncols()).filter(|j| on.column(*j).iter().any(|value| *value != 0.0)).collect();
        Influence { parts: felt.iter().map(|j| self.parts[*j]).collect(), on: on.select_columns(&felt) }
    }

    /// Covariance that it makes between a number and another that feels the same kind of error, each given as a weighted
    /// sum of the numbers here.
    pub fn covariance(&self, weights: &DVector<f64>, other: &Influence, other_weights: &DVector<f64>) -> f64 {
        let (one, two) = (self.on.tr_mul(weights), other.on.tr_mul(other_weights));
        let place = |part: &usize| other.parts.binary_search(part).ok();
        self.parts.iter().zip(one.iter()).filter_map(|(part, value)| Some(value * two[place(part)?])).sum()
    }
}

/// A matrix whose product with its own transpose is this covariance.
pub fn root(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = covariance.clone().symmetric_eigen();
    let roots = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
    eigen.eigenvectors * DMatrix::from_diagonal(&roots)
}
