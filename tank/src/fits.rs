//! The three-parameter model on a sweep: `CL = a alpha`, `CD = b + c alpha^2`, `CM = d alpha`, each with its interval,
//! its residuals, and whether the model is adequate at all.

use glidepolar_hull::hull_tests::{Estimate, HullFit};
use glidepolar_input::printable;

use crate::adequacy::{self, Adequacy};
use crate::angle_regression::{Basis, problem, scatter};
use crate::outlier::{self, Outlier};
use crate::series::distinct;
use crate::sweep::{NAMES, Sweep};
use crate::zero_drift::{self, Slope};
use glidepolar_inference::regression::{self, Regression, Scatter};

/// The fits of one hull.
#[derive(Debug, Clone)]
pub struct SweepFit {
    /// Angles up to this magnitude entered \[deg\].
    pub range_deg: f64,
    /// Indices of the points that entered.
    pub rows: Vec<usize>,
    /// CL, CD, CM.
    pub fits: [Regression; 3],
    /// a, b, c, d with intervals.
    pub estimates: HullFit,
    /// Slopes of CL and CM at zero drift, from all points.
    pub zero_drift: [Slope; 2],
    /// Standard deviation of the angle to which runs are set, as the scatter of the moment between runs shows it; zero
    /// where points know no errors of their own \[rad\].
    pub setting_rad: f64,
    /// Repeats against the model, for CL, CD and CM, where runs were repeated.
    pub lack_of_fit: [Option<LackOfFit>; 3],
    /// Points far off the fit to the others.
    pub outliers: Vec<Outlier>,
    /// Other forms of the model on the same points.
    pub adequacy: Adequacy,
    /// The coefficients against the range.
    pub ranges: Vec<RangePoint>,
    /// Drag against Reynolds number: exponent of the dynamic pressure in b, where speeds differ.
    pub drag_exponent: Option<Estimate>,
}

/// Scatter of repeated runs against scatter about the model (Draper and Smith, Applied Regression Analysis, 2.1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LackOfFit {
    /// Ratio of the mean squares.
    pub f: f64,
    /// Degrees of freedom of the misfit.
    pub misfit_dof: usize,
    /// Degrees of freedom of the repeats.
    pub repeat_dof: usize,
    /// Probability of so large a ratio if the model is right.
    pub p_value: f64,
}

/// The coefficients as one range gives them.
#[derive(Debug, Clone)]
pub struct RangePoint {
    /// Angles up to this magnitude entered \[deg\].
    pub range_deg: f64,
    /// Number of points.
    pub points: usize,
    /// a, b, c, d.
    pub fit: HullFit,
}

/// Why a sweep has no fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoFit {
    /// Too few points lie in the range.
    #[error(
        "points within {range_deg} deg: {found}, at {angles} different angles; expected at least 3 points at three angles or more"
    )]
    TooFewPoints {
        /// Different angles among them.
        angles: usize,
        /// Points in the range.
        found: usize,
        /// The range \[deg\].
        range_deg: f64,
    },
    /// The angles are those of a sweep in radians.
    #[error(
        "slope {name} = {per_rad:.1} per rad with angles up to {widest_deg:.3} deg: impossible for a bare hull; the angles look like radians, expected yaw_deg in degrees, in runs.csv and in the runs' files"
    )]
    Radians {
        /// The slope.
        name: &'static str,
        /// Its value \[1/rad\].
        per_rad: f64,
        /// Widest angle \[deg\].
        widest_deg: f64,
    },
}

/// Slender bodies have lift and moment slopes of one to two per radian on their frontal area (2 by slender-body theory);
/// with angles in radians taken for degrees they come out 57 times as large.
pub const STEEPEST_PER_RAD: f64 = 12.0;
/// No drift angle in radians is wider than a right angle.
const WIDEST_RAD: f64 = std::f64::consts::FRAC_PI_2;

/// Angles closer than this are one setting.
const SAME_DEG: f64 = 0.25;

