//! The noise of each quantity of a fit: what it leaves, less what candidates that are not in it could explain.
//!
//! What no mechanism of the fit explains yet must not count as noise, or it would hide itself. So the likelihood of the noise is asked with
//! the sensitivities to all candidates projected out, some thirty columns beside those of the fit. Of few legs these take up most of what
//! lasts in the water, and what is left seems smaller and shorter than it is. With the columns of the fit alone projected out a noise is
//! better known. It is taken where both are true:
//!
//! - The likelihood with all candidates set aside does not refute it: it lies below its maximum by no more than what the two numbers of a
//!   process cost (Akaike 1974).
//! - No candidate is worth its cost (the extended Bayesian criterion): the one that explains most by the first noise is not by the
//!   noise that is estimated with it in the fit.
//!
//! Fits nothing.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::covariance::side_by_side;
use super::evidence::{Evidence, Problem, Quantity, names};
use super::score::Score;
use super::subset_search::cost;
use crate::noise::{Lasting, Noise};
use crate::restricted_likelihood::RestrictedLikelihood;

/// Versions of one mechanism that are set aside: many jumps together would take all that is slow out of the noise.
const MOST_VERSIONS: usize = 3;

/// By how much the logarithm of the likelihood of a noise may lie below its maximum: two numbers (Akaike 1974).
const TWO_NUMBERS: f64 = 2.0;

/// A candidate that explains so many times its cost is worth it by either noise. To save time the second is not estimated then.
const CERTAINLY_WORTH: f64 = 10.0;

/// The least noise as a share of what is worth acting on where readings have no scatter: in worlds without noise 0.03 to 0.3 mm/s are left
/// where 1 mm/s is worth acting on.
const LEAST_OF_RELEVANT: f64 = 0.1;

/// The noise of each quantity of a fit with these candidates, all others set aside.
pub(super) fn with_all_aside(problem: &impl Problem, evidence: &Evidence, included: &[usize]) -> Vec<Noise> {
    let fit = Fit { problem, evidence, included };
    let of_fit = fit.side_by_side(included);
    let likelihoods = fit.likelihoods(&of_fit).zip(&evidence.quantities);
    likelihoods.map(|(likelihood, quantity)| fit.no_less(quantity, likelihood.most_likely(problem.lasting()))).collect()
}

/// The better known noise of each quantity where it is as good; `all_aside` is that with all others set aside.
pub(super) fn with_none_worth_its_cost(
    problem: &impl Problem,
    evidence: &Evidence,
    included: &[usize],
    all_aside: &[Noise],
) -> Vec<Noise> {
    if problem.lasting() == Lasting::White {
        return all_aside.to_vec();
    }
    let fit = Fit { problem, evidence, included };
    let of_fit = fit.side_by_side(included);
    let others = Others::new(&fit, &of_fit);
    let best = others.worth_most(all_aside).filter(|best| best.gain < CERTAINLY_WORTH * best.cost);
    let Some(best) = best else { return all_aside.to_vec() };
    let likelihoods: Vec<RestrictedLikelihood> = fit.likelihoods(&of_fit).collect();
    // The noise of each quantity with these columns alone projected out, where it is not refuted.
    let with_alone = |columns: &DMatrix<f64>| -> Vec<Noise> {
        let of_quantity = |((quantity, likelihood), all_aside): ((&Quantity, &RestrictedLikelihood), &Noise)| {
            let alone = fit.likelihood(quantity, columns).most_likely_joined_as(problem.lasting(), all_aside);
            let alone = fit.no_less(quantity, alone);
            let [alone_is, most] = [&alone, all_aside].map(|noise| likelihood.log_likelihood(noise));
            let is_refuted = alone_is.zip(most).is_none_or(|(alone_is, most)| alone_is < most - TWO_NUMBERS);
            if is_refuted { *all_aside } else { alone }
        };
        evidence.quantities.iter().zip(&likelihoods).zip(all_aside).map(of_quantity).collect()
    };
    let alone = with_alone(&of_fit);
    if alone == all_aside || best.gain < best.cost {
        return alone;
    }
    let with_best = side_by_side(evidence.residual.len(), &[&of_fit, &evidence.candidates[best.candidate]]);
    let beside_best = with_alone(&with_best);
    if others.gain(&beside_best, &best) < best.cost { alone } else { all_aside.to_vec() }
}

