//! Numerical continuation and bifurcation analysis of equilibria `f(u, p) = 0`.
//!
//! Floors, from the ground up; each uses only floors below it:
//! [`linalg`] → [`problem`] → [`branch`].

pub mod branch;
pub mod linalg;
pub mod problem;

pub use branch::{Branch, BranchPoint, Event, EventKind, Statistics, Stop, StopReason};
pub use linalg::{Facts, Matrix};
pub use problem::{EvalError, ParamId, Parameter, Problem, Stability};
