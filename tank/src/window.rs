//! Where a run is useful: after the run-up, before braking, transients dropped, stationarity tested.

use crate::history::History;
use crate::series::{block_means, median, robust_sd, trend_t};

/// A stretch of a history, samples `from..to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// First sample.
    pub from: usize,
    /// One past the last sample.
    pub to: usize,
}

/// The useful part of a run and how it was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The useful part.
    pub window: Window,
    /// Where the carriage held its speed.
    pub plateau: Window,
    /// Largest slope of the three channels over the window, in units of its standard error.
    pub slope_t: f64,
}

/// Why a run has no useful part.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum NoWindow {
    #[error("the carriage never moves: expected a run-up, a steady part and braking")]
    NeverMoves,
    #[error(
        "no steady part: the speed holds within {tolerance_percent:.1} % of {speed_m_s:.3} m/s for {held_s:.1} s, expected at least {needed_s:.1} s"
    )]
    NotSteady { speed_m_s: f64, tolerance_percent: f64, held_s: f64, needed_s: f64 },
    #[error("{samples} samples in the steady part, expected at least {FEWEST_SAMPLES}: sample faster")]
    TooCoarse { samples: usize },
    #[error("the model is never at rest: expected a record at zero speed")]
    NeverAtRest,
}

/// Speeds below this are rest \[m/s\].
const REST_M_S: f64 = 0.01;
/// Block over which speed is judged \[s\].
const BLOCK_S: f64 = 0.1;
/// The same where the speed is recorded with much noise \[s\].
const LONGEST_BLOCK_S: f64 = 1.6;
/// A speed that departs by more, relative to it, is not held.
const MOST_TOLERANCE: f64 = 0.02;
/// Kept away from run-up and braking, whose begin and end are smooth \[s\].
const GUARD_S: f64 = 0.5;
/// Shortest steady part \[s\].
const SHORTEST_S: f64 = 3.0;
/// Fewest samples of which a mean has a standard error.
const FEWEST_SAMPLES: usize = 16;
/// Way over which the flow about the hull develops after the run-up, hull lengths: the wake reaches its length in one, and
/// a tenth of the force that is missing then is down to half a per cent of it after three.
const DEVELOPMENT_LENGTHS: f64 = 3.0;
/// At most this share of the plateau is given to the developing flow.
const MOST_DEVELOPMENT: f64 = 0.5;
/// A stretch at the begin or end that departs by more standard errors is a transient.
const TRANSIENT_SE: f64 = 5.0;

impl Window {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.to - self.from
    }

    /// Whether nothing is in it.
    pub fn is_empty(&self) -> bool {
        self.to <= self.from
    }

    /// The window's part of a column.
    pub fn slice<'a>(&self, column: &'a [f64]) -> &'a [f64] {
        &column[self.from..self.to]
    }

    /// The window's part of three columns.
    pub fn of3<'a>(&self, columns: [&'a [f64]; 3]) -> [&'a [f64]; 3] {
        columns.map(|column| self.slice(column))
    }
}

/// The part of a record at rest: the whole of a zero run, the begin of any other.
///
/// # Errors
/// Where the speed never rests.
pub fn at_rest(history: &History) -> Result<Window, NoWindow> {
    let size = block_size(history);
    let speeds = block_means(history.speed_m_s(), size);
    let resting = speeds.iter().take_while(|speed| speed.abs() < REST_M_S).count();
    // The block in which the carriage begins to move is half rest.
    let blocks = if resting == speeds.len() {
        resting
    } else {
        resting.saturating_sub(2).min(resting - begun(&speeds, resting))
    };
    let window = Window { from: 0, to: if resting == speeds.len() { history.len() } else { blocks * size } };
    if blocks < 5 { Err(NoWindow::NeverAtRest) } else { Ok(window) }
}

/// Blocks of rest in which the carriage already gains speed: a tenth of the final acceleration is felt long before the speed shows.
///
/// Of a run-up `u = k t^p` the time until `u` is `u_4/4` is `1/(4^(1/p) - 1)` of that from there to `u_4`: one for constant jerk
/// (`p` = 2), 1.7 for `p` = 3. Twice that time is left out, half of the rest at most.
fn begun(speeds: &[f64], resting: usize) -> usize {
    let rise = speeds[resting..].iter().take_while(|speed| speed.abs() < 4.0 * REST_M_S).count();
    (2 * (rise + 1)).min(resting / 2)
}

/// Where the carriage holds its speed.
///
/// # Errors
/// Where it never moves, or holds no speed for long enough.
pub fn plateau(history: &History) -> Result<Window, NoWindow> {
    let mut size = block_size(history);
    let longest = (LONGEST_BLOCK_S / history.interval_s()) as usize;
    while 2 * size <= longest && 5.0 * scatter(history.speed_m_s(), size) > MOST_TOLERANCE {
        size *= 2;
    }
    let speeds = block_means(history.speed_m_s(), size);
    let fastest = speeds.iter().copied().fold(0.0, f64::max);
    if fastest < 2.0 * REST_M_S {
        return Err(NoWindow::NeverMoves);
    }
    let moving: Vec<f64> = speeds.iter().copied().filter(|speed| *speed > 0.8 * fastest).collect();
    let speed = median(&moving);
    let near: Vec<f64> = moving.into_iter().filter(|s| (s / speed - 1.0).abs() < 0.03).collect();
    let tolerance = (0.005 * speed).max(5.0 * robust_sd(&near)).min(MOST_TOLERANCE * speed);
    let (mut best, mut start) = (0..0, 0);
    for end in 0..=speeds.len() {
        if end == speeds.len() || (speeds[end] - speed).abs() > tolerance {
            if end - start > best.len() {
                best = start..end;
            }
            start = end + 1;
        }
    }
    let held_s = best.len() as f64 * size as f64 * history.interval_s();
    let needed_s = SHORTEST_S + 2.0 * GUARD_S;
    if held_s < needed_s {
        let tolerance_percent = 100.0 * tolerance / speed;
        return Err(NoWindow::NotSteady { speed_m_s: speed, tolerance_percent, held_s, needed_s });
    }
    // A longer block may hold a part of the run-up unnoticed.
    let guard =
        ((GUARD_S / history.interval_s()).ceil() as usize).max(if size > block_size(history) { size } else { 0 });
    let to = (best.end * size).min(history.len());
    Ok(Window { from: best.start * size + guard, to: to - guard })
}

