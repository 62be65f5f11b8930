//! A cause has one size everywhere: on both legs, shallow and deep, early and late, in what each quantity tells.
//!
//! A curve that merely resembles a mechanism needs another size of it in another regime. For each named mechanism its
//! own column, weighed by a covariate, is fitted beside it; what that explains is the evidence that one size is not
//! enough. A test of one degree of freedom sees this long before a free curve pays its cost.

use nalgebra::{DMatrix, DVector};

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

/// The size of an included mechanism on each leg, the first parameter with its standard error, the other mechanisms being
/// fitted as well; nothing where it acts on one leg alone.
pub fn on_each_leg(
    evidence: &Evidence,
    noises: &[Noise],
    included: &[Included<'_>],
    place: usize,
) -> Option<[(f64, f64); 2]> {
    let n = evidence.residual.len();
    let trace = included[place].trace();
    let of_leg =
        |sign: f64| DVector::from_fn(n, |row, _| if evidence.leg[row] * sign > 0.0 { trace[row] } else { 0.0 });
    let legs = [of_leg(-1.0), of_leg(1.0)];
    let others = included.iter().enumerate().filter(|(other, _)| *other != place);
    let mut columns: Vec<DVector<f64>> = legs.to_vec();
    columns.extend(others.flat_map(|(_, one)| one.columns.column_iter().map(|column| column.into_owned())));
    let all = DMatrix::from_columns(&columns);
    let mut evidence = evidence.clone();
    evidence.prior.truncate(evidence.baseline.ncols());
    let prior = vec![(0.0, f64::INFINITY); all.ncols()];
    let score = Score::new(&evidence, noises, &evidence.baseline, &all, &prior);
    if !(score.is_identifiable(0) && score.is_identifiable(1)) {
        return None;
    }
    let fit = score.fit(&(0..all.ncols()).collect::<Vec<_>>());
    let size = included[place].sizes[0];
    Some([0, 1].map(|leg| (size + fit.step[leg], fit.se(leg))))
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
