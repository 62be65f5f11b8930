//! The glider in six degrees of freedom through the same functions: its runs against the library's own, saved states,
//! partial derivatives against differences, heading control, the plane inside it.

mod support;

use glidepolar_fmu::description::structure::structure;
use glidepolar_fmu::fmi3::*;
use glidepolar_fmu::model::vehicle::Vehicle;
use glidepolar_fmu::model::{Kind, Model, Slot};
use glidepolar_ode::Integrator;
use glidepolar_spatial::{Body, Inputs, Lateral, SpatialGlider, State, Steering};
use support::*;

const SPACE: Model = Model::Space;

/// The body, state and inputs of the default vehicle.
fn library() -> (Body<f64>, State<f64>, Inputs<f64>) {
    let glider = Vehicle::built_in(SPACE).glider;
    let values = &glider.values;
    let n = values.parameters.len() - glidepolar_spatial::N_LATERAL;
    let lateral = Lateral::from_array(std::array::from_fn(|i| values.parameters[n + i]));
    let body = Body { plane: glider.parameters(), lateral, rate_law: glider.rate_law };
    (body, State::from_array(values.state), Inputs::from_array(std::array::from_fn(|i| values.inputs[i])))
}

fn states(glider: &Glider3) -> Vec<f64> {
    (0..SPACE.n_states()).map(|i| glider.get(SPACE.table().variable_of(Slot::State(i)).name)).collect()
}

fn near(found: &[f64], expected: &[f64], tolerance: f64) {
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        let error = (found - expected).abs() / SPACE.nominals()[i];
        assert!(error < tolerance, "state {i}: {found} against {expected}");
    }
}

#[test]
fn a_turn_is_the_library_s_whatever_the_communication_step() {
    let (body, mut state, mut inputs) = library();
    inputs.rudder_command_rad = 0.2;
    (inputs.current_east_m_s, inputs.current_north_shear_1_s) = (0.1, 1e-4);
    let (mut time, mut integrator) = (0.0, Integrator::new(1e-12));
    let own = SpatialGlider::new(body, Steering::Direct, inputs);
    own.fly(&mut integrator, &mut time, &mut state, 300.0).unwrap();
    assert!(state.heading_rad > 1.0, "it turns to starboard: {state:?}");
    for step in [300.0, 10.0, 0.5] {
        let glider = Glider3::of(SPACE, Options::default());
        glider.set(&[("rudder_command_rad", 0.2), ("current_east_m_s", 0.1), ("current_north_shear_1_s", 1e-4)]);
        glider.begin(Some(1e-10));
        glider.run(0.0, 300.0, step);
        near(&states(&glider), &state.as_array(), 1e-6);
    }
}

/// A voyage of forty legs.
#[test]
fn without_roll_and_rudder_it_is_the_plane() {
    const LEG_S: f64 = 400.0;
    let plane = Glider3::co_simulation(Options::default());
    let space = Glider3::of(SPACE, Options::default());
    for glider in [&plane, &space] {
        glider.set(&[("hull_compressibility_per_Pa", 4e-10), ("leak_kg_per_hour", 1e-4)]);
        glider.begin(Some(1e-11));
        for leg in 0..40 {
            let begin = f64::from(leg) * LEG_S;
            glider.run(begin, begin + LEG_S, 10.0);
            glider.set(&["ballast_command_m3", "moving_mass_command_m"].map(|name| (name, -glider.get(name))));
        }
    }
    assert!(plane.get("x_m") > 3000.0, "{} m", plane.get("x_m"));
    let pairs = [
        ("x_m", "north_m", 1e3),
        ("depth_m", "depth_m", 100.0),
        ("pitch_rad", "pitch_rad", 1.0),
        ("pitch_rate_rad_s", "q_rad_s", 1.0),
        ("v1_m_s", "v1_m_s", 1.0),
        ("v3_m_s", "v3_m_s", 1.0),
        ("energy_J", "energy_J", 1e3),
    ];
    for (in_plane, in_space, size) in pairs {
        let (a, b) = (plane.get(in_plane), space.get(in_space));
        assert!((a - b).abs() < 1e-9 * size, "{in_plane}: {a} against {b}");
    }
    assert_eq!(["east_m", "roll_rad", "heading_rad", "v2_m_s"].map(|name| space.get(name)), [0.0; 4]);
}

