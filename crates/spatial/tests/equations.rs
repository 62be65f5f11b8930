//! The equations against what must hold whatever their form: the vertical plane, conserved quantities, moving water, mirror.
#![allow(non_snake_case, reason = "coefficients are named as in the literature")]

mod support;

use glidepolar_dynamics::{self as dynamics, Actuation, Modes, Parameters};
use glidepolar_spatial::{Body, Inputs, Lateral, N_STATES, RateLaw, State, derivative, fly, outputs};
use rand::{RngExt, SeedableRng, rngs::StdRng};
use support::seawing;

/// A body with every number of the equations different from zero.
fn any_body(random: &mut StdRng) -> Body<f64> {
    let mut around = |value: f64| value * random.random_range(0.7..1.3);
    let plane = Parameters {
        pitch_damping_CMq: around(-5.0),
        pitch_damping_V2_kg_s: around(-20.0),
        CL0: around(0.05),
        CM0: around(0.02),
        ascent_a_ratio: around(0.9),
        ascent_d_ratio: around(1.1),
        offset_mass_kg: around(4.0),
        offset_mass_forward_m: around(-0.3),
        offset_mass_below_m: around(0.03),
        ballast_forward_m: around(0.6),
        ballast_below_m: around(0.02),
        added_Z_qdot_kg_m: around(2.0),
        hull_compressibility_per_Pa: 4e-10,
        drag_exponent: around(-0.2),
        nonlinear_lift_per_rad2: around(3.0),
        climb_dive_drag_ratio: around(1.1),
        vertical_current_m_s: around(0.02),
        drag_growth_per_day: around(0.1),
        hotel_W: around(1.0),
        pump_J_per_m3: around(1e6),
        ..Parameters::default()
    };
    let (cy, cl, cn) = (around(-2.0), around(-0.3), around(-0.4));
    let lateral = Lateral {
        CY_beta_per_rad: cy,
        ascent_CY_beta_per_rad: 1.1 * cy,
        Cl_beta_per_rad: cl,
        ascent_Cl_beta_per_rad: -cl,
        CN_beta_per_rad: cn,
        ascent_CN_beta_per_rad: 0.9 * cn,
        CY_r: around(0.5),
        CN_r: around(-1.5),
        ascent_CN_r: around(-1.5),
        Cl_p: around(-0.5),
        ascent_Cl_p: around(-0.5),
        Cl_r: around(0.1),
        CN_p: around(0.1),
        rudder_CY_per_rad: around(-0.6),
        rudder_CN_per_rad: around(0.3),
        rudder_Cl_per_rad: around(0.05),
        rudder_min_rad: -0.5,
        rudder_max_rad: 0.5,
        added_Y_rdot_kg_m: around(2.0),
        moving_inertia_1_kg_m2: around(0.05),
        moving_inertia_2_kg_m2: around(0.4),
        moving_inertia_3_kg_m2: around(0.3),
        roll_mass_kg: around(6.0),
        roll_mass_radius_m: around(0.05),
        roll_mass_min_rad: -1.5,
        roll_mass_max_rad: 1.5,
        roll_mass_rate_rad_s: 0.3,
        ..Lateral::default()
    };
    Body { plane, lateral, rate_law: RateLaw::Speed }
}

fn any_state(random: &mut StdRng) -> State<f64> {
    let mut within = |most: f64| random.random_range(-most..most);
    State {
        north_m: within(100.0),
        east_m: within(100.0),
        depth_m: 60.0 + within(50.0),
        roll_rad: within(1.0),
        pitch_rad: within(1.2),
        heading_rad: within(6.0),
        v1_m_s: 0.35 + within(0.3),
        v2_m_s: within(0.05),
        v3_m_s: within(0.08),
        p_rad_s: within(0.1),
        q_rad_s: within(0.1),
        r_rad_s: within(0.1),
        moving_mass_m: within(0.15),
        moving_mass_speed_m_s: within(0.02),
        roll_mass_rad: within(1.2),
        roll_mass_rate_rad_s: within(0.3),
        rudder_rad: within(0.4),
        ballast_mass_kg: 1.0 + within(0.4),
        ..State::from_array([0.0; N_STATES])
    }
}

