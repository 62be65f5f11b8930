//! The four answers in their order: wrong, cause, extension, gain.
//!
//! Fit and search alternate: around the best fit of the present set every set is tried on the linearised model, the
//! chosen one is fitted again in full, until the choice stands.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::evidence::{Candidate, Evidence, Headline, Point, Problem};
use super::findings::{Cause, Diagnosis, Gain, Rejected, Unexplained, Verdict, Wrong};
use super::holdout::{self, least_squares};
use super::noise::{self, Noise};
use super::regimes;
use super::score::{Score, whiten, whiten_with_prior};
use super::search::{Choice, Race, Runner};
use super::smooth;
use crate::estimate::Estimate;

/// Steps of Gauss and Newton to one fit.
const MAX_FIT_STEPS: usize = 12;

/// Alternations of fit and noise.
const MAX_NOISE_ROUNDS: usize = 4;

/// Versions of one mechanism whose traces are kept out of the noise.
const MAX_VERSIONS_IN_NOISE: usize = 3;

/// Alternations of fit and search.
const MAX_ROUNDS: usize = 6;

/// By how much a curve without a name must be better before it keeps a mechanism from being named, and how much worse
/// a mechanism may be and still count as a stand-in: a factor of 20 in evidence.
const MARGIN: f64 = 6.0;

/// Share of what the best curve explains that few parameters with a name must reach to keep it: what a rigid law explains
/// but for a twentieth is that law, imperfectly written down, and the rest is told as unexplained.
const FULL_SHARE: f64 = 0.95;

/// Ratio of misfit to noise from which on the linearised model is not trusted to find the first mechanism.
const GROSS_MISFIT: f64 = 1.25;

/// Difference of the logarithm of the held-out likelihood within which two single mechanisms are as good as each other.
const SAME: f64 = 1.0;

/// Change of a mechanism's size from regime to regime, relative to it, from which on it is another mechanism; less may
/// be due to what the model leaves out.
const LEAST_CHANGE: f64 = 0.1;

/// Least evidence for such a change, beyond the cost of having looked for it everywhere: a factor of 4.
const LEAST_EXCESS: f64 = 3.0;

/// Share of a mechanism's trace beside the baseline's parameters below which it hardly shows.
const HARDLY_SHOWN: f64 = 0.1;

/// Probability below which a misfit is called one.
const SIGNIFICANT: f64 = 0.01;

/// A diagnosis with the figures that it rests on, for tables and drawings.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What is said.
    pub diagnosis: Diagnosis,
    /// The baseline alone.
    pub before: Stage,
    /// With what was named.
    pub after: Stage,
    /// The candidates of the fit in the order of the fit.
    pub fitted: Vec<usize>,
    /// The candidates that were named, strongest first, by their place in [`Problem::candidates`].
    pub named: Vec<usize>,
    /// Measured less modelled by a model without it, fitted without the row's block.
    pub without: Vec<DVector<f64>>,
    /// Evidence of each one: fall of the sum of squares, in units of the noise, when it is added last.
    pub gains: Vec<f64>,
}

/// The model at one stage of a diagnosis.
#[derive(Debug, Clone)]
pub struct Stage {
    /// Its parameters.
    pub point: Point,
    /// Measured less modelled, row by row.
    pub residual: DVector<f64>,
    /// The same for a model that was fitted without the row's block.
    pub held_out: DVector<f64>,
    /// Standard deviation of each row's noise.
    pub sd: Vec<f64>,
    /// Covariance of what was fitted: the baseline's parameters, then those of each candidate in [`Outcome::fitted`].
    pub covariance: DMatrix<f64>,
    /// The same by the scatter between blocks (Liang and Zeger 1986): right where the rows of a block err together.
    pub covariance_by_blocks: DMatrix<f64>,
}

/// The diagnosis of a problem, and the point of the extended model.
pub fn diagnose(problem: &impl Problem) -> (Diagnosis, Point) {
    let outcome = diagnose_in_full(problem);
    (outcome.diagnosis, outcome.after.point)
}

/// The diagnosis of a problem with what it rests on.
pub fn diagnose_in_full(problem: &impl Problem) -> Outcome {
    let candidates = problem.candidates();
    let start = problem.start();
    let mut baseline = Fitted::new(problem, start, Vec::new());
    baseline.settle(problem);

    // Mechanisms alone first: far from the truth the model bends, and a curve would take up the bend. Once they have done
    // what they can, what is left decides whether a curve was needed after all.
    let single = baseline.leap(problem);
    let mut present = single.clone().unwrap_or_else(|| baseline.clone());
    present.alternate(problem, |lap| (lap.race().best_mechanisms().members, None));
    let curve = present
        .alternate(problem, |lap| decide(lap.race().best_mechanisms(), lap.race().best_with_curve(), lap, problem));
    present.drop_what_does_not_predict(problem, &baseline);
    present.drop_what_chance_explains(problem, &baseline);
    let mut refuted = present.drop_what_needs_other_sizes(problem, &baseline);
    if let Some(mut single) = single.filter(|single| single.predicts_as_well_as(&present)) {
        // A set that was thinned out to no more than one mechanism, and predicts no better than that one alone, was a
        // detour.
        single.drop_what_does_not_predict(problem, &baseline);
        single.drop_what_chance_explains(problem, &baseline);
        let of_single = single.drop_what_needs_other_sizes(problem, &baseline);
        if !single.included.is_empty() {
            (present, refuted) = (single, of_single);
        }
    }
    let curve = curve.or(refuted).or_else(|| Lap::new(candidates, &present).unnamed_curve(&present.included));
    report(problem, &baseline, &present, curve)
}

