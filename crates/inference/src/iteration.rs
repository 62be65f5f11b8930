//! One round of the search around a fit: every mechanism and every unnamed curve as regressors of one search.

use nalgebra::{DMatrix, DVector};

use super::covariance::side_by_side;
use super::evidence::{Candidate, Evidence, Point, Problem};
use super::fitted::Fitted;
use super::holdout;
use super::relevance::ONE_SIDED;
use super::score::{CLEARLY_WRONG, Score, chance};
use super::smooth;
use super::subset_search::{MARGIN, Regressor, SubsetSearch};
use crate::noise::Lasting;

/// A curve in the search.
#[derive(Debug, Clone, Copy)]
pub(super) struct CurveRegressor {
    pub(super) regressor: usize,
    /// Along which covariate it runs.
    pub(super) covariate: &'static str,
    /// In which quantity; none where in all together.
    pub(super) quantity: Option<usize>,
}

/// One round of the search around a fit.
pub(super) struct Iteration<'a> {
    pub(super) candidates: &'a [Candidate],
    pub(super) fitted: &'a Fitted,
    pub(super) regressors: Vec<Regressor>,
    pub(super) curves: Vec<CurveRegressor>,
    pub(super) score: Score,
    /// Residuals and beliefs of the baseline alone.
    evidence: Evidence,
    /// Every regressor's columns side by side, and what is believed of each.
    columns: DMatrix<f64>,
    prior: Vec<(f64, f64)>,
}

/// Share of its largest effect on any row from which on a mechanism acts on a row.
const ACTS: f64 = 0.1;

/// What some members change in the predictions, and how sure that is.
struct Change {
    values: DVector<f64>,
    /// What the readings were missed by before.
    before: DVector<f64>,
    /// Columns beside the baseline, and the covariance of their steps.
    outside: DMatrix<f64>,
    covariance: DMatrix<f64>,
}

impl Change {
    /// Its rms over these rows, the share of the noise removed.
    fn size(&self, rows: &[usize]) -> f64 {
        let part = self.outside.select_rows(rows);
        let noise = part.tr_mul(&part).component_mul(&self.covariance).sum();
        let square: f64 = rows.iter().map(|row| self.values[*row].powi(2)).sum();
        ((square - noise) / rows.len().max(1) as f64).max(0.0).sqrt()
    }

    /// What it takes off the rms of the misfit over these rows, in quadrature.
    fn taken_off(&self, rows: &[usize]) -> f64 {
        let square = |row: &usize| self.before[*row].powi(2) - (self.before[*row] - self.values[*row]).powi(2);
        (rows.iter().map(square).sum::<f64>() / rows.len().max(1) as f64).max(0.0).sqrt()
    }

    /// The standard error of that size: the covariance of the steps along its slope `Z' v / (n size)`.
    fn se_of_size(&self, rows: &[usize]) -> f64 {
        let size = self.size(rows);
        if size == 0.0 {
            return 0.0;
        }
        let part = self.outside.select_rows(rows);
        let slope = part.tr_mul(&self.values.select_rows(rows)) / (rows.len() as f64 * size);
        slope.dot(&(&self.covariance * &slope)).max(0.0).sqrt()
    }
}

