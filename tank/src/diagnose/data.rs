//! What a diagnosis is given of a campaign, or of a table of points: the steady drift runs, reduced, with all that they may
//! have to do with.

use nalgebra::{DMatrix, DVector, Matrix3, Matrix3xX, Vector3};

use crate::hull::Hull;
use crate::influence::Influence;
use crate::shared::{Common, SharedKind};
use crate::steady_run::SteadyRun;
use crate::sweep::{Point, Sweep};
use crate::tare::Tare;
use crate::water::Water;

/// Steady drift runs of one campaign.
#[derive(Debug, Clone, Default)]
pub struct Data {
    /// The hulls.
    pub hulls: Vec<Hull>,
    /// The runs, hull after hull.
    pub runs: Vec<SteadyData>,
    /// Whether the runs are raw ones, with zeros and a strut, and not points that came reduced.
    pub is_raw: bool,
    /// How the strut was tared; reduced points are taken to be at angles.
    pub tared: Tared,
    /// Whether every run says when it began.
    pub in_time: bool,
    /// The tare runs' own zeros, in time, channel by channel alike.
    pub tare_zeros: Vec<ZeroTimes>,
    /// The zero runs.
    pub zero_runs: Vec<ZeroRun>,
}

/// At which angles the strut was towed alone.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Tared {
    /// At none: its force is still in the coefficients.
    #[default]
    Never,
    /// Straight ahead: its side force at drift angles is.
    Ahead,
    /// At angles.
    AtAngles,
}

/// One zero run.
#[derive(Debug, Clone, PartialEq)]
pub struct ZeroRun {
    /// When \[s\].
    pub when_s: f64,
    /// Hull below the balance.
    pub hull: Option<usize>,
    /// AF, SF, YM.
    pub reading: Vector3<f64>,
    /// Their variances.
    pub variance: Vector3<f64>,
}

/// One steady drift run, or one point.
#[derive(Debug, Clone)]
pub struct SteadyData {
    /// Index of its hull.
    pub hull: usize,
    /// CL, CD, CM with what belongs to them.
    pub point: Point,
    /// Dynamic pressure; 1 where it is not known \[Pa\].
    pub pressure_Pa: f64,
    /// Reynolds number; 1e6 where it is not known.
    pub reynolds: f64,
    /// The water; none where it is not known.
    pub water: Option<Water>,
    /// When it was made, the middle of its window where times are known, its place in the order otherwise \[s\].
    pub time_s: f64,
    /// From the begin of the run.
    pub start_s: Option<f64>,
    /// Interaction matrix.
    pub interaction: Matrix3<f64>,
    /// Force of the strut that was taken off, about the moment centre: AF, SF, YM; zero where none was.
    pub strut: Vector3<f64>,
    /// Its zero.
    pub zeros: ZeroTimes,
    /// For each channel, what a change of force in every tare run does to the force of this one.
    pub tare_weights: [DVector<f64>; 3],
    /// Effect of one standard error of each independent part of the tare's and the calibration's errors on CL, CD, CM.
    pub rig_errors: DMatrix<f64>,
    /// The same of the zeros' errors, of which a run feels those of its own zeros alone.
    pub zero_errors: Influence,
}

/// When a run was made and on which zeros it rests, with their weights.
#[derive(Debug, Clone, Default)]
pub struct ZeroTimes {
    /// The run \[s\].
    pub time_s: f64,
    /// Its zeros: time \[s\] and weight.
    pub zeros: Vec<(f64, f64)>,
}

impl Data {
    /// Of a table of points.
    pub fn of_points(hull: &Hull, sweep: &Sweep, water: Option<Water>) -> Data {
        let runs = sweep.points.iter().map(|point| SteadyData {
            hull: 0,
            pressure_Pa: point.dynamic_pressure_Pa.unwrap_or(1.0),
            reynolds: point.reynolds.unwrap_or(1e6),
            water: water.zip(point.temperature_C).map(|(water, t)| water.at(t)),
            time_s: 600.0 * point.order as f64,
            start_s: None,
            interaction: Matrix3::identity(),
            strut: Vector3::zeros(),
            zeros: ZeroTimes::default(),
            tare_weights: [0, 1, 2].map(|_| DVector::zeros(0)),
            rig_errors: DMatrix::zeros(3, 0),
            zero_errors: Influence::none(3),
            point: point.clone(),
        });
        Data { hulls: vec![hull.clone()], runs: runs.collect(), tared: Tared::AtAngles, ..Data::default() }
    }

    /// Adds a hull with its steady runs; `sweep` is what they were reduced to.
    pub fn add(&mut self, common: &Common<'_>, hull: &Hull, runs: &[SteadyRun<'_>], sweep: &Sweep) {
        let index = self.hulls.len();
        self.hulls.push(hull.clone());
        for (run, point) in runs.iter().zip(&sweep.points) {
            let map = run.to_coefficients(hull);
            let density = run.run.water.density_kg_m3;
            // Each run has its zeros; the speed's error is in a, b, c, d and in nothing else.
            let of_rig = |kind: &SharedKind| !matches!(kind, SharedKind::Zeros | SharedKind::Speed);
            let errors = common.shared().into_iter().filter(of_rig).map(|kind| match (kind, common.tare) {
                (SharedKind::Tare(channel), Some(tare)) => {
                    let of_terms = tare.gradient(channel, &run.motion, density);
                    let parts = tare.considered_root(channel).tr_mul(&-of_terms);
                    let of_channel = Influence::of_all(DMatrix::from_row_slice(1, parts.len(), parts.as_slice()));
                    map * of_channel.on_channel(channel).on
                }
                _ => map * common.influence(kind, run).on,
            });
            let tare_weights = [0, 1, 2].map(|channel| match common.tare {
                Some(tare) => tare.weights(channel, &run.motion, density),
                None => DVector::zeros(0),
            });
            self.runs.push(SteadyData {
                hull: index,
                pressure_Pa: run.dynamic_pressure_Pa,
                reynolds: point.reynolds.unwrap_or(1e6),
                water: Some(run.run.water),
                time_s: run.run.start_time_s.map_or(600.0 * run.run.order as f64, |t| t + run.steady.middle_s),
                start_s: run.run.start_time_s,
                interaction: common.balance.interaction,
                strut: run.steps.tare,
                zeros: zero_times(common, run),
                tare_weights,
                rig_errors: beside(errors.collect()),
                zero_errors: common.influence(SharedKind::Zeros, run).through(&DMatrix::from_column_slice(
                    3,
                    3,
                    map.as_slice(),
                )),
                point: point.clone(),
            });
        }
    }
}

/// When a run and its zeros were made.
pub fn zero_times(common: &Common<'_>, run: &SteadyRun<'_>) -> ZeroTimes {
    let zeros = run.zero.parts.iter().map(|(zero, weight)| (common.zeros.zeros[*zero].when, *weight)).collect();
    ZeroTimes { time_s: run.run.start_time_s.unwrap_or(0.0) + run.steady.middle_s, zeros }
}

impl Tare {
    /// What a change of force in every tare run does to the strut's force in a motion, in one channel.
    fn weights(&self, channel: usize, motion: &crate::motion::Motion, density_kg_m3: f64) -> DVector<f64> {
        self.response(channel).tr_mul(&self.gradient(channel, motion, density_kg_m3))
    }
}

fn beside(parts: Vec<Matrix3xX<f64>>) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(3, parts.iter().map(|part| part.ncols()).sum());
    let mut column = 0;
    for part in parts {
        all.columns_mut(column, part.ncols()).copy_from(&part);
        column += part.ncols();
    }
    all
}
