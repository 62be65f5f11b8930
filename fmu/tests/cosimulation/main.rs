//! Communication steps: against the library's own run, whatever the step; events; what comes and goes inside a step.

mod inputs;
#[path = "../support/mod.rs"]
mod support;

use std::cell::RefCell;
use std::rc::Rc;

use glidepolar_dynamics::glide::start;
use glidepolar_dynamics::{Actuation, Glider, Integrator};
use glidepolar_fmu::fmi2::*;
use glidepolar_fmu::fmi3::*;
use glidepolar_fmu::model::Model;
use glidepolar_fmu::model::vehicle::Vehicle;
use support::*;

/// A dive and a climb, the commands changed at 400 s, by the library alone at a tight tolerance.
fn reference() -> Vec<f64> {
    let parameters = Vehicle::default().glider.parameters();
    let start = start(&parameters);
    let mut glider = Glider::new(parameters, Actuation::Servo, start.inputs);
    let (mut time, mut state, mut integrator) = (0.0, start.state, Integrator::new(1e-12));
    glider.fly(&mut integrator, &mut time, &mut state, 400.0, |_, _, _| true).unwrap();
    glider.inputs.ballast_command_m3 *= -1.0;
    glider.inputs.moving_mass_command_m *= -1.0;
    glider.fly(&mut integrator, &mut time, &mut state, 700.0, |_, _, _| true).unwrap();
    state.as_array().to_vec()
}

fn turn(glider: &Glider3) {
    let commands = ["ballast_command_m3", "moving_mass_command_m"].map(|name| (name, -glider.get(name)));
    glider.set(&commands);
}

#[test]
fn the_library_s_own_run_comes_out_whatever_the_communication_step() {
    let reference = reference();
    for (size, tolerance) in
        [(100.0, None), (10.0, None), (1.0, None), (0.5, None), (100.0, Some(1e-7)), (1.0, Some(1e-7))]
    {
        let glider = Glider3::co_simulation(Options::default());
        glider.begin(tolerance);
        glider.run(0.0, 400.0, size);
        turn(&glider);
        glider.run(400.0, 700.0, size);
        for ((name, found), expected) in STATES.iter().zip(glider.states()).zip(&reference) {
            let scale = expected.abs().max(1e-2);
            assert!((found - expected).abs() < 1e-6 * scale, "{name} {found} against {expected}, step {size} s");
        }
    }
}

#[test]
fn the_tolerance_that_is_asked_for_is_used() {
    let reference = reference();
    let error = |tolerance| {
        let glider = Glider3::co_simulation(Options::default());
        glider.begin(Some(tolerance));
        glider.run(0.0, 400.0, 100.0);
        turn(&glider);
        glider.run(400.0, 700.0, 100.0);
        (glider.get("depth_m") - reference[1]).abs()
    };
    let (loose, tight) = (error(1e-3), error(1e-10));
    assert!(tight < 1e-8, "{tight}");
    assert!(tight < 0.1 * loose && loose < 0.1, "{tight} and {loose}");
}

