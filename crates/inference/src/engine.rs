//! The four answers in their order: wrong, cause, extension, gain.
//!
//! Fit and search alternate: around the best fit of the present set every set is tried on the linearised model, the
//! chosen one is fitted again in full, until the choice stands.

use nalgebra::{DMatrix, DVector};

use super::evidence::{Evidence, Point, Problem};
use super::findings::{Diagnosis, Gain, Wrong};
use super::fitted::Fitted;
use super::holdout;
use super::lap::Lap;
use super::search::Choice;
use super::told::{report, wrong};

/// By how much a curve without a name must be better before it keeps a mechanism from being named, and how much worse
/// a mechanism may be and still count as a stand-in: a factor of 20 in evidence.
pub(super) const MARGIN: f64 = 6.0;

/// Share of what the best curve explains that few parameters with a name must reach to keep it: what a rigid law explains
/// but for a twentieth is that law, imperfectly written down, and the rest is told as unexplained.
const FULL_SHARE: f64 = 0.95;

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
    let mut refuted = present.thin_out(problem, &baseline);
    // What was found in full, alone, stands where the slopes' choice does no better: in the place of one of its mechanisms,
    // or of them all where it was thinned out to no more than one.
    for mut rival in single.iter().flat_map(|single| present.rivals(single, problem)) {
        let of_rival = rival.thin_out(problem, &baseline);
        if !rival.included.is_empty() {
            (present, refuted) = (rival, of_rival);
            break;
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
                < mechanisms.criterion.min(0.0) - MARGIN.max(problem.part_unexplained() * -mechanisms.criterion)
                && lap.foretells(&other.members, &mechanisms.members) =>
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
