//! The joint identification: any of the model's parameters, from all dives at once, by nonlinear least squares.
//!
//! ```text
//! minimise  sum t ((w - w_model) / s_w)^2 + sum t ((U - U_model) / s_U)^2
//! ```
//! over bins about a minute long; `t` is the time that a bin stands for and `s` the scatter of a quantity, estimated from the
//! residuals and the fit repeated, as is the inertia along each leg. That residuals are correlated is left to the standard
//! errors ([`JointFit::covariance`]): weights by their correlation gain little where the model is right, and lose where it is
//! not. Levenberg-Marquardt from several starts, on a part of the bins first.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector};
use nalgebra_lm as lm;

use super::blocks::Blocks;
use super::considered::Propagated;
use super::data::Dive;
use super::evaluate::{MOST_FREE, Tally, Weights};
use super::trim::Trim;
use crate::dynamics::{PARAMETERS, Parameters, parameter_index};
use glidepolar_inference::covariance::{inverse_symmetric_at_least, jackknife};
use glidepolar_inference::gram::Gram;

/// What is to be fitted, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// Values of all parameters; those that are not free keep them, those that are start there.
    pub baseline: Parameters<f64>,
    /// Rows of [`PARAMETERS`] that are free.
    pub free: Vec<usize>,
    /// Whether the measured speed takes part, where there is one.
    pub use_speed: bool,
    /// Whether to try other starts than the baseline.
    pub several_starts: bool,
}

impl Question {
    /// The usual one: these parameters by name, speed and several starts included.
    ///
    /// # Errors
    /// A name that is no parameter, one that is given twice, or too many of them.
    pub fn new(baseline: Parameters<f64>, free: &[&str]) -> Result<Self, IdentifyError> {
        let mut rows = Vec::new();
        for name in free {
            let row = parameter_index(name).ok_or_else(|| IdentifyError::UnknownParameter((*name).to_owned()))?;
            if rows.contains(&row) {
                return Err(IdentifyError::Twice((*name).to_owned()));
            }
            rows.push(row);
        }
        // One place is kept for what is held, whose error goes to the others.
        if rows.len() >= MOST_FREE {
            return Err(IdentifyError::TooMany { asked: rows.len() });
        }
        Ok(Question { baseline, free: rows, use_speed: true, several_starts: true })
    }
}

/// Why nothing could be identified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// No steady sample at all.
    #[error(
        "no steady sample: no leg of the log is high and long enough, or the motors never rest; is the pressure in dbar, the ballast volume positive when it makes the glider more buoyant, the pitch positive nose up?"
    )]
    NoSamples,
    /// Fewer dives than a standard error needs.
    #[error(
        "dives with steady samples: {found}, at least {needed} are needed to tell {parameters} parameters from the sea"
    )]
    TooFewDives {
        /// How many there are.
        found: usize,
        /// How many there should be.
        needed: usize,
        /// Free parameters.
        parameters: usize,
    },
    /// No such row.
    #[error("there is no parameter `{0}`")]
    UnknownParameter(String),
    /// A parameter that a steady glide does not show.
    #[error("a steady glide does not show `{0}`: ask for the unsteady mode, too (--unsteady)")]
    NeedsUnsteady(String),
    /// One parameter asked for twice.
    #[error("the parameter `{0}` is asked for twice")]
    Twice(String),
    /// More than the solver takes.
    #[error("{asked} parameters are free, {} can be", MOST_FREE - 1)]
    TooMany {
        /// How many were asked for.
        asked: usize,
    },
    /// The glider that the baseline describes does not fly the way the log does.
    #[error(
        "at {unflyable} of {samples} stretches no glide exists at the recorded pitch and the net mass of the baseline: {}",
        cause(*.trim)
    )]
    CannotFly {
        /// Bins without a glide.
        unflyable: usize,
        /// All bins.
        samples: usize,
        /// What the baseline takes for the net weight, where it is known.
        trim: Option<Trim>,
    },
    /// A value for a parameter that no glider has.
    #[error("`{name}` = {value} is beyond what it can be: {min} to {max}")]
    OutOfBounds {
        /// The parameter.
        name: &'static str,
        /// What was asked for.
        value: f64,
        /// Smallest possible value.
        min: f64,
        /// Largest possible value.
        max: f64,
    },
}

