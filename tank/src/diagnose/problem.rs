//! A campaign's steady runs as the engine sees them: rows of CL, CD, CM, a baseline of every hull's own a, b, c, d, and the
//! mechanisms that these runs could show.

use std::sync::Arc;

use glidepolar_inference::decorrelation::{Decorrelation, RunErrors};
use glidepolar_inference::evidence::nuisance_prior;
use glidepolar_inference::noise::Lasting;
use glidepolar_inference::relevance::Relevance;
use glidepolar_inference::smooth::Kind;
use glidepolar_inference::{Candidate, Covariate, Evidence, Headline, Point, Problem, Quantity};
use nalgebra::{DMatrix, DVector, Vector3};

use super::data::{Data, SteadyData, Tared};
use super::drift::Days;
use super::mechanisms::{Law, Mechanism};
use super::model::{self, Setting, Term};
use super::reduced::{run_errors, settings, start_of};
use crate::hull_results::HullResults;
use crate::series::median;
use crate::sweep::NAMES;

/// Standard deviation of the belief in a coefficient, relative to its fitted value: almost none.
const RELATIVE_BELIEF: f64 = 3.0;
/// The least value that this is relative to: a, b, c, d.
const LEAST: [f64; 4] = [0.5, 0.05, 0.5, 0.5];
/// A hull's coefficients and their units.
const NAMES_OF_HULL: [(&str, &str); 4] = [("a", "1/rad"), ("b", "1"), ("c", "1/rad^2"), ("d", "1/rad")];
/// The place of a moment centre is known to this share of the length.
const MOMENT_CENTRE_BELIEF: f64 = 0.02;
/// A strut that was never tared has this axial and side force, over the dynamic pressure, as a share of the frontal area.
const STRUT_BELIEF: [f64; 2] = [0.1, 0.3];
/// A misfit smaller than this share of the largest CL, CD or CM changes no use of them: tanks state one per cent as what they
/// can hope for (ITTC 7.5-02-06-02).
const RELEVANT_SHARE: f64 = 0.01;
/// Share of what a mechanism explains by which its size may be off somewhere, as at sea.
const PART_UNEXPLAINED: f64 = 0.1;
/// Relative change of the size of an exact law that is never one size: the square of what is left is 4 % of the effect, as at sea.
const LARGE_CHANGE: f64 = 0.2;
/// Standard deviation of the logarithm of a run's variance by its own record: sqrt(2/n) with n = 8 degrees of freedom, as many as
/// the lowest cosines have from which it is judged.
pub(super) const RECORDS_KNOWN_TO: f64 = 0.5;
/// Standard errors by which the height of a bump of drag must be known, as at sea: one that is broader than the range of Froude
/// numbers has any height, and is a slope.
const HEIGHT_KNOWN: f64 = 6.0;

/// Steady runs against the model.
pub struct TankProblem<'a> {
    pub(super) data: &'a Data,
    pub(super) relevance: &'a Relevance,
    /// Runs in the order of time: indices into the data.
    pub(super) order: Vec<usize>,
    pub(super) settings: Vec<Setting>,
    pub(super) days: Days,
    pub(super) decorrelation: Arc<Decorrelation>,
    pub(super) baseline: Vec<(&'static str, &'static str)>,
    pub(super) start: Vec<f64>,
    pub(super) belief: Vec<f64>,
    pub(super) candidates: Vec<Candidate>,
    pub(super) shapes: Vec<Shape>,
    /// Terms of the strut that its tare leaves open, in the baseline.
    pub(super) strut: &'static [Term],
    /// For each run, what a whole share of the last load adds to CL, CD, CM.
    pub(super) before: Vec<Vector3<f64>>,
}

