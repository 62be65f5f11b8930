//! What importers do to the FMU beside setting and stepping, each as it was met: the rules that each goes by, written as
//! checks of our own.

mod support;

use std::ffi::c_int;

use glidepolar_fmu::description::files;
use glidepolar_fmu::fmi2::*;
use glidepolar_fmu::fmi3::*;
use glidepolar_fmu::model::{Initial, Model, Slot, variables};
use support::*;

/// The value of an attribute of an element.
fn attribute<'a>(element: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = element.split_once(&format!(" {name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}

fn description(standard: &str) -> String {
    let path = format!("{standard}/modelDescription.xml");
    files().into_iter().find(|(name, _)| name.as_os_str() == path.as_str()).expect("a description").1
}

/// OMSimulator 2 takes a dependency of FMI 3.0 for a place in the list of variables, counted from one, as FMI 2.0 has it. With
/// references from 1 to n in the order of the list both readings are the same.
#[test]
fn a_value_reference_is_the_place_in_the_description() {
    for (standard, element) in [("fmi3", "valueReference"), ("fmi2", "ScalarVariable")] {
        let text = description(standard);
        let (_, rest) = text.split_once("<ModelVariables>").unwrap();
        let (list, structure) = rest.split_once("</ModelVariables>").unwrap();
        let elements: Vec<&str> = list.lines().filter(|line| line.contains(" valueReference=\"")).collect();
        assert_eq!(elements.len(), variables().len(), "{standard} {element}");
        for (place, line) in (1..).zip(&elements) {
            assert_eq!(attribute(line, "valueReference"), Some(place.to_string().as_str()), "{standard}: {line}");
        }
        for number in
            structure.lines().filter_map(|line| attribute(line, "dependencies")).flat_map(str::split_whitespace)
        {
            assert!((1..=elements.len()).contains(&number.parse().unwrap()), "{standard}: dependency {number}");
        }
    }
}

/// CasADi starts a state without a start value at 0.
#[test]
fn every_state_has_a_start_that_is_its_start() {
    let glider = Glider3::model_exchange();
    glider.begin(None);
    for standard in ["fmi2", "fmi3"] {
        let text = description(standard);
        for variable in variables().iter().filter(|v| matches!(v.slot, Slot::State(_))) {
            let (_, rest) = text.split_once(&format!(" name=\"{}\"", variable.name)).unwrap();
            let start: f64 = attribute(rest, "start").unwrap().parse().unwrap();
            assert_eq!(start, glider.get(variable.name), "{standard}: {}", variable.name);
        }
    }
    // An importer may hand over every start that it reads; those that follow from others still follow.
    let other = Glider3::model_exchange();
    let starts: Vec<_> = variables()
        .iter()
        .filter(|v| v.initial == Some(Initial::Approx))
        .map(|v| (v.name, 7.0))
        .chain([("v1_m_s", 0.2)])
        .collect();
    other.set(&starts);
    other.begin(None);
    let momentum = other.get("moving_mass_kg") * 0.2;
    assert!((other.get("PP1_kg_m_s") - momentum).abs() < 1e-12, "{} against {momentum}", other.get("PP1_kg_m_s"));
}

