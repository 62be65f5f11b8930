//! The four answers in their order: wrong, cause, extension, gain.
//!
//! Fit and search alternate: around the best fit of the present set every set is tried on the linearised model, the
//! chosen one is fitted again in full, until the choice stands.

use nalgebra::DVector;
use rayon::prelude::*;

use super::baseline::Baseline;
use super::change_point;
use super::estimate::Estimate;
use super::evidence::{Point, Problem, Quantity};
use super::findings::{Diagnosis, Verdict, Why, Wrong};
use super::fitted::{Fitted, LEAST_FALL, weighted_squares};
use super::holdout;
use super::iteration::Iteration;
use super::outcome::{Outcome, Stage};
use super::replacements::{Far, in_place_of, likelier};
use super::report::{report, wrong};
use super::score::SIGNIFICANT;
use super::subset_search::{Choice, MARGIN};

/// Alternations of fit and search.
const MAX_ROUNDS: usize = 6;

/// Share of what the best curve explains that few parameters with a name must reach to keep it: what a rigid law explains
/// but for a twentieth is that law, imperfectly written down, and the rest is reported as unexplained.
const FULL_SHARE: f64 = 0.95;

/// The diagnosis of a problem, and the point of the extended model.
pub fn diagnose(problem: &impl Problem) -> (Diagnosis, Point) {
    let outcome = diagnose_in_full(problem);
    (outcome.diagnosis, outcome.after.point)
}

/// The diagnosis of a problem with what it rests on.
pub fn diagnose_in_full(problem: &impl Problem) -> Outcome {
    let baseline = Baseline::new(problem);
    // A mechanism alone in full first: far from the truth the model bends, and slopes mislead.
    let single = baseline.nonlinear_refit(problem);
    let present = single.clone().unwrap_or_else(|| Fitted::clone(&baseline));
    search_from(problem, baseline, single, present, Far::Asked)
}

/// What was found in the same data by a problem that differs little, as in the versions of its mechanisms: where a search may begin.
pub struct Start {
    /// The point of the baseline alone.
    pub baseline: Point,
    /// The point with what was named.
    pub point: Point,
    /// What was named.
    pub included: Vec<usize>,
}

/// The same beside what was found before. Where that explained all the search begins there; where something was left it is begun anew,
/// since what was not found there may be hidden.
pub fn diagnose_again(problem: &impl Problem, found: &Outcome, start: impl FnOnce() -> Start) -> Outcome {
    if found.diagnosis.verdict != Verdict::Explained {
        return diagnose_in_full(problem);
    }
    let start = start();
    let baseline = Baseline::of(Fitted::converged(problem, start.baseline, Vec::new()));
    let present = Fitted::converged(problem, start.point, start.included);
    let single = (present.included.len() == 1).then(|| present.clone());
    // Versions a little apart are no nearer to a law of which slopes say nothing.
    search_from(problem, baseline, single, present, Far::AskedBefore)
}

/// The mechanisms that the slopes would choose where a search begins.
pub fn chosen_by_slopes(problem: &impl Problem, start: Start) -> Vec<usize> {
    let present = Fitted::converged(problem, start.point, start.included);
    Iteration::new(problem.candidates(), &present).search().best_mechanisms().members
}

/// A start with each mechanism in its likeliest version, all else fitted with it, and the value in which the versions of each differ.
pub fn in_likeliest_versions(problem: &impl Problem, start: Start) -> (Start, Vec<Option<Estimate>>) {
    let candidates = problem.candidates();
    let mut present = Fitted::converged(problem, start.point, start.included);
    present.alternate(problem, |iteration| (iteration.search().in_best_versions(&iteration.fitted.included), None));
    let iteration = Iteration::new(candidates, &present);
    let value = |place: usize| {
        let version = candidates[present.included[place]].version?;
        change_point::estimates(problem, &iteration, &present.included, place, &present.point).remove(version.name)
    };
    let values = (0..present.included.len()).map(value).collect();
    (Start { baseline: start.baseline, point: present.point, included: present.included }, values)
}

