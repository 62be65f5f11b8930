//! The methods against closed forms and published values, on small systems: a state that is only counted before those that are felt.

use std::cell::Cell;

use super::linear::Decomposition;
use super::method::{Method, Trial};
use super::*;
use glidepolar_number::Number;

const N: usize = 5;
const N_FELT: usize = 4;
const NOMINALS: [f64; N] = [100.0, 10.0, 0.1, 0.01, 0.1];

/// A system given by its equations alone.
trait Equations {
    fn rates<T: Number>(&self, time_s: T, state: [T; N]) -> [T; N];

    fn indicator(&self, _state: [f64; N]) -> f64 {
        1.0
    }
}

impl<Q: Equations> System<N, N_FELT, 1> for Q {
    const NOMINALS: [f64; N] = NOMINALS;
    const FIRST_FELT: usize = 1;

    fn derivative(&self, time_s: f64, state: &[f64; N]) -> [f64; N] {
        self.rates(time_s, *state)
    }

    fn slopes(&self, time_s: f64, state: &[f64; N]) -> Slopes<N, N_FELT> {
        Slopes::new::<{ N_FELT + 1 }>(time_s, state, (1, &NOMINALS), |time_s, state| self.rates(time_s, state))
    }

    fn event_indicators(&self, _: f64, state: &[f64; N]) -> [f64; 1] {
        [self.indicator(*state)]
    }

    fn next_jump_s(&self, _: f64) -> Option<f64> {
        None
    }

    fn next_bend_s(&self, _: f64, _: &[f64; N]) -> Option<f64> {
        None
    }
}

fn still<T: Number>() -> [T; N] {
    [T::constant(0.0); N]
}

/// Kaps' problem, `y1 = exp(-2t)`, `y2 = exp(-t)` whatever the stiffness, and after Prothero and Robinson a third state
/// drawn to a sine of the time as fast.
struct Kaps {
    stiffness: f64,
}

impl Equations for Kaps {
    fn rates<T: Number>(&self, time_s: T, state: [T; N]) -> [T; N] {
        let (k, [_, y1, y2, y3, ..]) = (self.stiffness, state);
        let mut rates = still();
        rates[1] = y1 * -(k + 2.0) + y2 * y2 * k;
        rates[2] = y1 - y2 - y2 * y2;
        rates[3] = (y3 - time_s.sin()) * -k + time_s.cos();
        // What is only counted: the way that y2 and the sine make.
        rates[0] = y2 + time_s.cos();
        rates
    }
}

fn kaps_at(time_s: f64) -> [f64; 4] {
    [time_s.sin() - (-time_s).exp(), (-2.0 * time_s).exp(), (-time_s).exp(), time_s.sin()]
}

/// Largest errors at the end and inside the steps, of a run to 1 s in equal steps.
fn errors(stiffness: f64, steps: usize) -> (f64, f64) {
    let kaps = Kaps { stiffness };
    let mut start = [0.0; N];
    start[..4].copy_from_slice(&kaps_at(0.0));
    let stretch = Stretch { system: &kaps, origin: start, last_s: f64::INFINITY };
    let h = 1.0 / steps as f64;
    let mut method = <Rosenbrock<N, N_FELT> as Method<Kaps, N, N_FELT, 1>>::begin(&stretch, 1e30, 0.0, h).unwrap();
    let error = |time_s: f64, place: &[f64; N]| {
        let state = stretch.state(place);
        kaps_at(time_s).iter().zip(state).map(|(exact, found)| (exact - found).abs()).fold(0.0, f64::max)
    };
    let mut inside = 0f64;
    for step in 0..steps {
        Method::<Kaps, N, N_FELT, 1>::set_next_step_s(&mut method, h);
        assert_eq!(method.step(&stretch), Trial::Accepted);
        let middle = (step as f64 + 0.5) * h;
        inside = inside.max(error(middle, &Method::<Kaps, N, N_FELT, 1>::inside(&mut method, middle).unwrap()));
    }
    (error(1.0, Method::<Kaps, N, N_FELT, 1>::place(&method)), inside)
}

#[test]
fn the_implicit_method_has_order_five_and_its_dense_output_order_four() {
    for stiffness in [1.0, 10.0] {
        let (coarse, fine) = (errors(stiffness, 32), errors(stiffness, 64));
        let (order, inside) = ((coarse.0 / fine.0).log2(), (coarse.1 / fine.1).log2());
        assert!(order > 4.7, "order {order} at stiffness {stiffness}: {coarse:?} {fine:?}");
        assert!(inside > 3.8, "order {inside} inside at stiffness {stiffness}: {coarse:?} {fine:?}");
    }
    // However stiff, the steps need not follow the fast mode.
    assert!(errors(1e8, 16).0 < 1e-5, "{:?}", errors(1e8, 16));
}