/// The baseline alone, and where it misses the data.
pub fn baseline(problem: &impl Problem) -> (Stage, Vec<Wrong>) {
    let mut baseline = Fitted::new(problem, problem.start(), Vec::new());
    baseline.settle(problem);
    let wrong = wrong(problem.candidates(), &baseline);
    (baseline.stage(baseline.held_out()), wrong)
}

/// The gain from one set of held-out residuals to another, for each quantity.
pub fn gains(evidence: &Evidence, before: &DVector<f64>, after: &DVector<f64>) -> Vec<Gain> {
    let of = |quantity: &super::evidence::Quantity| {
        let (b, a) = (holdout::rms(before, quantity.rows.clone()), holdout::rms(after, quantity.rows.clone()));
        Gain {
            quantity: quantity.name.to_owned(),
            holdout_rms_before: b,
            holdout_rms_after: a,
            reduction_percent: holdout::reduction_percent(b, a),
            ci95: holdout::reduction_interval(&evidence.block, quantity.rows.clone(), before, after),
        }
    };
    evidence.quantities.iter().map(of).collect()
}

/// Mechanisms alone, or what is left of them beside a curve that none of them can replace.
fn decide(
    mechanisms: Choice,
    with_curve: Option<Choice>,
    lap: &Lap<'_>,
    problem: &impl Problem,
) -> (Vec<usize>, Option<String>) {
    match with_curve {
        Some(other)
            if other.criterion
                < mechanisms.criterion.min(0.0) - MARGIN.max(problem.part_unexplained() * -mechanisms.criterion) =>
        {
            // Beside something unknown a name needs evidence that the unknown cannot take over, and more of it than the
            // unknown has itself: what is unknown may bring along a bit of many a mechanism.
            let race = lap.race();
            let mut members = other.members.clone();
            if race.gain(&mechanisms.members) > FULL_SHARE * race.gain(&members)
                && let Some(curve) = lap.best_curve(&mechanisms.members)
            {
                members = mechanisms.members;
                members.push(curve);
            }
            let lost_without = |members: &[usize], place: usize| {
                let mut fewer = members.to_vec();
                fewer.remove(place);
                race.criterion(&fewer) - race.criterion(members)
            };
            while let Some(curve) = members.iter().position(|member| lap.runners[*member].is_curve) {
                let needed = MARGIN.max(lost_without(&members, curve));
                let weak = (0..members.len()).find(|place| *place != curve && lost_without(&members, *place) < needed);
                match weak {
                    Some(place) => members.remove(place),
                    None => break,
                };
            }
            let (curves, named): (Vec<usize>, Vec<usize>) =
                members.iter().partition(|member| lap.runners[**member].is_curve);
            (named, curves.first().and_then(|curve| lap.curve_name(*curve)).map(str::to_owned))
        }
        _ => (mechanisms.members, None),
    }
}

/// A fit of the baseline and the included candidates.
#[derive(Debug, Clone)]
struct Fitted {
    point: Point,
    included: Vec<usize>,
    evidence: Evidence,
    noises: Vec<Noise>,
}

impl Fitted {
    fn new(problem: &impl Problem, point: Point, included: Vec<usize>) -> Self {
        let evidence = believing(problem, problem.evidence(&point), &point, &included);
        let noises = noises(problem, &evidence, &included);
        Fitted { point, included, evidence, noises }
    }

    /// The fit and its noise, each with the other as it is, until the fit stands.
    fn settle(&mut self, problem: &impl Problem) {
        for _ in 0..MAX_NOISE_ROUNDS {
            let moved = self.descend(problem);
            self.noises = noises(problem, &self.evidence, &self.included);
            if moved < 1e-2 {
                return;
            }
        }
    }

    /// Gauss and Newton's steps, shortened where a whole one makes things worse; returns by how much the weighted sum of
    /// squares fell.
    fn descend(&mut self, problem: &impl Problem) -> f64 {
        let mut fallen = 0.0;
        for _ in 0..MAX_FIT_STEPS {
            let columns = self.columns();
            let step = solve(&self.evidence, &self.noises, &columns, &self.evidence.residual);
            let before = weighted_squares(&self.evidence, &self.noises);
            let mut fall = 0.0;
            for shortening in [1.0, 0.5, 0.25, 0.1, 0.03] {
                let point = self.moved(problem, &(&step * shortening));
                let evidence = believing(problem, problem.evidence(&point), &point, &self.included);
                let after = weighted_squares(&evidence, &self.noises);
                if after < before {
                    (self.point, self.evidence, fall) = (point, evidence, before - after);
                    break;
                }
            }
            fallen += fall;
            if fall < 1e-3 {
                break;
            }
        }
        fallen
    }