fn any_inputs(random: &mut StdRng) -> Inputs<f64> {
    let mut within = |most: f64| random.random_range(-most..most);
    Inputs {
        ballast_command_m3: within(4e-4),
        moving_mass_command_m: within(0.15),
        roll_mass_command_rad: within(1.0),
        rudder_command_rad: within(0.4),
        current_north_m_s: within(0.3),
        current_east_m_s: within(0.3),
        current_down_m_s: within(0.02),
        ..Inputs::still_water(1027.0 + within(3.0), 10.0)
    }
}

#[test]
fn in_the_vertical_plane_the_accelerations_are_those_of_the_plane() {
    let random = &mut StdRng::seed_from_u64(11);
    for case in 0..500 {
        let body = any_body(random);
        let plane_state = any_state(random);
        let s = State {
            roll_rad: 0.0,
            v2_m_s: 0.0,
            p_rad_s: 0.0,
            r_rad_s: 0.0,
            roll_mass_rad: 0.0,
            roll_mass_rate_rad_s: 0.0,
            rudder_rad: 0.0,
            heading_rad: 0.0,
            ..plane_state
        };
        let i = Inputs { roll_mass_command_rad: 0.0, rudder_command_rad: 0.0, ..any_inputs(random) };
        let p = &body.plane;
        let (m, r1, r3) = (p.moving_mass_kg, s.moving_mass_m, p.moving_mass_height_m);
        let in_plane = dynamics::State {
            x_m: s.north_m,
            depth_m: s.depth_m,
            pitch_rad: s.pitch_rad,
            pitch_rate_rad_s: s.q_rad_s,
            v1_m_s: s.v1_m_s,
            v3_m_s: s.v3_m_s,
            moving_mass_1_m: r1,
            moving_mass_3_m: r3,
            momentum_1_kg_m_s: m * (s.v1_m_s + s.moving_mass_speed_m_s + r3 * s.q_rad_s),
            momentum_3_kg_m_s: m * (s.v3_m_s - r1 * s.q_rad_s),
            ballast_mass_kg: s.ballast_mass_kg,
            creep_pressure_Pa: 0.0,
            carried_density_kg_m3: 0.0,
            late_temperature_K: 0.0,
            leaked_back_m3: 0.0,
            energy_J: 0.0,
        };
        let plane_inputs = dynamics::Inputs {
            ballast_command_m3: i.ballast_command_m3,
            moving_mass_command_m: i.moving_mass_command_m,
            current_x_m_s: i.current_north_m_s,
            current_z_m_s: i.current_down_m_s,
            ..dynamics::Inputs::still_water(i.water_density_kg_m3, i.water_temperature_C)
        };
        let expected = dynamics::derivative(p, Actuation::Servo, Modes::default(), 1e4, &in_plane, &plane_inputs);
        let found = derivative(&body, 1e4, &s, &i);
        let pairs = [
            (found.north_m, expected.x_m, 0.3),
            (found.depth_m, expected.depth_m, 0.3),
            (found.pitch_rad, expected.pitch_rad, 0.1),
            (found.v1_m_s, expected.v1_m_s, 0.1),
            (found.v3_m_s, expected.v3_m_s, 0.1),
            (found.q_rad_s, expected.pitch_rate_rad_s, 0.1),
            (found.ballast_mass_kg, expected.ballast_mass_kg, 0.01),
            (found.energy_J, expected.energy_J, 1.0),
        ];
        for (k, (found, expected, scale)) in pairs.into_iter().enumerate() {
            let difference = (found - expected).abs() / f64::max(expected.abs(), scale);
            assert!(difference < 1e-12, "state {case}, quantity {k}: {found} against {expected}");
        }
        for sideways in [
            found.v2_m_s,
            found.p_rad_s,
            found.r_rad_s,
            found.roll_rad,
            found.heading_rad,
            found.east_m - i.current_east_m_s,
        ] {
            assert_eq!(sideways, 0.0, "state {case}");
        }
    }
}

