//! Logs of gliders whose turning is known.

use super::*;

/// A noise that any run repeats: a linear congruence, uniform, mean zero, standard deviation one.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * 12f64.sqrt()
    }
}

/// What the glider of a log does.
struct Truth {
    per_roll: [f64; 2],
    per_rudder: f64,
    rudder_offset: f64,
    list: f64,
    per_roll_mass: f64,
}

/// Dives of two legs; roll mass and rudder move every 150 s, heading is read every 5 s with 1 deg of noise.
fn log(truth: &Truth, dives: u32, roll_mass: bool, rudder: bool, seed: u64) -> Vec<Observation> {
    let mut noise = Noise(seed);
    let mut all = Vec::new();
    let mut heading = 6.0;
    for dive in 0..dives {
        for (leg, descends) in [(0, true), (1, false)] {
            // Something that a dive's stretches have in common.
            let common = 3e-4 * noise.next();
            let (mut gamma, mut delta) = (0.0, 0.0);
            for i in 0..300u32 {
                if i % 30 == 0 {
                    gamma = if roll_mass { 0.6 * noise.next() } else { 0.0 };
                    delta = if rudder { 0.1 * noise.next() } else { 0.0 };
                }
                let roll = truth.list + truth.per_roll_mass * gamma;
                let rate = truth.per_roll[leg] * roll + truth.per_rudder * (delta + truth.rudder_offset) + common;
                heading += 5.0 * rate;
                let pitch: f64 = if descends { -0.4 } else { 0.4 };
                let depth = if descends { f64::from(i) } else { 300.0 - f64::from(i) };
                all.push(Observation {
                    time_s: f64::from((dive * 2 + leg as u32) * 2000 + 5 * i),
                    pressure_dbar: 10.0 + depth,
                    pressure_rate_dbar_s: 0.0,
                    temperature_C: 10.0,
                    density_kg_m3: 1027.0,
                    teos10_density_kg_m3: f64::NAN,
                    teos10_surface_density_kg_m3: f64::NAN,
                    pitch_rad: pitch + 0.01 * noise.next(),
                    roll_rad: roll + 0.01 * noise.next(),
                    rudder_rad: if rudder { delta } else { f64::NAN },
                    roll_mass_rad: if roll_mass { gamma } else { f64::NAN },
                    heading_rad: (heading + 0.0175 * noise.next()).rem_euclid(std::f64::consts::TAU),
                    ballast_m3: 0.0,
                    battery_forward_m: f64::NAN,
                    sink_m_s: -0.2 * pitch.signum(),
                    sink_se_m_s: 1e-3,
                    sink_window_s: [0.0; 2],
                    sink_rate_m_s2: 0.0,
                    speed_m_s: f64::NAN,
                    water_met_m_s2: f64::NAN,
                    leg: dive * 2 + leg as u32,
                    dive,
                    stretch: dive * 2 + leg as u32,
                    motor_moving: i % 30 == 0,
                    since_move_s: f64::NAN,
                    steady: true,
                });
            }
        }
    }
    all
}

const SEAGLIDER: Truth =
    Truth { per_roll: [-0.042, 0.021], per_rudder: 0.0, rudder_offset: 0.0, list: 0.05, per_roll_mass: 0.55 };

#[test]
fn both_legs_turn_rates_per_roll_list_and_centres_come_back() {
    let found = turning(&log(&SEAGLIDER, 12, true, false, 1)).expect("turns");
    let near = |q: &Option<Estimate>, truth: f64| {
        let q = q.as_ref().expect("identified");
        assert!((q.value - truth).abs() < 4.0 * q.se && q.se < 0.1 * truth.abs(), "{q:?} against {truth}");
    };
    near(&found.turn_rate_per_roll_1_s.descent, -0.042);
    near(&found.turn_rate_per_roll_1_s.ascent, 0.021);
    near(&found.static_list_rad, 0.05);
    near(&found.roll_per_roll_mass, 0.55);
    let centre = found.roll_centre.expect("centres");
    near(&centre.descent, -0.05 / 0.55);
    near(&centre.ascent, -0.05 / 0.55);
    assert!(found.turn_rate_per_rudder_1_s.is_none() && found.rudder_offset_rad.is_none());
    let held_out = found.holdout_rms_rad_s.expect("twelve dives");
    assert!(held_out.descent < 0.1 * found.sd_rad_s.descent && held_out.ascent < 0.1 * found.sd_rad_s.ascent);
}

#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    // Of 200 logs with 8 dives 190 are expected, 178 to 199 in 99.9 of 100 series.
    let inside = (0..200)
        .filter(|seed| {
            let found = turning(&log(&SEAGLIDER, 8, true, false, 100 + seed)).expect("turns");
            let [low, high] = found.turn_rate_per_roll_1_s.descent.expect("identified").ci95;
            (low..=high).contains(&-0.042)
        })
        .count();
    assert!((178..=199).contains(&inside), "{inside} of 200");
}

/// As if every move lasted a second and fell between two samples, so that none has its flag; `times` says whether the log has them.
fn between_samples(mut all: Vec<Observation>, times: bool) -> Vec<Observation> {
    let mut end_s = f64::NAN;
    for o in &mut all {
        if o.motor_moving {
            end_s = o.time_s - 2.0;
        }
        // One flag is left: a log without any has its moves sought in the roll.
        o.motor_moving = o.leg == 0 && o.time_s < 1.0;
        if times {
            o.since_move_s = o.time_s - end_s;
        }
    }
    all
}

