//! A speed sensor that loses the water.

use crate::{Observation, take_out_lost_speeds};

use super::condensing::observations;

/// Legs of 20 samples, descents and ascents in turn, flown at a pitch with 3 degrees of angle of attack, their speed read
/// with a factor.
fn legs(flown: &[(f64, f64)]) -> Vec<Observation> {
    let any = observations(1)[0];
    let of_leg = |(leg, &(pitch_deg, factor)): (usize, &(f64, f64))| {
        let down = if leg % 2 == 0 { 1.0 } else { -1.0 };
        let speed_m_s = 0.3 + 0.01 * leg as f64;
        let path_rad = (pitch_deg + 3.0).to_radians();
        (0..20).map(move |i| Observation {
            time_s: (600 * leg + 10 * i) as f64,
            pitch_rad: -down * pitch_deg.to_radians(),
            sink_m_s: down * speed_m_s * path_rad.sin(),
            speed_m_s: factor * speed_m_s,
            water_met_m_s2: f64::NAN,
            leg: leg as u32,
            dive: leg as u32 / 2,
            steady: true,
            ..any
        })
    };
    flown.iter().enumerate().flat_map(of_leg).collect()
}

fn legs_without(observations: &[Observation]) -> Vec<u32> {
    let mut without: Vec<u32> = observations.iter().filter(|o| o.speed_m_s.is_nan()).map(|o| o.leg).collect();
    without.dedup();
    without
}

#[test]
fn the_speed_of_one_descent_that_is_not_that_of_the_others_is_left_out() {
    let mut flown = [(25.0, 1.0); 20];
    flown[14].1 = 0.65;
    let mut observations = legs(&flown);
    let warnings = take_out_lost_speeds(&mut observations);
    assert_eq!(legs_without(&observations), [14]);
    assert_eq!(warnings.len(), 1);
    assert!(
        warnings[0].contains("descent of dive 8")
            && warnings[0].contains("35 % less")
            && warnings[0].contains("other 9"),
        "{warnings:?}"
    );
}

#[test]
fn pitch_flown_from_shallow_to_steep_and_a_sensor_that_is_wrong_throughout_are_no_loss() {
    let pitches = [13.0, 25.0, 40.0, 27.0, 14.0, 38.0];
    for factor in [1.0, 0.7] {
        let flown: Vec<(f64, f64)> = (0..24).map(|leg| (pitches[leg / 2 % 6], factor)).collect();
        let mut observations = legs(&flown);
        assert!(take_out_lost_speeds(&mut observations).is_empty() && legs_without(&observations).is_empty());
    }
}

#[test]
fn where_few_legs_or_half_of_them_differ_nobody_can_say_which_is_right() {
    let half: Vec<(f64, f64)> = (0..24).map(|leg| (25.0, if leg < 12 { 1.0 } else { 0.6 })).collect();
    let few = [(25.0, 1.0), (25.0, 1.0), (25.0, 0.5), (25.0, 1.0), (25.0, 1.0), (25.0, 1.0)];
    for flown in [&half[..], &few[..]] {
        let mut observations = legs(flown);
        assert!(take_out_lost_speeds(&mut observations).is_empty() && legs_without(&observations).is_empty());
    }
}
