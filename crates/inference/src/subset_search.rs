//! Which candidates, if any: every set is weighed by what it explains and what it costs.
//!
//! The cost is the extended Bayesian criterion (Chen and Chen 2008): `df ln n_eff + 2 ln M` for each member chosen among
//! M, `n_eff` the number of independent rows. Curves in the covariates run in the same search: where a curve that nobody
//! can name beats every mechanism, no mechanism is named.

use std::collections::HashSet;

use super::score::Score;

/// By how much an unnamed curve must be better before it keeps a mechanism from being named, and how much worse
/// a mechanism may be and still count as a stand-in: a factor of 20 in evidence.
pub(crate) const MARGIN: f64 = 6.0;

/// What a member of so many columns costs that is chosen among so many, in one of so many versions: the extended Bayesian criterion.
pub(super) fn cost(score: &Score, columns: usize, [among, versions]: [usize; 2]) -> f64 {
    columns as f64 * score.effective_rows.ln() + 2.0 * (among as f64).ln() + 2.0 * (versions as f64).ln()
}

/// Something that runs in the search.
#[derive(Debug, Clone, PartialEq)]
pub struct Regressor {
    /// Its columns in the score.
    pub columns: Vec<usize>,
    /// Regressors of one family exclude each other: versions of one mechanism.
    pub family: usize,
    /// Whether it is an unnamed curve.
    pub is_curve: bool,
    /// Smallest and largest step that physics allows each of its columns; empty where any is allowed.
    pub bounds: Vec<(f64, f64)>,
}

/// A set of regressors with its criterion: smaller is better, 0 is the baseline alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The members, by index.
    pub members: Vec<usize>,
    /// Cost less gain.
    pub criterion: f64,
}

/// Largest number of mechanisms that are named together.
const MAX_MEMBERS: usize = 4;

/// How many sets are kept to be grown further.
const BEAM: usize = 12;

/// The search over one score.
#[derive(Debug, Clone)]
pub struct SubsetSearch<'a> {
    score: &'a Score,
    regressors: &'a [Regressor],
    /// What each regressor costs.
    costs: Vec<f64>,
}

impl<'a> SubsetSearch<'a> {
    /// A search of these regressors.
    pub fn new(score: &'a Score, regressors: &'a [Regressor]) -> Self {
        let mut families: Vec<usize> = regressors.iter().filter(|r| !r.is_curve).map(|r| r.family).collect();
        families.sort_unstable();
        families.dedup();
        let n_curves = regressors.iter().filter(|r| r.is_curve).count();
        let cost = |regressor: &Regressor| {
            let among = if regressor.is_curve { n_curves } else { families.len() };
            let versions = regressors.iter().filter(|r| r.family == regressor.family).count();
            cost(score, regressor.columns.len(), [among, versions])
        };
        SubsetSearch { score, regressors, costs: regressors.iter().map(cost).collect() }
    }

    /// The columns of a set.
    pub fn columns(&self, members: &[usize]) -> Vec<usize> {
        members.iter().flat_map(|member| self.regressors[*member].columns.clone()).collect()
    }

    /// Cost less gain of a set; infinite where its fit asks for what physics forbids.
    pub fn criterion(&self, members: &[usize]) -> f64 {
        let columns = self.columns(members);
        if columns.is_empty() {
            return 0.0;
        }
        let fit = self.score.fit(&columns);
        self.criterion_of(members.iter().copied(), fit.gain, fit.step.as_slice())
    }

    /// The criterion of a fit, its steps in the order of the members' columns.
    fn criterion_of(&self, members: impl Iterator<Item = usize>, gain: f64, steps: &[f64]) -> f64 {
        let mut steps = steps.iter();
        let mut cost = 0.0;
        for member in members {
            let regressor = &self.regressors[member];
            for (place, step) in (0..regressor.columns.len()).zip(&mut steps) {
                let bounds = regressor.bounds.get(place);
                if bounds.is_some_and(|(low, high)| step < low || step > high) {
                    return f64::INFINITY;
                }
            }
            cost += self.costs[member];
        }
        cost - gain
    }

    /// How much a set explains: fall of the sum of squares, in units of the noise.
    pub fn gain(&self, members: &[usize]) -> f64 {
        let columns = self.columns(members);
        if columns.is_empty() { 0.0 } else { self.score.fit(&columns).gain }
    }

    /// How much a member explains beside the others of a set, in units of the noise.
    pub fn gain_of(&self, members: &[usize], place: usize) -> f64 {
        let mut others = members.to_vec();
        others.remove(place);
        self.gain(members) - self.gain(&others)
    }

