//! The seam between the command line and the solvers: a checked case goes in, plain numbers come
//! out.

use crate::case::{CatalogueEntry, ProblemCase, ResolvedCase};
use crate::output::TraceResult;
use std::ops::ControlFlow;

/// How far a trace has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Progress {
    /// Points so far.
    pub(crate) points: usize,
    /// Special points so far.
    pub(crate) events: usize,
    /// Value of the continued parameter.
    pub(crate) parameter: f64,
}

/// Why there is no result at all. A branch that stops early is a result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum RunError {
    /// No solver for this kind of problem in this program.
    #[error("{case}: problem \"{problem}\" cannot be traced by this version of arclen")]
    NotAvailable {
        /// Name of the case.
        case: String,
        /// Name of the problem.
        problem: String,
    },
    /// Not even the first point could be computed.
    #[error("{case}: no solution at the start: {detail}; check path.start and the parameters")]
    #[expect(dead_code, reason = "for the solvers behind this seam")]
    NoStart {
        /// Name of the case.
        case: String,
        /// What happened.
        detail: String,
    },
}

/// The problems of the catalogue, as the command line knows them.
pub(crate) fn catalogue() -> Vec<CatalogueEntry> {
    Vec::new()
}

/// Trace a case. The observer hears of every point and may stop the trace; what was computed until
/// then is kept, with [`continuation::StopReason::Interrupted`].
///
/// # Errors
/// When there is no result at all.
pub(crate) fn run_trace(
    case: &ResolvedCase,
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<TraceResult, RunError> {
    let _ = observer;
    let problem = match &case.problem {
        ProblemCase::Contact(_) => "contact",
        ProblemCase::RingLoad(_) => "ring-load",
        ProblemCase::Catalogue(problem) => problem.name.as_str(),
    };
    Err(RunError::NotAvailable { case: case.name.clone(), problem: problem.to_string() })
}
