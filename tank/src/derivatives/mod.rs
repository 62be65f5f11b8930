//! Derivatives from oscillations and turns: all runs of a hull in one regression about the centre of buoyancy.
//!
//! Side force and moment of the water, in SNAME primes on the overall length, are taken for
//!
//! ```text
//! Y' = Yv' v V + Yvvv' v^3/V + Yr' r V + Yrrr' r^3/V + Yvdot' v. + Yrdot' r.
//! ```
//!
//! with `v`, `r` and their rates made dimensionless by speed and length and `V` the momentary speed; in place of the cubes
//! stand `v|v|` and `r|r|` where the third harmonics fit these better. Motion and force are compared harmonic by harmonic:
//! the motion as measured goes through the model, and first and third harmonics of what comes out are set against those
//! of the force. The same for `N'`.

mod comparisons;
mod model;
mod noise;
mod observations;

use glidepolar_hull::hull_tests::{DynamicDerivatives, Estimate};
use nalgebra::DMatrix;

use crate::campaign::{Kind, Run};
use crate::fits::SweepFit;
use crate::harmonics::Harmonics;
use crate::hull::Hull;
use crate::shared::Common;
use crate::steady_run::SteadyRun;
use glidepolar_inference::regression::{Regression, Shared};
use model::Model;
use observations::Observation;

pub use comparisons::{compare_sweep, from_sweep};

/// What the oscillations and turns of a hull came to.
#[derive(Debug, Clone)]
pub struct Derivatives {
    /// The eight derivatives.
    pub estimates: DynamicDerivatives,
    /// Form of the nonlinear terms in `v` and in `r`.
    pub forms: (Form, Form),
    /// The nonlinear terms' coefficients in Y' and N', with their names.
    pub nonlinear: Vec<(String, Estimate)>,
    /// Weighted squares of the residuals over degrees of freedom, Y and N.
    pub chi2_per_dof: [f64; 2],
    /// Run by run: what its first harmonic alone says.
    pub runs: Vec<SingleRun>,
    /// Turns alone against yaw oscillations alone.
    pub turns: Vec<Comparison>,
    /// Smallest and largest reduced frequency `omega L/U`, where anything oscillated.
    pub reduced_frequencies: Option<(f64, f64)>,
    /// Whether `Yv` and `Nv` are those of the steady sweep, for want of sway runs.
    pub slopes_from_sweep: bool,
    /// Whether the derivatives move with frequency: name, probability of as large a change by chance.
    pub frequency_dependence: Vec<(&'static str, f64)>,
    /// Observed less fitted, for a diagnosis: run, harmonic term, Y' and N', and their standard errors.
    pub residuals: Vec<Residual>,
}

/// The nonlinear term of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// `x^3/V`.
    Cubic,
    /// `x|x|`.
    Absolute,
    /// Amplitudes too much alike to tell.
    Linear,
}

/// First harmonic of one run, the other motion's part taken from the common fit.
#[derive(Debug, Clone)]
pub struct SingleRun {
    /// The run.
    pub run_id: String,
    /// Sway or yaw.
    pub kind: Kind,
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Amplitude of sway \[m\] or yaw \[deg\].
    pub amplitude: f64,
    /// Whole cycles.
    pub cycles: usize,
    /// Damping derivative in Y' and N' (`v` for sway, `r` for yaw), then that of the rate, each with its standard error.
    pub damping: [(f64, f64); 2],
    /// `vdot` or `rdot`.
    pub inertia: [(f64, f64); 2],
}

/// The same figure from two kinds of run.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// The derivative.
    pub name: &'static str,
    /// What the first comes from.
    pub first_from: &'static str,
    /// The first.
    pub first: Estimate,
    /// What the second comes from.
    pub second_from: &'static str,
    /// The second.
    pub second: Estimate,
}

impl Comparison {
    /// Difference in units of its standard error.
    pub fn apart(&self) -> f64 {
        (self.first.value - self.second.value) / self.first.se.hypot(self.second.se)
    }

    /// Whether they are further apart than chance explains: more than twice what 95 % intervals allow, some four standard
    /// errors, and more where these rest on few runs.
    pub fn disagrees(&self) -> bool {
        let half = |q: &Estimate| 0.5 * (q.ci95[1] - q.ci95[0]);
        (self.first.value - self.second.value).abs() > 2.2 * half(&self.first).hypot(half(&self.second))
    }
}

/// What the fit leaves of one observation.
#[derive(Debug, Clone, PartialEq)]
pub struct Residual {
    /// The run.
    pub run_id: String,
    /// Harmonic term, 0 for a mean.
    pub term: usize,
    /// Y', N'.
    pub left: [f64; 2],
    /// Their standard errors.
    pub se: [f64; 2],
}

