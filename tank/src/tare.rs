//! The strut's own force against angle and speed, from runs without a model.
//!
//! Each channel over the dynamic pressure is a short series in the sine of the drift angle; the axial force also in the
//! logarithm of the speed, since friction does not go with its square. As many terms as the angles and speeds support.

use nalgebra::{DMatrix, DVector, Vector3};

use crate::motion::Motion;
use crate::regression::{Fit, Problem, Scatter, Shared};
use crate::run_variance;
use crate::shared::{self, Influence};

/// The strut's force.
#[derive(Debug, Clone)]
pub struct Tare {
    channels: [Channel; 3],
    reference_speed_m_s: f64,
    /// Tare runs that entered.
    pub runs: usize,
    /// Largest drift angle that was tared \[deg\].
    pub largest_deg: f64,
}

#[derive(Debug, Clone)]
struct Channel {
    terms: Vec<Term>,
    fit: Fit,
    /// What a change of force in each run does to the terms.
    response: DMatrix<f64>,
    /// Of the covariance of the terms.
    root: DMatrix<f64>,
}

type Term = fn(Argument) -> f64;

/// What the strut's force depends on.
#[derive(Debug, Clone, Copy)]
struct Argument {
    sine: f64,
    log_speed: f64,
}

/// One tare run: force less zero, through the interaction.
#[derive(Debug, Clone)]
pub struct TareRun {
    /// Mean yaw angle \[rad\].
    pub yaw_rad: f64,
    /// Root mean square of the speed \[m/s\].
    pub speed_m_s: f64,
    /// Speed that was asked for \[m/s\].
    pub nominal_speed_m_s: f64,
    /// Dynamic pressure \[Pa\].
    pub dynamic_pressure_Pa: f64,
    /// AF, SF, YM.
    pub force: Vector3<f64>,
    /// Their variances.
    pub variance: Vector3<f64>,
    /// Of the zeros on the force.
    pub zero_influence: Influence,
}

/// Angles and speeds closer than this are one.
const SAME_DEG: f64 = 0.3;
const SAME_SPEED: f64 = 0.05;

impl Tare {
    /// Fits the tare runs; none if they are too few.
    pub fn of(runs: &[TareRun], zero_dof: f64) -> Option<Tare> {
        let angles = distinct(runs.iter().map(|run| run.yaw_rad.to_degrees()), |a, b| (a - b).abs() < SAME_DEG);
        let speeds = distinct(runs.iter().map(|run| run.speed_m_s), |a, b| (a / b - 1.0).abs() < SAME_SPEED);
        let reference_speed_m_s = crate::series::median(&runs.iter().map(|run| run.speed_m_s).collect::<Vec<_>>());
        let channel = |index: usize| {
            let terms = terms(index, angles, speeds, runs.len());
            let fit = fit(index, &terms, runs, reference_speed_m_s, zero_dof)?;
            let mut response = fit.gain.clone();
            for (mut column, run) in response.column_iter_mut().zip(runs) {
                column /= run.dynamic_pressure_Pa;
            }
            let root = shared::root(&fit.covariance);
            Some(Channel { terms, fit, response, root })
        };
        let channels = [channel(0)?, channel(1)?, channel(2)?];
        let largest_deg = runs.iter().map(|run| run.yaw_rad.abs().to_degrees()).fold(0.0, f64::max);
        Some(Tare { channels, reference_speed_m_s, runs: runs.len(), largest_deg })
    }

    /// AF, SF, YM of the strut in a motion; `density_kg_m3` of the water.
    pub fn force(&self, motion: &Motion, density_kg_m3: f64) -> Vector3<f64> {
        Vector3::from_fn(|channel, _| {
            let gradient = self.gradient(channel, motion, density_kg_m3);
            gradient.dot(&self.channels[channel].fit.parameters)
        })
    }

    /// The force's change with the parameters of one channel.
    pub fn gradient(&self, channel: usize, motion: &Motion, density_kg_m3: f64) -> DVector<f64> {
        let speed = motion.speed();
        let pressure = 0.5 * density_kg_m3 * speed * speed;
        let argument = Argument {
            sine: if speed > 0.0 { -motion.v / speed } else { 0.0 },
            log_speed: (speed / self.reference_speed_m_s).ln(),
        };
        let terms = &self.channels[channel].terms;
        DVector::from_iterator(terms.len(), terms.iter().map(|term| pressure * term(argument)))
    }

    /// What a change of force in each tare run does to the parameters of one channel: parameters by runs.
    pub fn response(&self, channel: usize) -> &DMatrix<f64> {
        &self.channels[channel].response
    }

    /// What one standard error of each independent part of a channel's errors does to its parameters: parameters by parts.
    pub fn root(&self, channel: usize) -> &DMatrix<f64> {
        &self.channels[channel].root
    }

    /// Degrees of freedom of a channel's errors.
    pub fn dof(&self, channel: usize) -> f64 {
        self.channels[channel].fit.dof as f64
    }

    /// Parameters of a channel.
    pub fn terms(&self, channel: usize) -> usize {
        self.channels[channel].terms.len()
    }
}

fn terms(channel: usize, angles: usize, speeds: usize, runs: usize) -> Vec<Term> {
    let mut terms: Vec<Term> = vec![|_| 1.0];
    let wanted: [(bool, Term); 3] = if channel == 0 {
        [(angles >= 3, |x| x.sine * x.sine), (angles >= 3, |x| x.sine), (speeds >= 2, |x| x.log_speed)]
    } else {
        [(angles >= 2, |x| x.sine), (angles >= 5, |x| x.sine.powi(3)), (false, |_| 0.0)]
    };
    // Half as many runs again as terms, and two to judge the scatter by.
    terms.extend(wanted.into_iter().filter(|(supported, _)| *supported).map(|(_, term)| term));
    while terms.len() > 1 && runs < terms.len() + 2 {
        terms.pop();
    }
    terms
}

fn fit(channel: usize, terms: &[Term], runs: &[TareRun], reference_speed_m_s: f64, zero_dof: f64) -> Option<Fit> {
    let n = runs.len();
    let argument =
        |run: &TareRun| Argument { sine: run.yaw_rad.sin(), log_speed: (run.speed_m_s / reference_speed_m_s).ln() };
    let per_pressure = |value: f64, run: &TareRun| value / run.dynamic_pressure_Pa;
    let mut zeros = Influence::stacked(runs.iter().map(|run| &run.zero_influence), channel).on;
    for (mut row, run) in zeros.row_iter_mut().zip(runs) {
        row /= run.dynamic_pressure_Pa;
    }
    let problem = Problem {
        design: DMatrix::from_fn(n, terms.len(), |i, j| terms[j](argument(&runs[i]))),
        observed: DVector::from_iterator(n, runs.iter().map(|run| per_pressure(run.force[channel], run))),
        variance: DVector::from_vec(run_variance::share(
            &runs.iter().map(|run| run.variance[channel] / run.dynamic_pressure_Pa.powi(2)).collect::<Vec<_>>(),
            &runs.iter().map(|run| run.nominal_speed_m_s).collect::<Vec<_>>(),
        )),
        shared: vec![Shared { influence: zeros, dof: zero_dof }],
    };
    problem.solve(Scatter::BetweenRuns)
}

fn distinct(values: impl Iterator<Item = f64>, same: impl Fn(f64, f64) -> bool) -> usize {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup_by(|a, b| same(*a, *b));
    sorted.len()
}