/// How a candidate acts.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// One size on all runs.
    All(&'static Mechanism),
    /// A size of its own for each hull, the parameters of the first hull first.
    EachHull(&'static Mechanism),
    /// One size on the runs of one day.
    Day(&'static Mechanism, usize),
    /// A zero that settles: channel.
    Drift(&'static Mechanism, usize),
    /// A zero by the last load.
    Before(&'static Mechanism),
    /// A channel's zero under way that the runs of the strut alone have as well, so that the tare takes a part of it along.
    WithTare(&'static Mechanism, usize),
}

impl Shape {
    /// The mechanism.
    pub fn mechanism(&self) -> &'static Mechanism {
        match self {
            Shape::All(m) | Shape::EachHull(m) | Shape::Before(m) => m,
            Shape::Day(m, _) | Shape::Drift(m, _) | Shape::WithTare(m, _) => m,
        }
    }
}

impl<'a> TankProblem<'a> {
    /// A problem; `hulls` give the fits to start from.
    pub fn new(data: &'a Data, hulls: &[HullResults], relevance: &'a Relevance) -> TankProblem<'a> {
        let mut order: Vec<usize> = (0..data.runs.len()).collect();
        order.sort_by(|a, b| data.runs[*a].time_s.total_cmp(&data.runs[*b].time_s));
        let days = Days::new(data);
        let coefficients: Vec<[f64; 4]> = hulls.iter().map(start_of).collect();
        let mut baseline = Vec::new();
        let (mut start, mut belief) = (Vec::new(), Vec::new());
        for hull in &coefficients {
            baseline.extend(NAMES_OF_HULL);
            start.extend(hull);
            belief.extend(hull.iter().zip(LEAST).map(|(value, least)| RELATIVE_BELIEF * value.abs().max(least)));
        }
        let length = median(&data.hulls.iter().map(|hull| hull.geometry.loa_m).collect::<Vec<_>>());
        let mut absorbed = vec![("moment_centre_error_m", "m", MOMENT_CENTRE_BELIEF * length)];
        let area = data.hulls.first().map_or(1.0, |hull| hull.frontal_area_m2());
        let strut: &'static [Term] = match data.tared {
            Tared::Never => &[Term::StrutAxial, Term::StrutSide],
            Tared::Ahead => &[Term::StrutSide],
            Tared::AtAngles => &[],
        };
        absorbed.extend(strut.iter().map(|term| match term {
            Term::StrutAxial => ("strut_axial_m2", "m2", STRUT_BELIEF[0] * area),
            _ => ("strut_side_m2", "m2", STRUT_BELIEF[1] * area),
        }));
        for (name, unit, prior_sd) in absorbed {
            baseline.push((name, unit));
            start.push(0.0);
            belief.push(prior_sd);
        }
        let settings = settings(data);
        let errors = run_errors(data, &coefficients);
        let errors: Vec<RunErrors> = order.iter().map(|run| errors[*run].clone()).collect();
        let mut problem = TankProblem {
            data,
            relevance,
            order,
            settings,
            days,
            decorrelation: Arc::new(Decorrelation::new(&errors)),
            baseline,
            start,
            belief,
            candidates: Vec::new(),
            shapes: Vec::new(),
            strut,
            before: Vec::new(),
        };
        problem.before = problem.loads_before();
        problem.find_candidates();
        problem
    }

    /// How each candidate acts.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// The run of each row of one quantity: indices into the data.
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// The days.
    pub fn days(&self) -> &Days {
        &self.days
    }

    /// Residuals of the readings, of these standard deviations, as independent rows of unit variance.
    pub fn independent_residuals(&self, residual: &DVector<f64>, sd: &[f64]) -> DVector<f64> {
        let mut rows = DMatrix::from_column_slice(residual.len(), 1, residual.as_slice());
        self.decorrelation.apply(&mut rows);
        DVector::from_iterator(residual.len(), rows.iter().zip(self.own_sd(sd)).map(|(row, own)| row / own))
    }

    /// Of standard deviations of the readings the part that runs do not share.
    pub fn own_sd(&self, sd: &[f64]) -> Vec<f64> {
        sd.iter().zip(self.decorrelation.shared_sd()).map(|(sd, shared)| (sd * sd - shared * shared).sqrt()).collect()
    }

    /// Makes the rows of columns of readings independent.
    pub fn make_independent(&self, columns: &mut DMatrix<f64>) {
        self.decorrelation.apply(columns);
    }

    /// Residuals and sensitivities with rows whose errors are independent.
    fn independent(
        &self,
        residual: DVector<f64>,
        baseline: &mut DMatrix<f64>,
        candidates: &mut [DMatrix<f64>],
    ) -> DVector<f64> {
        self.decorrelation.apply(baseline);
        candidates.iter_mut().for_each(|columns| self.decorrelation.apply(columns));
        let mut column = DMatrix::from_column_slice(residual.len(), 1, residual.as_slice());
        self.decorrelation.apply(&mut column);
        column.column(0).into_owned()
    }

    /// What is believed of the hulls' coefficients, and of what the rig adds.
    fn prior(&self, point: &Point) -> Vec<(f64, f64)> {
        let n_coefficients = NAMES_OF_HULL.len() * self.data.hulls.len();
        let of = |(j, value): (usize, &f64)| {
            let (distance, sd) = (value - self.start[j], self.belief[j]);
            if j < n_coefficients { (-distance, sd) } else { nuisance_prior(distance, sd) }
        };
        point.baseline.iter().enumerate().map(of).collect()
    }

    fn covariates(&self) -> Vec<Covariate> {
        // A lift and a moment that go with the angle have no level of their own: one is a misfit, alike on both sides or
        // opposite.
        let level = Covariate { name: "constant offset", kind: Kind::Level, values: vec![1.0; 3 * self.order.len()] };
        let mut found = vec![level];
        let mut add = |name: &'static str, value: &dyn Fn(&SteadyData, usize) -> f64| {
            let once: Vec<f64> = self.order.iter().map(|run| value(&self.data.runs[*run], *run)).collect();
            if once.iter().any(|v| v.is_finite()) {
                found.push(Covariate { name, kind: Kind::Line, values: once.repeat(3) });
            }
        };
        add("yaw angle", &|run, _| run.point.yaw_deg.abs());
        add("tow speed", &|run, _| run.point.speed_m_s.unwrap_or(f64::NAN));
        if self.data.hulls.len() > 1 {
            add("Froude number", &|run, _| {
                let length = self.data.hulls[run.hull].geometry.loa_m;
                run.point.speed_m_s.map_or(f64::NAN, |speed| speed / (9.81 * length).sqrt())
            });
        }
        // The rows of a table stand in order of angle rather than of time.
        if self.data.is_raw {
            add("run order", &|run, _| run.time_s);
            add("time of day", &|_, index| self.days.hours(index).unwrap_or(f64::NAN));
            add("speed of the run before", &|_, index| self.days.speed_before(index).unwrap_or(f64::NAN));
            for hull in (0..self.data.hulls.len()).filter(|_| self.data.hulls.len() > 1) {
                add("run order", &|run, _| if run.hull == hull { run.time_s } else { f64::NAN });
            }
        }
        found
    }
}

impl Problem for TankProblem<'_> {
    fn baseline(&self) -> &[(&'static str, &'static str)] {
        &self.baseline
    }

    fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    fn start(&self) -> Point {
        let candidates = self.candidates.iter().map(|candidate| candidate.neutral.clone()).collect();
        Point { baseline: self.start.clone(), candidates }
    }

    fn headline(&self) -> Headline {
        Headline::MostGained
    }

    /// An error of the moment centre passes on the side force, a strong crossflow included, which the slopes without it do not
    /// know: they give that crossflow a moment of the wrong sign.
    fn is_strongly_nonlinear(&self) -> bool {
        true
    }

    fn rows_per_column(&self) -> f64 {
        2.0
    }

    /// A run is no quieter than its own record shows.
    fn stated_variance_known_to(&self) -> f64 {
        RECORDS_KNOWN_TO
    }

    /// What runs share of the errors of zeros, tare and calibration is in their covariance. What goes on from run to run beside that
    /// is no noise: something has changed. Rows of a table go from angle to angle, and what the law of the hull leaves goes with it.
    fn lasting(&self) -> Lasting {
        if self.data.is_raw { Lasting::White } else { Lasting::MinutesAndHours }
    }

    fn least_advantage(&self) -> f64 {
        2.0
    }

    fn most_chance(&self) -> f64 {
        1e-4
    }

    fn judges_largest(&self) -> bool {
        true
    }

    fn has_regimes(&self) -> bool {
        true
    }

    /// A law of a real hull is no better than this: SUBOFF's crossflow leaves as much of its drag.
    fn part_unexplained(&self) -> f64 {
        PART_UNEXPLAINED
    }

    /// A fault of the rig has one size. A law that only comes near may leave the square of what it may be off by.
    fn large_change(&self, candidate: usize) -> f64 {
        match self.shapes[candidate].mechanism().law {
            Law::Exact => LARGE_CHANGE,
            Law::Approximate => PART_UNEXPLAINED.sqrt(),
        }
    }

    fn least_known(&self, candidate: usize) -> f64 {
        if self.shapes[candidate].mechanism().name == "free_surface" { HEIGHT_KNOWN } else { 0.0 }
    }

    /// A law of a tank is one of angle and speed: where it does nearly all and needs other sizes, another law does all.
    fn is_level(&self, _candidate: usize) -> bool {
        false
    }

    /// At two speeds the drag's dependence on speed is one number, which a zero, a transition and waves explain alike. Friction
    /// has its exponent by theory. What a tare leaves of a zero in its own runs is such a number in every channel.
    fn is_tested(&self, candidate: usize) -> bool {
        let shape = &self.shapes[candidate];
        let needs_three = shape.mechanism().name == "axial_force_zero" || matches!(shape, Shape::WithTare(..));
        !needs_three || self.shows_laws_of_speed()
    }

    /// The fit in full may go where the slopes did not, beyond a bound. Walls speed the water up past a model across the tank: at
    /// the largest angle the dynamic pressure is higher.
    fn exists(&self, candidate: usize, values: &[f64]) -> bool {
        let bounds = &self.candidates[candidate].bounds;
        if values.iter().zip(bounds).any(|(value, (low, high))| value < low || value > high) {
            return false;
        }
        let across = |run: &SteadyData| run.point.alpha_rad().sin().abs();
        match self.shapes[candidate].mechanism().name {
            "blockage" => values[0] + values[1] * self.data.runs.iter().map(across).fold(0.0, f64::max) > 0.0,
            _ => true,
        }
    }

    fn relevance(&self, quantity: &Quantity, scatter: f64) -> f64 {
        let k = NAMES.iter().position(|name| *name == quantity.name).unwrap_or(0);
        let largest = self.data.runs.iter().map(|run| run.point.coefficients[k].abs()).fold(0.0, f64::max);
        self.relevance.limit(quantity.name, scatter, RELEVANT_SHARE * largest)
    }

    fn evidence(&self, point: &Point) -> Evidence {
        glidepolar_progress::one_more("comparisons with the model");
        let n = self.order.len();
        let mut residual = DVector::zeros(3 * n);
        let mut baseline = DMatrix::zeros(3 * n, self.baseline.len());
        let mut candidates: Vec<DMatrix<f64>> =
            self.candidates.iter().map(|candidate| DMatrix::zeros(3 * n, candidate.neutral.len())).collect();
        let none = self.candidates.iter().map(|candidate| candidate.neutral.clone()).collect();
        let without = Point { baseline: point.baseline.clone(), candidates: none };
        let is_any_at_work = without.candidates != point.candidates;
        let mut baseline_without = is_any_at_work.then(|| baseline.clone());
        for (i, &run) in self.order.iter().enumerate() {
            let data = &self.data.runs[run];
            let reduced = model::reduced(&self.settings[run], &self.values(run, point));
            if let Some(columns) = &mut baseline_without {
                let reduced = model::reduced(&self.settings[run], &self.values(run, &without));
                for (k, (_, slopes)) in reduced.iter().enumerate() {
                    self.put_baseline(columns, k * n + i, run, slopes);
                }
            }
            let added = self.added(run, point);
            for (k, (value, slopes)) in reduced.iter().enumerate() {
                let row = k * n + i;
                residual[row] = data.point.coefficients[k] - value - added[k];
                self.put_baseline(&mut baseline, row, run, slopes);
                for (shape, columns) in self.shapes.iter().zip(&mut candidates) {
                    for (j, parameter) in shape.mechanism().parameters.iter().enumerate() {
                        if let Some(place) = self.place_of(shape, j, run) {
                            columns[(row, place)] = slopes[parameter.term.place()];
                        }
                    }
                }
            }
            for ((shape, sizes), columns) in self.shapes.iter().zip(&point.candidates).zip(&mut candidates) {
                if let Shape::Drift(_, channel) = shape {
                    let (by_rate, by_time) = self.drift(run, *channel, sizes[1]);
                    for k in 0..3 {
                        columns[(k * n + i, 0)] = by_rate[k];
                        columns[(k * n + i, 1)] = sizes[0] * by_time[k];
                    }
                }
                if let Shape::Before(_) = shape {
                    (0..3).for_each(|k| columns[(k * n + i, 0)] = self.before[run][k]);
                }
                if let Shape::WithTare(_, channel) = shape {
                    let by_size = self.with_tare(run, *channel);
                    (0..3).for_each(|k| columns[(k * n + i, 0)] = by_size[k]);
                }
            }
        }
        let residual = self.independent(residual, &mut baseline, &mut candidates);
        baseline_without.iter_mut().for_each(|columns| self.decorrelation.apply(columns));
        let of_run =
            |value: &dyn Fn(usize) -> f64| self.order.iter().map(|run| value(*run)).collect::<Vec<_>>().repeat(3);
        Evidence {
            quantities: (0..3)
                .map(|k| Quantity { name: NAMES[k], unit: "1", rows: k * n..(k + 1) * n, joined_s: 0.0 })
                .collect(),
            time_s: of_run(&|run| self.data.runs[run].time_s),
            stated_sd: self.decorrelation.sd().to_vec(),
            block: (0..n).collect::<Vec<_>>().repeat(3),
            leg: of_run(&|run| if self.data.runs[run].point.yaw_deg < 0.0 { -1.0 } else { 1.0 }),
            place: Vec::new(),
            residual,
            baseline,
            baseline_without,
            prior: self.prior(point),
            candidates,
            // What runs share of the errors of zeros, tare and calibration is in their covariance.
            shared: DMatrix::zeros(3 * n, 0),
            covariates: self.covariates(),
            decorrelation: Some(Arc::clone(&self.decorrelation)),
        }
    }
}
