//! The equations against what must hold whatever their form: conserved quantities, published equilibria, eigenvalues.

mod moving_water;

use super::*;
use crate::glide::{Attitude, at_path, start};
use nalgebra::SMatrix;
use num_dual::Dual64;

/// ROGUE, Leonard and Graver 2001.
fn rogue() -> Parameters<f64> {
    let (rho, area, length) = (1000.0, 0.03, 1.0);
    Parameters {
        reference_density_kg_m3: rho,
        frontal_area_m2: area,
        length_m: length,
        a_per_rad: 2.0 * 306.0 / (rho * area),
        b: 2.0 * 18.0 / (rho * area),
        c_per_rad2: 2.0 * 109.0 / (rho * area),
        d_per_rad: 2.0 * (-36.5 + 12.0) / (rho * area * length),
        pitch_damping_N_m_s: 0.0,
        pitch_damping_quadratic_N_m_s2: 0.0,
        hull_mass_kg: 8.22,
        moving_mass_kg: 2.0,
        ballast_nominal_kg: 1.0,
        displaced_mass_kg: 11.22,
        added_mass_1_kg: 2.0,
        added_mass_3_kg: 14.0,
        pitch_inertia_kg_m2: 0.1,
        moving_mass_height_m: 0.04,
        ..Parameters::default()
    }
}

/// The SLOCUM-like vehicle, Graver 2005.
fn slocum() -> Parameters<f64> {
    let (rho, area, length) = (1027.0, 0.03563, 1.8);
    Parameters {
        a_per_rad: 2.0 * 132.5 / (rho * area),
        b: 2.0 * 2.15 / (rho * area),
        c_per_rad2: 2.0 * 25.0 / (rho * area),
        d_per_rad: 2.0 * (-100.0 + 65.0) / (rho * area * length),
        ..Parameters::default()
    }
}

fn without_water_forces() -> Parameters<f64> {
    Parameters {
        a_per_rad: 0.0,
        b: 0.0,
        c_per_rad2: 0.0,
        // The Munk couple stays, so that K_M = 0: d = 2 (m_f3 - m_f1) / (rho A l) is left out below instead.
        d_per_rad: 2.0 * 65.0 / (1027.0 * 0.03563 * 1.8),
        pitch_damping_N_m_s: 0.0,
        pitch_damping_quadratic_N_m_s2: 0.0,
        offset_mass_kg: 3.0,
        offset_mass_forward_m: 0.4,
        offset_mass_below_m: 0.02,
        ballast_forward_m: 0.7,
        ballast_below_m: 0.01,
        ..Parameters::default()
    }
}

fn water(parameters: &Parameters<f64>) -> Inputs<f64> {
    Inputs::still_water(parameters.reference_density_kg_m3, parameters.reference_temperature_C)
}

fn surroundings(parameters: &Parameters<f64>) -> Surroundings<f64> {
    Surroundings {
        density_kg_m3: parameters.reference_density_kg_m3,
        pressure_Pa: 0.0,
        temperature_C: parameters.reference_temperature_C,
        time_s: 0.0,
    }
}

/// Kinetic and potential energy, and horizontal momentum, written from the masses alone.
fn invariants(p: &Parameters<f64>, s: &State<f64>) -> (f64, f64) {
    let (sin, cos) = s.pitch_rad.sin_cos();
    let rate = s.pitch_rate_rad_s;
    let mut kinetic = 0.5
        * ((p.hull_mass_kg - p.offset_mass_kg + p.added_mass_1_kg) * s.v1_m_s.powi(2)
            + (p.hull_mass_kg - p.offset_mass_kg + p.added_mass_3_kg) * s.v3_m_s.powi(2)
            + p.pitch_inertia_kg_m2 * rate * rate);
    let mut momentum = [
        (p.hull_mass_kg - p.offset_mass_kg + p.added_mass_1_kg) * s.v1_m_s,
        (p.hull_mass_kg - p.offset_mass_kg + p.added_mass_3_kg) * s.v3_m_s,
    ];
    let excess = p.hull_mass_kg + s.ballast_mass_kg + p.moving_mass_kg - p.displaced_mass_kg;
    let mut potential = -p.gravity_m_s2 * excess * s.depth_m;
    for (mass, forward, below) in [
        (p.offset_mass_kg, p.offset_mass_forward_m, p.offset_mass_below_m),
        (s.ballast_mass_kg, p.ballast_forward_m, p.ballast_below_m),
    ] {
        let velocity = [s.v1_m_s + below * rate, s.v3_m_s - forward * rate];
        kinetic += 0.5 * mass * (velocity[0].powi(2) + velocity[1].powi(2));
        momentum[0] += mass * velocity[0];
        momentum[1] += mass * velocity[1];
        potential -= p.gravity_m_s2 * mass * (below * cos - forward * sin);
    }
    kinetic += (s.momentum_1_kg_m_s.powi(2) + s.momentum_3_kg_m_s.powi(2)) / (2.0 * p.moving_mass_kg);
    potential -= p.gravity_m_s2 * p.moving_mass_kg * (s.moving_mass_3_m * cos - s.moving_mass_1_m * sin);
    let total = [momentum[0] + s.momentum_1_kg_m_s, momentum[1] + s.momentum_3_kg_m_s];
    (kinetic + potential, total[0] * cos + total[1] * sin)
}

