//! Says where a fitted model does not describe the log. The intervals of a fit are those of a model that does; where it misses the speed or
//! the vertical velocity by much, they are none. Knows a fit's errors and what was measured; no cause.

use super::data::Dive;
use super::residuals::Score;
use crate::log::Observation;

/// Share of the measured speed that the model may miss in the mean: a track by dead reckoning is then off by as much of its length.
const MOST_OF_SPEED: f64 = 0.1;

/// Share of the vertical velocity that the model may miss: drag goes with its square, and is off by twice that. Waves and the water's own
/// motion, some mm/s to 2 cm/s over nine samples, stay below it at the 0.1 to 0.2 m/s of gliders.
const MOST_OF_SINK: f64 = 0.2;

/// The warnings about a fit that misses its own samples.
pub(super) fn warnings(score: &Score, dives: &[Dive]) -> Vec<String> {
    let mean_square = |of: fn(&Observation) -> f64| {
        let values = || dives.iter().flat_map(|dive| &dive.observations).map(of).filter(|value| value.is_finite());
        (values().map(|value| value * value).sum::<f64>() / values().count().max(1) as f64).sqrt()
    };
    let mut found = Vec::new();
    let mut add = |missed_m_s: f64, of_m_s: f64, most: f64, what: &str| {
        if missed_m_s.abs() > most * of_m_s {
            found.push(format!(
                "the model does not describe the log: it misses the {what} by {:.0} of {:.0} mm/s; the intervals are those of a model that does. Are units, vehicle and steady samples right? `diagnose` looks for a cause",
                1e3 * missed_m_s.abs(),
                1e3 * of_m_s
            ));
        }
    };
    if let Some(bias_m_s) = score.speed_bias_m_s {
        add(bias_m_s, mean_square(|o| o.speed_m_s), MOST_OF_SPEED, "measured speed in the mean");
    }
    let missed_m_s = score.w_rms_9_point_m_s.unwrap_or(score.w_rms_m_s);
    add(missed_m_s, mean_square(|o| o.sink_m_s), MOST_OF_SINK, "vertical velocity");
    found
}

#[cfg(test)]
mod tests {
    use super::super::by_dive;
    use super::super::tests::{glider, sample};
    use super::*;

    #[test]
    fn a_fit_that_misses_a_tenth_of_the_speed_gets_a_warning() {
        let (_, p) = glider();
        let samples: Vec<Observation> = (0..20).map(|i| sample(&p, -27.0, 0.3, 0, 10.0 * f64::from(i))).collect();
        let dives = by_dive(&samples);
        let sink_m_s = samples[0].sink_m_s;
        let of = |bias: f64, rms: f64| {
            let score = Score {
                speed_bias_m_s: Some(-0.3 * bias),
                w_rms_9_point_m_s: Some(sink_m_s * rms),
                ..Score::default()
            };
            warnings(&score, &dives)
        };
        assert!(of(0.09, 0.19).is_empty());
        let found = of(0.11, 0.21);
        assert!(found.len() == 2 && found[0].contains("33 of 300 mm/s"), "{found:?}");
    }
}
