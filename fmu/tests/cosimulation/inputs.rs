//! Inputs of a communication step: how they move between two steps, what limits do to them, and outputs' derivatives.

use glidepolar_fmu::fmi2::*;
use glidepolar_fmu::fmi3::*;

use super::support::*;
use super::{turn, update};

#[test]
fn raw_ballast_runs_into_its_limit_and_says_so() {
    let glider = Glider3::co_simulation(Options::default());
    glider.set_actuation(2);
    glider.set(&[("u4_kg_s", 0.025)]);
    glider.begin(None);
    let start = glider.get("ballast_mass_kg");
    glider.run(0.0, 5.0, 5.0);
    assert_eq!(glider.integer("ballast_stop"), 0);
    assert!((glider.get("ballast_mass_kg") - start - 0.125).abs() < 1e-9);
    glider.run(5.0, 60.0, 5.0);
    assert_eq!(glider.integer("ballast_stop"), -1);
    assert!((glider.get("ballast_m3") - glider.get("ballast_min_m3")).abs() < 1e-15);
    glider.set(&[("u4_kg_s", -0.025)]);
    glider.run(60.0, 61.0, 1.0);
    assert_eq!(glider.integer("ballast_stop"), 0);
}

#[test]
fn a_moving_mass_whose_stop_is_set_farther_off_goes_on_from_where_it_is() {
    let glider = Glider3::co_simulation(Options::default());
    glider.set_actuation(2);
    glider.set(&[("depth_m", 500.0), ("u1_N", 2.0)]);
    glider.begin(None);
    glider.run(0.0, 10.0, 10.0);
    assert_eq!(glider.integer("moving_mass_stop"), 1);
    glider.set(&[("moving_mass_max_m", 0.3)]);
    glider.run(10.0, 10.0 + 1e-6, 1e-6);
    assert_eq!(glider.integer("moving_mass_stop"), 0);
    let position = glider.get("moving_mass_position_m");
    assert!((position - 0.2).abs() < 1e-9, "{position}");
    assert!(glider.environment.messages.take().is_empty());
}

#[test]
fn what_a_limit_moves_is_told() {
    let glider = Glider3::co_simulation(Options::default());
    glider.set_actuation(2);
    glider.set(&[("ballast_mass_kg", 3.0)]);
    glider.begin(None);
    let messages = glider.environment.messages.take();
    assert_eq!(messages.len(), 1, "{messages:?}");
    let (status, message) = &messages[0];
    assert!(*status == WARNING && message.contains("ballast_mass_kg = 3.0 kg lies beyond ballast_min_m3"), "{message}");
    assert!(message.contains("moved to 1.5135"), "{message}");
    glider.set(&[("moving_mass_max_m", -0.1)]);
    glider.run(0.0, 1.0, 1.0);
    let messages = glider.environment.messages.take();
    assert_eq!(messages.len(), 1, "{messages:?}");
    assert!(messages[0].1.contains("beyond moving_mass_max_m = -0.1 m; the mass was moved to -0.1 m"), "{messages:?}");
}

#[test]
fn inputs_set_from_inside_a_step_act_from_there_on() {
    let options = Options { look_in: true, ..Options::default() };
    let mut glider = Glider3::started(options, &[]);
    glider.environment.look_in = Some(Box::new(|instance, time, _| {
        let current = 0.01 * time;
        // SAFETY: a live instance inside its step.
        assert_eq!(unsafe { fmi3SetFloat64(instance, &vr("current_x_m_s"), 1, &current, 1) }, OK);
        None
    }));
    let x_without = {
        let still = Glider3::started(Options::default(), &[]);
        still.run(0.0, 20.0, 20.0);
        still.get("x_m")
    };
    glider.run(0.0, 20.0, 20.0);
    // Held at the last value between looks: less than the ramp, more than nothing.
    let drift = glider.get("x_m") - x_without;
    assert!(drift > 0.0 && drift < 2.0, "{drift}");
}