/// Van der Pol's oscillator, relaxation form.
struct VanDerPol;

impl Equations for VanDerPol {
    fn rates<T: Number>(&self, _: T, state: [T; N]) -> [T; N] {
        let (y1, y2) = (state[1], state[2]);
        let mut rates = still();
        rates[1] = y2;
        rates[2] = ((-y1 * y1 + 1.0) * y2 - y1) * 1e6;
        rates
    }
}

#[test]
fn the_stiff_oscillator_of_the_test_set_comes_out() {
    // Mazzia and Magherini, Test Set for IVP Solvers, VDPOL, at t = 2.
    let expected = [1.706_167_732_170_483, -0.892_809_701_024_797_5];
    for (tolerance, bound) in [(1e-6, 1e-4), (6e-8, 1e-5)] {
        let mut state = still::<f64>();
        state[1] = 2.0;
        let (mut time, mut integrator) = (0.0, Integrator::new(tolerance));
        assert_eq!(integrator.advance(&VanDerPol, &mut time, &mut state, 2.0).unwrap(), Advance::Reached);
        for (found, expected) in state.into_iter().skip(1).zip(expected) {
            assert!((found - expected).abs() < bound, "{found} against {expected} at {tolerance}");
        }
    }
}

/// Sinks, slower and slower, and rises again: at its deepest after 20 s.
struct Toss {
    floor_m: f64,
}

impl Equations for Toss {
    fn rates<T: Number>(&self, time_s: T, _: [T; N]) -> [T; N] {
        let mut rates = still();
        rates[1] = (-time_s + 20.0) * 0.01;
        rates
    }

    fn indicator(&self, state: [f64; N]) -> f64 {
        self.floor_m - state[1]
    }
}

#[test]
fn a_boundary_that_is_crossed_and_crossed_back_inside_a_step_is_met() {
    // Depth 0.2 t - 0.005 t^2, 2 m at the most: 1.5 m is passed at 20 -+ 10 s.
    for tolerance in [1e-6, 1e-10] {
        let (mut time, mut state) = (0.0, still::<f64>());
        let mut integrator = Integrator::new(tolerance).with_step_s(60.0);
        let toss = Toss { floor_m: 1.5 };
        let mut met = Vec::new();
        while integrator.advance(&toss, &mut time, &mut state, 50.0).unwrap() != Advance::Reached {
            met.push(time);
        }
        let expected = [10.0, 30.0];
        assert_eq!(met.len(), 2, "{met:?}");
        assert!(met.iter().zip(expected).all(|(met, expected)| (met - expected).abs() < 1e-6), "{met:?}");
    }
}

/// Drifts so slowly, so late, that nanoseconds do not move it across.
struct Drift;

impl Equations for Drift {
    fn rates<T: Number>(&self, _: T, _: [T; N]) -> [T; N] {
        let mut rates = still();
        rates[1] = T::constant(1e-7);
        rates
    }

    fn indicator(&self, state: [f64; N]) -> f64 {
        0.8e-7 - state[1]
    }
}

#[test]
fn a_slow_crossing_late_in_a_voyage_is_one_event_and_the_state_stands_behind_it() {
    for tolerance in [1e-6, 1e-10] {
        let (mut time, mut state, mut integrator) = (1e6, still::<f64>(), Integrator::new(tolerance));
        let advance = integrator.advance(&Drift, &mut time, &mut state, 1e6 + 5.0).unwrap();
        assert!(matches!(advance, Advance::Event(which) if which[0]), "{advance:?}");
        assert!(Drift.event_indicators(time, &state)[0] < 0.0 && (time - 1e6 - 0.8).abs() < 0.02, "{time}");
        let advance = integrator.advance(&Drift, &mut time, &mut state, 1e6 + 5.0).unwrap();
        assert_eq!((advance, time), (Advance::Reached, 1e6 + 5.0));
        assert!((state[1] - 5e-7).abs() < 1e-13, "{}", state[1]);
    }
}

#[test]
fn linear_equations_are_solved_to_rounding() {
    // Rows in an order that needs every pivot to be looked for.
    let matrix =
        |i: usize, j: usize| ((i * 7 + j * j * 3 + i * j) % 11) as f64 - if i + j == N_FELT - 1 { 40.0 } else { 5.0 };
    let columns: [[f64; N_FELT]; N_FELT] = std::array::from_fn(|j| std::array::from_fn(|i| matrix(i, j)));
    let right: [f64; N_FELT] = std::array::from_fn(|i| (i as f64 - 1.5).powi(3));
    let solution = Decomposition::new(columns).unwrap().solve(&right);
    for (i, expected) in right.iter().enumerate() {
        let found: f64 = (0..N_FELT).map(|j| matrix(i, j) * solution[j]).sum();
        assert!((found - expected).abs() < 1e-11, "row {i}: {found} against {expected}");
    }
    let mut singular = columns;
    singular[3] = singular[1];
    assert!(Decomposition::new(singular).is_none_or(|it| it.solve(&right).iter().any(|x| x.abs() > 1e12)));
    let mut not_a_number = columns;
    not_a_number[2][3] = f64::NAN;
    assert!(Decomposition::new(not_a_number).is_none_or(|it| it.solve(&right).iter().any(|x| x.is_nan())));
}

