//! The same derivative from different runs: each oscillation alone, turns against yaw, oscillation against the steady
//! sweep, low frequencies against high ones.

use glidepolar_hull::hull_tests::{DynamicDerivatives, Estimate};

use super::model::{Model, R, RDOT, V, VDOT, problem, solve};
use super::observations::Observation;
use super::{BetweenRuns, Comparison, Form, SingleRun};
use crate::campaign::{Kind, Run};
use crate::fits::SweepFit;
use crate::harmonics::{Harmonics, Series};
use crate::hull::Hull;
use crate::shared::Common;
use crate::zero_drift::Slope;
use glidepolar_inference::regression::{Regression, Scatter, student_p_value};

/// Per run: the first harmonics with every other term taken from the common fit, solved for the run's own damping and
/// inertia.
pub(super) fn single_runs(
    model: &Model,
    y: &Regression,
    n: &Regression,
    observations: &[&Observation],
    oscillations: &[(&Run, &Harmonics)],
) -> Vec<SingleRun> {
    let mut runs = Vec::new();
    for (index, (run, harmonics)) in oscillations.iter().enumerate() {
        let (damping, inertia) = if run.kind == Kind::Sway { (V, VDOT) } else { (R, RDOT) };
        let mine: Vec<usize> =
            (0..observations.len()).filter(|i| observations[*i].run == index && observations[*i].term <= 2).collect();
        let [i, j] = mine[..] else { continue };
        let (a, b) = (observations[i].regressors, observations[j].regressors);
        let determinant = a[damping] * b[inertia] - a[inertia] * b[damping];
        if determinant == 0.0 {
            continue;
        }
        let solve = |fit: &Regression, coefficient: usize| {
            let common = |column: usize| model.index(column).map_or(0.0, |index| fit.parameters[index]);
            // The run's residual on top of the common derivatives.
            let (ra, rb) = (fit.residuals[i], fit.residuals[j]);
            let d = (ra * b[inertia] - rb * a[inertia]) / determinant;
            let m = (a[damping] * rb - b[damping] * ra) / determinant;
            let (va, vb) = (observations[i].variance[coefficient], observations[j].variance[coefficient]);
            let d_se = (va * b[inertia].powi(2) + vb * a[inertia].powi(2)).sqrt() / determinant.abs();
            let m_se = (vb * a[damping].powi(2) + va * b[damping].powi(2)).sqrt() / determinant.abs();
            ((common(damping) + d, d_se), (common(inertia) + m, m_se))
        };
        let ((dy, my), (dn, mn)) = (solve(y, 0), solve(n, 1));
        let amplitude = |series: &Series| series[1].hypot(series[2]);
        runs.push(SingleRun {
            run_id: run.id.clone(),
            kind: run.kind,
            frequency_hz: harmonics.frequency_hz,
            amplitude: match run.kind {
                Kind::Sway => amplitude(&harmonics.sway_m),
                _ => amplitude(&harmonics.yaw_rad).to_degrees(),
            },
            cycles: harmonics.cycles,
            damping: [dy, dn],
            inertia: [my, mn],
        });
    }
    runs
}

/// Yr and Nr from sway and turns alone, and from sway and yaw alone.
pub(super) fn turns(common: &Common, model: &Model, observations: &[Observation]) -> Vec<Comparison> {
    let without = |kind: Kind| -> Vec<&Observation> { observations.iter().filter(|o| o.kind != kind).collect() };
    let has = |kind: Kind| observations.iter().any(|o| o.kind == kind);
    if !has(Kind::Yaw) || !has(Kind::Arc) {
        return Vec::new();
    }
    // The nonlinear term in r comes from the larger of the motions only if both are there: leave it as it is for yaw, and
    // out for turns.
    let turn_model = Model { r: Form::Linear, yawing: false, ..*model };
    let Some(yaws) = solve(common, model, &without(Kind::Arc)) else { return Vec::new() };
    let Some(turns) = solve(common, &turn_model, &without(Kind::Yaw)) else { return Vec::new() };
    let of = |name, coefficient: usize| {
        Some(Comparison {
            name,
            first_from: "yaw oscillations",
            first: yaws[coefficient].estimate(model.index(R)?, "1"),
            second_from: "turns",
            second: turns[coefficient].estimate(turn_model.index(R)?, "1"),
        })
    };
    [of("Yr", 0), of("Nr", 1)].into_iter().flatten().collect()
}

