//! Averages of steady samples over stretches of one leg, about a minute long: long against the filter of the vertical
//! velocity, short against a leg. A log of fewer rows than a bin needs in a minute has longer ones.
//!
//! The filter makes neighbouring samples say the same thing again, in a way that no simple law of noise describes; bins say
//! it once. A measured speed that comes more rarely than the rows is the mean of those that the bin has, however few: the
//! model's speed is compared at their times ([`Parts`](super::Parts)).

use crate::log::Observation;

/// Length of a bin where the log is short enough \[s\].
const BIN_S: f64 = 60.0;

/// Standard error of a vertical velocity that comes without one, in a table of whole legs \[m/s\]. It only weighs rows
/// against each other; their scatter is estimated.
const USUAL_SE_M_S: f64 = 0.003;

/// Scatter of one measured speed, at least \[m/s\].
const LEAST_SPEED_SD_M_S: f64 = 0.03;

/// Longest bin of a log that is sampled rarely \[s\]: pitch, water and net mass change along a leg in tens of minutes.
const LONGEST_BIN_S: f64 = 600.0;

/// A stretch of steady glide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Means of its samples; roll and rudder are root mean squares, since drag goes by their squares. What was not
    /// measured is NaN.
    pub mean: Observation,
    /// Which they are, of those that were put into bins.
    pub first: usize,
    /// How many they are.
    pub samples: usize,
    /// How many of them have a measured speed.
    pub speeds: usize,
    /// Standard deviation of the mean vertical velocity, by its measurement alone \[m/s\].
    pub sink_sd_m_s: f64,
    /// Standard deviation of the mean speed, by its measurement alone \[m/s\].
    pub speed_sd_m_s: f64,
}

/// The bins of steady samples in the order of time, at most about `most` of them, none of fewer than `least_samples`
/// unless it is alone on its leg: then it is the mean of a leg already, from a table of glides. A bin is a minute long, or
/// as much longer, up to ten minutes, as so many samples take.
pub fn bins(steady: &[Observation], most: usize, least_samples: usize) -> Vec<Bin> {
    let length_s = BIN_S.max(covered_s(steady) / most.max(1) as f64);
    let mut found = Vec::new();
    let mut start = 0;
    for end in 1..=steady.len() {
        let closes = steady.get(end).is_none_or(|next| {
            let lasts_s = next.time_s - steady[start].time_s;
            next.leg != steady[start].leg
                || lasts_s >= LONGEST_BIN_S.max(length_s)
                || (lasts_s >= length_s && end - start >= least_samples)
        });
        if closes {
            if end - start >= least_samples || is_alone(steady, start) {
                found.push(Bin { first: start, ..bin(&steady[start..end]) });
            }
            start = end;
        }
    }
    found
}

fn is_alone(steady: &[Observation], i: usize) -> bool {
    let leg = steady[i].leg;
    (i == 0 || steady[i - 1].leg != leg) && steady.get(i + 1).is_none_or(|next| next.leg != leg)
}

/// Time spent in steady glide \[s\].
fn covered_s(steady: &[Observation]) -> f64 {
    steady.windows(2).filter(|pair| pair[0].leg == pair[1].leg).map(|pair| pair[1].time_s - pair[0].time_s).sum()
}

fn bin(samples: &[Observation]) -> Bin {
    let n = samples.len() as f64;
    let of = |value: fn(&Observation) -> f64| samples.iter().map(value).sum::<f64>() / n;
    let square_se = of(|o| if o.sink_se_m_s > 0.0 { o.sink_se_m_s.powi(2) } else { USUAL_SE_M_S * USUAL_SE_M_S });
    let mean = mean(samples);
    let speeds = || samples.iter().map(|o| o.speed_m_s).filter(|speed| speed.is_finite());
    let count = speeds().count();
    let n_speeds = count as f64;
    let scatter = speeds().map(|speed| (speed - mean.speed_m_s).powi(2)).sum::<f64>() / n_speeds;
    Bin {
        mean,
        first: 0,
        samples: samples.len(),
        speeds: count,
        sink_sd_m_s: (square_se / n).sqrt().max(1e-4),
        speed_sd_m_s: (scatter.sqrt() / n_speeds.sqrt()).max(LEAST_SPEED_SD_M_S / n_speeds.sqrt()),
    }
}

/// The mean of some samples of a leg; the speed is that of the samples which have one.
pub(super) fn mean(samples: &[Observation]) -> Observation {
    let n = samples.len() as f64;
    let of = |value: fn(&Observation) -> f64| samples.iter().map(value).sum::<f64>() / n;
    let speeds = || samples.iter().map(|o| o.speed_m_s).filter(|speed| speed.is_finite());
    let n_speeds = speeds().count();
    let (sin, cos) = (of(|o| o.heading_rad.sin()), of(|o| o.heading_rad.cos()));
    Observation {
        roll_rad: of(|o| o.roll_rad * o.roll_rad).sqrt(),
        rudder_rad: of(|o| o.rudder_rad * o.rudder_rad).sqrt(),
        heading_rad: sin.atan2(cos),
        speed_m_s: if n_speeds > 0 { speeds().sum::<f64>() / n_speeds as f64 } else { f64::NAN },
        ..samples[0].with(of)
    }
}