/// PathSim's Model Exchange block sets every input to 0 before anything is connected; others ground inputs for good.
#[test]
fn inputs_that_nothing_feeds_are_water_of_the_reference_density_without_a_seabed() {
    let glider = Glider3::co_simulation(Options::default());
    let grounded = [("water_density_kg_m3", 0.0), ("seabed_depth_m", 0.0), ("current_x_m_s", 0.0)];
    glider.set(&grounded);
    let warnings = glider.environment.messages.take();
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings.iter().all(|(status, text)| *status == WARNING && text.contains("not given")), "{warnings:?}");
    glider.begin(None);
    glider.set(&grounded);
    glider.run(0.0, 100.0, 10.0);
    assert!(glider.environment.messages.take().is_empty(), "once is enough");
    let reference = Glider3::started(Options::default(), &[]);
    reference.run(0.0, 100.0, 10.0);
    assert_eq!(glider.states(), reference.states());
    glider.set(&[("water_density_kg_m3", 1e-8), ("seabed_depth_m", -1e-8)]);
    // Any other density without sense is still refused.
    // SAFETY: a live instance.
    let status = unsafe { fmi3SetFloat64(glider.instance, &vr("water_density_kg_m3"), 1, &1.0, 1) };
    assert_eq!(status, ERROR);

    let glider = Glider2::new(1);
    glider.set("water_density_kg_m3", 0.0);
    glider.begin();
    assert_eq!(glider.step(0.0, 10.0), OK);
    assert_eq!(glider.get("surrounding_density_kg_m3"), 1027.0);
}

/// What is no number is discarded, with or without seeds that ask for it; along no direction nothing changes.
#[test]
fn derivatives_that_are_not_finite_are_discarded() {
    let glider = Glider3::model_exchange();
    glider.begin(None);
    let component = Glider2::new(0);
    component.begin();
    // SAFETY: live instances, places of their own.
    unsafe {
        glider.update_discrete_states();
        glider.ok(fmi3EnterContinuousTimeMode(glider.instance));
        let mut event = std::mem::zeroed();
        component.ok(fmi2NewDiscreteStates(component.component, &mut event));
        component.ok(fmi2EnterContinuousTimeMode(component.component));
        let mut states = [0.0; STATES.len()];
        glider.ok(fmi3GetContinuousStates(glider.instance, states.as_mut_ptr(), STATES.len()));
        states[4] = 1e155;
        glider.ok(fmi3SetContinuousStates(glider.instance, states.as_ptr(), STATES.len()));
        component.ok(fmi2SetContinuousStates(component.component, states.as_ptr(), STATES.len()));

        let (unknown, known) = (vr("drag_N"), vr("v1_m_s"));
        let ask = |seed: f64| -> [(c_int, f64); 3] {
            let mut found = [f64::NAN; 3];
            let forward =
                fmi3GetDirectionalDerivative(glider.instance, &unknown, 1, &known, 1, &seed, 1, &mut found[0], 1);
            let adjoint = fmi3GetAdjointDerivative(glider.instance, &unknown, 1, &known, 1, &seed, 1, &mut found[1], 1);
            let second =
                fmi2GetDirectionalDerivative(component.component, &unknown, 1, &known, 1, &seed, &mut found[2]);
            [(forward, found[0]), (adjoint, found[1]), (second, found[2])]
        };
        for (status, _) in ask(1.0) {
            assert_eq!(status, DISCARD);
        }
        let messages = glider.environment.messages.take();
        assert!(messages.iter().all(|(_, text)| text.contains("out of range")), "{messages:?}");
        for (status, value) in ask(0.0) {
            assert_eq!((status, value), (OK, 0.0));
        }
    }
}

/// The rate with which a servo follows in proportion, 1/s: its band is its largest rate over this.
const SERVO_RATE_1_S: f64 = 1.0;