/// Classical Runge-Kutta, small enough to be checked by eye.
fn march(mut s: State<f64>, step: f64, steps: usize, f: impl Fn(&State<f64>) -> State<f64>) -> State<f64> {
    let add = |a: &State<f64>, b: &State<f64>, h: f64| {
        let b = b.as_array();
        let mut sum = a.as_array();
        sum.iter_mut().zip(b).for_each(|(x, y)| *x += h * y);
        State::from_array(sum)
    };
    for _ in 0..steps {
        let k1 = f(&s);
        let k2 = f(&add(&s, &k1, step / 2.0));
        let k3 = f(&add(&s, &k2, step / 2.0));
        let k4 = f(&add(&s, &k3, step));
        for (k, weight) in [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)] {
            s = add(&s, &k, step * weight / 6.0);
        }
    }
    s
}

fn tumbling(p: &Parameters<f64>) -> State<f64> {
    let (v1, v3, rate, r1, r3) = (0.4, -0.1, 0.2, 0.03, p.moving_mass_height_m);
    State {
        x_m: 0.0,
        depth_m: 1000.0,
        pitch_rad: 0.3,
        pitch_rate_rad_s: rate,
        v1_m_s: v1,
        v3_m_s: v3,
        moving_mass_1_m: r1,
        moving_mass_3_m: r3,
        momentum_1_kg_m_s: p.moving_mass_kg * (v1 + r3 * rate),
        momentum_3_kg_m_s: p.moving_mass_kg * (v3 - r1 * rate),
        ballast_mass_kg: 1.2,
        creep_pressure_Pa: 0.0,
        carried_density_kg_m3: 0.0,
        late_temperature_K: 0.0,
        leaked_back_m3: 0.0,
        energy_J: 0.0,
    }
}

#[test]
fn energy_and_horizontal_momentum_stay_when_the_mass_is_held() {
    let p = without_water_forces();
    let start = tumbling(&p);
    let inputs =
        Inputs { moving_mass_command_m: start.moving_mass_1_m, ballast_command_m3: p.ballast_m3(1.2), ..water(&p) };
    let end = march(start, 0.002, 10_000, |s| derivative(&p, Actuation::Servo, Modes::default(), 0.0, s, &inputs));
    let ((e0, h0), (e1, h1)) = (invariants(&p, &start), invariants(&p, &end));
    let exchanged = 0.5 * 120.0 * (end.v1_m_s.powi(2) + end.v3_m_s.powi(2));
    assert!(exchanged > 5.0, "the test must move energy about, {exchanged} J");
    assert!((e1 - e0).abs() < 1e-6 * exchanged, "energy {e0} J became {e1} J");
    assert!((h1 - h0).abs() < 1e-8 * h0.abs(), "momentum {h0} became {h1}");
}

#[test]
fn energy_and_horizontal_momentum_stay_when_the_mass_flies_free() {
    let p = without_water_forces();
    let start = tumbling(&p);
    let end = march(start, 0.001, 5_000, |s| {
        // Gravity and the turning frame alone: no force between hull and mass.
        let u1 = -s.momentum_3_kg_m_s * s.pitch_rate_rad_s - p.moving_mass_kg * p.gravity_m_s2 * s.pitch_rad.sin();
        let u3 = s.momentum_1_kg_m_s * s.pitch_rate_rad_s + p.moving_mass_kg * p.gravity_m_s2 * s.pitch_rad.cos();
        let inputs = Inputs { u1_N: u1, u3_N: u3, ..water(&p) };
        derivative(&p, Actuation::Raw, Modes::default(), 0.0, s, &inputs)
    });
    let ((e0, h0), (e1, h1)) = (invariants(&p, &start), invariants(&p, &end));
    let scale = p.moving_mass_kg * p.gravity_m_s2 * (end.moving_mass_3_m - start.moving_mass_3_m).abs();
    assert!(scale > 10.0, "the mass must fall, {scale} J");
    assert!((e1 - e0).abs() < 1e-6 * scale, "energy {e0} J became {e1} J");
    assert!((h1 - h0).abs() < 1e-7 * h0.abs(), "momentum {h0} became {h1}");
}

