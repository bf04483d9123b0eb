//! One step along a branch: predict, correct, judge; accepted, or refused with a reason.

mod corner;
mod corrector;
mod guard;
mod judge;
mod size;
mod stability;
mod state;
mod weights;

pub(crate) use corrector::{Constraint, Core, Corrected, Precision, curve_scale};
pub(crate) use guard::Guard;
pub(crate) use judge::judge;
pub(crate) use size::StepSize;
pub(crate) use stability::hessian_inertia;
pub(crate) use state::State;
pub(crate) use weights::{Weights, dot};

use crate::problem::EvalError;

/// Why a step was refused; [`crate::guide::troubleshooting`] says what to do where that ends a trace.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// The problem has no value at the predicted or an iterated state.
    #[error("{0}")]
    Evaluation(EvalError),
    /// The corrector converges too slowly or not at all.
    #[error("the corrector does not converge (contraction {contraction:.2e})")]
    Contraction {
        /// Ratio of successive corrections.
        contraction: f64,
    },
    /// The bordered Jacobian is singular.
    #[error("the bordered Jacobian is singular")]
    Singular,
    /// The solution found is too far from the predicted one.
    #[error("the solution is far from the prediction ({ratio:.2} of the step)")]
    FarFromPrediction {
        /// First correction over step length, in the scaled metric.
        ratio: f64,
    },
    /// The tangent turns too much.
    #[error("the branch turns by {angle:.2} radians in one step")]
    Turn {
        /// Angle in radians, in the scaled metric.
        angle: f64,
    },
    /// The orientation of the branch changed: a branch point, a jump or a reversal.
    #[error("the orientation of the branch changes within the step")]
    Orientation,
    /// The orientation changes though there is no branch point: two branches pass each other so
    /// closely that the step jumps from one to the other.
    #[error("the step jumps to another branch, {gap:.1e} away")]
    BranchesClose {
        /// Distance between the branches, in the problem's metric.
        gap: f64,
    },
    /// More modes become critical close together than are told apart.
    #[error("{modes} modes become critical too close together to be told apart")]
    ManyModes {
        /// How many.
        modes: usize,
    },
    /// The step ends on a special point, where the sides of it cannot be told apart.
    #[error("the step ends on a special point")]
    OnSpecialPoint,
    /// The step of a curve of special points ends where two of them meet: states there are not
    /// determined by their equations.
    #[error("two special points of the curve meet there")]
    Meeting,
    /// The step away from a branch point fell back onto the branch that led to it.
    #[error("the step falls back onto the branch that led to the branch point")]
    OldBranch,
    /// The number of unstable modes changed without a special point that explains it.
    #[error("the number of unstable modes changes without a fold")]
    Stability,
    /// An observable or the parameter varies too much for its events to be told apart.
    #[error("an observed function is not resolved by the step")]
    Unresolved,
    /// The step ends where the parameter stands still to rounding, so that a fold cannot be told from
    /// none.
    #[error("the parameter stands still to rounding at the end of the step")]
    Plateau,
    /// More than one special point in the step.
    #[error("more than one special point within the step")]
    SeveralEvents,
}