/// Scatter between steady runs beyond their own noise, in Y' and N'.
type BetweenRuns = [f64; 2];
/// `Yv'` and `Nv'` of the steady sweep.
type SteadySlopes = [Estimate; 2];

/// Fits a hull's oscillations and turns. Without sway runs the slopes of the steady sweep stand in for `Yv` and `Nv`, and
/// what goes with accelerations is left out; none where `v` and `r` cannot be separated at all.
pub fn fit(
    common: &Common,
    hull: &Hull,
    oscillations: &[(&Run, &Harmonics)],
    turns: &[SteadyRun],
    sweep: Option<&SweepFit>,
) -> Option<Derivatives> {
    let between_runs = sweep.map_or([0.0; 2], |fit| comparisons::between_runs(hull, fit));
    let observe = |hull: &Hull| {
        let mut observations = observations::oscillations(common, hull, oscillations);
        for (i, turn) in turns.iter().enumerate() {
            observations.push(observations::turn(common, hull, oscillations.len() + i, turn, between_runs));
        }
        observations
    };
    let mut observations = observe(hull);
    let mut ids: Vec<&str> = oscillations.iter().map(|(run, _)| run.id.as_str()).collect();
    ids.extend(turns.iter().map(|turn| turn.run.id.as_str()));
    let slopes = sweep.map(|fit| from_sweep(hull, fit));
    let slopes = slopes.filter(|_| !observations.iter().any(|o| o.kind == Kind::Sway));
    if let Some(slopes) = &slopes {
        observations.push(observations::steady(common, ids.len(), slopes));
        ids.push("steady sweep");
    }
    let all: Vec<&Observation> = observations.iter().collect();
    let model = model::best(common, &all)?;
    let fits = model::solve(common, &model, &all)?;
    let [y, n] = match centre_errors(hull, &model, &fits, &observations, &observe) {
        errors if errors.is_empty() => fits,
        errors => model::solve_with(common, &model, &all, &errors)?,
    };
    let mut estimates = model::named(&model, &y, &n)?;
    if let Some([yv, nv]) = slopes.clone() {
        (estimates.yv, estimates.nv) = (yv, nv);
    }
    let residual = |(i, o): (usize, &&Observation)| Residual {
        run_id: ids[o.run].to_owned(),
        term: o.term,
        left: [y.residuals[i], n.residuals[i]],
        se: o.variance.map(f64::sqrt),
    };
    let frequencies = observations.iter().map(|o| o.frequency).filter(|frequency| *frequency > 0.0);
    Some(Derivatives {
        nonlinear: model::nonlinear(&model, &y, &n),
        forms: (model.v, model.r),
        chi2_per_dof: [y.chi2_per_dof, n.chi2_per_dof],
        runs: comparisons::single_runs(&model, &y, &n, &all, oscillations),
        turns: comparisons::turns(common, &model, &observations),
        reduced_frequencies: frequencies
            .fold(None, |range, f| Some(range.map_or((f, f), |(low, high): (f64, f64)| (low.min(f), high.max(f))))),
        frequency_dependence: comparisons::frequency_dependence(common, &model, &all),
        residuals: all.iter().enumerate().map(residual).collect(),
        slopes_from_sweep: slopes.is_some(),
        estimates,
    })
}

/// A change of a centre's place by this much shows its influence \[m\].
const MOVED_M: f64 = 1e-4;

/// Influence of the places of moment centre and centre of buoyancy on Y' and N': on the moment, on the sway that the model
/// takes for that of the centre of buoyancy, and on the inertia of the mass that hangs below the balance.
fn centre_errors(
    hull: &Hull,
    model: &Model,
    fits: &[Regression; 2],
    observations: &[Observation],
    observe: &dyn Fn(&Hull) -> Vec<Observation>,
) -> Vec<[Shared; 2]> {
    let mut errors = Vec::new();
    for (centre, uncertainty) in hull.centre_uncertainties_m.into_iter().enumerate().filter(|(_, u)| *u > 0.0) {
        let mut moved = hull.clone();
        if centre == 0 {
            moved.mc_m += MOVED_M;
        } else {
            moved.geometry.cb_m += MOVED_M;
        }
        let moved = observe(&moved);
        errors.push([0, 1].map(|coefficient| {
            let left = |o: &Observation| o.force[coefficient] - model.value(&fits[coefficient], o);
            let change = |i: usize| moved.get(i).map_or(0.0, |after| (left(after) - left(&observations[i])) / MOVED_M);
            Shared {
                influence: DMatrix::from_fn(observations.len(), 1, |i, _| uncertainty * change(i)),
                dof: f64::INFINITY,
            }
        }));
    }
    errors
}
