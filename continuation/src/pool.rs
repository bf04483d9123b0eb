//! Work space of problems that several threads may evaluate at once.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Work spaces that no evaluation uses at present. An evaluation takes one for itself, so that none waits for
/// another, and a residual may evaluate its own problem; a single thread always has the same one.
pub(crate) struct Pool<T>(Mutex<Vec<T>>);

impl<T> Pool<T> {
    /// With one work space at hand.
    pub(crate) fn new(first: T) -> Self {
        Pool(Mutex::new(vec![first]))
    }

    /// Evaluates with a work space, made anew if all are in use. It holds what an earlier evaluation left.
    pub(crate) fn with<R>(
        &self,
        make: impl FnOnce() -> T,
        evaluate: impl FnOnce(&mut T) -> R,
    ) -> R {
        let free = self.free().pop();
        let mut work = free.unwrap_or_else(make);
        let result = evaluate(&mut work);
        self.free().push(work);
        result
    }

    /// One of the work spaces, if there is any; the others are gone.
    pub(crate) fn take_one(&mut self) -> Option<T> {
        let mut free = std::mem::take(self.0.get_mut().unwrap_or_else(PoisonError::into_inner));
        free.pop()
    }

    /// No thread panics while it has the list.
    fn free(&self) -> MutexGuard<'_, Vec<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