/// A fit of some candidates.
struct Fit<'a, P> {
    problem: &'a P,
    evidence: &'a Evidence,
    included: &'a [usize],
}

impl<'a, P: Problem> Fit<'a, P> {
    /// The columns of the baseline and of these candidates.
    fn side_by_side(&self, candidates: &[usize]) -> DMatrix<f64> {
        let of_candidates = candidates.iter().map(|candidate| &self.evidence.candidates[*candidate]);
        let parts: Vec<&DMatrix<f64>> = std::iter::once(&self.evidence.baseline).chain(of_candidates).collect();
        side_by_side(self.evidence.residual.len(), &parts)
    }

    /// The candidates that are set aside: of each mechanism a few versions.
    fn set_aside(&self) -> Vec<usize> {
        let candidates = self.problem.candidates();
        let of_name = |name: &'static str| {
            let versions: Vec<usize> = (0..candidates.len()).filter(|i| candidates[*i].name == name).collect();
            let every = versions.len().div_ceil(MOST_VERSIONS);
            versions.into_iter().skip(every / 2).step_by(every).filter(|i| !self.included.contains(i))
        };
        names(candidates).into_iter().flat_map(of_name).collect()
    }

    /// The likelihood of the noise of each quantity, all others set aside. Where rows are few a quantity has no noise of its own then, and
    /// the columns of the fit alone are.
    fn likelihoods(&self, of_fit: &DMatrix<f64>) -> impl Iterator<Item = RestrictedLikelihood<'a>> {
        let with_all = self.side_by_side(&[self.included, &self.set_aside()].concat());
        self.evidence.quantities.iter().map(move |quantity| {
            let explained = if self.has_rows_for(&with_all, quantity) { &with_all } else { of_fit };
            self.likelihood(quantity, explained)
        })
    }

    /// A noise that is no less than the equations are right to. Against less, rows without noise would show the smallest of their errors,
    /// and what is believed would hold no parameter that they hardly show.
    fn no_less(&self, quantity: &Quantity, mut noise: Noise) -> Noise {
        let rows = quantity.rows.clone();
        let stated =
            self.evidence.stated_sd[rows.clone()].iter().map(|sd| sd * sd).sum::<f64>() / rows.len().max(1) as f64;
        let slow: f64 = noise.slow.iter().map(|slow| slow.variance).sum();
        let least = (LEAST_OF_RELEVANT * self.problem.relevance(quantity, 0.0)).powi(2);
        let lacking = least - noise.white * stated - slow;
        if lacking > 0.0 && stated > 0.0 {
            noise.white += lacking / stated;
        }
        noise
    }

    fn has_rows_for(&self, columns: &DMatrix<f64>, quantity: &Quantity) -> bool {
        let rows = quantity.rows.clone();
        let reaching = columns.column_iter().filter(|column| column.rows(rows.start, rows.len()).amax() > 0.0).count();
        rows.len() as f64 > self.problem.rows_per_column() * reaching as f64
    }

    fn likelihood(&self, quantity: &Quantity, explained: &DMatrix<f64>) -> RestrictedLikelihood<'a> {
        let rows = quantity.rows.clone();
        let residual: DVector<f64> = self.evidence.residual.rows(rows.start, rows.len()).into_owned();
        let explained = explained.rows(rows.start, rows.len()).into_owned();
        let known_to = self.problem.stated_variance_known_to();
        RestrictedLikelihood::new(self.evidence.series(quantity), known_to, &residual, &explained)
    }
}

