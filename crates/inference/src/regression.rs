//! Weighted least squares with validated intervals: scatter judged by the residuals, Student's quantiles for few points,
//! and errors that many observations share (a tare, a zero) carried to the result instead of being averaged away.
//!
//! Knows numbers only.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

use super::covariance::inverse_if_independent;
use super::estimate::Estimate;

/// What is observed: one row of `design` and one value per observation.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Observations by parameters.
    pub design: DMatrix<f64>,
    /// What was observed.
    pub observed: DVector<f64>,
    /// Variance of each observation from within its own run; zero where it is unknown.
    pub variance: DVector<f64>,
    /// Errors that observations share.
    pub shared: Vec<Shared>,
}

/// Independent errors of one standard error each that several observations share: `observed += influence * error`.
#[derive(Debug, Clone)]
pub struct Shared {
    /// Observations by errors.
    pub influence: DMatrix<f64>,
    /// Degrees of freedom with which their size is known; infinite where it is given.
    pub dof: f64,
}

/// How the scatter between observations is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scatter {
    /// The same for all, from the residuals alone.
    Equal,
    /// The variances given, plus one between runs that the residuals ask for (Paule and Mandel 1982).
    BetweenRuns,
    /// The variances given, all scaled by one factor that the residuals ask for.
    Scaled,
    /// The variances given as they are, known on so many degrees of freedom: for as many parameters as observations, whose
    /// residuals say nothing.
    Given {
        /// Degrees of freedom.
        dof: usize,
    },
}

/// Fewer degrees of freedom than this are no judge of a scatter that is smaller than the variances given.
const FEW_DOF: usize = 3;

/// The solution.
#[derive(Debug, Clone)]
pub struct Regression {
    /// Parameters.
    pub parameters: DVector<f64>,
    /// Covariance of the parameters, shared errors included.
    pub covariance: DMatrix<f64>,
    /// The part of the covariance that the observations' own scatter makes.
    pub own_covariance: DMatrix<f64>,
    /// Parameters by observations: `parameters = gain * observed`.
    pub gain: DMatrix<f64>,
    /// Observed less fitted.
    pub residuals: DVector<f64>,
    /// Weight of each observation: 1 over its variance.
    pub weights: DVector<f64>,
    /// Degrees of freedom of the scatter: observations less parameters where the residuals judge it.
    pub dof: usize,
    /// Degrees of freedom of each parameter's variance, by Welch and Satterthwaite.
    pub parameter_dof: Vec<f64>,
    /// Standard deviation between runs, beyond what the runs themselves show.
    pub between_runs: f64,
    /// Weighted sum of squared residuals over degrees of freedom.
    pub chi2_per_dof: f64,
}

impl Problem {
    /// Observations that share no error; for [`Scatter::Equal`], since nothing is known of the variance of each.
    pub fn plain(design: DMatrix<f64>, observed: DVector<f64>) -> Self {
        let variance = DVector::zeros(observed.len());
        Problem { design, observed, variance, shared: Vec::new() }
    }

    /// Solves it; none if there are no degrees of freedom left or the parameters cannot be distinguished.
    pub fn solve(&self, scatter: Scatter) -> Option<Regression> {
        let (n, p) = self.design.shape();
        let given = if let Scatter::Given { dof } = scatter { Some(dof) } else { None };
        if n < p || n == p && given.is_none() {
            return None;
        }
        let dof = given.unwrap_or(n - p);
        let weights_for = |between: f64| match scatter {
            Scatter::Equal => DVector::from_element(n, 1.0),
            _ => self.variance.map(|v| 1.0 / (v + between * between)),
        };
        let between_runs = match scatter {
            Scatter::BetweenRuns => self.between_runs(&weights_for, dof)?,
            _ => 0.0,
        };
        let weights = weights_for(between_runs);
        let (gain, normal_inverse) = self.gain(&weights)?;
        let parameters = &gain * &self.observed;
        let residuals = &self.observed - &self.design * &parameters;
        let chi2: f64 = residuals.iter().zip(weights.iter()).map(|(r, w)| w * r * r).sum();
        let chi2_per_dof = if given.is_none() { chi2 / dof as f64 } else { 1.0 };
        // One or two residuals may be next to nothing by chance; what the runs themselves show is then the better judge.
        let is_by_chance = scatter == Scatter::BetweenRuns && dof < FEW_DOF && chi2_per_dof < 1.0;
        let chi2_per_dof = if is_by_chance { 1.0 } else { chi2_per_dof };
        let own_covariance = normal_inverse * chi2_per_dof;
        let mut covariance = own_covariance.clone();
        let mut by_source: Vec<(DMatrix<f64>, f64)> = vec![(own_covariance.clone(), dof as f64)];
        for shared in &self.shared {
            let influence = &gain * &shared.influence;
            let part = &influence * influence.transpose();
            covariance += &part;
            by_source.push((part, shared.dof));
        }
        let parameter_dof = (0..p)
            .map(|i| {
                let total = covariance[(i, i)];
                let sum: f64 = by_source.iter().map(|(part, dof)| part[(i, i)] * part[(i, i)] / dof).sum();
                if sum > 0.0 { total * total / sum } else { dof as f64 }
            })
            .collect();
        Some(Regression {
            parameters,
            covariance,
            own_covariance,
            gain,
            residuals,
            weights,
            dof,
            parameter_dof,
            between_runs,
            chi2_per_dof,
        })
    }