#[test]
fn the_seabed_is_met_inside_a_step() {
    let steady = Glider3::started(Options::default(), &[]);
    let sink = steady.get("vertical_velocity_m_s");
    let met_at = 50.0 / sink;
    let options = Options { event_mode: true, early_return: true, ..Options::default() };
    let glider = Glider3::started(options, &[("seabed_depth_m", 60.0)]);
    // With event mode the simulation begins at an event.
    update(&glider);
    let stepped = glider.step(0.0, 1000.0);
    assert_eq!((stepped.status, stepped.event, stepped.early), (OK, true, true));
    assert!((stepped.time - met_at).abs() < 1e-6, "{} against {met_at}", stepped.time);
    assert!(!glider.is("on_seabed"));
    // SAFETY: a live instance.
    glider.ok(unsafe { fmi3EnterEventMode(glider.instance) });
    update(&glider);
    assert!(glider.is("on_seabed"));
    // It slides on and comes to rest, carried where 3 B (x/D)^2 is its net weight.
    let mut time = stepped.time;
    while time < 2000.0 {
        let stepped = glider.step(time, 2000.0 - time);
        assert_eq!((stepped.status, stepped.event), (OK, stepped.early));
        time = stepped.time;
        if stepped.event {
            // SAFETY: a live instance.
            glider.ok(unsafe { fmi3EnterEventMode(glider.instance) });
            update(&glider);
        }
    }
    let depth = glider.get("depth_m");
    let diameter = (glider.get("frontal_area_m2") * 4.0 / std::f64::consts::PI).sqrt();
    let displaced = 50.0 - glider.get("net_mass_kg");
    let carried = 60.0 + diameter * (glider.get("net_mass_kg") / (3.0 * displaced)).sqrt();
    assert!((depth - carried).abs() < 1e-5, "{depth} against {carried}");
    assert!((glider.get("speed_m_s")) < 1e-6, "{}", glider.get("speed_m_s"));

    // Without event mode the step goes over it, and ends in the same place.
    let through = Glider3::started(Options::default(), &[("seabed_depth_m", 60.0)]);
    let whole = through.step(0.0, 2000.0);
    assert_eq!((whole.status, whole.event, whole.early, whole.time), (OK, false, false, 2000.0));
    assert!(through.is("on_seabed"));
    assert!((through.get("depth_m") - depth).abs() < 1e-6, "{} and {depth}", through.get("depth_m"));
}

fn update(glider: &Glider3) -> (bool, Option<f64>) {
    let found = glider.update_discrete_states();
    // SAFETY: a live instance.
    glider.ok(unsafe { fmi3EnterStepMode(glider.instance) });
    assert_eq!(found.flags, [0, 0, 0]);
    (found.values == 1, found.next_s)
}

/// Nothing else draws: afloat at the start is no surfacing, bobbing is none, and each coming up is one.
#[test]
fn a_surfacing_is_paid_once() {
    for model in [Model::Plane, Model::Space] {
        for (start_m, before) in [(-0.01, 0.0), (5.0, 500.0)] {
            let glider = Glider3::of(model, Options::default());
            glider.set(&[("surfacing_J", 500.0), ("hotel_W", 0.0), ("pump_J_per_m3", 0.0), ("pump_J_per_Pa_m3", 0.0)]);
            glider.set(&[("depth_m", start_m), ("ballast_command_m3", 3e-4), ("moving_mass_command_m", -0.02)]);
            glider.begin(None);
            assert_eq!(glider.get("energy_J"), 0.0);
            glider.set(&[("ballast_command_m3", 3e-4), ("moving_mass_command_m", -0.02)]);
            glider.run(0.0, 1000.0, 50.0);
            // Begun afloat in a glide down, it dips first and surfaces once for it; begun below, it comes up once.
            let first = glider.get("energy_J");
            assert!(glider.is("at_surface") && first >= before && first <= 500.0, "{model:?} {first}");
            glider.run(1000.0, 2000.0, 50.0);
            assert_eq!(glider.get("energy_J"), first, "bobbing is no surfacing");
            glider.set(&[("ballast_command_m3", -3e-4), ("moving_mass_command_m", 0.02)]);
            glider.run(2000.0, 2300.0, 50.0);
            assert!(glider.get("depth_m") > 1.0);
            glider.set(&[("ballast_command_m3", 3e-4), ("moving_mass_command_m", -0.02)]);
            glider.run(2300.0, 4000.0, 50.0);
            assert!(glider.is("at_surface"));
            assert_eq!(glider.get("energy_J"), first + 500.0);
        }
    }
}

#[test]
fn a_glider_made_light_comes_up_and_stays_afloat() {
    let glider = Glider3::started(Options::default(), &[]);
    glider.set(&[("ballast_command_m3", 3e-4), ("moving_mass_command_m", -0.02)]);
    assert!(!glider.is("at_surface"));
    glider.run(0.0, 1000.0, 50.0);
    assert!(glider.is("at_surface"));
    let depth = glider.get("depth_m");
    assert!((-0.1..0.0).contains(&depth), "{depth}");
    assert!(glider.get("vertical_velocity_m_s").abs() < 1e-3);
}

