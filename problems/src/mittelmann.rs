//! Mittelmann's problem `Δu − 10(u − λeᵘ) = 0` on the unit square, no flux through its sides
//! (Mittelmann, *SIAM J. Numer. Anal.* 23 (1986) 1007; BifurcationKit.jl, tutorial of that name).
//!
//! Second-order differences on `N × N` square cells of side `h = 1/N`, the unknowns in their
//! centres, multiplied by `h²`; read as `∂u/∂t`. A centred Laplacian without flux through the sides
//! has the eigenvalues `−(m_j + m_k)`, `m_j = (4/h²)sin²(jπh/2)`, `j, k = 0 … N − 1`.
//!
//! The trace follows the constant solutions `λ = ue^{−u}` from 0 up through the fold `λ = e⁻¹` and
//! down to `path.end`, met after the fold. Their branch points are at `u = 1 + (m_j + m_k)/10`:
//! double where `j ≠ k`, first `λ = 0.272435228668` (`(j, k) = (0, 1)`, `N → ∞`; 0.272557236618 for
//! `N = 30`), simple where `j = k`, first 0.151974940576.

use crate::visit::hand;
use crate::{Allowed, Elements, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::linalg::SymmetricBand;
use continuation::{EvalError, Matrix, Name, ParamId, Parameter, Problem, Stability, Watch, names};
use std::f64::consts::{E, PI};

/// See the module.
#[derive(Debug, Clone, Copy)]
pub struct Mittelmann {
    n: usize,
    h: f64,
}

static PARAMETERS: [Parameter; 1] = [Parameter::new("lambda", "", 0.4)];

impl Mittelmann {
    /// With `n ≥ 2` cells along a side.
    pub fn new(n: usize) -> Self {
        let n = n.max(2);
        Mittelmann { n, h: 1.0 / n as f64 }
    }

    /// The branch point of the constant solutions with the mode `cos jπx cos kπy`: `(λ, u)`.
    pub fn branch_point(&self, j: usize, k: usize) -> (f64, f64) {
        let m = |j: usize| (2.0 / self.h * (0.5 * j as f64 * PI * self.h).sin()).powi(2);
        let u = 1.0 + 0.1 * (m(j) + m(k));
        (u * (-u).exp(), u)
    }

    fn neighbours(&self, at: usize) -> impl Iterator<Item = usize> {
        let (n, i, j) = (self.n, at % self.n, at / self.n);
        let pick = |there: bool, to: usize| there.then_some(to);
        [
            pick(i > 0, at.wrapping_sub(1)),
            pick(i + 1 < n, at + 1),
            pick(j > 0, at.wrapping_sub(n)),
            pick(j + 1 < n, at + n),
        ]
        .into_iter()
        .flatten()
    }
}

impl Problem for Mittelmann {
    type Jacobian = SymmetricBand;

    fn dim(&self) -> usize {
        self.n * self.n
    }

    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }

    fn new_jacobian(&self) -> SymmetricBand {
        SymmetricBand::new(self.dim(), self.n)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let area = self.h * self.h;
        for (at, r) in r.iter_mut().enumerate() {
            let flux: f64 = self.neighbours(at).map(|b| u[b] - u[at]).sum();
            *r = flux - 10.0 * area * (u[at] - p[0] * u[at].exp());
        }
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        let area = self.h * self.h;
        j.set_zero();
        for at in 0..self.dim() {
            let mut count = 0.0;
            for b in self.neighbours(at) {
                count += 1.0;
                if b > at {
                    j.add(b, at, 1.0);
                }
            }
            j.add(at, at, -count - 10.0 * area * (1.0 - p[0] * u[at].exp()));
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        _p: &[f64],
        _which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        for (out, u) in out.iter_mut().zip(u) {
            *out = 10.0 * self.h * self.h * u.exp();
        }
        Ok(())
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        for (y, x) in y.iter_mut().zip(x) {
            *y = self.h * self.h * x;
        }
    }

    fn mass(&self, m: &mut SymmetricBand) -> bool {
        crate::grid::diagonal(m, self.dim(), self.h * self.h);
        true
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }

    fn observables(&self) -> &[Name] {
        names!["max_u", "mean_u"]
    }

    fn observe(&self, u: &[f64], _p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        out[0] = u.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        out[1] = u.iter().sum::<f64>() * self.h * self.h;
        Ok(())
    }
}

pub(crate) static ENTRY: Entry = Entry {
    name: "mittelmann",
    summary: "Laplace u - 10 (u - lambda exp(u)) = 0 on a square: a fold, double and simple points",
    parameter: "lambda",
    axes: &[
        ("lambda", "strength of the source λ"),
        ("max_u", "largest u"),
        ("mean_u", "integral of u"),
    ],
    start: 0.0,
    start_allowed: Allowed::Within(0.0, 0.3678),
    end: 0.05,
    parameters: &[],
    elements: Some(Elements { default: 30, least: 4, most: 200, what: "cells along a side" }),
    known: &[
        Known::fold(0.367_879_441_171_442_3, 1e-11, "1/e"),
        Known::branch_point(
            0.272_557_236_617_5,
            1e-11,
            "u = 1 + m/10, 30 x 30 cells; 0.272435228668 in the limit",
        )
        .form("double"),
        Known::branch_point(
            0.152_156_915_875_0,
            1e-11,
            "u = 1 + m/10, 30 x 30 cells; 0.151974940576 in the limit",
        )
        .form("pitchfork"),
    ],
    id: Id::Mittelmann,
};

/// The constant solution at `λ`, below or above the fold: a root of `ln u − u − ln λ`, which is
/// concave, by Newton's method from outside.
fn constant(lambda: f64, above: bool) -> f64 {
    let mut u = if above { 2.0 - 2.0 * lambda.ln() } else { lambda };
    for _ in 0..60 {
        if above {
            u -= (u.ln() - u - lambda.ln()) / (1.0 / u - 1.0);
        } else {
            u -= (u - lambda * u.exp()) / (1.0 - lambda * u.exp());
        }
    }
    u
}

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let problem = Mittelmann::new(request.elements);
    let u = vec![constant(request.start, false); problem.dim()];
    let mut setup = Setup::new(ENTRY.parameter, u, request).upwards();
    if let Some(end) = request.settings.target
        && end > 0.0
        && end < 1.0 / E
    {
        // that value is met on the way up too, but meant is the one beyond the fold
        setup.settings.target = None;
        setup = setup.watching(Watch::stop_at("mean_u", constant(end, true)));
    }
    Ok(hand(visitor, &problem, setup))
}
