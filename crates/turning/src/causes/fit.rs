//! The model with some of its terms, fitted to turn rate, roll and, where a roll mass moves it, pitch of all stretches.

use std::collections::BTreeMap;

use glidepolar_inference::estimate::Estimate;
use glidepolar_inference::regression::{Problem, Scatter};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::findings::{MOST_CHANCE, PITCH, ROLL, TURN_RATE};
use super::model::{ATTACK, Model, Path, Row, SLIDING, Term, dives, predicted, read_steeper, start};
use crate::{SURE, Stretch, sd};

/// Questions that are asked of a log: roll at rest, list, sensor, yaw.
const QUESTIONS: f64 = 4.0;
/// Prior standard deviation of the curvature per roll and cotangent of the pitch, where the roll hardly varies \[1/m\]: some times
/// what gliders show (0.03 to 0.1).
const PRIOR_PER_ROLL: f64 = 0.2;

/// The same of its change with the squared sine of the roll \[1/m\]. The equations in six degrees of freedom have -0.2 to -0.5 for the
/// built-in Seaglider: at 25 deg of roll it turns half as much per roll as at 3 deg.
const PRIOR_BEND: f64 = 0.3;

/// The same of its change with the cotangent of the pitch \[1/m\]. The net weight is the drag over the sine of the path's angle, which
/// the angle of attack makes steeper than the pitch: at 15 deg of pitch by a fifth, hence -0.05 of the curvature per roll.
const PRIOR_PITCH: f64 = 0.01;

/// Share of the scatter of turn rates that an eddy of a minute leaves in the stretches after a move that it caused: on average over
/// an episode, which has one such stretch among several.
const LASTING: f64 = 0.1;

/// Steps of Gauss and Newton at most: the model is nearly linear.
const STEPS: usize = 12;

/// So many of them at least where nothing is known of the values: the roll per roll mass and what follows from it take three.
const FIRST_STEPS: usize = 5;

/// Values that change by less than this \[rad, 1/m\], with weights that change by less than it in proportion, are found.
const FOUND: f64 = 1e-8;

fn prior(term: Term) -> Option<[f64; 2]> {
    match term {
        Term::Attack => Some(ATTACK),
        Term::RollTurnsAlike => Some([0.0, PRIOR_PER_ROLL]),
        Term::RollTurnsByRoll(_) => Some([0.0, PRIOR_BEND]),
        Term::RollTurnsByPitch(_) => Some([0.0, PRIOR_PITCH]),
        Term::RollPitches => Some(SLIDING),
        _ => None,
    }
}

/// The model with some of its terms, fitted.
pub(super) struct Fit {
    terms: Vec<Term>,
    pub(super) values: DVector<f64>,
    covariance: DMatrix<f64>,
    /// Scatter of turn rate, roll and pitch.
    pub(super) sds: [f64; 3],
    /// Sums of squares of turn rate, roll and pitch, in units of the scatter, for each dive.
    by_dive: Vec<[f64; 3]>,
}

impl Fit {
    /// None where the terms depend on each other. The weights follow from the scatter where they are not given.
    pub(super) fn new(rows: &[Row], terms: &[Term], sds: Option<[f64; 3]>) -> Option<Fit> {
        Fit::beginning_at(rows, terms, sds, None)
    }