    /// Alternates between the choice of a set and its fit until the choice stands; returns the curve that goes with it.
    fn alternate(
        &mut self,
        problem: &impl Problem,
        choose: impl Fn(&Lap<'_>) -> (Vec<usize>, Option<String>),
    ) -> Option<String> {
        let mut tried = vec![self.included.clone()];
        let mut curve = None;
        for _ in 0..MAX_ROUNDS {
            let lap = Lap::new(problem.candidates(), self);
            let (members, found) = choose(&lap);
            curve = found;
            if members == self.included {
                break;
            }
            let mut next = Fitted::new(problem, lap.point_of(&members, problem), members.clone());
            next.settle(problem);
            *self = next;
            if tried.contains(&members) {
                break;
            }
            tried.push(members);
        }
        curve
    }

    /// Far from the truth the model bends, and its slopes mislead: there each mechanism is fitted in full, alone, by plain
    /// least squares, and the one that leaves least is the place to start from.
    fn leap(&self, problem: &impl Problem) -> Option<Fitted> {
        if !problem.bends() {
            return None;
        }
        let plain = plain_noises(&self.evidence);
        let is_gross = (0..self.noises.len()).any(|quantity| {
            let rows = self.evidence.quantities[quantity].rows.clone();
            holdout::rms(&self.evidence.residual, rows)
                > GROSS_MISFIT * expected_rms(&self.evidence, &self.noises, quantity)
        });
        let candidates = problem.candidates();
        let mut trials: Vec<(f64, Fitted)> = Vec::new();
        for (i, _) in candidates.iter().enumerate().filter(|(_, candidate)| is_gross && candidate.fixed.is_empty()) {
            let evidence = believing(problem, problem.evidence(&self.point), &self.point, &[i]);
            let mut trial = Fitted { point: self.point.clone(), included: vec![i], evidence, noises: plain.clone() };
            // At first all of the misfit counts as noise, beside which beliefs about sizes weigh too much: once more with
            // what is left, until no more goes.
            for _ in 0..MAX_NOISE_ROUNDS {
                if trial.descend(problem) < 1e-2 {
                    break;
                }
                trial.noises = plain_noises(&trial.evidence);
            }
            if trial.is_possible(candidates) {
                trials.push((weighted_squares(&trial.evidence, &plain), trial));
            }
        }
        // Half of the misfit at least, or the slopes are as good a guide. What is left by the best ones is judged where they
        // were not fitted.
        let least = trials.iter().map(|trial| trial.0).min_by(f64::total_cmp)?;
        let enough = (2.0 * least).min(0.5 * weighted_squares(&self.evidence, &plain));
        let settled = trials.into_iter().filter(|(left, _)| *left <= enough).map(|(_, mut trial)| {
            trial.noises = noises(problem, &trial.evidence, &trial.included);
            trial.settle(problem);
            let left = trial.held_out();
            let of = |quantity: &super::evidence::Quantity| {
                quantity.rows.len() as f64 * holdout::rms(&left, quantity.rows.clone()).ln()
            };
            (trial.evidence.quantities.iter().map(of).sum::<f64>(), trial)
        });
        let settled: Vec<(f64, Fitted)> = settled.collect();
        let least = settled.iter().map(|(left, _)| *left).min_by(f64::total_cmp)?;
        // Where two are as good as each other the catalogue's order decides: the commoner stands first.
        settled.into_iter().find(|(left, _)| *left < least + SAME).map(|(_, trial)| trial)
    }

    /// Whether it is no larger than another set and leaves no more of the data that were held out.
    fn predicts_as_well_as(&self, other: &Fitted) -> bool {
        let left = |fitted: &Fitted| {
            let held_out = fitted.held_out();
            let of = |quantity: &super::evidence::Quantity| {
                quantity.rows.len() as f64 * holdout::rms(&held_out, quantity.rows.clone()).ln()
            };
            fitted.evidence.quantities.iter().map(of).sum::<f64>()
        };
        self.included != other.included && self.included.len() >= other.included.len() && left(self) <= left(other)
    }

    /// Whether every included parameter lies where physics allows it.
    fn is_possible(&self, candidates: &[Candidate]) -> bool {
        self.included.iter().all(|member| {
            let values = self.point.candidates[*member].iter();
            values.zip(&candidates[*member].bounds).all(|(value, (low, high))| (low..=high).contains(&value))
        })
    }

    fn columns(&self) -> DMatrix<f64> {
        let parts: Vec<&DMatrix<f64>> = std::iter::once(&self.evidence.baseline)
            .chain(self.included.iter().map(|member| &self.evidence.candidates[*member]))
            .collect();
        side_by_side(self.evidence.residual.len(), &parts)
    }

    fn moved(&self, problem: &impl Problem, step: &DVector<f64>) -> Point {
        let mut point = self.point.clone();
        let mut steps = step.iter();
        for (value, step) in point.baseline.iter_mut().zip(&mut steps) {
            *value += step;
        }
        for member in &self.included {
            for (value, step) in point.candidates[*member].iter_mut().zip(&mut steps) {
                *value += step;
            }
        }
        debug_assert_eq!(problem.baseline().len(), point.baseline.len());
        point
    }

    /// Residuals as the baseline would leave them at this point: the included candidates' share put back.
    fn without_candidates(&self, candidates: &[Candidate]) -> DVector<f64> {
        let mut residual = self.evidence.residual.clone();
        for member in &self.included {
            let (values, neutral) = (&self.point.candidates[*member], &candidates[*member].neutral);
            let offset = DVector::from_iterator(values.len(), values.iter().zip(neutral).map(|(v, n)| v - n));
            residual += &self.evidence.candidates[*member] * offset;
        }
        residual
    }

    fn stage(&self, held_out: DVector<f64>) -> Stage {
        let mut sd = vec![0.0; self.evidence.residual.len()];
        for (quantity, noise) in self.evidence.quantities.iter().zip(&self.noises) {
            quantity.rows.clone().for_each(|row| sd[row] = noise.sd(self.evidence.stated_sd[row]));
        }
        let columns = self.columns();
        let (n, k) = columns.shape();
        let mut all = columns.insert_column(k, 0.0);
        all.column_mut(k).copy_from(&self.evidence.residual);
        let all = whiten_with_prior(&self.evidence, &self.noises, &all, k);
        let design = all.columns(0, k);
        let covariance = (design.tr_mul(&design)).pseudo_inverse(1e-14).unwrap_or_else(|_| DMatrix::zeros(k, k));
        let mut by_block: std::collections::BTreeMap<usize, DVector<f64>> = std::collections::BTreeMap::new();
        for row in 0..all.nrows() {
            // Each belief is a block of its own.
            let block = if row < n { self.evidence.block[row] } else { usize::MAX - row };
            let score = by_block.entry(block).or_insert_with(|| DVector::zeros(k));
            *score += design.row(row).transpose() * all[(row, k)];
        }
        let blocks = by_block.len() as f64 - (all.nrows() - n) as f64;
        let few = blocks / (blocks - 1.0).max(1.0) * n as f64 / (n as f64 - k as f64).max(1.0);
        let between = by_block.values().fold(DMatrix::zeros(k, k), |sum, score| sum + score * score.transpose());
        let covariance_by_blocks = &covariance * between * &covariance * few;
        Stage {
            point: self.point.clone(),
            residual: self.evidence.residual.clone(),
            held_out,
            sd,
            covariance,
            covariance_by_blocks,
        }
    }

    /// What is left of each row when its block was held out.
    fn held_out(&self) -> DVector<f64> {
        holdout::residuals(&self.evidence, &self.noises, &self.columns(), &self.evidence.residual)
    }

    /// A mechanism that fits and does not predict is none: the one of least use goes, until all that are left predict.
    fn drop_what_does_not_predict(&mut self, problem: &impl Problem, baseline: &Fitted) {
        while !self.included.is_empty() {
            let with = self.held_out();
            let advantage_over =
                |other: &Fitted| holdout::advantage(&self.evidence, &self.noises, &other.held_out(), &with);
            if advantage_over(baseline) < problem.least_advantage() {
                *self = baseline.clone();
                return;
            }
            let useless = (0..self.included.len())
                .map(|place| self.without(problem, baseline, place))
                .map(|other| (advantage_over(&other), other))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .filter(|(advantage, _)| *advantage < problem.least_advantage());
            match useless {
                Some((_, other)) => *self = other,
                None => return,
            }
        }
    }

    /// What chance could have brought, being one of so many that were tried, goes as well: the least likely last.
    fn drop_what_chance_explains(&mut self, problem: &impl Problem, baseline: &Fitted) {
        let candidates = problem.candidates();
        let n_names = names(candidates).len() as f64;
        while !self.included.is_empty() {
            let lap = Lap::new(candidates, self);
            let race = lap.race();
            let all = race.gain(&self.included);
            let p_value = |place: usize| {
                let mut fewer = self.included.clone();
                let df = lap.runners[fewer.remove(place)].columns.len();
                n_names * chance(all - race.gain(&fewer), df)
            };
            let worst = (0..self.included.len())
                .map(|place| (p_value(place), place))
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .filter(|(p_value, _)| *p_value > problem.most_chance());
            match worst {
                Some((_, place)) => *self = self.without(problem, baseline, place),
                None => return,
            }
        }
    }

    /// A mechanism that needs another size in another regime is another one: it goes, and what its size goes with is
    /// returned.
    fn drop_what_needs_other_sizes(&mut self, problem: &impl Problem, baseline: &Fitted) -> Option<String> {
        let mut refuted = None;
        while problem.has_regimes() && !self.included.is_empty() {
            let included: Vec<&DMatrix<f64>> =
                self.included.iter().map(|member| &self.evidence.candidates[*member]).collect();
            let found = regimes::misfits(&self.evidence, &self.noises, &included);
            let differs = |misfit: &regimes::Misfit| {
                let member = self.included[misfit.place];
                let size = self.point.candidates[member][0] - problem.candidates()[member].neutral[0];
                let mut others = self.included.clone();
                others.remove(misfit.place);
                let lap = Lap::new(problem.candidates(), self);
                let race = lap.race();
                let worth = race.criterion(&others) - race.criterion(&self.included);
                misfit.excess > LEAST_EXCESS.max(problem.part_unexplained() * worth)
                    && misfit.change.abs() > LEAST_CHANGE * size.abs()
            };
            let Some(worst) = found.into_iter().find(differs) else {
                break;
            };
            *self = self.without(problem, baseline, worst.place);
            refuted.get_or_insert(worst.with);
            // Something unknown is there, and may bring along a bit of many a mechanism: the others need more evidence of
            // their own than it has.
            self.drop_what_is_weak(problem, baseline, MARGIN.max(worst.excess));
        }
        refuted
    }

    /// Only what is worth more than so much of the criterion stays.
    fn drop_what_is_weak(&mut self, problem: &impl Problem, baseline: &Fitted, needed: f64) {
        while !self.included.is_empty() {
            let lap = Lap::new(problem.candidates(), self);
            let race = lap.race();
            let here = race.criterion(&self.included);
            let worth = |place: usize| {
                let mut fewer = self.included.clone();
                fewer.remove(place);
                race.criterion(&fewer) - here
            };
            let weakest = (0..self.included.len()).min_by(|a, b| worth(*a).total_cmp(&worth(*b)));
            let Some(place) = weakest.filter(|place| worth(*place) < needed) else {
                return;
            };
            *self = self.without(problem, baseline, place);
        }
    }

    /// The fit of the same set less one member.
    fn without(&self, problem: &impl Problem, baseline: &Fitted, place: usize) -> Fitted {
        let mut fewer = self.included.clone();
        let gone = fewer.remove(place);
        if fewer.is_empty() {
            return baseline.clone();
        }
        let mut point = self.point.clone();
        point.candidates[gone].clone_from(&problem.candidates()[gone].neutral);
        let mut other = Fitted::new(problem, point, fewer);
        other.settle(problem);
        other
    }
}

/// The evidence with what is believed of the included candidates beside what is believed of the baseline.
fn believing(problem: &impl Problem, mut evidence: Evidence, point: &Point, included: &[usize]) -> Evidence {
    for member in included {
        let candidate = &problem.candidates()[*member];
        for ((value, neutral), usual) in point.candidates[*member].iter().zip(&candidate.neutral).zip(&candidate.usual)
        {
            evidence.prior.push((neutral - value, *usual));
        }
    }
    evidence
}

/// A curve in the race.
#[derive(Debug, Clone, Copy)]
struct CurveRunner {
    runner: usize,
    /// Along which covariate it runs.
    covariate: &'static str,
    /// In which quantity; none where in all together.
    quantity: Option<usize>,
}

/// One round of the search around a fit.
struct Lap<'a> {
    candidates: &'a [Candidate],
    fitted: &'a Fitted,
    runners: Vec<Runner>,
    curves: Vec<CurveRunner>,
    score: Score,
}

