//! A fit of the baseline with some mechanisms, and its noise: Gauss-Newton steps, residuals, held-out residuals. Does not decide which
//! mechanism is named.

use nalgebra::{DMatrix, DVector};

use super::covariance::side_by_side;
use super::evidence::{Candidate, Evidence, Point, Problem, Quantity};
use super::holdout::{self, least_squares};
use super::noise_of_fit::{with_all_aside, with_none_worth_its_cost};
use super::score::{whiten, whiten_with_prior};
use crate::noise::{Lasting, Noise};

/// Times that a quicker problem's steps come first.
const MAX_QUICK_ROUNDS: usize = 4;

/// Fall of the weighted sum of squares that ends a fit.
pub(super) const LEAST_FALL: f64 = 1e-3;

/// Largest number of alternations of fit and noise estimate.
pub(super) const MAX_NOISE_ROUNDS: usize = 4;

/// A fit of the baseline and the included candidates.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    pub(super) point: Point,
    pub(super) included: Vec<usize>,
    pub(super) evidence: Evidence,
    pub(super) noises: Vec<Noise>,
    /// Which slow processes these may have.
    pub(super) lasting: Lasting,
}

impl Fitted {
    pub(super) fn new(problem: &impl Problem, point: Point, included: Vec<usize>) -> Self {
        let evidence = believing(problem, problem.evidence(&point), &point, &included);
        let noises = with_all_aside(problem, &evidence, &included);
        Fitted { point, included, evidence, noises, lasting: problem.lasting() }
    }

    /// The fit of these candidates that begins at this point.
    pub(super) fn converged(problem: &impl Problem, point: Point, included: Vec<usize>) -> Self {
        let mut fitted = Fitted::new(problem, point, included);
        fitted.converge(problem);
        fitted
    }

    /// The fit and its noise, each with the other as it is, until the sum of squares no longer falls.
    pub(super) fn converge(&mut self, problem: &impl Problem) {
        let mut quicker = None;
        for _ in 0..MAX_NOISE_ROUNDS {
            let moved = self.descend_about(problem, &mut quicker);
            self.noises = with_all_aside(problem, &self.evidence, &self.included);
            if moved < 1e-2 {
                break;
            }
        }
        let better_known = with_none_worth_its_cost(problem, &self.evidence, &self.included, &self.noises);
        if better_known != self.noises {
            self.noises = better_known;
            self.descend_about(problem, &mut quicker);
        }
    }

    /// Gauss and Newton's steps, until the weighted sum of squares no longer falls; returns by how much it fell.
    pub(super) fn descend(&mut self, problem: &impl Problem) -> f64 {
        self.descend_about(problem, &mut None)
    }

    /// The same. Where there is a quicker problem about a point, its steps come first, and what it holds fixed is computed again after
    /// them, so that the minimum is that of the problem itself. `quicker` is the one about this point, if known, before and after.
    fn descend_about<P: Problem>(&mut self, problem: &P, quicker: &mut Option<P>) -> f64 {
        let mut fallen = 0.0;
        for _ in 0..MAX_QUICK_ROUNDS {
            *quicker = quicker.take().or_else(|| problem.for_first_search(&self.point));
            let Some(about_here) = quicker else { break };
            let mut trial = self.clone();
            if trial.take_steps(about_here) < LEAST_FALL {
                break;
            }
            // At the point about which it was made a quicker problem equals the problem itself.
            let Some(about_there) = problem.for_first_search(&trial.point) else { break };
            trial.evidence = believing(problem, about_there.evidence(&trial.point), &trial.point, &trial.included);
            let fall =
                weighted_squares(&self.evidence, &self.noises) - weighted_squares(&trial.evidence, &trial.noises);
            // No fall: what was held fixed matters here.
            if fall < LEAST_FALL {
                break;
            }
            (*self, *quicker) = (trial, Some(about_there));
            fallen += fall;
        }
        let by_problem = self.step(problem);
        if by_problem > 0.0 {
            *quicker = None;
        }
        fallen + by_problem
    }

