//! Single readings that no force explains: a loose plug, a lost bit. One of them in a thousand moves a mean by more than
//! everything else that is wrong with a run. They are left out and reported, never passed over in silence. Must not know what a
//! channel measures.

use crate::clipping::{NAMES, is_fine};
use crate::history::History;

/// A spike departs from its neighbours by so many times what readings do on the average. Normal noise does so once in
/// 10^80 readings; a record half of which is at rest, without vibration, once in 10^20.
const DEPARTURES: f64 = 25.0;
/// More spikes than these are the channel's own way.
const MOST: usize = 5;

/// Puts the mean of its neighbours in the place of every spike, and says so.
pub fn leave_out(history: &mut History) -> Vec<String> {
    let mut notices = Vec::new();
    for (channel, name) in NAMES.into_iter().enumerate() {
        let values = history.channels()[channel];
        let (mut sum, mut largest) = (0.0, 0.0f64);
        for three in values.windows(3) {
            let departure = departure(three).abs();
            sum += departure;
            largest = largest.max(departure);
        }
        let limit = DEPARTURES * sum / values.len() as f64;
        if largest <= limit || !is_fine(values) {
            continue;
        }
        let is_spike = |three: &[f64]| {
            let departure = departure(three).abs();
            // Neighbours of a step do not agree with each other.
            departure > limit && (three[2] - three[0]).abs() < 0.5 * departure
        };
        let middles = values.windows(3).enumerate().filter(|(_, three)| is_spike(three));
        let spikes: Vec<usize> = middles.map(|(i, _)| i + 1).take(MOST + 1).collect();
        if spikes.len() > MOST {
            continue;
        }
        for at in spikes {
            let time_s = history.time_s()[at];
            let values = history.channel_mut(channel);
            let between = 0.5 * (values[at - 1] + values[at + 1]);
            notices.push(format!(
                "{name} is {} at {time_s:.3} s, {between:.4} before and after: taken for a spike and left out",
                values[at]
            ));
            values[at] = between;
        }
    }
    notices
}

/// Of the middle one of three readings from the mean of the others.
fn departure(three: &[f64]) -> f64 {
    three[1] - 0.5 * (three[0] + three[2])
}