#[test]
fn the_importer_looks_in_and_may_end_the_step() {
    let options = Options { early_return: true, look_in: true, ..Options::default() };
    let mut glider = Glider3::started(options, &[]);
    let seen = Rc::new(RefCell::new(Vec::new()));
    let times = seen.clone();
    glider.environment.look_in = Some(Box::new(move |instance, time, can_return| {
        times.borrow_mut().push((time, get_3(instance, "depth_m")));
        (can_return && time > 3.0).then_some(time + 0.75)
    }));
    let stepped = glider.step(0.0, 10.0);
    let seen = seen.borrow();
    let wanted = seen.iter().find(|(time, _)| *time > 3.0).unwrap().0 + 0.75;
    assert_eq!((stepped.status, stepped.event, stepped.early), (OK, false, true));
    assert!(stepped.time >= wanted && stepped.time < 10.0, "{} against {wanted}", stepped.time);
    assert!(seen.len() > 2 && seen.windows(2).all(|pair| pair[0].0 < pair[1].0), "{seen:?}");
    let sink = glider.get("vertical_velocity_m_s");
    for (time, depth) in seen.iter() {
        assert!((depth - 10.0 - sink * time).abs() < 1e-9, "{depth} at {time}");
    }
}

#[test]
fn the_state_of_the_instance_cannot_be_changed_from_inside_a_step() {
    let options = Options { look_in: true, ..Options::default() };
    let mut glider = Glider3::started(options, &[]);
    let saved = glider.save() as usize;
    glider.environment.look_in = Some(Box::new(move |instance, _, _| {
        // SAFETY: a live instance inside its step.
        unsafe {
            assert_eq!(fmi3Terminate(instance), ERROR);
            assert_eq!(fmi3Reset(instance), ERROR);
            assert_eq!(fmi3EnterEventMode(instance), ERROR);
            let (mut a, mut b, mut c, mut t) = (0, 0, 0, 0.0);
            assert_eq!(fmi3DoStep(instance, 0.0, 1.0, 1, &mut a, &mut b, &mut c, &mut t), ERROR);
            assert_eq!(fmi3SetFMUState(instance, saved as FmuState3), ERROR);
            let mut state = std::ptr::null_mut();
            assert_eq!(fmi3GetFMUState(instance, &mut state), ERROR);
            fmi3FreeInstance(instance);
        }
        None
    }));
    let stepped = glider.step(0.0, 1.0);
    assert_eq!((stepped.status, stepped.time), (OK, 1.0));
    let messages = glider.environment.messages.take();
    assert!(messages.len().is_multiple_of(7) && messages.iter().all(|(status, _)| *status == ERROR), "{messages:?}");
    glider.environment.look_in = None;
    assert_eq!(glider.step(1.0, 1.0).status, OK);
}

#[test]
fn a_step_that_makes_no_sense_is_refused_and_changes_nothing() {
    let glider = Glider3::started(Options::default(), &[]);
    glider.run(0.0, 10.0, 1.0);
    let before = glider.states();
    for (from, size) in [
        (10.0, 0.0),
        (10.0, -1.0),
        (10.0, f64::NAN),
        (10.0, f64::INFINITY),
        (9.0, 1.0),
        (f64::NAN, 1.0),
        (11.0, 1.0),
        (10.0, 1e-300),
    ] {
        let stepped = glider.step(from, size);
        assert_eq!((stepped.status, stepped.time), (ERROR, 10.0), "{from} + {size}");
        let messages = glider.environment.messages.take();
        assert_eq!(messages.len(), 1, "{messages:?}");
        assert!(messages[0].1.starts_with("fmi3DoStep: the "), "{messages:?}");
    }
    assert_eq!(glider.states(), before);
    assert_eq!(glider.step(10.0, 1.0).status, OK);
}