/// What changes sign when the glider is seen in a mirror.
const ODD: [&str; 10] = [
    "east_m",
    "roll_rad",
    "heading_rad",
    "v2_m_s",
    "p_rad_s",
    "r_rad_s",
    "roll_mass_rad",
    "roll_mass_rate_rad_s",
    "rudder_rad",
    "",
];

fn mirrored(state: &State<f64>) -> State<f64> {
    let mut values = state.as_array();
    for (value, name) in values.iter_mut().zip(State::<f64>::NAMES) {
        if ODD.contains(name) {
            *value = -*value;
        }
    }
    State::from_array(values)
}

#[test]
fn mirrored_it_moves_as_its_mirror_image_to_the_last_bit() {
    let random = &mut StdRng::seed_from_u64(12);
    for _ in 0..200 {
        let (body, state, inputs) = (any_body(random), any_state(random), any_inputs(random));
        let other = Inputs {
            roll_mass_command_rad: -inputs.roll_mass_command_rad,
            rudder_command_rad: -inputs.rudder_command_rad,
            current_east_m_s: -inputs.current_east_m_s,
            ..inputs
        };
        let there = derivative(&body, 0.0, &mirrored(&state), &other);
        let expected = mirrored(&derivative(&body, 0.0, &state, &inputs));
        // Minus zero is zero.
        assert_eq!(there, expected);
    }
}

/// A body on which the water exerts no force but by its inertia.
fn without_drag(mut body: Body<f64>) -> Body<f64> {
    let (p, l) = (&mut body.plane, &mut body.lateral);
    let side = 2.0 / (1027.0 * p.frontal_area_m2 * p.length_m);
    (p.reference_density_kg_m3, p.density_bias_kg_m3) = (1027.0, 0.0);
    (p.a_per_rad, p.b, p.c_per_rad2, p.CL0, p.CM0, p.nonlinear_lift_per_rad2) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    (p.ascent_d_ratio, p.pitch_damping_CMq, p.pitch_damping_V2_kg_s) = (1.0, 0.0, 0.0);
    (p.pitch_damping_N_m_s, p.pitch_damping_quadratic_N_m_s2) = (0.0, 0.0);
    (p.hull_compressibility_per_Pa, p.vertical_current_m_s) = (0.0, 0.0);
    // The Munk couple stays in the equations; only what is beyond it goes.
    p.d_per_rad = side * (p.added_mass_3_kg - p.added_mass_1_kg);
    let CN = side * (p.added_mass_1_kg - l.added_mass_2_kg);
    *l = Lateral {
        CN_beta_per_rad: CN,
        ascent_CN_beta_per_rad: CN,
        added_mass_2_kg: l.added_mass_2_kg,
        roll_inertia_kg_m2: l.roll_inertia_kg_m2,
        yaw_inertia_kg_m2: l.yaw_inertia_kg_m2,
        added_Y_rdot_kg_m: l.added_Y_rdot_kg_m,
        moving_inertia_1_kg_m2: l.moving_inertia_1_kg_m2,
        moving_inertia_2_kg_m2: l.moving_inertia_2_kg_m2,
        moving_inertia_3_kg_m2: l.moving_inertia_3_kg_m2,
        roll_mass_kg: l.roll_mass_kg,
        roll_mass_radius_m: l.roll_mass_radius_m,
        starboard_moment_kg_m: 0.1,
        roll_mass_offset_rad: 0.05,
        roll_mass_min_rad: -1.5,
        roll_mass_max_rad: 1.5,
        ..Lateral::default()
    };
    body
}