impl<'a> Iteration<'a> {
    pub(super) fn new(candidates: &'a [Candidate], fitted: &'a Fitted) -> Self {
        let mut evidence = fitted.evidence.clone();
        evidence.residual = fitted.without_candidates(candidates);
        if let Some(without) = evidence.baseline_without.take() {
            evidence.baseline = without;
        }
        evidence.prior.truncate(evidence.baseline.ncols());
        let mut regressors: Vec<Regressor> = Vec::new();
        let mut parts_of_all: Vec<DMatrix<f64>> = Vec::new();
        let mut prior: Vec<(f64, f64)> = Vec::new();
        let mut n_columns = 0;
        for (index, candidate) in candidates.iter().enumerate() {
            let family = candidates.iter().position(|other| other.name == candidate.name).unwrap_or(index);
            let allowed = candidate.bounds.iter().zip(&candidate.neutral);
            let bounds = allowed.map(|((low, high), neutral)| (low - neutral, high - neutral)).collect();
            let columns: Vec<usize> = (n_columns..n_columns + evidence.candidates[index].ncols()).collect();
            n_columns += columns.len();
            parts_of_all.push(evidence.candidates[index].clone());
            regressors.push(Regressor { columns, family, is_curve: false, bounds });
            // Of a mechanism that is in the fit another version has about its size: the prior of all is taken there, or the one in the
            // fit alone would not be shrunk from a size that is unusual.
            let included = fitted.included.iter().find(|member| candidates[**member].name == candidate.name);
            prior.extend(candidate.prior_at(&fitted.point.candidates[*included.unwrap_or(&index)]));
        }
        let mut curves: Vec<CurveRegressor> = Vec::new();
        for (covariate, shapes) in curve_shapes(&evidence) {
            // Columns of each shape in each quantity; any of them together may be what is there.
            let columns: Vec<Vec<Vec<usize>>> = shapes
                .into_iter()
                .map(|parts| {
                    let place = |part: DMatrix<f64>| {
                        let columns = (n_columns..n_columns + part.ncols()).collect();
                        n_columns += part.ncols();
                        parts_of_all.push(part);
                        columns
                    };
                    parts.into_iter().map(place).collect()
                })
                .collect();
            let mut add = |quantity: Option<usize>, columns: Vec<usize>| {
                let regressor = regressors.len();
                regressors.push(Regressor { columns, family: regressor, is_curve: true, bounds: Vec::new() });
                curves.push(CurveRegressor { regressor, covariate, quantity });
            };
            let n_quantities = evidence.quantities.len();
            let mut shapes: Vec<Vec<Vec<usize>>> = columns.clone();
            if columns.len() > 1 {
                shapes.push(
                    (0..n_quantities).map(|q| columns.iter().flat_map(|shape| shape[q].clone()).collect()).collect(),
                );
            }
            for shape in shapes {
                if n_quantities > 1 {
                    add(None, shape.concat());
                }
                for (quantity, columns) in shape.into_iter().enumerate() {
                    add(Some(quantity), columns);
                }
            }
        }
        let parts = parts_of_all;
        let all = side_by_side(evidence.residual.len(), &parts.iter().collect::<Vec<_>>());
        prior.resize(all.ncols(), (0.0, f64::INFINITY));
        let score = Score::new(&evidence, &fitted.noises, &evidence.baseline, &all, &prior);
        Iteration { candidates, fitted, regressors, curves, score, evidence, columns: all, prior }
    }

