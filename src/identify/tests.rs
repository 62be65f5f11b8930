//! Fits on glides whose every figure is known from the closed form, from forces written out, or by construction.

use num_dual::Dual64;

use super::blocks::Blocks;
use super::inflections::inflections;
use super::pitch_balance::{pitch_balance, predicted_pitch_rad};
use super::unsteady::passages;
use super::*;
use crate::dynamics::{Parameters, Surroundings, parameter_index};
use crate::glide::{Attitude, at_path, at_pitch};
use crate::log::Observation;
use crate::vehicle::Vehicle;

pub(crate) fn glider() -> (Vehicle, Parameters<f64>) {
    let vehicle = Vehicle::load("slocum-graver").expect("a built-in vehicle");
    let mut p = vehicle.glide_parameters();
    (p.a_per_rad, p.b, p.c_per_rad2, p.ballast_offset_kg) = (18.0, 0.4, 8.0, 0.05);
    (p.CL0, p.CM0) = (0.0, 0.0);
    (vehicle, p)
}

fn water(p: &Parameters<f64>) -> Surroundings<f64> {
    Surroundings { density_kg_m3: 1026.0, pressure_Pa: 4e5, temperature_C: p.reference_temperature_C, time_s: 0.0 }
}

/// One sample of a glide at this path angle and speed, by the closed form; mass and pitch follow from the forces.
pub(crate) fn sample(p: &Parameters<f64>, path_deg: f64, speed_m_s: f64, dive: u32, time_s: f64) -> Observation {
    sample_in(p, &water(p), path_deg, speed_m_s, dive, time_s)
}

fn sample_in(
    p: &Parameters<f64>,
    water: &Surroundings<f64>,
    path_deg: f64,
    speed_m_s: f64,
    dive: u32,
    time_s: f64,
) -> Observation {
    let glide = at_path(p, water, path_deg.to_radians(), speed_m_s).expect("a path that can be flown");
    Observation {
        time_s,
        pressure_dbar: 40.0,
        pressure_rate_dbar_s: 0.0,
        temperature_C: water.temperature_C,
        density_kg_m3: water.density_kg_m3,
        teos10_density_kg_m3: f64::NAN,
        teos10_surface_density_kg_m3: f64::NAN,
        pitch_rad: glide.pitch_rad,
        roll_rad: 0.0,
        rudder_rad: 0.0,
        roll_mass_rad: f64::NAN,
        heading_rad: f64::NAN,
        ballast_m3: glide.ballast_m3,
        battery_forward_m: glide.moving_mass_m,
        sink_m_s: glide.vertical_velocity_m_s,
        sink_se_m_s: 1e-3,
        sink_window_s: [0.0; 2],
        sink_rate_m_s2: 0.0,
        speed_m_s: glide.speed_m_s,
        water_met_m_s2: f64::NAN,
        leg: 2 * dive + u32::from(path_deg > 0.0),
        dive,
        stretch: 0,
        motor_moving: false,
        since_move_s: f64::NAN,
        steady: true,
    }
}

/// Steep, medium and shallow glides on both legs, each held from its first sample to its last.
fn campaign(p: &Parameters<f64>) -> Vec<Observation> {
    let mut all = Vec::new();
    for dive in 0..8u32 {
        let steep = 24.0 + 2.5 * f64::from(dive % 4);
        let speed = 0.27 + 0.02 * f64::from(dive % 3);
        for (leg, sign) in [(0, -1.0), (1, 1.0)] {
            for i in 0..6 {
                let time = f64::from(dive) * 1000.0 + f64::from(leg) * 500.0 + f64::from(i) * 10.0;
                all.push(sample(p, sign * steep, speed, dive, time));
            }
        }
    }
    all
}

#[test]
fn the_joint_fit_returns_what_the_closed_form_was_made_of() {
    let (vehicle, truth) = glider();
    let all = campaign(&truth);
    let question =
        Question::new(vehicle.glide_parameters(), &["a_per_rad", "b", "c_per_rad2", "ballast_offset_kg"]).unwrap();
    let found = fit(&question, &mut by_dive(&all)).unwrap();
    let p = found.parameters;
    for (name, found, truth) in [
        ("a", p.a_per_rad, truth.a_per_rad),
        ("b", p.b, truth.b),
        ("c", p.c_per_rad2, truth.c_per_rad2),
        ("offset", p.ballast_offset_kg, truth.ballast_offset_kg),
    ] {
        assert!((found / truth - 1.0).abs() < 1e-4, "{name}: {found} against {truth}");
    }
    assert!(found.tally.sink.rms() < 1e-6 && found.tally.speed.rms() < 1e-6);
}