#[test]
fn without_forces_of_the_water_energy_and_horizontal_momentum_stay() {
    let random = &mut StdRng::seed_from_u64(13);
    for _ in 0..5 {
        let body = without_drag(any_body(random));
        let begin =
            State { moving_mass_speed_m_s: 0.0, roll_mass_rate_rad_s: 0.0, pitch_rad: -0.3, ..any_state(random) };
        let inputs = Inputs {
            moving_mass_command_m: begin.moving_mass_m,
            roll_mass_command_rad: begin.roll_mass_rad,
            ballast_command_m3: body.plane.ballast_m3(begin.ballast_mass_kg),
            ..Inputs::still_water(1027.0, 10.0)
        };
        let mut state = begin;
        fly(&body, &inputs, (0.0, 20.0), &mut state, 1e-13).unwrap();
        let ([e0, n0, m0], [e1, n1, m1]) = (conserved(&body, &begin, &inputs), conserved(&body, &state, &inputs));
        // Kinetic energy: of what it had or gained, whichever is more.
        let size = f64::max(kinetic(&body, &begin).0, kinetic(&body, &state).0);
        assert!((e1 - e0).abs() < 1e-9 * size, "energy {e0} {e1} of {size}");
        let moved = body.plane.hull_mass_kg * 0.3;
        assert!((n1 - n0).abs() < 1e-9 * moved && (m1 - m0).abs() < 1e-9 * moved, "{n0} {n1}, {m0} {m1}");
    }
}

/// Kinetic energy and momentum in body axes, by finite masses summed apart from the equations' own inertia: hull, added
/// mass, offset mass, ballast, moving mass, list.
fn kinetic(body: &Body<f64>, s: &State<f64>) -> (f64, [f64; 3]) {
    let (p, l) = (&body.plane, &body.lateral);
    let (v, w) = ([s.v1_m_s, s.v2_m_s, s.v3_m_s], [s.p_rad_s, s.q_rad_s, s.r_rad_s]);
    let at = |r: [f64; 3]| {
        [v[0] + w[1] * r[2] - w[2] * r[1], v[1] + w[2] * r[0] - w[0] * r[2], v[2] + w[0] * r[1] - w[1] * r[0]]
    };
    let gamma = s.roll_mass_rad + l.roll_mass_offset_rad;
    let radius = l.roll_mass_kg * l.roll_mass_radius_m / p.moving_mass_kg;
    let mover = [s.moving_mass_m, radius * gamma.sin(), p.moving_mass_height_m - radius * (1.0 - gamma.cos())];
    // Two halves of the hull to one side of where its parts are, so that the list has no inertia but that of its place.
    let aside = l.starboard_moment_kg_m / p.hull_mass_kg;
    let bodies = [
        (p.hull_mass_kg - p.offset_mass_kg, [0.0, aside, 0.0]),
        (p.offset_mass_kg, [p.offset_mass_forward_m, aside, p.offset_mass_below_m]),
        (s.ballast_mass_kg, [p.ballast_forward_m, 0.0, p.ballast_below_m]),
        (p.moving_mass_kg, mover),
    ];
    let added = [p.added_mass_1_kg, l.added_mass_2_kg, p.added_mass_3_kg];
    let mut energy: f64 = (0..3).map(|i| 0.5 * added[i] * v[i] * v[i]).sum();
    energy += l.added_Y_rdot_kg_m * v[1] * w[2] + p.added_Z_qdot_kg_m * v[2] * w[1];
    let mut momentum =
        [added[0] * v[0], added[1] * v[1] + l.added_Y_rdot_kg_m * w[2], added[2] * v[2] + p.added_Z_qdot_kg_m * w[1]];
    for (mass, place) in bodies {
        let u = at(place);
        energy += 0.5 * mass * u.iter().map(|x| x * x).sum::<f64>();
        (0..3).for_each(|i| momentum[i] += mass * u[i]);
    }
    let hull = [l.roll_inertia_kg_m2, p.pitch_inertia_kg_m2 - l.moving_inertia_2_kg_m2, l.yaw_inertia_kg_m2];
    energy += (0..3).map(|i| 0.5 * hull[i] * w[i] * w[i]).sum::<f64>();
    // The moving mass's own inertia, in axes that turned with it: to starboard, from down towards starboard.
    let (sin, cos) = gamma.sin_cos();
    let turned = [w[0], w[1] * cos - w[2] * sin, w[1] * sin + w[2] * cos];
    let own = [l.moving_inertia_1_kg_m2, l.moving_inertia_2_kg_m2, l.moving_inertia_3_kg_m2];
    energy += (0..3).map(|i| 0.5 * own[i] * turned[i] * turned[i]).sum::<f64>();
    (energy, momentum)
}

