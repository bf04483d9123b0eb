//! The Swift-Hohenberg equation with a destabilising cubic term, on an interval:
//!
//! ```text
//! ∂u/∂t = −(1 + ∂²)²u + λu + 2u³ − u⁵,   u = u″ = 0 at the ends
//! ```
//! (Swift & Hohenberg, *Phys. Rev. A* 15 (1977) 319; BifurcationKit.jl, tutorial 1d
//! Swift-Hohenberg.) `∂² = tridiag(1, −2, 1)/h²` on `N` interior nodes, `h = 12.06/(N + 1)`: 0.06 for
//! `N = 200`. `u = 0` has its branch points, all pitchforks, at `λ = (1 − m_k)²`,
//! `m_k = (4/h²)sin²(kπ/(2N + 2))`: for `N = 200` 0.0072905271454, 0.1516200230688, 0.4838631054859,
//! 0.5308398264876, 0.8688900966968.
//!
//! The assembled square of `1 + ∂²` has entries of size `h⁻⁴`, whose rounding alone moves these
//! values by 1e-10. In the mixed form, `v = (1 + ∂²)u` is an unknown besides `u`, and the equations
//! are those of a stationary
//! `Σ v (1 + ∂²)u − v²/2 − λu²/2 − u⁴/2 + u⁶/6`: entries of size `h⁻²` keep twelve digits. Each `v`
//! adds a negative eigenvalue that is no instability.

use crate::grid::Grid;
use crate::visit::hand;
use crate::{Allowed, Elements, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::linalg::SymmetricBand;
use continuation::{EvalError, Matrix, Name, ParamId, Parameter, Problem, Stability, names};
use std::f64::consts::PI;

/// Length of the interval.
const LENGTH: f64 = 12.06;

/// See the module. Unknowns are `v` and `u` in turn, node by node.
#[derive(Debug, Clone)]
pub struct SwiftHohenberg {
    grid: Grid,
}

static PARAMETERS: [Parameter; 1] = [Parameter::new("lambda", "", 1.0)];

/// Number of unknowns per node; `v` comes first, `u` second.
const PER_NODE: usize = 2;

impl SwiftHohenberg {
    /// With `n ≥ 1` interior nodes.
    pub fn new(n: usize) -> Self {
        SwiftHohenberg { grid: Grid::new(n, LENGTH) }
    }

    /// `(1 + ∂²)x` at node `i`, of the field that is `part` of the unknowns.
    fn operator(&self, x: &[f64], part: usize, i: usize) -> f64 {
        let at = |i: usize| x[PER_NODE * i + part];
        let before = if i == 0 { 0.0 } else { at(i - 1) };
        let after = if i + 1 < self.grid.n { at(i + 1) } else { 0.0 };
        let middle = at(i);
        middle + ((after - middle) - (middle - before)) / (self.grid.h * self.grid.h)
    }

    fn values<'x>(&self, x: &'x [f64]) -> impl Iterator<Item = f64> + 'x {
        x.iter().skip(1).step_by(PER_NODE).copied()
    }

    /// The branch point of `u = 0` with `k` half waves.
    pub fn branch_point(&self, k: usize) -> f64 {
        let wave = 2.0 / self.grid.h * (0.5 * k as f64 * PI / (self.grid.n as f64 + 1.0)).sin();
        (1.0 - wave * wave).powi(2)
    }
}

impl Problem for SwiftHohenberg {
    type Jacobian = SymmetricBand;

    fn dim(&self) -> usize {
        PER_NODE * self.grid.n
    }

    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }

    fn new_jacobian(&self) -> SymmetricBand {
        SymmetricBand::new(self.dim(), PER_NODE + 1)
    }

    fn residual(&self, x: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        for (i, r) in r.chunks_exact_mut(PER_NODE).enumerate() {
            let (v, u) = (x[PER_NODE * i], x[PER_NODE * i + 1]);
            let square = u * u;
            r[0] = self.operator(x, 1, i) - v;
            r[1] = self.operator(x, 0, i) - u * (p[0] + square * (2.0 - square));
        }
        Ok(())
    }

    fn jacobian(&self, x: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        let side = 1.0 / (self.grid.h * self.grid.h);
        j.set_zero();
        for (i, u) in self.values(x).enumerate() {
            let square = u * u;
            let (v, u) = (PER_NODE * i, PER_NODE * i + 1);
            j.add(v, v, -1.0);
            j.add(u, v, 1.0 - 2.0 * side);
            j.add(u, u, -(p[0] + square * (6.0 - 5.0 * square)));
            if i + 1 < self.grid.n {
                j.add(v + PER_NODE, u, side);
                j.add(u + PER_NODE, v, side);
            }
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        x: &[f64],
        _p: &[f64],
        _which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        for (out, x) in out.chunks_exact_mut(PER_NODE).zip(x.chunks_exact(PER_NODE)) {
            (out[0], out[1]) = (0.0, -x[1]);
        }
        Ok(())
    }

    /// That of `L²` for `u`; `v` does not count.
    fn metric(&self, x: &[f64], y: &mut [f64]) {
        for (y, x) in y.chunks_exact_mut(PER_NODE).zip(x.chunks_exact(PER_NODE)) {
            (y[0], y[1]) = (0.0, self.grid.h * x[1]);
        }
    }

    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }

    fn multipliers(&self) -> usize {
        self.grid.n
    }

    fn observables(&self) -> &[Name] {
        names!["norm", "max_u"]
    }

    fn observe(&self, x: &[f64], _p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        let square: f64 = self.values(x).map(|u| u * u).sum();
        out[0] = (self.grid.h * square).sqrt();
        out[1] = self.values(x).fold(0.0, |m, u| m.max(u.abs()));
        Ok(())
    }
}

const SOURCE: &str = "(1 - m_k)^2 with the eigenvalues m_k of second-order differences, N = 200";

pub(crate) static ENTRY: Entry = Entry {
    name: "swift-hohenberg",
    summary: "Swift-Hohenberg equation on an interval: the first five pitchforks of u = 0",
    parameter: "lambda",
    axes: &[("lambda", "driving λ"), ("norm", "norm of u"), ("max_u", "largest |u|")],
    start: -0.1,
    start_allowed: Allowed::Any,
    end: 1.0,
    parameters: &[],
    elements: Some(Elements { default: 200, least: 16, most: 20_000, what: "interior nodes" }),
    known: &[
        Known::branch_point(0.007_290_527_145_4, 1e-11, SOURCE).form("pitchfork"),
        Known::branch_point(0.151_620_023_068_8, 1e-11, SOURCE).form("pitchfork"),
        Known::branch_point(0.483_863_105_485_9, 1e-11, SOURCE).form("pitchfork"),
        Known::branch_point(0.530_839_826_487_6, 1e-11, SOURCE).form("pitchfork"),
        Known::branch_point(0.868_890_096_696_8, 1e-11, SOURCE).form("pitchfork"),
    ],
    id: Id::SwiftHohenberg,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let problem = SwiftHohenberg::new(request.elements);
    let setup = Setup::new(ENTRY.parameter, vec![0.0; problem.dim()], request);
    Ok(hand(visitor, &problem, setup))
}
