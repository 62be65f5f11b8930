//! How far a long work is: the work says it, whoever started it shows it or stops the work.
//!
//! The work calls [`step`] now and then. Without anybody who watches that costs nothing. [`watched`] does some work under a
//! watch; the watch holds for the thread that works, and [`Watch::current`] takes it along into other threads. A watch that
//! answers [`ControlFlow::Break`] stops the work: it unwinds with [`Stopped`], and `watched` returns it.
//!
//! Knows no terminal and no work.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;

/// How far a work is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Step {
    /// What is counted: `rows`, `variants`.
    pub what: &'static str,
    /// How many are done.
    pub done: usize,
    /// How many there are; 0 where nobody knows yet.
    pub total: usize,
}

/// Whoever watches a work.
#[derive(Clone)]
pub struct Watch(Arc<dyn Fn(Step) -> ControlFlow<()> + Send + Sync>);

/// A work that was stopped by its watch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stopped;

thread_local! {
    static WATCH: RefCell<Option<Watch>> = const { RefCell::new(None) };
    /// What was counted last, and how often.
    static COUNT: Cell<(&'static str, usize)> = const { Cell::new(("", 0)) };
}

impl Watch {
    /// A watch that is called at each step, from any thread that works.
    pub fn new(watch: impl Fn(Step) -> ControlFlow<()> + Send + Sync + 'static) -> Self {
        Watch(Arc::new(watch))
    }

    /// The watch of this thread, to be asked from others.
    pub fn current() -> Option<Watch> {
        WATCH.with_borrow(Clone::clone)
    }

    /// Says how far the work is; does not return where the work is to stop.
    pub fn step(&self, step: Step) {
        if (self.0)(step).is_break() {
            // Without the message of a panic: it is none.
            resume_unwind(Box::new(Stopped));
        }
    }
}

/// Says how far the work of this thread is; does not return where it is to stop.
pub fn step(what: &'static str, done: usize, total: usize) {
    // Cloned, so that the watch may itself do some work that is watched.
    if let Some(watch) = Watch::current() {
        watch.step(Step { what, done, total });
    }
}

/// Says that one more of these is done, of nobody knows how many; does not return where the work is to stop.
pub fn one_more(what: &'static str) {
    let (counted, done) = COUNT.get();
    let done = if counted == what { done + 1 } else { 1 };
    COUNT.set((what, done));
    step(what, done, 0);
}

/// Does some work under a watch.
///
/// # Errors
/// Where the watch stopped it.
pub fn watched<T>(watch: Watch, work: impl FnOnce() -> T) -> Result<T, Stopped> {
    let before = WATCH.replace(Some(watch));
    COUNT.set(("", 0));
    let done = catch_unwind(AssertUnwindSafe(work));
    WATCH.set(before);
    done.map_err(|panic| match panic.downcast::<Stopped>() {
        Ok(stopped) => *stopped,
        Err(panic) => resume_unwind(panic),
    })
}

#[cfg(test)]
mod tests {
    use super::{Step, Stopped, Watch, one_more, step, watched};
    use std::ops::ControlFlow;
    use std::sync::{Arc, Mutex};
    use std::thread;

    fn counted(work: impl FnOnce(), stop_at: usize) -> (Result<(), Stopped>, Vec<Step>) {
        let steps = Arc::new(Mutex::new(Vec::new()));
        let seen = steps.clone();
        let watch = Watch::new(move |step| {
            seen.lock().unwrap().push(step);
            if step.done < stop_at { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        let done = watched(watch, work);
        let steps = steps.lock().unwrap().clone();
        (done, steps)
    }

    #[test]
    fn steps_are_seen_here_and_from_other_threads_and_not_afterwards() {
        let work = || {
            step("rows", 1, 0);
            let watch = Watch::current().expect("the work is watched");
            thread::spawn(move || watch.step(Step { what: "rows", done: 2, total: 3 })).join().unwrap();
        };
        let (done, steps) = counted(work, 9);
        assert_eq!(done, Ok(()));
        assert_eq!(steps.iter().map(|step| (step.done, step.total)).collect::<Vec<_>>(), [(1, 0), (2, 3)]);
        step("rows", 3, 0);
        assert!(Watch::current().is_none());
    }

    #[test]
    fn a_watch_stops_the_work_at_its_next_step() {
        let (done, steps) = counted(|| (1..100).for_each(|i| step("rows", i, 0)), 5);
        assert_eq!((done, steps.len()), (Err(Stopped), 5));
        assert!(Watch::current().is_none());
    }

    #[test]
    fn what_nobody_can_foresee_is_counted_from_one_each_time() {
        let work = || ["a", "a", "b", "a"].into_iter().for_each(one_more);
        for _ in 0..2 {
            let (_, steps) = counted(work, 9);
            let counts: Vec<_> = steps.iter().map(|step| (step.what, step.done)).collect();
            assert_eq!(counts, [("a", 1), ("a", 2), ("b", 1), ("a", 1)]);
        }
    }

    #[test]
    #[should_panic(expected = "a fault of the work")]
    fn any_other_panic_goes_on() {
        let _ = counted(|| panic!("a fault of the work"), 9);
    }
}
