//! How carriage and planar motion mechanism move the moment centre: rest, run-up, steady or periodic part, braking,
//! rest. Tank axes: X along the tank, Y to starboard of it, heading positive bow to starboard. Knows kinematics only.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

/// What a run is; the `kind` column of `runs.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Model at rest.
    Zero,
    /// Strut alone under way.
    Tare,
    /// Fixed yaw angle.
    Static,
    /// Pure sway.
    Sway,
    /// Pure yaw: the heading follows the path.
    Yaw,
    /// Constant-radius turn.
    Arc,
}

impl Kind {
    /// As written in `runs.csv`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::Tare => "tare",
            Self::Static => "static",
            Self::Sway => "sway",
            Self::Yaw => "yaw",
            Self::Arc => "arc",
        }
    }
}

/// What the mechanism was commanded to do.
#[derive(Debug, Clone, Copy)]
pub(super) struct Command {
    pub kind: Kind,
    pub speed_m_s: f64,
    /// Fixed yaw angle, static and tare.
    pub yaw_deg: f64,
    /// Greatest excursion to the side, sway and yaw.
    pub sway_amplitude_m: f64,
    pub frequency_hz: f64,
    /// Positive to starboard, arc.
    pub radius_m: f64,
    /// Longest steady part of a drift run; length of a zero run, s.
    pub hold_s: f64,
}

/// When each part of a run begins, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Times {
    pub start: f64,
    pub up_to_speed: f64,
    /// From here to `steady_to`: steady or periodic in full.
    pub steady_from: f64,
    pub steady_to: f64,
    /// Begin of braking.
    pub brake: f64,
    pub stopped: f64,
    pub end: f64,
}

/// Where the moment centre is heading.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Motion {
    /// Velocity and acceleration along and across the tank.
    pub velocity: (f64, f64),
    pub acceleration: (f64, f64),
    pub heading: f64,
    pub r: f64,
    pub rdot: f64,
    /// What speed, yaw and sway columns show when nothing disturbs them: m/s, deg, m.
    pub shown: (f64, f64, f64),
}

impl Command {
    /// Frequency in rad/s.
    fn omega(&self) -> f64 {
        TAU * self.frequency_hz
    }

    /// Greatest heading of a pure yaw run, degrees.
    pub(super) fn yaw_amplitude_deg(&self) -> f64 {
        (self.sway_amplitude_m * self.omega() / self.speed_m_s).atan().to_degrees()
    }

    /// The run's time table: about 70 m of a 90 m tank at most.
    pub(super) fn times(&self) -> Times {
        if self.kind == Kind::Zero {
            // Never starts within the record.
            return Times {
                start: self.hold_s,
                up_to_speed: self.hold_s + 1.0,
                steady_from: 0.0,
                steady_to: self.hold_s,
                brake: self.hold_s + 2.0,
                stopped: self.hold_s + 3.0,
                end: self.hold_s,
            };
        }
        let ramp = 0.75 + 1.4 * self.speed_m_s;
        let start = 3.0;
        let up_to_speed = start + ramp;
        let (build_up, steady, fade) = match self.kind {
            Kind::Sway | Kind::Yaw => (4.0, 25.0, 3.0),
            Kind::Arc => (1.0, if self.speed_m_s > 1.5 { 11.0 } else { 14.0 }, 0.0),
            _ => (0.0, (54.0 / self.speed_m_s).min(self.hold_s), 0.0),
        };
        let steady_from = up_to_speed + build_up;
        let steady_to = steady_from + steady;
        let brake = steady_to + fade;
        let stopped = brake + 0.75 * ramp;
        Times { start, up_to_speed, steady_from, steady_to, brake, stopped, end: stopped + 2.0 }
    }
}

/// The mechanism during one run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mechanism {
    command: Command,
    times: Times,
    /// Heading at the start of an arc, so that it is symmetrical about the tank's axis.
    first_heading: f64,
}

impl Mechanism {
    pub(super) fn new(command: Command) -> Self {
        let times = command.times();
        let mut mechanism = Self { command, times, first_heading: 0.0 };
        if command.kind == Kind::Arc {
            mechanism.first_heading = -0.5 * mechanism.arc(times.end, 0.0, 0.0).heading;
        }
        mechanism
    }