/// Fits a sweep within a range of angles.
///
/// # Errors
/// Where too few points lie within the range, or their angles are in radians.
pub fn fit(sweep: &Sweep, range_deg: f64) -> Result<SweepFit, NoFit> {
    let rows = sweep.within_deg(range_deg);
    let angles = distinct(rows.iter().map(|i| sweep.points[*i].nominal_yaw_deg), |a, b| (a - b).abs() < SAME_DEG);
    let too_few = || NoFit::TooFewPoints { found: rows.len(), angles, range_deg };
    // Points at one setting differ in angle by its scatter, and a fit would follow that.
    if angles < 3 {
        return Err(too_few());
    }
    let fits = coefficients(sweep, &rows).ok_or_else(too_few)?;
    if let Some(radians) = in_radians(sweep, &fits) {
        return Err(radians);
    }
    let slope = |coefficient| zero_drift::slope(sweep, coefficient).ok_or_else(too_few);
    Ok(SweepFit {
        range_deg,
        estimates: estimates(&fits, range_deg),
        zero_drift: [slope(0)?, slope(2)?],
        setting_rad: if sweep.has_errors() { setting_rad(&fits[2]) } else { 0.0 },
        lack_of_fit: [0, 1, 2].map(|i| lack_of_fit(sweep, &rows, &fits[i])),
        outliers: outlier::find(sweep, &rows, &MODEL),
        adequacy: adequacy::test(sweep, &rows),
        ranges: ranges(sweep, range_deg),
        drag_exponent: drag_exponent(sweep, &rows, &fits[1]),
        rows,
        fits,
    })
}

/// Angles that are so narrow, and slopes so steep, as radians taken for degrees make them.
fn in_radians(sweep: &Sweep, fits: &[Regression; 3]) -> Option<NoFit> {
    let widest_deg = sweep.points.iter().map(|point| point.yaw_deg.abs()).fold(0.0, f64::max);
    let slopes = [("a", fits[0].parameters[0]), ("d", fits[2].parameters[0])];
    let (name, per_rad) = slopes.into_iter().find(|(_, slope)| slope.abs() > STEEPEST_PER_RAD)?;
    (widest_deg < WIDEST_RAD).then_some(NoFit::Radians { name, per_rad, widest_deg })
}

/// The model: functions of the angle for CL, CD, CM.
pub const MODEL: [Basis; 3] = [&[|x| x], &[|_| 1.0, |x| x * x], &[|x| x]];

fn coefficients(sweep: &Sweep, rows: &[usize]) -> Option<[Regression; 3]> {
    let solve = |i: usize| problem(sweep, rows, i, MODEL[i]).solve(scatter(sweep));
    let (lift, mut drag, moment) = (solve(0)?, solve(1)?, solve(2)?);
    if sweep.has_errors() {
        // Runs are never set to quite the same angle. The moment, least noisy and steepest, tells by how much; drag feels
        // it the more the larger the angle: by its own growth, less the lift that is turned into it with the wind axes.
        let setting_rad = setting_rad(&moment);
        let per_rad2 = 2.0 * drag.parameters[1] - lift.parameters[0];
        let mut problem = problem(sweep, rows, 1, MODEL[1]);
        for (variance, row) in problem.variance.iter_mut().zip(rows) {
            *variance += (per_rad2 * sweep.points[*row].alpha_rad() * setting_rad).powi(2);
        }
        drag = problem.solve(Scatter::BetweenRuns)?;
    }
    Some([lift, drag, moment])
}

/// Standard deviation of the angle to which runs are set, as the moment shows it \[rad\].
fn setting_rad(moment: &Regression) -> f64 {
    moment.between_runs / moment.parameters[0].abs()
}

fn estimates(fits: &[Regression; 3], range_deg: f64) -> HullFit {
    HullFit {
        range_deg,
        a: fits[0].estimate(0, "1/rad"),
        b: fits[1].estimate(0, "1"),
        c: fits[1].estimate(1, "1/rad^2"),
        d: fits[2].estimate(0, "1/rad"),
    }
}