/// Energy with that of height, and momentum to the north and to the east.
fn conserved(body: &Body<f64>, s: &State<f64>, inputs: &Inputs<f64>) -> [f64; 3] {
    let (p, l) = (&body.plane, &body.lateral);
    let (kinetic, m) = kinetic(body, s);
    let out = outputs(body, 0.0, s, inputs);
    let gamma = s.roll_mass_rad + l.roll_mass_offset_rad;
    let radius = l.roll_mass_kg * l.roll_mass_radius_m;
    let moments = [
        p.moving_mass_kg * s.moving_mass_m
            + p.offset_mass_kg * p.offset_mass_forward_m
            + s.ballast_mass_kg * p.ballast_forward_m,
        radius * gamma.sin() + l.starboard_moment_kg_m,
        p.moving_mass_kg * p.moving_mass_height_m - radius * (1.0 - gamma.cos())
            + p.offset_mass_kg * p.offset_mass_below_m
            + s.ballast_mass_kg * p.ballast_below_m,
    ];
    let ((sr, cr), (sp, cp), (sh, ch)) = (s.roll_rad.sin_cos(), s.pitch_rad.sin_cos(), s.heading_rad.sin_cos());
    let down = [-sp, sr * cp, cr * cp];
    let height = -out.net_mass_kg * s.depth_m - (0..3).map(|i| moments[i] * down[i]).sum::<f64>();
    let north = [cp * ch, sr * sp * ch - cr * sh, cr * sp * ch + sr * sh];
    let east = [cp * sh, sr * sp * sh + cr * ch, cr * sp * sh - sr * ch];
    let along = |axis: [f64; 3]| (0..3).map(|i| axis[i] * m[i]).sum::<f64>();
    [kinetic + p.gravity_m_s2 * height, along(north), along(east)]
}

#[test]
fn masses_that_move_inside_change_no_horizontal_momentum() {
    // Neutral, at rest in the beginning; the servos push the masses about, and the roll mass's weight turns the hull.
    let random = &mut StdRng::seed_from_u64(14);
    let mut body = without_drag(any_body(random));
    body.lateral.roll_mass_rate_rad_s = 0.4;
    let begin = State { depth_m: 50.0, ballast_mass_kg: 1.0, ..State::from_array([0.0; N_STATES]) };
    let inputs = Inputs {
        moving_mass_command_m: 0.1,
        roll_mass_command_rad: 0.8,
        ballast_command_m3: body.plane.ballast_m3(1.0),
        ..Inputs::still_water(1027.0, 10.0)
    };
    let mut state = begin;
    // Until both masses stand: the sums of momenta above are those of masses at rest in the hull.
    fly(&body, &inputs, (0.0, 60.0), &mut state, 1e-12).unwrap();
    assert!(state.roll_mass_rate_rad_s.abs() < 1e-9 && state.roll_rad.abs() > 1e-3, "{state:?}");
    let [_, north, east] = conserved(&body, &state, &inputs);
    assert!(north.abs() < 1e-9 && east.abs() < 1e-9, "{north} {east}");
}