#[test]
fn without_speed_the_lift_slope_is_held_and_it_is_said() {
    let (vehicle, truth) = glider();
    let mut all = campaign(&truth);
    all.iter_mut().for_each(|o| o.speed_m_s = f64::NAN);
    let request = Request { trim: Trim::Vehicle, free: Vec::new(), pin: Vec::new(), unsteady: None };
    let found = identify(&vehicle, &all, &request).unwrap();
    assert!(found.pinned.contains_key("a"), "{:?}", found.pinned);
    let report = found.report(&vehicle, String::new(), Vec::new());
    assert!(!report.identifiable["a"]);
    assert!(report.warnings.iter().any(|warning| warning.contains("no measured speed")));
    // The offset needs no lift slope.
    let offset = report.parameters["ballast_offset_kg"].as_ref().unwrap().value;
    assert!((offset - truth.ballast_offset_kg).abs() < 2e-3, "{offset}");
}

#[test]
fn samples_weigh_by_the_time_they_stand_for() {
    // Two legs that contradict each other, one sampled ten times as often for as long: b is where both weigh alike.
    let (_, truth) = glider();
    let mut slow = truth;
    slow.b *= 1.1;
    let mut all = Vec::new();
    for dive in 0..4u32 {
        for (p, every, start) in [(&truth, 10, 0.0), (&slow, 1, 600.0)] {
            for i in (0..=300).step_by(every) {
                let mut o = sample(p, -27.0, 0.3, dive, f64::from(dive) * 2000.0 + start + f64::from(i));
                o.leg = 2 * dive + u32::from(start > 0.0);
                all.push(o);
            }
        }
    }
    let question = Question { use_speed: false, ..Question::new(truth, &["b"]).unwrap() };
    let found = fit(&question, &mut by_dive(&all)).unwrap();
    let middle = found.parameters.b / truth.b;
    assert!((middle - 1.05).abs() < 0.005, "{middle}");
}

/// A dive and a climb at constant ballast each, long enough to be steady, one sample a second.
fn long_glide(p: &Parameters<f64>, dives: u32) -> Vec<Observation> {
    let mut all = Vec::new();
    for dive in 0..dives {
        for i in 0..600 {
            let mut o = sample(p, -26.0 - f64::from(dive), 0.3, dive, f64::from(dive) * 5000.0 + f64::from(i));
            (o.leg, o.stretch) = (dive, dive);
            all.push(o);
        }
    }
    all
}

#[test]
fn flown_through_time_a_steady_glide_stays_what_it_is() {
    let (_, truth) = glider();
    let all = long_glide(&truth, 2);
    let found = passages(&all, 3.0, 4.0);
    assert_eq!(found.len(), 2);
    for passage in &found {
        let counted = passage.counts.iter().filter(|&&counts| counts).count();
        assert!(counted > 500 && counted < 600, "{counted}");
        for residual in passage.residuals(&truth).iter().filter(|r| r.sink_m_s.is_finite()) {
            assert!(residual.sink_m_s.abs() < 1e-6 && residual.speed_m_s.abs() < 1e-6, "{residual:?}");
        }
    }
}

#[test]
fn a_jump_of_the_ballast_is_answered_with_the_time_constant_of_surge() {
    // Straight down, nose down: no angle of attack, m V' = W - rho/2 A b V^2, whose solution from rest is a tanh.
    let (_, mut p) = glider();
    (p.c_per_rad2, p.ballast_offset_kg) = (0.0, 0.0);
    let water = water(&p);
    let net_kg = 0.3;
    let ballast_m3 = (p.net_mass_kg(0.0, &water) - net_kg) / (water.density_kg_m3 * p.ballast_scale);
    let mass = p.hull_mass_kg + p.moving_mass_kg + p.ballast_mass_kg(ballast_m3) + p.added_mass_1_kg;
    let drag = 0.5 * water.density_kg_m3 * p.frontal_area_m2 * p.b;
    let terminal = (net_kg * p.gravity_m_s2 / drag).sqrt();
    let rate = (net_kg * p.gravity_m_s2 * drag).sqrt() / mass;
    let template = sample(&glider().1, -27.0, 0.3, 0, 0.0);
    let all: Vec<Observation> = (0..200)
        .map(|i| Observation {
            time_s: f64::from(i),
            // Afloat in the first sample, so that it starts at rest; then below.
            pressure_dbar: if i == 0 { 0.0 } else { 40.0 },
            pitch_rad: -std::f64::consts::FRAC_PI_2,
            ballast_m3,
            sink_m_s: 0.0,
            speed_m_s: 0.0,
            ..template
        })
        .collect();
    let passage = &passages(&all, 3.0, 4.0)[0];
    let found = passage.residuals(&p);
    for i in [10, 20, 40, 80, 150] {
        let expected = terminal * (rate * i as f64).tanh();
        assert!(
            (-found[i].speed_m_s - expected).abs() < 2e-3 * terminal,
            "{i} s: {found:?} against {expected}",
            found = -found[i].speed_m_s
        );
    }
}