/// Runs asked for at the same angle and speed are repeats of each other.
fn lack_of_fit(sweep: &Sweep, rows: &[usize], fit: &Regression) -> Option<LackOfFit> {
    let key = |i: usize| {
        let point = &sweep.points[rows[i]];
        (point.nominal_yaw_deg, point.nominal_speed_m_s)
    };
    let mut is_done = vec![false; rows.len()];
    let (mut repeat_dof, mut pure) = (0, 0.0);
    for i in 0..rows.len() {
        if std::mem::replace(&mut is_done[i], true) {
            continue;
        }
        let alike: Vec<usize> = (i..rows.len()).filter(|j| key(*j) == key(i)).collect();
        let weight: f64 = alike.iter().map(|j| fit.weights[*j]).sum();
        let mean = alike.iter().map(|j| fit.weights[*j] * fit.residuals[*j]).sum::<f64>() / weight;
        pure += alike.iter().map(|j| fit.weights[*j] * (fit.residuals[*j] - mean).powi(2)).sum::<f64>();
        repeat_dof += alike.len() - 1;
        alike.into_iter().for_each(|j| is_done[j] = true);
    }
    let misfit_dof = fit.dof.checked_sub(repeat_dof).filter(|dof| *dof > 0)?;
    if repeat_dof == 0 {
        return None;
    }
    let total = fit.chi2_per_dof * fit.dof as f64;
    let f = ((total - pure).max(0.0) / misfit_dof as f64) / (pure / repeat_dof as f64);
    let p_value = regression::f_p_value(f, misfit_dof as f64, repeat_dof as f64);
    Some(LackOfFit { f, misfit_dof, repeat_dof, p_value })
}

/// The fit at every range from a third of the widest angle on, at most a dozen, the chosen one and its neighbours among
/// them.
fn ranges(sweep: &Sweep, range_deg: f64) -> Vec<RangePoint> {
    let mut angles: Vec<f64> = sweep.points.iter().map(|p| p.nominal_yaw_deg.abs()).collect();
    angles.sort_by(f64::total_cmp);
    // Angles closer than a quarter of a degree are one setting.
    let mut steps: Vec<f64> = Vec::new();
    for angle in angles {
        match steps.last_mut() {
            Some(last) if angle - *last < 0.25 && (angle <= range_deg) == (*last <= range_deg) => *last = angle,
            _ => steps.push(angle),
        }
    }
    let widest = steps.last().copied().unwrap_or(0.0);
    steps.retain(|angle| *angle >= 0.3 * range_deg.min(widest));
    while steps.len() > 12 {
        // Thin out where the chosen range is far.
        let far = (0..steps.len() - 1).max_by(|i, j| {
            let distance = |i: usize| (steps[i] - range_deg).abs() / (steps[i + 1] - steps[i]).max(1e-3);
            distance(*i).total_cmp(&distance(*j))
        });
        steps.remove(far.unwrap_or(0));
    }
    steps
        .into_iter()
        .filter_map(|range_deg| {
            let rows = sweep.within_deg(range_deg);
            let fits = coefficients(sweep, &rows)?;
            Some(RangePoint { range_deg, points: rows.len(), fit: estimates(&fits, range_deg) })
        })
        .collect()
}

/// The exponent `s` of `b ~ q^s`, by adding `b ln(q/q0)` to the drag model, linear for small exponents.
fn drag_exponent(sweep: &Sweep, rows: &[usize], drag: &Regression) -> Option<Estimate> {
    let pressures: Option<Vec<f64>> = rows.iter().map(|i| sweep.points[*i].dynamic_pressure_Pa).collect();
    let logs: Vec<f64> = pressures?.into_iter().map(f64::ln).collect();
    let mean = logs.iter().sum::<f64>() / logs.len() as f64;
    let spread = logs.iter().map(|l| (l - mean).abs()).fold(0.0, f64::max);
    let b = drag.parameters[0];
    // Speeds that differ by less than a tenth say nothing.
    if spread < 0.2 || b <= 0.0 {
        return None;
    }
    let mut problem = problem(sweep, rows, 1, MODEL[1]);
    problem.design = problem.design.insert_column(2, 0.0);
    for (i, log) in logs.iter().enumerate() {
        problem.design[(i, 2)] = b * (log - mean);
    }
    Some(problem.solve(scatter(sweep))?.estimate(2, "1"))
}

