//! A turn of Seawing against an integration of the paper's equations in another language and in other variables
//! (`tests/python/six_degrees.py`).

mod support;

use glidepolar_spatial::{Inputs, N_STATES, State, fly};
use support::seawing;

#[test]
fn over_a_whole_turn_it_is_where_the_independent_integration_is() {
    let table = include_str!("reference/seawing_turn.csv");
    let rows: Vec<Vec<f64>> =
        table.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 21);
    let (body, first) = (seawing(), &rows[0]);
    let mut state = State {
        depth_m: first[3],
        pitch_rad: first[5],
        v1_m_s: first[7],
        v2_m_s: first[8],
        v3_m_s: first[9],
        moving_mass_m: 0.4216,
        roll_mass_rad: -45f64.to_radians(),
        ballast_mass_kg: 0.3,
        ..State::from_array([0.0; N_STATES])
    };
    let inputs = Inputs {
        moving_mass_command_m: 0.4216,
        roll_mass_command_rad: -45f64.to_radians(),
        ballast_command_m3: body.plane.ballast_m3(0.3),
        ..Inputs::still_water(1025.0, 15.0)
    };
    for pair in rows.windows(2) {
        fly(&body, &inputs, (pair[0][0], pair[1][0]), &mut state, 1e-12).unwrap();
        for (expected, found) in pair[1][1..].iter().zip(state.as_array()) {
            let difference = (found - expected).abs() / f64::max(1.0, expected.abs());
            assert!(difference < 1e-7, "{found} against {expected} at {} s: {state:?}", pair[1][0]);
        }
    }
    assert!(state.heading_rad > 2.0 * std::f64::consts::PI, "a whole turn: {}", state.heading_rad);
}
