//! What a diagnosis works on: residuals, and how each candidate would change them. Knows neither tank nor sea.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, Normal};

use super::decorrelation::Decorrelation;
use super::relevance::SHARE_OF_SCATTER;
use super::smooth::Kind;
use crate::noise::{Lasting, Series};

/// One measured quantity: a run of rows in the order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Its name, as reports give it (`vertical_velocity`).
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its rows.
    pub rows: Range<usize>,
    /// Rows no farther apart than this share a reading of which each is a difference \[s\]; 0 where none do.
    pub joined_s: f64,
}

/// A value that may have to do with the residuals: depth, time, heading, speed.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariate {
    /// Its name, as reports give it.
    pub name: &'static str,
    /// How it runs.
    pub kind: Kind,
    /// Its value in each row; not a number where it means nothing.
    pub values: Vec<f64>,
}

/// The data against a model at one point of its parameters.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// The measured quantities, one after the other.
    pub quantities: Vec<Quantity>,
    /// Time of each row \[s\].
    pub time_s: Vec<f64>,
    /// Stated standard deviation of the measurement in each row.
    pub stated_sd: Vec<f64>,
    /// The glide or run to which each row belongs: what is held out is held out whole.
    pub block: Vec<usize>,
    /// Which leg a row is on: +1 and -1; all +1 where there are no legs.
    pub leg: Vec<f64>,
    /// Place of each row along the water column, 0 to 1, by which slow water keeps its shape; empty where there is none.
    pub place: Vec<f64>,
    /// Measured less modelled.
    pub residual: DVector<f64>,
    /// Sensitivity of the modelled value to each baseline parameter: rows by parameters.
    pub baseline: DMatrix<f64>,
    /// The same with no candidate at work, where that differs: whether a candidate is needed is asked of a baseline without
    /// it. A law that multiplies one parameter tells it from another that does the same, which the baseline alone cannot.
    pub baseline_without: Option<DMatrix<f64>>,
    /// What is believed of the baseline beforehand: for each parameter its believed value less the present one, and the
    /// standard deviation of that belief.
    pub prior: Vec<(f64, f64)>,
    /// Sensitivity to each candidate's parameters, in the order of [`Problem::candidates`].
    pub candidates: Vec<DMatrix<f64>>,
    /// What one standard error of each error that all rows share changes in them: rows by errors. It widens the intervals of
    /// sizes and takes no part in the choice of names.
    pub shared: DMatrix<f64>,
    /// What the residuals may go with.
    pub covariates: Vec<Covariate>,
    /// How these rows were made independent of each other; none where they are as they were read.
    pub decorrelation: Option<Arc<Decorrelation>>,
}

impl Evidence {
    /// The rows of a quantity as its noise sees them.
    pub fn series(&self, quantity: &Quantity) -> Series<'_> {
        let rows = quantity.rows.clone();
        let place = if self.place.is_empty() { &[][..] } else { &self.place[rows.clone()] };
        Series {
            time_s: &self.time_s[rows.clone()],
            stated_sd: &self.stated_sd[rows],
            place,
            joined_s: quantity.joined_s,
        }
    }

    /// These columns as the readings have them: what is alike in all rows is small in rows that were made independent.
    pub fn as_read(&self, mut columns: DMatrix<f64>) -> DMatrix<f64> {
        if let Some(decorrelation) = &self.decorrelation {
            decorrelation.undo(&mut columns);
        }
        columns
    }

    /// Standard deviations of the readings, where these are those of independent rows.
    pub fn sd_as_read(&self, mut sd: Vec<f64>) -> Vec<f64> {
        if let Some(decorrelation) = &self.decorrelation {
            sd.iter_mut().zip(decorrelation.shared_sd()).for_each(|(sd, shared)| *sd = sd.hypot(shared));
        }
        sd
    }

    /// One column as the readings have it.
    pub fn column_as_read(&self, column: &DVector<f64>) -> DVector<f64> {
        self.as_read(DMatrix::from_column_slice(column.len(), 1, column.as_slice())).column(0).into_owned()
    }
}

/// A mechanism that a diagnosis may name.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The mechanism's name. Candidates of one name are versions of it (the time of a jump), of which one is taken.
    pub name: &'static str,
    /// Name and unit of each parameter that is fitted.
    pub parameters: Vec<(&'static str, &'static str)>,
    /// Where each parameter has no effect.
    pub neutral: Vec<f64>,
    /// Prior standard deviation of each parameter about its neutral value.
    pub prior_sd: Vec<f64>,
    /// Prior standard deviations within which the first parameter usually lies. Beyond them the prior has a power-law tail, and
    /// the mechanism must be the only explanation.
    pub usual_sds: f64,
    /// Smallest and largest value that physics allows each parameter.
    pub bounds: Vec<(f64, f64)>,
    /// The least and the largest first parameter that nature has: what a fit puts beyond is refused.
    pub possible: [f64; 2],
    /// The first parameter as another channel of the data shows it, `prior_sd` being the standard error of that; none: what is
    /// believed lies about neutral.
    pub shown: Option<f64>,
    /// What sets this version apart from the others of its name; none where there is only one.
    pub version: Option<Version>,
}

