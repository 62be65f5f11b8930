//! The servos of ballast, moving mass, roll mass and rudder: how far each has to go, and when its rate bends.

use glidepolar_dynamics::servo::{servo_bend_s, servo_corner, slow_servo_bend_s};
use glidepolar_number::Number;

use super::lateral::Body;
use super::state::{Inputs, State};

/// When the next of the servos comes so near to its set-point that it leaves its largest rate, if one runs at it \[s\]: there
/// the rates of change bend. Foreseen as if the set-points stood still.
pub fn next_bend_s(body: &Body<f64>, time_s: f64, state: &State<f64>, inputs: &Inputs<f64>) -> Option<f64> {
    let ([ballast, mass, roll, rudder], limits) = (ways_to_go(body, state, inputs), largest_rates(body));
    let bends = [
        servo_bend_s(ballast, limits[0]),
        slow_servo_bend_s(mass, state.moving_mass_speed_m_s, limits[1]),
        slow_servo_bend_s(roll, state.roll_mass_rate_rad_s, limits[2]),
        servo_bend_s(rudder, limits[3]),
    ];
    bends.into_iter().filter(|in_s| *in_s > 0.0).min_by(f64::total_cmp).map(|in_s| time_s + in_s)
}

/// Functions that are zero where a servo reaches or leaves its largest rate, in either direction: of ballast, moving mass,
/// roll mass and rudder. There the rates of change have a kink.
pub fn servo_corners<T: Number>(body: &Body<T>, state: &State<T>, inputs: &Inputs<T>) -> [T; 8] {
    let (ways, limits) = (ways_to_go(body, state, inputs), largest_rates(body));
    let [[a, b], [c, d], [e, f], [g, h]] = std::array::from_fn(|i| servo_corner(ways[i], limits[i]));
    [a, b, c, d, e, f, g, h]
}

/// How far ballast, moving mass, roll mass and rudder are from their set-points.
pub(super) fn ways_to_go<T: Number>(body: &Body<T>, state: &State<T>, inputs: &Inputs<T>) -> [T; 4] {
    let (p, l) = (&body.plane, &body.lateral);
    let to = |target: T, low: T, high: T, at: T| target.held_within(low, high) - at;
    let volume = p.ballast_m3(state.ballast_mass_kg);
    [
        to(inputs.ballast_command_m3, p.ballast_min_m3, p.ballast_max_m3, volume),
        to(inputs.moving_mass_command_m, p.moving_mass_min_m, p.moving_mass_max_m, state.moving_mass_m),
        to(inputs.roll_mass_command_rad, l.roll_mass_min_rad, l.roll_mass_max_rad, state.roll_mass_rad),
        to(inputs.rudder_command_rad, l.rudder_min_rad, l.rudder_max_rad, state.rudder_rad),
    ]
}

/// Largest rates of the servos, in the order of [`ways_to_go`].
fn largest_rates<T: Number>(body: &Body<T>) -> [T; 4] {
    let (p, l) = (&body.plane, &body.lateral);
    [p.ballast_rate_m3_s, p.moving_mass_rate_m_s, l.roll_mass_rate_rad_s, l.rudder_rate_rad_s]
}
