//! Whole bifurcation diagrams: the first branch, those that leave it at its branch points, those
//! that leave them, and so on.
//!
//! A diagram is a graph. Its edges are branches, its joints the branch points at which they meet. At
//! a joint several *rays* begin: both halves of the branch that was traced through it, and both
//! halves of every branch that leaves there ([`crate::Crossing`]). [`Explorer`] keeps account of them:
//! a branch that passes a joint takes the ray along which it comes and the one along which it goes;
//! every ray that nothing has taken is followed, in the order in which joints were found. So no
//! branch is traced twice, whether it connects two branch points, closes a loop or is met from
//! several sides; one that is about to go on along a ray that is taken ends there
//! ([`crate::StopReason::Retraced`]).
//!
//! ```
//! use continuation::{DenseProblem, EventKind, Settings};
//! use continuation::diagram::{DiagramSettings, Explorer};
//! use std::ops::ControlFlow;
//!
//! // a pitchfork at p = 0, on each of whose branches another one follows
//! let problem = DenseProblem::from_residual(2, &["p"], |u, p, r| {
//!     r[0] = p[0] * u[0] - u[0].powi(3);
//!     r[1] = (u[0] * u[0] - 0.5) * u[1] - u[1].powi(3);
//! });
//! let trace = Settings { target: Some(1.0), ..Settings::default() };
//! let settings = DiagramSettings { trace, ..DiagramSettings::default() };
//! let explorer = Explorer::new(&problem, "p", &[0.0, 0.0], &[-1.0], settings, &[])?;
//! let diagram = explorer.run(&mut |_| ControlFlow::Continue(()))?;
//! // the trunk, two halves of the fork, and two of each of the next ones
//! assert_eq!(diagram.branches.len(), 7);
//! assert_eq!(diagram.joints.len(), 3);
//! assert!(diagram.is_complete());
//! # Ok::<(), continuation::diagram::DiagramError>(())
//! ```
//!
//! Where an imperfection keeps branches apart there is no joint to lead from one to the other. When no
//! ray is left, every branch is searched for near-bifurcations ([`crate::near_bifurcations`]), beside
//! which deflation looks for solutions that are on no known branch
//! ([`disconnected`](crate::deflation::disconnected)); the branch of each is followed both ways and
//! explored like the others.
//!
//! # What is found
//! Everything that is connected with the first branch through located branch points, within the domain
//! and to the depth asked for, as far as the tangents at the branch points are known: at points whose
//! form is [`Degenerate`](crate::Shape::Degenerate) they may not be, and of a continuous family one
//! branch is followed. Of disconnected branches those that come near a known one; that nothing more was
//! found proves nothing. Branches that a symmetry of the problem maps onto each other are different
//! branches.
//!
//! # Going on later
//! A diagram is its branches, in order: [`Explorer::resume`] takes those that are finished, and the one
//! that is not ([`DiagramProgress::unfinished`]), and goes on as if it had traced them. What is kept on
//! disk is the caller's affair; the format must know NaN.
//!
//! # Reference
//! - M. E. Henderson, Multiple parameter continuation, *International Journal of Bifurcation and
//!   Chaos* 12 (2002), 451-476, for the account of what is covered, in more parameters.

mod explorer;
mod follow;
mod joints;
mod settings;

pub use explorer::Explorer;
pub use settings::{DiagramSettings, Search};

use crate::branch::{Branch, Event, EventKind, Point, Shape, Statistics};
use crate::near::NearBifurcation;
use crate::settings::SettingsError;
use crate::tracer::{Progress, TraceError};
use follow::Part;
use serde::{Deserialize, Serialize};

/// Where a branch of a diagram begins.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Origin {
    /// At the solution from which the diagram starts.
    Start,
    /// At a branch point of another branch.
    Switch {
        /// The other branch.
        branch: usize,
        /// Its event.
        event: usize,
        /// Which of [`crate::Crossing::leaving`].
        direction: usize,
        /// Along that direction, or against it.
        forward: bool,
    },
    /// Disconnected from all others: at a solution found by deflation beside a near-bifurcation.
    Deflation {
        /// The branch with the near-bifurcation.
        branch: usize,
        /// Which of [`DiagramBranch::near`].
        near: usize,
        /// The parameter's value at the solution.
        parameter: f64,
    },
}

