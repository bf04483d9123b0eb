//! What can go wrong.

use continuation::{EvalError, TraceError};
use shell_contact::ParameterError;

/// Why the model has no value for some parameters.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A parameter is outside what the model allows.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A state could not be evaluated.
    #[error("a state of the branch could not be evaluated: {0}")]
    Evaluation(#[from] EvalError),
    /// The branch has no start.
    #[error("the branch has no start: {0}")]
    Trace(#[from] TraceError),
    /// The branch ends before the data do.
    #[error("the branch ends at an approach of {reached:.3e} m; the data go to {needed:.3e} m")]
    TooShort {
        /// Farthest approach of the branch, m.
        reached: f64,
        /// Farthest approach of the data, m.
        needed: f64,
    },
    /// No part of the branch is stable under this lever.
    #[error("no part of the branch is stable under this lever")]
    NothingStable,
}

/// Why there is no fit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// A quantity that must be known is not.
    #[error("{key}: not known; give its value in the file of known values, or free it")]
    Unknown {
        /// Which.
        key: &'static str,
    },
    /// No noise: a computed curve, or a constant one.
    #[error("force: no noise can be read off; a fit needs the noise of at least 8 samples")]
    NoNoise,
    /// The force never rises clearly above the baseline.
    #[error(
        "force: no contact: the force at the least height does not rise above the noise in at least \
         {fewest} samples; check the sign of the force (data.force_sign) and that height falls on approach"
    )]
    NoContact {
        /// Fewest samples in contact.
        fewest: usize,
    },
    /// Too few samples in contact.
    #[error("force: {found} samples in contact; at least {fewest} are needed: measure farther or denser")]
    FewInContact {
        /// How many there are.
        found: usize,
        /// How many are needed.
        fewest: usize,
    },
    /// Contact from the first sample on.
    #[error(
        "force: {found} samples of baseline before contact; at least {fewest} are needed, or offset and \
         contact point cannot be told apart: start farther away"
    )]
    NoBaseline {
        /// How many there are.
        found: usize,
        /// How many are needed.
        fewest: usize,
    },
    /// Units that cannot be.
    #[error(
        "height: the piezo moves by {span:.3e} m, the bubble's radius is {radius:.3e} m; one of the units \
         is wrong (data.height_unit, physical.radius)"
    )]
    Scale {
        /// Travel of the piezo, m.
        span: f64,
        /// Radius, m.
        radius: f64,
    },
    /// No start leads anywhere.
    #[error("no shell of the grid of starts has a branch that spans the data")]
    NoStart,
    /// The model has no value at the end.
    #[error(transparent)]
    Model(ModelError),
}
