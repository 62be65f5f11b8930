//! What a glider draws from its battery, term by term: the one account of plans, simulations and the FMU.
//! ```text
//! E = hotel T  +  (k2 + k1 P) dV  +  rudder T_w + move N_m  +  surfacing N_s
//! ```
//! `T` is the time, `T_w` that under water, `dV` the volume pumped out at the gauge pressure `P`, `N_m` the moves of the moving
//! mass, `N_s` the surfacings. The account is linear in all of these: per dive a plan has it from a dive's counts, and the
//! equations of motion have the power from the same counts per second.
//!
//! The equations know no moves, only a servo. A move takes the mass from rest to a speed and back to rest. Half of it is counted
//! while the speed rises and half while it falls, each change of `u`, the speed over the servo's largest, with the weight
//! `693/256 (1 - u^2)^5` ([`moves_1_s`]). The weight's integral from 0 to 1 is 1, most of it at low speed. So a displacement that
//! takes a second or more at the largest speed is one move within half a per cent, and one of a tenth of that a fifth of a move.

use glidepolar_number::Number;

use super::parameters::Parameters;
use super::servo::servo_acceleration;

/// What was used in some time; or, each per second, what is being used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Usage<T> {
    /// Time \[s\].
    pub time_s: T,
    /// That of it with the hull under water \[s\].
    pub under_water_s: T,
    /// Volume pumped out \[m3\].
    pub pumped_m3: T,
    /// Gauge pressure that it was pumped out against \[Pa\].
    pub pressure_Pa: T,
    /// Moves of the moving mass.
    pub pitch_moves: T,
    /// Surfacings.
    pub surfacings: T,
}

/// Energy by what took it \[J\]; or, of a usage per second, power \[W\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energy<T> {
    /// Everything that runs all the time.
    pub hotel_J: T,
    /// The pump.
    pub pump_J: T,
    /// Rudder and moving mass.
    pub steering_J: T,
    /// Fixes and calls.
    pub surfacing_J: T,
}

impl<T: Number> Usage<T> {
    /// Nothing.
    pub fn none() -> Self {
        let zero = T::constant(0.0);
        Usage {
            time_s: zero,
            under_water_s: zero,
            pumped_m3: zero,
            pressure_Pa: zero,
            pitch_moves: zero,
            surfacings: zero,
        }
    }

    /// What this takes from the battery of a glider.
    pub fn energy(&self, parameters: &Parameters<T>) -> Energy<T> {
        let p = parameters;
        Energy {
            hotel_J: p.hotel_W * self.time_s,
            pump_J: (p.pump_J_per_m3 + p.pump_J_per_Pa_m3 * self.pressure_Pa) * self.pumped_m3,
            steering_J: p.rudder_W * self.under_water_s + p.pitch_move_J * self.pitch_moves,
            surfacing_J: p.surfacing_J * self.surfacings,
        }
    }
}

impl<T: Number> Energy<T> {
    /// All of it.
    pub fn total_J(&self) -> T {
        self.hotel_J + self.pump_J + self.steering_J + self.surfacing_J
    }

    /// This and another, term by term.
    #[must_use]
    pub fn plus(&self, other: &Energy<T>) -> Self {
        Energy {
            hotel_J: self.hotel_J + other.hotel_J,
            pump_J: self.pump_J + other.pump_J,
            steering_J: self.steering_J + other.steering_J,
            surfacing_J: self.surfacing_J + other.surfacing_J,
        }
    }
}

/// Moves per second of a servo with this largest speed, at this speed and acceleration.
pub fn moves_1_s<T: Number>(acceleration: T, speed: T, largest_speed: T) -> T {
    let u = speed / largest_speed;
    let rest = (-u * u + 1.0).at_least(0.0);
    let fifth_power = rest * rest * rest * rest * rest;
    fifth_power * (0.5 * WEIGHT) * acceleration.abs() / largest_speed
}

/// Over the integral of `(1 - u^2)^5` from 0 to 1.
const WEIGHT: f64 = 693.0 / 256.0;

/// Moves that a servo with this largest speed makes of one displacement from rest to rest: one, or less where it is small.
pub fn moves_over(way: f64, largest_speed: f64) -> f64 {
    /// A hundredth of the servo's own time.
    const STEP_S: f64 = 2.5e-3;
    /// Ten seconds: the largest speed is reached in 2.3 s, and a short way is half gone before.
    const MOST_STEPS: usize = 4000;
    let is_way = |value: f64| value.is_finite() && value > 0.0;
    if !is_way(way) || !is_way(largest_speed) {
        return 0.0;
    }
    let (mut to_go, mut speed, mut moves) = (way, 0.0, 0.0);
    for _ in 0..MOST_STEPS {
        let acceleration = servo_acceleration(to_go, speed, largest_speed);
        if acceleration <= 0.0 || speed > 0.9999 * largest_speed {
            return moves;
        }
        let middle = speed + 0.5 * acceleration * STEP_S;
        // As much again when it slows down.
        moves += 2.0 * moves_1_s(acceleration, middle, largest_speed) * STEP_S;
        speed += acceleration * STEP_S;
        to_go -= middle * STEP_S;
    }
    moves
}

/// Seconds under water per second at a depth: 1 or 0. The change is where the surface is met, which is an event.
pub fn under_water<T: Number>(depth_m: T) -> T {
    T::constant(if depth_m.value() > 0.0 { 1.0 } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_term_is_its_figure_times_its_count() {
        let p = Parameters {
            hotel_W: 0.5,
            rudder_W: 0.1,
            pump_J_per_m3: 2e6,
            pump_J_per_Pa_m3: 2.0,
            pitch_move_J: 30.0,
            surfacing_J: 500.0,
            ..Parameters::default()
        };
        let usage = Usage {
            time_s: 1000.0,
            under_water_s: 900.0,
            pumped_m3: 4e-4,
            pressure_Pa: 1e6,
            pitch_moves: 3.0,
            surfacings: 0.5,
        };
        let energy = usage.energy(&p);
        let expected = Energy { hotel_J: 500.0, pump_J: 1600.0, steering_J: 90.0 + 90.0, surfacing_J: 250.0 };
        assert_eq!(energy, expected);
        assert_eq!(energy.total_J(), 2530.0);
        assert_eq!(energy.plus(&Usage::none().energy(&p)), energy);
    }

    /// Moves of a servo over a way, by its own equation in small steps.
    fn moves(way_m: f64, rate_m_s: f64) -> f64 {
        let (step_s, mut at_m, mut speed, mut moves) = (1e-3, 0.0, 0.0, 0.0);
        for _ in 0..60_000 {
            let acceleration = servo_acceleration(way_m - at_m, speed, rate_m_s);
            moves += moves_1_s(acceleration, speed, rate_m_s) * step_s;
            speed += acceleration * step_s;
            at_m += speed * step_s;
        }
        assert!((at_m - way_m).abs() < 1e-6);
        assert!((moves_over(way_m, rate_m_s) - moves).abs() < 5e-3, "{} against {moves}", moves_over(way_m, rate_m_s));
        moves
    }

    #[test]
    fn a_move_counts_as_one_however_far_and_a_small_correction_by_its_speed() {
        for ways in [1.0, 3.0, 6.0, 20.0] {
            let count = moves(0.02 * ways, 0.02);
            assert!((count - 1.0).abs() < 0.01, "{ways} s of the largest speed: {count}");
        }
        let count = moves(0.02 * 0.1, 0.02);
        assert!((0.18..0.22).contains(&count), "{count}");
    }
}