#[test]
fn inputs_move_between_communication_points_as_their_derivatives_say() {
    let glider = Glider2::new(CO_SIMULATION);
    glider.begin();
    let still = Glider2::new(CO_SIMULATION);
    still.begin();
    glider.slope("current_x_m_s", 1, 0.02);
    glider.slope("current_x_m_s", 2, 0.006);
    assert_eq!((glider.step(0.0, 10.0), still.step(0.0, 10.0)), (OK, OK));
    // The current carries the glider by its integral: a t^2/2 + b t^3/6.
    let expected = 0.02 * 50.0 + 0.006 * 1000.0 / 6.0;
    let drift = glider.get("x_m") - still.get("x_m");
    assert!((drift - expected).abs() < 1e-9, "{drift} against {expected}");
    assert!((glider.get("current_x_m_s") - (0.02 * 10.0 + 0.006 * 50.0)).abs() < 1e-12);
    // They hold for one step: the current stands still afterwards.
    assert_eq!((glider.step(10.0, 10.0), still.step(10.0, 10.0)), (OK, OK));
    let drift = glider.get("x_m") - still.get("x_m");
    assert!((drift - expected - 0.5 * 10.0).abs() < 1e-9, "{drift}");
}

#[test]
fn outputs_have_exact_derivatives() {
    let glider = Glider2::new(CO_SIMULATION);
    glider.begin();
    glider.set("ballast_command_m3", 1e-4);
    assert_eq!(glider.step(0.0, 3.0), OK);
    let names = ["depth_m", "speed_m_s", "pitching_moment_N_m", "net_mass_kg", "glide_angle_rad"];
    let references = names.map(vr);
    let mut rates = [f64::NAN; 5];
    // SAFETY: a live component and arrays of five.
    unsafe {
        let orders = [1; 5];
        glider.ok(fmi2GetRealOutputDerivatives(
            glider.component,
            references.as_ptr(),
            5,
            orders.as_ptr(),
            rates.as_mut_ptr(),
        ));
    }
    let h = 1e-3;
    let before = names.map(|name| glider.get(name));
    assert_eq!(glider.step(3.0, h), OK);
    let middle = names.map(|name| glider.get(name));
    assert_eq!(glider.step(3.0 + h, h), OK);
    let after = names.map(|name| glider.get(name));
    for (i, name) in names.iter().enumerate() {
        // One-sided, second order.
        let difference = (4.0 * middle[i] - 3.0 * before[i] - after[i]) / (2.0 * h);
        assert!(
            (rates[i] - difference).abs() < 1e-5 * rates[i].abs().max(1e-3),
            "{name}: {} against {difference}",
            rates[i]
        );
    }
}

fn output_rate(glider: &Glider2, name: &str) -> f64 {
    let (mut rate, order) = (f64::NAN, 1);
    // SAFETY: a live component and single places.
    glider.ok(unsafe { fmi2GetRealOutputDerivatives(glider.component, &vr(name), 1, &order, &mut rate) });
    rate
}

#[test]
fn output_derivatives_know_how_the_inputs_moved_until_they_are_set() {
    let glider = Glider2::new(CO_SIMULATION);
    glider.begin();
    assert_eq!(glider.step(0.0, 2.0), OK);
    // The glide is steady but for the water: what it carries grows by the slope at the end, 0.01 + 0.002 * 5 kg/m3/s.
    let displaced = 50.0 / 1027.0 + glider.get("ballast_m3");
    glider.slope("water_density_kg_m3", 1, 0.01);
    glider.slope("water_density_kg_m3", 2, 0.002);
    assert!((output_rate(&glider, "net_mass_kg") + 0.01 * displaced).abs() < 1e-9);
    assert_eq!(glider.step(2.0, 5.0), OK);
    let expected = -0.02 * displaced;
    let found = output_rate(&glider, "net_mass_kg");
    assert!((found - expected).abs() < 1e-9, "{found} against {expected}");
    // A saved state knows it, too, written out and read back.
    let (mut state, mut again, mut size) = (std::ptr::null_mut(), std::ptr::null_mut(), 0);
    // SAFETY: a live component and a buffer of its size.
    unsafe {
        glider.ok(fmi2GetFMUstate(glider.component, &mut state));
        glider.ok(fmi2SerializedFMUstateSize(glider.component, state, &mut size));
        let mut bytes = vec![0u8; size];
        glider.ok(fmi2SerializeFMUstate(glider.component, state, bytes.as_mut_ptr(), size));
        glider.set("water_density_kg_m3", glider.get("water_density_kg_m3"));
        assert!(output_rate(&glider, "net_mass_kg").abs() < 1e-9);
        glider.ok(fmi2DeSerializeFMUstate(glider.component, bytes.as_ptr(), size, &mut again));
        glider.ok(fmi2SetFMUstate(glider.component, again));
    }
    assert_eq!(output_rate(&glider, "net_mass_kg"), found);
    // In the step that follows the water stands still.
    assert_eq!(glider.step(7.0, 5.0), OK);
    assert!(output_rate(&glider, "net_mass_kg").abs() < 1e-9);
}

