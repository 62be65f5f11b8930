//! How much of the force of the log's own shear its readings show: what is left is regressed on what that force does, beside all that
//! was fitted. Newton's law asks for all of it. Knows the finished diagnosis; changes nothing in it.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector};

use super::SeaProblem;
use crate::diagnose::estimate::Estimate;
use crate::diagnose::evidence::{Evidence, Problem};
use crate::diagnose::noise::{Noise, WHITE};
use crate::diagnose::{Outcome, holdout};

/// Returns that share, 1 where the readings show all of the force, with its error by the scatter between legs (jackknife); none where the log
/// has no current, or legs that do not tell of its effect.
pub(super) fn share(problem: &SeaProblem, outcome: &Outcome) -> Option<Estimate> {
    if !problem.knows_shear() {
        return None;
    }
    let point = &outcome.after.point;
    let mut evidence = problem.evidence_of(point, &outcome.fitted);
    let without = problem.with_share_of_shear(0.0).evidence_of(point, &[]).residual;
    let effect = without - &evidence.residual;
    // The noise of each row as it was found; rows of one leg err together, of which the jackknife knows.
    evidence.stated_sd.clone_from(&outcome.after.sd);
    let columns = beside(&evidence, &outcome.fitted, effect);
    let place = evidence.baseline.ncols();
    let noises = vec![WHITE; evidence.quantities.len()];
    let beyond_all = |keep: &dyn Fn(usize) -> bool| missing(&evidence, &noises, &columns, place, keep);
    let all = beyond_all(&|_| true)?;
    let legs: BTreeSet<usize> = evidence.block.iter().copied().collect();
    let without_one = |leg: &usize| beyond_all(&|row| evidence.block[row] != *leg);
    let each: Vec<f64> = legs.iter().map(without_one).collect::<Option<_>>()?;
    let n = each.len() as f64;
    let mean = each.iter().sum::<f64>() / n;
    let square_se = (n - 1.0) / n * each.iter().map(|one| (one - mean).powi(2)).sum::<f64>();
    (square_se > 0.0).then(|| Estimate::student(1.0 + all, square_se.sqrt(), n - 1.0, "1"))
}

/// The columns of the baseline, that of the effect, and those of what was fitted.
fn beside(evidence: &Evidence, fitted: &[usize], effect: DVector<f64>) -> DMatrix<f64> {
    let baseline = evidence.baseline.column_iter().map(|column| column.into_owned());
    let of_fitted = fitted.iter().flat_map(|member| evidence.candidates[*member].column_iter());
    let columns: Vec<_> = baseline.chain([effect]).chain(of_fitted.map(|column| column.into_owned())).collect();
    DMatrix::from_columns(&columns)
}

/// What these rows ask for beyond all of the effect, in units of it; none where they do not show it.
fn missing(
    evidence: &Evidence,
    noises: &[Noise],
    columns: &DMatrix<f64>,
    place: usize,
    keep: &dyn Fn(usize) -> bool,
) -> Option<f64> {
    let (solution, _) = holdout::on_part(evidence, noises, columns, keep)?;
    Some(solution[place]).filter(|share| share.is_finite())
}

impl SeaProblem {
    /// The same problem in water whose own current has this share of its shear.
    fn with_share_of_shear(&self, share: f64) -> SeaProblem {
        SeaProblem { past: self.past.with_share_of_shear(share), ..self.clone() }
    }
}