#[test]
fn a_move_between_two_samples_ends_a_stretch() {
    let flagged = stretches(&log(&SEAGLIDER, 4, true, false, 6));
    assert_eq!(flagged.len(), 4 * 2 * 10);
    let found = stretches(&between_samples(log(&SEAGLIDER, 4, true, false, 6), true));
    assert_eq!(found.len(), flagged.len());
    for (own, known) in found.iter().zip(&flagged) {
        assert!((own.roll_rad - known.roll_rad).abs() < 0.005 && (own.rate_rad_s - known.rate_rad_s).abs() < 1e-3);
    }
    // By the readings of the roll mass: one of the moves is smaller than what counts as one.
    let found = stretches(&between_samples(log(&SEAGLIDER, 4, true, false, 6), false));
    assert_eq!(found.len(), flagged.len() - 1);
}

#[test]
fn halves_are_every_other_dive_and_their_errors_are_those_held_out() {
    let all = log(&SEAGLIDER, 7, true, false, 7);
    let found = turning(&all).expect("turns");
    let Halves { odd, even } = found.halves.expect("seven dives");
    assert_eq!((odd.dives, even.dives), (4, 3));
    let alone: Vec<Observation> = all.iter().filter(|o| o.dive % 2 == 0).copied().collect();
    assert_eq!(turning(&alone).expect("four dives").turn_rate_per_roll_1_s, odd.turn_rate_per_roll_1_s);
    let squares = |half: &Half| half.predicted_rms_rad_s.ascent.powi(2) * half.stretches.ascent as f64;
    let n = (odd.stretches.ascent + even.stretches.ascent) as f64;
    let both = found.holdout_rms_rad_s.expect("seven dives").ascent;
    assert!((both - ((squares(&odd) + squares(&even)) / n).sqrt()).abs() < 1e-15);
    // Two dives have one degree of freedom, one has no error.
    let few = |dives| turning(&log(&SEAGLIDER, dives, true, false, 8)).expect("turns").halves.expect("halves").even;
    assert!(few(4).turn_rate_per_roll_1_s.descent.is_some() && few(3).turn_rate_per_roll_1_s.descent.is_none());
}

#[test]
fn a_rudder_and_its_offset_come_back() {
    let truth = Truth { per_roll: [0.0; 2], per_rudder: 0.09, rudder_offset: 0.05, list: -0.1, per_roll_mass: 0.0 };
    let found = turning(&log(&truth, 12, false, true, 3)).expect("turns");
    let rudder = found.turn_rate_per_rudder_1_s.expect("identified");
    assert!((rudder.value - 0.09).abs() < 4.0 * rudder.se && rudder.se < 0.005, "{rudder:?}");
    let offset = found.rudder_offset_rad.expect("identified");
    assert!((offset.value - 0.05).abs() < 4.0 * offset.se && offset.se < 0.01, "{offset:?}");
    let list = found.static_list_rad.expect("the roll stands still");
    assert!((list.value + 0.1).abs() < 0.005, "{list:?}");
    assert!(found.turn_rate_per_roll_1_s.descent.is_none(), "the roll did not vary");
}

#[test]
fn what_is_not_there_is_not_invented() {
    let mut no_heading = log(&SEAGLIDER, 6, true, false, 4);
    no_heading.iter_mut().for_each(|o| o.heading_rad = f64::NAN);
    assert!(turning(&no_heading).is_none());
    assert!(turning(&log(&SEAGLIDER, 2, true, false, 5)).is_none(), "two dives");
    assert!(turning(&[]).is_none());
}

/// A curvature per rudder that errs by less than a third explains what a rudder that stands still does, or does not. A straight course with
/// the rudder at an angle needs no such figure.
#[test]
fn a_rudder_that_stands_still_is_judged_by_what_the_vehicle_says_it_turns() {
    let curvature_per_rudder = 0.3;
    // Curvature that is flown, angle of the rudder, offset that is named.
    let cases = [
        (0.0, -0.05, Some(0.05)),
        (0.0, 0.08, Some(-0.08)),
        (0.0, 0.0, None),
        (1.2 * 0.3 * 0.05, 0.05, None),
        (0.8 * 0.3 * 0.05, 0.05, None),
        // Twice as much is 2.7 standard errors of the logarithm, four times as much 5.3.
        (2.0 * 0.3 * 0.05, 0.05, None),
        (4.0 * 0.3 * 0.05, 0.05, Some(0.15)),
        (-0.3 * 0.05, 0.05, None),
    ];
    for (curvature, rudder_rad, offset) in cases {
        // The path is steeper than the pitch of 0.4 rad by the angle of attack, 0.07 rad.
        let speed_m_s = 0.2 / 0.47f64.sin();
        let truth = Truth {
            per_roll: [0.0; 2],
            per_rudder: curvature * speed_m_s,
            rudder_offset: 1.0,
            list: 0.0,
            per_roll_mass: 0.0,
        };
        let mut all = log(&truth, 12, false, false, 9);
        all.iter_mut().for_each(|row| row.rudder_rad = rudder_rad);
        let known = causes::KnownTurning { curvature_per_rudder: Some(curvature_per_rudder), ..Default::default() };
        let found = causes::causes(&all, known).expect("steady stretches");
        let named = found.causes.iter().find(|cause| cause.quantity == causes::TURN_RATE);
        match (offset, named) {
            (None, None) => {}
            (Some(offset), Some(cause)) => {
                assert_eq!(cause.cause, "rudder_offset");
                let found = &cause.parameters["rudder_offset_rad"];
                assert!((found.value - offset).abs() < 4.0 * found.se, "{found:?} against {offset}");
                let errs_by = 0.26 * curvature / curvature_per_rudder;
                assert!(found.se < 1.1 * errs_by + 0.005, "{found:?}: the vehicle's figure errs by {errs_by}");
            }
            (expected, named) => panic!("{curvature} at {rudder_rad}: {expected:?}, named {named:?}"),
        }
    }
}
