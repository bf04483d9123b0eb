//! Long work beside an interpreter that goes on answering signals.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// How often the interpreter is asked for signals.
const PERIOD: Duration = Duration::from_millis(10);
/// The stack that a program's main thread has.
const STACK: usize = 8 << 20;

/// Does work on a thread of its own, and asks the interpreter for signals on this one. What a handler of
/// Python raises goes to `asked`: it asks the work to stop and returns `None`, or returns the exception, with
/// which the wait ends while the work runs on, unheard.
pub(crate) fn attended<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
    mut asked: impl FnMut(PyErr) -> Option<PyErr>,
) -> PyResult<T> {
    let (done, mut result) = channel();
    let work = move || {
        // nobody waits any more: nobody to tell
        let _ = done.send(work());
    };
    std::thread::Builder::new().name("arclen".to_owned()).stack_size(STACK).spawn(work)?;
    loop {
        let received = py.detach(move || (result.recv_timeout(PERIOD), result));
        result = received.1;
        match received.0 {
            Ok(value) => return Ok(value),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the computation broke off; this is a fault"));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        if let Err(raised) = py.check_signals()
            && let Some(raised) = asked(raised)
        {
            return Err(raised);
        }
    }
}
