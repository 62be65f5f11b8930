//! What is left without a cause, as an extension all the same: of some sets of columns the one that best predicts held-out data.

use nalgebra::{DMatrix, DVector};

use super::covariance::side_by_side;
use super::evidence::{Point, Problem};
use super::fitted::{Fitted, solve};
use super::holdout;
use super::outcome::Stage;

/// Columns that are offered, and what is believed of the step of each with its standard deviation.
pub type Offered = (DMatrix<f64>, Vec<(f64, f64)>);

/// The set of columns that predicts best.
#[derive(Debug, Clone)]
pub struct Unnamed {
    /// Its place among those that were offered.
    pub place: usize,
    /// By how many standard errors it predicts better.
    pub advantage: f64,
    /// Steps of its columns.
    pub step: DVector<f64>,
    /// What is left of held-out data without it and with it.
    pub held_out: [DVector<f64>; 2],
}

/// Of these sets of columns the one that predicts held-out data best beside this fit. Those whose steps physics forbids take no
/// part; `is_possible` is given the place of a set and its steps.
pub fn best_unnamed(
    problem: &impl Problem,
    point: &Point,
    fitted: &[usize],
    offered: &[Offered],
    is_possible: impl Fn(usize, &DVector<f64>) -> bool,
) -> Option<Unnamed> {
    let fit = Fitted::new(problem, point.clone(), fitted.to_vec());
    let before = fit.held_out();
    let known = fit.columns();
    let with = |(place, (columns, prior)): (usize, &Offered)| {
        let mut evidence = fit.evidence.clone();
        evidence.prior.extend(prior);
        let all = side_by_side(known.nrows(), &[&known, columns]);
        let after = holdout::residuals(&evidence, &fit.noises, &all, &evidence.residual);
        let advantage = holdout::advantage(&evidence, &fit.noises, &before, &after);
        let step = solve(&evidence, &fit.noises, &all, &evidence.residual);
        let step = step.rows(known.ncols(), columns.ncols()).into_owned();
        Unnamed { place, advantage, step, held_out: [before.clone(), after] }
    };
    let tried = offered.iter().enumerate().map(with).filter(|tried| is_possible(tried.place, &tried.step));
    tried.max_by(|a, b| a.advantage.total_cmp(&b.advantage))
}

/// These candidates fitted again in full from a point, with what is left of held-out data taken from elsewhere.
pub fn fitted_again(problem: &impl Problem, point: &Point, fitted: &[usize], held_out: DVector<f64>) -> Stage {
    Fitted::converged(problem, point.clone(), fitted.to_vec()).stage(held_out)
}
