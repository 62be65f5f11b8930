//! Work in a thread of its own, while Python goes on, shows how far the work is, and can interrupt it.

use std::any::Any;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use glidepolar_progress::{Step, Stopped, Watch, watched};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How long an interrupt from the keyboard waits at most.
const PATIENCE: Duration = Duration::from_millis(50);

/// Time between two calls of a callback, at least.
const BETWEEN_STEPS: Duration = Duration::from_millis(100);

/// Stack of the thread in bytes: as a program's main thread has it.
const STACK: usize = 8 << 20;

/// What comes back from the thread.
enum News<T> {
    Step(Step),
    Done(thread::Result<Result<T, Stopped>>),
}

/// Does some work without the interpreter's lock. `progress` is called in this thread with what is counted, how many are
/// done, and of how many where that is known.
///
/// # Errors
/// What a signal's handler raises, as `KeyboardInterrupt`, and what `progress` raises: the work then ends at its next step.
/// And where the work panics.
pub fn in_a_thread<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver) = channel();
    let is_stopped = Arc::new(AtomicBool::new(false));
    let watch = watch(sender.clone(), is_stopped.clone(), progress.is_some());
    let worker = move || {
        let done = catch_unwind(AssertUnwindSafe(|| watched(watch, work)));
        // Nobody waits any more after an interrupt.
        let _ = sender.send(News::Done(done));
    };
    thread::Builder::new().name("glidepolar".to_owned()).stack_size(STACK).spawn(worker)?;
    let stopped = |error: PyErr| {
        is_stopped.store(true, Ordering::Relaxed);
        error
    };
    loop {
        let received;
        (receiver, received) = py.detach(move || {
            let received = receiver.recv_timeout(PATIENCE);
            (receiver, received)
        });
        match received {
            Ok(News::Step(step)) => {
                if let Some(progress) = &progress {
                    let total = (step.total > 0).then_some(step.total);
                    progress.call1(py, (step.what, step.done, total)).map_err(stopped)?;
                }
                py.check_signals().map_err(stopped)?;
            }
            Ok(News::Done(Ok(Ok(done)))) => return Ok(done),
            Ok(News::Done(Err(panic))) => return Err(fault(&*panic)),
            Err(RecvTimeoutError::Timeout) => py.check_signals().map_err(stopped)?,
            Ok(News::Done(Ok(Err(Stopped)))) | Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the work ended without a result"));
            }
        }
    }
}

/// Hands on a step now and then, and stops the work when it is to stop.
fn watch<T: Send + 'static>(sender: Sender<News<T>>, is_stopped: Arc<AtomicBool>, is_asked_for: bool) -> Watch {
    let sender = Mutex::new((sender, None::<Instant>));
    Watch::new(move |step| {
        if is_stopped.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        if is_asked_for {
            let (sender, last) = &mut *sender.lock().unwrap_or_else(PoisonError::into_inner);
            if step.done == step.total || last.is_none_or(|last| last.elapsed() >= BETWEEN_STEPS) {
                *last = Some(Instant::now());
                let _ = sender.send(News::Step(step));
            }
        }
        ControlFlow::Continue(())
    })
}

fn fault(panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    PyRuntimeError::new_err(format!("a fault in glidepolar: {}; please report it", text.unwrap_or("no message")))
}
