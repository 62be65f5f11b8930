//! What the engine found, reported for the campaign and for each hull: sizes, chances, gains, the extended fit.

use std::collections::BTreeMap;

use glidepolar_hull::hull_tests::{ExtendedFit, HullFit};
use glidepolar_inference::estimate::Estimate;
use glidepolar_inference::holdout::{reduction_interval, reduction_percent, rms};
use glidepolar_inference::{Cause, Diagnosis, Gain, Outcome, Problem, Rejected, Unexplained, Verdict, Why, Wrong};
use nalgebra::DMatrix;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::data::Data;
use super::mechanisms::Reach;
use super::problem::{Shape, TankProblem};
use super::{Diagnoses, HullDiagnosis, not_identifiable, runs_left};
use crate::hull_results::HullResults;
use crate::sweep::NAMES;

/// A size of one hull's own is reported for that hull where chance would show it less often than this.
const SIGNIFICANT: f64 = 0.01;

/// The size that says which channel drifts.
pub const CHANNEL: &str = "channel";

/// Writes it down.
pub fn write(data: &Data, problem: &TankProblem<'_>, outcome: &Outcome, hulls: &[HullResults]) -> Diagnoses {
    let not_identifiable = not_identifiable(problem, data);
    let teller = Teller { data, problem, outcome };
    let mut campaign = outcome.diagnosis.clone();
    for (place, cause) in campaign.causes.iter_mut().enumerate() {
        cause.parameters = teller.sizes(place, None);
    }
    let not_shown = || {
        not_identifiable.iter().map(|(mechanism, why)| Rejected {
            cause: mechanism.name.to_owned(),
            p_value: None,
            holdout_rms_after: None,
            why: Why::Equivalent,
            remark: why.clone(),
        })
    };
    campaign.rejected.extend(not_shown());
    let of_hulls: Vec<Option<HullDiagnosis>> = (0..data.hulls.len())
        .map(|hull| {
            let rows = teller.runs_of(hull);
            (!rows.is_empty()).then(|| HullDiagnosis {
                diagnosis: if data.hulls.len() == 1 {
                    campaign.clone()
                } else {
                    teller.of_hull(hull, &campaign, &rows)
                },
                extended: teller.extended(hull, &hulls[hull]),
            })
        })
        .collect();
    let absorbed: Vec<String> = not_identifiable
        .iter()
        .filter(|(mechanism, _)| mechanism.reach == Reach::Absorbed)
        .map(|(mechanism, _)| format!("{} ({})", mechanism.name.replace('_', " "), mechanism.shown_by))
        .collect();
    Diagnoses {
        campaign: data.is_raw.then_some(campaign),
        hulls: of_hulls,
        runs: runs_left(data, problem, outcome),
        warnings: vec![format!(
            "diagnosis: a, b, c, d absorb what these steady runs cannot show, in brackets what would: {}",
            absorbed.join("; ")
        )],
    }
}

struct Teller<'a> {
    data: &'a Data,
    problem: &'a TankProblem<'a>,
    outcome: &'a Outcome,
}