#[test]
fn a_steady_current_changes_nothing_in_the_frame_of_the_water() {
    let random = &mut StdRng::seed_from_u64(15);
    let body = any_body(random);
    let begin = State { depth_m: 200.0, ..any_state(random) };
    // Pressure changes density and volume: the same depths, so a horizontal current.
    let still = Inputs { current_north_m_s: 0.0, current_east_m_s: 0.0, current_down_m_s: 0.0, ..any_inputs(random) };
    let moving = Inputs { current_north_m_s: 0.4, current_east_m_s: -0.25, ..still };
    let (mut a, mut b) = (begin, begin);
    fly(&body, &still, (0.0, 120.0), &mut a, 1e-11).unwrap();
    fly(&body, &moving, (0.0, 120.0), &mut b, 1e-11).unwrap();
    b.north_m -= 0.4 * 120.0;
    b.east_m += 0.25 * 120.0;
    for ((x, y), name) in a.as_array().into_iter().zip(b.as_array()).zip(State::<f64>::NAMES) {
        assert!((x - y).abs() < 1e-12 * f64::max(1.0, x.abs()), "{name}: {x} {y}");
    }
}

#[test]
fn a_neutral_body_without_drag_follows_any_uniform_current() {
    let random = &mut StdRng::seed_from_u64(16);
    for _ in 0..20 {
        let mut body = without_drag(any_body(random));
        let l = &mut body.lateral;
        (l.starboard_moment_kg_m, l.roll_mass_offset_rad, l.roll_mass_radius_m) = (0.0, 0.0, 0.0);
        body.plane.moving_mass_height_m = 0.0;
        (body.plane.offset_mass_below_m, body.plane.offset_mass_forward_m) = (0.0, 0.0);
        (body.plane.ballast_below_m, body.plane.ballast_forward_m) = (0.0, 0.0);
        // Its masses at the centre of buoyancy, or the water's acceleration would swing them like a pendulum.
        let state = State {
            depth_m: 50.0,
            ballast_mass_kg: 1.0,
            roll_rad: 0.3,
            heading_rad: 1.0,
            ..State::from_array([0.0; N_STATES])
        };
        let inputs = Inputs {
            current_north_rate_m_s2: random.random_range(-0.1..0.1),
            current_east_rate_m_s2: random.random_range(-0.1..0.1),
            current_down_rate_m_s2: random.random_range(-0.1..0.1),
            current_down_m_s: 0.0,
            ..any_inputs(random)
        };
        let inputs =
            Inputs { water_density_kg_m3: 1027.0, moving_mass_command_m: 0.0, roll_mass_command_rad: 0.0, ..inputs };
        let rates = derivative(&body, 0.0, &state, &inputs);
        for rate in [rates.v1_m_s, rates.v2_m_s, rates.v3_m_s, rates.p_rad_s, rates.q_rad_s, rates.r_rad_s] {
            assert!(rate.abs() < 1e-12, "{rates:?}");
        }
        assert_eq!((rates.north_m, rates.east_m), (inputs.current_north_m_s, inputs.current_east_m_s));
    }
}

#[test]
fn an_accelerometer_in_a_steady_glide_reads_gravity() {
    let body = seawing();
    let random = &mut StdRng::seed_from_u64(17);
    let state = State { depth_m: 50.0, ballast_mass_kg: 0.0, ..State::from_array([0.0; N_STATES]) };
    let still = Inputs { moving_mass_command_m: 0.0, ..Inputs::still_water(1025.0, 15.0) };
    let mut level = state;
    level.roll_rad = random.random_range(-0.5..0.5);
    let imu = outputs(&body, 0.0, &level, &still).imu_m_s2;
    let own = derivative(&body, 0.0, &level, &still);
    let read = [imu[0] - own.v1_m_s, imu[1] - own.v2_m_s, imu[2] - own.v3_m_s];
    let expected = [0.0, -9.81 * level.roll_rad.sin(), -9.81 * level.roll_rad.cos()];
    for (read, expected) in read.into_iter().zip(expected) {
        assert!((read - expected).abs() < 1e-12, "{imu:?}");
    }
}