    /// Gauss and Newton's steps, and the evidence of all candidates where they end; returns by how much the weighted sum of squares fell.
    fn step(&mut self, problem: &impl Problem) -> f64 {
        let fallen = self.take_steps(problem);
        if fallen > 0.0 {
            self.evaluate_all(problem);
        }
        fallen
    }

    /// The evidence of all candidates at this point.
    pub(super) fn evaluate_all(&mut self, problem: &impl Problem) {
        self.evidence = believing(problem, problem.evidence(&self.point), &self.point, &self.included);
    }

    /// Whether every included parameter lies where physics allows it.
    pub(super) fn is_possible(&self, candidates: &[Candidate]) -> bool {
        self.included.iter().all(|member| {
            let values = self.point.candidates[*member].iter();
            values.zip(&candidates[*member].bounds).all(|(value, (low, high))| (low..=high).contains(&value))
        })
    }

    pub(super) fn columns(&self) -> DMatrix<f64> {
        let parts: Vec<&DMatrix<f64>> = std::iter::once(&self.evidence.baseline)
            .chain(self.included.iter().map(|member| &self.evidence.candidates[*member]))
            .collect();
        side_by_side(self.evidence.residual.len(), &parts)
    }

    /// Residuals as the baseline would leave them at this point: the included candidates' share put back.
    pub(super) fn without_candidates(&self, candidates: &[Candidate]) -> DVector<f64> {
        let mut residual = self.evidence.residual.clone();
        for member in &self.included {
            let (values, neutral) = (&self.point.candidates[*member], &candidates[*member].neutral);
            let offset = DVector::from_iterator(values.len(), values.iter().zip(neutral).map(|(v, n)| v - n));
            residual += &self.evidence.candidates[*member] * offset;
        }
        residual
    }

    /// Standard deviation of the noise of each row, as far as it shows within the record.
    pub(super) fn sd(&self) -> Vec<f64> {
        let mut sd = vec![0.0; self.evidence.residual.len()];
        for (i, (quantity, noise)) in self.evidence.quantities.iter().zip(&self.noises).enumerate() {
            let noise = self.within_record(noise, i);
            quantity.rows.clone().for_each(|row| sd[row] = noise.sd(self.evidence.stated_sd[row]));
        }
        sd
    }

    /// The size above which a misfit of each quantity is worth acting on.
    pub(super) fn limits(&self, problem: &impl Problem) -> Vec<f64> {
        let quantities = self.evidence.quantities.iter().enumerate();
        quantities.map(|(i, quantity)| problem.relevance(quantity, self.expected_rms(&self.noises, i))).collect()
    }

    /// Root mean square of the noise of one quantity, as far as it shows within the record.
    pub(super) fn expected_rms(&self, noises: &[Noise], quantity: usize) -> f64 {
        let noise = self.within_record(&noises[quantity], quantity);
        let rows = self.evidence.quantities[quantity].rows.clone();
        let n = rows.len().max(1) as f64;
        (rows.map(|row| noise.sd(self.evidence.stated_sd[row]).powi(2)).sum::<f64>() / n).sqrt()
    }

    /// A noise whose slow parts are no larger than what this fit leaves beside the white one. A process that outlasts the record has
    /// most of its variance in a mean and a trend, which the fit takes and no misfit is compared with.
    fn within_record(&self, noise: &Noise, quantity: usize) -> Noise {
        let rows = self.evidence.quantities[quantity].rows.clone();
        let n = rows.len();
        let reaches = |column: &DMatrix<f64>| {
            column.column_iter().filter(|column| column.rows(rows.start, n).amax() > 0.0).count()
        };
        let included = self.included.iter().map(|member| reaches(&self.evidence.candidates[*member]));
        let free = n.saturating_sub(reaches(&self.evidence.baseline) + included.sum::<usize>()).max(1);
        let left = self.evidence.residual.rows(rows.start, n).norm_squared() / free as f64;
        let stated = self.evidence.stated_sd[rows].iter().map(|sd| sd * sd).sum::<f64>() / n.max(1) as f64;
        let slow: f64 = noise.slow.iter().map(|slow| slow.variance).sum();
        let most = (left - noise.white * stated).max(0.0);
        let mut within = *noise;
        if slow > most {
            within.slow.iter_mut().for_each(|part| part.variance *= most / slow);
        }
        within
    }

