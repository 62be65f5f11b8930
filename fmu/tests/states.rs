//! Saved states: a run that is saved, restored and continued equals the uninterrupted one, bit for bit.

mod support;

use std::ptr::null_mut;

use glidepolar_fmu::fmi2::*;
use glidepolar_fmu::fmi3::*;
use glidepolar_fmu::model::{Kind, variables};
use support::*;

/// A run with something going on: commands, a tuned parameter, an event and a discontinuity lie ahead.
fn busy() -> Glider3 {
    busy_at(None)
}

/// The same at a tolerance, which chooses the method.
fn busy_at(tolerance: Option<f64>) -> Glider3 {
    let starts = [
        ("drag_step", 0.3),
        ("step_time_s", 70.0),
        ("net_mass_step_kg", 0.02),
        ("net_mass_step_time_s", 22.5),
        ("seabed_depth_m", 25.0),
        ("leak_kg_per_hour", 0.1),
    ];
    let glider = Glider3::co_simulation(Options::default());
    glider.set(&starts);
    glider.begin(tolerance);
    glider.run(0.0, 20.0, 1.0);
    glider.set(&[("moving_mass_command_m", 0.01), ("b", 0.13)]);
    glider.run(20.0, 23.0, 1.0);
    glider
}

fn go_on(glider: &Glider3) -> Vec<u64> {
    glider.run(23.0, 60.0, 1.0);
    glider.set(&[("ballast_command_m3", 1e-4)]);
    glider.run(60.0, 200.0, 4.0);
    everything(glider)
}

/// The bits of every number there is.
fn everything(glider: &Glider3) -> Vec<u64> {
    let reals = variables().iter().filter(|variable| variable.kind == Kind::Real);
    reals.map(|variable| glider.get(variable.name).to_bits()).collect()
}

#[test]
fn a_restored_run_goes_on_bit_for_bit() {
    for tolerance in [None, Some(1e-6)] {
        restore_and_go_on(tolerance);
    }
}

fn restore_and_go_on(tolerance: Option<f64>) {
    let glider = busy_at(tolerance);
    let saved = glider.save();
    let at_saving = everything(&glider);
    let first = go_on(&glider);
    assert_ne!(at_saving, first);
    glider.restore(saved);
    assert_eq!(everything(&glider), at_saving);
    assert_eq!(go_on(&glider), first);
    // The saved state is still what it was, and saving did not disturb the run.
    glider.restore(saved);
    assert_eq!(go_on(&glider), first);
    assert_eq!(go_on(&busy_at(tolerance)), first);
}

#[test]
fn bytes_carry_a_run_to_another_instance() {
    let glider = busy();
    let saved = glider.save();
    let bytes = glider.serialize(saved);
    let expected = go_on(&glider);

    let other = Glider3::co_simulation(Options::default());
    let state = other.deserialize(&bytes).unwrap();
    other.restore(state);
    assert_eq!(go_on(&other), expected);
    assert_eq!(other.serialize(state), bytes);
}

#[test]
fn the_phase_is_part_of_the_state() {
    let glider = Glider3::co_simulation(Options::default());
    let fresh = glider.save();
    glider.begin(None);
    glider.run(0.0, 5.0, 1.0);
    glider.restore(fresh);
    assert_eq!(glider.step(5.0, 1.0).status, ERROR);
    glider.begin(None);
    assert_eq!(glider.step(0.0, 1.0).status, OK);
}

#[test]
fn a_handle_can_be_used_again_and_freed_once() {
    let glider = busy();
    let mut state = glider.save();
    let first = state;
    glider.run(23.0, 30.0, 1.0);
    let later = everything(&glider);
    // SAFETY: a live instance and its own state.
    unsafe {
        glider.ok(fmi3GetFMUState(glider.instance, &mut state));
        assert_eq!(state, first);
        glider.run(30.0, 31.0, 1.0);
        glider.restore(state);
        assert_eq!(everything(&glider), later);
        glider.ok(fmi3FreeFMUState(glider.instance, &mut state));
        assert!(state.is_null());
        glider.ok(fmi3FreeFMUState(glider.instance, &mut state));
        glider.ok(fmi3FreeFMUState(glider.instance, null_mut()));
        // What was freed, what is another instance's and what was never a state: all refused.
        let other = busy();
        let foreign = other.save();
        for mut wrong in [first, foreign, null_mut(), 0x1234 as FmuState3] {
            assert_eq!(fmi3SetFMUState(glider.instance, wrong), ERROR);
            let mut size = 0;
            assert_eq!(fmi3SerializedFMUStateSize(glider.instance, wrong, &mut size), ERROR);
            if !wrong.is_null() {
                assert_eq!(fmi3FreeFMUState(glider.instance, &mut wrong), ERROR);
                assert_eq!(fmi3GetFMUState(glider.instance, &mut wrong), ERROR);
            }
        }
        assert_eq!(everything(&glider), later);
    }
}