/// A parameter that is not fitted but chosen: each version of a mechanism has a value of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Version {
    /// Name of the parameter.
    pub name: &'static str,
    /// Its value in this version.
    pub value: f64,
    /// Whether it is the time at which the mechanism begins: there is none before it.
    pub is_onset: bool,
    /// The values that these data cannot tell from it.
    pub between: [f64; 2],
    /// Its unit.
    pub unit: &'static str,
}

impl Candidate {
    /// Whether nature does not have this value of the first parameter.
    pub fn is_impossible(&self, value: f64) -> bool {
        !(self.possible[0]..=self.possible[1]).contains(&value)
    }

    /// Whether nature does not have this value of the first parameter, or it is unusual.
    pub fn cannot_be(&self, value: f64) -> bool {
        self.is_impossible(value) || self.is_unusual(value)
    }

    /// Whether a value of the first parameter lies further from what is believed of it than is usual.
    pub fn is_unusual(&self, value: f64) -> bool {
        (value - self.centre()).abs() > self.usual_sds * self.prior_sd[0]
    }

    /// Prior mean of each parameter less neutral, with its prior standard deviation.
    pub fn prior(&self) -> Vec<(f64, f64)> {
        let shown = self.centre() - self.neutral[0];
        self.prior_sd.iter().enumerate().map(|(i, prior_sd)| (if i == 0 { shown } else { 0.0 }, *prior_sd)).collect()
    }

    /// The prior of the parameters, linearised at these values: mean less neutral and standard deviation of the normal prior that has
    /// the same density and slope there.
    ///
    /// The prior is normal within `K = usual_sds` standard deviations. Beyond, its density falls as the power `-K^2` of the distance, so
    /// that an unusual size is hardly shrunk towards the usual ones. At `k` standard deviations, twice the negative logarithm of
    /// the density is `K^2 (1 + 2 ln (k / K))`, the square `r^2` of a residual of slope `K^2 / (k r)`. The prior by another channel is a
    /// measurement, and normal everywhere.
    pub fn prior_at(&self, values: &[f64]) -> Vec<(f64, f64)> {
        let mut prior = self.prior();
        if self.shown.is_none() && self.is_unusual(values[0]) {
            let distance = values[0] - self.centre();
            let (k, square) = (distance.abs() / self.prior_sd[0], self.usual_sds.powi(2));
            let residual = (square * (1.0 + 2.0 * (k / self.usual_sds).ln())).sqrt();
            let sd = self.prior_sd[0] * k * residual / square;
            prior[0] = (values[0] - self.neutral[0] - distance.signum() * residual * sd, sd);
        }
        prior
    }

    /// Returns the width of each parameter's prior: its standard deviation. That of the first one is multiplied by the prior probability of
    /// the magnitudes that nature has, since a truncated density is as much larger.
    pub fn prior_widths(&self) -> Vec<f64> {
        let mut widths = self.prior_sd.clone();
        let normal = Normal::standard();
        let [below, above] = self.possible.map(|end| normal.cdf((end - self.centre()) / self.prior_sd[0]));
        widths[0] *= (above - below).max(f64::MIN_POSITIVE);
        widths
    }

    /// Prior mean of the first parameter.
    fn centre(&self) -> f64 {
        self.shown.unwrap_or(self.neutral[0])
    }
}

/// Prior standard deviations within which the prior of a nuisance is normal: what is believed of its scatter may be off by a factor
/// of two, and two and a half true ones are within.
const NUISANCE_WITHIN: f64 = 5.0;

/// The prior of a nuisance that is `distance` from its prior mean, linearised there: mean less value and standard deviation of the normal
/// prior with the same density and slope.
///
/// A nuisance is what a fit must allow for and nobody asks: the shear of a current, the force of a strut. Its size is believed, and
/// not known. Beyond `K` = 5 standard deviations the residual `k` of its prior is `k^3 / K^2`, so that hardly more than that is ever
/// taken: a normal prior gives way to a large unknown effect in many rows, and a current of 7 m/s takes the place of a fault.
pub fn nuisance_prior(distance: f64, sd: f64) -> (f64, f64) {
    let k = distance.abs() / sd;
    if k <= NUISANCE_WITHIN {
        return (-distance, sd);
    }
    // The slope is three times the residual over the distance.
    (-distance / 3.0, NUISANCE_WITHIN.powi(2) * sd / (3.0 * k * k))
}

