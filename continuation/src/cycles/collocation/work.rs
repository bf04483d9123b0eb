//! Work space of the collocation equations, and what it keeps from one evaluation to the next.

use crate::any_problem::DynProblem;
use crate::cycles::floquet::{Latest, Multiplier};
use crate::cycles::matrix::CycleMatrix;
use crate::linalg::AnyMatrix;

pub(super) struct Work {
    /// States at the Gauss points of an interval, and their derivatives times its length.
    pub(super) u: Vec<f64>,
    pub(super) du: Vec<f64>,
    /// The unknowns of an interval, its right end included.
    pub(super) nodes: Vec<f64>,
    pub(super) f: Vec<f64>,
    pub(super) jacobian: AnyMatrix,
    /// Its entries, row by row.
    pub(super) slopes: Vec<f64>,
    pub(super) unit: Vec<f64>,
    /// For the metric.
    pub(super) weighed: Vec<f64>,
    /// The state and the parameters whose multipliers are known.
    pub(super) known: Known,
    /// Where and in which direction the slopes of their functions are known, and these.
    pub(super) along: Vec<f64>,
    pub(super) slopes_along: [f64; 2],
    pub(super) shifted: Vec<f64>,
    pub(super) latest: Latest,
    /// For the multipliers alone.
    pub(super) matrix: Option<CycleMatrix>,
}

impl Work {
    /// For cycles of this degree on so many intervals.
    pub(super) fn new(problem: &DynProblem<'_>, degree: usize, intervals: usize) -> Self {
        let n = problem.dim();
        let vector = |blocks: usize| vec![0.0; blocks * n];
        Work {
            u: vector(degree),
            du: vector(degree),
            nodes: vector(degree + 1),
            f: vector(1),
            jacobian: problem.new_jacobian(),
            slopes: vector(n),
            unit: vector(1),
            weighed: vector(2),
            known: Known::default(),
            along: Vec::new(),
            slopes_along: [0.0; 2],
            shifted: vec![0.0; intervals * degree * n + 1],
            latest: Latest::default(),
            matrix: None,
        }
    }
}

/// The multipliers at a state.
#[derive(Default)]
pub(super) struct Known {
    /// The state and the parameters.
    pub(super) at: Vec<f64>,
    pub(super) multipliers: Vec<Multiplier>,
    pub(super) tests: [f64; 2],
}

impl Known {
    pub(super) fn is_at(&self, x: &[f64], p: &[f64]) -> bool {
        let known = self.at.len() == x.len() + p.len();
        known && self.at[..x.len()] == *x && self.at[x.len()..] == *p
    }
}