/// What a reader of the fits has to know, hull by hull.
pub fn warnings(id: &str, fit: &SweepFit) -> Vec<String> {
    let mut warnings = Vec::new();
    for Outlier { run_id, coefficient, value, expected } in &fit.outliers {
        warnings.push(format!(
            "{id}: run {} has {coefficient} = {value:.4} where the others lead to expect {expected:.4}: other units, another hull, another angle? It is still in the fit",
            printable(run_id)
        ));
    }
    warnings.extend(range_warning(id, fit));
    for (i, lack) in fit.lack_of_fit.iter().enumerate() {
        if let Some(lack) = lack
            && lack.p_value < 1e-4
        {
            warnings.push(format!(
                "{id}: {} departs from its model by more than repeats scatter (F = {:.1} on {} and {}, p = {:.1e})",
                NAMES[i], lack.f, lack.misfit_dof, lack.repeat_dof, lack.p_value
            ));
        }
    }
    if let Some(s) = &fit.drag_exponent
        && s.value.abs() > 4.5 * s.se
    {
        warnings.push(format!(
            "{id}: drag depends on Reynolds number, b ~ q^({:.3} +- {:.3}); the b given is a mean over the speeds",
            s.value, s.se
        ));
    }
    warnings
}

/// Whether another range would have given another coefficient.
fn range_warning(id: &str, fit: &SweepFit) -> Option<String> {
    let mut moved: Vec<(&str, String)> = Vec::new();
    for (i, name) in ["a", "b", "c", "d"].into_iter().enumerate() {
        let of = |fit: &HullFit| [&fit.a, &fit.b, &fit.c, &fit.d][i].clone();
        let here = of(&fit.estimates);
        // Nested samples: the variance of the difference is the difference of the variances. Twice the 95 % half-width
        // leaves chance little room, few points or many.
        let half = |q: &Estimate| 0.5 * (q.ci95[1] - q.ci95[0]);
        let differs = |other: &&RangePoint| {
            let there = of(&other.fit);
            let allowed = (half(&there).powi(2) - half(&here).powi(2)).abs().sqrt();
            let change = (there.value - here.value).abs();
            change > 2.0 * allowed && change > 0.05 * here.value.abs()
        };
        let mut off = fit.ranges.iter().filter(|r| (r.range_deg - fit.range_deg).abs() > 0.05 && r.points >= 5);
        let Some(worst) = off.rfind(differs) else { continue };
        let next = fit.ranges.iter().find(|r| r.range_deg > fit.range_deg + 1e-9);
        let mut text = format!("{name} = {:.3} within {} deg", here.value, fit.range_deg);
        if let Some(next) = next.filter(|next| next.range_deg < worst.range_deg) {
            text += &format!(", {:.3} within {} deg", of(&next.fit).value, next.range_deg);
        }
        text += &format!(", {:.3} within {} deg", of(&worst.fit).value, worst.range_deg);
        moved.push((name, text));
    }
    if moved.is_empty() {
        return None;
    }
    let names: Vec<&str> = moved.iter().map(|(name, _)| *name).collect();
    let texts: Vec<&str> = moved.iter().map(|(_, text)| text.as_str()).collect();
    let (verb, model) = if names.len() == 1 { ("depends", "model differs") } else { ("depend", "models differ") };
    Some(format!(
        "{id}: {} {verb} on the range of angles: {}; the {model} in kind from the readings",
        names.join(", "),
        texts.join("; ")
    ))
}
