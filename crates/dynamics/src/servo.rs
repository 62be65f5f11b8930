//! How a servo goes to its set-point: of first order at a limited speed, of second order at a limited speed that it takes up
//! smoothly, and when either leaves its limit.
//!
//! Knows distances, speeds and limits; no vehicle.

use glidepolar_number::{Number, functions};

/// Bandwidth of the servos \[1/s\]: the speed that a servo asks for, below its largest rate, is this times the way to its
/// set-point. The ballast has that speed at once and is of first order; the moving mass takes it up first and is of second
/// order, `r'' = 4 (sat((command - r) 1) - r')`, critically damped.
const SERVO_RATE_1_S: f64 = 1.0;

/// Bandwidth with which the moving mass takes up the speed that its servo asks for \[1/s\].
const SERVO_SPEED_RATE_1_S: f64 = 4.0;

/// Speed that a servo of first order has, so far from its set-point.
pub fn servo_speed<T: Number>(to_go: T, limit: T) -> T {
    (to_go * SERVO_RATE_1_S).held_within(-limit, limit)
}

/// Acceleration of a servo of second order: it takes up the speed that its distance to the set-point asks for.
pub fn servo_acceleration<T: Number>(to_go: T, speed: T, limit: T) -> T {
    (servo_speed(to_go, limit) - speed) * SERVO_SPEED_RATE_1_S
}

/// In which time a servo of first order, so far from its set-point, leaves its largest rate \[s\]; zero or less where it does
/// not run at it.
pub fn servo_bend_s(to_go: f64, limit: f64) -> f64 {
    to_go.abs() / limit - 1.0 / SERVO_RATE_1_S
}

/// The same of a servo of second order, at this speed.
pub fn slow_servo_bend_s(to_go: f64, speed: f64, limit: f64) -> f64 {
    let at_limit = to_go.abs() - limit / SERVO_RATE_1_S;
    if at_limit <= 0.0 {
        return 0.0;
    }
    // The speed nears its limit as exp(-k t): at_limit = limit t - lag (1 - exp(-k t)), solved by fixed point.
    let lag = (limit - speed * to_go.signum()) / SERVO_SPEED_RATE_1_S;
    let mut in_s = at_limit / limit;
    for _ in 0..20 {
        in_s = (at_limit + lag * (1.0 - functions::exp(-SERVO_SPEED_RATE_1_S * in_s))) / limit;
    }
    in_s
}

/// Two functions that are zero where a servo so far from its set-point reaches or leaves its largest rate, in either
/// direction.
pub fn servo_corner<T: Number>(to_go: T, limit: T) -> [T; 2] {
    let share = to_go * SERVO_RATE_1_S / limit;
    [share + 1.0, -share + 1.0]
}
