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

use glidepolar::hull_tests::{DynamicDerivatives, Estimate};
use nalgebra::{DMatrix, DVector, Vector3};

use crate::campaign::{Kind, Run};
use crate::harmonics::{HARMONICS, Harmonics, Series, TERMS};
use crate::hull::Hull;
use crate::motion::Motion;
use crate::readings::Readings;
use crate::regression::{Fit, Problem, Scatter, Shared, estimate};
use crate::statics::{Common, SharedKind, SteadyRun, share_variances};

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
    /// Smallest and largest reduced frequency `omega L/U`.
    pub reduced_frequencies: (f64, f64),
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

/// Phases at which one cycle is worked out.
const PHASES: usize = 96;
/// The terms that are compared: cosine and sine of first and third harmonic.
const COMPARED: [usize; 4] = [1, 2, 5, 6];
/// Amplitudes must differ by this factor to tell a nonlinear term.
const AMPLITUDE_RATIO: f64 = 1.3;
/// A form must be better by this much to be preferred to the cubic one.
const CLEARLY_BETTER: f64 = 6.0;
/// Degrees of freedom of a run's own noise at one harmonic.
const NOISE_DOF: f64 = 8.0;

/// One number to be explained: a harmonic term of an oscillation, or the mean of a turn.
#[derive(Debug, Clone)]
struct Observation {
    run: usize,
    kind: Kind,
    term: usize,
    /// v, v^3/V, v|v|, r, r^3/V, r|r|, vdot, rdot.
    regressors: [f64; 8],
    /// Y', N'.
    force: [f64; 2],
    variance: [f64; 2],
    /// Influence of each shared error on Y' and N'.
    shared: Vec<[DVector<f64>; 2]>,
    frequency: f64,
}

/// Scatter between steady runs beyond their own noise, in Y' and N'.
pub type BetweenRuns = [f64; 2];

/// Fits a hull's oscillations and turns; none if the sway runs are too few for a derivative.
pub fn of(
    common: &Common,
    hull: &Hull,
    oscillations: &[(&Run, &Readings, &Harmonics)],
    turns: &[SteadyRun],
    between_runs: BetweenRuns,
) -> Option<Derivatives> {
    let mut observations = Vec::new();
    for (i, (run, readings, harmonics)) in oscillations.iter().enumerate() {
        observations.extend(oscillation(common, hull, i, run, readings, harmonics));
    }
    pool_noise(&mut observations);
    let first_turn = oscillations.len();
    for (i, turn) in turns.iter().enumerate() {
        observations.push(turn_observation(common, hull, first_turn + i, turn, between_runs));
    }
    let ids: Vec<&str> = oscillations
        .iter()
        .map(|(run, ..)| run.id.as_str())
        .chain(turns.iter().map(|turn| turn.run.id.as_str()))
        .collect();
    let all: Vec<&Observation> = observations.iter().collect();
    let model = best_model(common, &all)?;
    let [y, n] = solve(common, &model, &all)?;
    let estimates = named(&model, &y, &n)?;
    let residual = |(i, o): (usize, &&Observation)| Residual {
        run_id: ids[o.run].to_owned(),
        term: o.term,
        left: [y.residuals[i], n.residuals[i]],
        se: o.variance.map(f64::sqrt),
    };
    let frequencies = || {
        oscillations.iter().map(|(_, _, h)| std::f64::consts::TAU * h.frequency_hz * hull.geometry.loa_m / h.speed_m_s)
    };
    Some(Derivatives {
        nonlinear: nonlinear(&model, &y, &n),
        forms: (model.v, model.r),
        chi2_per_dof: [y.chi2_per_dof, n.chi2_per_dof],
        runs: single_runs(&model, &y, &n, &all, oscillations),
        turns: compare_turns(common, &model, &observations),
        reduced_frequencies: (frequencies().fold(f64::INFINITY, f64::min), frequencies().fold(0.0, f64::max)),
        frequency_dependence: frequency_dependence(common, &model, &all),
        residuals: all.iter().enumerate().map(residual).collect(),
        estimates,
    })
}

/// Which terms the model has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Model {
    v: Form,
    r: Form,
    turning: bool,
    yawing: bool,
}

impl Model {
    /// Columns of the regressors, the derivatives first: v, vdot, r, rdot, then the nonlinear ones.
    fn columns(&self) -> Vec<usize> {
        let mut columns = vec![0, 6];
        columns.extend(self.turning.then_some(3));
        columns.extend(self.yawing.then_some(7));
        columns.extend(nonlinear_column(self.v, 1));
        columns.extend(if self.turning { nonlinear_column(self.r, 4) } else { None });
        columns
    }

