//! Least squares in bounded memory: residuals and Jacobian are never held, only their products.
//!
//! Every dive keeps `G = [J r]^T [J r]`, a small symmetric matrix, however many samples it has. The sum over the dives
//! says all that a Levenberg-Marquardt step needs: its Cholesky factor `R`, with `R^T R = G`, is a Jacobian and a
//! residual vector of `n + 1` rows with the same products. The dives' own matrices give the standard errors, with dives
//! as the independent unit.

use nalgebra::{DMatrix, DVector};

/// `[J r]^T [J r]` of one dive or of many, packed by rows of the upper triangle; the last column is that of `r`.
#[derive(Debug, Clone, PartialEq)]
pub struct Gram {
    /// Number of parameters.
    pub n: usize,
    packed: Vec<f64>,
    /// Number of residuals in it.
    pub rows: usize,
}

impl Gram {
    /// An empty one.
    pub fn new(n: usize) -> Self {
        Gram { n, packed: vec![0.0; (n + 1) * (n + 2) / 2], rows: 0 }
    }

    /// Empties it, to be filled again.
    pub fn clear(&mut self) {
        self.packed.fill(0.0);
        self.rows = 0;
    }

    /// Adds one residual with its slopes; `row` holds the slopes, then the residual.
    pub fn add_row(&mut self, row: &[f64]) {
        let width = self.n + 1;
        assert_eq!(row.len(), width);
        let mut rest = &mut self.packed[..];
        for i in 0..width {
            let (line, after) = rest.split_at_mut(width - i);
            let factor = row[i];
            for (sum, value) in line.iter_mut().zip(&row[i..]) {
                *sum += factor * value;
            }
            rest = after;
        }
        self.rows += 1;
    }

    /// Adds another one.
    pub fn add(&mut self, other: &Gram) {
        for (mine, theirs) in self.packed.iter_mut().zip(&other.packed) {
            *mine += theirs;
        }
        self.rows += other.rows;
    }

    /// The sum of several.
    pub fn sum<'a>(n: usize, grams: impl IntoIterator<Item = &'a Gram>) -> Gram {
        let mut sum = Gram::new(n);
        grams.into_iter().for_each(|gram| sum.add(gram));
        sum
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.min(j), i.max(j));
        // Rows above this one hold n + 1, n, n - 1 ... values.
        self.packed[i * (self.n + 1) - i * i.saturating_sub(1) / 2 + (j - i)]
    }

    /// `J^T J`.
    pub fn normal_matrix(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.n, self.n, |i, j| self.at(i, j))
    }

    /// `J^T r`.
    pub fn gradient(&self) -> DVector<f64> {
        DVector::from_fn(self.n, |i, _| self.at(i, self.n))
    }

    /// `r^T r`.
    pub fn sum_of_squares(&self) -> f64 {
        self.at(self.n, self.n)
    }

    /// `n + 1` rows with the same products: a Jacobian and a residual vector as good as the long ones.
    ///
    /// By the eigenvalues of the matrix scaled to a unit diagonal, so that parameters of any magnitude, and ones that
    /// the data do not see at all, do no harm.
    pub fn compressed(&self) -> (DMatrix<f64>, DVector<f64>) {
        let width = self.n + 1;
        let scale: Vec<f64> = (0..width).map(|i| self.at(i, i).sqrt()).map(|s| if s > 0.0 { s } else { 1.0 }).collect();
        let scaled = DMatrix::from_fn(width, width, |i, j| self.at(i, j) / (scale[i] * scale[j]));
        let eigen = scaled.symmetric_eigen();
        let factor = DMatrix::from_fn(width, width, |k, j| {
            eigen.eigenvalues[k].max(0.0).sqrt() * eigen.eigenvectors[(j, k)] * scale[j]
        });
        (factor.columns(0, self.n).into_owned(), factor.column(self.n).into_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_compressed_rows_have_the_products_of_the_long_ones() {
        let mut gram = Gram::new(3);
        let mut rows = Vec::new();
        for i in 0..50 {
            let x = f64::from(i) * 0.1;
            let row = [x.sin() * 1e-6, x.cos() * 1e3, x, x * x - 1.0];
            gram.add_row(&row);
            rows.push(row);
        }
        let long = DMatrix::from_fn(50, 3, |i, j| rows[i][j]);
        let residual = DVector::from_fn(50, |i, _| rows[i][3]);
        let (short, compressed) = gram.compressed();
        let (a, b) = (long.transpose() * &long, short.transpose() * &short);
        let (g, h) = (long.transpose() * &residual, short.transpose() * &compressed);
        for i in 0..3 {
            assert!((g[i] - h[i]).abs() < 1e-10 * g.norm(), "{g} {h}");
            assert!((gram.gradient()[i] - g[i]).abs() < 1e-12 * g.norm());
            for j in 0..3 {
                assert!((a[(i, j)] - b[(i, j)]).abs() < 1e-10 * (a[(i, i)] * a[(j, j)]).sqrt(), "{a} {b}");
                assert!((a[(i, j)] - gram.normal_matrix()[(i, j)]).abs() < 1e-12 * a[(i, j)].abs());
            }
        }
        assert!((compressed.norm_squared() - residual.norm_squared()).abs() < 1e-9);
        assert!((gram.sum_of_squares() - residual.norm_squared()).abs() < 1e-9);
    }
}