fn gliding(p: &Parameters<f64>, angle_deg: f64, speed: f64) -> (State<f64>, Inputs<f64>) {
    let g = at_path(p, &surroundings(p), angle_deg.to_radians(), speed).expect("a glide");
    let inputs = Inputs { moving_mass_command_m: g.moving_mass_m, ballast_command_m3: g.ballast_m3, ..water(p) };
    let state = State {
        x_m: 0.0,
        depth_m: 100.0,
        pitch_rad: g.pitch_rad,
        pitch_rate_rad_s: 0.0,
        v1_m_s: g.v1_m_s,
        v3_m_s: g.v3_m_s,
        moving_mass_1_m: g.moving_mass_m,
        moving_mass_3_m: p.moving_mass_height_m,
        momentum_1_kg_m_s: p.moving_mass_kg * g.v1_m_s,
        momentum_3_kg_m_s: p.moving_mass_kg * g.v3_m_s,
        ballast_mass_kg: g.ballast_mass_kg,
        creep_pressure_Pa: 0.0,
        carried_density_kg_m3: 0.0,
        late_temperature_K: 0.0,
        leaked_back_m3: 0.0,
        energy_J: 0.0,
    };
    (state, inputs)
}

#[test]
fn published_steady_glides_are_equilibria() {
    // (vehicle, xi, V, alpha, theta, ballast mass, v1, v3, r1): the equilibrium formulas evaluated independently.
    let cases = [
        (rogue(), -30.0, 0.30, 6.2595, -23.7405, 1.35415, 0.29821, 0.03271, 0.0041273),
        (slocum(), -25.0, 0.30, 2.02265, -22.97735, 1.047349, 0.299813, 0.010588, 0.0198303),
        (slocum(), -35.0, 0.30, 1.33615, -33.66385, 1.034607, 0.299918, 0.006995, 0.0323000),
        (slocum(), -45.0, 0.30, 0.93257, -44.06743, 1.027981, 0.299960, 0.004883, 0.0475898),
    ];
    for (p, xi, v, alpha, theta, ballast, v1, v3, r1) in cases {
        let (state, inputs) = gliding(&p, xi, v);
        let near = |found: f64, expected: f64, digits: f64| {
            assert!((found - expected).abs() < digits, "xi {xi}: {found} against {expected}")
        };
        near(state.v3_m_s.atan2(state.v1_m_s).to_degrees(), alpha, 6e-5);
        near(state.pitch_rad.to_degrees(), theta, 6e-5);
        near(state.ballast_mass_kg, ballast, 6e-6);
        near(state.v1_m_s, v1, 6e-6);
        near(state.v3_m_s, v3, 6e-6);
        near(state.moving_mass_1_m, r1, 6e-8);
        for actuation in [Actuation::Servo, Actuation::RawAlongAxis1, Actuation::Raw] {
            let rates = derivative(&p, actuation, Modes::default(), 0.0, &state, &inputs);
            for (i, rate) in rates.as_array().into_iter().enumerate().skip(2) {
                assert!(rate.abs() < 1e-9, "xi {xi}, {actuation:?}: state {i} moves at {rate}");
            }
        }
    }
}