/// Searches from a set on, and tests what is found. `single` is a mechanism that was fitted alone in full.
fn search_from(
    problem: &impl Problem,
    baseline: Baseline,
    single: Option<Fitted>,
    mut present: Fitted,
    far: Far,
) -> Outcome {
    let candidates = problem.candidates();
    // Mechanisms without curves: a curve would take up what the slopes miss. Once they have done what they can, what is left decides
    // whether a curve was needed after all.
    present.alternate(problem, |iteration| (iteration.search().best_mechanisms().members, None));
    let curve = present.alternate(problem, |iteration| {
        decide(iteration.search().best_mechanisms(), iteration.search().best_with_curve(), iteration, problem)
    });
    let mut dropped = Vec::new();
    let found = present.clone();
    let mut refuted = present.eliminate_backward(problem, &baseline, &mut dropped);
    // What was found first may be refused for what it is not, and the law that it resembles stand in its place.
    if let Some((standing, of_standing)) = found.stands_with_another(problem, &baseline, &mut dropped) {
        (present, refuted) = (standing, of_standing);
    }
    // Several laws that fit together may not predict together, or have sizes that nature does not have; a curve may resemble a law that
    // the slopes hide. Where nothing stands, one law fitted in full may.
    if present.included.is_empty() && (found.included.len() > 1 || baseline.may_miss_something(problem)) {
        let (alone, of_alone) = baseline.stands_alone(problem, &mut dropped);
        refuted = refuted.or(of_alone);
        present = alone.unwrap_or(present);
    }
    // What was found in full, alone, stands where the slopes' choice does no better: in the place of one of its mechanisms,
    // or of them all where backward elimination left no more than one.
    for mut rival in single.iter().flat_map(|single| present.rivals(single, problem)) {
        let of_rival = rival.eliminate_backward(problem, &baseline, &mut dropped);
        if !rival.included.is_empty() {
            (present, refuted) = (rival, of_rival);
            break;
        }
    }
    let refused = (present.included != found.included).then_some(&found);
    if let Some((likelier, of_likelier)) = present.likelier_that_stands(problem, &baseline, refused, far, &mut dropped)
    {
        (present, refuted) = (likelier, refuted.or(of_likelier));
    }
    if let Some(better) = present.better_alone(problem, &baseline, &mut dropped) {
        present = better;
    }
    let mut is_part = false;
    if present.included.len() > problem.max_causes() {
        let clearest = present.clearest(problem, &baseline, &mut dropped);
        let kept = clearest.as_ref().map_or(&[][..], |clearest| &clearest.included);
        dropped.retain(|(member, _)| !kept.contains(member));
        let gone = present.included.iter().filter(|member| !kept.contains(member));
        dropped.extend(gone.map(|member| (*member, Why::Equivalent)));
        let iteration = Iteration::new(candidates, &present);
        let curve = iteration.most_explaining_curve().and_then(|curve| iteration.curve_name(curve)).map(str::to_owned);
        is_part = clearest.is_some();
        (present, refuted) = (clearest.unwrap_or_else(|| Fitted::clone(&baseline)), refuted.or(curve));
    }
    // Where nothing deserves its name alone, one mechanism may still do nearly all, if it is large enough to act on.
    let is_relevant = |single: &Fitted| {
        let mut kept = single.clone();
        kept.drop_what_is_irrelevant(problem, &baseline);
        !kept.included.is_empty()
    };
    if let Some(part) = single.filter(|single| {
        present.included.is_empty() && single.does_nearly_all(problem, &baseline) && is_relevant(single)
    }) {
        (present, is_part) = (part, true);
        dropped.retain(|(member, _)| !present.included.contains(member));
    }
    // Where no name is left the noise is that of the baseline, by which it is said to be wrong or not.
    if present.included.is_empty() {
        present = Fitted::clone(&baseline);
    }
    let iteration = Iteration::new(candidates, &present);
    let limits = present.limits(problem);
    // What was refuted on the way is worth a word only where something remains that is.
    let curve = curve
        .or(refuted)
        .filter(|_| is_part || iteration.is_anything_wrong(&present.included, &limits))
        .or_else(|| iteration.unnamed_curve(&present.included, &limits));
    report(problem, &baseline, &present, curve, &dropped, None)
}

/// The baseline alone, and where it misses the data.
pub fn baseline(problem: &impl Problem) -> (Stage, Vec<Wrong>) {
    let baseline = Fitted::baseline(problem);
    let wrong = wrong(problem, &baseline);
    (baseline.stage(baseline.held_out()), wrong)
}

/// A baseline fitted with other beliefs about its parameters, beside that of a problem with the same data.
pub struct Believed {
    /// Where it was fitted.
    pub point: Point,
    /// By how much it is the less likely one: minus twice the logarithm of the ratio of likelihoods, with the noise of the other.
    pub deviance: f64,
    /// Whether what the two predict differs by enough to act on, in any quantity.
    pub differs: bool,
}