impl<'a> Lap<'a> {
    fn new(candidates: &'a [Candidate], fitted: &'a Fitted) -> Self {
        let mut evidence = fitted.evidence.clone();
        evidence.residual = fitted.without_candidates(candidates);
        evidence.prior.truncate(evidence.baseline.ncols());
        let mut runners: Vec<Runner> = Vec::new();
        let mut parts_of_all: Vec<DMatrix<f64>> = Vec::new();
        let mut usual: Vec<f64> = Vec::new();
        let mut n_columns = 0;
        for (index, candidate) in candidates.iter().enumerate() {
            let family = candidates.iter().position(|other| other.name == candidate.name).unwrap_or(index);
            let allowed = candidate.bounds.iter().zip(&candidate.neutral);
            let bounds = allowed.map(|((low, high), neutral)| (low - neutral, high - neutral)).collect();
            let columns: Vec<usize> = (n_columns..n_columns + evidence.candidates[index].ncols()).collect();
            n_columns += columns.len();
            parts_of_all.push(evidence.candidates[index].clone());
            runners.push(Runner { columns, family, is_curve: false, bounds });
            usual.extend(&candidate.usual);
        }
        let mut curves: Vec<CurveRunner> = Vec::new();
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
                let runner = runners.len();
                runners.push(Runner { columns, family: runner, is_curve: true, bounds: Vec::new() });
                curves.push(CurveRunner { runner, covariate, quantity });
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
        usual.resize(all.ncols(), f64::INFINITY);
        let score = Score::new(&evidence, &fitted.noises, &evidence.baseline, &all, &usual);
        Lap { candidates, fitted, runners, curves, score }
    }