    /// Share of the set speed and its rate at `time`: smooth up and smooth down.
    pub(super) fn throttle(&self, time: f64) -> (f64, f64) {
        let t = &self.times;
        if time < t.brake {
            let duration = t.up_to_speed - t.start;
            let (share, rate) = smooth((time - t.start) / duration);
            (share, rate / duration)
        } else {
            let duration = t.stopped - t.brake;
            let (share, rate) = smooth((time - t.brake) / duration);
            (1.0 - share, -rate / duration)
        }
    }

    /// Motion at `time` with the carriage (for an arc: the model along its path) at `speed`, gaining `speed_rate`.
    pub(super) fn at(&self, time: f64, speed: f64, speed_rate: f64) -> Motion {
        let command = &self.command;
        match command.kind {
            Kind::Zero | Kind::Tare | Kind::Static => Motion {
                velocity: (speed, 0.0),
                acceleration: (speed_rate, 0.0),
                heading: command.yaw_deg.to_radians(),
                shown: (speed, command.yaw_deg, 0.0),
                ..Motion::default()
            },
            Kind::Sway => {
                let y = self.excursion(time);
                Motion {
                    velocity: (speed, y[1]),
                    acceleration: (speed_rate, y[2]),
                    shown: (speed, 0.0, y[0]),
                    ..Motion::default()
                }
            }
            Kind::Yaw => {
                // Heading along the path at the set speed: tan(heading) = Y' / U.
                let y = self.excursion(time);
                let [p, p1, p2] = [y[1], y[2], y[3]].map(|value| value / command.speed_m_s);
                let heading = p.atan();
                let squeeze = 1.0 / (1.0 + p * p);
                let r = p1 * squeeze;
                Motion {
                    velocity: (speed, y[1]),
                    acceleration: (speed_rate, y[2]),
                    heading,
                    r,
                    rdot: p2 * squeeze - 2.0 * p * r * r,
                    shown: (speed, heading.to_degrees(), y[0]),
                }
            }
            Kind::Arc => self.arc(time, speed, speed_rate),
        }
    }

    /// Excursion to the side and its first three derivatives: a sine that fades in and out.
    fn excursion(&self, time: f64) -> [f64; 4] {
        let t = &self.times;
        let (envelope, scale) = if time < t.steady_from {
            let duration = t.steady_from - t.up_to_speed;
            (fade((time - t.up_to_speed) / duration), 1.0 / duration)
        } else {
            let duration = t.brake - t.steady_to;
            let mut down = fade((time - t.steady_to) / duration).map(|value| -value);
            down[0] += 1.0;
            (down, 1.0 / duration)
        };
        let [e0, e1, e2, e3] =
            [envelope[0], envelope[1] * scale, envelope[2] * scale.powi(2), envelope[3] * scale.powi(3)];
        let w = self.command.omega();
        let (sine, cosine) = (w * (time - t.up_to_speed)).sin_cos();
        let [s0, s1, s2, s3] = [sine, w * cosine, -w * w * sine, -w * w * w * cosine];
        [
            e0 * s0,
            e1 * s0 + e0 * s1,
            e2 * s0 + 2.0 * e1 * s1 + e0 * s2,
            e3 * s0 + 3.0 * e2 * s1 + 3.0 * e1 * s2 + e0 * s3,
        ]
        .map(|value| value * self.command.sway_amplitude_m)
    }

    /// A turn at constant radius: the path's curvature builds up during the second half of the run-up.
    fn arc(&self, time: f64, speed: f64, speed_rate: f64) -> Motion {
        let t = &self.times;
        let rate = self.command.speed_m_s / self.command.radius_m;
        let begin = 0.5 * (t.start + t.up_to_speed);
        let build = t.steady_from - begin;
        let cease = t.stopped - t.steady_to;
        let (share, share_rate, turned) = if time < t.steady_to {
            let x = ((time - begin) / build).clamp(0.0, 1.0);
            let [e, e1, ..] = fade(x);
            // The integral of the fade, and full rate after it.
            (e, e1 / build, build * fade_integral(x) + (time - t.steady_from).max(0.0))
        } else {
            let x = ((time - t.steady_to) / cease).clamp(0.0, 1.0);
            let [e, e1, ..] = fade(x);
            let before = 0.5 * build + t.steady_to - t.steady_from;
            (1.0 - e, -e1 / cease, before + cease * (x - fade_integral(x)))
        };
        let (r, rdot) = (rate * share, rate * share_rate);
        let heading = self.first_heading + rate * turned;
        let (sine, cosine) = heading.sin_cos();
        Motion {
            velocity: (speed * cosine, speed * sine),
            acceleration: (speed_rate * cosine - speed * r * sine, speed_rate * sine + speed * r * cosine),
            heading,
            r,
            rdot,
            shown: (speed, 0.0, 0.0),
        }
    }
}

