//! What a curve knows of the state where it was evaluated last.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Work space that follows one trace: the borders of a curve are those of the points it came by. A copy follows
/// another trace.
pub(super) struct TraceWork<W>(Mutex<W>);

impl<W> TraceWork<W> {
    pub(super) fn new(work: W) -> Self {
        TraceWork(Mutex::new(work))
    }

    /// An evaluation that panicked has left no state that passes for a known one.
    pub(super) fn get(&self) -> MutexGuard<'_, W> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<W: Clone> Clone for TraceWork<W> {
    fn clone(&self) -> Self {
        Self::new(self.get().clone())
    }
}