/// The baseline of a problem fitted with each of these other beliefs, beside its own.
pub fn believed<P: Problem>(problem: &P, others: &[P]) -> Vec<Believed> {
    let own = Fitted::baseline(problem);
    let limits = own.limits(problem);
    let squares = |fitted: &Fitted| weighted_squares(&fitted.evidence, &own.noises);
    let beside = |other: &P| {
        let fitted = Fitted::baseline(other);
        let difference = &fitted.evidence.residual - &own.evidence.residual;
        let differs = |(quantity, limit): (&Quantity, &f64)| holdout::rms(&difference, quantity.rows.clone()) > *limit;
        Believed {
            deviance: squares(&fitted) - squares(&own),
            differs: own.evidence.quantities.iter().zip(&limits).any(differs),
            point: fitted.point,
        }
    };
    others.par_iter().map(beside).collect()
}

/// What is said where these candidates are decided upon, beside a curve along this covariate that no name explains; fitted from this
/// point on. A `nuisance` among them says nothing of what is wrong.
pub fn decided(
    problem: &impl Problem,
    point: &Point,
    included: &[usize],
    nuisance: Option<usize>,
    curve: Option<String>,
) -> Outcome {
    let baseline = Baseline::new(problem);
    let present = Fitted::converged(problem, point.clone(), included.to_vec());
    report(problem, &baseline, &present, curve, &[], nuisance)
}

/// What is left of held-out rows where these candidates are fitted from this point on.
pub fn held_out(problem: &impl Problem, point: &Point, included: &[usize]) -> DVector<f64> {
    Fitted::converged(problem, point.clone(), included.to_vec()).held_out()
}

/// Whether any of these candidates stands, all of them fitted from this point on.
pub fn is_any_standing(problem: &impl Problem, point: &Point, included: &[usize]) -> bool {
    let baseline = Baseline::new(problem);
    let mut present = Fitted::converged(problem, point.clone(), included.to_vec());
    present.eliminate_backward(problem, &baseline, &mut Vec::new());
    !present.included.is_empty()
}

/// Whether the curve in a choice is there beside its mechanisms, and large enough to act on.
fn is_wrong(choice: &Choice, iteration: &Iteration<'_>, problem: &impl Problem) -> bool {
    let limits = iteration.fitted.limits(problem);
    let (curves, others): (Vec<usize>, Vec<usize>) =
        choice.members.iter().partition(|member| iteration.regressors[**member].is_curve);
    curves.iter().all(|curve| iteration.is_wrong(&others, *curve, &limits, SIGNIFICANT))
}

/// Mechanisms alone, or what is left of them beside a curve that none of them can replace.
fn decide(
    mechanisms: Choice,
    with_curve: Option<Choice>,
    iteration: &Iteration<'_>,
    problem: &impl Problem,
) -> (Vec<usize>, Option<String>) {
    match with_curve {
        Some(other)
            if other.criterion
                < mechanisms.criterion.min(0.0) - MARGIN.max(problem.part_unexplained() * -mechanisms.criterion)
                && iteration.predicts_better(&other.members, &mechanisms.members)
                && is_wrong(&other, iteration, problem) =>
        {
            // Beside something unknown a name needs evidence that the unknown cannot take over, and more of it than the
            // unknown has itself: what is unknown may bring along a bit of many a mechanism.
            let search = iteration.search();
            let mut members = other.members.clone();
            if search.gain(&mechanisms.members) > FULL_SHARE * search.gain(&members)
                && let Some(curve) = iteration.best_curve(&mechanisms.members)
            {
                members = mechanisms.members;
                members.push(curve);
            }
            let lost_without = |members: &[usize], place: usize| {
                let mut fewer = members.to_vec();
                fewer.remove(place);
                search.criterion(&fewer) - search.criterion(members)
            };
            while let Some(curve) = members.iter().position(|member| iteration.regressors[*member].is_curve) {
                let needed = MARGIN.max(lost_without(&members, curve));
                let weak = (0..members.len()).find(|place| *place != curve && lost_without(&members, *place) < needed);
                match weak {
                    Some(place) => members.remove(place),
                    None => break,
                };
            }
            let (curves, named): (Vec<usize>, Vec<usize>) =
                members.iter().partition(|member| iteration.regressors[**member].is_curve);
            (named, curves.first().and_then(|curve| iteration.curve_name(*curve)).map(str::to_owned))
        }
        _ => (mechanisms.members, None),
    }
}

impl Fitted {
    /// Whether a misfit may be left that is large enough to act on.
    pub(super) fn may_miss_something(&self, problem: &impl Problem) -> bool {
        Iteration::new(problem.candidates(), self).may_be_wrong(&self.included, &self.limits(problem), SIGNIFICANT)
    }