/// Why no glide may exist, by what the baseline takes for the net weight.
fn cause(trim: Option<Trim>) -> &'static str {
    match trim {
        // A unit divides the speed and so the drag; the weight is the log's own then.
        Some(Trim::Neutral) => {
            "the trim is neutral already, so that mass and volume are no cause; check the units of pressure or depth, of ballast volume and of pitch (--unit), and the values that are held (--pin)"
        }
        _ => {
            "check the units of pressure or depth and of ballast volume (--unit), the values that are held (--pin), and mass and volume of the vehicle; --trim neutral sets aside the last"
        }
    }
}

/// The result of a fit.
#[derive(Debug, Clone)]
pub struct JointFit {
    /// All parameters, the fitted ones in place.
    pub parameters: Parameters<f64>,
    /// Rows of [`PARAMETERS`] that were free.
    pub free: Vec<usize>,
    /// By what the residuals were divided.
    pub weights: Weights,
    /// How the residuals scatter.
    pub tally: Tally,
    /// Products of residuals and slopes, one matrix a dive.
    pub grams: Vec<Gram>,
    /// Sum of squared weighted residuals: minus twice the logarithm of the likelihood, up to a constant.
    pub chi2: f64,
    /// Covariance of the free parameters, dives as the independent unit.
    pub covariance: DMatrix<f64>,
    /// What the errors of held parameters do to the free ones.
    pub propagated: Vec<Propagated>,
    /// The error of the model itself, where two weighings of the same data disagree: one standard error, by which all
    /// free parameters move together. Empty where they agree.
    pub model_error: Vec<f64>,
    /// Evaluations of all samples.
    pub evaluations: usize,
    /// Whether the minimum was reached within the limits of the solver.
    pub converged: bool,
}

impl JointFit {
    /// A fitted parameter's place among the free ones.
    pub fn position(&self, name: &str) -> Option<usize> {
        let row = parameter_index(name)?;
        self.free.iter().position(|&free| free == row)
    }

    /// A parameter's value, fitted or not.
    pub fn value(&self, row: usize) -> f64 {
        self.parameters.as_array()[row]
    }

    /// The standard error of the free parameter at this position by the scatter between dives, what was held taken for exact.
    pub fn scatter_se(&self, position: usize) -> f64 {
        self.covariance[(position, position)].max(0.0).sqrt()
    }

    /// The standard error of the free parameter at this position, the errors of what was held and of the model in it.
    pub fn se(&self, position: usize) -> f64 {
        let moves = self.moves_together().map(|moves| moves[position].powi(2));
        (self.covariance[(position, position)].max(0.0) + moves.sum::<f64>()).sqrt()
    }

    /// Covariance of the free parameters, the errors of what was held and of the model in it.
    pub fn whole_covariance(&self) -> DMatrix<f64> {
        self.moves_together().fold(self.covariance.clone(), |sum, moves| {
            let moves = DVector::from_column_slice(moves);
            sum + &moves * moves.transpose()
        })
    }

    /// Moves of the free parameters by one standard error of each thing that is independent of the others.
    fn moves_together(&self) -> impl Iterator<Item = &[f64]> {
        let propagated = self.propagated.iter().map(|propagated| propagated.moves.as_slice());
        propagated.chain((!self.model_error.is_empty()).then_some(self.model_error.as_slice()))
    }

    /// Degrees of freedom of that standard error: those of the dives for what they scatter, none lost by what was held
    /// (Welch and Satterthwaite).
    pub fn degrees_of_freedom(&self, position: usize) -> f64 {
        let dives = self.grams.iter().filter(|gram| gram.rows > 0).count() as f64 - 1.0;
        let share = self.covariance[(position, position)] / self.se(position).powi(2);
        if share.is_finite() && share > 0.0 { dives / (share * share) } else { dives }
    }
}

