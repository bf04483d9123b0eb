//! Who waits for a fit: told how far it is, and may stop it.
//!
//! A stop is asked for between the points of a branch, a fraction of a millisecond apart. What was found until then
//! is kept: see [`crate::identify_attended`].

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

/// What a fit is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Shells of the grid are laid on the data.
    Starts,
    /// Descents from the best of them, on a coarse mesh.
    Descents,
    /// The best minimum, on all samples and a fine mesh.
    Polish,
    /// Profile likelihoods.
    Profiles,
}

impl Stage {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Starts => "starts",
            Stage::Descents => "descents",
            Stage::Polish => "polish",
            Stage::Profiles => "profiles",
        }
    }

    /// Usual shares of the work of a fit with profiles that is done before it and after it.
    fn part(self) -> (f64, f64) {
        match self {
            Stage::Starts => (0.0, 0.1),
            Stage::Descents => (0.1, 0.3),
            Stage::Polish => (0.3, 0.5),
            Stage::Profiles => (0.5, 1.0),
        }
    }
}

/// How far a fit is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// What it is doing.
    pub stage: Stage,
    /// Roughly what share of the work is done, from 0 to 1; it never falls.
    pub share: f64,
}

/// Who is told of progress.
pub type Listener<'a> = dyn Fn(Progress) + Sync + 'a;

/// Who waits for a fit; by default nobody.
#[derive(Clone, Copy, Default)]
pub struct Attended<'a> {
    /// Set when the fit is to stop.
    pub stop: Option<&'a AtomicBool>,
    /// Told of progress.
    pub listener: Option<&'a Listener<'a>>,
}

impl fmt::Debug for Attended<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let listener = self.listener.map(|_| "…");
        f.debug_struct("Attended").field("stop", &self.stop).field("listener", &listener).finish()
    }
}

impl Attended<'_> {
    /// Whether the fit is to stop.
    pub fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// Tells that `done` of `of` pieces of a stage are done.
    pub(crate) fn tell(&self, stage: Stage, done: usize, of: usize) {
        if let Some(listener) = self.listener {
            let (from, to) = stage.part();
            let share = from + (to - from) * (done as f64 / of.max(1) as f64).min(1.0);
            listener(Progress { stage, share });
        }
    }
}