    /// Whether a misfit is left that is clear and large enough to act on.
    pub(super) fn misses_something(&self, problem: &impl Problem) -> bool {
        Iteration::new(problem.candidates(), self).is_anything_wrong(&self.included, &self.limits(problem))
    }

    /// This set with one of its refused members exchanged for a mechanism that predicts as well, if then all of them stand; with
    /// the covariate of what was refuted on the way.
    fn stands_with_another(
        &self,
        problem: &impl Problem,
        baseline: &Baseline,
        dropped: &mut Vec<(usize, Why)>,
    ) -> Option<(Fitted, Option<String>)> {
        let is_gone_for =
            |member: &usize, whys: &[Why]| dropped.iter().any(|(gone, why)| gone == member && whys.contains(why));
        // What chance or no gain on held-out data took out has no place to be filled.
        let mut asked = self.clone();
        let says_nothing = [Why::ByChance, Why::HardlyKnown, Why::PredictsNoBetter];
        while let Some(place) = asked.included.iter().position(|member| is_gone_for(member, &says_nothing)) {
            asked = asked.without(problem, baseline, place);
        }
        let is_refused = |member: &usize| {
            !problem.is_tested(*member)
                || is_gone_for(member, &[Why::SizeVaries, Why::SizeImpossible, Why::SpoilsQuantity])
        };
        let refused: Vec<usize> =
            (0..asked.included.len()).filter(|place| is_refused(&asked.included[*place])).collect();
        let others = refused.into_iter().flat_map(|place| in_place_of(problem, baseline, &asked, place));
        others.into_iter().find_map(|mut other| {
            let asked = other.included.len();
            let refuted = other.eliminate_backward(problem, baseline, dropped);
            (other.included.len() == asked).then_some((other, refuted))
        })
    }

    /// The likeliest set with one member exchanged, if it is likelier than this one and all of its members stand. A set that was `refused`
    /// before is not asked again, unless it is likelier now.
    fn likelier_that_stands(
        &self,
        problem: &impl Problem,
        baseline: &Baseline,
        refused: Option<&Fitted>,
        far: Far,
        dropped: &mut Vec<(usize, Why)>,
    ) -> Option<(Fitted, Option<String>)> {
        let is_refused = |other: &Fitted| {
            refused.is_some_and(|set| set.included == other.included && other.deviance_above(set) > -LEAST_FALL)
        };
        let mut likelier = likelier(problem, baseline, self, far).into_iter().filter(|other| !is_refused(other));
        let (other, refuted, of_other) = likelier.find_map(|mut other| {
            let (members, mut of_other) = (other.included.len(), dropped.clone());
            let refuted = other.eliminate_backward(problem, baseline, &mut of_other);
            (other.included.len() == members).then_some((other, refuted, of_other))
        })?;
        *dropped = of_other;
        dropped.retain(|(member, _)| !other.included.contains(member));
        let gone = self.included.iter().filter(|member| !other.included.contains(member));
        dropped.extend(gone.map(|member| (*member, Why::Equivalent)));
        Some((other, refuted))
    }

    /// Alternates between the choice of a set and its fit until the choice stands; returns the curve that goes with it. The slopes at one
    /// set may lead to another that is far less likely once it is fitted, and on from there. Then the likeliest on the way is taken.
    fn alternate(
        &mut self,
        problem: &impl Problem,
        choose: impl Fn(&Iteration<'_>) -> (Vec<usize>, Option<String>),
    ) -> Option<String> {
        let mut tried = vec![self.included.clone()];
        let mut curve = None;
        let mut likeliest = self.clone();
        // By how much the likeliest is likelier than what is here, what each costs counted.
        let mut ahead = 0.0;
        for _ in 0..MAX_ROUNDS {
            let iteration = Iteration::new(problem.candidates(), self);
            let (members, found) = choose(&iteration);
            curve = found;
            if members == self.included {
                break;
            }
            let next = self.with_members(problem, &iteration, members.clone());
            ahead = next.deviance_above(&likeliest) + iteration.search().cost_above(&members, &likeliest.included);
            *self = next;
            if ahead < 0.0 && curve.is_none() {
                likeliest = self.clone();
            }
            if tried.contains(&members) {
                break;
            }
            tried.push(members);
        }
        // What stands beside a curve need not explain what the curve does.
        if ahead > MARGIN && curve.is_none() {
            *self = likeliest;
        }
        curve
    }
}
