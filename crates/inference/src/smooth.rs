//! Flexible curves in a covariate: what an unknown effect could look like.
//!
//! A natural cubic spline with knots at quantiles, a piecewise linear curve between more levels where thin layers matter, or a short
//! Fourier series where the covariate is an angle. A spline is centred: its level belongs to the model. A wave is not: what goes as the
//! sine of a heading has its zero where the sine has it, whatever headings happened to be steered. Where the model has no level of its own
//! a level is a curve as well.

use nalgebra::DMatrix;

/// Bends of a spline.
const KNOTS: usize = 6;

/// Levels of the finer curve, with a fifteenth of the values between two: what is thinner than an eighth of a water column is over before a
/// glider follows.
const LEVELS: usize = 16;

/// Fewest rows to a level.
const ROWS_OF_A_LEVEL: usize = 8;

/// Harmonics of an angle.
const HARMONICS: usize = 2;

/// How a covariate runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Along a line.
    Line,
    /// Along a line, as finely as layers of water are.
    Layers,
    /// Round a circle, in radians.
    Angle,
    /// Not at all: one level wherever it is a number.
    Level,
}

/// The columns of the curve, of unit mean square; fewer where the covariate takes few values, none where
/// it does not vary. Rows where the covariate is not a number take no part: zero.
pub fn basis(kind: Kind, values: &[f64]) -> DMatrix<f64> {
    let columns = match kind {
        Kind::Angle => (1..=HARMONICS)
            .flat_map(|k| {
                let multiple = k as f64;
                [
                    values.iter().map(|v| (multiple * v).sin()).collect::<Vec<_>>(),
                    values.iter().map(|v| (multiple * v).cos()).collect(),
                ]
            })
            .collect(),
        Kind::Line => spline(values),
        Kind::Layers => layers(values),
        Kind::Level => {
            return DMatrix::from_fn(values.len(), 1, |row, _| if values[row].is_finite() { 1.0 } else { 0.0 });
        }
    };
    let meaningful = |mut column: Vec<f64>| {
        column.iter_mut().zip(values).filter(|(_, v)| !v.is_finite()).for_each(|(entry, _)| *entry = f64::NAN);
        column
    };
    let kept: Vec<Vec<f64>> = columns
        .into_iter()
        .filter_map(|column: Vec<f64>| standardised(meaningful(column), kind != Kind::Angle))
        .collect();
    DMatrix::from_fn(values.len(), kept.len(), |row, column| kept[column][row])
}

/// Natural cubic spline by truncated powers (Hastie, Tibshirani, Friedman 2009, eq. 5.4), on the unit interval.
fn spline(values: &[f64]) -> Vec<Vec<f64>> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(low), Some(high)) = (sorted.first().copied(), sorted.last().copied()) else {
        return Vec::new();
    };
    if high <= low {
        return Vec::new();
    }
    let unit = |v: f64| (v - low) / (high - low);
    let mut knots: Vec<f64> =
        (0..KNOTS).map(|i| unit(sorted[(sorted.len() - 1) * (2 * i + 1) / (2 * KNOTS)])).collect();
    knots.dedup_by(|a, b| *a - *b < 1e-3);
    let mut columns = vec![values.iter().map(|v| unit(*v)).collect::<Vec<_>>()];
    if knots.len() < 3 {
        return columns;
    }
    let last = knots[knots.len() - 1];
    let cube = |x: f64| x.max(0.0).powi(3);
    let d = |x: f64, knot: f64| (cube(x - knot) - cube(x - last)) / (last - knot);
    let before_last = knots[knots.len() - 2];
    for knot in &knots[..knots.len() - 2] {
        columns.push(values.iter().map(|v| d(unit(*v), *knot) - d(unit(*v), before_last)).collect());
    }
    columns
}

