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
    let blocks = if resting == speeds.len() { resting } else { resting.saturating_sub(2) };
    let window = Window { from: 0, to: if resting == speeds.len() { history.len() } else { blocks * size } };
    if blocks < 5 { Err(NoWindow::NeverAtRest) } else { Ok(window) }
}

/// Where the carriage holds its speed.
///
/// # Errors
/// Where it never moves, or holds no speed for long enough.
pub fn plateau(history: &History) -> Result<Window, NoWindow> {
    let size = block_size(history);
    let speeds = block_means(history.speed_m_s(), size);
    let fastest = speeds.iter().copied().fold(0.0, f64::max);
    if fastest < 2.0 * REST_M_S {
        return Err(NoWindow::NeverMoves);
    }
    let moving: Vec<f64> = speeds.iter().copied().filter(|speed| *speed > 0.8 * fastest).collect();
    let speed = median(&moving);
    let near: Vec<f64> = moving.into_iter().filter(|s| (s / speed - 1.0).abs() < 0.03).collect();
    let tolerance = (0.005 * speed).max(5.0 * robust_sd(&near)).min(0.02 * speed);
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
    let guard = (GUARD_S / history.interval_s()).ceil() as usize;
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

fn block_size(history: &History) -> usize {
    ((BLOCK_S / history.interval_s()).round() as usize).max(1)
}
