//! A speed sensor that loses the water for a leg.
//!
//! A Doppler log that takes something else for the water, a propeller with weed in it: on one leg the measured speed is not
//! that of the others, while pressure and pitch say that the glider flew as always. Along the path `w = U sin(path)`, and the
//! path is steeper than the pitch by some degrees of angle of attack, so `U sin(pitch)/w` is a little below 1, and much the
//! same on all descents and on all ascents. A leg on which it is another has no measured speed.
//!
//! Knows samples and legs; nothing of vehicles: what a whole log's speed is wrong by, a diagnosis has to find.

use super::median;
use super::observation::Observation;

/// Departure from the other legs below which it may be the range of pitch flown, or the water.
const LEAST_DEPARTURE: f64 = 0.2;

/// The same in standard deviations of the legs, by their median deviation.
const BEYOND_SCATTER: f64 = 8.0;

/// Standard deviation over median deviation of normal numbers.
const SD_PER_MEDIAN: f64 = 1.4826;

/// Fewest legs of a direction that say what is typical, and the largest share of them that can have lost it.
const FEWEST_LEGS: usize = 6;
const LARGEST_SHARE: f64 = 0.25;

/// Fewest samples with a speed on a leg, and the least slope and vertical velocity at which they say anything.
const FEWEST_SAMPLES: usize = 3;
const LEAST_PITCH_RAD: f64 = 0.1;
const LEAST_SINK_M_S: f64 = 0.03;

/// Takes out the speeds of legs on which the sensor had lost the water; what was taken out, in a sentence for each.
pub fn take_out_lost_speeds(observations: &mut [Observation]) -> Vec<String> {
    let mut warnings = Vec::new();
    for descends in [true, false] {
        let legs = of_legs(observations, descends);
        let Some(typical) = typical(&legs) else { continue };
        for leg in legs.iter().filter(|leg| typical.is_left_by(leg.ratio)) {
            let of_leg = observations.iter_mut().filter(|o| o.leg == leg.leg && o.dive == leg.dive);
            of_leg.for_each(|o| o.speed_m_s = f64::NAN);
            let departure = leg.ratio / typical.ratio - 1.0;
            warnings.push(format!(
                "measured speed on the {} of dive {}, {:.2} h after the start, {:.0} % {} than pitch and vertical velocity ask for on the other {} like it: left out there",
                if descends { "descent" } else { "ascent" },
                leg.dive + 1,
                leg.time_s / 3600.0,
                100.0 * departure.abs(),
                if departure < 0.0 { "less" } else { "more" },
                legs.len() - 1,
            ));
        }
    }
    warnings
}

/// What one leg has.
struct OfLeg {
    leg: u32,
    dive: u32,
    time_s: f64,
    /// `U sin(pitch)/w`.
    ratio: f64,
}

/// The legs of a direction on which a speed was measured in steady glide.
fn of_legs(observations: &[Observation], descends: bool) -> Vec<OfLeg> {
    let says = |o: &&Observation| {
        let (pitch, sink) = if descends { (-o.pitch_rad, o.sink_m_s) } else { (o.pitch_rad, -o.sink_m_s) };
        o.steady && o.speed_m_s.is_finite() && pitch > LEAST_PITCH_RAD && sink > LEAST_SINK_M_S
    };
    let by_leg = observations.chunk_by(|a, b| a.leg == b.leg && a.dive == b.dive);
    let of_leg = |leg: &[Observation]| {
        let samples: Vec<&Observation> = leg.iter().filter(says).collect();
        let measured: f64 = samples.iter().map(|o| o.speed_m_s).sum();
        let asked_for: f64 = samples.iter().map(|o| o.sink_m_s.abs() / o.pitch_rad.abs().sin()).sum();
        let first = samples.first()?;
        (samples.len() >= FEWEST_SAMPLES).then(|| OfLeg {
            leg: first.leg,
            dive: first.dive,
            time_s: first.time_s,
            ratio: measured / asked_for,
        })
    };
    by_leg.filter_map(of_leg).collect()
}

/// Typical values on the legs of a direction.
struct Typical {
    ratio: f64,
    departure: f64,
}

impl Typical {
    fn is_left_by(&self, ratio: f64) -> bool {
        (ratio / self.ratio - 1.0).abs() > self.departure
    }
}

/// Typical values, and by how much a leg must depart from it; nothing where too few legs say so, or too many depart.
fn typical(legs: &[OfLeg]) -> Option<Typical> {
    if legs.len() < FEWEST_LEGS {
        return None;
    }
    let ratio = median(&mut legs.iter().map(|leg| leg.ratio).collect::<Vec<_>>());
    let scatter = median(&mut legs.iter().map(|leg| (leg.ratio / ratio - 1.0).abs()).collect::<Vec<_>>());
    let typical = Typical { ratio, departure: LEAST_DEPARTURE.max(BEYOND_SCATTER * SD_PER_MEDIAN * scatter) };
    let lost = legs.iter().filter(|leg| typical.is_left_by(leg.ratio)).count();
    (lost as f64 <= LARGEST_SHARE * legs.len() as f64).then_some(typical)
}