    fn race(&self) -> Race<'_> {
        Race::new(&self.score, &self.runners)
    }

    /// The covariate of the curve that explains what these members leave, if one clearly does.
    fn unnamed_curve(&self, members: &[usize]) -> Option<String> {
        self.best_curve(members).and_then(|curve| self.curve_name(curve)).map(str::to_owned)
    }

    /// The curve that best explains what these members leave, if one clearly does.
    fn best_curve(&self, members: &[usize]) -> Option<usize> {
        let race = self.race();
        let here = race.criterion(members);
        let best = self.curves.iter().map(|curve| {
            let mut with = members.to_vec();
            with.push(curve.runner);
            (race.criterion(&with), curve.runner)
        });
        let (criterion, runner) = best.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (criterion < here - MARGIN).then_some(runner)
    }

    fn curve_name(&self, runner: usize) -> Option<&str> {
        self.curves.iter().find(|curve| curve.runner == runner).map(|curve| curve.covariate)
    }

    /// Where the linearised fit of a set lies.
    fn point_of(&self, members: &[usize], problem: &impl Problem) -> Point {
        let mut point = self.fitted.point.clone();
        for (values, candidate) in point.candidates.iter_mut().zip(self.candidates) {
            values.clone_from(&candidate.neutral);
        }
        let columns = self.race().columns(members);
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
fn curve_shapes(evidence: &Evidence) -> Vec<(&'static str, Vec<Vec<DMatrix<f64>>>)> {
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
            // Each quantity in units of its own noise, and free of the others.
            let part = |rows: &std::ops::Range<usize>| {
                DMatrix::from_fn(n, shape.ncols(), |i, j| {
                    if rows.contains(&i) { shape[(i, j)] * evidence.stated_sd[i] } else { 0.0 }
                })
            };
            evidence.quantities.iter().map(|quantity| part(&quantity.rows)).collect()
        };
        let shapes = if has_legs { vec![basis, by_leg] } else { vec![basis] };
        found.push((covariate.name, shapes.into_iter().map(parts_of).collect()));
    }
    found
}