/// A run with something going on.
fn busy() -> Glider3 {
    let glider = Glider3::of(SPACE, Options::default());
    glider.choose("steering", 1);
    glider.set(&[("drag_step", 0.3), ("step_time_s", 70.0), ("seabed_depth_m", 25.0), ("heading_command_rad", 1.0)]);
    glider.set(&[("net_mass_step_kg", 0.02), ("net_mass_step_time_s", 22.5)]);
    glider.begin(None);
    glider.run(0.0, 20.0, 1.0);
    glider.set(&[("moving_mass_command_m", 0.01), ("CN_r", -0.5)]);
    glider.run(20.0, 23.0, 1.0);
    glider
}

fn go_on(glider: &Glider3) -> Vec<u64> {
    glider.run(23.0, 60.0, 1.0);
    glider.set(&[("ballast_command_m3", 1e-4)]);
    glider.run(60.0, 200.0, 4.0);
    let reals = SPACE.table().rows.iter().filter(|variable| variable.kind == Kind::Real);
    reals.map(|variable| glider.get(variable.name).to_bits()).collect()
}

#[test]
fn a_saved_run_goes_on_bit_for_bit_here_and_in_another_instance() {
    let glider = busy();
    let saved = glider.save();
    let bytes = glider.serialize(saved);
    let expected = go_on(&glider);
    glider.restore(saved);
    assert_eq!(go_on(&glider), expected);
    let other = Glider3::of(SPACE, Options::default());
    let state = other.deserialize(&bytes).unwrap();
    other.restore(state);
    assert_eq!(go_on(&other), expected);
    assert_eq!(other.serialize(state), bytes);
    // The state of one model is none of the other.
    assert!(Glider3::co_simulation(Options::default()).deserialize(&bytes).is_err());
}

#[test]
fn the_counts_of_states_and_indicators_are_those_of_the_model() {
    for model in Model::ALL {
        let glider = Glider3::model_exchange_of(model);
        let (mut states, mut indicators) = (0, 0);
        // SAFETY: a live instance and places of its own.
        unsafe {
            glider.ok(fmi3GetNumberOfContinuousStates(glider.instance, &mut states));
            glider.ok(fmi3GetNumberOfEventIndicators(glider.instance, &mut indicators));
        }
        let count = |is: fn(Slot) -> bool| model.table().rows.iter().filter(|row| is(row.slot)).count();
        assert_eq!(states, count(|slot| matches!(slot, Slot::State(_))), "{model:?}");
        assert_eq!(indicators, count(|slot| matches!(slot, Slot::Indicator(_))), "{model:?}");
    }
}

#[test]
fn a_heading_is_reached_and_held_by_the_rudder() {
    for command in [0.8, -2.5] {
        let glider = Glider3::of(SPACE, Options::default());
        glider.choose("steering", 1);
        glider.set(&[("heading_command_rad", command)]);
        glider.begin(None);
        glider.run(0.0, 900.0, 10.0);
        assert!((glider.get("heading_rad") - command).abs() < 0.02, "{} of {command}", glider.get("heading_rad"));
        assert!(glider.get("turn_rate_rad_s").abs() < 1e-3);
    }
}

#[test]
fn left_on_the_seabed_in_a_current_it_rests() {
    let glider = Glider3::of(SPACE, Options::default());
    glider.set(&[("seabed_depth_m", 30.0), ("current_east_m_s", 0.3), ("current_north_m_s", -0.2)]);
    glider.begin(None);
    glider.run(0.0, 3000.0, 60.0);
    assert!(glider.is("on_seabed"));
    let before = [glider.get("north_m"), glider.get("east_m")];
    glider.run(3000.0, 3600.0, 60.0);
    for (before, name) in before.into_iter().zip(["north_m", "east_m"]) {
        assert!((glider.get(name) - before).abs() < 1e-3, "{name}: {before} to {}", glider.get(name));
    }
}