impl Teller<'_> {
    /// The rows of one quantity that belong to a hull.
    fn runs_of(&self, hull: usize) -> Vec<usize> {
        let order = self.problem.order();
        (0..order.len()).filter(|i| self.data.runs[order[*i]].hull == hull).collect()
    }

    fn rows(&self, quantity: usize, runs: &[usize]) -> Vec<usize> {
        runs.iter().map(|i| quantity * self.problem.order().len() + i).collect()
    }

    fn shape(&self, place: usize) -> &Shape {
        &self.problem.shapes()[self.outcome.named[place]]
    }

    /// The sizes of a named mechanism, of one hull or of all together.
    fn sizes(&self, place: usize, hull: Option<usize>) -> BTreeMap<String, Estimate> {
        let candidate = self.outcome.named[place];
        let shape = self.shape(place);
        let mechanism = shape.mechanism();
        let values = &self.outcome.after.point.candidates[candidate];
        let covariance = self.covariance(place);
        let n = mechanism.parameters.len();
        // A sum of parameters of one hull, each with its share, and the covariance of two hulls' sums.
        let value = |hull: usize, shares: &[f64]| -> f64 { (0..n).map(|i| shares[i] * values[n * hull + i]).sum() };
        let covariance = |one: usize, other: usize, shares: &[f64]| -> f64 {
            let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            pairs.map(|(i, j)| shares[i] * shares[j] * covariance[(n * one + i, n * other + j)]).sum()
        };
        let report = |shares: &[f64], unit: &str| match (shape, hull) {
            (Shape::EachHull(_), None) => {
                let hulls = self.data.hulls.len();
                let values: Vec<f64> = (0..hulls).map(|hull| value(hull, shares)).collect();
                mean(&values, &DMatrix::from_fn(hulls, hulls, |i, j| covariance(i, j, shares)), unit)
            }
            _ => {
                let hull = if matches!(shape, Shape::EachHull(_)) { hull.unwrap_or(0) } else { 0 };
                Estimate::normal(value(hull, shares), covariance(hull, hull, shares).max(0.0).sqrt(), unit)
            }
        };
        let mut sizes = BTreeMap::new();
        for (name, unit, shares) in mechanism.reported_as {
            sizes.insert((*name).to_owned(), report(shares, unit));
        }
        if mechanism.reported_as.is_empty() {
            for (i, parameter) in mechanism.parameters.iter().enumerate() {
                let shares: Vec<f64> = (0..n).map(|j| f64::from(u8::from(i == j))).collect();
                sizes.insert(parameter.name.to_owned(), report(&shares, parameter.unit));
            }
        }
        match shape {
            Shape::Day(_, day) => {
                sizes.insert("day".to_owned(), Estimate::normal(*day as f64 + 1.0, 0.0, "1"));
            }
            Shape::Drift(_, channel) => tell_channel(&mut sizes, *channel),
            _ => {}
        }
        sizes
    }

    /// Covariance of a named mechanism's parameters: by the model of the noise, or by the scatter between runs where that
    /// is larger. Lift and moment of a run err together, by the angle to which it was set.
    fn covariance(&self, place: usize) -> DMatrix<f64> {
        let candidate = self.outcome.named[place];
        let before = self.outcome.fitted.iter().take_while(|fitted| **fitted != candidate);
        let sizes = |candidate: &usize| self.problem.candidates()[*candidate].neutral.len();
        let first = self.problem.baseline().len() + before.map(sizes).sum::<usize>();
        let df = sizes(&candidate);
        let model = self.outcome.after.covariance.view((first, first), (df, df));
        let runs = self.outcome.after.covariance_by_clusters.view((first, first), (df, df));
        let growth = |i: usize| (runs[(i, i)] / model[(i, i)]).max(1.0).sqrt();
        DMatrix::from_fn(df, df, |i, j| model[(i, j)] * growth(i) * growth(j))
    }

    /// Chance and evidence of a hull's own size.
    fn evidence(&self, place: usize, hull: usize) -> Option<(f64, f64)> {
        let Shape::EachHull(mechanism) = self.shape(place) else { return None };
        let candidate = self.outcome.named[place];
        let df = mechanism.parameters.len();
        let first = df * hull;
        let neutral = &self.problem.candidates()[candidate].neutral;
        let values = &self.outcome.after.point.candidates[candidate];
        let size = nalgebra::DVector::from_fn(df, |i, _| values[first + i] - neutral[first + i]);
        let covariance = self.covariance(place).view((first, first), (df, df)).into_owned();
        let gain = covariance.cholesky().map_or(0.0, |root| size.dot(&root.solve(&size)));
        let p_value = ChiSquared::new(df as f64).map_or(1.0, |d| d.sf(gain));
        Some((p_value, gain - df as f64 * (self.runs_of(hull).len() as f64 * 3.0).ln()))
    }

    fn of_hull(&self, hull: usize, campaign: &Diagnosis, runs: &[usize]) -> Diagnosis {
        let outcome = self.outcome;
        let mut causes: Vec<Cause> = Vec::new();
        for (place, cause) in campaign.causes.iter().enumerate() {
            let quantity = NAMES.iter().position(|name| *name == cause.quantity).unwrap_or(0);
            let rows = self.rows(quantity, runs);
            let own = self.evidence(place, hull);
            if own.is_some_and(|(p_value, _)| p_value > SIGNIFICANT) || !self.acts_on(place, runs) {
                continue;
            }
            let (p_value, delta_bic) = own.unwrap_or((cause.p_value, cause.delta_bic));
            causes.push(Cause {
                parameters: self.sizes(place, Some(hull)),
                p_value,
                delta_bic,
                holdout_rms_before: rms(&outcome.without[place], rows.clone()),
                holdout_rms_after: rms(&outcome.after.held_out, rows),
                ..cause.clone()
            });
        }
        let (before, after) = (&outcome.before.held_out, &outcome.after.held_out);
        let blocks: Vec<usize> = (0..before.len()).map(|row| row % self.problem.order().len()).collect();
        let gains: Vec<Gain> = (0..3)
            .map(|k| {
                let rows = self.rows(k, runs);
                let (b, a) = (rms(before, rows.clone()), rms(after, rows.clone()));
                Gain {
                    quantity: NAMES[k].to_owned(),
                    holdout_rms_before: b,
                    holdout_rms_after: a,
                    reduction_percent: reduction_percent(b, a),
                    ci95: reduction_interval(&blocks, rows, before, after),
                }
            })
            .collect();
        let gain = gains.iter().find(|gain| gain.quantity == campaign.gain.quantity).unwrap_or(&gains[0]).clone();
        let unexplained = campaign.unexplained.as_ref().map(|unexplained| {
            let quantity = NAMES.iter().position(|name| *name == unexplained.quantity).unwrap_or(0);
            Unexplained { rms: rms(&outcome.after.residual, self.rows(quantity, runs)), ..unexplained.clone() }
        });
        Diagnosis {
            verdict: Verdict::new(!causes.is_empty(), unexplained.is_some()),
            wrong: self.wrong(campaign, runs),
            causes,
            unexplained,
            gain,
            gains,
            ..campaign.clone()
        }
    }

    /// Whether a mechanism reaches any of these runs.
    fn acts_on(&self, place: usize, runs: &[usize]) -> bool {
        match self.shape(place) {
            Shape::Day(_, day) => {
                runs.iter().any(|i| self.problem.days().of_run(self.problem.order()[*i]) == Some(*day))
            }
            _ => true,
        }
    }

    /// Where the baseline misses a hull's runs by more than their noise.
    fn wrong(&self, campaign: &Diagnosis, runs: &[usize]) -> Vec<Wrong> {
        let outcome = self.outcome;
        let independent = self.problem.independent_residuals(&outcome.before.residual, &outcome.after.sd);
        let mut found: Vec<Wrong> = campaign
            .wrong
            .iter()
            .filter_map(|wrong| {
                let quantity = NAMES.iter().position(|name| *name == wrong.quantity)?;
                let rows = self.rows(quantity, runs);
                let chi2: f64 = rows.iter().map(|row| independent[*row].powi(2)).sum();
                let p_value = ChiSquared::new(rows.len() as f64).map_or(1.0, |d| d.sf(chi2));
                let expected = rows.iter().map(|row| outcome.after.sd[*row].powi(2)).sum::<f64>() / rows.len() as f64;
                (p_value < SIGNIFICANT).then(|| Wrong {
                    rms: rms(&outcome.before.residual, rows.iter().copied()),
                    expected_rms: expected.sqrt(),
                    p_value: (p_value * campaign.wrong.len() as f64).min(1.0),
                    ..wrong.clone()
                })
            })
            .collect();
        found.sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
        found
    }

    /// A hull's coefficients beside its own mechanisms, where any were named.
    fn extended(&self, hull: usize, results: &HullResults) -> Option<ExtendedFit> {
        let own = |name: &str| {
            let place = (0..self.outcome.named.len()).find(|place| self.shape(*place).mechanism().name == name)?;
            self.evidence(place, hull).is_none_or(|(p, _)| p < SIGNIFICANT).then(|| self.sizes(place, Some(hull)))
        };
        let is_extended = !self.outcome.named.is_empty();
        let after = &self.outcome.after;
        let coefficient = |i: usize, unit: &str| {
            let place = 4 * hull + i;
            Estimate::normal(after.point.baseline[place], after.covariance[(place, place)].max(0.0).sqrt(), unit)
        };
        let size = |of: &Option<BTreeMap<String, Estimate>>, name: &str| {
            of.as_ref().and_then(|sizes| sizes.get(name).cloned())
        };
        let crossflow = own("crossflow");
        let moment = size(&crossflow, "crossflow_moment_per_rad2");
        let widest = results.sweep.points.iter().map(|point| point.yaw_deg.abs()).fold(0.0, f64::max);
        is_extended.then(|| ExtendedFit {
            fit: HullFit {
                range_deg: widest,
                a: coefficient(0, "1/rad"),
                b: coefficient(1, "1"),
                c: coefficient(2, "1/rad^2"),
                d: coefficient(3, "1/rad"),
            },
            nonlinear_lift_per_rad2: size(&crossflow, "crossflow_per_rad2"),
            // Counted as CM is; the mechanism's own counts away from the drift.
            nonlinear_moment_per_rad2: moment.map(|m| Estimate {
                value: -m.value,
                ci95: [-m.ci95[1], -m.ci95[0]],
                ..m
            }),
            drag_exponent: size(&own("reynolds_drag"), "drag_exponent"),
        })
    }
}

