//! Water that accelerates, in time and across its depths, against Newton's law in the frame of the ground.

use super::*;

/// A horizontal current with shear and a rate of its own, and a vertical one: velocity, its change with depth, its rates.
#[derive(Debug, Clone, Copy)]
struct Current {
    x_m_s: f64,
    z_m_s: f64,
    shear_1_s: f64,
    x_rate_m_s2: f64,
    z_rate_m_s2: f64,
}

const STILL: Current = Current { x_m_s: 0.0, z_m_s: 0.0, shear_1_s: 0.0, x_rate_m_s2: 0.0, z_rate_m_s2: 0.0 };

impl Current {
    /// Horizontal and downward velocity.
    fn at(&self, time_s: f64, depth_m: f64) -> [f64; 2] {
        [self.x_m_s + self.shear_1_s * depth_m + self.x_rate_m_s2 * time_s, self.z_m_s + self.z_rate_m_s2 * time_s]
    }

    fn inputs(&self, time_s: f64, depth_m: f64, otherwise: &Inputs<f64>) -> Inputs<f64> {
        let [x, z] = self.at(time_s, depth_m);
        Inputs {
            current_x_m_s: x,
            current_z_m_s: z,
            current_x_shear_1_s: self.shear_1_s,
            current_x_rate_m_s2: self.x_rate_m_s2,
            current_z_rate_m_s2: self.z_rate_m_s2,
            ..*otherwise
        }
    }
}

/// Newton and Euler in the frame of the ground for a body whose moving mass rests on the hull. The state is x, depth, pitch,
/// the momentum of body and added mass along x and down, the angular momentum about the centre of buoyancy.
///
/// The momentum of the body is that of its velocity over ground, that of the added mass that of its velocity through the
/// water; from outside come weight, lift and drag, and the pressure of accelerating water on the displaced volume.
fn newton(p: &Parameters<f64>, ballast_kg: f64, r1: f64, current: &Current, time_s: f64, y: &[f64; 6]) -> [f64; 6] {
    let [_, depth, pitch, px, pz, spin] = *y;
    let (sin, cos) = pitch.sin_cos();
    let [ux, uz] = current.at(time_s, depth);
    let (u1, u3) = (ux * cos - uz * sin, ux * sin + uz * cos);
    let (p1, p3) = (px * cos - pz * sin, px * sin + pz * cos);
    // Masses with their places; the rest of the hull sits at the origin.
    let points = [
        (p.moving_mass_kg, r1, p.moving_mass_height_m),
        (p.offset_mass_kg, p.offset_mass_forward_m, p.offset_mass_below_m),
        (ballast_kg, p.ballast_forward_m, p.ballast_below_m),
        (p.hull_mass_kg - p.offset_mass_kg, 0.0, 0.0),
    ];
    let mass: f64 = points.iter().map(|(m, _, _)| m).sum();
    let first: [f64; 2] = [points.iter().map(|(m, r, _)| m * r).sum(), points.iter().map(|(m, _, r)| m * r).sum()];
    let second: f64 = points.iter().map(|(m, a, b)| m * (a * a + b * b)).sum();
    // p1 = mass v1 + first3 Om + mf1 (v1 - u1), p3 = mass v3 - first1 Om + mf3 (v3 - u3),
    // spin = (J + second) Om + first3 v1 - first1 v3.
    let (m1, m3) = (mass + p.added_mass_1_kg, mass + p.added_mass_3_kg);
    let (a1, a3) = (p1 + p.added_mass_1_kg * u1, p3 + p.added_mass_3_kg * u3);
    let inertia = p.pitch_inertia_kg_m2 + second - first[1] * first[1] / m1 - first[0] * first[0] / m3;
    let rate = (spin - first[1] * a1 / m1 + first[0] * a3 / m3) / inertia;
    let (v1, v3) = ((a1 - first[1] * rate) / m1, (a3 + first[0] * rate) / m3);
    let (w1, w3) = (v1 - u1, v3 - u3);

    // Lift and drag by the coefficients, turned into body axes by the velocity through the water.
    let (speed, alpha) = (w1.hypot(w3), w3.atan2(w1));
    let q_area = 0.5 * p.reference_density_kg_m3 * speed * speed * p.frontal_area_m2;
    let (lift, drag) = (q_area * p.a_per_rad * alpha, q_area * (p.b + p.c_per_rad2 * alpha * alpha));
    let (f1, f3) = (lift * alpha.sin() - drag * alpha.cos(), -lift * alpha.cos() - drag * alpha.sin());
    let tank_moment = q_area * p.length_m * p.d_per_rad * alpha
        + p.pitch_damping_N_m_s * rate
        + p.pitch_damping_quadratic_N_m_s2 * rate * rate.abs();
    // The tank's moment holds the couple of the added mass in its own approximation; the exact one follows below.
    let moment = tank_moment - (p.added_mass_3_kg - p.added_mass_1_kg) * alpha * speed * speed;

    let water_x = current.x_rate_m_s2 + current.shear_1_s * uz;
    let water_z = current.z_rate_m_s2;
    let g = p.gravity_m_s2;
    let (solid1, solid3) = (mass * v1 + first[1] * rate, mass * v3 - first[0] * rate);
    [
        v1 * cos + v3 * sin,
        v3 * cos - v1 * sin,
        rate,
        f1 * cos + f3 * sin + p.displaced_mass_kg * water_x,
        f3 * cos - f1 * sin + p.displaced_mass_kg * water_z + (mass - p.displaced_mass_kg) * g,
        moment - g * (first[0] * cos + first[1] * sin)
            // The origin moves: -v x P of the body, and of the added mass with its own velocity.
            - (v3 * solid1 - v1 * solid3)
            + (p.added_mass_3_kg - p.added_mass_1_kg) * w1 * w3,
    ]
}