/// Water carried along at the density of that around weighs nothing, and takes as much force to be moved as any mass.
#[test]
fn carried_water_has_inertia_along_both_axes() {
    let p = slocum();
    let (mut state, inputs) = gliding(&p, -25.0, 0.3);
    // At the surface, where the pressure is none, and out of balance.
    state.depth_m = 0.0;
    (state.v1_m_s, state.v3_m_s) = (0.8 * state.v1_m_s, 2.0 * state.v3_m_s);
    let carrying = Parameters { carried_water_m3: 0.01, exchange_time_s: 600.0, ..p };
    let around = Surroundings {
        density_kg_m3: inputs.water_density_kg_m3,
        pressure_Pa: 0.0,
        temperature_C: inputs.water_temperature_C,
        time_s: 0.0,
    };
    state.carried_density_kg_m3 = carrying.carried_from_kg_m3(&around);
    let of = |p: &Parameters<f64>| accelerations(p, 0.0, &state, &inputs, 0.0);
    let (without, with) = (of(&p), of(&carrying));
    let moving_kg = p.hull_mass_kg + p.moving_mass_kg + state.ballast_mass_kg;
    let carried_kg = 0.01 * p.reference_density_kg_m3;
    for (axis, added_kg) in [p.added_mass_1_kg, p.added_mass_3_kg].into_iter().enumerate() {
        let ratio = (moving_kg + added_kg) / (moving_kg + added_kg + carried_kg);
        let found = with[axis] / without[axis];
        assert!(without[axis].abs() > 1e-3, "axis {axis}: {} m/s2", without[axis]);
        assert!((found / ratio - 1.0).abs() < 1e-9, "axis {axis}: {found} and {ratio}");
    }
}

#[test]
fn a_glide_that_is_left_alone_goes_on() {
    let p = slocum();
    let (start, inputs) = gliding(&p, -25.0, 0.3);
    let end = march(start, 0.05, 20_000, |s| derivative(&p, Actuation::Servo, Modes::default(), 0.0, s, &inputs));
    for (i, (a, b)) in start.as_array().into_iter().zip(end.as_array()).enumerate().skip(2) {
        assert!((a - b).abs() < 1e-9, "state {i}: {a} became {b}");
    }
    assert!((end.depth_m - start.depth_m - 1000.0 * 0.3 * 25f64.to_radians().sin()).abs() < 1e-6);
}

/// Eigenvalues of the equations linearised by dual numbers.
fn eigenvalues(p: &Parameters<f64>, angle: f64, v: f64, actuation: Actuation, modes: Modes) -> Vec<(f64, f64)> {
    let (state, inputs) = gliding(p, angle, v);
    // The reference figures follow Graver 2005, who leaves the ballast out of m1 and m3.
    let p = &Parameters {
        added_mass_1_kg: p.added_mass_1_kg - state.ballast_mass_kg,
        added_mass_3_kg: p.added_mass_3_kg - state.ballast_mass_kg,
        ..*p
    };
    let mut jacobian = SMatrix::<f64, N_STATES, N_STATES>::zeros();
    for j in 0..N_STATES {
        let mut seeded = state.as_array().map(Dual64::from);
        seeded[j].eps = 1.0;
        let rates = derivative(
            &p.map(Dual64::from),
            actuation,
            modes,
            Dual64::from(0.0),
            &State::from_array(seeded),
            &inputs.map(Dual64::from),
        );
        for (i, rate) in rates.as_array().into_iter().enumerate() {
            jacobian[(i, j)] = rate.eps;
        }
    }
    let dynamic = nalgebra::DMatrix::from_iterator(N_STATES, N_STATES, jacobian.iter().copied());
    dynamic.complex_eigenvalues().iter().map(|e| (e.re, e.im)).collect()
}

#[test]
fn linearised_about_the_glide_it_has_the_reference_eigenvalues() {
    let held = Modes { moving_mass: Stop::AtMax, ..Modes::default() };
    let free = Modes::default();
    let (raw, along) = (Actuation::Raw, Actuation::RawAlongAxis1);
    let rogue_45 = 0.369_69;
    // Locked mass: stable. Constant forces on the mass: unstable, the "shakes" of the Simulink paper.
    type Case<'a> = (Parameters<f64>, f64, f64, Actuation, Modes, &'a [(f64, f64)]);
    let cases: &[Case] = &[
        (rogue(), -30.0, 0.3, along, held, &[(-1.954, 0.0), (-1.233, 0.0), (-0.861, 3.641)]),
        (rogue(), -30.0, 0.3, along, free, &[(1.000, 2.318)]),
        (rogue(), -30.0, 0.3, raw, free, &[(0.929, 2.535)]),
        (rogue(), 30.0, 0.3, along, free, &[(2.248, 0.0)]),
        (rogue(), -45.0, rogue_45, along, held, &[(-2.492, 0.0), (-1.224, 0.0), (-1.267, 4.129)]),
        (slocum(), -25.0, 0.3, along, held, &[(-4.032, 0.0), (-0.381, 0.0), (-0.0876, 0.0), (-0.0256, 0.0)]),
        (slocum(), 25.0, 0.3, along, held, &[(-4.026, 0.0), (-0.380, 0.0), (-0.0879, 0.0), (-0.0255, 0.0)]),
        (slocum(), -25.0, 0.3, along, free, &[(0.079, 0.229)]),
        (slocum(), 25.0, 0.3, along, free, &[(0.258, 0.0)]),
        (slocum(), 25.0, 0.3, raw, free, &[(0.325, 0.0)]),
    ];
    for (p, angle, v, actuation, modes, expected) in cases {
        let found = eigenvalues(p, *angle, *v, *actuation, *modes);
        for e in *expected {
            let nearest = found.iter().map(|f| (f.0 - e.0).hypot(f.1 - e.1)).fold(f64::INFINITY, f64::min);
            assert!(nearest < 2e-3, "xi {angle}, {actuation:?} {modes:?}: {e:?} not in {found:?}");
        }
    }
}