/// Rounds of inertia and parameters, each with the other as it is: two are enough but where the pump runs through half of a short leg.
const MOST_INERTIA_ROUNDS: usize = 8;

/// Fall of the sum of squares, in units of the scatter, that changes nothing.
const SETTLED: f64 = 1e-3;

/// Bins on which the starts are tried.
const BINS_OF_A_START: usize = 400;

/// Fits the parameters to the dives.
///
/// # Errors
/// Without samples, or where the baseline is no description of this glider at all.
pub fn fit(question: &Question, dives: &mut [Dive]) -> Result<JointFit, IdentifyError> {
    let mut dives = dives;
    let mut solver = Solver::new(question, &mut dives)?;
    // Coarse: every start on a part of the bins, then the best one with the scatter and the inertia that it shows.
    let every = (solver.samples.samples() / BINS_OF_A_START).max(1);
    let mut best = solver.best_start(every);
    solver.weights = scatter(solver.tally(&best, every), solver.weights);
    solver.samples.update_inertia(&best);
    best = solver.minimise(&best, every.div_ceil(3), 1e-4);
    solver.samples.update_inertia(&best);
    solver.weights = scatter(solver.tally(&best, every.div_ceil(3)), solver.weights);
    // The inertia follows from the parameters, and they from it: until the residuals with both no longer fall.
    let mut left = solver.squares(&best, 1);
    for _ in 1..MOST_INERTIA_ROUNDS {
        let found = solver.minimise(&best, 1, 1e-4);
        solver.samples.update_inertia(&found);
        let squares = solver.squares(&found, 1);
        if squares >= left {
            solver.samples.update_inertia(&best);
            break;
        }
        let is_settled = left - squares < SETTLED;
        (best, left) = (found, squares);
        if is_settled {
            break;
        }
    }
    solver.finish(best)
}

/// Fits the parameters from a start that is near already, on all samples at once.
///
/// # Errors
/// As [`fit`].
pub(super) fn refine(question: &Question, samples: &mut dyn Blocks) -> Result<JointFit, IdentifyError> {
    let mut solver = Solver::new(question, samples)?;
    solver.weights = scatter(solver.tally(&question.baseline, 1), solver.weights);
    solver.finish(question.baseline)
}

/// What the steady glide with its inertia misses of a flight by the equations of motion \[m/s\]: a tenth of a millimetre per
/// second of vertical velocity (docs/theory/identification.md), and three times that of speed, the path's sine being a third.
const MODEL_ERROR_M_S: [f64; 2] = [1e-4, 3e-4];

/// What such errors do to the free parameters at worst: all of them along the one direction that moves a parameter most.
///
/// With residuals `r` in units of the weights, `|dt_i| <= |r| sqrt((J'J)^-1_ii)`. Beside the noise of the sea it is small. A
/// combination of parameters that the data hardly show has no other bound in a log without noise.
fn covariance_of_model(free: usize, grams: &[Gram], weights: Weights, tally: &Tally) -> DMatrix<f64> {
    let total = Gram::sum(free, grams);
    let rows = [(weights.sink_m_s, tally.sink), (weights.speed_m_s, tally.speed)];
    let left: f64 = rows.iter().map(|(weight, scatter)| scatter.sum_of_squares / weight.powi(2)).sum();
    let of_model: f64 =
        rows.iter().zip(MODEL_ERROR_M_S).map(|((weight, scatter), e)| scatter.n as f64 * (e / weight).powi(2)).sum();
    // A bin counts as often as the time that it stands for.
    let squares = total.sum_of_squares() * of_model / left.max(f64::MIN_POSITIVE);
    inverse_symmetric_at_least(&total.normal_matrix()) * squares
}

