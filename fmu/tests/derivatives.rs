//! Partial derivatives against differences, for every pair of known and unknown that the model structure declares, and
//! the adjoint ones against the forward ones.

mod support;

use glidepolar_fmu::description::structure::{Unknown, structure};
use glidepolar_fmu::fmi2::*;
use glidepolar_fmu::fmi3::*;
use glidepolar_fmu::model::{Causality, Kind, Model, Slot, variable};
use support::*;

/// Somewhere away from every special value, in free water, the servos within their rates, every mechanism at work.
const SOMEWHERE: [(&str, f64); 52] = [
    ("ballast_command_m3", -4.0e-5),
    ("moving_mass_command_m", 0.021),
    // Pumping out, which costs energy: at rest the power has a corner.
    ("u4_kg_s", -0.013),
    ("water_density_kg_m3", 1025.3),
    ("water_temperature_C", 9.0),
    ("current_x_m_s", 0.1),
    ("current_z_m_s", 0.02),
    ("roll_rad", 0.1),
    ("rudder_rad", 0.2),
    ("pitch_rate_rad_s", 0.013),
    ("v3_m_s", 0.02),
    ("hull_compressibility_per_Pa", 4e-10),
    ("hull_thermal_expansion_per_K", 5e-5),
    ("trapped_air_cc", 30.0),
    ("leak_kg_per_hour", 0.3),
    ("drag_growth_per_day", 0.4),
    ("drag_exponent", -0.1),
    ("nonlinear_lift_per_rad2", 3.0),
    ("roll_drag_per_rad2", 0.7),
    ("rudder_drag_per_rad2", 0.8),
    ("offset_mass_kg", 1.0),
    ("offset_mass_forward_m", 0.01),
    ("ballast_forward_m", 0.02),
    ("hotel_W", 1.5),
    ("rudder_W", 0.2),
    ("pitch_move_J", 30.0),
    ("pump_J_per_Pa_m3", 2.0),
    ("pitch_damping_CMq", -0.4),
    ("pump_J_per_m3", 1e6),
    ("current_x_shear_1_s", 0.012),
    ("current_x_rate_m_s2", 2e-3),
    ("current_z_rate_m_s2", -1e-3),
    ("climb_dive_lift_ratio", 1.1),
    ("hull_creep_per_Pa", 3e-10),
    ("creep_time_s", 3600.0),
    ("creep_pressure_Pa", 4e4),
    ("carried_water_m3", 0.012),
    ("exchange_time_s", 900.0),
    ("carried_density_kg_m3", -0.7),
    ("late_expansion_per_K", 4e-5),
    ("expansion_time_s", 700.0),
    ("late_temperature_K", 3.0),
    ("pump_leakback_cc_per_hour", 25.0),
    ("leaked_back_m3", 3e-6),
    // Drag against pressure.
    ("empirical_acts_on", 1.0),
    ("empirical_at_2", 110.0),
    ("empirical_at_3", 220.0),
    ("empirical_at_4", 330.0),
    ("empirical_at_5", 440.0),
    ("empirical_value_1", 0.2),
    ("empirical_value_2", -0.1),
    ("empirical_value_3", 0.15),
];

fn forward(glider: &Glider3, unknowns: &[u32], knowns: &[u32], seed: &[f64]) -> Vec<f64> {
    let mut sensitivity = vec![f64::NAN; unknowns.len()];
    // SAFETY: a live instance and arrays of these lengths.
    glider.ok(unsafe {
        fmi3GetDirectionalDerivative(
            glider.instance,
            unknowns.as_ptr(),
            unknowns.len(),
            knowns.as_ptr(),
            knowns.len(),
            seed.as_ptr(),
            seed.len(),
            sensitivity.as_mut_ptr(),
            sensitivity.len(),
        )
    });
    sensitivity
}