#[test]
fn a_step_that_cannot_be_done_is_discarded_and_changes_nothing() {
    // Damping of the wrong sign, that grows with the square of the rate: infinite after a finite time.
    let glider = Glider2::new(CO_SIMULATION);
    glider.set("pitch_damping_quadratic_N_m_s2", 1e6);
    glider.begin();
    glider.set("moving_mass_command_m", 0.1);
    let before = glider.get("depth_m");
    assert_eq!(glider.step(0.0, 1000.0), DISCARD);
    let messages = glider.environment.messages.take();
    assert_eq!(messages.len(), 1, "{messages:?}");
    assert_eq!(glider.get("depth_m").to_bits(), before.to_bits());
    let (mut time, mut terminated, mut status) = (f64::NAN, 9, 9);
    // SAFETY: a live component.
    unsafe {
        glider.ok(fmi2GetRealStatus(glider.component, 2, &mut time));
        glider.ok(fmi2GetBooleanStatus(glider.component, 3, &mut terminated));
        glider.ok(fmi2GetStatus(glider.component, 0, &mut status));
    }
    assert_eq!((time, terminated, status), (0.0, 0, DISCARD));
}

#[test]
fn fast_modes_do_not_hold_a_step_up() {
    // Next to no inertia: modes of microseconds, through which the glider must come in a moment all the same.
    let glider = Glider2::new(CO_SIMULATION);
    glider.set("pitch_inertia_kg_m2", 1e-6);
    glider.set("moving_mass_kg", 1e-3);
    glider.set("a_per_rad", 1000.0);
    // SAFETY: a live component.
    unsafe {
        glider.ok(fmi2SetupExperiment(glider.component, 1, 1e-6, 0.0, 0, 0.0));
        glider.ok(fmi2EnterInitializationMode(glider.component));
        glider.ok(fmi2ExitInitializationMode(glider.component));
    }
    glider.set("moving_mass_command_m", 0.1);
    assert_eq!(glider.step(0.0, 1000.0), OK);
    assert!(glider.get("depth_m").is_finite());
}

#[test]
fn the_stop_time_is_the_end() {
    let glider = Glider3::co_simulation(Options::default());
    // SAFETY: a live instance.
    unsafe {
        glider.ok(fmi3EnterInitializationMode(glider.instance, 0, 0.0, 5.0, 1, 10.0));
        glider.ok(fmi3ExitInitializationMode(glider.instance));
    }
    assert_eq!(glider.step(5.0, 5.0).status, OK);
    assert_eq!(glider.step(10.0, 1.0).status, ERROR);
}

#[test]
fn after_a_reset_nothing_of_the_last_run_is_left() {
    let glider = Glider3::started(Options::default(), &[("hull_mass_kg", 40.1), ("v1_m_s", 0.2)]);
    glider.run(0.0, 10.0, 1.0);
    // SAFETY: a live instance.
    glider.ok(unsafe { fmi3Reset(glider.instance) });
    glider.begin(None);
    glider.run(0.0, 10.0, 1.0);
    let fresh = Glider3::started(Options::default(), &[]);
    fresh.run(0.0, 10.0, 1.0);
    assert_eq!(glider.states(), fresh.states());
    assert_eq!(glider.get("hull_mass_kg"), 40.0);
}

#[test]
fn many_instances_in_many_threads_do_not_know_of_each_other() {
    let alone = |i: usize| {
        let glider = Glider3::started(Options::default(), &[("ballast_offset_kg", 1e-3 * i as f64)]);
        glider.run(0.0, 50.0, 1.0);
        glider.states()
    };
    let expected: Vec<Vec<f64>> = (0..8).map(alone).collect();
    std::thread::scope(|scope| {
        for (i, expected) in expected.iter().enumerate() {
            scope.spawn(move || {
                for _ in 0..10 {
                    assert_eq!(&alone(i), expected);
                }
            });
        }
    });
}