/// The weights that the residuals themselves suggest.
fn scatter(tally: Tally, before: Weights) -> Weights {
    let effective = |s: &super::evaluate::Scatter, before: f64| {
        if s.n < 2 || !before.is_finite() {
            return before;
        }
        // A floor against data without any noise: a tenth of a millimetre per second.
        s.rms().max(MODEL_ERROR_M_S[0])
    };
    Weights { sink_m_s: effective(&tally.sink, before.sink_m_s), speed_m_s: effective(&tally.speed, before.speed_m_s) }
}

struct Solver<'a> {
    question: &'a Question,
    samples: &'a mut dyn Blocks,
    grams: Vec<Gram>,
    weights: Weights,
    evaluations: usize,
    converged: bool,
}

impl<'a> Solver<'a> {
    fn new(question: &'a Question, samples: &'a mut dyn Blocks) -> Result<Self, IdentifyError> {
        if samples.samples() == 0 {
            return Err(IdentifyError::NoSamples);
        }
        let has_speed = question.use_speed && samples.has_speed();
        let weights = Weights { sink_m_s: 0.01, speed_m_s: if has_speed { 0.03 } else { f64::INFINITY } };
        let grams = vec![Gram::new(question.free.len()); samples.count()];
        Ok(Solver { question, samples, grams, weights, evaluations: 0, converged: true })
    }

    /// From a start nearby, on all samples.
    fn finish(mut self, start: Parameters<f64>) -> Result<JointFit, IdentifyError> {
        let at_start = (self.tally(&start, 1), self.grams.clone());
        let mut parameters = self.minimise(&start, 1, 1e-4);
        let mut tally = self.tally(&parameters, 1);
        let samples = self.samples.samples();
        // Each glide is found from that of the step before, and a last step far out, refused, may have led all of them astray.
        if 2 * tally.unflyable > samples && 2 * at_start.0.unflyable <= samples {
            parameters = start;
            (tally, self.grams) = at_start;
        }
        if 2 * tally.unflyable > samples {
            return Err(IdentifyError::CannotFly { unflyable: tally.unflyable, samples, trim: None });
        }
        let n = self.question.free.len();
        Ok(JointFit {
            parameters,
            free: self.question.free.clone(),
            weights: self.weights,
            tally,
            chi2: Gram::sum(n, &self.grams).sum_of_squares(),
            covariance: jackknife(n, &self.grams) + covariance_of_model(n, &self.grams, self.weights, &tally),
            propagated: Vec::new(),
            model_error: Vec::new(),
            grams: self.grams,
            evaluations: self.evaluations,
            converged: self.converged,
        })
    }

    /// Sum of the squared weighted residuals with the inertia as it is.
    fn squares(&mut self, at: &Parameters<f64>, every: usize) -> f64 {
        self.tally(at, every);
        Gram::sum(self.question.free.len(), &self.grams).sum_of_squares()
    }

    fn tally(&mut self, at: &Parameters<f64>, every: usize) -> Tally {
        self.evaluations += 1;
        self.samples.evaluate(at, &self.question.free, self.weights, &mut self.grams, every)
    }

    fn best_start(&mut self, every: usize) -> Parameters<f64> {
        let mut best = (f64::INFINITY, self.question.baseline);
        for start in starts(self.question) {
            let found = self.minimise(&start, every, 1e-3);
            let cost = self.squares(&found, every);
            if cost < best.0 {
                best = (cost, found);
            }
        }
        best.1
    }

    fn minimise(&mut self, start: &Parameters<f64>, every: usize, tolerance: f64) -> Parameters<f64> {
        let n = self.question.free.len();
        if n == 0 {
            return *start;
        }
        let values = start.as_array();
        let x = lm::DVector::from_fn(n, |i, _| values[self.question.free[i]]);
        let mut problem = Problem {
            base: *start,
            free: &self.question.free,
            weights: self.weights,
            every,
            samples: &mut *self.samples,
            grams: &mut self.grams,
            x: x.clone(),
            residuals: lm::DVector::zeros(0),
            jacobian: lm::DMatrix::zeros(0, 0),
            evaluations: 0,
        };
        problem.set_params(&x);
        let solver = LevenbergMarquardt::new()
            .with_ftol(tolerance * tolerance)
            .with_xtol(tolerance)
            .with_gtol(1e-12)
            .with_patience(20)
            .with_stepbound(1.0);
        let (problem, report) = solver.minimize(problem);
        let evaluations = problem.evaluations;
        let found = problem.parameters();
        self.evaluations += evaluations;
        self.converged = report.termination.was_successful();
        found
    }
}