fn adjoint(glider: &Glider3, unknowns: &[u32], knowns: &[u32], seed: &[f64]) -> Vec<f64> {
    let mut sensitivity = vec![f64::NAN; knowns.len()];
    // SAFETY: as above.
    glider.ok(unsafe {
        fmi3GetAdjointDerivative(
            glider.instance,
            unknowns.as_ptr(),
            unknowns.len(),
            knowns.as_ptr(),
            knowns.len(),
            seed.as_ptr(),
            seed.len(),
            sensitivity.as_mut_ptr(),
            sensitivity.len(),
        )
    });
    sensitivity
}

fn value(glider: &Glider3, reference: u32) -> f64 {
    glider.get(variable(reference).unwrap().name)
}

/// A small change of a variable.
fn step_of(reference: u32, value: f64) -> f64 {
    let row = variable(reference).unwrap();
    let size = match (row.causality, row.bounds) {
        (Causality::Parameter, _) if value != 0.0 => value.abs(),
        (Causality::Parameter, Some((_, max))) => max.min(1.0),
        _ => row.nominal.unwrap_or(1.0).max(value.abs()),
    };
    1e-5 * size
}

/// Every pair against central differences; `put` moves a known.
fn check_all(glider: &Glider3, unknowns: &[Unknown], put: impl Fn(&Glider3, u32, f64)) -> usize {
    let mut pairs = 0;
    for unknown in unknowns {
        for &known in &unknown.dependencies {
            let row = variable(known).unwrap();
            if row.kind != Kind::Real || row.name.ends_with("step_time_s") {
                continue; // switches: nothing to differentiate by
            }
            let exact = forward(glider, &[unknown.reference], &[known], &[1.0])[0];
            let here = value(glider, known);
            let difference = |h: f64| {
                put(glider, known, here + h);
                let above = value(glider, unknown.reference);
                put(glider, known, here - h);
                let below = value(glider, unknown.reference);
                put(glider, known, here);
                (above - below) / (2.0 * h)
            };
            let h = step_of(known, here);
            // Richardson: the error of fourth order.
            let numeric = (4.0 * difference(h) - difference(2.0 * h)) / 3.0;
            let size = value(glider, unknown.reference).abs().max(1e-3);
            // Rounding of the value over the step, beside a relative error.
            let allowed = 1e-6 * exact.abs() + 1e-9 * size.max(1.0) / h * 1e-4;
            assert!(
                (exact - numeric).abs() <= allowed,
                "d {} / d {}: {exact} against {numeric} (allowed {allowed:e})",
                variable(unknown.reference).unwrap().name,
                row.name
            );
            pairs += 1;
        }
    }
    pairs
}

#[test]
fn while_time_is_continuous() {
    for actuation in [0, 1, 2] {
        let glider = Glider3::model_exchange();
        glider.set_actuation(actuation);
        glider.set(&SOMEWHERE);
        glider.begin(None);
        // SAFETY: a live instance.
        unsafe {
            glider.update_discrete_states();
            glider.ok(fmi3EnterContinuousTimeMode(glider.instance));
            glider.ok(fmi3SetTime(glider.instance, 4000.0));
        }
        let put = |glider: &Glider3, known: u32, value: f64| {
            let row = variable(known).unwrap();
            // SAFETY: a live instance and room for all states.
            unsafe {
                match row.slot {
                    Slot::Time => glider.ok(fmi3SetTime(glider.instance, value)),
                    Slot::State(i) => {
                        let mut x = [0.0; STATES.len()];
                        glider.ok(fmi3GetContinuousStates(glider.instance, x.as_mut_ptr(), STATES.len()));
                        x[i] = value;
                        glider.ok(fmi3SetContinuousStates(glider.instance, x.as_ptr(), STATES.len()));
                    }
                    _ => glider.set(&[(row.name, value)]),
                }
            }
        };
        let structure = structure(Model::Plane);
        let unknowns = structure.outputs.into_iter().chain(structure.derivatives).chain(structure.indicators);
        let pairs = check_all(&glider, &unknowns.collect::<Vec<_>>(), put);
        assert!(pairs > 150, "{pairs}");
    }
}

