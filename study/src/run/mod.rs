//! Runs: a checked case goes in, the solvers work, plain numbers come out.

mod asymmetric;
mod contact;
mod cycle;
mod diagram;
mod family;
mod form;
mod general;
mod map;
mod mesh_error;
mod mesh_for;
mod orbits;
mod resolution;
mod ring_load;
mod stability;
mod states;
mod sweep;
mod two_plates;
mod ways;

pub use contact::{branch as contact_branch, result as contact_result};
pub use map::MapError;
pub use ring_load::AXES as RING_AXES;
pub use sweep::{Outcome, run_sweep};

use crate::case::{PathCase, ResolvedCase};
use crate::record::{CycleResult, DiagramResult, MapResult, Outline, TraceResult};
use continuation::{Settings, TraceError};
use diagram::Work;
use family::Wanted;
use std::ops::ControlFlow;

pub use diagram::{DiagramObserver, DiagramProgress, Keep, KeepNothing, Saved};

/// How far a trace has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Points so far.
    pub points: usize,
    /// Special points so far.
    pub events: usize,
    /// Value of the continued parameter.
    pub parameter: f64,
}

/// Told of every point; may stop the trace.
pub type Observer<'o> = dyn FnMut(Progress) -> ControlFlow<()> + 'o;

/// Why there is no result at all. A branch that stops early is a result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// No solver for this kind of problem in this program.
    #[error("{case}: problem \"{problem}\" cannot be traced by this version of arclen")]
    NotAvailable {
        /// Name of the case.
        case: String,
        /// Name of the problem.
        problem: String,
    },
    /// The model refuses the parameters.
    #[error("{case}: {error}")]
    Parameters {
        /// Name of the case.
        case: String,
        /// What it says.
        error: shell_contact::ParameterError,
    },
    /// No mesh for a tolerance.
    #[error("{case}: mesh.tolerance: {error}; ask for less, or for a fixed mesh by mesh.elements")]
    Tolerance {
        /// Name of the case.
        case: String,
        /// What it says.
        error: shell_contact::discretisation::ToleranceError,
    },
    /// The problem of the catalogue refuses the case.
    #[error("{case}: {error}")]
    Problem {
        /// Name of the case.
        case: String,
        /// What it says.
        error: problems::ProblemError,
    },
    /// The diagram cannot be explored.
    #[error("{case}: {error}")]
    Diagram {
        /// Name of the case.
        case: String,
        /// What happened.
        error: continuation::diagram::DiagramError,
    },
    /// No stable state under a device.
    #[error("{case}: path.start = {start}: {detail}; choose another start, or another device")]
    NotHeld {
        /// Name of the case.
        case: String,
        /// The start asked for.
        start: f64,
        /// What happened.
        detail: shell_contact::device::StartError,
    },
    /// A device where only a grip can be.
    #[error(
        "{case}: device.kind = \"{device}\": only trace and cycle know devices; leave out the table \
         [device]"
    )]
    Device {
        /// Name of the case.
        case: String,
        /// The device.
        device: &'static str,
    },
    /// A problem without plates.
    #[error("{case}: problem \"{problem}\": a cycle needs plates: problem = \"contact\"")]
    NoPlates {
        /// Name of the case.
        case: String,
        /// Name of the problem.
        problem: String,
    },
    /// A cycle that cannot begin.
    #[error("{case}: path.start = {start}: {detail}; choose another start")]
    Cycle {
        /// Name of the case.
        case: String,
        /// The start asked for.
        start: f64,
        /// What happened.
        detail: shell_contact::device::CycleError,
    },
    /// A problem without periodic orbits.
    #[error(
        "{case}: problem \"{problem}\": its states minimise an energy, and there are no periodic orbits; \
         take a problem of the catalogue whose special points include a Hopf point"
    )]
    NoOrbits {
        /// Name of the case.
        case: String,
        /// Name of the problem.
        problem: String,
    },
    /// A Hopf point that is not there.
    #[error("{case}: there is no Hopf point number {wanted}; there are {found}, counted from 0")]
    NoHopfPoint {
        /// Name of the case.
        case: String,
        /// The number asked for.
        wanted: usize,
        /// How many there are.
        found: usize,
    },
    /// The problem refuses periodic orbits.
    #[error("{case}: {error}")]
    Orbits {
        /// Name of the case.
        case: String,
        /// What it says.
        error: continuation::cycles::CycleError,
    },
    /// Not even the first point could be computed.
    #[error("{case}: path.start = {start}: {detail}; {remedy}")]
    NoStart {
        /// Name of the case.
        case: String,
        /// The start asked for.
        start: f64,
        /// What happened.
        detail: TraceError,
        /// What to do.
        remedy: &'static str,
    },
}

