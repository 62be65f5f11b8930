//! A cause has one size everywhere: on both legs, shallow and deep, early and late, in what each quantity tells.
//!
//! A curve that merely resembles a mechanism needs another size of it in another regime. For each named mechanism its
//! own column, weighed by a covariate, is fitted beside it; what that explains is the evidence that one size is not
//! enough. A test of one degree of freedom sees this long before a free curve pays its cost.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::covariance::inverse_symmetric;
use super::evidence::Evidence;
use super::score::Score;
use super::smooth::Kind;
use crate::noise::Noise;

/// A regime in which a mechanism would need another size.
#[derive(Debug, Clone, PartialEq)]
pub struct Misfit {
    /// The place of the mechanism among those included.
    pub place: usize,
    /// With what the size would have to go.
    pub with: String,
    /// Evidence: fall of the sum of squares, less the cost of having looked everywhere.
    pub excess: f64,
    /// By how much the size would change from the mean to one standard deviation beyond (from leg to leg by twice as much).
    pub change: f64,
}

/// A named mechanism: its columns, and the size of each of its parameters.
#[derive(Debug, Clone)]
pub struct Included<'a> {
    /// Sensitivity of each row to each parameter.
    pub columns: &'a DMatrix<f64>,
    /// How far from neutral each parameter is.
    pub sizes: DVector<f64>,
}

impl Included<'_> {
    /// What all parameters together do to each row, for a unit of the first.
    fn trace(&self) -> DVector<f64> {
        match self.sizes[0] {
            0.0 => self.columns.column(0).into_owned(),
            first => self.columns * &self.sizes / first,
        }
    }
}

/// The regime in which each included mechanism fails worst, the worst mechanism first.
pub fn misfits(evidence: &Evidence, noises: &[Noise], included: &[Included<'_>]) -> Vec<Misfit> {
    if included.is_empty() {
        return Vec::new();
    }
    let n = evidence.residual.len();
    let k: usize = included.iter().map(|one| one.columns.ncols()).sum();
    let mut tests: Vec<(usize, String, DVector<f64>)> = Vec::new();
    for (place, one) in included.iter().enumerate() {
        let trace = one.trace();
        for (name, weight) in weights(evidence) {
            let weighed = DVector::from_fn(n, |row, _| trace[row] * weight[row]);
            tests.push((place, name, weighed));
        }
    }
    let mut all = DMatrix::zeros(n, k + tests.len());
    let mut at = 0;
    for Included { columns, .. } in included {
        all.columns_mut(at, columns.ncols()).copy_from(columns);
        at += columns.ncols();
    }
    for (i, (_, _, column)) in tests.iter().enumerate() {
        all.set_column(k + i, column);
    }
    let mut evidence = evidence.clone();
    evidence.prior.truncate(evidence.baseline.ncols());
    let prior = vec![(0.0, f64::INFINITY); all.ncols()];
    let score = Score::new(&evidence, noises, &evidence.baseline, &all, &prior);
    let known: Vec<usize> = (0..k).collect();
    let here = score.fit(&known).gain;
    let cost = score.effective_rows.ln() + 2.0 * (tests.len().max(1) as f64).ln();
    let mut worst: Vec<Misfit> = Vec::new();
    for (i, (place, name, _)) in tests.into_iter().enumerate() {
        if !score.is_identifiable(k + i) {
            continue;
        }
        let with: Vec<usize> = known.iter().copied().chain([k + i]).collect();
        let fit = score.fit(&with);
        let (excess, change) = (fit.gain - here - cost, fit.step[k]);
        match worst.iter_mut().find(|known| known.place == place) {
            Some(known) if known.excess < excess => *known = Misfit { place, with: name, excess, change },
            Some(_) => {}
            None => worst.push(Misfit { place, with: name, excess, change }),
        }
    }
    worst.sort_by(|a, b| b.excess.total_cmp(&a.excess));
    worst
}

/// The size of a mechanism on each of two parts of the data: the legs, or the halves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnParts {
    /// The size on each part, less neutral.
    pub size: [f64; 2],
    /// Variance of each.
    pub variance: [f64; 2],
    /// Covariance of the two, where the rest of the model is fitted to both parts.
    pub covariance: f64,
}

/// Standard error of one size on both legs, relative to that of the better known leg, below which the size is known by the
/// contrast of the legs: two legs that tell of it independently reach 0.71.
const BY_CONTRAST: f64 = 0.5;

impl OnParts {
    fn variance_of_difference(&self) -> f64 {
        (self.variance[0] + self.variance[1] - 2.0 * self.covariance).max(f64::MIN_POSITIVE)
    }

    /// The difference of the sizes in its standard errors.
    fn against_one_size(&self) -> f64 {
        (self.size[0] - self.size[1]).abs() / self.variance_of_difference().sqrt()
    }

    /// Variance of one size on both parts.
    fn variance_together(&self) -> f64 {
        let [a, b] = self.variance;
        ((a * b - self.covariance.powi(2)) / self.variance_of_difference()).max(f64::MIN_POSITIVE)
    }