/// The candidates of other mechanisms than those of a fit.
struct Others<'a> {
    evidence: &'a Evidence,
    of_fit: &'a DMatrix<f64>,
    columns: DMatrix<f64>,
    /// What is believed of each column.
    prior: Vec<(f64, f64)>,
    /// Each with its columns and the number of its versions.
    members: Vec<(usize, Range<usize>, usize)>,
    /// Mechanisms among which one is chosen.
    among: usize,
}

/// What a candidate explains beside a fit, in units of the noise, and what it costs.
struct Worth {
    candidate: usize,
    columns: Range<usize>,
    gain: f64,
    cost: f64,
}

impl<'a> Others<'a> {
    fn new<P: Problem>(fit: &Fit<'a, P>, of_fit: &'a DMatrix<f64>) -> Others<'a> {
        let candidates = fit.problem.candidates();
        let versions = |i: usize| candidates.iter().filter(|other| other.name == candidates[i].name).count();
        let is_in = |i: usize| fit.included.iter().any(|member| candidates[*member].name == candidates[i].name);
        let mut members: Vec<(usize, Range<usize>, usize)> = Vec::new();
        for i in (0..candidates.len()).filter(|i| !is_in(*i)) {
            let first = members.last().map_or(0, |(_, columns, _)| columns.end);
            members.push((i, first..first + fit.evidence.candidates[i].ncols(), versions(i)));
        }
        let parts: Vec<&DMatrix<f64>> = members.iter().map(|(i, ..)| &fit.evidence.candidates[*i]).collect();
        Others {
            evidence: fit.evidence,
            of_fit,
            columns: side_by_side(fit.evidence.residual.len(), &parts),
            prior: members.iter().flat_map(|(i, ..)| candidates[*i].prior()).collect(),
            among: names(candidates).len(),
            members,
        }
    }

    /// The one whose gain exceeds its cost by most.
    fn worth_most(&self, noises: &[Noise]) -> Option<Worth> {
        let score = self.score(noises);
        let worth = |(candidate, columns, versions): &(usize, Range<usize>, usize)| Worth {
            candidate: *candidate,
            columns: columns.clone(),
            gain: score.fit(&columns.clone().collect::<Vec<_>>()).gain,
            cost: cost(&score, columns.len(), [self.among, *versions]),
        };
        let excess = |worth: &Worth| worth.gain - worth.cost;
        self.members.iter().map(worth).max_by(|a, b| excess(a).total_cmp(&excess(b)))
    }

    /// What a candidate explains by these noises.
    fn gain(&self, noises: &[Noise], worth: &Worth) -> f64 {
        self.score(noises).fit(&worth.columns.clone().collect::<Vec<_>>()).gain
    }

    fn score(&self, noises: &[Noise]) -> Score {
        Score::new(self.evidence, noises, self.of_fit, &self.columns, &self.prior)
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng, rngs::StdRng};
    use rand_distr::StandardNormal;

    use super::*;
    use crate::evidence::{Candidate, Point};
    use crate::tests::candidate;

    /// Eight legs of fifty rows; candidates that take up what changes in an hour or more.
    struct FewLegs {
        candidates: Vec<Candidate>,
        residual: DVector<f64>,
    }

    const ROWS: usize = 400;
    const CANDIDATES: usize = 24;
    const STEP_S: f64 = 60.0;
    const WHITE_SD: f64 = 0.5;
    const SLOW_S: f64 = 1800.0;

    fn wave(candidate: usize, row: usize) -> f64 {
        (std::f64::consts::PI * (candidate + 1) as f64 * (row as f64 + 0.5) / ROWS as f64).cos()
    }

    impl FewLegs {
        /// White noise and water that moves by 1 in half an hour, beside so much of one candidate.
        fn new(seed: u64, size: f64) -> FewLegs {
            let mut rng = StdRng::seed_from_u64(seed);
            let mut normal = move || rng.sample::<f64, _>(StandardNormal);
            let kept = (-STEP_S / SLOW_S).exp();
            let mut slow = normal();
            let residual = DVector::from_fn(ROWS, |row, _| {
                slow = kept * slow + (1.0 - kept * kept).sqrt() * normal();
                slow + WHITE_SD * normal() + size * wave(2, row)
            });
            const NAMES: [&str; CANDIDATES] = [
                "a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l", "m", "n", "o", "p", "q", "r", "s", "t",
                "u", "v", "w", "x",
            ];
            FewLegs { candidates: NAMES.map(candidate).to_vec(), residual }
        }

        /// Standard deviation and time of what is slow in the noise, all others set aside and as it is better known.
        fn slow(&self, included: &[usize]) -> [(f64, f64); 2] {
            let evidence = self.evidence(&self.start());
            let all_aside = with_all_aside(self, &evidence, included);
            let better = with_none_worth_its_cost(self, &evidence, included, &all_aside);
            [all_aside, better].map(|noises| {
                let slow = noises[0].slow[0];
                (slow.variance.sqrt(), slow.correlation_time_s)
            })
        }
    }

    impl Problem for FewLegs {
        fn baseline(&self) -> &[(&'static str, &'static str)] {
            &[("level", "1")]
        }

        fn candidates(&self) -> &[Candidate] {
            &self.candidates
        }

        fn start(&self) -> Point {
            Point { baseline: vec![0.0], candidates: vec![vec![0.0]; CANDIDATES] }
        }

        fn evidence(&self, _point: &Point) -> Evidence {
            let column = |candidate: usize| DMatrix::from_fn(ROWS, 1, |row, _| wave(candidate, row));
            Evidence {
                quantities: vec![Quantity { name: "w", unit: "mm/s", rows: 0..ROWS, joined_s: 0.0 }],
                time_s: (0..ROWS).map(|row| STEP_S * row as f64).collect(),
                stated_sd: vec![WHITE_SD; ROWS],
                block: (0..ROWS).map(|row| row / 50).collect(),
                leg: vec![1.0; ROWS],
                place: Vec::new(),
                residual: self.residual.clone(),
                baseline: DMatrix::from_element(ROWS, 1, 1.0),
                baseline_without: None,
                prior: vec![(0.0, 1e6)],
                candidates: (0..CANDIDATES).map(column).collect(),
                shared: DMatrix::zeros(ROWS, 0),
                covariates: Vec::new(),
                decorrelation: None,
            }
        }
    }

    /// The mean over twenty logs of the logarithms of the two.
    fn mean_of(find: impl Fn(u64) -> (f64, f64)) -> [f64; 2] {
        let found: Vec<(f64, f64)> = (0..20).map(find).collect();
        [found.iter().map(|(sd, _)| sd.ln()).sum::<f64>(), found.iter().map(|(_, time_s)| time_s.ln()).sum()]
            .map(|sum| (sum / 20.0).exp())
    }

    #[test]
    fn water_that_moves_for_long_is_known_where_candidates_would_take_it_up() {
        let [sd, time_s] = mean_of(|seed| FewLegs::new(seed, 0.0).slow(&[])[1]);
        assert!((0.8..1.2).contains(&sd) && (900.0..2900.0).contains(&time_s), "{sd} in {time_s} s");
        let [sd, time_s] = mean_of(|seed| FewLegs::new(seed, 0.0).slow(&[])[0]);
        assert!(sd < 0.7 && time_s < 700.0, "with all set aside {sd} in {time_s} s");
    }

    /// Three times as large as the water's motion, and as slow: none of it counts as noise, whether a fit has it or not.
    #[test]
    fn what_a_candidate_explains_is_no_noise() {
        for included in [&[][..], &[2]] {
            let [sd, _] = mean_of(|seed| FewLegs::new(seed, 3.0).slow(included)[1]);
            assert!(sd < 1.2, "{included:?}: {sd}");
        }
    }
}
