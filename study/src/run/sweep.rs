//! The cases of a sweep on several threads.

use super::family::{self, Wanted};
use super::stability;
use crate::case::ResolvedCase;
use crate::record::phase::classify;
use crate::record::{CaseRecord, LossRecord, Status, Table, TraceResult, events_table};
use crate::sweep::SweepCase;
use continuation::StopReason;
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// What a case of a sweep hands over.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// How it went.
    pub record: CaseRecord,
    /// Its points.
    pub curve: Table,
    /// Its special points.
    pub events: Table,
}

/// Traces the cases on `jobs` threads and hands every outcome to `done`, on the thread that computed
/// it, in whatever order they come. Once `stop` is set no case begins, and those under way are given
/// up. Nothing that is computed depends on the number of threads.
///
/// # Errors
/// When the threads cannot be had.
pub fn run_sweep(
    cases: &[&SweepCase],
    jobs: usize,
    stop: &AtomicBool,
    done: &(dyn Fn(&SweepCase, Outcome) + Sync),
) -> Result<(), rayon::ThreadPoolBuildError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build()?;
    pool.install(|| {
        // single cases: some take a hundred times as long as others
        cases.par_iter().with_max_len(1).for_each(|case| {
            if !stop.load(Ordering::Relaxed)
                && let Some(outcome) = outcome(case, stop)
            {
                done(case, outcome);
            }
        });
    });
    Ok(())
}

/// The outcome of a case; `None` if it was given up.
fn outcome(case: &SweepCase, stop: &AtomicBool) -> Option<Outcome> {
    let failed = |reason: String| {
        let record = CaseRecord::failed(case.index, reason);
        Some(Outcome { record, curve: Table::default(), events: Table::default() })
    };
    let resolved = match &case.case {
        Ok(resolved) => resolved,
        Err(reason) => return failed(reason.clone()),
    };
    let family = family::of(&resolved.problem);
    let traced =
        family.trace(resolved, Wanted::Nothing, &mut |_| match stop.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        });
    match traced {
        Ok(result) if result.stopped_because == StopReason::Interrupted => None,
        Ok(result) => Some(present(case.index, resolved, result)),
        Err(error) => failed(error.to_string()),
    }
}

fn present(index: usize, case: &ResolvedCase, result: TraceResult) -> Outcome {
    let complete = result.stopped_because.is_complete();
    let folds = result.events.iter().filter(|event| event.kind == "fold").count();
    let film = family::of(&case.problem).film();
    // a class is that of the branch, whatever was counted beside it
    let own = result.table.without("event", stability::KIND);
    let phase = film.map(|film| classify(&own, folds, film, complete));
    let record = CaseRecord {
        case: index,
        status: if complete { Status::Finished } else { Status::StoppedEarly },
        reason: (!complete).then(|| result.stopped_detail.clone()).filter(|why| !why.is_empty()),
        stopped_because: Some(result.stopped_because.to_string()),
        points: result.points,
        special_points: result.events.len(),
        certified: result.certified,
        newton_iterations: result.newton_iterations,
        seconds: result.seconds,
        phase,
        stability: result.stability,
        first_loss: LossRecord::first_of(&result),
    };
    let events = events_table(&result);
    Outcome { record, curve: result.table, events }
}