/// Piecewise linear, between levels with as many values between each two; nothing where the rows are too few for them.
fn layers(values: &[f64]) -> Vec<Vec<f64>> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    if sorted.len() < ROWS_OF_A_LEVEL * LEVELS {
        return Vec::new();
    }
    let mut levels: Vec<f64> = (0..LEVELS).map(|i| sorted[(sorted.len() - 1) * i / (LEVELS - 1)]).collect();
    levels.dedup_by(|a, b| *a - *b <= 0.0);
    // The last level is the rest: a curve has no mean.
    (0..levels.len().saturating_sub(1))
        .map(|i| {
            let rising = |v: f64| if i == 0 { 1.0 } else { (v - levels[i - 1]) / (levels[i] - levels[i - 1]) };
            let falling = |v: f64| (levels[i + 1] - v) / (levels[i + 1] - levels[i]);
            values.iter().map(|v| rising(*v).min(falling(*v)).clamp(0.0, 1.0)).collect()
        })
        .collect()
}

fn standardised(mut column: Vec<f64>, centred: bool) -> Option<Vec<f64>> {
    let present = || column.iter().copied().filter(|v| v.is_finite());
    let n = present().count() as f64;
    let mean = present().sum::<f64>() / n;
    let spread = (present().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
    if spread.is_nan() || spread <= 1e-12 {
        return None;
    }
    let level = if centred { mean } else { 0.0 };
    column.iter_mut().for_each(|v| *v = if v.is_finite() { *v - level } else { 0.0 });
    let size = (column.iter().map(|v| v * v).sum::<f64>() / n).sqrt();
    column.iter_mut().for_each(|v| *v /= size);
    Some(column)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    fn left_over(kind: Kind, f: impl Fn(f64) -> f64, values: &[f64]) -> f64 {
        let columns = basis(kind, values);
        let y = DVector::from_iterator(values.len(), values.iter().map(|v| f(*v)));
        let y = if kind == Kind::Angle { y } else { y.add_scalar(-y.mean()) };
        let solution = columns.clone().svd(true, true).solve(&y, 1e-10).unwrap();
        (&y - columns * solution).norm() / y.norm()
    }

    #[test]
    fn lines_bends_and_waves_are_followed() {
        let values: Vec<f64> = (0..500).map(|i| 3.0 + i as f64 * 0.01).collect();
        assert!(left_over(Kind::Line, |v| 2.0 * v, &values) < 1e-9);
        assert!(left_over(Kind::Line, |v| (v - 5.0).powi(2), &values) < 0.06);
        assert!(left_over(Kind::Line, |v| (v * 1.3).sin(), &values) < 0.1);
        assert!(left_over(Kind::Angle, |v| (v + 0.7).sin(), &values) < 1e-9);
        assert!(left_over(Kind::Line, |v| (v * 40.0).sin(), &values) > 0.9, "but not noise");
    }

    /// A tenth of the column moves. A spline of six knots runs through it.
    #[test]
    fn a_layer_is_followed_between_levels_alone() {
        let values: Vec<f64> = (0..500).map(|i| 3.0 + i as f64 * 0.01).collect();
        let layer = |v: f64| f64::from((v - 4.5).abs() < 0.25);
        assert!(left_over(Kind::Line, layer, &values) > 0.7);
        assert!(left_over(Kind::Layers, layer, &values) < 0.5);
        assert!(left_over(Kind::Layers, |v| 2.0 * v, &values) < 1e-9);
    }

    #[test]
    fn what_does_not_vary_has_no_curve() {
        assert_eq!(basis(Kind::Layers, &[2.0; 10]).ncols(), 0);
        assert_eq!(basis(Kind::Line, &[2.0; 10]).ncols(), 0);
        assert_eq!(basis(Kind::Line, &[0.0, 1.0, 0.0, 1.0]).ncols(), 1);
    }

    #[test]
    fn where_a_covariate_means_nothing_its_curve_is_zero() {
        let values = [1.0, f64::NAN, 2.0, 3.0, f64::NAN, 5.0];
        let columns = basis(Kind::Line, &values);
        assert!(columns.ncols() >= 1 && columns.iter().all(|v| v.is_finite()));
        assert!(columns.row(1).iter().chain(columns.row(4).iter()).all(|v| *v == 0.0));
    }
}