    pub(super) fn search(&self) -> SubsetSearch<'_> {
        SubsetSearch::new(&self.score, &self.regressors)
    }

    /// The covariate of the curve that explains what these members leave, if one clearly does.
    pub(super) fn unnamed_curve(&self, members: &[usize], limits: &[f64]) -> Option<String> {
        let curve = self.best_curve(members).filter(|curve| self.is_wrong(members, *curve, limits, CLEARLY_WRONG))?;
        let with: Vec<usize> = members.iter().copied().chain([curve]).collect();
        if self.predicts_better(&with, members) { self.curve_name(curve).map(str::to_owned) } else { None }
    }

    /// The curve that best explains what these members leave, if one clearly does.
    pub(super) fn best_curve(&self, members: &[usize]) -> Option<usize> {
        let search = self.search();
        let here = search.criterion(members);
        let best = self.curves.iter().map(|curve| {
            let mut with = members.to_vec();
            with.push(curve.regressor);
            (search.criterion(&with), curve.regressor)
        });
        let (criterion, regressor) = best.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (criterion < here - MARGIN).then_some(regressor)
    }

    /// The curve that alone explains most for its cost.
    pub(super) fn most_explaining_curve(&self) -> Option<usize> {
        let search = self.search();
        let curves = self.curves.iter().map(|curve| (search.criterion(&[curve.regressor]), curve.regressor));
        curves.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, regressor)| regressor)
    }

    /// Whether a set with a curve predicts_better data that were held out no worse than one without it: what is at work is there
    /// on the next glide, too; a wave that a few glides happened to meet is not.
    pub(super) fn predicts_better(&self, with: &[usize], without: &[usize]) -> bool {
        self.advantage(with, without) > 0.0
    }

    /// How sure it is that a set predicts_better data that were held out better than another.
    pub(super) fn advantage(&self, with: &[usize], without: &[usize]) -> f64 {
        holdout::advantage(&self.evidence, &self.fitted.noises, &self.held_out(without), &self.held_out(with))
    }

    /// What a set leaves of the rows that its fit did not see.
    fn held_out(&self, members: &[usize]) -> DVector<f64> {
        let chosen = self.search().columns(members);
        let mut evidence = self.evidence.clone();
        evidence.prior.extend(chosen.iter().map(|column| self.prior[*column]));
        let members = self.columns.select_columns(&chosen);
        let columns = side_by_side(evidence.residual.len(), &[&evidence.baseline, &members]);
        holdout::residuals(&evidence, &self.fitted.noises, &columns, &evidence.residual)
    }

    /// Probability that chance alone explains what the tested members add to the others: the larger of that by the model of
    /// the noise and that by the scatter between legs or runs.
    pub(super) fn chance(&self, others: &[usize], tested: &[usize]) -> f64 {
        let search = self.search();
        let by_model = match self.curves.iter().find(|curve| tested == [curve.regressor]) {
            Some(curve) if self.fitted.lasting == Lasting::White => {
                self.chance_of_curve(&search.columns(others), curve)
            }
            _ => chance(self.gain_beside(others, tested), search.columns(tested).len()),
        };
        self.or_by_clusters(by_model, others, tested, 1.0)
    }

    /// The same where the likelihood says that the tested members explain so much, which may be more than by the slopes.
    pub(super) fn chance_of_rise(&self, rise: f64, others: &[usize], tested: &[usize]) -> f64 {
        let magnified = (rise / self.gain_beside(others, tested)).max(1.0);
        self.or_by_clusters(chance(rise, self.search().columns(tested).len()), others, tested, magnified)
    }

    fn gain_beside(&self, others: &[usize], tested: &[usize]) -> f64 {
        let search = self.search();
        let with: Vec<usize> = others.iter().chain(tested).copied().collect();
        search.gain(&with) - search.gain(others)
    }

    /// The larger of a probability and that by the scatter between legs or runs. The second test costs more; where the first one is
    /// content it has no say.
    fn or_by_clusters(&self, by_model: f64, others: &[usize], tested: &[usize], magnified: f64) -> f64 {
        let search = self.search();
        if by_model > 0.5 {
            return by_model;
        }
        by_model.max(self.score.chance_by_clusters(&search.columns(others), &search.columns(tested), magnified))
    }

    /// The same of a curve by what it leaves itself. The noise is that beside the mechanisms alone: what no mechanism explains is in it.
    fn chance_of_curve(&self, others: &[usize], curve: &CurveRegressor) -> f64 {
        let quantities = &self.evidence.quantities;
        let (rows, noises) = match curve.quantity {
            Some(index) => (quantities[index].rows.clone(), &self.fitted.noises[index..=index]),
            None => (0..self.evidence.residual.len(), &self.fitted.noises[..]),
        };
        // No row is better than its measurement states.
        let stated = noises.iter().map(|noise| noise.white.recip()).fold(f64::INFINITY, f64::min);
        self.score.chance_by_rows(others, &self.regressors[curve.regressor].columns, rows, stated)
    }

    /// The rms of what the tested members change in the predictions of each quantity beside the others, once everything is
    /// fitted again, the share of the noise removed.
    ///
    /// For nested fits the change of the predictions has the covariance of the one less that of the other.
    pub(super) fn sizes(&self, others: &[usize], tested: &[usize]) -> Vec<f64> {
        self.sizes_less(others, tested, 0.0)
    }

    /// The sizes less some of their standard errors. Nothing is larger than what it takes off the misfit: where noise is slow, a curve
    /// and what the baseline makes of it may change the predictions by more, all of it noise again.
    fn sizes_less(&self, others: &[usize], tested: &[usize], standard_errors: f64) -> Vec<f64> {
        let change = self.change(others, tested);
        let of = |quantity: &super::evidence::Quantity| {
            let rows: Vec<usize> = quantity.rows.clone().collect();
            let size = change.size(&rows) - standard_errors * change.se_of_size(&rows);
            size.clamp(0.0, change.taken_off(&rows))
        };
        self.evidence.quantities.iter().map(of).collect()
    }

    /// The rms of the change itself, whether it takes anything off the misfit or adds to it.
    pub(super) fn changes(&self, others: &[usize], tested: &[usize]) -> Vec<f64> {
        let change = self.change(others, tested);
        let of = |quantity: &super::evidence::Quantity| change.size(&quantity.rows.clone().collect::<Vec<_>>());
        self.evidence.quantities.iter().map(of).collect()
    }

    /// The same of the row that one mechanism changes most.
    pub(super) fn largest(&self, others: &[usize], tested: &[usize]) -> Vec<f64> {
        let change = self.change(others, tested);
        let of = |quantity: &super::evidence::Quantity| {
            quantity.rows.clone().map(|row| change.size(&[row])).fold(0.0, f64::max)
        };
        self.evidence.quantities.iter().map(of).collect()
    }

    fn change(&self, others: &[usize], tested: &[usize]) -> Change {
        let search = self.search();
        let with: Vec<usize> = others.iter().chain(tested).copied().collect();
        let (all, few) = (search.columns(&with), search.columns(others));
        let mut outside = self.columns.select_columns(&all);
        for (j, column) in all.iter().enumerate() {
            let absorbed = &self.evidence.baseline * self.score.absorbed(*column);
            let mut here = outside.column_mut(j);
            here -= absorbed;
        }
        let (wide, narrow) = (self.score.fit(&all), self.score.fit(&few));
        let mut step = wide.step.clone();
        let mut covariance = wide.covariance.clone();
        for i in 0..few.len() {
            step[i] -= narrow.step[i];
            (0..few.len()).for_each(|j| covariance[(i, j)] -= narrow.covariance[(i, j)]);
        }
        let outside = self.evidence.as_read(outside);
        let by_baseline = &self.evidence.residual - &self.evidence.baseline * self.score.baseline_step();
        let of_few: DVector<f64> = outside.columns(0, few.len()) * &narrow.step;
        let before = self.evidence.column_as_read(&by_baseline) - of_few;
        Change { values: &outside * step, before, outside, covariance }
    }

    /// The same of one mechanism, over the rows in which it acts.
    pub(super) fn size_where_it_acts(&self, others: &[usize], member: usize) -> Vec<f64> {
        let change = self.change(others, &[member]);
        self.evidence.quantities.iter().map(|quantity| change.size(&self.rows_of(member, quantity))).collect()
    }

    /// The rows of a quantity in which a mechanism acts: those that a unit of it changes by a tenth of the most it changes any, or more.
    /// A step late in the log changes few rows, and these are what it is relevant for.
    pub(super) fn rows_of(&self, member: usize, quantity: &super::evidence::Quantity) -> Vec<usize> {
        let column = &self.evidence.candidates[member];
        let felt = |row: usize| column.row(row).amax();
        let most = quantity.rows.clone().map(felt).fold(0.0, f64::max);
        quantity.rows.clone().filter(|row| most > 0.0 && felt(*row) >= ACTS * most).collect()
    }

    /// The same less what chance may have added: below the true sizes in 95 of 100.
    pub(super) fn least_sizes(&self, others: &[usize], tested: &[usize]) -> Vec<f64> {
        self.sizes_less(others, tested, ONE_SIDED)
    }

    /// Whether something that no name explains is there beside the others: a curve that chance does not bring, that is
    /// large enough to act on and that predicts.
    pub(super) fn is_wrong(&self, others: &[usize], curve: usize, limits: &[f64], most_chance: f64) -> bool {
        // A curve in all quantities together is there where it is in one of them: what is clear in one and large in another one
        // is neither.
        let here = self.curves.iter().find(|known| known.regressor == curve);
        if here.is_some_and(|here| here.quantity.is_none()) {
            let of_quantities = (1..=self.evidence.quantities.len()).map(|place| curve + place);
            return of_quantities.into_iter().any(|one| self.is_wrong(others, one, limits, most_chance));
        }
        // What it changes in another quantity is the polar's answer, and no misfit of that one.
        let quantity = here.and_then(|here| here.quantity).unwrap_or(0);
        let tests = self.curves.len().max(1) as f64;
        self.least_sizes(others, &[curve])[quantity] > limits[quantity]
            && tests * self.chance(others, &[curve]) <= most_chance
    }

    /// Whether any curve is there beside these members, clearly, and large enough to act on.
    pub(super) fn is_anything_wrong(&self, members: &[usize], limits: &[f64]) -> bool {
        self.may_be_wrong(members, limits, CLEARLY_WRONG)
    }

    /// Whether any curve of which chance explains no more than this is there beside these members, and large enough to act on.
    pub(super) fn may_be_wrong(&self, members: &[usize], limits: &[f64], most_chance: f64) -> bool {
        self.curves.iter().any(|curve| self.is_wrong(members, curve.regressor, limits, most_chance))
    }

    pub(super) fn curve_name(&self, regressor: usize) -> Option<&str> {
        self.curves.iter().find(|curve| curve.regressor == regressor).map(|curve| curve.covariate)
    }

    /// Where the linearised fit of a set lies.
    pub(super) fn point_of(&self, members: &[usize], problem: &impl Problem) -> Point {
        let mut point = self.fitted.point.clone();
        for (values, candidate) in point.candidates.iter_mut().zip(self.candidates) {
            values.clone_from(&candidate.neutral);
        }
        let columns = self.search().columns(members);
        if columns.is_empty() {
            return Point { baseline: problem.start().baseline, ..point };
        }
        let fit = self.score.fit(&columns);
        let mut steps = fit.step.iter();
        for member in members {
            for (value, step) in point.candidates[*member].iter_mut().zip(&mut steps) {
                *value += step;
            }
        }
        point
    }
}