#[test]
fn an_input_does_not_move_out_of_its_bounds() {
    let glider = Glider2::new(CO_SIMULATION);
    glider.begin();
    glider.slope("water_density_kg_m3", 1, 100.0);
    let before = glider.get("water_density_kg_m3");
    assert_eq!(glider.step(0.0, 60.0), DISCARD);
    let messages = glider.environment.messages.take();
    assert_eq!(messages.len(), 1, "{messages:?}");
    assert!(
        messages[0].1.contains("water_density_kg_m3 = ") && messages[0].1.contains("900.0 to 1300.0"),
        "{messages:?}"
    );
    assert_eq!(glider.get("water_density_kg_m3"), before);
    // As far as it stays within them it may.
    assert_eq!(glider.step(0.0, 2.0), OK);
    assert_eq!(glider.get("water_density_kg_m3"), before + 200.0);
}

#[test]
fn limits_the_wrong_way_round_are_refused() {
    let glider = Glider3::co_simulation(Options::default());
    glider.set(&[("ballast_max_m3", -6e-4)]);
    // SAFETY: a live instance.
    unsafe {
        glider.ok(fmi3EnterInitializationMode(glider.instance, 0, 0.0, 0.0, 0, 0.0));
        assert_eq!(fmi3ExitInitializationMode(glider.instance), ERROR);
        let messages = glider.environment.messages.take();
        assert!(messages[0].1.contains("ballast_max_m3 = -0.0006 lies below ballast_min_m3 = -0.0005"), "{messages:?}");
        glider.set(&[("ballast_min_m3", -7e-4)]);
        glider.ok(fmi3ExitInitializationMode(glider.instance));
    }
    glider.environment.messages.take();
    let before = glider.states();
    glider.set(&[("moving_mass_min_m", 0.3)]);
    assert_eq!(glider.step(0.0, 1.0).status, DISCARD);
    let messages = glider.environment.messages.take();
    assert!(messages[0].1.contains("moving_mass_max_m = 0.2 lies below moving_mass_min_m = 0.3"), "{messages:?}");
    assert_eq!(glider.states(), before);
    glider.set(&[("moving_mass_max_m", 0.4)]);
    assert_eq!(glider.step(0.0, 1.0).status, OK);
}

#[test]
fn an_input_set_to_what_it_is_changes_nothing() {
    let flights = [false, true].map(|sets| {
        let glider = Glider3::co_simulation(Options::default());
        glider.begin(Some(1e-6));
        turn(&glider);
        let command = glider.get("ballast_command_m3");
        for second in 0..300 {
            if sets {
                glider.set(&[("ballast_command_m3", command)]);
            }
            glider.run(f64::from(second), f64::from(second + 1), 0.25);
        }
        glider.states()
    });
    assert_eq!(flights[0], flights[1]);
}

#[test]
fn whoever_steers_between_two_steps_is_obeyed_at_once() {
    // The library's steps reach further than the communication step; what lies beyond must be forgotten when an input, a
    // parameter or, in event mode, either of them changes.
    let whole_options = Options::default();
    let event_options = Options { event_mode: true, early_return: true, ..Options::default() };
    for (name, value) in [("ballast_command_m3", 1e-4), ("b", 0.2), ("current_x_m_s", 0.3)] {
        let flights = [(0.1, false), (50.0, false), (0.1, true)].map(|(size, events)| {
            let options = if events { event_options } else { whole_options };
            let glider = Glider3::started(options, &[]);
            if events {
                update(&glider);
            }
            glider.run(0.0, 50.0, size);
            if events {
                // SAFETY: a live instance.
                glider.ok(unsafe { fmi3EnterEventMode(glider.instance) });
            }
            glider.set(&[(name, value)]);
            if events {
                update(&glider);
            }
            glider.run(50.0, 100.0, size);
            glider.states()
        });
        for other in &flights[1..] {
            for ((state, found), expected) in STATES.iter().zip(other).zip(&flights[0]) {
                let scale = expected.abs().max(1e-2);
                assert!((found - expected).abs() < 1e-6 * scale, "{name}: {state} {found} against {expected}");
            }
        }
    }
}