fn report(problem: &impl Problem, baseline: &Fitted, extended: &Fitted, curve: Option<String>) -> Outcome {
    let candidates = problem.candidates();
    let before = baseline.held_out();
    let after = if extended.included.is_empty() { before.clone() } else { extended.held_out() };
    let gains = gains(&baseline.evidence, &before, &after);

    let lap = Lap::new(candidates, extended);
    let race = lap.race();
    let n_names = names(candidates).len() as f64;
    let mut named: Vec<Named> =
        (0..extended.included.len()).map(|place| cause(problem, extended, &lap, &race, place, n_names)).collect();
    named.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let causes: Vec<Cause> = named.iter().map(|named| named.cause.clone()).collect();

    let depends_on: Vec<String> = curve.into_iter().collect();
    let rows = baseline.evidence.quantities[0].rows.clone();
    let unexplained = (!depends_on.is_empty())
        .then(|| Unexplained { rms: holdout::rms(&extended.evidence.residual, rows), depends_on });
    let verdict = match (causes.is_empty(), unexplained.is_some()) {
        (true, false) => Verdict::None,
        (true, true) => Verdict::Unexplained,
        (false, true) => Verdict::PartlyExplained,
        (false, false) => Verdict::Explained,
    };
    let diagnosis = Diagnosis {
        schema: "glidepolar.diagnosis/1",
        verdict,
        consistency: Vec::new(),
        warnings: Vec::new(),
        wrong: wrong(candidates, baseline),
        rejected: rejected(candidates, extended, &lap, &race, &causes),
        causes,
        unexplained,
        gain: gains[headline(problem, baseline, &before, &after)].clone(),
        gains,
        extended: None,
    };
    Outcome {
        diagnosis,
        before: baseline.stage(before),
        after: extended.stage(after),
        fitted: extended.included.clone(),
        named: named.iter().map(|named| named.candidate).collect(),
        gains: named.iter().map(|named| named.gain).collect(),
        without: named.into_iter().map(|named| named.without).collect(),
    }
}

/// The quantity of which a gain is told.
fn headline(problem: &impl Problem, fitted: &Fitted, before: &DVector<f64>, after: &DVector<f64>) -> usize {
    if problem.headline() == Headline::First {
        return 0;
    }
    let evidence = &fitted.evidence;
    let fall = |quantity: usize| -> f64 {
        let sd = |row: usize| fitted.noises[quantity].sd(evidence.stated_sd[row]);
        let rows = evidence.quantities[quantity].rows.clone();
        rows.map(|row| (before[row].powi(2) - after[row].powi(2)) / sd(row).powi(2)).sum()
    };
    (0..evidence.quantities.len()).max_by(|a, b| fall(*a).total_cmp(&fall(*b))).unwrap_or(0)
}

/// A cause with the figures that it rests on.
struct Named {
    cause: Cause,
    candidate: usize,
    gain: f64,
    without: DVector<f64>,
}

