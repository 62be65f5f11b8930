//! The built-in vehicles turn as real gliders of their kind do, on both legs.

mod support;

use glidepolar_spatial::Body;
use glidepolar_spatial::turn::{Setting, Trim, Turn, find};
use support::builtin;

fn only(body: &Body<f64>, net_mass_kg: f64, pitch_deg: f64, roll_mass_deg: f64, rudder_rad: f64) -> Turn {
    let setting = Setting {
        net_mass_kg,
        trim: Trim::Pitch(pitch_deg.to_radians()),
        roll_mass_rad: roll_mass_deg.to_radians(),
        rudder_rad,
        density_kg_m3: body.plane.reference_density_kg_m3,
        depth_m: 0.0,
    };
    let turns = find(body, &setting);
    assert_eq!(turns.len(), 1, "{turns:#?}");
    assert!(turns[0].stable);
    turns[0].clone()
}

#[test]
fn a_seaglider_turns_against_its_roll_on_descents_and_with_it_on_ascents() {
    // SG542's dives 304-317: heavy by .19 kg at -22.5 deg, light by .11 kg at 34.2 deg, roll mass at +-40 deg. Turn rate per
    // roll of its log: -.0424(15) and +.0204(7) 1/s, roll per roll mass .561. The fin was fitted to the descents alone.
    let body = builtin("seaglider");
    for sign in [1.0, -1.0] {
        let (dive, climb) = (only(&body, 0.19, -22.5, 40.0 * sign, 0.0), only(&body, -0.11, 34.2, 40.0 * sign, 0.0));
        let k = |turn: &Turn| turn.turn_rate_rad_s / turn.roll_rad;
        assert!((k(&dive) / -0.0424 - 1.0).abs() < 0.05, "dive {}", k(&dive));
        assert!((k(&climb) / 0.0204 - 1.0).abs() < 0.20, "climb {}", k(&climb));
        for turn in [&dive, &climb] {
            let per_roll_mass = turn.roll_rad / (40.0 * sign).to_radians();
            assert!((per_roll_mass / 0.561 - 1.0).abs() < 0.03, "{per_roll_mass}");
        }
    }
}

#[test]
fn a_slocum_turns_to_the_side_of_its_rudder_on_both_legs() {
    // Comet, settled below the thermocline: .0177 and .0179 rad/s at a rudder of .2022 rad, at .28 to .37 m/s.
    for name in ["slocum-graver", "slocum-049"] {
        let body = builtin(name);
        for (net_mass_kg, pitch_deg) in [(0.07, -25.5), (-0.08, 26.8)] {
            for rudder_rad in [0.2022, -0.2022] {
                let turn = only(&body, net_mass_kg, pitch_deg, 0.0, rudder_rad);
                let per_rudder = turn.turn_rate_rad_s / rudder_rad;
                let at_speed = per_rudder * 0.32 / turn.speed_m_s;
                assert!(
                    (at_speed / 0.088 - 1.0).abs() < 0.2,
                    "{name} {net_mass_kg}: {per_rudder} at {}",
                    turn.speed_m_s
                );
            }
        }
    }
}

#[test]
fn every_turn_within_the_limits_is_one_and_stable() {
    let (seaglider, slocum) = (builtin("seaglider"), builtin("slocum-049"));
    for (net_mass_kg, pitch_deg) in [(0.2, -18.0), (0.1, -40.0), (-0.2, 18.0), (-0.1, 40.0)] {
        for tenths in -5..=5 {
            let share = f64::from(tenths) / 5.0;
            only(&seaglider, net_mass_kg, pitch_deg, 50.0 * share, 0.0);
            only(&slocum, net_mass_kg, pitch_deg, 0.0, 0.5 * share);
        }
    }
}
