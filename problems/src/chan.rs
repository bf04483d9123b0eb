//! Chan's model of a reacting slab (Chan, *SIAM J. Sci. Stat. Comput.* 5 (1984) 242):
//!
//! ```text
//! u″ + α g(u) = 0,   g = 1 + (u + u²/2)/(1 + βu²),   u(0) = u(1) = β
//! ```
//! Second-order finite differences, multiplied by the spacing; read as `∂u/∂t`. From `u = β` at
//! `α = 0`: with 101 nodes, ends included, and `β = 0.01` a fold at `α = 4.041160429041`.

use crate::grid::{Grid, diagonal};
use crate::visit::hand;
use crate::{Allowed, Constant, Elements, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::linalg::SymmetricBand;
use continuation::{EvalError, Matrix, Name, ParamId, Parameter, Problem, Stability, Watch, names};

/// See the module.
#[derive(Debug, Clone, Copy)]
pub struct Chan {
    grid: Grid,
}

static PARAMETERS: [Parameter; 2] =
    [Parameter::new("alpha", "", 1.0), Parameter::new("beta", "", 0.01)];

impl Chan {
    /// With `nodes ≥ 3` nodes, the two ends included.
    pub fn new(nodes: usize) -> Self {
        Chan { grid: Grid::new(nodes.saturating_sub(2), 1.0) }
    }
}

impl Problem for Chan {
    type Jacobian = SymmetricBand;

    fn dim(&self) -> usize {
        self.grid.n
    }

    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }

    fn new_jacobian(&self) -> SymmetricBand {
        SymmetricBand::new(self.grid.n, 1)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let (h, [alpha, beta]) = (self.grid.h, [p[0], p[1]]);
        for (i, r) in r.iter_mut().enumerate() {
            let x = u[i];
            let (before, after) = self.grid.neighbours(u, i, beta);
            let g = 1.0 + (x + 0.5 * x * x) / (1.0 + beta * x * x);
            *r = (before - 2.0 * x + after) / h + h * alpha * g;
        }
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        let (h, [alpha, beta]) = (self.grid.h, [p[0], p[1]]);
        j.set_zero();
        for (i, x) in u.iter().enumerate() {
            let d = 1.0 + beta * x * x;
            let slope = ((1.0 + x) * d - 2.0 * beta * x * (x + 0.5 * x * x)) / (d * d);
            let column = j.column_mut(i);
            column[0] = -2.0 / h + h * alpha * slope;
            if let Some(below) = column.get_mut(1) {
                *below = 1.0 / h;
            }
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let (h, [alpha, beta]) = (self.grid.h, [p[0], p[1]]);
        for (out, x) in out.iter_mut().zip(u) {
            let (n, d) = (x + 0.5 * x * x, 1.0 + beta * x * x);
            *out = h * if which.0 == 0 { 1.0 + n / d } else { -alpha * n * x * x / (d * d) };
        }
        if which.0 == 1 {
            out[0] += 1.0 / h;
            out[self.grid.n - 1] += 1.0 / h;
        }
        Ok(())
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        self.grid.weigh(x, y);
    }

    fn mass(&self, m: &mut SymmetricBand) -> bool {
        diagonal(m, self.grid.n, self.grid.h);
        true
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }

    fn observables(&self) -> &[Name] {
        names!["max_u"]
    }

    /// The maximum is in the middle.
    fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        out[0] = self.grid.middle(u, p[1]);
        Ok(())
    }
}

const END: f64 = 8.0;

pub(crate) static ENTRY: Entry = Entry {
    name: "chan",
    summary: "Chan's reacting slab u'' + alpha (1 + (u + u^2/2)/(1 + beta u^2)) = 0, fold at 4.0412",
    parameter: "alpha",
    axes: &[("alpha", "strength of the reaction α"), ("max_u", "largest u")],
    start: 0.0,
    start_allowed: Allowed::AtLeast(0.0),
    end: -1.0,
    parameters: &[Constant { name: "beta", default: 0.01, allowed: Allowed::AtLeast(0.0) }],
    elements: Some(Elements {
        default: 101,
        least: 5,
        most: 100_000,
        what: "nodes, the ends included",
    }),
    known: &[Known::fold(4.041_160_429_041, 1e-11, "recomputed in multiple precision, 101 nodes")],
    id: Id::Chan,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let problem = Chan::new(request.elements);
    let u = vec![request.parameter(0); problem.dim()];
    let setup = Setup::new(ENTRY.parameter, u, request).upwards();
    Ok(hand(visitor, &problem, setup.watching(Watch::stop_at("max_u", END))))
}
