//! What a traced branch is: points, events, and why it stopped. Plain data, serialisable.

mod access;
mod event;

pub use access::RestartPoint;
pub use event::{
    Criticality, Crossing, Detail, Direction, DoublingForm, Eigenvector, Event, EventKind,
    FoldForm, HopfForm, Offset, Shape,
};

use serde::{Deserialize, Serialize};
use std::fmt;

/// One solution on a branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Arclength from the start, in the problem's metric.
    pub s: f64,
    /// Value of the continued parameter.
    pub p: f64,
    /// The unknowns, of length [`crate::Problem::dim`].
    pub u: Vec<f64>,
    /// dp/ds: the parameter's component of the unit tangent, oriented along the branch.
    pub dp_ds: f64,
    /// Number of unstable modes; at a special point the smaller of the numbers before and after.
    /// `None` when the problem does not say what stability means.
    pub unstable: Option<usize>,
    /// Whether that number is certain: from the inertia or from the full spectrum, and not from a
    /// few eigenvalues found by iteration.
    pub certified: bool,
    /// The eigenvalues asked for by [`crate::Settings::eigenvalues`], (real, imaginary) parts,
    /// the most unstable first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub eigenvalues: Vec<(f64, f64)>,
    /// Observables, in the order of [`crate::Problem::observables`].
    pub observables: Vec<f64>,
    /// Index into [`Branch::events`] when this point is a special point or a landing.
    pub event: Option<usize>,
}

/// Why a branch ended; [`crate::guide::troubleshooting`] says what to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum StopReason {
    /// The parameter reached its target, or an observable the value at which the trace was to stop.
    Target,
    /// The branch came back to its start in the same direction.
    ClosedLoop,
    /// The parameter met a bound of its domain, where the last point is.
    Domain,
    /// The largest number of points was reached.
    MaxPoints,
    /// No step longer than the smallest was acceptable.
    StepTooSmall,
    /// Another branch passes so closely that the two cannot be told apart; the detail says how
    /// closely.
    BranchesTooClose,
    /// The unknowns grow without bound while the parameter comes to rest: to more than 1e7 times
    /// their size at the start, or 1e7 if that is less than 1.
    Unbounded,
    /// The period of the cycles grows without bound while the parameter comes to rest: they approach a
    /// homoclinic or heteroclinic orbit ([`crate::cycles`]).
    PeriodUnbounded,
    /// The cycles shrink to an equilibrium, a Hopf point ([`crate::cycles`]).
    CyclesVanish,
    /// Doubled cycles come back to those of half their period ([`crate::cycles`]).
    PeriodHalved,
    /// The branch came back over its start, against its direction.
    ReturnedToStart,
    /// The branch goes on as one that is known already ([`crate::diagram`]).
    Retraced,
    /// The observer asked to stop, or the problem did ([`crate::EvalError::Aborted`]).
    Interrupted,
}

impl StopReason {
    /// Whether the branch was traced as far as it was asked to be.
    pub fn is_complete(self) -> bool {
        use StopReason::{ClosedLoop, CyclesVanish, Domain, PeriodHalved, Retraced, Target};
        matches!(self, Target | ClosedLoop | Domain | Retraced | CyclesVanish | PeriodHalved)
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
            StopReason::BranchesTooClose => "branches-too-close",
            StopReason::Unbounded => "unbounded",
            StopReason::PeriodUnbounded => "period-unbounded",
            StopReason::CyclesVanish => "cycles-vanish",
            StopReason::PeriodHalved => "period-halved",
            StopReason::ReturnedToStart => "returned-to-start",
            StopReason::Retraced => "retraced",
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

/// A piece of a branch in which something may have been missed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Doubt {
    /// The continued parameter where the piece begins, along the branch.
    pub from: f64,
    /// The continued parameter where it ends.
    pub to: f64,
    /// What is not known there, for people.
    pub reason: String,
}

/// A traced branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Branch {
    /// Name of the continued parameter.
    pub parameter: String,
    /// Values of all parameters where the trace was started (the continued one varies).
    pub parameters: Vec<f64>,
    /// Names of the observables.
    pub observables: Vec<String>,
    /// Points in order along the branch, special points included.
    pub points: Vec<Point>,
    /// Special points in order along the branch.
    pub events: Vec<Event>,
    /// Where special points may be missing; empty where every change of the count of unstable modes
    /// has a special point that explains it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<Doubt>,
    /// Why the branch ended.
    pub stopped: Stop,
    /// Why it ends at its first point, where that is an end and not a start
    /// ([`crate::both_ways`]).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub began: Option<Stop>,
    /// What it cost.
    pub statistics: Statistics,
}

impl Branch {
    /// Whether the branch was traced as far as it was asked to be, at both ends if it has two.
    pub fn is_complete(&self) -> bool {
        let ends = self.began.iter().chain([&self.stopped]);
        ends.into_iter().all(|stop| stop.reason.is_complete())
    }

    /// Whether the number of unstable modes is certain at every point that has one, and every change
    /// of it has a special point that explains it.
    pub fn is_certain(&self) -> bool {
        let uncertain = |point: &Point| point.unstable.is_some() && !point.certified;
        self.doubts.is_empty() && !self.points.iter().any(uncertain)
    }

    /// The special points of one kind, in order along the branch.
    pub fn events_of<'b>(&'b self, kind: &EventKind) -> impl Iterator<Item = &'b Event> + use<'b> {
        let kind = kind.clone();
        self.events.iter().filter(move |e| e.kind == kind)
    }
}