/// Trace a case. The observer hears of every point and may stop the trace; what was computed until
/// then is kept, with [`continuation::StopReason::Interrupted`].
///
/// # Errors
/// When there is no result at all.
pub fn run_trace(
    case: &ResolvedCase,
    observer: &mut Observer<'_>,
) -> Result<TraceResult, RunError> {
    family::of(&case.problem).trace(case, Wanted::Pictures, observer)
}

/// The same with the states along the branch, for a report.
///
/// # Errors
/// When there is no result at all.
pub fn run_trace_reported(
    case: &ResolvedCase,
    observer: &mut Observer<'_>,
) -> Result<TraceResult, RunError> {
    family::of(&case.problem).trace(case, Wanted::States, observer)
}

/// Explore the diagram of a case, from what was kept of it; `reported` also takes the states along
/// the branches, for a report.
///
/// # Errors
/// When there is no result at all, or what was kept is of another diagram.
pub fn run_diagram(
    case: &ResolvedCase,
    reported: bool,
    saved: Saved,
    keep: &mut dyn Keep,
    observer: &mut DiagramObserver<'_>,
) -> Result<DiagramResult, RunError> {
    family::of(&case.problem).diagram(case, Work::new(saved, keep, reported), observer)
}

/// Close and open the plates of a case once; `reported` also takes the states along both ways, for a
/// report.
///
/// # Errors
/// When there is no result at all; a cycle that ends early is a result.
pub fn run_cycle(
    case: &ResolvedCase,
    reported: bool,
    observer: &mut Observer<'_>,
) -> Result<CycleResult, RunError> {
    family::of(&case.problem).cycle(case, reported, observer)
}

/// The meridian of a shell in a state of a branch of the case, for example at a special point: its unknowns, and
/// the value of the continued parameter. `None` for a problem without a shell, or a state that is not
/// admissible.
///
/// # Errors
/// When the model refuses the case.
pub fn meridian(
    case: &ResolvedCase,
    u: &[f64],
    parameter: f64,
) -> Result<Option<Outline>, RunError> {
    family::of(&case.problem).meridian(case, u, parameter)
}

/// Follow the periodic orbits that leave the Hopf points of a case's diagram: all, or the one with a
/// number, counted from 0 in the order of the branches. Disconnected equilibria are not sought.
///
/// # Errors
/// When there is no result at all; branches that end early are a result.
pub fn run_orbits(
    case: &ResolvedCase,
    hopf: Option<usize>,
    observer: &mut DiagramObserver<'_>,
) -> Result<DiagramResult, RunError> {
    family::of(&case.problem).orbits(case, hopf, observer)
}

/// Map a case over `key`. The observer hears of every point and may stop the work; what was
/// computed until then is kept.
///
/// # Errors
/// When there is no result at all.
pub fn run_map(
    case: &ResolvedCase,
    key: &str,
    observer: &mut Observer<'_>,
) -> Result<MapResult, MapError> {
    let family = family::of(&case.problem);
    let second = family.second_parameter(case, key)?;
    let attempts = |task: &map::Task<'_>, at: f64, observer: &mut Observer<'_>| {
        family.attempt(task, at, observer)
    };
    map::map(case, second, &attempts, observer)
}

/// The tracer's settings for a path.
fn settings(path: &PathCase) -> Settings {
    Settings {
        target: Some(path.end),
        max_step: path.max_step,
        min_step: path.min_step,
        max_points: path.max_points,
        eigenvalues: path.eigenvalues,
        ..Settings::default()
    }
}

/// Hands the tracer's progress on.
fn listen<'o>(
    observer: &'o mut Observer<'_>,
) -> impl FnMut(&continuation::Progress) -> ControlFlow<()> + 'o {
    move |progress| {
        observer(Progress {
            points: progress.points,
            events: progress.events,
            parameter: progress.p,
        })
    }
}