/// Whether each derivative of an oscillation moves with the square of the frequency, one at a time.
pub(super) fn frequency_dependence(
    common: &Common,
    model: &Model,
    observations: &[&Observation],
) -> Vec<(&'static str, f64)> {
    let oscillating: Vec<&Observation> =
        observations.iter().copied().filter(|o| matches!(o.kind, Kind::Sway | Kind::Yaw)).collect();
    let mut frequencies: Vec<f64> = oscillating.iter().map(|o| o.frequency).collect();
    frequencies.sort_by(f64::total_cmp);
    let (Some(low), Some(high)) = (frequencies.first(), frequencies.last()) else { return Vec::new() };
    if *high < 1.3 * low {
        return Vec::new();
    }
    let mean_square = frequencies.iter().map(|f| f * f).sum::<f64>() / frequencies.len() as f64;
    let names = [
        [("Yv", V), ("Yvdot", VDOT), ("Yr", R), ("Yrdot", RDOT)],
        [("Nv", V), ("Nvdot", VDOT), ("Nr", R), ("Nrdot", RDOT)],
    ];
    let mut found = Vec::new();
    for (coefficient, names) in names.into_iter().enumerate() {
        for (name, column) in names {
            if model.index(column).is_none() {
                continue;
            }
            let mut problem = problem(common, model, &oscillating, coefficient);
            let last = problem.design.ncols();
            problem.design = problem.design.insert_column(last, 0.0);
            for (i, o) in oscillating.iter().enumerate() {
                problem.design[(i, last)] = o.regressors[column] * (o.frequency * o.frequency / mean_square - 1.0);
            }
            if let Some(fit) = problem.solve(Scatter::Scaled) {
                let t = fit.parameters[last] / fit.covariance[(last, last)].sqrt();
                found.push((name, student_p_value(t, fit.parameter_dof[last])));
            }
        }
    }
    found
}

/// `Yv'` and `Nv'` as the steady sweep has them: `Yv' = -(a0 + b) A/L^2`, `Nv' = -d0 A/L^2` with the slopes `a0` and `d0`
/// at zero drift, since a body that drifts with `v = -V sin(alpha)` feels `Y = q A (CL cos(alpha) + CD sin(alpha))`.
pub fn from_sweep(hull: &Hull, fit: &SweepFit) -> [Estimate; 2] {
    let scale = hull.frontal_area_m2() / hull.geometry.loa_m.powi(2);
    let [lift, moment] = &fit.zero_drift;
    let b = &fit.estimates.b;
    let scaled = |value: f64, se: f64, slope: &Slope| Estimate::student(-value * scale, se * scale, slope.dof, "1");
    [
        scaled(lift.estimate.value + b.value, lift.estimate.se.hypot(b.se), lift),
        scaled(moment.estimate.value, moment.estimate.se, moment),
    ]
}

/// The scatter between steady runs as Y' and N': runs are never set to quite the same angle, and the moment tells by how
/// much.
pub(super) fn between_runs(hull: &Hull, fit: &SweepFit) -> BetweenRuns {
    let scale = hull.frontal_area_m2() / hull.geometry.loa_m.powi(2);
    let e = &fit.estimates;
    [(e.a.value + e.b.value).abs() * fit.setting_rad * scale, e.d.value.abs() * fit.setting_rad * scale]
}

/// Oscillation and sweep side by side.
pub fn compare_sweep(hull: &Hull, fit: &SweepFit, dynamic: &DynamicDerivatives) -> Vec<Comparison> {
    let [yv, nv] = from_sweep(hull, fit);
    let of = |name, sweep, oscillation: &Estimate| Comparison {
        name,
        first_from: "steady sweep",
        first: sweep,
        second_from: "oscillation",
        second: oscillation.clone(),
    };
    vec![of("Yv", yv, &dynamic.yv), of("Nv", nv, &dynamic.nv)]
}
