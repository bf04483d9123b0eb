//! The elastic column of Euler, exact geometry:
//!
//! ```text
//! −θ″ = λ sin θ,   θ = 0 at both ends
//! ```
//! `θ` is the rotation of the axis, `λ = PL²/EI` the load; both ends are held against rotation, one
//! is free to move sideways and along. Second-order differences on `N` interior nodes with the
//! factor `1/h²` left in: the determinant overflows from a hundred nodes on, which must not matter.
//!
//! The straight column `θ = 0` has branch points, pitchforks, at `λ = (4/h²)sin²(kπh/2)`,
//! `h = 1/(N + 1)`: the first at 9.861160440778, 9.868808678860, 9.869591749270 for `N` = 30, 100,
//! 800. The buckled column is that of Euler's elastica: `√λ = 2K(sin θ_max/2)`, `K` the complete
//! elliptic integral, which tends to `π²`.

use crate::grid::Grid;
use crate::visit::hand;
use crate::{Allowed, Elements, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::linalg::SymmetricBand;
use continuation::{EvalError, Matrix, Name, ParamId, Parameter, Problem, Stability, names};
use std::f64::consts::PI;

/// See the module.
#[derive(Debug, Clone, Copy)]
pub struct EulerColumn {
    grid: Grid,
}

static PARAMETERS: [Parameter; 1] = [Parameter::new("lambda", "EI/L^2", 10.0)];

impl EulerColumn {
    /// With `n ≥ 1` interior nodes.
    pub fn new(n: usize) -> Self {
        EulerColumn { grid: Grid::new(n, 1.0) }
    }

    /// The buckling load with `k` half waves of the rotation.
    pub fn branch_point(&self, k: usize) -> f64 {
        let h = self.grid.h;
        (2.0 / h * (0.5 * k as f64 * PI * h).sin()).powi(2)
    }
}

impl Problem for EulerColumn {
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
        let stiffness = 1.0 / (self.grid.h * self.grid.h);
        for (i, r) in r.iter_mut().enumerate() {
            let (before, after) = self.grid.neighbours(u, i, 0.0);
            *r = stiffness * (2.0 * u[i] - before - after) - p[0] * u[i].sin();
        }
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        let stiffness = 1.0 / (self.grid.h * self.grid.h);
        j.set_zero();
        for (i, u) in u.iter().enumerate() {
            let column = j.column_mut(i);
            column[0] = 2.0 * stiffness - p[0] * u.cos();
            if let Some(below) = column.get_mut(1) {
                *below = -stiffness;
            }
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
            *out = -u.sin();
        }
        Ok(())
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        self.grid.weigh(x, y);
    }

    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }

    /// `f` is the gradient of the energy over the spacing, so that eigenvalues are those of `f_u`.
    fn mass(&self, m: &mut SymmetricBand) -> bool {
        crate::grid::diagonal(m, self.grid.n, 1.0);
        true
    }

    /// Rotation in the middle; how far the free end has come nearer, and has moved sideways, over
    /// the length; the norm of the rotation.
    fn observables(&self) -> &[Name] {
        names!["rotation", "shortening", "sway", "norm"]
    }

    fn observe(&self, u: &[f64], _p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        let h = self.grid.h;
        out[0] = self.grid.middle(u, 0.0);
        // 1 − cos θ without cancellation
        out[1] = h * u.iter().map(|u| 2.0 * (0.5 * u).sin().powi(2)).sum::<f64>();
        out[2] = h * u.iter().map(|u| u.sin()).sum::<f64>();
        out[3] = self.grid.norm(u);
        Ok(())
    }
}

pub(crate) static ENTRY: Entry = Entry {
    name: "euler-column",
    summary: "Euler's elastic column -u'' = lambda sin u, buckling at pi^2 up to the mesh",
    parameter: "lambda",
    axes: &[
        ("lambda", "load λ = PL²/(EI)"),
        ("rotation", "rotation in the middle θ"),
        ("shortening", "shortening over length"),
        ("sway", "sideways displacement over length"),
        ("norm", "norm of θ"),
    ],
    start: 9.0,
    start_allowed: Allowed::Any,
    end: 11.0,
    parameters: &[],
    elements: Some(Elements { default: 800, least: 8, most: 100_000, what: "interior nodes" }),
    known: &[Known::branch_point(
        9.869_591_749_270,
        1e-10,
        "(4/h^2) sin^2(pi h/2) with 800 nodes; pi^2 in the limit",
    )
    .form("pitchfork")],
    id: Id::EulerColumn,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let problem = EulerColumn::new(request.elements);
    let setup = Setup::new(ENTRY.parameter, vec![0.0; problem.dim()], request);
    Ok(hand(visitor, &problem, setup))
}
