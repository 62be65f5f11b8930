//! Work in a thread of its own, while Python goes on and can be interrupted.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How long an interrupt from the keyboard waits at most.
const PATIENCE: Duration = Duration::from_millis(50);

/// Stack of the thread in bytes: as a program's main thread has it.
const STACK: usize = 8 << 20;

/// Does some work without the interpreter's lock.
///
/// # Errors
/// What a signal's handler raises, as `KeyboardInterrupt`: the work is left alone then, and its result is thrown away. And
/// where the work panics.
pub fn in_a_thread<T: Send + 'static>(py: Python<'_>, work: impl FnOnce() -> T + Send + 'static) -> PyResult<T> {
    let (sender, mut receiver) = channel();
    let worker = move || {
        // Nobody waits any more after an interrupt.
        let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
    };
    thread::Builder::new().name("glidepolar".to_owned()).stack_size(STACK).spawn(worker)?;
    loop {
        let received;
        (receiver, received) = py.detach(move || {
            let received = receiver.recv_timeout(PATIENCE);
            (receiver, received)
        });
        match received {
            Ok(Ok(done)) => return Ok(done),
            Ok(Err(panic)) => return Err(fault(&*panic)),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the work ended without a result"));
            }
        }
    }
}

fn fault(panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    PyRuntimeError::new_err(format!("a fault in glidepolar: {}; please report it", text.unwrap_or("no message")))
}