    fn index(&self, column: usize) -> Option<usize> {
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

fn oscillation(
    common: &Common,
    hull: &Hull,
    index: usize,
    run: &Run,
    readings: &Readings,
    harmonics: &Harmonics,
) -> Vec<Observation> {
    let density = run.water.density_kg_m3;
    let length = hull.geometry.loa_m;
    let lever = hull.cb_aft_of_mc_m();
    let speed = harmonics.speed_m_s;
    let interaction = common.balance.interaction;
    let kinds = common.shared();
    let zero = common.zeros.at(run, readings, harmonics.middle_s).map(|zero| zero.reading).unwrap_or_default();
    // One cycle of the model's motion: what goes into the force beside the water's, and the regressors.
    let mut beside = [[0.0; TERMS]; 3];
    let mut regressors = [[0.0; TERMS]; 8];
    let mut gradients: Vec<Vec<Series>> = Vec::new();
    for channel in 0..3 {
        let size = common.tare.map_or(0, |tare| tare.covariance(channel).0.nrows());
        gradients.push(vec![[0.0; TERMS]; size]);
    }
    for i in 0..PHASES {
        let phase = std::f64::consts::TAU * i as f64 / PHASES as f64;
        let motion = Motion::oscillating(harmonics, phase);
        let mut extra = motion.inertia(hull);
        if let Some(tare) = common.tare {
            extra -= tare.force(&motion, density);
            for (channel, series) in gradients.iter_mut().enumerate() {
                let gradient = tare.gradient(channel, &motion, density);
                series.iter_mut().zip(gradient.iter()).for_each(|(series, value)| accumulate(series, *value, phase));
            }
        }
        (0..3).for_each(|channel| accumulate(&mut beside[channel], extra[channel], phase));
        let values = regressors_of(&motion.at_cb(lever), speed, length);
        regressors.iter_mut().zip(values).for_each(|(series, value)| accumulate(series, value, phase));
    }
    COMPARED
        .iter()
        .map(|&term| {
            let raw = Vector3::from_fn(|c, _| harmonics.readings[c][term]);
            // The zero is constant over a run: it stands in the mean only.
            let reading = if term == 0 { raw - zero } else { raw };
            let force = interaction * reading + Vector3::from_fn(|c, _| beside[c][term]);
            let noise = interaction * harmonics.noise[(term - 1) / 2] * interaction.transpose();
            let to_primes = to_primes(density, length, speed, lever);
            let shared = kinds
                .iter()
                .map(|kind| match kind {
                    SharedKind::Tare(channel) => {
                        let series = &gradients[*channel];
                        let on_force = DVector::from_iterator(series.len(), series.iter().map(|s| -s[term]));
                        to_primes.map(|row| &on_force * row[*channel])
                    }
                    other => {
                        let size = common.covariance(*other).0.nrows();
                        [DVector::zeros(size), DVector::zeros(size)]
                    }
                })
                .collect();
            Observation {
                run: index,
                kind: run.kind,
                term,
                regressors: regressors.map(|series| series[term]),
                force: to_primes.map(|row| row.dot(&force)),
                variance: to_primes.map(|row| (row.transpose() * noise * row)[(0, 0)]),
                shared,
                frequency: std::f64::consts::TAU * harmonics.frequency_hz * length / speed,
            }
        })
        .collect()
}

fn turn_observation(
    common: &Common,
    hull: &Hull,
    index: usize,
    turn: &SteadyRun,
    between_runs: BetweenRuns,
) -> Observation {
    let (length, lever) = (hull.geometry.loa_m, hull.cb_aft_of_mc_m());
    let speed = turn.motion.speed();
    let rows = to_primes(turn.run.water.density_kg_m3, length, speed, lever);
    let force = turn.steps.water();
    let shared = common
        .shared()
        .into_iter()
        .map(|kind| {
            let influence = common.influence(kind, turn);
            rows.map(|row| (row.transpose() * &influence).transpose())
        })
        .map(|pair| pair.map(|column| DVector::from_column_slice(column.as_slice())))
        .collect();
    let own = rows.map(|row| (row.transpose() * turn.covariance * row)[(0, 0)]);
    Observation {
        run: index,
        kind: Kind::Arc,
        term: 0,
        regressors: regressors_of(&turn.motion.at_cb(lever), speed, length),
        force: rows.map(|row| row.dot(&force)),
        variance: [own[0] + between_runs[0].powi(2), own[1] + between_runs[1].powi(2)],
        shared,
        frequency: 0.0,
    }
}

/// Rows that make Y' and N' about the centre of buoyancy of AF, SF, YM about the moment centre.
fn to_primes(density: f64, length: f64, speed: f64, lever: f64) -> [Vector3<f64>; 2] {
    let side = 1.0 / (0.5 * density * length * length * speed * speed);
    [Vector3::new(0.0, side, 0.0), Vector3::new(0.0, lever * side / length, side / length)]
}

fn regressors_of(motion: &Motion, speed: f64, length: f64) -> [f64; 8] {
    let momentary = motion.speed() / speed;
    let (v, r) = (motion.v / speed, motion.r * length / speed);
    let rate = length / (speed * speed);
    [
        v * momentary,
        v.powi(3) / momentary,
        v * v.abs(),
        r * momentary,
        r.powi(3) / momentary,
        r * r.abs(),
        motion.vdot() * rate,
        motion.rdot * rate * length,
    ]
}

/// Adds one phase to a series' terms.
fn accumulate(series: &mut Series, value: f64, phase: f64) {
    series[0] += value / PHASES as f64;
    for k in 1..=HARMONICS {
        let (sine, cosine) = (k as f64 * phase).sin_cos();
        series[2 * k - 1] += 2.0 / PHASES as f64 * value * cosine;
        series[2 * k] += 2.0 / PHASES as f64 * value * sine;
    }
}

/// Noise at one absolute frequency is the same for all runs: one record tells it poorly.
fn pool_noise(observations: &mut [Observation]) {
    let keys: Vec<f64> =
        observations.iter().map(|o| (o.frequency * o.term.div_ceil(2) as f64 * 100.0).round()).collect();
    for coefficient in 0..2 {
        let variances: Vec<f64> = observations.iter().map(|o| o.variance[coefficient]).collect();
        let shared = share_variances(&variances, &keys, NOISE_DOF);
        observations.iter_mut().zip(shared).for_each(|(o, variance)| o.variance[coefficient] = variance);
    }
}

/// The forms of the nonlinear terms that fit best; the cubic ones unless others are clearly better.
fn best_model(common: &Common, observations: &[&Observation]) -> Option<Model> {
    let has = |kind: Kind| observations.iter().any(|o| o.kind == kind);
    if !has(Kind::Sway) {
        return None;
    }
    let turning = has(Kind::Yaw) || has(Kind::Arc);
    let varied = |kinds: &[Kind], column: usize| {
        let sizes = observations.iter().filter(|o| kinds.contains(&o.kind)).map(|o| o.regressors[column].abs());
        let (low, high) = sizes.filter(|s| *s > 1e-4).fold((f64::INFINITY, 0.0f64), |(l, h), s| (l.min(s), h.max(s)));
        high > AMPLITUDE_RATIO * low
    };
    let forms = |varied: bool| -> &[Form] { if varied { &[Form::Cubic, Form::Absolute] } else { &[Form::Linear] } };
    let v_forms = forms(varied(&[Kind::Sway], 0));
    let r_forms = forms(turning && varied(&[Kind::Yaw, Kind::Arc], 3));
    let mut best: Option<(f64, Model)> = None;
    for &v in v_forms {
        for &r in r_forms {
            let model = Model { v, r, turning, yawing: has(Kind::Yaw) };
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

fn problem(common: &Common, model: &Model, observations: &[&Observation], coefficient: usize) -> Problem {
    let columns = model.columns();
    let n = observations.len();
    let kinds = common.shared();
    let shared = kinds.iter().enumerate().map(|(k, kind)| {
        let (covariance, dof) = common.covariance(*kind);
        let influence = DMatrix::from_fn(n, covariance.nrows(), |i, j| observations[i].shared[k][coefficient][j]);
        Shared { influence, covariance, dof }
    });
    Problem {
        design: DMatrix::from_fn(n, columns.len(), |i, j| observations[i].regressors[columns[j]]),
        observed: DVector::from_iterator(n, observations.iter().map(|o| o.force[coefficient])),
        variance: DVector::from_iterator(n, observations.iter().map(|o| o.variance[coefficient])),
        shared: shared.collect(),
    }
}

fn solve(common: &Common, model: &Model, observations: &[&Observation]) -> Option<[Fit; 2]> {
    let one = |coefficient| problem(common, model, observations, coefficient).solve(Scatter::Scaled);
    Some([one(0)?, one(1)?])
}

fn named(model: &Model, y: &Fit, n: &Fit) -> Option<DynamicDerivatives> {
    let of = |fit: &Fit, column: usize| model.index(column).map(|index| fit.estimate(index, "1"));
    Some(DynamicDerivatives {
        yv: of(y, 0)?,
        nv: of(n, 0)?,
        yr: of(y, 3),
        nr: of(n, 3),
        yvdot: of(y, 6),
        nvdot: of(n, 6),
        yrdot: of(y, 7),
        nrdot: of(n, 7),
    })
}

fn nonlinear(model: &Model, y: &Fit, n: &Fit) -> Vec<(String, Estimate)> {
    let mut found = Vec::new();
    for (symbol, form, first) in [("v", model.v, 1), ("r", model.r, 4)] {
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

/// Per run: the first harmonics with every other term taken from the common fit, solved for the run's own damping and
/// inertia.
fn single_runs(
    model: &Model,
    y: &Fit,
    n: &Fit,
    observations: &[&Observation],
    oscillations: &[(&Run, &Readings, &Harmonics)],
) -> Vec<SingleRun> {
    let mut runs = Vec::new();
    for (index, (run, _, harmonics)) in oscillations.iter().enumerate() {
        let (damping, inertia) = if run.kind == Kind::Sway { (0, 6) } else { (3, 7) };
        let mine: Vec<usize> =
            (0..observations.len()).filter(|i| observations[*i].run == index && observations[*i].term <= 2).collect();
        let [i, j] = mine[..] else { continue };
        let (a, b) = (observations[i].regressors, observations[j].regressors);
        let determinant = a[damping] * b[inertia] - a[inertia] * b[damping];
        if determinant == 0.0 {
            continue;
        }
        let solve = |fit: &Fit, coefficient: usize| {
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
fn compare_turns(common: &Common, model: &Model, observations: &[Observation]) -> Vec<Comparison> {
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
            first: yaws[coefficient].estimate(model.index(3)?, "1"),
            second_from: "turns",
            second: turns[coefficient].estimate(turn_model.index(3)?, "1"),
        })
    };
    [of("Yr", 0), of("Nr", 1)].into_iter().flatten().collect()
}

/// Whether each derivative of an oscillation moves with the square of the frequency, one at a time.
fn frequency_dependence(common: &Common, model: &Model, observations: &[&Observation]) -> Vec<(&'static str, f64)> {
    let oscillating: Vec<&Observation> = observations.iter().copied().filter(|o| o.kind != Kind::Arc).collect();
    let mut frequencies: Vec<f64> = oscillating.iter().map(|o| o.frequency).collect();
    frequencies.sort_by(f64::total_cmp);
    let (Some(low), Some(high)) = (frequencies.first(), frequencies.last()) else { return Vec::new() };
    if *high < 1.3 * low {
        return Vec::new();
    }
    let mean_square = frequencies.iter().map(|f| f * f).sum::<f64>() / frequencies.len() as f64;
    let names =
        [[("Yv", 0), ("Yvdot", 6), ("Yr", 3), ("Yrdot", 7)], [("Nv", 0), ("Nvdot", 6), ("Nr", 3), ("Nrdot", 7)]];
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
                found.push((name, crate::regression::student_p_value(t, fit.parameter_dof[last])));
            }
        }
    }
    found
}

/// `Yv'` and `Nv'` as the steady sweep has them: `Yv' = -(a + b) A/L^2`, `Nv' = -d A/L^2`, since a body that drifts with
/// `v = -V sin(alpha)` feels `Y = q A (CL cos(alpha) + CD sin(alpha))`.
pub fn from_sweep(hull: &Hull, fit: &crate::fits::SweepFit) -> [Estimate; 2] {
    let scale = hull.frontal_area_m2() / hull.geometry.loa_m.powi(2);
    let e = &fit.estimates;
    let dof = |i: usize, j: usize| fit.fits[i].parameter_dof[j];
    let slope =
        estimate(-(e.a.value + e.b.value) * scale, (e.a.se.powi(2) + e.b.se.powi(2)) * scale * scale, dof(0, 0), "1");
    [slope, estimate(-e.d.value * scale, (e.d.se * scale).powi(2), dof(2, 0), "1")]
}

/// The scatter between steady runs as Y' and N': runs are never set to quite the same angle, and the moment tells by how
/// much.
pub fn between_runs(hull: &Hull, fit: &crate::fits::SweepFit) -> BetweenRuns {
    let scale = hull.frontal_area_m2() / hull.geometry.loa_m.powi(2);
    let e = &fit.estimates;
    [(e.a.value + e.b.value).abs() * fit.setting_rad * scale, e.d.value.abs() * fit.setting_rad * scale]
}

/// Oscillation and sweep side by side.
pub fn compare_sweep(hull: &Hull, fit: &crate::fits::SweepFit, dynamic: &DynamicDerivatives) -> Vec<Comparison> {
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
