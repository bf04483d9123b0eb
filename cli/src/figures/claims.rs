//! Statements of the paper against what was computed.

use super::curve::Traced;
use serde::Serialize;

/// What the numbers say of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Verdict {
    /// The computed value is within the tolerance.
    Agrees,
    /// It is not.
    Disagrees,
    /// The paper does not say enough, or the computation did not get there.
    CannotBeDecided,
}

/// A statement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Claim {
    /// The figure it is about.
    pub(crate) figure: u32,
    /// What the paper says.
    pub(crate) statement: String,
    /// Its value.
    pub(crate) paper: Option<f64>,
    /// The computed one.
    pub(crate) ours: Option<f64>,
    /// Unit of both.
    pub(crate) unit: String,
    /// How far apart they may be, in words that the verdict follows.
    pub(crate) tolerance: String,
    /// The verdict.
    pub(crate) verdict: Verdict,
    /// Why.
    pub(crate) why: String,
}

/// All statements about the figures whose branches these are.
pub(super) fn of(_traced: &[Traced]) -> Vec<Claim> {
    Vec::new()
}