/// Which channel drifts, as a number with its legend for a unit: sizes are numbers in the JSON. The drift of a moment keeps
/// the name of that of a force, which readers know, and has a moment's unit.
fn tell_channel(sizes: &mut BTreeMap<String, Estimate>, channel: usize) {
    sizes.insert(CHANNEL.to_owned(), Estimate::normal(channel as f64 + 1.0, 0.0, "1 AF, 2 SF, 3 YM"));
    if channel == 2
        && let Some(drift) = sizes.get_mut("zero_drift_N_per_hour")
    {
        drift.unit = "N m/h".to_owned();
    }
}

/// The mean of what hulls show, with the errors that they share; where they differ by more than that, by their scatter.
fn mean(values: &[f64], covariance: &DMatrix<f64>, unit: &str) -> Estimate {
    let known: Vec<usize> = (0..values.len()).filter(|i| covariance[(*i, *i)] > 0.0).collect();
    if known.is_empty() {
        return Estimate::normal(values.first().copied().unwrap_or(0.0), 0.0, unit);
    }
    let weights: Vec<f64> = known.iter().map(|i| covariance[(*i, *i)].recip()).collect();
    let all: f64 = weights.iter().sum();
    let mean = known.iter().zip(&weights).map(|(i, weight)| weight * values[*i]).sum::<f64>() / all;
    let chi2: f64 = known.iter().zip(&weights).map(|(i, weight)| weight * (values[*i] - mean).powi(2)).sum();
    let scale = (chi2 / (known.len() as f64 - 1.0).max(1.0)).max(1.0);
    let pairs = (0..known.len()).flat_map(|i| (0..known.len()).map(move |j| (i, j)));
    let variance: f64 =
        pairs.map(|(i, j)| weights[i] * weights[j] * covariance[(known[i], known[j])]).sum::<f64>() / (all * all);
    Estimate::normal(mean, (scale * variance.max(0.0)).sqrt(), unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_drift_of_a_moment_has_a_moments_unit() {
        for (channel, unit) in [(0, "N/h"), (1, "N/h"), (2, "N m/h")] {
            let drift = Estimate::normal(1.5, 0.1, "N/h");
            let mut sizes = BTreeMap::from([("zero_drift_N_per_hour".to_owned(), drift)]);
            tell_channel(&mut sizes, channel);
            assert_eq!(sizes["zero_drift_N_per_hour"].unit, unit);
            assert_eq!(sizes[CHANNEL].value, channel as f64 + 1.0);
        }
    }
}
