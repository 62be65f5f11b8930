//! Gauss and Newton's steps of a fit, damped where the model bends away from its slopes (Levenberg and Marquardt). Knows one fit;
//! estimates no noise.

use nalgebra::DVector;

use super::evidence::{Point, Problem};
use super::fitted::{Fitted, LEAST_FALL, believing, weighted_squares, with_target};
use super::holdout::LeastSquares;

/// Steps to one fit.
const MAX_FIT_STEPS: usize = 40;

/// Steps that are tried, each damped more than the last, until one makes things better.
const MAX_TRIALS: usize = 6;

/// How much a step is damped. It is damped less after a step that went as predicted, and more after one that did not (Nielsen 1999,
/// IMM-REP-1999-05).
struct Damping {
    value: f64,
    /// By what the next failure multiplies it.
    growth: f64,
}

impl Fitted {
    /// Steps until the weighted sum of squares no longer falls; returns by how much it fell. Leaves the evidence with the sensitivities
    /// of the included candidates alone.
    pub(super) fn take_steps(&mut self, problem: &impl Problem) -> f64 {
        let mut damping = Damping { value: 0.0, growth: 2.0 };
        let mut fallen = 0.0;
        for _ in 0..MAX_FIT_STEPS {
            let fall = self.take_step(problem, &mut damping);
            fallen += fall;
            if fall < LEAST_FALL {
                break;
            }
        }
        fallen
    }

    /// The weighted sum of squares after one step, were the model linear.
    pub(super) fn squares_after_a_step(&self) -> f64 {
        let all = with_target(&self.evidence, &self.noises, &self.columns(), &self.evidence.residual);
        weighted_squares(&self.evidence, &self.noises) - LeastSquares::new(&all).fall(0.0)
    }

    /// One step; returns by how much the weighted sum of squares fell, 0 where no step makes it fall.
    fn take_step(&mut self, problem: &impl Problem, damping: &mut Damping) -> f64 {
        // Slow slopes are asked for where a step ends, not where it is tried.
        let is_quick = |member: &usize| !problem.has_slow_slopes(*member);
        let quick_slopes: Vec<usize> = self.included.iter().copied().filter(is_quick).collect();
        let all = with_target(&self.evidence, &self.noises, &self.columns(), &self.evidence.residual);
        let linear = LeastSquares::new(&all);
        let before = weighted_squares(&self.evidence, &self.noises);
        for _ in 0..MAX_TRIALS {
            // Too little is the end, even were the model linear.
            let predicted = linear.fall(damping.value);
            if predicted < LEAST_FALL {
                break;
            }
            let point = self.moved(problem, &linear.solution(damping.value));
            if !problem.admits(&point) {
                damping.rise(&linear);
                continue;
            }
            let evidence = problem.evidence_of(&point, &quick_slopes);
            let mut evidence = believing(problem, evidence, &point, &self.included);
            let fall = before - weighted_squares(&evidence, &self.noises);
            if fall > 0.0 {
                if quick_slopes.len() < self.included.len() {
                    evidence = problem.evidence_of(&point, &self.included);
                    evidence = believing(problem, evidence, &point, &self.included);
                }
                (self.point, self.evidence) = (point, evidence);
                damping.follow(fall / predicted, &linear);
                return fall;
            }
            damping.rise(&linear);
        }
        0.0
    }

    /// The point after a step of the fitted parameters.
    fn moved(&self, problem: &impl Problem, step: &DVector<f64>) -> Point {
        let mut point = self.point.clone();
        let mut steps = step.iter();
        for (place, (value, step)) in point.baseline.iter_mut().zip(&mut steps).enumerate() {
            *value = problem.stepped(place, *value, *step);
        }
        for member in &self.included {
            for (value, step) in point.candidates[*member].iter_mut().zip(&mut steps) {
                *value += step;
            }
        }
        assert_eq!(problem.baseline().len(), point.baseline.len());
        point
    }
}

impl Damping {
    /// After a step that made things worse.
    fn rise(&mut self, linear: &LeastSquares) {
        // The least that halves a step in any direction.
        self.value = (self.value * self.growth).max(linear.least_curvature());
        self.growth *= 2.0;
    }

    /// After a step whose fall was this share of what the slopes predicted.
    fn follow(&mut self, share: f64, linear: &LeastSquares) {
        self.value *= (1.0 - (2.0 * share - 1.0).powi(3)).max(1.0 / 3.0);
        self.growth = 2.0;
        // What no direction feels is none.
        if self.value < 0.1 * linear.least_curvature() {
            self.value = 0.0;
        }
    }
}