#[test]
fn slopes_of_the_unsteady_flight_are_those_of_differences() {
    let (_, truth) = glider();
    let mut all = long_glide(&truth, 1);
    // A turn of the pitch and of the ballast on the way.
    for (i, o) in all.iter_mut().enumerate() {
        let turn = ((i as f64 - 300.0) / 10.0).tanh();
        o.pitch_rad *= -turn;
        o.ballast_m3 *= -turn;
    }
    let mut flown = passages(&all, 3.0, 4.0);
    let free: Vec<usize> =
        ["a_per_rad", "b", "ballast_offset_kg", "added_mass_1_kg"].map(|name| parameter_index(name).unwrap()).to_vec();
    let weights = Weights { sink_m_s: 1.0, speed_m_s: 1.0 };
    let mut cost = |p: &Parameters<f64>| {
        let mut grams = vec![Gram::new(free.len()); flown.len()];
        flown.evaluate(p, &free, weights, &mut grams, 1);
        (0.5 * grams[0].sum_of_squares(), grams[0].gradient())
    };
    let gradient = cost(&truth).1;
    for (i, &row) in free.iter().enumerate() {
        let step = 1e-5 * truth.as_array()[row].abs().max(0.1);
        let (mut up, mut down) = (truth, truth);
        *up.at(row) += step;
        *down.at(row) -= step;
        let difference = (cost(&up).0 - cost(&down).0) / (2.0 * step);
        assert!(
            (gradient[i] - difference).abs() < 1e-4 * difference.abs().max(1e-6),
            "{row}: {} against {difference}",
            gradient[i]
        );
    }
}

#[test]
fn the_unsteady_fit_finds_what_the_flight_was_made_of() {
    let (_, truth) = glider();
    let mut all = long_glide(&truth, 4);
    for o in &mut all {
        let turn = ((o.time_s % 5000.0 - 300.0) / 10.0).tanh();
        o.pitch_rad *= -turn;
        o.ballast_m3 *= -turn;
        (o.sink_m_s, o.speed_m_s) = (0.0, 0.0);
    }
    // What the model itself flies, as the record.
    for passage in passages(&all, 3.0, 4.0) {
        for (o, residual) in passage.observations.iter().zip(passage.residuals(&truth)) {
            let row = all.iter_mut().find(|row| row.time_s == o.time_s).unwrap();
            (row.sink_m_s, row.speed_m_s) = (-residual.sink_m_s, -residual.speed_m_s);
        }
    }
    let mut start = truth;
    (start.a_per_rad, start.b, start.ballast_offset_kg) = (16.0, 0.44, 0.06);
    let question = Question::new(start, &["a_per_rad", "b", "ballast_offset_kg", "added_mass_3_kg"]).unwrap();
    let unsteady = Unsteady { from_dbar: 3.0, half_window_s: 4.0 };
    let found = inflections(&question, &start, &all, &unsteady).unwrap();
    let p = found.fit.parameters;
    for (found, truth) in [(p.a_per_rad, truth.a_per_rad), (p.b, truth.b), (p.added_mass_3_kg, truth.added_mass_3_kg)] {
        assert!((found / truth - 1.0).abs() < 1e-3, "{found} against {truth}");
    }
    assert!(found.score.w_rms_m_s < 1e-5, "{:?}", found.score);
    assert!(found.comparison.steady.w_rms_m_s > 10.0 * found.comparison.unsteady.w_rms_m_s);
}

/// Descents whose battery stands where the moments balance. Lift carries the weight, so that the hydrodynamic moment goes
/// with the net weight: only where the density changes that, does it differ from the moment of the ballast.
fn balanced(p: &Parameters<f64>) -> Vec<Observation> {
    let mut all = Vec::new();
    for dive in 0..8u32 {
        for i in 0..10 {
            let (steep, speed) =
                (22.0 + 2.0 * f64::from((dive * 3 + i) % 5), 0.2 + 0.03 * f64::from((dive + 2 * i) % 7));
            let density_kg_m3 = 1024.0 + 2.0 * f64::from((dive + i) % 3);
            let water = Surroundings { density_kg_m3, ..water(p) };
            all.push(sample_in(p, &water, -steep, speed, dive, f64::from(dive * 1000 + i * 10)));
        }
    }
    all
}

