//! One mechanism that stands alone, fitted in full whatever the slopes say of it. Decides nothing where several stand.

use rayon::prelude::*;

use super::baseline::Baseline;
use super::evidence::Problem;
use super::findings::Why;
use super::fitted::Fitted;
use super::iteration::Iteration;
use super::replacements::{REFITTED_SHARE, REFITTED_WITHIN, first_versions};
use super::subset_search::MARGIN;

impl Baseline {
    /// The likeliest mechanism that stands alone, each fitted whatever the slopes here say of it; with the covariate of what was refuted
    /// on the way. Of many that are tried one may fit by chance: it must leave nothing that may be wrong, or remove nearly all of a gross
    /// misfit; one that is clearly less likely than another must remove that.
    pub(super) fn stands_alone(
        &self,
        problem: &impl Problem,
        dropped: &mut Vec<(usize, Why)>,
    ) -> (Option<Fitted>, Option<String>) {
        let candidates = problem.candidates();
        let iteration = Iteration::new(candidates, self);
        let search = iteration.search();
        // Of the versions of a mechanism the best by the slopes stands for all.
        let mut singles: Vec<usize> = (0..candidates.len()).collect();
        singles.sort_by(|a, b| search.criterion(&[*a]).total_cmp(&search.criterion(&[*b])));
        let singles = first_versions(candidates, singles, None);
        let less_likely = |alone: &Fitted| alone.deviance_above(self) + search.cost(alone.included[0]);
        let quicker = problem.for_first_search(&self.point);
        let quickly = |member: usize| {
            let first = quicker.as_ref().filter(|_| !problem.is_held_in_first_search(member)).unwrap_or(problem);
            let alone = self.with_one(first, &iteration, member);
            (less_likely(&alone), alone)
        };
        let quickly: Vec<(f64, Fitted)> = singles.into_par_iter().map(quickly).collect();
        // A quick fit is nearer to the full one than the slopes at another law are: what is refitted there is near enough here.
        let least = quickly.iter().map(|(less_likely, _)| *less_likely).fold(f64::INFINITY, f64::min);
        let near = least + REFITTED_WITHIN.max(REFITTED_SHARE * -least);
        let is_promising = |(less_likely, alone): &(f64, Fitted)| *less_likely < near || alone.removes_nearly_all(self);
        let in_full = |(_, quickly): (f64, Fitted)| {
            let alone = Fitted::converged(problem, quickly.point, quickly.included);
            alone.is_possible(candidates).then(|| (less_likely(&alone), alone))
        };
        let mut fitted: Vec<(f64, Fitted)> = quickly.into_par_iter().filter(is_promising).filter_map(in_full).collect();
        fitted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let likeliest = fitted.first().map_or(0.0, |(less_likely, _)| *less_likely);
        let mut refuted = None;
        // What explains less than its cost says nothing.
        for (less_likely, mut alone) in fitted.into_iter().take_while(|(less_likely, _)| *less_likely < 0.0) {
            let of_alone = alone.eliminate_backward(problem, self, dropped);
            refuted = refuted.or(of_alone);
            let is_likeliest = less_likely < likeliest + MARGIN;
            let explains_all = || is_likeliest && !alone.may_miss_something(problem);
            if !alone.included.is_empty() && (explains_all() || alone.removes_nearly_all(self)) {
                dropped.retain(|(member, _)| !alone.included.contains(member));
                return (Some(alone), refuted);
            }
        }
        (None, refuted)
    }
}

impl Fitted {
    /// The mechanism that stands alone and leaves nothing wrong, where this set leaves something, is less likely and predicts no better:
    /// what stands may resemble a law of which the slopes at it say nothing.
    pub(super) fn better_alone(
        &self,
        problem: &impl Problem,
        baseline: &Baseline,
        dropped: &mut Vec<(usize, Why)>,
    ) -> Option<Fitted> {
        if self.included.is_empty() || !self.misses_something(problem) {
            return None;
        }
        let mut of_alone = dropped.clone();
        let (alone, _) = baseline.stands_alone(problem, &mut of_alone);
        let is_better = |alone: &Fitted| {
            alone.included != self.included
                && !alone.misses_something(problem)
                && alone.deviance_above(self) < 0.0
                && alone.held_out_misfit() <= self.held_out_misfit()
        };
        let alone = alone.filter(is_better)?;
        *dropped = of_alone;
        let gone = self.included.iter().filter(|member| !alone.included.contains(member));
        dropped.extend(gone.map(|member| (*member, Why::Equivalent)));
        Some(alone)
    }
}