    /// The same from another fit of these terms, to most of the stretches or to all.
    fn beginning_at(rows: &[Row], terms: &[Term], sds: Option<[f64; 3]>, near: Option<&Fit>) -> Option<Fit> {
        let n = rows.len();
        let has_pitch = terms.contains(&Term::Askew);
        let readings = if has_pitch { 3 } else { 2 };
        let steeper = if has_pitch { read_steeper(rows) } else { Vec::new() };
        let mut values = near.map_or_else(|| start(terms), |fit| fit.values.clone());
        let scatter = |values: &DVector<f64>| {
            let mut squares = [0.0; 3];
            let model = Model::new(terms, values);
            for row in rows {
                let [rate, roll] = model.predicted(row, model.path(row));
                squares[0] += (row.stretch.rate_rad_s - rate).powi(2);
                squares[1] += (row.stretch.roll_rad - roll).powi(2);
            }
            if has_pitch {
                squares[2] =
                    model.steeper(rows).iter().zip(&steeper).map(|(of_model, read)| (read - of_model).powi(2)).sum();
            }
            // Perfect readings would leave nothing to weigh by.
            squares.map(|sum| (sum / n as f64).sqrt().max(1e-9))
        };
        let spread = |of: fn(&Stretch) -> f64| sd(&rows.iter().map(|row| of(&row.stretch)).collect::<Vec<_>>());
        let mut weights = sds
            .or(near.map(|fit| fit.sds))
            .unwrap_or_else(|| [spread(|s| s.rate_rad_s), spread(|s| s.roll_rad), sd(&steeper)].map(|sd| sd.max(1e-9)));
        // Each reading has the dive: those of one stretch err apart, those of one dive together.
        let mut clusters: Vec<u32> = rows.iter().flat_map(|row| [row.stretch.dive; 2]).collect();
        clusters.extend(rows.iter().take(steeper.len()).map(|row| row.stretch.dive));
        let priors: Vec<(usize, [f64; 2])> =
            terms.iter().enumerate().filter_map(|(at, term)| Some((at, prior(*term)?))).collect();
        clusters.extend(priors.iter().map(|_| rows[0].stretch.dive));
        let length = clusters.len();
        let mut last = None;
        for step in 0..STEPS {
            let here = Model::new(terms, &values);
            let paths: Vec<Path> = rows.iter().map(|row| here.path(row)).collect();
            let of_rows = rows.iter().zip(&paths).flat_map(|(row, path)| {
                let [rate, roll] = here.predicted(row, *path);
                [(row.stretch.rate_rad_s - rate) / weights[0], (row.stretch.roll_rad - roll) / weights[1]]
            });
            let here_steeper = if has_pitch { here.steeper(rows) } else { Vec::new() };
            let of_pitch = steeper.iter().zip(&here_steeper).map(|(read, of_model)| (read - of_model) / weights[2]);
            let of_priors = priors.iter().map(|(at, [mean, sd])| (mean - values[*at]) / sd);
            let residual = DVector::from_iterator(length, of_rows.chain(of_pitch).chain(of_priors));
            let mut design = DMatrix::zeros(length, terms.len());
            for (i, (at, [_, sd])) in priors.iter().enumerate() {
                design[(readings * n + i, *at)] = 1.0 / sd;
            }
            for column in 0..terms.len() {
                let step = 1e-5;
                let at = |change: f64| {
                    let mut values = values.clone();
                    values[column] += change;
                    Model::new(terms, &values)
                };
                let (above, below) = (at(step), at(-step));
                let turns_paths = terms[column] == Term::Attack;
                for (i, (row, path)) in rows.iter().zip(&paths).enumerate() {
                    let [up, down] = [&above, &below]
                        .map(|model| model.predicted(row, if turns_paths { model.path(row) } else { *path }));
                    for k in 0..2 {
                        design[(2 * i + k, column)] = (up[k] - down[k]) / (2.0 * step) / weights[k];
                    }
                }
                if has_pitch && !turns_paths {
                    let [up, down] = [&above, &below].map(|model| model.steeper(rows));
                    for (i, (up, down)) in up.iter().zip(&down).enumerate() {
                        design[(2 * n + i, column)] = (up - down) / (2.0 * step) / weights[2];
                    }
                }
            }
            // While nothing is known of the turn per roll, a sensor's zero is a list: it follows in the next step. Nor is a roll
            // mass's part in the roll at rest known before the roll per roll mass is, which takes two.
            let leans = terms.contains(&Term::List) || terms.contains(&Term::RollMassOffset);
            let is_known = |at: &usize| match terms[*at] {
                Term::Zero => step > 0 || !leans || near.is_some(),
                Term::Share => step > 2 || near.is_some(),
                _ => true,
            };
            let known: Vec<usize> = (0..terms.len()).filter(is_known).collect();
            let mut fit = Problem::plain(design.select_columns(&known), residual).solve(Scatter::Equal)?;
            for (place, at) in known.iter().enumerate() {
                values[*at] += fit.parameters[place];
            }
            if !values.iter().all(|value| value.is_finite()) {
                return None;
            }
            let mut is_found = fit.parameters.amax() < FOUND && (near.is_some() || step >= FIRST_STEPS);
            if sds.is_none() && step < STEPS / 2 {
                let before = weights;
                weights = scatter(&values);
                is_found &= weights.iter().zip(before).all(|(after, before)| (after / before - 1.0).abs() < FOUND);
            }
            if known.len() == terms.len() && (is_found || step + 1 == STEPS) {
                // A prior errs by its standard deviation, whatever it is off by here.
                fit.residuals.rows_mut(readings * n, priors.len()).fill(0.0);
                let of_priors = fit.gain.columns(readings * n, priors.len());
                last = Some(fit.cluster_covariance(&clusters) + of_priors * of_priors.transpose());
                break;
            }
        }
        let covariance = last?;
        let mut by_dive: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
        let of_model = if has_pitch { Model::new(terms, &values).steeper(rows) } else { Vec::new() };
        for (row, (read, of_model)) in rows.iter().zip(steeper.iter().zip(&of_model)) {
            by_dive.entry(row.stretch.dive).or_default()[2] += ((read - of_model) / weights[2]).powi(2);
        }
        for row in rows {
            let [rate, roll] = predicted(row, terms, &values);
            let of_dive = by_dive.entry(row.stretch.dive).or_default();
            of_dive[0] += ((row.stretch.rate_rad_s - rate) / weights[0]).powi(2);
            of_dive[1] += ((row.stretch.roll_rad - roll) / weights[1]).powi(2);
        }
        let by_dive = by_dive.into_values().collect();
        Some(Fit { terms: terms.to_vec(), values, covariance, sds: weights, by_dive })
    }