/// 0 to 1 with two continuous derivatives: value and slope.
fn smooth(x: f64) -> (f64, f64) {
    if x <= 0.0 {
        (0.0, 0.0)
    } else if x >= 1.0 {
        (1.0, 0.0)
    } else {
        (x * x * x * (10.0 + x * (6.0 * x - 15.0)), 30.0 * x * x * (1.0 - x) * (1.0 - x))
    }
}

/// 0 to 1 with three continuous derivatives: value and the three.
fn fade(x: f64) -> [f64; 4] {
    if x <= 0.0 {
        return [0.0; 4];
    }
    if x >= 1.0 {
        return [1.0, 0.0, 0.0, 0.0];
    }
    let x2 = x * x;
    [
        x2 * x2 * (35.0 + x * (-84.0 + x * (70.0 - 20.0 * x))),
        140.0 * x2 * x * (1.0 - x).powi(3),
        420.0 * x2 * (1.0 - x).powi(2) * (1.0 - 2.0 * x),
        840.0 * x * (1.0 - x) * (1.0 - 5.0 * x + 5.0 * x2),
    ]
}

/// Integral of [`fade`] from 0 to `x`, `x` within 0 and 1.
fn fade_integral(x: f64) -> f64 {
    x.powi(5) * (7.0 + x * (-14.0 + x * (10.0 - 2.5 * x)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMMAND: Command = Command {
        kind: Kind::Static,
        speed_m_s: 2.0,
        yaw_deg: 8.0,
        sway_amplitude_m: 0.3,
        frequency_hz: 0.2,
        radius_m: -10.0,
        hold_s: 25.0,
    };

    /// Every rate that the mechanism hands out is the derivative of what it should be the rate of.
    #[test]
    fn rates_are_derivatives() {
        for kind in [Kind::Static, Kind::Sway, Kind::Yaw, Kind::Arc] {
            let mechanism = Mechanism::new(Command { kind, ..COMMAND });
            let motion = |time: f64| {
                let (share, rate) = mechanism.throttle(time);
                mechanism.at(time, 2.0 * share, 2.0 * rate)
            };
            let (mut time, h) = (0.05, 1e-5);
            while time < mechanism.times.end {
                let (before, now, after) = (motion(time - h), motion(time), motion(time + h));
                let check = |from: f64, to: f64, rate: f64, what: &str| {
                    let slope = (to - from) / (2.0 * h);
                    assert!((slope - rate).abs() < 2e-5, "{kind:?} at {time}: {what} {slope} against {rate}");
                };
                check(before.velocity.0, after.velocity.0, now.acceleration.0, "X");
                check(before.velocity.1, after.velocity.1, now.acceleration.1, "Y");
                check(before.heading, after.heading, now.r, "heading");
                check(before.r, after.r, now.rdot, "r");
                if kind != Kind::Arc {
                    check(before.shown.2, after.shown.2, now.velocity.1, "sway");
                }
                time += 0.173;
            }
        }
    }

    /// In pure yaw and on an arc nothing drifts sideways; on the arc the turn has its radius and its sides are equal.
    #[test]
    fn heading_follows_the_path() {
        for kind in [Kind::Yaw, Kind::Arc] {
            let mechanism = Mechanism::new(Command { kind, ..COMMAND });
            let t = mechanism.times;
            let mut time = t.up_to_speed;
            while time < t.brake {
                let motion = mechanism.at(time, 2.0, 0.0);
                let sideways = motion.velocity.1 * motion.heading.cos() - motion.velocity.0 * motion.heading.sin();
                assert!(sideways.abs() < 1e-12);
                if kind == Kind::Arc && (t.steady_from..t.steady_to).contains(&time) {
                    assert!((2.0 / motion.r + 10.0).abs() < 1e-9);
                }
                time += 0.31;
            }
        }
        let at_rest = Mechanism::new(Command { kind: Kind::Arc, ..COMMAND });
        assert!(at_rest.at(0.0, 0.0, 0.0).heading > 0.0, "a turn to port begins bow to starboard");
    }
}
