//! Whether a log is diagnosed with inertia or without. Knows the problem and the engine.
//!
//! A real glider has inertia. A log that was simulated from steady glides has none, and a baseline that had it would miss
//! every sharp thermocline, or take a lag for a cause.

use nalgebra::DVector;

use super::SeaProblem;
use crate::diagnose::engine::Start;
use crate::diagnose::evidence::{Point, Problem};
use crate::diagnose::findings::Verdict;
use crate::diagnose::relevance::SHARE_OF_SCATTER;
use crate::diagnose::{Outcome, engine, holdout};

/// Fall of the error of held-out glides \[%\] below which a log is not said to follow a glide without inertia: what a tenth of the scatter
/// adds in quadrature, as of any misfit that is not worth acting on.
const NO_INERTIA_PERCENT: f64 = 50.0 * SHARE_OF_SCATTER * SHARE_OF_SCATTER;

/// Diagnoses a problem with inertia, or without where that is the better account of held-out glides.
///
/// It is tried without where that predicts better by what is relevant for certain (97.5 % by resampled legs), alone or beside the causes
/// that were found. It is taken where it leaves nothing unexplained and does so against the same causes with inertia; or where it does so
/// against those that are found with inertia, or predicts no worse than these with fewer.
pub(super) fn diagnose(problem: SeaProblem) -> (SeaProblem, Outcome) {
    let steady = problem.without_inertia();
    let is_better_alone = {
        let alone = |problem: &SeaProblem| engine::held_out(problem, &problem.start(), &[]);
        let (with, without) = rayon::join(|| alone(&problem), || alone(&steady));
        problem.gain(&with, &without)[0] > NO_INERTIA_PERCENT
    };
    let with_inertia = || engine::diagnose_in_full(&problem);
    let (of_steady, outcome) = if is_better_alone {
        // Most often both are needed, and half of each runs on one core alone.
        let (found, outcome) = rayon::join(|| engine::diagnose_in_full(&steady), with_inertia);
        let explains_all = matches!(found.diagnosis.verdict, Verdict::None | Verdict::Explained);
        let same_causes = || engine::held_out(&problem, &problem.with_all_inertia(&found.after.point), &found.fitted);
        if explains_all && problem.gain(&same_causes(), &found.after.held_out)[0] > NO_INERTIA_PERCENT {
            return (steady, found);
        }
        (Some(found), outcome)
    } else {
        (None, with_inertia())
    };
    let from_there = || {
        let [baseline, point] = [&outcome.before, &outcome.after].map(|stage| problem.without_share(&stage.point));
        let beside = engine::held_out(&steady, &point, &outcome.fitted);
        let is_better = problem.gain(&outcome.after.held_out, &beside)[0] > NO_INERTIA_PERCENT;
        let start = Start { baseline, point, included: outcome.fitted.clone() };
        is_better.then(|| engine::diagnose_again(&steady, &outcome, || start))
    };
    let Some(found) = of_steady.or_else(from_there) else { return (problem, outcome) };
    let [least, most] = problem.gain(&outcome.after.held_out, &found.after.held_out);
    let is_better = least > NO_INERTIA_PERCENT || (most > 0.0 && found.fitted.len() < outcome.fitted.len());
    if is_better { (steady, found) } else { (problem, outcome) }
}

impl SeaProblem {
    /// The same problem without inertia.
    fn without_inertia(&self) -> SeaProblem {
        let mut steady = SeaProblem { parts: self.parts.without_inertia(), ..self.clone() };
        steady.baseline.truncate(self.place_of_inertia());
        steady
    }

    /// A point of this problem with all of the inertia, from one without.
    fn with_all_inertia(&self, steady: &Point) -> Point {
        let mut point = steady.clone();
        point.baseline.extend(&self.start().baseline[self.place_of_inertia()..]);
        point
    }

    /// A point without the shares of the inertia.
    fn without_share(&self, point: &Point) -> Point {
        let mut steady = point.clone();
        steady.baseline.truncate(self.place_of_inertia());
        steady
    }

    /// By how much the error of held-out vertical velocity falls from one set of residuals to another \[%\], the 95 % interval.
    fn gain(&self, before: &DVector<f64>, after: &DVector<f64>) -> [f64; 2] {
        let block: Vec<usize> = self.bins.iter().map(|bin| bin.mean.leg as usize).collect();
        holdout::reduction_interval(&block, 0..self.bins.len(), before, after)
    }
}