    pub(super) fn at(&self, term: Term) -> Option<usize> {
        self.terms.iter().position(|known| *known == term)
    }

    pub(super) fn value(&self, term: Term) -> f64 {
        self.at(term).map_or(0.0, |at| self.values[at])
    }

    /// Value and standard error.
    pub(super) fn size(&self, term: Term) -> Option<[f64; 2]> {
        self.at(term).map(|at| [self.values[at], self.covariance[(at, at)].max(0.0).sqrt()])
    }

    /// The same of a weighted sum of terms; a term that is not fitted is zero.
    pub(super) fn sum(&self, terms: &[(Term, f64)]) -> [f64; 2] {
        let mut weights = DVector::zeros(self.terms.len());
        for (term, weight) in terms {
            if let Some(at) = self.at(*term) {
                weights[at] += weight;
            }
        }
        let variance = (weights.transpose() * &self.covariance * &weights)[(0, 0)];
        [weights.dot(&self.values), variance.max(0.0).sqrt()]
    }

    /// Error of the sensor's zero by disturbances that outlast a move of the control \[rad\]: the glider is leaned because an eddy
    /// turned it, and what is left of the eddy after the move is taken for a turn by this roll.
    pub(super) fn lasting_disturbance(&self, rows: &[Row]) -> f64 {
        let Some(at) = self.at(Term::Zero) else { return 0.0 };
        let step = 1e-4;
        let mut moved = self.values.clone();
        moved[at] += step;
        let slope = |row: &Row| {
            let [before, after] = [&self.values, &moved].map(|values| predicted(row, &self.terms, values)[0]);
            (after - before).abs() / step
        };
        let mean = rows.iter().map(slope).sum::<f64>() / rows.len() as f64;
        LASTING * self.sds[0] / mean.max(f64::MIN_POSITIVE)
    }

    /// Standard error of a size by leaving out one dive at a time.
    pub(super) fn jackknife(&self, rows: &[Row], of: impl Fn(&Fit) -> Option<[f64; 2]> + Sync) -> f64 {
        let without = |dive: u32| {
            let kept: Vec<Row> = rows.iter().filter(|row| row.stretch.dive != dive).copied().collect();
            Fit::beginning_at(&kept, &self.terms, None, Some(self)).as_ref().and_then(&of).map(|[value, _]| value)
        };
        let parts: Vec<f64> = dives(rows).into_par_iter().filter_map(without).collect();
        let n = parts.len() as f64;
        let mean = parts.iter().sum::<f64>() / n;
        let se = ((n - 1.0) / n * parts.iter().map(|part| (part - mean).powi(2)).sum::<f64>()).sqrt();
        if se.is_finite() { se } else { 0.0 }
    }

    pub(super) fn freedom(&self) -> f64 {
        self.by_dive.len() as f64 - 1.0
    }

