//! The cases of a sweep that are not kept yet: computed, and kept as they come.

use super::sweep::{Kept, Store, StoreError};
use crate::record::Status;
use crate::run::{Outcome, run_sweep};
use crate::sweep::{Sweep, SweepCase};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// What a run of a sweep leaves.
#[derive(Debug)]
pub struct Computed {
    /// The cases whose files are there, in their order.
    pub kept: Vec<Kept>,
    /// How many were computed whose files were removed meanwhile.
    pub lost: usize,
    /// Whether it was stopped before all were computed.
    pub interrupted: bool,
    /// The first case that could not be kept.
    pub failure: Option<StoreError>,
}

/// Computes the cases that are not among those `kept`, on `jobs` threads, and keeps them in the store, or in memory
/// without one. `told` hears after every case how many failed or stopped early.
///
/// # Errors
/// When the threads cannot be had.
pub fn compute(
    sweep: &Sweep,
    store: Option<&Store>,
    kept: Vec<Kept>,
    jobs: usize,
    stop: &AtomicBool,
    told: &(dyn Fn(usize) + Sync),
) -> Result<Computed, rayon::ThreadPoolBuildError> {
    let have: Vec<usize> = kept.iter().map(|case| case.record.case).collect();
    let to_do: Vec<&SweepCase> =
        sweep.cases.iter().filter(|case| have.binary_search(&case.index).is_err()).collect();
    let shared = Mutex::new((kept, None));
    let done = |case: &SweepCase, outcome: Outcome| {
        let written = match store {
            Some(store) => store.keep(case, &outcome),
            None => Ok(Kept::in_memory(outcome.record)),
        };
        let mut shared = shared.lock().unwrap_or_else(PoisonError::into_inner);
        let (kept, failure) = &mut *shared;
        match written {
            Ok(case) => kept.push(case),
            // what cannot be kept need not be computed
            Err(error) => {
                stop.store(true, Ordering::SeqCst);
                failure.get_or_insert(error);
            }
        }
        told(kept.iter().filter(|case| case.record.status != Status::Finished).count());
    };
    run_sweep(&to_do, jobs, stop, &done)?;
    let (mut all, failure) = shared.into_inner().unwrap_or_else(PoisonError::into_inner);
    all.sort_by_key(|case| case.record.case);
    let (kept, lost): (Vec<Kept>, Vec<Kept>) = all.into_iter().partition(Kept::is_there);
    let lost = lost.len();
    let interrupted = failure.is_none() && kept.len() + lost < sweep.cases.len();
    Ok(Computed { kept, lost, interrupted, failure })
}
