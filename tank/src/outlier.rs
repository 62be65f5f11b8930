//! Runs that lie wildly off the fit of their sweep, as one whose forces are in other units does. They stay in the fit: what
//! is wrong with them is for the crew to say. Must not know how the points came about.

use nalgebra::{DMatrix, DVector};

use crate::angle_regression::Basis;
use crate::sweep::{NAMES, Sweep};

/// A point is reported that departs by more standard errors from the fit to the others: models that are merely too simple, and
/// runs at low speed, come to ten.
const DEPARTURES: f64 = 30.0;
/// So many others say at least where a point should lie \[degrees of freedom\].
const FEWEST: usize = 4;
/// At most so many are reported of one coefficient.
const MOST: usize = 3;

/// A point far off the fit to the others.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlier {
    /// The run.
    pub run_id: String,
    /// CL, CD or CM.
    pub coefficient: &'static str,
    /// Its value there.
    pub value: f64,
    /// What the others lead to expect.
    pub expected: f64,
}

/// The points that lie so, in the fits of CL, CD and CM on these functions of the angle.
pub fn find(sweep: &Sweep, rows: &[usize], model: &[Basis; 3]) -> Vec<Outlier> {
    let mut found = Vec::new();
    for (coefficient, basis) in model.iter().enumerate() {
        let mut rows = rows.to_vec();
        for _ in 0..MOST {
            let Some((place, expected)) = furthest(sweep, &rows, coefficient, basis) else { break };
            let point = &sweep.points[rows.remove(place)];
            found.push(Outlier {
                run_id: point.run_id.clone(),
                coefficient: NAMES[coefficient],
                value: point.coefficients[coefficient],
                expected,
            });
        }
    }
    found
}

/// The point furthest off the fit to the others, where that is too far: its place among the rows, and what the others lead
/// to expect there (externally studentized residuals; Cook and Weisberg 1982, Residuals and Influence in Regression, 2.2).
fn furthest(sweep: &Sweep, rows: &[usize], coefficient: usize, basis: Basis) -> Option<(usize, f64)> {
    let dof = rows.len().checked_sub(basis.len() + 1).filter(|dof| *dof >= FEWEST)?;
    let alpha_rad: Vec<f64> = rows.iter().map(|i| sweep.points[*i].alpha_rad()).collect();
    let design = DMatrix::from_fn(rows.len(), basis.len(), |i, j| basis[j](alpha_rad[i]));
    let observed = DVector::from_iterator(rows.len(), rows.iter().map(|i| sweep.points[*i].coefficients[coefficient]));
    let inverse = design.tr_mul(&design).try_inverse()?;
    let residuals = &observed - &design * (&inverse * design.tr_mul(&observed));
    // What each leaves in the sum of squares when it is taken out, and where it lies to the others' fit.
    let without = |i: usize| {
        let leverage = (design.row(i) * &inverse * design.row(i).transpose())[(0, 0)];
        let departure = residuals[i] / (1.0 - leverage).max(1e-9);
        ((residuals.norm_squared() - residuals[i] * departure).max(0.0), departure, leverage)
    };
    let best = (0..rows.len()).min_by(|i, j| without(*i).0.total_cmp(&without(*j).0))?;
    let (squares, departure, leverage) = without(best);
    let se = (squares / dof as f64 / (1.0 - leverage).max(1e-9)).sqrt();
    // Rounding leaves something of a large departure in the others' sum.
    let is_far = departure.abs() > DEPARTURES * se && departure.abs() > 1e-6;
    is_far.then(|| (best, observed[best] - departure))
}
