//! A step that reached beyond the time that was asked for: the way through it, kept for the times that will be asked for next.
//!
//! Dense output of either method is a polynomial of time of degree 7 at the most; its values at eight Chebyshev points are
//! that polynomial, whichever method made it (Berrut and Trefethen, Barycentric Lagrange interpolation, SIAM Review 46:501,
//! 2004). Knows neither methods nor equations.

/// Degree of the richest dense output, that of DOP853.
const DEGREE: usize = 7;

/// How far a state that rests may seem to move by rounding, in units of its size.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The states from the beginning of a step to its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ahead<const N: usize> {
    begun_s: f64,
    end_s: f64,
    known_to_s: f64,
    start: [f64; N],
    /// What is added to `start` at every Chebyshev point but the first, where it is nothing.
    moves: [[f64; N]; DEGREE],
}

impl<const N: usize> Ahead<N> {
    /// Numbers that [`Ahead::numbers`] gives.
    pub const N_NUMBERS: usize = 3 + N * (DEGREE + 1);

    /// The way of a step from `begun_s` to `end_s`, given by its state at each time, good up to `known_to_s`, where an event
    /// may cut it short. None where `inside` knows no state.
    pub fn new(
        (begun_s, end_s, known_to_s): (f64, f64, f64),
        start: [f64; N],
        nominals: &[f64; N],
        mut inside: impl FnMut(f64) -> Option<[f64; N]>,
    ) -> Option<Self> {
        let from = &start;
        let mut moves = [[0.0; N]; DEGREE];
        for (j, moves) in moves.iter_mut().enumerate() {
            let there = inside(begun_s + (end_s - begun_s) * point(j + 1))?;
            *moves = std::array::from_fn(|i| there[i] - from[i]);
        }
        // A state that rests, at a limit for example, must not be moved off it by rounding.
        for (i, nominal) in nominals.iter().enumerate() {
            if moves.iter().all(|moves| moves[i].abs() <= ROUNDING * (from[i].abs() + nominal)) {
                moves.iter_mut().for_each(|moves| moves[i] = 0.0);
            }
        }
        Some(Ahead { begun_s, end_s, known_to_s, start, moves })
    }

    /// Whether it has a state for this time.
    pub fn knows(&self, time_s: f64) -> bool {
        self.begun_s <= time_s && time_s <= self.known_to_s
    }

    /// The end of the step, unless an event comes before it.
    pub fn end(&self) -> Option<(f64, [f64; N])> {
        (self.known_to_s >= self.end_s).then(|| (self.end_s, self.at(self.end_s)))
    }

    /// The state at a time that it knows.
    pub fn at(&self, time_s: f64) -> [f64; N] {
        let place = (time_s - self.begun_s) / (self.end_s - self.begun_s);
        let (mut sum, mut weights) = ([0.0; N], 0.0);
        for j in 0..=DEGREE {
            let distance = place - point(j);
            if distance == 0.0 {
                return self.moved(&if j == 0 { [0.0; N] } else { self.moves[j - 1] });
            }
            let weight = sign(j) / distance;
            weights += weight;
            if j > 0 {
                sum.iter_mut().zip(&self.moves[j - 1]).for_each(|(sum, moves)| *sum += weight * moves);
            }
        }
        self.moved(&sum.map(|sum| sum / weights))
    }

    /// All of it as plain numbers.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        let states = std::iter::once(self.start).chain(self.moves).flatten();
        [self.begun_s, self.end_s, self.known_to_s].into_iter().chain(states)
    }

    /// What [`Ahead::numbers`] wrote; none where they are no way through a step.
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let (&[begun_s, end_s, known_to_s], states) = numbers.split_first_chunk::<3>()?;
        let (start, moves) = states.split_first_chunk::<N>()?;
        let is_a_step = begun_s < end_s && known_to_s <= end_s && numbers.iter().all(|number| number.is_finite());
        let is_whole = moves.len() == N * DEGREE;
        (is_a_step && is_whole).then(|| Ahead {
            begun_s,
            end_s,
            known_to_s,
            start: *start,
            moves: std::array::from_fn(|j| std::array::from_fn(|i| moves[j * N + i])),
        })
    }

    fn moved(&self, moves: &[f64; N]) -> [f64; N] {
        std::array::from_fn(|i| self.start[i] + moves[i])
    }
}

/// The Chebyshev points of the second kind, from 0 to 1.
fn point(j: usize) -> f64 {
    /// `(1 - cos(pi j/7))/2`.
    const POINTS: [f64; DEGREE + 1] = [
        0.0,
        0.049_515_566_048_790_43,
        0.188_255_099_070_633_28,
        0.388_739_533_021_842_8,
        0.611_260_466_978_157_2,
        0.811_744_900_929_366_7,
        0.950_484_433_951_209_6,
        1.0,
    ];
    POINTS[j]
}

/// Their weights, up to a common factor.
fn sign(j: usize) -> f64 {
    let half = if j == 0 || j == DEGREE { 0.5 } else { 1.0 };
    if j.is_multiple_of(2) { half } else { -half }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(time_s: f64) -> [f64; 4] {
        let s = time_s - 100.0;
        let mut state = [0.0; 4];
        state[0] = 5e5 + s * (1.0 + s * (0.3 - s * (0.02 - s * (1e-3 + s * (2e-5 - s * (1e-6 - 3e-8 * s))))));
        state[1] = -0.1;
        state[2] = 0.3 + 1e-17 * s;
        state
    }

    #[test]
    fn a_polynomial_of_degree_seven_comes_back_and_what_rests_does_not_move() {
        let ahead = Ahead::new((100.0, 112.0, 110.0), at(100.0), &[1.0; 4], |time_s| Some(at(time_s))).unwrap();
        for k in 0..=120 {
            let time_s = 100.0 + 0.1 * f64::from(k);
            let (found, expected) = (ahead.at(time_s), at(time_s));
            assert!((found[0] - expected[0]).abs() < 1e-9, "{found:?} {expected:?} at {time_s}");
            assert_eq!(found[1..3], [-0.1, 0.3]);
        }
        assert!(ahead.knows(100.0) && ahead.knows(110.0) && !ahead.knows(110.1) && !ahead.knows(99.9));
        assert_eq!(ahead.end(), None);
        let numbers: Vec<f64> = ahead.numbers().collect();
        assert_eq!(Ahead::from_numbers(&numbers), Some(ahead));
        assert_eq!(Ahead::<4>::from_numbers(&numbers[1..]), None);
        let mut broken = numbers;
        broken[1] = 99.0;
        assert_eq!(Ahead::<4>::from_numbers(&broken), None);
    }

    #[test]
    fn the_points_are_those_of_chebyshev() {
        for j in 0..=DEGREE {
            let expected = 0.5 * (1.0 - (std::f64::consts::PI * j as f64 / DEGREE as f64).cos());
            assert!((point(j) - expected).abs() < 1e-15, "{j}: {expected:.18}");
        }
    }
}
