//! What a traced branch is: points, events, and why it stopped. Plain data, serialisable.

use serde::{Deserialize, Serialize};
use std::fmt;

/// One solution on a branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BranchPoint {
    /// Arclength from the start, in the problem's metric.
    pub s: f64,
    /// Value of the continued parameter.
    pub p: f64,
    /// The unknowns.
    pub u: Vec<f64>,
    /// dp/ds: the parameter's component of the unit tangent, oriented along the branch.
    pub dp_ds: f64,
    /// Number of unstable modes; `None` when the problem does not say what stability means.
    pub unstable: Option<usize>,
    /// Observables, in the order of [`crate::Problem::observables`].
    pub observables: Vec<f64>,
    /// Index into [`Branch::events`] when this point is a special point.
    pub event: Option<usize>,
}

/// What kind of special point an event is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum EventKind {
    /// The parameter turns back (limit point).
    Fold,
    /// Another branch crosses.
    BranchPoint,
    /// A pair of complex eigenvalues crosses the imaginary axis.
    Hopf,
    /// A zero of the named observable (minus the requested level).
    Zero(String),
    /// A local minimum of the named observable along the branch.
    Minimum(String),
    /// A local maximum of the named observable along the branch.
    Maximum(String),
    /// The parameter takes a requested value.
    Target,
    /// A kind that an application has given a name of its own.
    Named(String),
}

impl fmt::Display for EventKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EventKind::Fold => write!(f, "fold"),
            EventKind::BranchPoint => write!(f, "branch-point"),
            EventKind::Hopf => write!(f, "hopf"),
            EventKind::Zero(name) => write!(f, "zero-{name}"),
            EventKind::Minimum(name) => write!(f, "{name}-minimum"),
            EventKind::Maximum(name) => write!(f, "{name}-maximum"),
            EventKind::Target => write!(f, "target"),
            EventKind::Named(name) => write!(f, "{name}"),
        }
    }
}

/// A located special point; its state is the [`BranchPoint`] at `point`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// What it is.
    pub kind: EventKind,
    /// Index of its state in [`Branch::points`].
    pub point: usize,
    /// Value of the continued parameter there.
    pub p: f64,
    /// Number of unstable modes before, along the branch.
    pub unstable_before: Option<usize>,
    /// Number of unstable modes after, along the branch.
    pub unstable_after: Option<usize>,
    /// Largest component of the residual at the located point.
    pub residual: f64,
    /// Estimated error of the location, as a length in the problem's metric.
    pub error_estimate: f64,
}

/// Why a branch ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum StopReason {
    /// The parameter reached its target.
    Target,
    /// The branch came back to its start in the same direction.
    ClosedLoop,
    /// The branch left the allowed range of the parameter.
    Domain,
    /// The largest number of points was reached.
    MaxPoints,
    /// No step longer than the smallest was acceptable.
    StepTooSmall,
    /// The branch came back over its start, against its direction.
    ReturnedToStart,
    /// The observer asked to stop.
    Interrupted,
}

impl StopReason {
    /// Whether the branch was traced as far as it was asked to be.
    pub fn is_complete(self) -> bool {
        matches!(self, StopReason::Target | StopReason::ClosedLoop | StopReason::Domain)
    }
}

impl fmt::Display for StopReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            StopReason::Target => "target",
            StopReason::ClosedLoop => "closed-loop",
            StopReason::Domain => "domain",
            StopReason::MaxPoints => "max-points",
            StopReason::StepTooSmall => "step-too-small",
            StopReason::ReturnedToStart => "returned-to-start",
            StopReason::Interrupted => "interrupted",
        })
    }
}

/// Why a branch ended, with a sentence of detail.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stop {
    /// The reason.
    pub reason: StopReason,
    /// What happened, for people; may be empty.
    pub detail: String,
}

/// What the computation cost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Statistics {
    /// Jacobian assemblies, those of rejected steps and of event location included.
    pub newton_iterations: usize,
    /// Steps accepted.
    pub accepted: usize,
    /// Steps rejected.
    pub rejected: usize,
}

/// A traced branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Branch {
    /// Name of the continued parameter.
    pub parameter: String,
    /// Values of all parameters at the start (the continued one varies).
    pub parameters: Vec<f64>,
    /// Names of the observables.
    pub observables: Vec<String>,
    /// Points in order along the branch, special points included.
    pub points: Vec<BranchPoint>,
    /// Special points in order along the branch.
    pub events: Vec<Event>,
    /// Why the branch ended.
    pub stopped: Stop,
    /// What it cost.
    pub statistics: Statistics,
}

impl Branch {
    /// The special points of one kind, in order along the branch.
    pub fn events_of<'b>(&'b self, kind: &'b EventKind) -> impl Iterator<Item = &'b Event> {
        self.events.iter().filter(move |e| e.kind == *kind)
    }
}