    /// A set with each member in the version of its mechanism that explains most beside the others.
    pub fn in_best_versions(&self, members: &[usize]) -> Vec<usize> {
        let mut best = members.to_vec();
        for place in 0..best.len() {
            let family = self.regressors[best[place]].family;
            let is_version =
                |other: &usize| !self.regressors[*other].is_curve && self.regressors[*other].family == family;
            let with = |version: usize| {
                let mut set = best.clone();
                set[place] = version;
                self.gain(&set)
            };
            let versions = (0..self.regressors.len()).filter(is_version).map(|version| (with(version), version));
            if let Some((_, version)) = versions.max_by(|a, b| a.0.total_cmp(&b.0)) {
                best[place] = version;
            }
        }
        best
    }

    /// What a regressor costs.
    pub fn cost(&self, regressor: usize) -> f64 {
        self.costs[regressor]
    }

    /// By how much one set costs more than another.
    pub fn cost_above(&self, members: &[usize], others: &[usize]) -> f64 {
        let cost = |set: &[usize]| set.iter().map(|member| self.costs[*member]).sum::<f64>();
        cost(members) - cost(others)
    }

    /// The best set of mechanisms alone: all singles and pairs, larger sets grown from the best ones.
    pub fn best_mechanisms(&self) -> Choice {
        let named: Vec<usize> = (0..self.regressors.len()).filter(|i| !self.regressors[*i].is_curve).collect();
        self.grow(vec![Choice { members: Vec::new(), criterion: 0.0 }], &named, MAX_MEMBERS, &mut |_| ())
    }

    /// The sets of mechanisms alone whose criterion is below a limit, of those that a search for the best one meets, the best
    /// first.
    pub fn within(&self, criterion: f64, max_members: usize) -> Vec<Choice> {
        let named: Vec<usize> = (0..self.regressors.len()).filter(|i| !self.regressors[*i].is_curve).collect();
        let mut found: Vec<Choice> = Vec::new();
        let start = vec![Choice { members: Vec::new(), criterion: 0.0 }];
        self.grow(start, &named, max_members, &mut |choice| {
            if choice.criterion < criterion {
                found.push(choice.clone());
            }
        });
        found.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
        found
    }

    /// The best set with one curve in it.
    pub fn best_with_curve(&self) -> Option<Choice> {
        let named: Vec<usize> = (0..self.regressors.len()).filter(|i| !self.regressors[*i].is_curve).collect();
        let curves = (0..self.regressors.len())
            .filter(|i| self.regressors[*i].is_curve)
            .map(|curve| Choice { members: vec![curve], criterion: self.criterion(&[curve]) });
        let mut starts: Vec<Choice> = curves.collect();
        starts.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
        starts.truncate(BEAM);
        (!starts.is_empty()).then(|| self.grow(starts, &named, 3, &mut |_| ()))
    }

    /// The members that could stand in one member's place with a criterion at most `margin` worse, best first.
    pub fn replacements(&self, members: &[usize], place: usize, margin: f64) -> Vec<usize> {
        let here = self.criterion(members);
        let others = (0..self.regressors.len()).filter(|i| {
            let family = self.regressors[*i].family;
            !self.regressors[*i].is_curve && members.iter().all(|member| self.regressors[*member].family != family)
        });
        let mut found: Vec<(f64, usize)> = others
            .filter_map(|other| {
                let mut set = members.to_vec();
                set[place] = other;
                let criterion = self.criterion(&set);
                (criterion < here + margin).then_some((criterion, other))
            })
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, other)| other).collect()
    }

    /// Grows sets by one member after the other; `met` is shown each of them.
    fn grow(&self, starts: Vec<Choice>, named: &[usize], max_members: usize, met: &mut impl FnMut(&Choice)) -> Choice {
        let mut best = starts
            .iter()
            .min_by(|a, b| a.criterion.total_cmp(&b.criterion))
            .cloned()
            .unwrap_or(Choice { members: Vec::new(), criterion: 0.0 });
        let mut level = starts;
        for size in 1..=max_members {
            let mut next: Vec<Choice> = Vec::new();
            let mut known: HashSet<Vec<usize>> = HashSet::new();
            let mut steps = Vec::new();
            for choice in &level {
                let here = self.score.solve(&self.columns(&choice.members));
                for other in named {
                    let family = self.regressors[*other].family;
                    if choice.members.iter().any(|member| self.regressors[*member].family == family) {
                        continue;
                    }
                    let mut members = choice.members.clone();
                    members.push(*other);
                    members.sort_unstable();
                    if !known.insert(members.clone()) {
                        continue;
                    }
                    let gain = match self.regressors[*other].columns[..] {
                        [column] => self.score.gain_with(&here, column, &mut steps),
                        _ => None,
                    };
                    let criterion = match gain {
                        Some(gain) => self.criterion_of(choice.members.iter().chain([other]).copied(), gain, &steps),
                        None => self.criterion(&members),
                    };
                    let choice = Choice { members, criterion };
                    met(&choice);
                    next.push(choice);
                }
            }
            next.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
            if let Some(first) = next.first().filter(|first| first.criterion < best.criterion) {
                best = first.clone();
            }
            // All singles go on to all pairs; from there the best go on.
            if size > 1 {
                next.truncate(BEAM);
            }
            level = next;
        }
        best
    }
}
