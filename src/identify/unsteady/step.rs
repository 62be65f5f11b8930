//! One step through time: TR-BDF2, its stages solved in plain numbers, their slopes by the implicit function theorem. Knows no
//! passage.

use num_dual::Dual64;

use super::flyer::Flyer;
use super::moment::{Moment, rates, sink};
use crate::Number;

/// Longest step \[s\].
const LONGEST_STEP_S: f64 = 5.0;

/// From one sample to the next: velocity, the way down meanwhile, and the rates at the end.
pub(super) fn advance<T: Number>(
    flyer: &Flyer<T>,
    here: &Moment,
    next: &Moment,
    velocity: [T; 2],
    known: Option<[T; 2]>,
) -> Option<([T; 2], T, [T; 2])> {
    // gamma = 2 - sqrt 2: both stages have the same matrix 1 - d h f'.
    const GAMMA: f64 = 2.0 - std::f64::consts::SQRT_2;
    const D: f64 = 0.5 * GAMMA;
    const FROM_STAGE: f64 = 1.0 / (GAMMA * (2.0 - GAMMA));
    const FROM_START: f64 = (1.0 - GAMMA) * (1.0 - GAMMA) / (GAMMA * (2.0 - GAMMA));
    let duration = next.time_s - here.time_s;
    let steps = (duration / LONGEST_STEP_S).ceil().max(1.0);
    let h = duration / steps;
    let mut x = velocity;
    let mut f = known.unwrap_or_else(|| rates(&flyer.lifted, here, x));
    let mut down = T::constant(0.0);
    let mut matrix = [[f64::INFINITY, 0.0], [0.0, f64::INFINITY]];
    for step in 0..steps as usize {
        let at = |share: f64| here.between(next, (step as f64 + share) / steps);
        let (start, middle, end) = (at(0.0), at(GAMMA), at(1.0));
        let guess = [x[0].value() + GAMMA * h * f[0].value(), x[1].value()];
        let base = [x[0] + f[0] * (D * h), x[1] + f[1] * (D * h)];
        let stage = implicit(flyer, &middle, base, D * h, guess, &mut matrix)?;
        let base = [0, 1].map(|k| stage[k] * FROM_STAGE - x[k] * FROM_START);
        let there = implicit(flyer, &end, base, D * h, stage.map(T::value), &mut matrix)?;
        // Simpson's weights for the three places of the stage, exact for parabolas.
        let sinks =
            [sink(&flyer.lifted, &start, x), sink(&flyer.lifted, &middle, stage), sink(&flyer.lifted, &end, there)];
        let middle_weight = 1.0 / (6.0 * GAMMA * (1.0 - GAMMA));
        let end_weight = 0.5 - GAMMA * middle_weight;
        let start_weight = 1.0 - middle_weight - end_weight;
        down += (sinks[0] * start_weight + sinks[1] * middle_weight + sinks[2] * end_weight) * h;
        f = [0, 1].map(|k| (there[k] - base[k]) / (D * h));
        x = there;
    }
    Some((x, down, f))
}

/// The solution of `x = base + s f(x)`, with its derivatives. `matrix` is `1 - s f'` nearby, and that of the solution
/// afterwards.
fn implicit<T: Number>(
    flyer: &Flyer<T>,
    at: &Moment,
    base: [T; 2],
    s: f64,
    guess: [f64; 2],
    matrix: &mut [[f64; 2]; 2],
) -> Option<[T; 2]> {
    // The last step is Newton's own and squares the error: after one of this size the rest is rounding.
    const TOLERANCE_M_S: f64 = 1e-6;
    const MOST_ROUNDS: usize = 25;
    const MOST_CHEAP_STEPS: usize = 3;
    let plain_base = base.map(T::value);
    let mut x = guess;
    for _ in 0..MOST_ROUNDS {
        // A few steps with the matrix at hand cost a fraction of a new one.
        for _ in 0..MOST_CHEAP_STEPS {
            let f = rates(&flyer.plain, at, x);
            let step = solve_2(*matrix, [0, 1].map(|k| x[k] - plain_base[k] - s * f[k]));
            let size = step[0].abs().max(step[1].abs());
            if size.is_nan() || size >= 0.05 {
                break;
            }
            x = [x[0] - step[0], x[1] - step[1]];
            if size < 10.0 * TOLERANCE_M_S {
                break;
            }
        }
        let by_1 = rates(&flyer.with_slopes, at, [Dual64::from(x[0]).derivative(), x[1].into()]);
        let by_3 = rates(&flyer.with_slopes, at, [x[0].into(), Dual64::from(x[1]).derivative()]);
        *matrix = [[1.0 - s * by_1[0].eps, -s * by_3[0].eps], [-s * by_1[1].eps, 1.0 - s * by_3[1].eps]];
        let step = solve_2(*matrix, [0, 1].map(|k| x[k] - plain_base[k] - s * by_1[k].re));
        let size = step[0].abs().max(step[1].abs());
        if !size.is_finite() {
            return None;
        }
        // Where the flow turns over, a full step overshoots.
        let damping = (0.2 / size).min(1.0);
        x = [x[0] - damping * step[0], x[1] - damping * step[1]];
        if size < TOLERANCE_M_S {
            let mut solution = x.map(T::constant);
            if T::HAS_DERIVATIVES {
                let f = rates(&flyer.lifted, at, solution);
                let step = solve_2(*matrix, [0, 1].map(|k| solution[k] - base[k] - f[k] * s));
                solution = [0, 1].map(|k| solution[k] - step[k]);
            }
            return Some(solution);
        }
    }
    None
}

/// `A^-1 r` for a matrix of plain numbers.
fn solve_2<T: Number>([[a, b], [c, d]]: [[f64; 2]; 2], [r, s]: [T; 2]) -> [T; 2] {
    let determinant = a * d - b * c;
    [(r * d - s * b) / determinant, (s * a - r * c) / determinant]
}