fn cause(
    problem: &impl Problem,
    extended: &Fitted,
    lap: &Lap<'_>,
    race: &Race<'_>,
    place: usize,
    n_names: f64,
) -> Named {
    let candidates = problem.candidates();
    let member = extended.included[place];
    let candidate = &candidates[member];
    let all = race.columns(&extended.included);
    let fit = lap.score.fit(&all);
    let others: Vec<usize> = extended.included.iter().copied().filter(|other| *other != member).collect();
    let gain = fit.gain - if others.is_empty() { 0.0 } else { lap.score.fit(&race.columns(&others)).gain };
    let df = lap.runners[member].columns.len();
    let first = all.iter().position(|column| Some(column) == lap.runners[member].columns.first()).unwrap_or(0);
    let mut parameters: std::collections::BTreeMap<String, Estimate> = candidate
        .parameters
        .iter()
        .enumerate()
        .map(|(i, (name, unit))| {
            let se = fit.covariance[(first + i, first + i)].max(0.0).sqrt();
            ((*name).to_owned(), Estimate::normal(extended.point.candidates[member][i], se, unit))
        })
        .collect();
    for (name, value, unit) in &candidate.fixed {
        parameters.insert((*name).to_owned(), Estimate::normal(*value, 0.0, unit));
    }

    let mut stand_ins: Vec<String> = Vec::new();
    for other in race.stand_ins(&extended.included, place, MARGIN) {
        let name = candidates[other].name;
        if name != candidate.name && !stand_ins.iter().any(|known| known == name) {
            stand_ins.push(name.to_owned());
        }
    }

    let mut without = extended.clone();
    without.included = others;
    let after_baseline = extended.evidence.baseline.ncols()
        + extended.included[..place].iter().map(|i| candidates[*i].usual.len()).sum::<usize>();
    without.evidence.prior.drain(after_baseline..after_baseline + candidate.usual.len());
    without.evidence.residual += &extended.evidence.candidates[member]
        * DVector::from_iterator(
            df,
            extended.point.candidates[member].iter().zip(&candidate.neutral).map(|(v, n)| v - n),
        );
    let (before, after) = (without.held_out(), extended.held_out());
    let quantity = &extended.evidence.quantities[headline(problem, extended, &before, &after)];
    let cause = Cause {
        cause: candidate.name.to_owned(),
        parameters,
        p_value: (n_names * chance(gain, df)).min(1.0),
        delta_bic: gain - df as f64 * lap.score.effective_rows.ln(),
        quantity: quantity.name.to_owned(),
        holdout_rms_before: holdout::rms(&before, quantity.rows.clone()),
        holdout_rms_after: holdout::rms(&after, quantity.rows.clone()),
        indistinguishable_from: stand_ins,
    };
    Named { cause, candidate: member, gain, without: before }
}

fn rejected(
    candidates: &[Candidate],
    extended: &Fitted,
    lap: &Lap<'_>,
    race: &Race<'_>,
    causes: &[Cause],
) -> Vec<Rejected> {
    let here = if extended.included.is_empty() { 0.0 } else { lap.score.fit(&race.columns(&extended.included)).gain };
    names(candidates)
        .into_iter()
        .filter(|name| !causes.iter().any(|cause| cause.cause == *name))
        .map(|name| {
            let versions = (0..candidates.len()).filter(|i| candidates[*i].name == name);
            let best = versions
                .filter(|i| lap.runners[*i].columns.iter().any(|column| lap.score.is_seen(*column)))
                .map(|i| {
                    let mut set = extended.included.clone();
                    set.push(i);
                    let gain = lap.score.fit(&race.columns(&set)).gain - here;
                    (chance(gain, lap.runners[i].columns.len()), i)
                })
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((p_value, index)) = best else {
                return Rejected {
                    cause: name.to_owned(),
                    p_value: None,
                    holdout_rms_after: None,
                    why: "these data cannot show it: the baseline's own parameters absorb it".to_owned(),
                };
            };
            let mut with = extended.clone();
            with.included.push(index);
            with.evidence.prior.extend(candidates[index].usual.iter().map(|usual| (0.0, *usual)));
            let rows = extended.evidence.quantities[0].rows.clone();
            let stands_in: Vec<&str> = causes
                .iter()
                .filter(|cause| cause.indistinguishable_from.iter().any(|other| other == name))
                .map(|cause| cause.cause.as_str())
                .collect();
            let shown = lap.runners[index].columns.first().map_or(0.0, |column| lap.score.seen(*column));
            let mut why = if !stands_in.is_empty() {
                format!("cannot be told from {} in these data", stands_in.join(", "))
            } else if p_value >= SIGNIFICANT {
                format!("explains no more than chance would beside what is named (p = {p_value:.2})")
            } else {
                format!("explains a part (p = {p_value:.1e}), but does not earn a name: it predicts no better, or needs another size elsewhere")
            };
            if shown < HARDLY_SHOWN {
                why += &format!("; beside the baseline's own parameters {:.1} % of its trace shows", 100.0 * shown);
            }
            Rejected {
                cause: name.to_owned(),
                p_value: Some(p_value),
                holdout_rms_after: Some(holdout::rms(&with.held_out(), rows)),
                why,
            }
        })
        .collect()
}

