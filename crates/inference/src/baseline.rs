//! The fit of the baseline alone, from which every search begins and to which every elimination may return; with the fits of sets that
//! were made on the way, so that none is made twice. Decides nothing.

use std::collections::VecDeque;
use std::ops::Deref;
use std::sync::{Mutex, PoisonError};

use super::evidence::{Point, Problem};
use super::fitted::Fitted;

/// Most fits that are kept: those of a few eliminations. One holds the sensitivities of all candidates, about 1 MB.
const MOST_KEPT: usize = 32;

/// The baseline of one problem.
pub(super) struct Baseline {
    fitted: Fitted,
    /// Where each fit began, and how it ended; the latest last.
    kept: Mutex<VecDeque<(Point, Fitted)>>,
}

impl Baseline {
    pub(super) fn new(problem: &impl Problem) -> Baseline {
        Baseline::of(Fitted::baseline(problem))
    }

    /// One that was fitted already.
    pub(super) fn of(fitted: Fitted) -> Baseline {
        Baseline { fitted, kept: Mutex::default() }
    }

    /// The fit of these candidates that begins at this point, in the problem of this baseline.
    pub(super) fn converged(&self, problem: &impl Problem, point: Point, included: Vec<usize>) -> Fitted {
        // A fit follows from where it begins alone. None is made while the list is locked: two threads may make the same one.
        let known = |kept: &VecDeque<(Point, Fitted)>| {
            let same = kept.iter().find(|(start, fitted)| fitted.included == included && *start == point);
            same.map(|(_, fitted)| fitted.clone())
        };
        let lock = || self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = known(&lock()) {
            return known;
        }
        let fitted = Fitted::converged(problem, point.clone(), included);
        let mut kept = lock();
        if kept.len() == MOST_KEPT {
            kept.pop_front();
        }
        kept.push_back((point, fitted.clone()));
        fitted
    }
}

impl Deref for Baseline {
    type Target = Fitted;

    fn deref(&self) -> &Fitted {
        &self.fitted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::Toy;

    /// A fit that begins where another did is that one, and those that are kept stay few.
    #[test]
    fn no_fit_is_made_twice_and_few_are_kept() {
        let toy = Toy::new(3, |_, _| 0.0);
        let baseline = Baseline::new(&toy);
        let at = |value: f64| Point { baseline: vec![value], ..toy.start() };
        let first = baseline.converged(&toy, at(3.0), vec![0]);
        let again = baseline.converged(&toy, at(3.0), vec![0]);
        let fitted = Fitted::converged(&toy, at(3.0), vec![0]);
        let kept = || baseline.kept.lock().expect("no thread failed").len();
        assert!(first.point == again.point && again.point == fitted.point && kept() == 1);
        let other = baseline.converged(&toy, at(3.0), vec![1]);
        assert!(other.included == [1] && kept() == 2);
        for step in 0..2 * MOST_KEPT {
            baseline.converged(&toy, at(2.0 + 0.01 * step as f64), vec![0]);
        }
        assert_eq!(kept(), MOST_KEPT);
    }
}