/// An importer's root finder ends on either side of a zero. Scipy's `solve_ivp` restarts just before it, and would find the
/// same zero for ever if nothing changed there.
#[test]
fn after_an_event_no_indicator_is_near_zero_whatever_side_it_was_found_from() {
    for model in Model::ALL {
        let glider = Glider3::model_exchange_of(model);
        glider.set(&[("seabed_depth_m", 60.0)]);
        glider.begin(None);
        let mut states = vec![0.0; model.n_states()];
        let mut z = vec![0.0; model.n_events()];
        let (n_states, n_events) = (states.len(), z.len());
        // SAFETY: a live instance, places of its own and room for all.
        unsafe {
            glider.update_discrete_states();
            glider.ok(fmi3EnterContinuousTimeMode(glider.instance));
            glider.ok(fmi3GetContinuousStates(glider.instance, states.as_mut_ptr(), n_states));
            for (i, place, there) in [(1, 60.0 + 1e-9, true), (1, 60.0 - 1e-9, false), (0, -1e-9, true)] {
                for side in [-1e-14, 0.0, 1e-14] {
                    states[model.depth()] = place + side;
                    glider.ok(fmi3SetContinuousStates(glider.instance, states.as_ptr(), n_states));
                    glider.ok(fmi3EnterEventMode(glider.instance));
                    glider.update_discrete_states();
                    glider.ok(fmi3EnterContinuousTimeMode(glider.instance));
                    glider.ok(fmi3GetEventIndicators(glider.instance, z.as_mut_ptr(), n_events));
                    assert!(z[i].abs() > 5e-10, "{model:?}: indicator {i} is {} at {place} m", z[i]);
                    assert_eq!(z[i] < 0.0, there, "{model:?}: indicator {i} at {place} m");
                }
            }
            // The corner of a servo: there the set-point is as far away as the servo's band is wide.
            let corner = glider.get("ballast_rate_m3_s") / SERVO_RATE_1_S;
            let ballast = ["ballast_command_m3"].map(|name| glider.get(name))[0];
            for side in [-1e-15, 0.0, 1e-15] {
                glider.set(&[("ballast_command_m3", ballast + corner * (1.0 + 1e-9 + side))]);
                glider.ok(fmi3EnterEventMode(glider.instance));
                glider.update_discrete_states();
                glider.ok(fmi3EnterContinuousTimeMode(glider.instance));
                glider.ok(fmi3GetEventIndicators(glider.instance, z.as_mut_ptr(), n_events));
                let nearest = z[2..].iter().fold(f64::INFINITY, |least, z| least.min(z.abs()));
                assert!(nearest > 5e-10, "{model:?}: {z:?}");
            }
        }
    }
}

/// However senseless the parameters are, a step ends soon, with how far it came: here a pitch moment that drives instead of
/// damping.
#[test]
fn a_step_without_end_is_given_up_soon() {
    let fly = |parameters: &[(&str, f64)], duration_s: f64| {
        let glider = Glider3::started(Options::default(), parameters);
        glider.set(&[("ballast_command_m3", 3e-4), ("moving_mass_command_m", -0.1), ("current_x_m_s", 0.1)]);
        let begun = std::time::Instant::now();
        let stepped = glider.step(0.0, duration_s);
        (glider, stepped, begun.elapsed().as_secs_f64())
    };
    let (_, usual, usual_s) = fly(&[], 1e6);
    assert_eq!(usual.status, OK);
    let (glider, stepped, seconds) = fly(&[("pitch_damping_N_m_s", 1e4)], 1e7);
    assert_eq!(stepped.status, DISCARD);
    assert_eq!((stepped.time, glider.get("time")), (0.0, 0.0));
    let messages = glider.environment.messages.take();
    assert!(messages.iter().any(|(_, text)| text.contains("it came to")), "{messages:?}");
    // Ten times are usual. Before there was a budget for a step it was two hundred times.
    assert!(seconds < 50.0 * usual_s, "{seconds} s, where a flight of 1e6 s takes {usual_s} s");
}

/// Carried to the seabed, whatever the current does, it stays where it came to rest.
#[test]
fn a_hull_on_the_seabed_is_neither_carried_nor_creeps() {
    for current in [0.0, 0.5, -0.5] {
        let starts = [("seabed_depth_m", 60.0), ("current_x_m_s", current), ("current_z_m_s", 0.0)];
        let glider = Glider3::started(Options::default(), &starts);
        glider.run(0.0, 1200.0, 600.0);
        let rested = glider.get("x_m");
        glider.run(1200.0, 9200.0, 1000.0);
        let moved = glider.get("x_m") - rested;
        assert!(moved.abs() < 0.01, "with {current} m/s it moved {moved} m in 8000 s");
        assert!(glider.is("on_seabed"));
        // Made light, it rises again.
        glider.set(&[("ballast_command_m3", 3e-4), ("moving_mass_command_m", -0.03)]);
        glider.run(9200.0, 9500.0, 100.0);
        assert!(glider.get("depth_m") < 40.0, "{}", glider.get("depth_m"));
    }
}