    /// One size on both parts.
    fn together(&self) -> f64 {
        let ([a, b], [var_a, var_b]) = (self.size, self.variance);
        (a * (var_b - self.covariance) + b * (var_a - self.covariance)) / self.variance_of_difference()
    }

    /// Whether neither leg tells by itself what both tell together: an offset of the pitch shifts the legs' polars apart, and
    /// each leg alone would call it another polar.
    fn is_known_by_contrast(&self) -> bool {
        self.variance_together() < BY_CONTRAST.powi(2) * self.variance[0].min(self.variance[1])
    }

    /// Whether the sizes differ by `apart` standard errors, and two sizes explain more by `share` of what one does.
    pub fn differ(&self, apart: f64, share: f64) -> bool {
        let against_one_size = self.against_one_size();
        against_one_size > apart && against_one_size.powi(2) > share * self.explained()
    }

    /// What one size on both parts explains, in units of the noise.
    pub fn explained(&self) -> f64 {
        self.together().powi(2) / self.variance_together()
    }

    /// Standard errors by which the leg that knows it better shows it.
    pub fn best_known(&self) -> f64 {
        (0..2).map(|leg| self.size[leg].abs() / self.variance[leg].sqrt()).fold(0.0, f64::max)
    }

    /// Whether the mechanism may be absent on a leg, or has another size there: it does not show on a leg by `shown` standard errors,
    /// or the sizes [differ](OnParts::differ).
    ///
    /// Where it is known by the contrast of the legs none shows it by itself: then one size on both stands until a law on one leg
    /// explains more by `share` of what the one size does.
    pub fn disagree(&self, shown: f64, apart: f64, share: f64) -> bool {
        let sign = self.together().signum();
        let against_none = (0..2).map(|leg| self.size[leg] * sign / self.variance[leg].sqrt());
        let least = against_none.fold(f64::INFINITY, f64::min);
        let one_leg_explains_more =
            || self.against_one_size().powi(2) - least.max(0.0).powi(2) > share * self.explained();
        least < shown && (!self.is_known_by_contrast() || one_leg_explains_more()) || self.differ(apart, share)
    }
}

/// The size of an included mechanism on each leg, the first parameter, the other mechanisms being fitted as well; nothing where
/// it acts on one leg alone.
pub fn on_each_leg(evidence: &Evidence, noises: &[Noise], included: &[Included<'_>], place: usize) -> Option<OnParts> {
    let n = evidence.residual.len();
    let trace = included[place].trace();
    let of_leg =
        |sign: f64| DVector::from_fn(n, |row, _| if evidence.leg[row] * sign > 0.0 { trace[row] } else { 0.0 });
    let (evidence, all, prior) = split(evidence, included, place, vec![of_leg(-1.0), of_leg(1.0)]);
    let score = Score::new(&evidence, noises, &evidence.baseline, &all, &prior);
    if !(score.is_identifiable(0) && score.is_identifiable(1)) {
        return None;
    }
    let fit = score.fit(&(0..all.ncols()).collect::<Vec<_>>());
    let size = included[place].sizes[0];
    Some(OnParts {
        size: [0, 1].map(|leg| size + fit.step[leg]),
        variance: [0, 1].map(|leg| fit.covariance[(leg, leg)].max(f64::MIN_POSITIVE)),
        covariance: fit.covariance[(0, 1)],
    })
}

/// How the size of a mechanism varies from one part of the record to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OverTime {
    /// What sizes of their own explain beyond one size, in units of the noise: a chi-squared variable where there is one size.
    pub beyond_one_size: f64,
    /// Its degrees of freedom: the parts less one.
    pub degrees_of_freedom: f64,
    /// What one size explains, in the same units.
    pub explained: f64,
}

impl OverTime {
    /// Whether the sizes differ by more than chance allows, and explain more by `share` of what one size does.
    pub fn varies(&self, chance: f64, share: f64) -> bool {
        let Ok(chi_squared) = ChiSquared::new(self.degrees_of_freedom) else { return false };
        chi_squared.sf(self.beyond_one_size) < chance
            && self.beyond_one_size - self.degrees_of_freedom > share * self.explained
    }
}