#[test]
fn during_initialisation_starts_and_parameters_count_too() {
    let glider = Glider3::co_simulation(Options::default());
    glider.set(&SOMEWHERE);
    // SAFETY: a live instance.
    glider.ok(unsafe { fmi3EnterInitializationMode(glider.instance, 0, 0.0, 0.0, 0, 0.0) });
    let put = |glider: &Glider3, known: u32, value: f64| glider.set(&[(variable(known).unwrap().name, value)]);
    let mut initial = structure(Model::Plane).initial;
    for unknown in &mut initial {
        // Time is not set during initialisation.
        unknown.dependencies.retain(|known| *known != vr("time"));
    }
    let pairs = check_all(&glider, &initial, put);
    assert!(pairs > 300, "{pairs}");
}

#[test]
fn the_adjoint_is_the_transpose() {
    let glider = Glider3::started(Options::default(), &SOMEWHERE);
    let structure = structure(Model::Plane);
    let unknowns: Vec<u32> =
        structure.derivatives.iter().chain(&structure.indicators).map(|unknown| unknown.reference).collect();
    let knowns: Vec<u32> =
        STATES.iter().map(|name| vr(name)).chain((2..14).chain([vr("time"), vr("b"), vr("c_per_rad2")])).collect();
    let number = |i: usize| (i as f64 * 0.7).sin() + 0.1;
    let seed_knowns: Vec<f64> = (0..knowns.len()).map(number).collect();
    let seed_unknowns: Vec<f64> = (0..unknowns.len()).map(|i| number(i + 5)).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let right = dot(&seed_unknowns, &forward(&glider, &unknowns, &knowns, &seed_knowns));
    let left = dot(&adjoint(&glider, &unknowns, &knowns, &seed_unknowns), &seed_knowns);
    assert!((left - right).abs() < 1e-12 * left.abs().max(1.0), "{left} against {right}");
}

#[test]
fn fmi_2_gives_the_same() {
    let three = Glider3::started(Options::default(), &[]);
    let two = Glider2::new(CO_SIMULATION);
    two.begin();
    let (unknown, knowns, seed) = ([vr("der(v1_m_s)")], [vr("v1_m_s"), vr("pitch_rad")], [1.0, -2.0]);
    let mut sensitivity = f64::NAN;
    // SAFETY: a live component and arrays of these lengths.
    two.ok(unsafe {
        fmi2GetDirectionalDerivative(
            two.component,
            unknown.as_ptr(),
            1,
            knowns.as_ptr(),
            2,
            seed.as_ptr(),
            &mut sensitivity,
        )
    });
    assert_eq!(sensitivity, forward(&three, &unknown, &knowns, &seed)[0]);
}

#[test]
fn what_is_no_unknown_or_no_known_is_refused() {
    let glider = Glider3::started(Options::default(), &[]);
    let derivative = |unknown: u32, known: u32, seed: f64| {
        let mut sensitivity = 0.0;
        // SAFETY: a live instance and single places.
        unsafe { fmi3GetDirectionalDerivative(glider.instance, &unknown, 1, &known, 1, &seed, 1, &mut sensitivity, 1) }
    };
    assert_eq!(derivative(vr("drag_N"), vr("v1_m_s"), 1.0), OK);
    assert_eq!(derivative(vr("b"), vr("v1_m_s"), 1.0), ERROR);
    assert_eq!(derivative(vr("drag_N"), vr("lift_N"), 1.0), ERROR);
    assert_eq!(derivative(vr("drag_N"), vr("actuation"), 1.0), ERROR);
    assert_eq!(derivative(vr("at_surface"), vr("v1_m_s"), 1.0), ERROR);
    assert_eq!(derivative(vr("drag_N"), vr("v1_m_s"), f64::NAN), ERROR);
    assert_eq!(derivative(9999, vr("v1_m_s"), 1.0), ERROR);
    assert_eq!(glider.environment.messages.take().len(), 6);
}