/// A branch of a diagram.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DiagramBranch {
    /// Its place in [`Diagram::branches`].
    pub id: usize,
    /// Where it begins.
    pub origin: Origin,
    /// How many branch points or searches lie between it and the first branch, by the way it was
    /// found.
    pub depth: usize,
    /// The branch.
    pub branch: Branch,
    /// Its near-bifurcations, if disconnected branches are sought.
    pub near: Vec<NearBifurcation>,
}

impl DiagramBranch {
    /// Number of its branch points at which it is not known for sure which branches leave: without a
    /// normal form, or with a degenerate one.
    pub fn unresolved(&self) -> usize {
        let unknown = |event: &&Event| {
            let shape = event.crossing().map(|crossing| crossing.shape);
            shape.is_none_or(|shape| shape == Shape::Degenerate)
        };
        self.branch.events_of(&EventKind::BranchPoint).filter(unknown).count()
    }
}

/// A branch point, and all places where it was met.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Joint {
    /// Branches that pass through it, with the number of the event on each.
    pub passed: Vec<(usize, usize)>,
    /// Branches that begin at it.
    pub begun: Vec<usize>,
    /// Rays that nothing has followed.
    pub open: usize,
}

/// Why the exploration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum DiagramStop {
    /// Everything asked for was followed.
    Complete,
    /// The largest number of branches was reached.
    MaxBranches,
    /// The observer asked to stop.
    Interrupted,
}

/// A bifurcation diagram.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Diagram {
    /// The branches, in the order in which they were traced; the first one begins at the start.
    pub branches: Vec<DiagramBranch>,
    /// The branch points that join them.
    pub joints: Vec<Joint>,
    /// Why it ended.
    pub stopped: DiagramStop,
}

impl Diagram {
    /// Whether everything asked for was followed, every branch to its end, no special point may have
    /// been missed for want of a certain count ([`Branch::is_certain`]), and at every branch point the
    /// branches that leave are known. What a step jumps over without a change of any count, and
    /// branches that hang together with none of these, are not part of the promise.
    pub fn is_complete(&self) -> bool {
        self.stopped == DiagramStop::Complete
            && self.branches.iter().all(|one| {
                one.branch.is_complete() && one.branch.is_certain() && one.unresolved() == 0
            })
    }

    /// What all branches together cost.
    pub fn statistics(&self) -> Statistics {
        let mut total = Statistics::default();
        for one in &self.branches {
            total.newton_iterations += one.branch.statistics.newton_iterations;
            total.accepted += one.branch.statistics.accepted;
            total.rejected += one.branch.statistics.rejected;
        }
        total
    }
}

/// What an observer is told after every point.
#[derive(Clone, Copy)]
pub struct DiagramProgress<'p> {
    /// Branches that are finished.
    pub branches: usize,
    /// Rays that wait to be followed.
    pub waiting: usize,
    /// Where the branch that is traced at the moment stands; without points while disconnected
    /// branches are sought, `p` being where.
    pub at: Progress,
    origin: Origin,
    part: Option<&'p dyn Fn() -> Part>,
}

impl DiagramProgress<'_> {
    /// A copy of the branch that is traced at the moment, with which [`Explorer::resume`] goes on in
    /// the middle of it. Costs as much as the branch has points; `None` where a branch is followed
    /// both ways, which is traced again from its beginning.
    pub fn unfinished(&self) -> Option<Unfinished> {
        self.part.map(|part| Unfinished { origin: self.origin, part: part() })
    }
}

/// A branch that is not finished.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Unfinished {
    origin: Origin,
    part: Part,
}

impl Unfinished {
    /// Its points so far.
    pub fn points(&self) -> &[Point] {
        &self.part.points
    }
}

/// Why there is no diagram.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DiagramError {
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The first branch cannot be traced.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// Nothing bounds the first branch.
    #[error(
        "nothing bounds the diagram: give a domain of the parameter, a target, or an observable \
         that stops"
    )]
    Unbounded,
    /// Branches of another diagram.
    #[error("the finished branches are not those of this diagram: branch {branch}: {what}")]
    Foreign {
        /// The first that does not fit.
        branch: usize,
        /// What does not fit.
        what: &'static str,
    },
}