/// Every curve that could show: along each covariate, alike and opposite on the legs, for each quantity its columns.
pub(super) fn curve_shapes(evidence: &Evidence) -> Vec<(&'static str, Vec<Vec<DMatrix<f64>>>)> {
    let n = evidence.residual.len();
    let has_legs = evidence.leg.iter().any(|leg| *leg < 0.0) && evidence.leg.iter().any(|leg| *leg > 0.0);
    let mut found = Vec::new();
    for covariate in &evidence.covariates {
        let basis = smooth::basis(covariate.kind, &covariate.values);
        if basis.ncols() == 0 {
            continue;
        }
        let by_leg = DMatrix::from_fn(n, basis.ncols(), |i, j| basis[(i, j)] * evidence.leg[i]);
        let parts_of = |shape: DMatrix<f64>| -> Vec<DMatrix<f64>> {
            // Each quantity in units of its own noise, and free of the others. One unit for all its rows: what a row states
            // of its error may go by its own measurement, and a curve must not know that.
            let part = |rows: &std::ops::Range<usize>| {
                let sizes = &evidence.stated_sd[rows.clone()];
                let unit = (sizes.iter().map(|sd| sd * sd).sum::<f64>() / sizes.len().max(1) as f64).sqrt();
                DMatrix::from_fn(n, shape.ncols(), |i, j| if rows.contains(&i) { shape[(i, j)] * unit } else { 0.0 })
            };
            evidence.quantities.iter().map(|quantity| part(&quantity.rows)).collect()
        };
        let shapes = if has_legs { vec![basis, by_leg] } else { vec![basis] };
        found.push((covariate.name, shapes.into_iter().map(parts_of).collect()));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::Toy;

    /// A mechanism that is there, and one that noise alone brings: each takes off the misfit what the two fits say, and its size is no
    /// larger.
    #[test]
    fn a_size_is_no_larger_than_what_it_takes_off_the_misfit() {
        let toy = Toy::new(3, |row, toy| 0.3 * toy.columns[1][row]);
        let baseline = Fitted::baseline(&toy);
        let iteration = Iteration::new(toy.candidates(), &baseline);
        let rows: Vec<usize> = (0..baseline.evidence.residual.len()).collect();
        let rms = |fitted: &Fitted| crate::holdout::rms(&fitted.evidence.residual, rows.iter().copied());
        for member in [1, 4] {
            let mut with = Fitted::new(&toy, iteration.point_of(&[member], &toy), vec![member]);
            with.noises.clone_from(&baseline.noises);
            with.descend(&toy);
            let expected = (rms(&baseline).powi(2) - rms(&with).powi(2)).max(0.0).sqrt();
            let found = iteration.change(&[], &[member]).taken_off(&rows);
            assert!((found - expected).abs() < 1e-6 + 1e-3 * expected, "{member}: {found} against {expected}");
            let size = iteration.sizes(&[], &[member])[0];
            assert!(size <= found, "{member}: {size} of {found}");
        }
    }
}