fn runge_kutta<const N: usize>(
    mut y: [f64; N],
    step: f64,
    steps: usize,
    f: impl Fn(f64, &[f64; N]) -> [f64; N],
) -> [f64; N] {
    let along = |y: &[f64; N], k: &[f64; N], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
    for i in 0..steps {
        let t = step * i as f64;
        let k1 = f(t, &y);
        let k2 = f(t + 0.5 * step, &along(&y, &k1, 0.5 * step));
        let k3 = f(t + 0.5 * step, &along(&y, &k2, 0.5 * step));
        let k4 = f(t + step, &along(&y, &k3, step));
        y = std::array::from_fn(|i| y[i] + step * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
    }
    y
}

/// A glider with masses off its centre, in a steady glide of 25 deg.
fn off_centre() -> (Parameters<f64>, State<f64>, Inputs<f64>) {
    let p = Parameters {
        offset_mass_kg: 3.0,
        offset_mass_forward_m: -0.04,
        offset_mass_below_m: 0.02,
        ballast_forward_m: 0.3,
        ballast_below_m: 0.01,
        ..Parameters::default()
    };
    let (state, inputs) = gliding(&p, -25.0, 0.3);
    (p, state, inputs)
}

#[test]
fn through_shear_and_accelerating_water_it_is_newtons_law() {
    let (p, start, inputs) = off_centre();
    let r1 = start.moving_mass_1_m;
    for current in [
        Current { shear_1_s: 0.015, ..STILL },
        Current { x_m_s: 0.1, z_m_s: -0.02, shear_1_s: -0.015, x_rate_m_s2: 2e-3, z_rate_m_s2: -1e-3 },
        Current { x_m_s: -0.3, z_m_s: 0.05, shear_1_s: 0.0, x_rate_m_s2: -4e-3, z_rate_m_s2: 2e-3 },
    ] {
        let (step, steps) = (0.02, 4000);
        let end = State::from_array(runge_kutta(start.as_array(), step, steps, |t, y| {
            let s = State::from_array(*y);
            let inputs = current.inputs(t, s.depth_m, &inputs);
            derivative(&p, Actuation::Servo, Modes::default(), t, &s, &inputs).as_array()
        }));

        let [ux, uz] = current.at(0.0, start.depth_m);
        let (sin, cos) = start.pitch_rad.sin_cos();
        let (u1, u3) = (ux * cos - uz * sin, ux * sin + uz * cos);
        let mass = p.hull_mass_kg + p.moving_mass_kg + start.ballast_mass_kg;
        let p1 = mass * (start.v1_m_s + u1) + p.added_mass_1_kg * start.v1_m_s;
        let p3 = mass * (start.v3_m_s + u3) + p.added_mass_3_kg * start.v3_m_s;
        let first_1 = p.moving_mass_kg * r1
            + p.offset_mass_kg * p.offset_mass_forward_m
            + start.ballast_mass_kg * p.ballast_forward_m;
        let first_3 = p.moving_mass_kg * p.moving_mass_height_m
            + p.offset_mass_kg * p.offset_mass_below_m
            + start.ballast_mass_kg * p.ballast_below_m;
        let spin = first_3 * (start.v1_m_s + u1) - first_1 * (start.v3_m_s + u3);
        let begin = [start.x_m, start.depth_m, start.pitch_rad, p1 * cos + p3 * sin, p3 * cos - p1 * sin, spin];
        let [x, depth, pitch, ..] =
            runge_kutta(begin, step, steps, |t, y| newton(&p, start.ballast_mass_kg, r1, &current, t, y));

        // The servo holds the ballast mass and the moving mass; what they drift by is rounding.
        assert!((end.moving_mass_1_m - r1).abs() < 1e-9 && (end.ballast_mass_kg - start.ballast_mass_kg).abs() < 1e-9);
        for (name, found, expected) in
            [("x", end.x_m, x), ("depth", end.depth_m, depth), ("pitch", end.pitch_rad, pitch)]
        {
            let allowed = 1e-6 * expected.abs().max(0.1);
            assert!((found - expected).abs() < allowed, "{current:?}: {name} {found} against {expected}");
        }
        // And the water has done something: without its acceleration the glider is elsewhere.
        let still = State::from_array(runge_kutta(start.as_array(), step, steps, |t, y| {
            let s = State::from_array(*y);
            let [x, z] = current.at(t, s.depth_m);
            let inputs = Inputs { current_x_m_s: x, current_z_m_s: z, ..inputs };
            derivative(&p, Actuation::Servo, Modes::default(), t, &s, &inputs).as_array()
        }));
        if current.shear_1_s != 0.0 {
            assert!((still.depth_m - end.depth_m).abs() > 0.3, "{current:?}: {} {}", still.depth_m, end.depth_m);
        }
    }
}

/// A neutral body without lift and drag stays where it is in water that is accelerated as a whole.
#[test]
fn a_neutral_body_is_carried_by_any_uniform_current() {
    let p = Parameters { moving_mass_height_m: 0.0, ballast_offset_kg: 0.0, ..Parameters::default() };
    let neutral = Inputs { ballast_command_m3: 0.0, ..water(&p) };
    let start = State {
        x_m: 0.0,
        depth_m: 50.0,
        pitch_rad: 0.4,
        pitch_rate_rad_s: 0.0,
        v1_m_s: 0.0,
        v3_m_s: 0.0,
        moving_mass_1_m: 0.0,
        moving_mass_3_m: 0.0,
        momentum_1_kg_m_s: 0.0,
        momentum_3_kg_m_s: 0.0,
        ballast_mass_kg: p.ballast_nominal_kg,
        creep_pressure_Pa: 0.0,
        carried_density_kg_m3: 0.0,
        late_temperature_K: 0.0,
        leaked_back_m3: 0.0,
        energy_J: 0.0,
    };
    let current = Current { x_m_s: 0.2, z_m_s: 0.03, shear_1_s: 0.0, x_rate_m_s2: 3e-3, z_rate_m_s2: -1e-3 };
    let end = State::from_array(runge_kutta(start.as_array(), 0.1, 1000, |t, y| {
        let s = State::from_array(*y);
        derivative(&p, Actuation::Servo, Modes::default(), t, &s, &current.inputs(t, s.depth_m, &neutral)).as_array()
    }));
    assert!((end.x_m - (0.2 * 100.0 + 0.5 * 3e-3 * 1e4)).abs() < 1e-9, "{end:?}");
    assert!((end.depth_m - (50.0 + 0.03 * 100.0 - 0.5 * 1e-3 * 1e4)).abs() < 1e-9, "{end:?}");
    assert!(end.v1_m_s.abs() < 1e-12 && end.v3_m_s.abs() < 1e-12 && (end.pitch_rad - 0.4).abs() < 1e-12, "{end:?}");
}

/// The water's own velocity moves the frame and nothing else.
#[test]
fn a_steady_uniform_current_changes_nothing_through_the_water() {
    let (p, start, inputs) = off_centre();
    let fly = |current: Current| {
        State::from_array(runge_kutta(start.as_array(), 0.05, 1000, |t, y| {
            let s = State::from_array(*y);
            let turned = Inputs { moving_mass_command_m: -0.02, ballast_command_m3: 2e-4, ..inputs };
            let inputs = current.inputs(t, s.depth_m, &turned);
            derivative(&p, Actuation::Servo, Modes::default(), t, &s, &inputs).as_array()
        }))
    };
    let (still, carried) = (fly(STILL), fly(Current { x_m_s: 0.4, ..STILL }));
    assert!((carried.x_m - still.x_m - 0.4 * 50.0).abs() < 1e-9);
    let without_x = |s: State<f64>| State { x_m: 0.0, ..s };
    assert_eq!(without_x(carried), without_x(still));
}