#[test]
fn the_munk_couple_is_counted_once() {
    // A hull with no other moment than its added masses': the tank measures d = 2 (m_f3 - m_f1)/(rho A l), and the
    // equations must turn the glider by exactly (m_f3 - m_f1) v1 v3.
    let p = without_water_forces();
    let p = Parameters { offset_mass_kg: 0.0, ballast_forward_m: 0.0, ballast_below_m: 0.0, ..p };
    let (v1, v3) = (0.4, 0.004);
    let state = State {
        pitch_rad: 0.0,
        pitch_rate_rad_s: 0.0,
        v1_m_s: v1,
        v3_m_s: v3,
        moving_mass_1_m: 0.0,
        momentum_1_kg_m_s: p.moving_mass_kg * v1,
        momentum_3_kg_m_s: p.moving_mass_kg * v3,
        ballast_mass_kg: 1.0,
        ..tumbling(&p)
    };
    let inputs = water(&p);
    let rates = derivative(&p, Actuation::Servo, Modes::default(), 0.0, &state, &inputs);
    // The moving mass hangs below and is held along both axes; its share of the turning inertia and its reaction:
    let r3 = p.moving_mass_height_m;
    let munk = (p.added_mass_3_kg - p.added_mass_1_kg) * v1 * v3;
    let m1 = p.hull_mass_kg + p.ballast_nominal_kg + p.added_mass_1_kg;
    let reduced = p.moving_mass_kg * m1 / (p.moving_mass_kg + m1) * r3 * r3;
    let expected = munk / (p.pitch_inertia_kg_m2 + reduced);
    assert!((rates.pitch_rate_rad_s - expected).abs() < 1e-12, "{} against {expected}", rates.pitch_rate_rad_s);
}

#[test]
fn a_moving_mass_that_meets_its_stop_keeps_total_momentum() {
    let p = Parameters { moving_mass_max_m: 0.05, ..without_water_forces() };
    let mut state = tumbling(&p);
    state.moving_mass_1_m = 0.05;
    state.momentum_1_kg_m_s += p.moving_mass_kg * 0.1;
    let (_, before) = invariants(&p, &state);
    let inputs = Inputs { u1_N: 10.0, ..water(&p) };
    let (modes, after) = limits::apply(&p, Actuation::Raw, Modes::default(), 0.0, &state, &inputs);
    assert_eq!(modes.moving_mass, Stop::AtMax);
    let (_, momentum) = invariants(&p, &after);
    assert!((momentum - before).abs() < 1e-12, "{before} became {momentum}");
    let rates = derivative(&p, Actuation::Raw, modes, 0.0, &after, &inputs);
    assert!(rates.moving_mass_1_m.abs() < 1e-12, "still moves at {}", rates.moving_mass_1_m);
    assert!(after.v1_m_s > state.v1_m_s, "the hull takes the blow");
}

#[test]
fn left_at_the_surface_or_dropped_on_the_seabed_it_comes_to_rest() {
    let p = slocum();
    for (ballast_m3, expected_depth) in [(2e-4, 0.0), (-2e-4, 300.0)] {
        let inputs = Inputs { ballast_command_m3: ballast_m3, seabed_depth_m: 300.0, ..water(&p) };
        let start = State {
            depth_m: if ballast_m3 > 0.0 { 5.0 } else { 295.0 },
            pitch_rad: 0.0,
            pitch_rate_rad_s: 0.0,
            v1_m_s: 0.0,
            v3_m_s: 0.0,
            moving_mass_1_m: 0.0,
            moving_mass_3_m: p.moving_mass_height_m,
            momentum_1_kg_m_s: 0.0,
            momentum_3_kg_m_s: 0.0,
            ballast_mass_kg: p.ballast_mass_kg(ballast_m3),
            x_m: 0.0,
            creep_pressure_Pa: 0.0,
            carried_density_kg_m3: 0.0,
            late_temperature_K: 0.0,
            leaked_back_m3: 0.0,
            energy_J: 0.0,
        };
        let end = march(start, 0.02, 20_000, |s| derivative(&p, Actuation::Servo, Modes::default(), 0.0, s, &inputs));
        assert!((end.depth_m - expected_depth).abs() < 0.01, "rests at {} m", end.depth_m);
        let rates = derivative(&p, Actuation::Servo, Modes::default(), 0.0, &end, &inputs);
        assert!(rates.depth_m.abs() < 1e-4, "still moves at {} m/s", rates.depth_m);
    }
}