/// Where the baseline alone misses the data: along which covariate, in which quantity.
fn wrong(candidates: &[Candidate], baseline: &Fitted) -> Vec<Wrong> {
    let lap = Lap::new(candidates, baseline);
    let evidence = &baseline.evidence;
    let tests = lap.curves.len().max(1) as f64;
    let mut found: Vec<Wrong> = Vec::new();
    for curve in &lap.curves {
        // What quantities share is told of them one by one.
        let Some(quantity_index) = curve.quantity else { continue };
        let columns = &lap.runners[curve.runner].columns;
        let p_value = (tests * chance(lap.score.fit(columns).gain, columns.len())).min(1.0);
        if p_value > SIGNIFICANT {
            continue;
        }
        let quantity = &evidence.quantities[quantity_index];
        match found.iter_mut().find(|known| known.regime == curve.covariate && known.quantity == quantity.name) {
            Some(known) => known.p_value = known.p_value.min(p_value),
            None => found.push(Wrong {
                quantity: quantity.name.to_owned(),
                regime: curve.covariate.to_owned(),
                rms: holdout::rms(&evidence.residual, quantity.rows.clone()),
                expected_rms: expected_rms(evidence, &baseline.noises, quantity_index),
                p_value,
            }),
        }
    }
    found.sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
    found
}

fn expected_rms(evidence: &Evidence, noises: &[Noise], quantity: usize) -> f64 {
    let rows = evidence.quantities[quantity].rows.clone();
    let n = rows.len().max(1) as f64;
    (rows.map(|row| noises[quantity].sd(evidence.stated_sd[row]).powi(2)).sum::<f64>() / n).sqrt()
}

/// The names of the candidates, each once.
fn names(candidates: &[Candidate]) -> Vec<&'static str> {
    let mut names: Vec<&'static str> = Vec::new();
    for candidate in candidates {
        if !names.contains(&candidate.name) {
            names.push(candidate.name);
        }
    }
    names
}

/// White noise as large as what is left.
fn plain_noises(evidence: &Evidence) -> Vec<Noise> {
    let of = |quantity: &super::evidence::Quantity| {
        let stated: f64 = quantity.rows.clone().map(|row| evidence.stated_sd[row].powi(2)).sum();
        let misfit: f64 = quantity.rows.clone().map(|row| evidence.residual[row].powi(2)).sum();
        Noise { white: misfit / stated.max(f64::MIN_POSITIVE), ..noise::WHITE }
    };
    evidence.quantities.iter().map(of).collect()
}

/// The noise of each quantity, everything that any candidate could explain set aside where there are rows to spare. Of
/// the versions of one mechanism a few stand for all: many jumps together would take all that is slow out of the noise.
fn noises(problem: &impl Problem, evidence: &Evidence, included: &[usize]) -> Vec<Noise> {
    let candidates = problem.candidates();
    let mut parts: Vec<&DMatrix<f64>> = vec![&evidence.baseline];
    parts.extend(included.iter().map(|member| &evidence.candidates[*member]));
    let few = side_by_side(evidence.residual.len(), &parts);
    for name in names(candidates) {
        let versions: Vec<usize> = (0..candidates.len()).filter(|i| candidates[*i].name == name).collect();
        let every = versions.len().div_ceil(MAX_VERSIONS_IN_NOISE);
        let chosen = versions.iter().skip(every / 2).step_by(every).filter(|i| !included.contains(i));
        parts.extend(chosen.map(|i| &evidence.candidates[*i]));
    }
    let many = side_by_side(evidence.residual.len(), &parts);
    evidence
        .quantities
        .iter()
        .map(|quantity| {
            let rows = quantity.rows.clone();
            let reaching = many.column_iter().filter(|column| column.rows(rows.start, rows.len()).amax() > 0.0).count();
            let spare = rows.len() as f64 > problem.rows_per_column() * reaching as f64;
            let explained = if spare { &many } else { &few };
            let residual = evidence.residual.rows(rows.start, rows.len()).into_owned();
            noise::estimate(evidence.series(quantity), &residual, &explained.rows(rows.start, rows.len()).into_owned())
        })
        .collect()
}

fn solve(evidence: &Evidence, noises: &[Noise], columns: &DMatrix<f64>, target: &DVector<f64>) -> DVector<f64> {
    let k = columns.ncols();
    let mut all = DMatrix::zeros(target.len(), k + 1);
    all.columns_mut(0, k).copy_from(columns);
    all.column_mut(k).copy_from(target);
    least_squares(&whiten_with_prior(evidence, noises, &all, k))
}

fn weighted_squares(evidence: &Evidence, noises: &[Noise]) -> f64 {
    weighted(evidence, noises, &evidence.residual)
}

fn weighted(evidence: &Evidence, noises: &[Noise], values: &DVector<f64>) -> f64 {
    let mut column = DMatrix::from_column_slice(values.len(), 1, values.as_slice());
    whiten(evidence, noises, &mut column);
    let belief: f64 = evidence.prior.iter().map(|(belief, sd)| (belief / sd).powi(2)).sum();
    column.norm_squared() + belief
}

/// Probability that chance alone explains this much.
fn chance(gain: f64, df: usize) -> f64 {
    ChiSquared::new(df as f64).map_or(1.0, |distribution| distribution.sf(gain.max(0.0)))
}

fn side_by_side(rows: usize, parts: &[&DMatrix<f64>]) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(rows, parts.iter().map(|part| part.ncols()).sum());
    let mut column = 0;
    for part in parts {
        all.columns_mut(column, part.ncols()).copy_from(part);
        column += part.ncols();
    }
    all
}