    fn gain(&self, weights: &DVector<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let mut weighted = self.design.clone();
        for (i, mut row) in weighted.row_iter_mut().enumerate() {
            row *= weights[i];
        }
        let normal = self.design.transpose() * &weighted;
        let inverse = inverse_if_independent(&normal)?;
        Some((&inverse * weighted.transpose(), inverse))
    }

    /// The standard deviation between runs with which the weighted squares of the residuals are as many as the degrees
    /// of freedom; zero if the runs' own variances explain the residuals already.
    fn between_runs(&self, weights_for: &dyn Fn(f64) -> DVector<f64>, dof: usize) -> Option<f64> {
        let excess = |between: f64| {
            let weights = weights_for(between);
            let (gain, _) = self.gain(&weights)?;
            let residuals = &self.observed - &self.design * (gain * &self.observed);
            let chi2: f64 = residuals.iter().zip(weights.iter()).map(|(r, w)| w * r * r).sum();
            Some(chi2 - dof as f64)
        };
        let smallest = self.variance.iter().copied().fold(f64::INFINITY, f64::min);
        if smallest > 0.0 && excess(0.0)? <= 0.0 {
            return Some(0.0);
        }
        let spread = self.observed.iter().map(|y| y * y).sum::<f64>().sqrt();
        let (mut low, mut high) = (0.0, spread.max(f64::MIN_POSITIVE));
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if excess(middle)? > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(high)
    }
}

impl Regression {
    /// A parameter with its 95 % interval.
    pub fn estimate(&self, index: usize, unit: &str) -> Estimate {
        let se = self.covariance[(index, index)].max(0.0).sqrt();
        Estimate::student(self.parameters[index], se, self.parameter_dof[index], unit)
    }

    /// Root of the mean square residual.
    pub fn rms(&self) -> f64 {
        (self.residuals.norm_squared() / self.residuals.len() as f64).sqrt()
    }

    /// Root of the mean square error with which each observation is predicted by a fit to all others, in closed form:
    /// `r_i / (1 - h_i)` with the leverage `h_i`. None where an observation alone decides a parameter.
    pub fn left_out_rms(&self, design: &DMatrix<f64>) -> Option<f64> {
        let n = design.nrows();
        let mut sum = 0.0;
        for i in 0..n {
            let leverage = (design.row(i) * self.gain.column(i))[(0, 0)];
            if leverage > 1.0 - 1e-9 {
                return None;
            }
            sum += (self.residuals[i] / (1.0 - leverage)).powi(2);
        }
        Some((sum / n as f64).sqrt())
    }

    /// Covariance for residuals that belong together within clusters: the sandwich of Liang and Zeger (1986) with the
    /// factor `G / (G - 1) (n - 1) / (n - p)` for few clusters.
    pub fn cluster_covariance(&self, clusters: &[u32]) -> DMatrix<f64> {
        let (p, n) = self.gain.shape();
        let mut moves: BTreeMap<u32, DVector<f64>> = BTreeMap::new();
        for (i, cluster) in clusters.iter().enumerate() {
            *moves.entry(*cluster).or_insert_with(|| DVector::zeros(p)) += self.gain.column(i) * self.residuals[i];
        }
        let g = moves.len() as f64;
        let few = g / (g - 1.0) * (n as f64 - 1.0) / (n - p) as f64;
        moves.values().fold(DMatrix::zeros(p, p), |sum, step| sum + step * step.transpose()) * few
    }
}

/// Two-sided probability of a value of Student's t at least this large.
pub fn student_p_value(t: f64, dof: f64) -> f64 {
    StudentsT::new(0.0, 1.0, dof.clamp(1.0, 1e5)).map_or(1.0, |d| 2.0 * d.sf(t.abs()))
}

