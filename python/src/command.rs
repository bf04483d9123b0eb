//! The program `arclen`, inside the interpreter's process.

use crate::attended::attended;
use pyo3::prelude::*;
use std::ffi::OsString;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Signals that come closer than this are one request, as for the program.
const ONE_REQUEST: Duration = Duration::from_millis(500);

/// Runs the program; its exit code. The first signal for which Python raises asks a computation to stop and keep
/// what it has; a second one, or one before a computation, ends the wait with the exception.
#[pyfunction]
pub(crate) fn run_command(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<u8> {
    let stop = Arc::new(AtomicBool::new(false));
    let computes = Arc::new(AtomicBool::new(false));
    let (asked, begun) = (Arc::clone(&stop), Arc::clone(&computes));
    let work = move || {
        let listen = || {
            begun.store(true, Ordering::SeqCst);
            Ok(Arc::clone(&asked))
        };
        cli::run(arguments, &listen)
    };
    let mut first: Option<Instant> = None;
    attended(py, work, |raised| {
        let again = first.is_some_and(|at| at.elapsed() > ONE_REQUEST);
        if again || !computes.load(Ordering::SeqCst) {
            return Some(raised);
        }
        first.get_or_insert_with(Instant::now);
        stop.store(true, Ordering::SeqCst);
        None
    })
}