#[test]
fn the_kinks_of_the_servos_are_predicted_where_they_are() {
    // By small steps of the very equations: when each servo leaves its largest rate.
    let p = Parameters::default();
    let start = start(&p);
    let mut glider = Glider::new(p, Actuation::Servo, start.inputs);
    glider.inputs.ballast_command_m3 *= -1.0;
    glider.inputs.moving_mass_command_m *= -1.0;
    let left = |state: &State<f64>| {
        let ballast_s =
            (glider.inputs.ballast_command_m3 - p.ballast_m3(state.ballast_mass_kg)).abs() / p.ballast_rate_m3_s;
        let mass_s = (glider.inputs.moving_mass_command_m - state.moving_mass_1_m).abs() / p.moving_mass_rate_m_s;
        [ballast_s, mass_s]
    };
    let (mut time, mut state, mut integrator) = (0.0, start.state, Integrator::new(1e-12));
    let mut found = [None; 2];
    let mut predicted = Vec::new();
    while time < 10.0 {
        predicted.extend(next_bend_s(&p, glider.actuation, time, &state, &glider.inputs));
        let before = left(&state);
        let begun = time;
        let mut flown = glider;
        flown.fly(&mut integrator, &mut time, &mut state, begun + 1e-3, |_, _, _| true).unwrap();
        let after = left(&state);
        for (i, found) in found.iter_mut().enumerate() {
            // The servo is 1 s short of its set-point.
            if before[i] > 1.0 && after[i] <= 1.0 {
                *found = Some(begun + 1e-3 * (before[i] - 1.0) / (before[i] - after[i]));
            }
        }
    }
    let expected = found.map(|found| found.expect("both run at their largest rate for a while"));
    assert!(predicted.len() > 100);
    for bend in predicted {
        assert!(expected.iter().any(|expected| (bend - expected).abs() < 1e-6), "{bend} of {expected:?}");
    }
    // A servo that gets a constant force has no bends.
    assert_eq!(next_bend_s(&p, Actuation::Raw, 0.0, &start.state, &glider.inputs), None);
}

/// With `CL = a alpha` and `CD = b + c alpha^2` the balance along the path is `tan xi = -CD/CL`, so that a descent at the angle of attack
/// `alpha` has the pitch `alpha - atan((b + c alpha^2) / (a alpha))`. Where drag grows faster than lift this turns back at an angle
/// short of the stall: no shallower pitch flies.
#[test]
fn a_pitch_flies_up_to_the_shallowest_that_balances() {
    for (a, b, c) in [(9.5, 0.125, 16.2), (6.0, 0.2, 15.0), (4.0, 0.1, 20.0)] {
        let parameters = Parameters { a_per_rad: a, b, c_per_rad2: c, ..slocum() };
        let pitch = |alpha: f64| alpha - ((b + c * alpha * alpha) / (a * alpha)).atan();
        let grown = |i: &i32| pitch(1e-6 * f64::from(i + 1)) > pitch(1e-6 * f64::from(*i));
        let turns = (1..800_000).take_while(grown).last().expect("an angle");
        let shallowest = pitch(1e-6 * f64::from(turns));
        let water = Surroundings { density_kg_m3: 1025.0, pressure_Pa: 0.0, temperature_C: 10.0, time_s: 0.0 };
        let flies = |pitch_rad: f64| {
            crate::glide::at_pitch(&parameters, &water, Attitude { pitch_rad, net_mass_kg: 0.2 }).is_ok()
        };
        for i in 0..100 {
            let apart = 1e-6 * 1.1f64.powi(i);
            assert!(flies(shallowest - apart), "{apart} rad steeper than {shallowest}");
            assert!(!flies(shallowest + apart), "{apart} rad shallower than {shallowest}");
        }
    }
}