#[test]
fn bytes_that_are_no_state_are_refused_whole() {
    let glider = busy();
    let bytes = glider.serialize(glider.save());
    let before = everything(&glider);
    let refused = |bytes: &[u8], why: &str| {
        let messages = glider.deserialize(bytes).expect_err(why);
        assert_eq!(messages.len(), 1);
        assert!(messages[0].1.contains(why), "{messages:?}");
    };
    refused(&[], "too few");
    refused(b"hello", "too few");
    for length in [20, 60, bytes.len() - 1] {
        let why = if length < 63 { "too few" } else { "checksum" };
        refused(&bytes[..length], why);
    }
    refused(&[bytes.as_slice(), b"x"].concat(), "checksum");
    refused(&vec![0; bytes.len()], "do not begin");
    for place in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[place] ^= 0x40;
        glider.deserialize(&changed).expect_err("a changed byte");
    }
    glider.environment.messages.take();
    // A state of the other interface, whole and sound.
    let exchange = Glider3::model_exchange();
    exchange.begin(None);
    refused(&exchange.serialize(exchange.save()), "another version of this FMU");
    assert_eq!(everything(&glider), before);
}

#[test]
fn room_of_the_wrong_size_is_refused() {
    let glider = busy();
    let state = glider.save();
    let mut room = vec![0; 10_000];
    let needed = glider.serialize(state).len();
    for size in [0, needed - 1, needed + 1] {
        // SAFETY: the room is larger.
        assert_eq!(unsafe { fmi3SerializeFMUState(glider.instance, state, room.as_mut_ptr(), size) }, ERROR);
    }
    assert!(room.iter().all(|byte| *byte == 0));
}

#[test]
fn fmi_2_saves_and_restores_too() {
    let glider = Glider2::new(CO_SIMULATION);
    glider.begin();
    assert_eq!(glider.step(0.0, 1.0), OK);
    glider.slope("current_x_m_s", 1, 0.1);
    let mut state = null_mut();
    // SAFETY: a live component.
    unsafe {
        glider.ok(fmi2GetFMUstate(glider.component, &mut state));
        assert_eq!(glider.step(1.0, 2.0), OK);
        let expected = glider.get("x_m").to_bits();
        glider.ok(fmi2SetFMUstate(glider.component, state));
        assert_eq!(glider.step(1.0, 2.0), OK);
        assert_eq!(glider.get("x_m").to_bits(), expected);
        let mut size = 0;
        glider.ok(fmi2SerializedFMUstateSize(glider.component, state, &mut size));
        let mut bytes = vec![0u8; size];
        glider.ok(fmi2SerializeFMUstate(glider.component, state, bytes.as_mut_ptr(), size));
        let mut again = null_mut();
        glider.ok(fmi2DeSerializeFMUstate(glider.component, bytes.as_ptr(), size, &mut again));
        glider.ok(fmi2SetFMUstate(glider.component, again));
        assert_eq!(glider.step(1.0, 2.0), OK);
        assert_eq!(glider.get("x_m").to_bits(), expected);
        glider.ok(fmi2FreeFMUstate(glider.component, &mut state));
        glider.ok(fmi2FreeFMUstate(glider.component, &mut again));
    }
}

#[test]
fn a_state_saved_between_the_library_s_own_steps_goes_on_bit_for_bit() {
    // On the straight leg those are of a minute: every quarter of a second lies inside one.
    let glider = Glider3::co_simulation(Options::default());
    glider.begin(Some(1e-6));
    glider.run(0.0, 100.0, 0.25);
    let saved = glider.save();
    let bytes = glider.serialize(saved);
    let go_on = |glider: &Glider3| {
        glider.run(100.0, 130.0, 0.25);
        let inside = everything(glider);
        glider.set(&[("ballast_command_m3", 1e-4)]);
        glider.run(130.0, 150.0, 0.25);
        [inside, everything(glider)]
    };
    let expected = go_on(&glider);
    glider.restore(saved);
    assert_eq!(go_on(&glider), expected);
    let other = Glider3::co_simulation(Options::default());
    other.restore(other.deserialize(&bytes).unwrap());
    assert_eq!(go_on(&other), expected);
    // Looking at it once more, at other times, is the same flight.
    glider.restore(saved);
    glider.run(100.0, 130.0, 30.0);
    assert_eq!(everything(&glider), expected[0]);
}
