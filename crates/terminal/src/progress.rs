//! How far a long work is, in a line on the terminal. Other outputs get nothing: indicatif draws on terminals only.

use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use glidepolar_progress::{Step, Stopped, Watch, watched};
use indicatif::{ProgressBar, ProgressStyle};

/// What is done sooner needs no line.
const PATIENCE: Duration = Duration::from_millis(500);

static LINE: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// Does some work and shows on a terminal how far it is.
pub fn on_terminal<T>(work: impl FnOnce() -> T) -> T {
    let begin = Instant::now();
    let watch = Watch::new(move |step| {
        if begin.elapsed() >= PATIENCE {
            draw(step);
        }
        ControlFlow::Continue(())
    });
    let done = watched(watch, work);
    hide();
    match done {
        Ok(done) => done,
        Err(Stopped) => unreachable!("this watch stops nothing"),
    }
}

/// Takes the line away, so that something else can be printed.
pub(crate) fn hide() {
    if let Some(line) = LINE.lock().unwrap_or_else(PoisonError::into_inner).take() {
        line.finish_and_clear();
    }
}

fn draw(step: Step) {
    let mut line = LINE.lock().unwrap_or_else(PoisonError::into_inner);
    let line = line.get_or_insert_with(|| ProgressBar::new(0));
    if line.message() != step.what || line.length() != Some(step.total as u64) {
        let style =
            if step.total > 0 { "{bar:40} {pos}/{len} {msg} {elapsed}, left {eta}" } else { "{pos} {msg} {elapsed}" };
        if let Ok(style) = ProgressStyle::with_template(style) {
            line.set_style(style);
        }
        line.set_length(step.total as u64);
        line.set_message(step.what);
    }
    line.set_position(step.done as u64);
}
