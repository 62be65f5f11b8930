//! Mechanisms that do nearly all although something else is there as well: they are named, and what is left is reported.

use super::backward_elimination::LEAST_SPOILT_PERCENT;
use super::baseline::Baseline;
use super::evidence::Problem;
use super::findings::Why;
use super::fitted::Fitted;
use super::holdout;
use super::iteration::Iteration;

/// Share of the held-out squared error beyond the noise that a mechanism must remove: what is left of the error is half.
const NEARLY_ALL: f64 = 0.75;

/// Ratio of the error of the baseline to that of the measurement from which on a misfit is gross: the measurement's share of
/// its square is less than a quarter.
const GROSS: f64 = 2.0;

impl Fitted {
    /// Whether this one mechanism removes nearly all of a gross misfit on held-out data, on both halves of the data, and
    /// spoils no quantity.
    pub(super) fn does_nearly_all(&self, problem: &impl Problem, baseline: &Baseline) -> bool {
        let &[member] = self.included.as_slice() else { return false };
        let candidate = &problem.candidates()[member];
        // The mean of a level that varies is still a level; a law that needs another size elsewhere is another law.
        if !problem.is_level(member) || candidate.cannot_be(self.point.candidates[member][0]) {
            return false;
        }
        let on_both_halves = self.halves(problem, 0).iter().all(|half| half.found);
        let iteration = Iteration::new(problem.candidates(), self);
        on_both_halves && self.removes_nearly_all(baseline) && iteration.chance(&[], &[member]) <= problem.most_chance()
    }

    /// Where more mechanisms stand than are named: as many as are named, the weakest gone one by one, if those pass every test of the
    /// elimination and remove nearly all of a gross misfit on held-out data.
    pub(super) fn clearest(
        &self,
        problem: &impl Problem,
        baseline: &Baseline,
        dropped: &mut Vec<(usize, Why)>,
    ) -> Option<Fitted> {
        let mut clearest = self.clone();
        while clearest.included.len() > problem.max_causes() {
            let rises =
                (0..clearest.included.len()).map(|place| (clearest.rise_without(problem, baseline, place), place));
            let (_, weakest) = rises.min_by(|a, b| a.0.total_cmp(&b.0))?;
            clearest = clearest.without(problem, baseline, weakest);
        }
        let of_clearest = clearest.included.clone();
        clearest.eliminate_backward(problem, baseline, dropped);
        let stands = clearest.included == of_clearest && clearest.removes_nearly_all(baseline);
        stands.then_some(clearest)
    }

    /// Whether these mechanisms remove nearly all of a gross misfit on held-out data, and spoil no quantity.
    pub(super) fn removes_nearly_all(&self, baseline: &Fitted) -> bool {
        let (before, after) = (baseline.held_out(), self.held_out());
        let rms = |values, quantity: usize| holdout::rms(values, self.evidence.quantities[quantity].rows.clone());
        // What the baseline takes for noise holds a part of its misfit: the measurement's own is known beside the mechanism.
        let noise = |quantity: usize| {
            self.expected_rms(&self.noises, quantity).min(self.expected_rms(&baseline.noises, quantity))
        };
        let quantities = 0..self.evidence.quantities.len();
        let is_gross = quantities.clone().any(|q| rms(&before, q) > GROSS * noise(q));
        // Squares in units of the noise, over all quantities.
        let excess = |values| -> f64 {
            let of = |q: usize| {
                let n = self.evidence.quantities[q].rows.len() as f64;
                n * ((rms(values, q) / noise(q)).powi(2) - 1.0)
            };
            quantities.clone().map(of).sum()
        };
        let most = 1.0 + LEAST_SPOILT_PERCENT / 100.0;
        let spoils = quantities.clone().any(|q| rms(&after, q) > most * rms(&before, q).max(noise(q)));
        is_gross && !spoils && excess(&after) < (1.0 - NEARLY_ALL) * excess(&before)
    }
}