/// Probability of a ratio of variances at least this large.
pub fn f_p_value(f: f64, dof1: f64, dof2: f64) -> f64 {
    if !f.is_finite() || f <= 0.0 {
        return if f > 0.0 { 0.0 } else { 1.0 };
    }
    FisherSnedecor::new(dof1, dof2).map_or(1.0, |d| d.sf(f))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(observed: &[f64]) -> Problem {
        let n = observed.len();
        let design = DMatrix::from_fn(n, 2, |i, j| if j == 0 { 1.0 } else { i as f64 });
        Problem {
            design,
            observed: DVector::from_column_slice(observed),
            variance: DVector::from_element(n, 1.0),
            shared: vec![],
        }
    }

    #[test]
    fn a_line_through_points_has_the_textbook_standard_errors() {
        // x = 0..4, y = 1, 3, 2, 5, 4: slope 0.8, residual sum 3.6, s^2 = 1.2, var(slope) = 1.2/10.
        let fit = line(&[1.0, 3.0, 2.0, 5.0, 4.0]).solve(Scatter::Equal).unwrap();
        assert!((fit.parameters[1] - 0.8).abs() < 1e-12);
        assert!((fit.covariance[(1, 1)] - 0.12).abs() < 1e-12);
        let slope = fit.estimate(1, "1");
        // t(0.975, 3) = 3.18245.
        assert!((slope.ci95[1] - (0.8 + 3.18245 * 0.12f64.sqrt())).abs() < 1e-5);
    }

    #[test]
    fn a_shared_offset_is_not_averaged_away() {
        let mut problem = line(&[1.0, 3.0, 2.0, 5.0, 4.0]);
        let alone = problem.solve(Scatter::Equal).unwrap();
        problem.shared.push(Shared { influence: DMatrix::from_element(5, 1, 0.5), dof: f64::INFINITY });
        let fit = problem.solve(Scatter::Equal).unwrap();
        // The offset takes all of it, the slope nothing.
        assert!((fit.covariance[(0, 0)] - alone.covariance[(0, 0)] - 0.25).abs() < 1e-12);
        assert!((fit.covariance[(1, 1)] - alone.covariance[(1, 1)]).abs() < 1e-12);
        assert!(fit.parameter_dof[0] > 3.0 && (fit.parameter_dof[1] - 3.0).abs() < 1e-9);
    }

    #[test]
    fn scatter_beyond_the_runs_own_is_found() {
        let mut problem = line(&[1.0, 3.0, 2.0, 5.0, 4.0]);
        problem.variance.fill(0.2);
        let fit = problem.solve(Scatter::BetweenRuns).unwrap();
        // Equal weights: total variance 1.2, of which 0.2 is the runs' own.
        assert!((fit.between_runs - 1.0).abs() < 1e-9, "{}", fit.between_runs);
        problem.variance.fill(5.0);
        assert_eq!(problem.solve(Scatter::BetweenRuns).unwrap().between_runs, 0.0);
    }

    /// With every row its own cluster: the sandwich of White with the factor n / (n - p), in closed form for a line.
    #[test]
    fn errors_by_clusters_are_those_of_the_closed_form() {
        let (x, y) = ([1.0, 2.0, 3.0, 4.0, 5.0], [1.1, 1.9, 3.2, 3.9, 5.1]);
        let design = DMatrix::from_fn(5, 2, |i, j| if j == 0 { 1.0 } else { x[i] });
        let fit = Problem::plain(design, DVector::from_row_slice(&y)).solve(Scatter::Equal).unwrap();
        let by_row: f64 = x.iter().zip(&fit.residuals).map(|(x, r)| ((x - 3.0) * r).powi(2)).sum();
        let clustered = fit.cluster_covariance(&[0, 1, 2, 3, 4]);
        assert!((clustered[(1, 1)] - 5.0 / 3.0 * by_row / (10.0 * 10.0)).abs() < 1e-12);
    }

    #[test]
    fn an_observation_left_out_is_predicted_as_by_a_fit_to_the_others() {
        let problem = line(&[1.0, 3.0, 2.0, 5.0, 4.0]);
        let squares = (0..5).map(|i| {
            let others = Problem::plain(problem.design.clone().remove_row(i), problem.observed.clone().remove_row(i));
            let fit = others.solve(Scatter::Equal).unwrap();
            (problem.observed[i] - (problem.design.row(i) * fit.parameters)[0]).powi(2)
        });
        let expected = (squares.sum::<f64>() / 5.0).sqrt();
        let found = problem.solve(Scatter::Equal).unwrap().left_out_rms(&problem.design).unwrap();
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }

    #[test]
    fn columns_that_depend_on_each_other_have_no_fit() {
        let fit = |design, n| Problem::plain(design, DVector::from_fn(n, |i, _| i as f64 + 1.0)).solve(Scatter::Equal);
        assert!(fit(DMatrix::from_row_slice(3, 2, &[1.0, 1e6, 2.0, 2e6, 3.0, 3e6]), 3).is_none());
        assert!(fit(DMatrix::from_row_slice(3, 2, &[0.0, 1.0, 0.0, 2.0, 0.0, 4.0]), 3).is_none());
        assert!(fit(DMatrix::identity(3, 3), 3).is_none());
    }

    #[test]
    fn parameters_that_cannot_be_distinguished_are_refused() {
        let mut problem = line(&[1.0, 3.0, 2.0, 5.0, 4.0]);
        problem.design.column_mut(1).fill(2.0);
        assert!(problem.solve(Scatter::Equal).is_none());
    }
}