    /// One term over another; none where the denominator may be zero.
    pub(super) fn ratio(&self, above: Term, below: Term, unit: &str) -> Option<Estimate> {
        let (a, b) = (self.at(above)?, self.at(below)?);
        let (top, bottom) = (self.values[a], self.values[b]);
        let se = |at: usize| self.covariance[(at, at)].max(0.0).sqrt();
        if bottom.abs() < SURE * se(b) {
            return None;
        }
        let value = top / bottom;
        let variance = (self.covariance[(a, a)] - 2.0 * value * self.covariance[(a, b)]
            + value * value * self.covariance[(b, b)])
            / (bottom * bottom);
        Some(Estimate::student(value, variance.max(0.0).sqrt(), self.freedom(), unit))
    }

    /// The same with the scatter between dives, where that is more.
    pub(super) fn ratio_by_dives(&self, rows: &[Row], above: Term, below: Term, unit: &str) -> Option<Estimate> {
        let of = |fit: &Fit| fit.ratio(above, below, unit).map(|ratio| [ratio.value, ratio.se]);
        let [value, se] = of(self)?;
        Some(Estimate::student(value, se.max(self.jackknife(rows, of)), self.freedom(), unit))
    }

    pub(super) fn rudder_per_roll(&self) -> Option<f64> {
        let rudder = self.ratio(Term::Yaw, Term::Rudder, "")?;
        let per_roll =
            [Term::RollTurns(true), Term::RollTurns(false), Term::RollTurnsAlike].map(|term| self.value(term).abs());
        rudder.value.is_finite().then(|| per_roll.into_iter().fold(0.0, f64::max) / self.value(Term::Rudder).abs())
    }

    /// Probability by chance of a size like this one, corrected for the number of questions; 1 where it does not exceed the
    /// limit of relevance by a standard error.
    pub(super) fn chance(&self, [value, se]: [f64; 2], limit: f64) -> f64 {
        self.chance_considering([value, se], 0.0, limit)
    }

    /// The same of a size that errs by a considered figure too, whose error has no scatter to be estimated from: the freedom is that of
    /// the sum of both variances (Welch 1947).
    pub(super) fn chance_considering(&self, [value, se]: [f64; 2], considered: f64, limit: f64) -> f64 {
        let of_both = se.hypot(considered);
        let is_relevant = value.abs() - of_both > limit;
        let chance =
            2.0 * student_above(value.abs() / of_both.max(f64::MIN_POSITIVE), self.freedom_considering(se, considered));
        if is_relevant { (QUESTIONS * chance).min(1.0) } else { 1.0 }
    }

    /// Degrees of freedom of an error of this fit and a considered one together.
    pub(super) fn freedom_considering(&self, se: f64, considered: f64) -> f64 {
        let share = (se / se.hypot(considered).max(f64::MIN_POSITIVE)).powi(4);
        (self.freedom() / share.max(1e-4)).max(self.freedom())
    }

    /// Returns the log-likelihood ratio of a size against zero, by Student's density.
    pub(super) fn log_likelihood_ratio(&self, [value, se]: [f64; 2]) -> f64 {
        let (t, freedom) = (value / se.max(f64::MIN_POSITIVE), self.freedom().max(1.0));
        0.5 * (freedom + 1.0) * (t * t / freedom).ln_1p()
    }

    /// Whether its misfit in a quantity is larger for certain, the dives being independent (Vuong 1989, with Student's t).
    pub(super) fn is_worse_than(&self, other: &Fit, quantity: &str) -> bool {
        let at = [TURN_RATE, ROLL, PITCH].iter().position(|known| *known == quantity).unwrap_or(0);
        let apart: Vec<f64> = self.by_dive.iter().zip(&other.by_dive).map(|(a, b)| a[at] - b[at]).collect();
        let n = apart.len() as f64;
        let mean = apart.iter().sum::<f64>() / n;
        let se = sd(&apart) / n.sqrt();
        student_above(mean / se.max(f64::MIN_POSITIVE), n - 1.0) < MOST_CHANCE
    }
}

fn student_above(t: f64, freedom: f64) -> f64 {
    if t.is_nan() {
        return 1.0;
    }
    StudentsT::new(0.0, 1.0, freedom.max(1.0)).map_or(1.0, |student| student.sf(t))
}