/// A system that counts how often it is asked.
struct Counted<E> {
    equations: E,
    asked: Cell<usize>,
}

impl<E: Equations> Equations for Counted<E> {
    fn rates<T: Number>(&self, time_s: T, state: [T; N]) -> [T; N] {
        self.asked.set(self.asked.get() + 1);
        self.equations.rates(time_s, state)
    }

    fn indicator(&self, state: [f64; N]) -> f64 {
        self.equations.indicator(state)
    }
}

/// Kaps' problem from 0 to 1 s, looked at so many times; the largest error and the evaluations.
fn looked_at(looks: usize, tolerance: f64, horizon_s: f64) -> (f64, usize) {
    let kaps = Counted { equations: Kaps { stiffness: 10.0 }, asked: Cell::new(0) };
    let mut start = [0.0; N];
    start[..4].copy_from_slice(&kaps_at(0.0));
    let (mut time, mut state, mut integrator) = (0.0, start, Integrator::new(tolerance));
    let mut error = 0f64;
    for look in 1..=looks {
        let end_s = look as f64 / looks as f64;
        let reached = integrator.follow(&kaps, &mut time, &mut state, end_s, horizon_s.max(end_s)).unwrap();
        assert_eq!((reached, time), (Advance::Reached, end_s));
        let errors = kaps_at(time).into_iter().zip(state).zip(NOMINALS);
        error = errors.map(|((exact, found), nominal)| (exact - found).abs() / nominal).fold(error, f64::max);
    }
    (error, kaps.asked.get())
}

#[test]
fn looking_often_costs_little_and_keeps_the_accuracy() {
    for tolerance in [1e-6, 1e-8, 1e-11] {
        let (seldom, often) = (looked_at(1, tolerance, 1.0), looked_at(1000, tolerance, 1.0));
        assert!(often.0 < 100.0 * tolerance, "{tolerance}: {seldom:?} {often:?}");
        // The explicit method begins anew after each step that went too far, and grows its steps less boldly then.
        assert!(often.1 <= seldom.1 * 3 / 2, "{tolerance}: {seldom:?} {often:?}");
        assert!(looked_at(1000, tolerance, 0.0).1 > 10 * often.1);
    }
}

#[test]
fn an_event_beyond_the_time_asked_for_waits_for_its_time() {
    // Depth 0.2 t - 0.005 t^2: 1.5 m is passed at 10 and at 30 s.
    for tolerance in [1e-6, 1e-10] {
        let (mut time, mut state) = (0.0, still::<f64>());
        let (toss, mut integrator, mut met) = (Toss { floor_m: 1.5 }, Integrator::new(tolerance), Vec::new());
        for look in 1..=500 {
            let end_s = 0.1 * f64::from(look);
            while integrator.follow(&toss, &mut time, &mut state, end_s, 60.0).unwrap() != Advance::Reached {
                assert!(time <= end_s);
                met.push(time);
            }
            assert!((state[1] - (0.2 - 0.005 * time) * time).abs() < 1e-9, "{} at {time}", state[1]);
        }
        assert!(met.len() == 2 && (met[0] - 10.0).abs() < 1e-6 && (met[1] - 30.0).abs() < 1e-6, "{met:?}");
    }
}

/// A system with no way beyond one second.
struct Wall;

impl Equations for Wall {
    fn rates<T: Number>(&self, time_s: T, _: [T; N]) -> [T; N] {
        let mut rates = still();
        rates[1] = if time_s.re() > 1.0 { T::constant(f64::NAN) } else { T::constant(0.1) };
        rates
    }
}

#[test]
fn what_fails_beyond_the_time_asked_for_is_no_fault_before_it() {
    let (mut time, mut state, mut integrator) = (0.0, still::<f64>(), Integrator::new(1e-8));
    for look in 1..=10 {
        let end_s = 0.1 * f64::from(look);
        assert_eq!(integrator.follow(&Wall, &mut time, &mut state, end_s, 60.0), Ok(Advance::Reached));
    }
    let before = (time, state);
    assert!(integrator.follow(&Wall, &mut time, &mut state, 2.0, 60.0).is_err());
    assert_eq!((time, state), before);
}
