//! What oscillations and turns say, as numbers for the regression: harmonic terms of force and moment about the centre of
//! buoyancy in primes, the regressors that the measured motion makes, noise, and the influence of errors that runs share.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::noise::Spectrum;
use super::{BetweenRuns, SteadySlopes};
use crate::campaign::{Kind, Run};
use crate::harmonics::{HARMONICS, Harmonics, Series, TERMS};
use crate::hull::Hull;
use crate::influence::Influence;
use crate::motion::Motion;
use crate::shared::{Common, SharedKind};
use crate::steady_run::SteadyRun;

/// Phases at which one cycle is worked out.
const PHASES: usize = 96;
/// The terms that are compared: cosine and sine of first and third harmonic.
const COMPARED: [usize; 4] = [1, 2, 5, 6];
/// Weight of a run's own noise against that of all runs at its speed, in degrees of freedom: a line of the carriage's
/// vibration near a harmonic shows in its own record only.
const OWN_NOISE_DOF: f64 = 4.0;
const COMMON_NOISE_DOF: f64 = 30.0;

/// One number to be explained: a harmonic term of an oscillation, the mean of a turn, or a slope of the steady sweep.
#[derive(Debug, Clone)]
pub(super) struct Observation {
    pub run: usize,
    pub kind: Kind,
    pub term: usize,
    /// v, v^3/V, v|v|, r, r^3/V, r|r|, vdot, rdot.
    pub regressors: [f64; 8],
    /// Y', N'.
    pub force: [f64; 2],
    pub variance: [f64; 2],
    /// Of each shared error on Y' and N'.
    pub shared: Vec<Influence>,
    /// Reduced frequency.
    pub frequency: f64,
}

/// All oscillations of a hull, noise shared among them.
pub(super) fn oscillations(common: &Common, hull: &Hull, runs: &[(&Run, &Harmonics)]) -> Vec<Observation> {
    let spectra = [0, 1].map(|coefficient| {
        let at = |run: &Run, harmonics: &Harmonics, hz: f64, covariance: &Matrix3<f64>| {
            let variance = primes_of(common, hull, run, harmonics, covariance)[coefficient];
            (run.speed_m_s, hz, variance * harmonics.effective_s)
        };
        let points = runs.iter().flat_map(|(run, h)| h.spectrum.iter().map(move |(hz, c)| at(run, h, *hz, c)));
        Spectrum::fit(&points.collect::<Vec<_>>())
    });
    let mut observations = Vec::new();
    for (index, (run, harmonics)) in runs.iter().enumerate() {
        for mut observation in oscillation(common, hull, index, run, harmonics) {
            let hz = harmonics.frequency_hz * observation.term.div_ceil(2) as f64;
            for (variance, spectrum) in observation.variance.iter_mut().zip(&spectra) {
                let shared = spectrum.density(run.speed_m_s, hz) / harmonics.effective_s;
                *variance =
                    (OWN_NOISE_DOF * *variance + COMMON_NOISE_DOF * shared) / (OWN_NOISE_DOF + COMMON_NOISE_DOF);
            }
            observations.push(observation);
        }
    }
    observations
}

/// Variances of Y' and N' where the readings have this covariance.
fn primes_of(common: &Common, hull: &Hull, run: &Run, harmonics: &Harmonics, covariance: &Matrix3<f64>) -> [f64; 2] {
    let interaction = common.balance.interaction;
    let of_force = interaction * covariance * interaction.transpose();
    let rows = to_primes(run.water.density_kg_m3, hull, harmonics.speed_m_s);
    rows.map(|row| (row.transpose() * of_force * row)[(0, 0)])
}

fn oscillation(common: &Common, hull: &Hull, index: usize, run: &Run, harmonics: &Harmonics) -> Vec<Observation> {
    let density = run.water.density_kg_m3;
    let length = hull.geometry.loa_m;
    let speed = harmonics.speed_m_s;
    let cycle = Cycle::new(common, hull, run, harmonics);
    let to_primes = to_primes(density, hull, speed);
    let map = stacked(&to_primes);
    let kinds = common.shared();
    COMPARED
        .iter()
        .map(|&term| {
            let at = |series: &[Series; 3]| Vector3::from_fn(|channel, _| series[channel][term]);
            let (force, strut) = (at(&cycle.force), at(&cycle.strut));
            let water = force - strut + at(&cycle.inertia);
            let shared = kinds
                .iter()
                .map(|kind| match kind {
                    SharedKind::Tare(channel) => {
                        let series = &cycle.strut_gradients[*channel];
                        let of_terms = DVector::from_iterator(series.len(), series.iter().map(|s| -s[term]));
                        common.tare_influence(*channel, &of_terms).through(&map.columns(*channel, 1).into_owned())
                    }
                    SharedKind::Interaction => common.interaction_influence(force - strut).through(&map),
                    // Alike on one side and opposite on the other: a square wave in step with the load.
                    SharedKind::Calibration => common.calibration_influence(at(&cycle.side)).through(&map),
                    // The zero is constant over a run: it stands in the mean only.
                    SharedKind::Zeros => Influence::none(2),
                    // No more than a share of a derivative that is far below what the harmonics are known to.
                    SharedKind::Speed => Influence::none(2),
                })
                .collect();
            Observation {
                run: index,
                kind: run.kind,
                term,
                regressors: cycle.regressors.map(|series| series[term]),
                force: to_primes.map(|row| row.dot(&water)),
                variance: primes_of(common, hull, run, harmonics, &harmonics.noise[(term - 1) / 2]),
                shared,
                frequency: std::f64::consts::TAU * harmonics.frequency_hz * length / speed,
            }
        })
        .collect()
}

