//! A whole passage flown: velocities and depth at every sample, as instruments and filter show them. Knows no residuals.

use super::flyer::Flyer;
use super::moment::{Moment, sink};
use super::step::advance;
use super::{AFLOAT_DBAR, Passage, is_start};
use crate::Number;
use crate::dynamics::Parameters;
use crate::glide::{Attitude, Deflection};
use crate::identify::model::{sink_read_m_s, surroundings, true_pitch_rad};
use crate::log::Observation;

/// A passage as flown: velocities along axes 1 and 3 at each sample, and the way down since the passage began.
pub(super) struct Flight<T> {
    pub(super) velocity: Vec<[T; 2]>,
    way_down_m: Vec<T>,
    /// How often the flight began anew before a sample: a filter does not look across.
    begun: Vec<u32>,
}

impl<T: Number> Flight<T> {
    /// Downward velocity as the pressure sensor and the filter show it, and speed; nothing where the flight broke off.
    pub(super) fn at(&self, passage: &Passage, parameters: &Parameters<T>, i: usize) -> Option<(T, T)> {
        let (low, high) = passage.windows[i];
        if low == high || self.begun[low] != self.begun[high] {
            return None;
        }
        // The slope of the least-squares line through the depths of the window.
        let time = |k: usize| passage.observations[k].time_s - passage.observations[i].time_s;
        let n = (high - low + 1) as f64;
        let mean = (low..=high).map(time).sum::<f64>() / n;
        let spread: f64 = (low..=high).map(|k| (time(k) - mean).powi(2)).sum();
        let mut slope = T::constant(0.0);
        for k in low..=high {
            slope += (self.way_down_m[k] - self.way_down_m[i]) * ((time(k) - mean) / spread);
        }
        let [v1, v3] = self.velocity[i];
        let speed = (v1 * v1 + v3 * v3).sqrt();
        let sink = sink_read_m_s(parameters, slope, passage.observations[i].sink_rate_m_s2);
        (sink.value().is_finite() && speed.value().is_finite()).then_some((sink, speed))
    }
}

pub(super) fn fly<T: Number>(flyer: &Flyer<T>, passage: &Passage) -> Flight<T> {
    let n = passage.observations.len();
    let mut flight =
        Flight { velocity: Vec::with_capacity(n), way_down_m: Vec::with_capacity(n), begun: Vec::with_capacity(n) };
    let mut velocity = [T::constant(0.0); 2];
    let mut down = T::constant(0.0);
    let mut begun = 0;
    // The rates at the end of a step are those at the beginning of the next.
    let mut rates: Option<[T; 2]> = None;
    let mut here = Moment::at(passage, 0);
    for i in 0..n {
        let next = Moment::at(passage, i);
        if is_start(&passage.observations, i) {
            velocity = begin(flyer, &passage.observations[i]);
            rates = None;
            begun += 1;
        } else {
            let before = sink(&flyer.lifted, &here, velocity);
            match advance(flyer, &here, &next, velocity, rates) {
                Some((there, way_down, at_the_end)) => {
                    (velocity, rates) = (there, Some(at_the_end));
                    down += way_down;
                }
                None => {
                    // No solution: the flight goes on from rest, and a gap tells the filter.
                    velocity = [T::constant(REST_M_S), T::constant(0.0)];
                    rates = None;
                    down += before * (next.time_s - here.time_s);
                    begun += 1;
                }
            }
        }
        here = next;
        flight.velocity.push(velocity);
        flight.way_down_m.push(down);
        flight.begun.push(begun);
    }
    flight
}

/// Speed of a glider at rest \[m/s\]: the angle of attack has no value at none.
const REST_M_S: f64 = 1e-3;

/// At rest where it floats, or where no steady glide exists; in a steady glide otherwise.
fn begin<T: Number>(flyer: &Flyer<T>, observed: &Observation) -> [T; 2] {
    let rest = [T::constant(REST_M_S), T::constant(0.0)];
    if observed.pressure_dbar < AFLOAT_DBAR {
        return rest;
    }
    let p = &flyer.lifted;
    let water = surroundings(p, observed);
    let attitude = Attitude {
        pitch_rad: true_pitch_rad(p, observed.pitch_rad),
        net_mass_kg: p.net_mass_kg(T::constant(observed.ballast_m3), &water),
    };
    let straight = Deflection { roll_rad: T::constant(0.0), rudder_rad: T::constant(0.0) };
    match flyer.glider.flight(&water, attitude, straight, None) {
        Ok(glide) => {
            let (sin, cos) = glide.angle_of_attack_rad.sin_cos();
            [glide.speed_m_s * cos, glide.speed_m_s * sin]
        }
        Err(_) => rest,
    }
}
