//! Rodas5P, a linearly implicit method of order 5 for stiff systems, with the exact Jacobian of the dual numbers.
//!
//! G. Steinebach, Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within the Julia
//! Differential Equations package, BIT Numerical Mathematics 63:27 (2023); the form without products of Jacobian and
//! vector is that of Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.7:
//! ```text
//! (1/(h gamma) - J) k_i = f(t + c_i h, y + sum_j a_ij k_j) + sum_j (C_ij/h) k_j + h d_i f_t,    i = 1..8
//! y(t + h) = y + sum_j a_8j k_j + k_8,      error k_8
//! ```
//! L-stable and stiffly accurate, error estimate of order 4, dense output of order 4. One Jacobian and one
//! decomposition a step, eight right-hand sides, of which the first comes with the Jacobian. The equations for what is only
//! counted stand alone: `k_i = h gamma (right_i + J_i k)` once the others are known. Allocates nothing.

use glidepolar_number::functions;
use nalgebra::SVector;

use super::linear::Decomposition;
use super::method::{Method, Stretch, Trial};
use super::{IntegrationError, LONGEST_STEP_S, Slopes, System};

const STAGES: usize = 8;

const GAMMA: f64 = 0.211_937_563_194_290_14;

/// `a_ij` of the stages 2 to 6; stages 7 and 8 and the result each add the stage before them whole.
const A: [[f64; 5]; 6] = [
    [0.0; 5],
    [3.0, 0.0, 0.0, 0.0, 0.0],
    [2.849394379747939, 0.45842242204463923, 0.0, 0.0, 0.0],
    [-6.954028509809101, 2.489845061869568, -10.358996098473584, 0.0, 0.0],
    [2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641, 0.0],
    [-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946],
];