/// One cycle as the motion and the balance show it, harmonic by harmonic.
struct Cycle {
    /// AF, SF, YM through the interaction matrix.
    force: [Series; 3],
    /// Of the strut, to be taken away.
    strut: [Series; 3],
    /// To be added.
    inertia: [Series; 3],
    /// Sign of the load.
    side: [Series; 3],
    regressors: [Series; 8],
    /// Of the strut's force in each channel, with the tare's parameters.
    strut_gradients: [Vec<Series>; 3],
}

impl Cycle {
    fn new(common: &Common, hull: &Hull, run: &Run, harmonics: &Harmonics) -> Cycle {
        let density = run.water.density_kg_m3;
        let zero: Series = [0.0; TERMS];
        let mut cycle = Cycle {
            force: [zero; 3],
            strut: [zero; 3],
            inertia: [zero; 3],
            side: [zero; 3],
            regressors: [zero; 8],
            strut_gradients: [0, 1, 2].map(|channel| vec![zero; common.tare.map_or(0, |tare| tare.terms(channel))]),
        };
        for term in 0..TERMS {
            let raw = Vector3::from_fn(|channel, _| harmonics.readings[channel][term]);
            let force = common.balance.interaction * raw;
            (0..3).for_each(|channel| cycle.force[channel][term] = force[channel]);
        }
        for i in 0..PHASES {
            let phase = std::f64::consts::TAU * i as f64 / PHASES as f64;
            let motion = Motion::oscillating(harmonics, phase);
            if let Some(tare) = common.tare {
                add(&mut cycle.strut, tare.force(&motion, density), phase);
                for (channel, series) in cycle.strut_gradients.iter_mut().enumerate() {
                    let gradient = tare.gradient(channel, &motion, density);
                    series.iter_mut().zip(gradient.iter()).for_each(|(s, value)| accumulate(s, *value, phase));
                }
            }
            add(&mut cycle.inertia, motion.inertia(hull), phase);
            let load = Vector3::from_fn(|channel, _| {
                // The mean holds the zero: only what swings tells the side.
                oscillating_part(&cycle.force[channel], phase)
            });
            add(&mut cycle.side, load.map(f64::signum), phase);
            let values = regressors_of(&motion.at_cb(hull.cb_aft_of_mc_m()), harmonics.speed_m_s, hull.geometry.loa_m);
            cycle.regressors.iter_mut().zip(values).for_each(|(s, value)| accumulate(s, value, phase));
        }
        cycle
    }
}

/// A turn by its mean.
pub(super) fn turn(
    common: &Common,
    hull: &Hull,
    index: usize,
    turn: &SteadyRun,
    between_runs: BetweenRuns,
) -> Observation {
    let speed = turn.motion.speed();
    let rows = to_primes(turn.run.water.density_kg_m3, hull, speed);
    let force = turn.steps.force - turn.steps.tare + turn.motion.inertia(hull);
    let shared =
        common.shared().into_iter().map(|kind| common.influence(kind, turn).through(&stacked(&rows))).collect();
    let own = rows.map(|row| (row.transpose() * turn.covariance * row)[(0, 0)]);
    Observation {
        run: index,
        kind: Kind::Arc,
        term: 0,
        regressors: regressors_of(&turn.motion.at_cb(hull.cb_aft_of_mc_m()), speed, hull.geometry.loa_m),
        force: rows.map(|row| row.dot(&force)),
        variance: [own[0] + between_runs[0].powi(2), own[1] + between_runs[1].powi(2)],
        shared,
        frequency: 0.0,
    }
}

/// The slopes of the steady sweep, where no sway run tells `Yv` and `Nv`.
pub(super) fn steady(common: &Common, index: usize, slopes: &SteadySlopes) -> Observation {
    let mut regressors = [0.0; 8];
    regressors[0] = 1.0;
    Observation {
        run: index,
        kind: Kind::Static,
        term: 0,
        regressors,
        force: [slopes[0].value, slopes[1].value],
        variance: [slopes[0].se.powi(2), slopes[1].se.powi(2)],
        shared: common.shared().iter().map(|_| Influence::none(2)).collect(),
        frequency: 0.0,
    }
}

/// Rows that make Y' and N' about the centre of buoyancy of AF, SF, YM about the moment centre.
fn to_primes(density: f64, hull: &Hull, speed: f64) -> [Vector3<f64>; 2] {
    let (length, lever) = (hull.geometry.loa_m, hull.cb_aft_of_mc_m());
    let side = 1.0 / (0.5 * density * length * length * speed * speed);
    [Vector3::new(0.0, side, 0.0), Vector3::new(0.0, lever * side / length, side / length)]
}

/// The rows as a matrix.
fn stacked(rows: &[Vector3<f64>; 2]) -> DMatrix<f64> {
    DMatrix::from_fn(2, 3, |i, j| rows[i][j])
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

fn add(series: &mut [Series; 3], value: Vector3<f64>, phase: f64) {
    (0..3).for_each(|channel| accumulate(&mut series[channel], value[channel], phase));
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

fn oscillating_part(series: &Series, phase: f64) -> f64 {
    let term = |k: usize| {
        let (sine, cosine) = (k as f64 * phase).sin_cos();
        series[2 * k - 1] * cosine + series[2 * k] * sine
    };
    (1..=HARMONICS).map(term).sum()
}