/// Values of the baseline's and the candidates' parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Baseline parameters.
    pub baseline: Vec<f64>,
    /// Parameters of each candidate; neutral where it is not in the model.
    pub candidates: Vec<Vec<f64>>,
}

/// Of which quantity the error of a cause is reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Headline {
    /// The first one.
    First,
    /// The one that gains most by it, in units of its noise.
    MostGained,
}

/// A model with its data. Several fits of it run at once.
pub trait Problem: Sync {
    /// Names and units of the baseline parameters.
    fn baseline(&self) -> &[(&'static str, &'static str)];

    /// What may be named.
    fn candidates(&self) -> &[Candidate];

    /// Where to begin: the baseline as it is believed, every candidate neutral.
    fn start(&self) -> Point;

    /// Other points to begin from where the fit from [`Problem::start`] ends far from what is believed.
    fn other_starts(&self) -> Vec<Point> {
        Vec::new()
    }

    /// Of which quantity the error of a cause is reported.
    fn headline(&self) -> Headline {
        Headline::First
    }

    /// Rows that a quantity must have for each column that could explain it, before its noise is judged with all of them
    /// set aside.
    fn rows_per_column(&self) -> f64 {
        6.0
    }

    /// Standard deviation of the logarithm of the stated variances, as the least that the noise can have. Infinite where they
    /// are no more than weights.
    fn stated_variance_known_to(&self) -> f64 {
        f64::INFINITY
    }

    /// Which slow processes the noise may have.
    fn lasting(&self) -> Lasting {
        Lasting::MinutesAndHours
    }

    /// Least advantage on held-out data, in standard errors, for a mechanism to stay.
    fn least_advantage(&self) -> f64 {
        1.0
    }

    /// Returns the largest number of mechanisms that are named together.
    fn max_causes(&self) -> usize {
        usize::MAX
    }

    /// Probability by chance, corrected for the number of mechanisms, above which none is named.
    fn most_chance(&self) -> f64 {
        1.0
    }

    /// Standard errors by which the size of a candidate must be known for it to be named.
    fn least_known(&self, candidate: usize) -> f64 {
        let _ = candidate;
        0.0
    }

    /// Whether the model is so nonlinear that a linearisation misleads far from the truth: each mechanism is then first fitted in full.
    fn is_strongly_nonlinear(&self) -> bool {
        false
    }

    /// Whether the slopes along a candidate at one size of it say nothing of another: it is fitted from several sizes on.
    fn is_strongly_nonlinear_in(&self, candidate: usize) -> bool {
        let _ = candidate;
        false
    }

    /// The same problem for a first search about a point, quicker: what changes little with the parameters stays as it is there.
    /// None where there is no such problem. What is found is fitted again in full.
    fn for_first_search(&self, about: &Point) -> Option<Self>
    where
        Self: Sized,
    {
        let _ = about;
        None
    }

    /// Whether most of what a candidate does is held fixed in the problem for a first search, which then says nothing of it.
    fn is_held_in_first_search(&self, candidate: usize) -> bool {
        let _ = candidate;
        false
    }

    /// Whether the slopes along a candidate take longer than the residuals.
    fn has_slow_slopes(&self, candidate: usize) -> bool {
        let _ = candidate;
        false
    }

    /// Whether the covariates span regimes in each of which a mechanism must have one size.
    fn has_regimes(&self) -> bool {
        false
    }

    /// Whether the sizes of a mechanism must agree from part to part of the record. Not where the order of the rows is that of a
    /// covariate, as in a campaign that is run from angle to angle: a part of the record is then a part of the law.
    fn has_record_over_time(&self) -> bool {
        false
    }

    /// The candidate of which this one has a part that does not vary over the data: a temperature's mean is an offset.
    fn level_of(&self, candidate: usize) -> Option<usize> {
        let _ = candidate;
        None
    }

    /// Whether a candidate is a level, whose mean says something even where it varies.
    fn is_level(&self, candidate: usize) -> bool {
        let _ = candidate;
        true
    }

    /// Whether a candidate is a constant in a quantity, and so its mean: of that noise which lasts leaves little.
    fn is_mean_of_a_quantity(&self, candidate: usize) -> bool {
        let _ = candidate;
        false
    }

    /// Share of what named mechanisms explain that may stay unexplained beside them without costing them their names.
    fn part_unexplained(&self) -> f64 {
        0.0
    }

    /// Whether a mechanism must show on each of the two legs by itself.
    fn needs_both_legs(&self) -> bool {
        false
    }

    /// Whether the baseline may take up most of a change of a size from regime to regime, as a fitted polar does.
    fn baseline_takes_up_changes(&self) -> bool {
        false
    }