const C: [[f64; 7]; STAGES] = [
    [0.0; 7],
    [-14.155112264123755, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [-17.97296035885952, -2.859693295451294, 0.0, 0.0, 0.0, 0.0, 0.0],
    [147.12150275711716, -1.41221402718213, 71.68940251302358, 0.0, 0.0, 0.0, 0.0],
    [165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306, 0.0, 0.0, 0.0],
    [24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471, 0.0, 0.0],
    [
        30.91273214028599,
        -3.1208243349937974,
        77.79954646070892,
        34.28646028294783,
        -19.097331116725623,
        -28.087943162872662,
        0.0,
    ],
    [
        37.80277123390563,
        -3.2571969029072276,
        112.26918849496327,
        66.9347231244047,
        -40.06618937091002,
        -54.66780262877968,
        -9.48861652309627,
    ],
];

/// Places of the stages in the step.
const C_TIME: [f64; STAGES] =
    [0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0];

/// Weights of the slope in time.
const D: [f64; STAGES] =
    [GAMMA, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734, 2.325825639765069, 0.0, 0.0, 0.0];

/// Dense output: `y(s) = (1-s) y0 + s (y1 + (1-s) (q1 + s (q2 + s q3)))`, `q_l = sum_j H_lj k_j`.
const H: [[f64; STAGES]; 3] = [
    [
        25.948786856663858,
        -2.5579724845846235,
        10.433815404888879,
        -2.3679251022685204,
        0.524948541321073,
        1.1241088310450404,
        0.4272876194431874,
        -0.17202221070155493,
    ],
    [
        -9.91568850695171,
        -0.9689944594115154,
        3.0438037242978453,
        -24.495224566215796,
        20.176138334709044,
        15.98066361424651,
        -6.789040303419874,
        -6.710236069923372,
    ],
    [
        11.419903575922262,
        2.8879645146136994,
        72.92137995996029,
        80.12511834622643,
        -52.072871366152654,
        -59.78993625266729,
        -0.15582684282751913,
        4.883087185713722,
    ],
];

/// The next step is the one that would just meet the tolerance, times this.
const SAFETY: f64 = 0.9;

/// How much shorter or longer the next step may be.
const CHANGE: (f64, f64) = (0.05, 6.0);

/// The method at a place.
pub struct Rosenbrock<const N: usize, const F: usize> {
    tolerance: f64,
    time_s: f64,
    place: [f64; N],
    next_step_s: f64,
    /// At `place`, once a trial needed them: a trial that failed leaves them to the next.
    slopes: Option<Slopes<N, F>>,
    last: Option<Last<N>>,
    was_rejected: bool,
}

/// The last accepted step.
struct Last<const N: usize> {
    time_s: f64,
    step_s: f64,
    place: SVector<f64, N>,
    stages: [SVector<f64, N>; STAGES],
    /// What dense output needs, once it was asked for.
    inside: Option<[SVector<f64, N>; 3]>,
}

impl<S: System<N, F, E>, const N: usize, const F: usize, const E: usize> Method<S, N, F, E> for Rosenbrock<N, F> {
    fn begin(stretch: &Stretch<'_, S, N>, tolerance: f64, time_s: f64, step_s: f64) -> Result<Self, IntegrationError> {
        let place = [0.0; N];
        let slopes = stretch.slopes(time_s, &place);
        if !slopes.are_finite() {
            return Err(IntegrationError::NotFinite { time_s });
        }
        Ok(Rosenbrock {
            tolerance,
            time_s,
            place,
            next_step_s: step_s,
            slopes: Some(slopes),
            last: None,
            was_rejected: false,
        })
    }

    fn step(&mut self, stretch: &Stretch<'_, S, N>) -> Trial {
        let slopes = self.slopes.take().unwrap_or_else(|| stretch.slopes(self.time_s, &self.place));
        if !slopes.are_finite() {
            return Trial::Failed;
        }
        let step_s = self.next_step_s;
        let stages = stages(stretch, &slopes, self.time_s, &self.place, step_s);
        let error = stages
            .as_ref()
            .map_or(f64::INFINITY, |(_, stages)| error(&stages[STAGES - 1], self.tolerance, S::COUNTED_IN_ERROR));
        let Some((reached, stages)) = stages.filter(|_| error <= 1.0) else {
            let shorter = if error.is_finite() { SAFETY * functions::powf(error, -0.2) } else { 0.0 };
            self.next_step_s = step_s * shorter.max(CHANGE.0);
            self.slopes = Some(slopes);
            self.was_rejected = true;
            return Trial::Rejected;
        };
        let longest = if self.was_rejected { 1.0 } else { CHANGE.1 };
        // An error of nothing makes the power infinite, and the longest step the next.
        let change = (SAFETY * functions::powf(error, -0.2)).clamp(CHANGE.0, longest);
        self.last = Some(Last { time_s: self.time_s, step_s, place: SVector::from(self.place), stages, inside: None });
        (self.time_s, self.place) = (self.time_s + step_s, reached.into());
        self.next_step_s = (step_s * change).min(LONGEST_STEP_S);
        self.was_rejected = false;
        Trial::Accepted
    }

    fn time_s(&self) -> f64 {
        self.time_s
    }

    fn place(&self) -> &[f64; N] {
        &self.place
    }

    fn next_step_s(&self) -> f64 {
        self.next_step_s
    }

    fn set_next_step_s(&mut self, step_s: f64) {
        self.next_step_s = step_s;
    }

    fn inside(&mut self, time_s: f64) -> Option<[f64; N]> {
        let last = self.last.as_mut()?;
        let s = ((time_s - last.time_s) / last.step_s).clamp(0.0, 1.0);
        let [q1, q2, q3] = *last.inside.get_or_insert_with(|| H.map(|row| combine(&row, &last.stages)));
        let end = SVector::from(self.place);
        Some((last.place * (1.0 - s) + (end + (q1 + (q2 + q3 * s) * s) * (1.0 - s)) * s).into())
    }
}

/// Root mean square of the error in units of the tolerance; infinite for what is no number.
fn error<const N: usize>(estimate: &SVector<f64, N>, tolerance: f64, counted: usize) -> f64 {
    let error = (estimate.norm_squared() / counted as f64).sqrt() / tolerance;
    if error.is_nan() { f64::INFINITY } else { error }
}

/// A state and the stages that led to it.
type Stages<const N: usize> = (SVector<f64, N>, [SVector<f64, N>; STAGES]);

/// The state after one step and its stages; none where the decomposition fails.
fn stages<S: System<N, F, E>, const N: usize, const F: usize, const E: usize>(
    stretch: &Stretch<'_, S, N>,
    slopes: &Slopes<N, F>,
    time_s: f64,
    place: &[f64; N],
    step_s: f64,
) -> Option<Stages<N>> {
    let diagonal = 1.0 / (step_s * GAMMA);
    let matrix = Decomposition::<F>::new(std::array::from_fn(|j| {
        std::array::from_fn(|i| if i == j { diagonal } else { 0.0 } - slopes.jacobian[i + S::FIRST_FELT][j])
    }))?;
    let (start, in_time) = (SVector::from(*place), SVector::from(slopes.in_time));
    let mut k = [SVector::zeros(); STAGES];
    let mut at = start;
    for i in 0..STAGES {
        at = match i {
            0 => start,
            1..6 => start + combine(&A[i], &k[..i]),
            _ => at + k[i - 1],
        };
        let rates = if i == 0 { slopes.rates } else { stretch.rates(time_s + C_TIME[i] * step_s, &at.into()) };
        let right = SVector::from(rates) + in_time * (D[i] * step_s) + combine(&C[i], &k[..i]) / step_s;
        let felt = S::FIRST_FELT..S::FIRST_FELT + F;
        let solved = matrix.solve(&std::array::from_fn(|j| right[j + S::FIRST_FELT]));
        k[i].as_mut_slice()[felt.clone()].copy_from_slice(&solved);
        for counted in (0..N).filter(|i| !felt.contains(i)) {
            let passed_on: f64 = slopes.jacobian[counted].iter().zip(&solved).map(|(slope, k)| slope * k).sum();
            k[i][counted] = (right[counted] + passed_on) / diagonal;
        }
    }
    Some((at + k[STAGES - 1], k))
}

fn combine<const N: usize>(weights: &[f64], vectors: &[SVector<f64, N>]) -> SVector<f64, N> {
    let mut sum = SVector::zeros();
    for (weight, vector) in weights.iter().zip(vectors) {
        sum += vector * *weight;
    }
    sum
}