/// Sizes of an included mechanism on parts of the record, all else being fitted to the whole: what comes and goes, or drifts, has no one
/// size, which two halves may hide. `part` is that of each row. Nothing where fewer than two parts show the mechanism.
pub fn over_time(
    evidence: &Evidence,
    noises: &[Noise],
    included: &[Included<'_>],
    place: usize,
    part: &[usize],
) -> Option<OverTime> {
    let n = evidence.residual.len();
    let trace = included[place].trace();
    let of_part = |wanted: usize| DVector::from_fn(n, |row, _| if part[row] == wanted { trace[row] } else { 0.0 });
    let parts = part.iter().max()? + 1;
    let (evidence, all, prior) = split(evidence, included, place, (0..parts).map(of_part).collect());
    let score = Score::new(&evidence, noises, &evidence.baseline, &all, &prior);
    let shown: Vec<usize> = (0..parts).filter(|part| score.is_identifiable(*part)).collect();
    if shown.len() < 2 {
        return None;
    }
    let fit = score.fit(&shown.iter().copied().chain(parts..all.ncols()).collect::<Vec<_>>());
    let k = shown.len();
    let sizes = fit.step.rows(0, k).add_scalar(included[place].sizes[0]);
    let weight = inverse_symmetric(&fit.covariance.view((0, 0), (k, k)).into_owned());
    let ones = DVector::from_element(k, 1.0);
    let weight_of_one = ones.dot(&(&weight * &ones));
    let one = ones.dot(&(&weight * &sizes)) / weight_of_one;
    let apart = sizes.add_scalar(-one);
    Some(OverTime {
        beyond_one_size: apart.dot(&(&weight * &apart)),
        degrees_of_freedom: (k - 1) as f64,
        explained: one * one * weight_of_one,
    })
}

/// The columns of a mechanism split into `parts`, followed by those of the others, none with a prior; with the evidence for them.
fn split(
    evidence: &Evidence,
    included: &[Included<'_>],
    place: usize,
    mut parts: Vec<DVector<f64>>,
) -> (Evidence, DMatrix<f64>, Vec<(f64, f64)>) {
    let others = included.iter().enumerate().filter(|(other, _)| *other != place);
    parts.extend(others.flat_map(|(_, one)| one.columns.column_iter().map(|column| column.into_owned())));
    let all = DMatrix::from_columns(&parts);
    let mut evidence = evidence.clone();
    evidence.prior.truncate(evidence.baseline.ncols());
    let prior = vec![(0.0, f64::INFINITY); all.ncols()];
    (evidence, all, prior)
}

/// What a size may go with: each covariate that runs along a line, the leg, the second quantity.
fn weights(evidence: &Evidence) -> Vec<(String, Vec<f64>)> {
    let n = evidence.residual.len();
    let mut found: Vec<(String, Vec<f64>)> = Vec::new();
    for covariate in evidence.covariates.iter().filter(|covariate| covariate.kind == Kind::Line) {
        let mean = covariate.values.iter().sum::<f64>() / n as f64;
        let spread = (covariate.values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n as f64).sqrt();
        if spread > 1e-9 {
            found.push((covariate.name.to_owned(), covariate.values.iter().map(|v| (v - mean) / spread).collect()));
        }
    }
    if evidence.leg.iter().any(|leg| *leg < 0.0) && evidence.leg.iter().any(|leg| *leg > 0.0) {
        found.push(("leg".to_owned(), evidence.leg.clone()));
    }
    for quantity in evidence.quantities.iter().skip(1) {
        let inside = (0..n).map(|row| if quantity.rows.contains(&row) { 1.0 } else { 0.0 }).collect();
        found.push((quantity.name.to_owned(), inside));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{OnParts, OverTime};

    #[test]
    fn a_size_varies_where_chance_does_not_explain_it_and_it_matters() {
        let varies = |beyond_one_size, explained| {
            OverTime { beyond_one_size, degrees_of_freedom: 5.0, explained }.varies(1.0 / 400.0, 0.1)
        };
        // The quantile of chi-squared of 5 degrees of freedom is 18.4; beside 400 a tenth is 40.
        assert!(varies(19.0, 36.0) && !varies(18.0, 36.0));
        assert!(!varies(40.0, 400.0) && varies(46.0, 400.0));
    }

    /// The rule of the diagnosis at sea.
    fn disagree(legs: OnParts) -> bool {
        legs.disagree(1.645, 3.5, 0.1)
    }

    #[test]
    fn a_leg_that_shows_nothing_may_have_none() {
        // Independent legs, one hardly measured: what is there may act on the other alone.
        assert!(disagree(OnParts { size: [1.0, 0.9], variance: [0.01, 1.0], covariance: 0.0 }));
        assert!(!disagree(OnParts { size: [1.0, 0.9], variance: [0.01, 0.01], covariance: 0.0 }));
        assert!(disagree(OnParts { size: [1.0, -0.9], variance: [0.01, 0.01], covariance: 0.0 }));
    }

    /// The sum of the sizes is known by 0.1, the difference by 1: one size on both is known by 0.05, each leg by 0.5.
    #[test]
    fn what_the_contrast_shows_stands_until_the_legs_speak_against_it() {
        let (variance, covariance) = ([0.2525; 2], -0.2475);
        assert!(!disagree(OnParts { size: [0.6, 0.4], variance, covariance }));
        // A law on one leg explains a hundredth more.
        assert!(!disagree(OnParts { size: [1.0, 0.0], variance, covariance }));
        // One size explains 100, two explain 20 more.
        assert!(disagree(OnParts { size: [2.75, -1.75], variance, covariance }));
    }

    #[test]
    fn sizes_differ_by_their_standard_errors_and_by_enough() {
        let legs = |covariance| OnParts { size: [1.0, 0.45], variance: [0.01, 0.01], covariance };
        assert!(disagree(legs(0.0)));
        assert!(!legs(0.0).disagree(1.645, 3.5, 0.2));
        // Errors of opposite sign make the difference less certain.
        assert!(!disagree(legs(-0.005)));
    }
}