    /// Relative change of a candidate's size from regime to regime from which on it is not one size, whatever the mechanism
    /// explains.
    fn large_change(&self, candidate: usize) -> f64 {
        let _ = candidate;
        f64::INFINITY
    }

    /// Whether the data could contradict a candidate's law: if not, any other law that acts on the same rows explains as much,
    /// and the candidate has no name of its own. It may still stand beside another one as indistinguishable.
    fn is_tested(&self, candidate: usize) -> bool {
        let _ = candidate;
        true
    }

    /// Whether nature has these values of a candidate's parameters, taken together.
    fn exists(&self, candidate: usize, values: &[f64]) -> bool {
        let _ = (candidate, values);
        true
    }

    /// The size in the quantity's unit above which a misfit of it is worth acting on; `scatter` is the rms of what the
    /// measurement alone leaves. See [`super::relevance`].
    fn relevance(&self, quantity: &Quantity, scatter: f64) -> f64 {
        let _ = quantity;
        SHARE_OF_SCATTER * scatter
    }

    /// Whether a mechanism is worth a name where it changes any one row by as much as a misfit must have on the average: each
    /// row is a result of its own.
    fn judges_largest(&self) -> bool {
        false
    }

    /// A parameter of the baseline after a step along its slopes. One that is positive by its nature moves by a factor.
    fn stepped(&self, _place: usize, value: f64, step: f64) -> f64 {
        value + step
    }

    /// Whether a fit may go to this point: where physics has no such baseline it takes a shorter step.
    fn admits(&self, _point: &Point) -> bool {
        true
    }

    /// Residuals and sensitivities at a point. Rows, blocks and covariates are the same at every point.
    fn evidence(&self, point: &Point) -> Evidence;

    /// The same with the sensitivities of these candidates; those of others may be zero. The steps of a fit ask for no more.
    fn evidence_of(&self, point: &Point, _included: &[usize]) -> Evidence {
        self.evidence(point)
    }
}

/// The names of the candidates, each once.
pub(crate) fn names(candidates: &[Candidate]) -> Vec<&'static str> {
    let mut names: Vec<&'static str> = Vec::new();
    for candidate in candidates {
        if !names.contains(&candidate.name) {
            names.push(candidate.name);
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the negative logarithm of the density that is written in the docs, k standard deviations from its middle.
    fn penalty(k: f64) -> f64 {
        if k <= 3.0 { k * k } else { 9.0 * (1.0 + 2.0 * (k / 3.0).ln()) }
    }

    /// The linearised prior has the density and slope of the prior at each size.
    #[test]
    fn the_linearised_prior_has_the_density_and_slope_of_a_power_law_tail() {
        let (neutral, sd) = (1.0, 0.2);
        let candidate = Candidate {
            name: "scale",
            parameters: vec![("scale", "1")],
            neutral: vec![neutral],
            prior_sd: vec![sd],
            usual_sds: 3.0,
            bounds: Vec::new(),
            possible: [f64::NEG_INFINITY, f64::INFINITY],
            shown: None,
            version: None,
        };
        for k in [-12.0f64, -3.5, -2.0, 0.5, 2.9, 3.1, 7.5, 40.0] {
            let (mean, width) = candidate.prior_at(&[neutral + k * sd])[0];
            let residual = (k * sd - mean) / width;
            assert!((residual * residual - penalty(k.abs())).abs() < 1e-9, "{k}: {}", residual * residual);
            let step = 1e-5;
            let slope = (penalty(k.abs() + step) - penalty(k.abs() - step)) / (2.0 * step) * k.signum();
            assert!((2.0 * residual / width * sd - slope).abs() < 1e-6, "{k}: {slope}");
        }
    }

    /// Residual and slope of the linearised prior are those of `k` and of `k^3 / 25`.
    #[test]
    fn a_nuisance_has_a_normal_prior_that_ends() {
        let sd = 0.2;
        let penalty = |k: f64| if k <= 5.0 { k * k } else { k.powi(6) / 625.0 };
        for k in [-7.0f64, -5.5, -1.0, 0.0, 4.9, 5.1, 12.0] {
            let (mean, width) = nuisance_prior(k * sd, sd);
            assert!(((mean / width).powi(2) - penalty(k.abs())).abs() < 1e-9 * penalty(k.abs()).max(1.0), "{k}");
            let step = 1e-6;
            let slope = (penalty(k.abs() + step) - penalty(k.abs() - step)) / (2.0 * step) * k.signum();
            assert!((-2.0 * mean / (width * width) * sd - slope).abs() < 1e-5 * slope.abs().max(1.0), "{k}: {slope}");
        }
    }
}