/// However much air it carries, a hull floats: what is above the water displaces nothing.
#[test]
fn no_buoyancy_lifts_a_glider_out_of_the_sea() {
    for (name, value) in [("ballast_offset_kg", -10.0), ("trapped_air_cc", 5000.0), ("hull_mass_kg", 10.0)] {
        let glider = Glider3::started(Options::default(), &[(name, value)]);
        let mut highest = f64::INFINITY;
        for i in 0..850 {
            glider.run(f64::from(i) * 10.0, f64::from(i + 1) * 10.0, 10.0);
            highest = highest.min(glider.get("depth_m"));
        }
        // A leap from the speed of the ascent is ballistic; then it floats.
        assert!(highest > -20.0, "{name} = {value}: {highest} m");
        let depth = glider.get("depth_m");
        assert!(depth < 0.0 && depth > -0.25, "{name} = {value}: floats at {depth} m");
        assert!(glider.get("speed_m_s") < 5e-3, "{name} = {value}: {} m/s", glider.get("speed_m_s"));
    }
    // What no hull can carry is refused, and what weighs nothing does not fly away with OK.
    let glider = Glider3::co_simulation(Options::default());
    // SAFETY: a live instance.
    let status = unsafe { fmi3SetFloat64(glider.instance, &vr("trapped_air_cc"), 1, &60_000.0, 1) };
    assert_eq!(status, ERROR);
    let glider = Glider3::started(Options::default(), &[("leak_kg_per_hour", -10.0)]);
    assert_eq!(glider.step(0.0, 1e5).status, DISCARD);
}