/// The useful part of a run at constant speed.
///
/// # Errors
/// As [`plateau`].
pub fn steady(history: &History, hull_length_m: f64) -> Result<Found, NoWindow> {
    let plateau = plateau(history)?;
    let speed = median(plateau.slice(history.speed_m_s()));
    let development = DEVELOPMENT_LENGTHS * hull_length_m / speed / history.interval_s();
    let dropped = (development as usize).min((MOST_DEVELOPMENT * plateau.len() as f64) as usize);
    let mut window = Window { from: plateau.from + dropped, to: plateau.to };
    drop_transients(history, &mut window);
    if window.len() < FEWEST_SAMPLES {
        return Err(NoWindow::TooCoarse { samples: window.len() });
    }
    let slope_t = history
        .channels()
        .iter()
        .map(|channel| trend_t(window.slice(channel)))
        .max_by(|a, b| a.abs().total_cmp(&b.abs()))
        .unwrap_or(0.0);
    Ok(Found { window, plateau, slope_t })
}

/// Fifths of the window at its begin, and then at its end, that depart from the rest are dropped, two at most.
fn drop_transients(history: &History, window: &mut Window) {
    for _ in 0..2 {
        let fifth = window.len() / 5;
        let first = Window { from: window.from, to: window.from + fifth };
        let last = Window { from: window.to - fifth, to: window.to };
        let after = Window { from: first.to, to: window.to };
        let before = Window { from: window.from, to: last.from };
        if departs(history, first, after) {
            *window = after;
        } else if departs(history, last, before) {
            *window = before;
        } else {
            return;
        }
    }
}

/// Whether a stretch departs from the rest in any channel, by the standard error that the rest's own fourths suggest.
fn departs(history: &History, stretch: Window, rest: Window) -> bool {
    history.channels().iter().any(|channel| {
        let parts = block_means(rest.slice(channel), rest.len() / 4);
        let mean = parts.iter().sum::<f64>() / parts.len() as f64;
        let variance = parts.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / (parts.len() - 1) as f64;
        let there = stretch.slice(channel);
        let difference = there.iter().sum::<f64>() / there.len() as f64 - mean;
        // Three degrees of freedom only: five times such a standard error is rare, and then it is a transient worth
        // dropping only where it matters against the channel itself.
        difference.abs() > TRANSIENT_SE * (1.25 * variance).sqrt() && difference.abs() > 0.002 * mean.abs()
    })
}

/// Scatter of successive blocks of speed, relative to the speed that the carriage holds: half of the square of their differences,
/// which a change of speed over the run leaves out. Blocks must average the noise of the record, or one of them would end a window.
fn scatter(speed_m_s: &[f64], size: usize) -> f64 {
    let speeds = block_means(speed_m_s, size);
    let fastest = speeds.iter().copied().fold(0.0, f64::max);
    let moving: Vec<f64> = speeds.into_iter().filter(|speed| *speed > 0.8 * fastest).collect();
    let differences: Vec<f64> = moving.windows(2).map(|pair| pair[1] - pair[0]).collect();
    robust_sd(&differences) / (std::f64::consts::SQRT_2 * median(&moving))
}

fn block_size(history: &History) -> usize {
    ((BLOCK_S / history.interval_s()).round() as usize).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rest for 6 s, then a run-up of 6 s to 0.6 m/s that begins with a linear, quadratic or cubic growth of the speed.
    #[test]
    fn no_block_of_rest_gains_speed() {
        for power in [1, 2, 3] {
            let speed = |i: usize| {
                let x = (0.1 * (i as f64 + 0.5) - 6.0).max(0.0) / 6.0;
                0.6 * x.powi(power)
            };
            let speeds: Vec<f64> = (0..120).map(speed).collect();
            let resting = speeds.iter().take_while(|speed| **speed < REST_M_S).count();
            let kept = resting - begun(&speeds, resting);
            assert!((30..=60).contains(&kept), "power {power}: {kept} blocks of 60");
        }
    }

    /// A sensor's noise of 1.5 % at 16 Hz is averaged to what leaves the carriage's own 2 % their meaning.
    #[test]
    fn blocks_average_a_noisy_speed() {
        let noisy: Vec<f64> = (0..640).map(|i| 0.7 * (1.0 + 0.015 * 1.7 * (37.0 * i as f64).sin())).collect();
        assert!(5.0 * scatter(&noisy, 2) > MOST_TOLERANCE);
        assert!(5.0 * scatter(&noisy, 25) < MOST_TOLERANCE);
        let steady: Vec<f64> = (0..640).map(|i| 0.7 * (1.0 + 0.0001 * i as f64)).collect();
        assert!(scatter(&steady, 2) < 1e-3);
    }
}