#[test]
fn the_balance_of_moments_returns_d_and_the_height_of_the_centre_of_gravity() {
    let (vehicle, mut truth) = glider();
    truth.offset_mass_kg = truth.hull_mass_kg;
    (truth.moving_mass_height_m, truth.offset_mass_below_m) = (0.0, 0.006);
    (truth.offset_mass_forward_m, truth.ballast_forward_m) = (-0.002, 0.5);
    truth.d_per_rad = -1.4;
    let all = balanced(&truth);
    let known = Parameters {
        d_per_rad: 0.0,
        offset_mass_forward_m: 0.0,
        offset_mass_below_m: 0.0,
        ballast_forward_m: 0.0,
        ..truth
    };
    let found = pitch_balance(&vehicle, &known, &by_dive(&all), &[]).unwrap().expect("a battery that moves");
    let p = found.fit.parameters;
    assert!((p.d_per_rad - truth.d_per_rad).abs() < 1e-4, "d {}", p.d_per_rad);
    assert!((p.ballast_forward_m - 0.5).abs() < 1e-5, "arm {}", p.ballast_forward_m);
    let expected = truth.hull_mass_kg * 0.006 / truth.mass_kg();
    assert!((found.cg_below_cb_m().0 - expected).abs() < 1e-7, "{:?} against {expected}", found.cg_below_cb_m());
    assert!(found.pitch_rms_rad < 1e-6 && found.is_identified && found.failure.is_none());
    assert!(found.pitch_rms_without_d_rad.is_none_or(|rms| rms > 1e-4));
}

/// The same glider whose battery reads something else.
fn with_battery(of: impl Fn(usize, &Observation) -> f64) -> Identification {
    let (vehicle, mut truth) = glider();
    truth.offset_mass_kg = truth.hull_mass_kg;
    (truth.moving_mass_height_m, truth.offset_mass_below_m, truth.d_per_rad) = (0.0, 0.006, -1.4);
    let read = |(i, o): (usize, Observation)| Observation { battery_forward_m: of(i, &o), ..o };
    let all: Vec<Observation> = balanced(&truth).into_iter().enumerate().map(read).collect();
    let request = Request { trim: Trim::Vehicle, free: Vec::new(), pin: Vec::new(), unsteady: None };
    identify(&vehicle, &all, &request).expect("a polar")
}

#[test]
fn a_balance_that_explains_no_pitch_is_not_reported() {
    assert!(with_battery(|_, o| o.battery_forward_m).pitch_balance.is_some());
    // A battery whose position has nothing to do with the pitch but a trace of the right sign.
    let noise = |i: usize| 0.05 * ((i * 37 % 23) as f64 / 11.0 - 1.0);
    let none = with_battery(|i, o| noise(i) + 0.2 * o.battery_forward_m);
    assert!(none.pitch_balance.is_none());
    assert!(
        none.warnings.iter().any(|text| text.contains("balance of moments is not identifiable")),
        "{:?}",
        none.warnings
    );
}

#[test]
fn battery_and_ballast_that_move_together_are_not_distinguished() {
    let (vehicle, mut truth) = glider();
    truth.offset_mass_kg = truth.hull_mass_kg;
    (truth.moving_mass_height_m, truth.offset_mass_below_m, truth.d_per_rad) = (0.0, 0.006, -1.4);
    // One ballast and one pitch for each leg: as most gliders are flown.
    let mut all = Vec::new();
    for dive in 0..8u32 {
        for (sign, path) in [(-1.0, 27.0), (1.0, 27.0)] {
            for i in 0..5 {
                all.push(sample(
                    &truth,
                    sign * (path + 0.01 * f64::from(i)),
                    0.28,
                    dive,
                    f64::from(dive * 1000 + i * 10) + 300.0 * (sign + 1.0),
                ));
            }
        }
    }
    let found = pitch_balance(&vehicle, &truth, &by_dive(&all), &[]).unwrap().expect("a battery that moves");
    assert!(found.pinned.contains_key("ballast_forward_m"), "{:?}", found.pinned);
    assert!(!found.is_identified);
}

#[test]
fn predicted_pitch_and_needed_battery_are_inverse_to_each_other() {
    let (_, mut p) = glider();
    p.d_per_rad = -0.8;
    let with_slope = p.map(Dual64::from);
    let o = sample(&p, 26.0, 0.3, 0, 0.0);
    let pitch: f64 = predicted_pitch_rad(&p, &with_slope, &o, o.pitch_rad + 0.05).unwrap();
    assert!((pitch - o.pitch_rad).abs() < 1e-9);
    let net = p.net_mass_kg(o.ballast_m3, &water(&p));
    let glide = at_pitch(&p, &water(&p), Attitude { pitch_rad: pitch, net_mass_kg: net }).unwrap();
    assert!((glide.moving_mass_m - o.battery_forward_m).abs() < 1e-9);
}