/// With other masses and another polar the run begins on the glide of the vehicle as it was set.
#[test]
fn a_start_in_trim_is_steady() {
    let changed =
        [("hull_mass_kg", 40.2), ("b", 0.2), ("moving_mass_height_m", 0.03), ("depth_m", 25.0), ("energy_J", 7.0)];
    let drift = |in_trim: i32| {
        let glider = Glider3::co_simulation(Options::default());
        glider.set(&changed);
        // SAFETY: a live instance, one value.
        glider.ok(unsafe { fmi3SetInt32(glider.instance, &vr("start_in_trim"), 1, &in_trim, 1) });
        glider.begin(None);
        assert_eq!((glider.get("depth_m"), glider.get("energy_J")), (25.0, 7.0));
        let said = glider.environment.messages.take();
        assert!(
            said.iter().all(|(_, text)| !text.contains("lies beyond")),
            "a start in trim passes no limit: {said:?}"
        );
        let before = ["pitch_rad", "v1_m_s", "v3_m_s", "moving_mass_position_m"].map(|name| glider.get(name));
        glider.run(0.0, 100.0, 50.0);
        let after = ["pitch_rad", "v1_m_s", "v3_m_s", "moving_mass_position_m"].map(|name| glider.get(name));
        before.iter().zip(after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    // Nothing glides that cannot be made heavy or light enough: no other start is taken in silence.
    let glider = Glider3::co_simulation(Options::default());
    glider.set(&[("hull_mass_kg", 45.0)]);
    // SAFETY: a live instance, one value.
    unsafe {
        glider.ok(fmi3SetInt32(glider.instance, &vr("start_in_trim"), 1, &1, 1));
        glider.ok(fmi3EnterInitializationMode(glider.instance, 0, 0.0, 0.0, 0, 0.0));
        assert_eq!(fmi3ExitInitializationMode(glider.instance), ERROR);
    }
    assert!(glider.environment.messages.take().iter().any(|(_, text)| text.contains("no steady glide")));
    assert!(drift(1) < 1e-6, "{}", drift(1));
    assert!(drift(0) > 1e-2, "{}", drift(0));
}

/// The same through FMI 2.0: the glide is that of the parameters that were set before the initialisation, in either order with
/// the choice.
#[test]
fn a_start_in_trim_is_steady_in_fmi_2() {
    let drift = |in_trim: c_int, choice_first: bool| {
        let glider = Glider2::new(1);
        let choose = || {
            // SAFETY: a live component, one value.
            glider.ok(unsafe { fmi2SetInteger(glider.component, &vr("start_in_trim"), 1, &in_trim) });
        };
        if choice_first {
            choose();
        }
        for (name, value) in [("hull_mass_kg", 40.2), ("b", 0.2), ("moving_mass_height_m", 0.03), ("depth_m", 25.0)] {
            glider.set(name, value);
        }
        if !choice_first {
            choose();
        }
        glider.begin();
        assert_eq!(glider.get("depth_m"), 25.0);
        let names = ["pitch_rad", "speed_m_s", "v1_m_s", "v3_m_s", "moving_mass_position_m"];
        let before = names.map(|name| glider.get(name));
        for i in 0..10 {
            assert_eq!(glider.step(f64::from(i) * 10.0, 10.0), OK);
        }
        let after = names.map(|name| glider.get(name));
        before.iter().zip(after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    for choice_first in [true, false] {
        assert!(drift(1, choice_first) < 1e-6, "{}", drift(1, choice_first));
        assert!(drift(0, choice_first) > 1e-2, "{}", drift(0, choice_first));
    }
}

/// FMI 3.0 sets an enumeration by `fmi3SetInt64`, FMI 2.0 by `fmi2SetInteger`.
#[test]
fn choices_are_enumerations() {
    let glider = Glider3::co_simulation(Options::default());
    let mut number = 9_i64;
    // SAFETY: a live instance, one value each.
    unsafe {
        glider.ok(fmi3SetInt64(glider.instance, &vr("actuation"), 1, &2, 1));
        glider.ok(fmi3GetInt64(glider.instance, &vr("actuation"), 1, &mut number, 1));
        assert_eq!(number, 2);
        assert_eq!(fmi3SetInt64(glider.instance, &vr("actuation"), 1, &(1 << 40), 1), ERROR);
    }
    for standard in ["fmi2", "fmi3"] {
        let text = description(standard);
        for needed in ["ActuationKind", "WaterSourceKind", "generationDateAndTime", "author", "copyright"] {
            assert!(text.contains(needed), "{standard}: {needed}");
        }
    }
}

/// The hotel load over the time, and the pump against the pressure: by hand from the vehicle's figures.
#[test]
fn the_shipped_vehicle_draws_energy() {
    let glider = Glider3::started(Options::default(), &[]);
    glider.run(0.0, 600.0, 100.0);
    let hotel = glider.get("hotel_W");
    // Nothing is pumped on the way down.
    assert!(hotel > 0.0 && (glider.get("energy_J") - 600.0 * hotel).abs() < 1e-6, "{} J", glider.get("energy_J"));
    assert!((glider.get("power_W") - hotel).abs() < 1e-9, "{}", glider.get("power_W"));
    let pressure = |glider: &Glider3| 1027.0 * 9.81 * glider.get("depth_m");
    let (volume, before) = (glider.get("ballast_m3"), pressure(&glider));
    glider.set(&[("ballast_command_m3", 1e-4), ("moving_mass_command_m", -0.02)]);
    glider.run(600.0, 640.0, 10.0);
    let pumped = glider.get("ballast_m3") - volume;
    let pump = glider.get("energy_J") - 640.0 * hotel;
    let mean = 0.5 * (before + pressure(&glider));
    let expected = glider.get("pump_J_per_Pa_m3") * mean * pumped;
    assert!((pump / expected - 1.0).abs() < 0.05, "{pump} J against {expected} J");
}
