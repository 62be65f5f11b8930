//! The regression of side force and moment: which terms it has, and its solution.

use glidepolar_hull::hull_tests::{DynamicDerivatives, Estimate};
use nalgebra::{DMatrix, DVector};

use super::Form;
use super::observations::Observation;
use crate::campaign::Kind;
use crate::influence::Influence;
use crate::shared::Common;
use glidepolar_inference::regression::{Problem, Regression, Scatter, Shared};

/// Amplitudes must differ by this factor to tell a nonlinear term.
const AMPLITUDE_RATIO: f64 = 1.3;
/// A form must be better by this much to be preferred to the cubic one.
const CLEARLY_BETTER: f64 = 6.0;
/// Columns of the regressors.
pub(super) const V: usize = 0;
pub(super) const R: usize = 3;
pub(super) const VDOT: usize = 6;
pub(super) const RDOT: usize = 7;

/// Which terms the model has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Model {
    pub v: Form,
    pub r: Form,
    pub swaying: bool,
    pub turning: bool,
    pub yawing: bool,
}

impl Model {
    /// Columns of the regressors, the derivatives first: v, vdot, r, rdot, then the nonlinear ones.
    pub(super) fn columns(&self) -> Vec<usize> {
        let mut columns = vec![V];
        columns.extend(self.swaying.then_some(VDOT));
        columns.extend(self.turning.then_some(R));
        columns.extend(self.yawing.then_some(RDOT));
        columns.extend(nonlinear_column(self.v, V + 1));
        columns.extend(if self.turning { nonlinear_column(self.r, R + 1) } else { None });
        columns
    }

    /// What a fit expects of an observation.
    pub(super) fn value(&self, fit: &Regression, observation: &Observation) -> f64 {
        self.columns().into_iter().zip(fit.parameters.iter()).map(|(c, p)| observation.regressors[c] * p).sum()
    }

    pub(super) fn index(&self, column: usize) -> Option<usize> {
        self.columns().iter().position(|c| *c == column)
    }
}

fn nonlinear_column(form: Form, first: usize) -> Option<usize> {
    match form {
        Form::Cubic => Some(first),
        Form::Absolute => Some(first + 1),
        Form::Linear => None,
    }
}

/// The forms of the nonlinear terms that fit best; the cubic ones unless others are clearly better.
pub(super) fn best(common: &Common, observations: &[&Observation]) -> Option<Model> {
    let has = |kind: Kind| observations.iter().any(|o| o.kind == kind);
    if !has(Kind::Sway) && !has(Kind::Static) {
        return None;
    }
    let turning = has(Kind::Yaw) || has(Kind::Arc);
    let varied = |kinds: &[Kind], column: usize| {
        let sizes = observations.iter().filter(|o| kinds.contains(&o.kind)).map(|o| o.regressors[column].abs());
        let (low, high) = sizes.filter(|s| *s > 1e-4).fold((f64::INFINITY, 0.0f64), |(l, h), s| (l.min(s), h.max(s)));
        high > AMPLITUDE_RATIO * low
    };
    let forms = |varied: bool| -> &[Form] { if varied { &[Form::Cubic, Form::Absolute] } else { &[Form::Linear] } };
    let v_forms = forms(varied(&[Kind::Sway], V));
    let r_forms = forms(turning && varied(&[Kind::Yaw, Kind::Arc], R));
    let mut best: Option<(f64, Model)> = None;
    for &v in v_forms {
        for &r in r_forms {
            let model = Model { v, r, swaying: has(Kind::Sway), turning, yawing: has(Kind::Yaw) };
            let Some(fits) = solve(common, &model, observations) else { continue };
            let chi2: f64 = fits.iter().map(|fit| fit.chi2_per_dof * fit.dof as f64).sum();
            let penalty = |form: Form| if form == Form::Absolute { CLEARLY_BETTER } else { 0.0 };
            let chi2 = chi2 + penalty(v) + penalty(r);
            if best.is_none_or(|(least, _)| chi2 < least) {
                best = Some((chi2, model));
            }
        }
    }
    best.map(|(_, model)| model)
}

pub(super) fn problem(common: &Common, model: &Model, observations: &[&Observation], coefficient: usize) -> Problem {
    let columns = model.columns();
    let n = observations.len();
    let kinds = common.shared();
    let shared = kinds.iter().enumerate().map(|(k, kind)| {
        let each = observations.iter().map(|observation| &observation.shared[k]);
        Shared { influence: Influence::stacked(each, coefficient).on, dof: common.shared_dof(*kind) }
    });
    Problem {
        design: DMatrix::from_fn(n, columns.len(), |i, j| observations[i].regressors[columns[j]]),
        observed: DVector::from_iterator(n, observations.iter().map(|o| o.force[coefficient])),
        variance: DVector::from_iterator(n, observations.iter().map(|o| o.variance[coefficient])),
        shared: shared.collect(),
    }
}

/// Y' and N'.
pub(super) fn solve(common: &Common, model: &Model, observations: &[&Observation]) -> Option<[Regression; 2]> {
    solve_with(common, model, observations, &[])
}

/// The same with further errors that the observations share, on Y' and N'.
pub(super) fn solve_with(
    common: &Common,
    model: &Model,
    observations: &[&Observation],
    further: &[[Shared; 2]],
) -> Option<[Regression; 2]> {
    let one = |coefficient: usize| {
        let mut problem = problem(common, model, observations, coefficient);
        problem.shared.extend(further.iter().map(|errors| errors[coefficient].clone()));
        problem.solve(Scatter::Scaled)
    };
    Some([one(0)?, one(1)?])
}

/// By name. Without sway runs what goes with `rdot` cannot be moved to the centre of buoyancy: `vdot` there is
/// `rdot` times the lever.
pub(super) fn named(model: &Model, y: &Regression, n: &Regression) -> Option<DynamicDerivatives> {
    let of = |fit: &Regression, column: usize| {
        let known = column != RDOT || model.swaying;
        model.index(column).filter(|_| known).map(|index| fit.estimate(index, "1"))
    };
    Some(DynamicDerivatives {
        yv: of(y, V)?,
        nv: of(n, V)?,
        yr: of(y, R),
        nr: of(n, R),
        yvdot: of(y, VDOT),
        nvdot: of(n, VDOT),
        yrdot: of(y, RDOT),
        nrdot: of(n, RDOT),
    })
}

/// Coefficients of the nonlinear terms, with their names.
pub(super) fn nonlinear(model: &Model, y: &Regression, n: &Regression) -> Vec<(String, Estimate)> {
    let mut found = Vec::new();
    for (symbol, form, first) in [("v", model.v, V + 1), ("r", model.r, R + 1)] {
        let name = match form {
            Form::Cubic => symbol.repeat(3),
            Form::Absolute => format!("{symbol}|{symbol}|"),
            Form::Linear => continue,
        };
        let Some(index) = nonlinear_column(form, first).and_then(|column| model.index(column)) else { continue };
        found.push((format!("Y{name}"), y.estimate(index, "1")));
        found.push((format!("N{name}"), n.estimate(index, "1")));
    }
    found
}