/// The baseline, and starts around it: local minima are common here.
fn starts(question: &Question) -> Vec<Parameters<f64>> {
    let mut starts = vec![question.baseline];
    if !question.several_starts {
        return starts;
    }
    let free = |name: &str| parameter_index(name).is_some_and(|row| question.free.contains(&row));
    for (a, b, offset_kg) in [(1.0, 0.6, 0.1), (1.0, 1.5, -0.1), (2.0, 2.5, 0.0)] {
        let mut start = question.baseline;
        if free("a_per_rad") {
            start.a_per_rad *= a;
        }
        if free("b") {
            start.b *= b;
        }
        if free("ballast_offset_kg") {
            start.ballast_offset_kg += offset_kg;
        }
        if start != question.baseline {
            starts.push(start);
        }
    }
    starts
}

/// The problem as the solver sees it: a few rows that stand for all.
struct Problem<'a> {
    base: Parameters<f64>,
    free: &'a [usize],
    weights: Weights,
    every: usize,
    samples: &'a mut dyn Blocks,
    grams: &'a mut [Gram],
    x: lm::DVector<f64>,
    residuals: lm::DVector<f64>,
    jacobian: lm::DMatrix<f64>,
    evaluations: usize,
}

/// Weight of a step beyond a bound, against the span of a parameter's meaning.
const BOUND_WEIGHT: f64 = 1e6;

impl Problem<'_> {
    /// The parameters at `x`, held within their bounds.
    fn parameters(&self) -> Parameters<f64> {
        let mut parameters = self.base;
        for (&row, &value) in self.free.iter().zip(self.x.iter()) {
            *parameters.at(row) = value.clamp(PARAMETERS[row].min, PARAMETERS[row].max);
        }
        parameters
    }
}

impl LeastSquaresProblem<f64, lm::Dyn, lm::Dyn> for Problem<'_> {
    type ResidualStorage = lm::storage::Owned<f64, lm::Dyn>;
    type JacobianStorage = lm::storage::Owned<f64, lm::Dyn, lm::Dyn>;
    type ParameterStorage = lm::storage::Owned<f64, lm::Dyn>;

    fn set_params(&mut self, x: &lm::DVector<f64>) {
        self.x.copy_from(x);
        let n = self.free.len();
        let parameters = self.parameters();
        self.samples.evaluate(&parameters, self.free, self.weights, self.grams, self.every);
        self.evaluations += 1;
        let mut total = Gram::sum(n, &*self.grams);
        // Beyond a bound the samples see the bound itself; a residual of its own leads back.
        let mut row = vec![0.0; n + 1];
        for (i, &index) in self.free.iter().enumerate() {
            let bounds = &PARAMETERS[index];
            let beyond = x[i] - x[i].clamp(bounds.min, bounds.max);
            if beyond != 0.0 {
                let weight = BOUND_WEIGHT / (bounds.max - bounds.min);
                row.fill(0.0);
                row[i] = weight;
                row[n] = weight * beyond;
                total.add_row(&row);
            }
        }
        let (jacobian, residuals) = total.compressed();
        self.jacobian = lm::DMatrix::from_iterator(n + 1, n, jacobian.iter().copied());
        self.residuals = lm::DVector::from_iterator(n + 1, residuals.iter().copied());
    }

    fn params(&self) -> lm::DVector<f64> {
        self.x.clone()
    }

    fn residuals(&self) -> Option<lm::DVector<f64>> {
        Some(self.residuals.clone())
    }

    fn jacobian(&self) -> Option<lm::DMatrix<f64>> {
        Some(self.jacobian.clone())
    }
}
