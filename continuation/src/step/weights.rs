//! The scaled metric in which tangents are normalised, angles measured and corrections compared.
//!
//! The problem's metric `ds² = du·M du + dp²` says what a step length means to the user. It is
//! not what decides whether two tangents are parallel: with unknowns in metres and a parameter
//! in pascals one of them would count for nothing. The scaled metric divides `u` and `p` by
//! their ranges, so that the tracer does the same under `u → b u`, `p → c p`.

use serde::{Deserialize, Serialize};

/// Divisors of the unknowns and of the parameter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Weights {
    /// Scale of the unknowns, in the problem's metric.
    pub(crate) unknowns: f64,
    /// Scale of the parameter.
    pub(crate) parameter: f64,
}

impl Weights {
    /// Inner product of `(a, ap)` and `(b, bp)`, where `ma = M a`.
    pub(crate) fn dot(&self, ma: &[f64], ap: f64, b: &[f64], bp: f64) -> f64 {
        dot(ma, b) / (self.unknowns * self.unknowns) + ap * bp / (self.parameter * self.parameter)
    }

    /// Norm of `(x, p)`, where `mx = M x`.
    pub(crate) fn norm(&self, mx: &[f64], x: &[f64], p: f64) -> f64 {
        self.dot(mx, p, x, p).max(0.0).sqrt()
    }
}

/// Plain inner product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