    /// Returns the negative log-likelihood of held-out data, up to a constant.
    pub(super) fn held_out_misfit(&self) -> f64 {
        let left = self.held_out();
        let of = |quantity: &Quantity| quantity.rows.len() as f64 * holdout::rms(&left, quantity.rows.clone()).ln();
        self.evidence.quantities.iter().map(of).sum()
    }

    /// What is left of each row when its block was held out.
    pub(super) fn held_out(&self) -> DVector<f64> {
        holdout::residuals(&self.evidence, &self.noises, &self.columns(), &self.evidence.residual)
    }
}

/// The evidence with what is believed of the included candidates beside what is believed of the baseline.
pub(super) fn believing(problem: &impl Problem, mut evidence: Evidence, point: &Point, included: &[usize]) -> Evidence {
    for member in included {
        let candidate = &problem.candidates()[*member];
        let values = point.candidates[*member].iter().zip(&candidate.neutral);
        let prior = candidate.prior_at(&point.candidates[*member]);
        for ((value, neutral), (believed, sd)) in values.zip(prior) {
            evidence.prior.push((neutral + believed - value, sd));
        }
    }
    evidence
}

pub(super) fn solve(
    evidence: &Evidence,
    noises: &[Noise],
    columns: &DMatrix<f64>,
    target: &DVector<f64>,
) -> DVector<f64> {
    least_squares(&with_target(evidence, noises, columns, target))
}

/// Whitened columns with the target behind them, and what is believed below.
pub(super) fn with_target(
    evidence: &Evidence,
    noises: &[Noise],
    columns: &DMatrix<f64>,
    target: &DVector<f64>,
) -> DMatrix<f64> {
    let k = columns.ncols();
    let mut all = DMatrix::zeros(target.len(), k + 1);
    all.columns_mut(0, k).copy_from(columns);
    all.column_mut(k).copy_from(target);
    whiten_with_prior(evidence, noises, &all, k)
}

pub(super) fn weighted_squares(evidence: &Evidence, noises: &[Noise]) -> f64 {
    weighted(evidence, noises, &evidence.residual)
}

pub(super) fn weighted(evidence: &Evidence, noises: &[Noise], values: &DVector<f64>) -> f64 {
    let mut column = DMatrix::from_column_slice(values.len(), 1, values.as_slice());
    whiten(evidence, noises, &mut column);
    column.norm_squared() + belief_squares(evidence)
}

/// Minus twice the logarithm of the likelihood under these noises, with what is believed, up to a constant.
pub(super) fn deviance(evidence: &Evidence, noises: &[Noise]) -> f64 {
    let mut column = DMatrix::from_column_slice(evidence.residual.len(), 1, evidence.residual.as_slice());
    let log_determinant = whiten(evidence, noises, &mut column);
    log_determinant + column.norm_squared() + belief_squares(evidence)
}

/// Squares of how far the parameters are from what is believed, in units of its standard deviations.
pub(super) fn belief_squares(evidence: &Evidence) -> f64 {
    evidence.prior.iter().map(|(belief, sd)| (belief / sd).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::super::tests::Toy;
    use super::*;
    use crate::noise::Slow;

    /// The likelihood of a process that outlasts the record hardly depends on its variance, which may come out as anything.
    #[test]
    fn a_noise_that_outlasts_the_record_counts_as_far_as_it_shows() {
        let toy = Toy::new(3, |_, _| 0.0);
        let mut fitted = Fitted::new(&toy, Point { baseline: vec![3.0], ..toy.start() }, Vec::new());
        let before = fitted.expected_rms(&fitted.noises, 0);
        fitted.noises[0].slow[0] = Slow { variance: 1e4, correlation_time_s: 1e8 };
        let left = holdout::rms(&fitted.evidence.residual, 0..fitted.evidence.residual.len());
        let shown = fitted.expected_rms(&fitted.noises, 0);
        assert!((shown / left - 1.0).abs() < 0.01 && (shown / before - 1.0).abs() < 0.3, "{shown} {left} {before}");
        assert!((holdout::rms(&DVector::from_vec(fitted.sd()), 0..fitted.sd().len()) - shown).abs() < 1e-9);
    }
}
