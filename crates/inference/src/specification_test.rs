//! Two weightings of one least-squares fit as a test of the model (Hausman 1978).
//!
//! Where the model is right both estimates have the same truth, and the difference scatters about zero; where something that
//! depends on a parameter is missing, as a lag, it does not:
//! ```text
//! D = t(second) - t(first),      z = D / se(D),   se(D) by leaving out one block at a time in both
//! ```
//! Where they disagree, two answers of one model to one question tell how far off it is: their standard deviation is
//! `|D|/sqrt 2`. As that of what every such answer is about, it belongs to the errors of the parameters, all of which move
//! together along `D`.

use nalgebra::DVector;

use super::covariance::solve_symmetric;
use super::gram::Gram;

/// Fewest blocks whose scatter says what a difference is worth.
pub const LEAST_BLOCKS: usize = 8;

/// A difference of so many of its standard errors is one: a probability of one in a hundred with 14 blocks, to the safe side
/// for being looked for in each parameter.
const DIFFERENT: f64 = 3.5;

/// Two weighings that disagree.
#[derive(Debug, Clone, PartialEq)]
pub struct Disagreement {
    /// By how much the free parameters move from the one by time to the one by the correlated noise.
    pub differences: Vec<f64>,
    /// Places among them of those that depend on the weighing by more than their 95 % intervals allow.
    pub named: Vec<usize>,
}

impl Disagreement {
    /// One standard error of the model.
    pub fn model_error(&self) -> Vec<f64> {
        self.differences.iter().map(|difference| difference / std::f64::consts::SQRT_2).collect()
    }
}

/// The disagreement of two weightings of the same blocks at one point, if any parameter depends on the weighting by more
/// than its standard error `se` allows; none with too few blocks.
pub fn compare(se: &[f64], first: &[Gram], second: &[Gram]) -> Option<Disagreement> {
    if first.len() < LEAST_BLOCKS || se.is_empty() {
        return None;
    }
    let (of_first, of_second) = (Steps::new(se.len(), first)?, Steps::new(se.len(), second)?);
    let differences: Vec<f64> = (&of_second.whole - &of_first.whole).iter().copied().collect();
    let named: Vec<usize> = (0..se.len())
        .filter(|&i| {
            let difference = differences[i];
            let without: Vec<f64> = of_second.without.iter().zip(&of_first.without).map(|(n, t)| n[i] - t[i]).collect();
            let count = without.len() as f64;
            let mean = without.iter().sum::<f64>() / count;
            let scatter: f64 = without.iter().map(|one| (one - mean).powi(2)).sum();
            let scatter = (scatter * (count - 1.0) / count).sqrt();
            let [low, high] = [-1.96, 1.96].map(|z| z * se[i]);
            difference.abs() > DIFFERENT * scatter && !(low..=high).contains(&difference)
        })
        .collect();
    (!named.is_empty()).then_some(Disagreement { differences, named })
}

/// Steps of Gauss and Newton from a fit, with all blocks and without each.
struct Steps {
    whole: DVector<f64>,
    without: Vec<DVector<f64>>,
}

impl Steps {
    fn new(n: usize, grams: &[Gram]) -> Option<Steps> {
        let all = Gram::sum(n, grams);
        let (normal, gradient) = (all.normal_matrix(), all.gradient());
        let without = |gram: &Gram| -solve_symmetric(&(&normal - gram.normal_matrix()), &(&gradient - gram.gradient()));
        let steps = Steps { whole: -solve_symmetric(&normal, &gradient), without: grams.iter().map(without).collect() };
        let is_finite = |step: &DVector<f64>| step.iter().all(|x| x.is_finite());
        let all_are = is_finite(&steps.whole) && steps.without.iter().all(is_finite);
        all_are.then_some(steps)
    }
}