/// Numbers between -1 and 1 (xorshift).
struct Odd(u64);

impl Odd {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// In continuous time, at a random state in free water, the servos within their rates.
fn somewhere(odd: &mut Odd, steering: i32) -> Glider3 {
    let glider = Glider3::model_exchange_of(SPACE);
    glider.choose("steering", steering);
    let mut near = |middle: f64, most: f64| middle + most * odd.next();
    let starts = [
        ("depth_m", near(60.0, 20.0)),
        ("roll_rad", near(0.0, 0.6)),
        ("pitch_rad", near(0.0, 0.8)),
        ("heading_rad", near(0.0, 3.0)),
        ("v1_m_s", near(0.35, 0.2)),
        ("v2_m_s", near(0.0, 0.05)),
        ("v3_m_s", near(0.0, 0.08)),
        ("p_rad_s", near(0.0, 0.1)),
        ("q_rad_s", near(0.0, 0.1)),
        ("r_rad_s", near(0.0, 0.1)),
        ("moving_mass_speed_m_s", near(0.0, 0.01)),
        ("roll_mass_speed_rad_s", near(0.03, 0.02)),
        ("current_north_m_s", near(0.0, 0.3)),
        ("current_east_m_s", near(0.0, 0.3)),
        ("current_down_m_s", near(0.0, 0.02)),
        ("current_north_shear_1_s", near(0.0, 0.01)),
        ("current_east_shear_1_s", near(0.0, 0.01)),
        ("current_north_rate_m_s2", near(0.0, 1e-3)),
        ("current_east_rate_m_s2", near(0.0, 1e-3)),
        ("current_down_rate_m_s2", near(0.0, 1e-3)),
        ("hull_compressibility_per_Pa", 4e-10),
        ("nonlinear_lift_per_rad2", 3.0),
        ("starboard_moment_kg_m", 0.05),
        ("hotel_W", 1.5),
    ];
    glider.set(&starts);
    // Within the band in which a servo follows in proportion, and the pump at work.
    let here = |name: &str| glider.get(name);
    let heading = here("heading_rad") + 0.03;
    let commands = [
        ("rudder_command_rad", here("rudder_rad") + 0.03),
        ("roll_mass_command_rad", here("roll_mass_rad") + 0.03),
        ("heading_command_rad", heading),
        ("ballast_command_m3", here("ballast_m3") + 1e-5),
        ("moving_mass_command_m", here("moving_mass_position_m") + 1e-3),
    ];
    glider.set(&commands);
    glider.begin(None);
    // SAFETY: a live instance.
    unsafe {
        glider.update_discrete_states();
        glider.ok(fmi3EnterContinuousTimeMode(glider.instance));
    }
    glider
}

fn rates(glider: &Glider3) -> Vec<f64> {
    let mut rates = vec![0.0; SPACE.n_states()];
    // SAFETY: a live instance and room for all rates.
    glider.ok(unsafe { fmi3GetContinuousStateDerivatives(glider.instance, rates.as_mut_ptr(), rates.len()) });
    rates
}

fn set_states(glider: &Glider3, states: &[f64]) {
    // SAFETY: a live instance and all states.
    glider.ok(unsafe { fmi3SetContinuousStates(glider.instance, states.as_ptr(), states.len()) });
}

/// Derivatives of all rates along one known.
fn column(glider: &Glider3, known: u32) -> Vec<f64> {
    let unknowns: Vec<u32> = (0..SPACE.n_states()).map(|i| SPACE.table().reference_of(Slot::Derivative(i))).collect();
    let mut found = vec![f64::NAN; unknowns.len()];
    // SAFETY: a live instance and arrays of these lengths.
    glider.ok(unsafe {
        fmi3GetDirectionalDerivative(
            glider.instance,
            unknowns.as_ptr(),
            unknowns.len(),
            &known,
            1,
            &1.0,
            1,
            found.as_mut_ptr(),
            found.len(),
        )
    });
    found
}

#[test]
fn directional_derivatives_are_those_of_differences_at_fifty_states() {
    let mut odd = Odd(0x9e37_79b9_7f4a_7c15);
    for case in 0..50 {
        let glider = somewhere(&mut odd, case % 3);
        let here = states(&glider);
        for i in 0..here.len() {
            let exact = column(&glider, SPACE.table().reference_of(Slot::State(i)));
            let difference = |h: f64| {
                let at = |value: f64| {
                    let mut moved = here.clone();
                    moved[i] = value;
                    set_states(&glider, &moved);
                    rates(&glider)
                };
                let (above, below) = (at(here[i] + h), at(here[i] - h));
                above.iter().zip(below).map(|(a, b)| (a - b) / (2.0 * h)).collect::<Vec<_>>()
            };
            // Richardson: the error of fourth order.
            let h = 1e-3 * SPACE.nominals()[i];
            let (one, two) = (difference(h), difference(2.0 * h));
            set_states(&glider, &here);
            for (j, exact) in exact.iter().enumerate() {
                let numeric = (4.0 * one[j] - two[j]) / 3.0;
                // In units of the state over its rate's.
                let size = SPACE.nominals()[j] / SPACE.nominals()[i];
                let error = (exact - numeric).abs() / f64::max(exact.abs(), size);
                assert!(error < 1e-6, "case {case}: d rate {j} / d state {i}: {exact} against {numeric}");
            }
        }
    }
}

#[test]
fn the_adjoint_is_the_transpose() {
    let mut odd = Odd(0x1234_5678_9abc_def1);
    for steering in 0..3 {
        let glider = somewhere(&mut odd, steering);
        let unknowns: Vec<u32> =
            (0..SPACE.n_states()).map(|i| SPACE.table().reference_of(Slot::Derivative(i))).collect();
        let knowns: Vec<u32> = (0..SPACE.n_states()).map(|i| SPACE.table().reference_of(Slot::State(i))).collect();
        let columns: Vec<Vec<f64>> = knowns.iter().map(|known| column(&glider, *known)).collect();
        let seed: Vec<f64> = unknowns.iter().map(|_| odd.next()).collect();
        let mut found = vec![f64::NAN; knowns.len()];
        // SAFETY: a live instance and arrays of these lengths.
        glider.ok(unsafe {
            fmi3GetAdjointDerivative(
                glider.instance,
                unknowns.as_ptr(),
                unknowns.len(),
                knowns.as_ptr(),
                knowns.len(),
                seed.as_ptr(),
                seed.len(),
                found.as_mut_ptr(),
                found.len(),
            )
        });
        for (found, column) in found.into_iter().zip(columns) {
            let expected: f64 = column.iter().zip(&seed).map(|(a, b)| a * b).sum();
            assert!((found - expected).abs() < 1e-12 * expected.abs().max(1.0), "{found} against {expected}");
        }
    }
}

#[test]
fn what_depends_on_what_is_what_the_equations_say() {
    let structure = structure(SPACE);
    let names = |of: &str| {
        let unknown = structure.derivatives.iter().find(|unknown| unknown.reference == vr_of(SPACE, of)).unwrap();
        let name = |reference: &u32| SPACE.table().variable(*reference).unwrap().name;
        unknown.dependencies.iter().map(name).collect::<Vec<_>>()
    };
    // From the kinematics alone, and the current that dies out at the bed.
    let north = names("der(north_m)");
    for known in ["current_north_m_s", "roll_rad", "pitch_rad", "heading_rad", "v1_m_s", "v2_m_s", "v3_m_s"] {
        assert!(north.contains(&known), "{north:?}");
    }
    assert!(!north.contains(&"rudder_rad") && !north.contains(&"current_east_m_s"), "{north:?}");
    assert!(names("der(rudder_rad)").contains(&"heading_command_rad"));
    assert!(names("der(roll_mass_speed_rad_s)").contains(&"heading_command_rad"));
    assert!(names("der(r_rad_s)").contains(&"rudder_rad"));
}
