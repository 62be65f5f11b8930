//! Steady turns of the virtual sea's gliders.

use super::*;
use crate::ocean::{Ocean, Weather};
use crate::random::{Part, stream};

/// Steady turn rate and roll with the roll mass, the rudder and a pod held, in water without eddies.
fn turn(seed: u64, pitch_rad: f64, roll_mass_rad: f64, rudder_rad: f64, pod_m3: f64) -> (f64, f64) {
    turn_with_list(seed, pitch_rad, roll_mass_rad, 0.0, rudder_rad, pod_m3)
}

fn turn_with_list(
    seed: u64,
    pitch_rad: f64,
    roll_mass_rad: f64,
    list_rad: f64,
    rudder_rad: f64,
    pod_m3: f64,
) -> (f64, f64) {
    let ocean = Ocean::draw(&mut stream(seed, Part::Ocean), Weather::default());
    let hull = if rudder_rad == 0.0 { Hull::Seaglider } else { Hull::Slocum200 };
    let vehicle = hull.draw(&mut stream(seed, Part::Vehicle), &ocean);
    let figures = LateralFigures::draw(&mut stream(seed, Part::LateralFigures), hull);
    let net_mass_kg = -0.2 * pitch_rad.signum();
    let (angle_rad, speed_m_s) = vehicle.steady_glide(net_mass_kg, pitch_rad, 1027.0).expect("a glide");
    let below = vehicle.moving_mass_kg * vehicle.moving_mass_height_m;
    let sliding_kg_m = vehicle.moving_mass_kg * vehicle.moving_mass_for(pitch_rad, angle_rad, speed_m_s, 1027.0);
    let below_kg_m = below + figures.rolling_kg_m * (roll_mass_rad.cos() - 1.0);
    let mut given = Given {
        vehicle: &vehicle,
        figures: &figures,
        speed_m_s,
        angle_rad,
        pitch_rad,
        density_kg_m3: 1027.0,
        net_mass_kg,
        forward_kg_m: sliding_kg_m,
        starboard_kg_m: figures.rolling_kg_m * roll_mass_rad.sin() + below * list_rad.tan(),
        below_kg_m,
        rudder_rad,
        pod_m3,
        gust_m_s: 0.0,
        eddy: 0.0,
    };
    let mut state = State::default();
    for _ in 0..8000 {
        state = given.advance(&state, 0.025);
        // The sliding mass that holds this pitch at this roll.
        given.forward_kg_m = (sliding_kg_m + (below - below_kg_m) * pitch_rad.tan()) / state.roll_rad.cos();
    }
    (given.rate(&state)[4], state.roll_rad)
}

#[test]
fn the_sense_of_a_roll_reverses_between_the_legs_and_that_of_rudder_and_pod_does_not() {
    for seed in 7000..7010 {
        for pitch in [0.25, 0.45, 0.7] {
            let legs = [-pitch, pitch];
            let [down, up] = legs.map(|pitch| turn(seed, pitch, 0.4, 0.0, 0.0));
            assert!(down.0 < -1e-3 && up.0 > 1e-3 && down.1 > 0.15 && up.1 > 0.15, "{seed}: {down:?} {up:?}");
            // Its mirror image turns the other way, as fast.
            let [mirror, _] = legs.map(|pitch| turn(seed, pitch, -0.4, 0.0, 0.0));
            assert!((down.0 + mirror.0).abs() < 1e-9 && (down.1 + mirror.1).abs() < 1e-9, "{seed}");
            let [down, up] = legs.map(|pitch| turn(seed, pitch, 0.0, 0.1, 0.0).0);
            assert!(down > 5e-3 && (up - down).abs() < 1e-6, "{seed}: rudder {down} {up}");
            let [down, up] = legs.map(|pitch| turn(seed, pitch, 0.0, 0.0, 6e-4).0);
            assert!(down > 1e-3 && (up - down).abs() < 1e-6, "{seed}: pod {down} {up}");
        }
    }
}

/// Gravity yaws a leaning glider by its roll alone, whether a list or the roll mass makes it lean.
#[test]
fn a_list_and_a_roll_mass_that_lean_the_glider_alike_turn_it_alike() {
    for pitch in [-0.6, -0.25, 0.25, 0.6] {
        // The roll mass that makes the same roll as 0.12 rad of list and 0.5 rad of roll mass.
        let (rate, roll) = turn_with_list(7001, pitch, 0.5, 0.12, 0.0, 0.0);
        let (mut low, mut high) = (0.0, 1.4);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if turn(7001, pitch, middle, 0.0, 0.0).1 < roll { low = middle } else { high = middle }
        }
        let (alone, _) = turn(7001, pitch, low, 0.0, 0.0);
        assert!((alone - rate).abs() < 1e-6 && rate.abs() > 1e-3, "{pitch}: {rate} with a list, {alone} without");
    }
}

/// Without turning, the roll is that at which gravity has no moment.
#[test]
fn a_roll_mass_and_a_list_lean_the_glider_as_statics_say() {
    let (turn_rate, roll_rad) = turn(7001, -0.25, 0.4, 0.0, 0.0);
    let seed = 7001;
    let ocean = Ocean::draw(&mut stream(seed, Part::Ocean), Weather::default());
    let vehicle = Hull::Seaglider.draw(&mut stream(seed, Part::Vehicle), &ocean);
    let rolling = LateralFigures::draw(&mut stream(seed, Part::LateralFigures), Hull::Seaglider).rolling_kg_m;
    let below = vehicle.moving_mass_kg * vehicle.moving_mass_height_m;
    let at_rest = (rolling * 0.4f64.sin() / (below + rolling * (0.4f64.cos() - 1.0))).atan();
    // The wing's damping of the roll rate that a turn at this pitch has adds some hundredths.
    assert!((roll_rad - at_rest).abs() < 0.03 && turn_rate < 0.0, "{roll_rad} against {at_rest}");
}

/// The closed form against the motion itself, where a list keeps the roll at zero.
#[test]
fn the_curvature_without_roll_is_that_of_a_settled_turn() {
    for seed in 7000..7004 {
        for pitch in [-0.6, -0.3, 0.3, 0.6] {
            for (rudder, pod) in [(0.0, 6e-4), (0.05, 0.0)] {
                let (mut low, mut high) = (-0.3, 0.3);
                let at = |list: f64| turn_with_list(seed, pitch, 0.0, list, rudder, pod);
                for _ in 0..40 {
                    let middle = 0.5 * (low + high);
                    if at(middle).1 < 0.0 { low = middle } else { high = middle }
                }
                let rate = at(low).0;
                let ocean = Ocean::draw(&mut stream(seed, Part::Ocean), Weather::default());
                let hull = if rudder == 0.0 { Hull::Seaglider } else { Hull::Slocum200 };
                let vehicle = hull.draw(&mut stream(seed, Part::Vehicle), &ocean);
                let figures = LateralFigures::draw(&mut stream(seed, Part::LateralFigures), hull);
                let (_, speed) = vehicle.steady_glide(-0.2 * pitch.signum(), pitch, 1027.0).expect("a glide");
                let curvature = figures.curvature_without_roll(&vehicle, pod, rudder, pitch, speed).expect("a glide");
                // The pod's drag makes the path steeper, which the motion above leaves out: some thousandths.
                assert!((curvature * speed / rate - 1.0).abs() < 0.01, "{seed} {pitch}: {} {rate}", curvature * speed);
            }
        }
    }
}
