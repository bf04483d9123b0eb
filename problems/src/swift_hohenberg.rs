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

use crate::grid::Grid;
use crate::{Allowed, Elements, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::linalg::SymmetricBand;
use continuation::{EvalError, Matrix, ParamId, Parameter, Problem, Stability};
use std::cell::RefCell;
use std::f64::consts::PI;

/// Length of the interval.
const LENGTH: f64 = 12.06;

/// See the module.
#[derive(Debug, Clone)]
pub struct SwiftHohenberg {
    grid: Grid,
    /// `(1 + ∂²)²`.
    operator: SymmetricBand,
    /// `(1 + ∂²)u`.
    scratch: RefCell<Vec<f64>>,
}

const PARAMETERS: [Parameter; 1] = [Parameter { name: "lambda", unit: "", scale: 1.0 }];

impl SwiftHohenberg {
    /// With `n ≥ 1` interior nodes.
    pub fn new(n: usize) -> Self {
        let grid = Grid::new(n, LENGTH);
        let n = grid.n;
        let side = 1.0 / (grid.h * grid.h);
        let middle = 1.0 - 2.0 * side;
        let mut operator = SymmetricBand::new(n, 2);
        for i in 0..n {
            let neighbours = usize::from(i > 0) + usize::from(i + 1 < n);
            operator.add(i, i, middle * middle + neighbours as f64 * side * side);
            if i + 1 < n {
                operator.add(i + 1, i, 2.0 * middle * side);
            }
            if i + 2 < n {
                operator.add(i + 2, i, side * side);
            }
        }
        SwiftHohenberg { grid, operator, scratch: RefCell::new(vec![0.0; n]) }
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
        self.grid.n
    }

    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }

    fn new_jacobian(&self) -> SymmetricBand {
        SymmetricBand::new(self.grid.n, 2)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let mut v = self.scratch.borrow_mut();
        for (i, v) in v.iter_mut().enumerate() {
            *v = u[i] + self.grid.second(u, i, 0.0);
        }
        for (i, r) in r.iter_mut().enumerate() {
            let square = u[i] * u[i];
            let growth = u[i] * (p[0] + square * (2.0 - square));
            *r = growth - (v[i] + self.grid.second(&v, i, 0.0));
        }
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        j.set_zero();
        j.axpy(-1.0, &self.operator);
        for (i, u) in u.iter().enumerate() {
            let square = u * u;
            j.add(i, i, p[0] + square * (6.0 - 5.0 * square));
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
        out.copy_from_slice(u);
        Ok(())
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        self.grid.weigh(x, y);
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }

    fn observables(&self) -> &[&'static str] {
        &["norm", "max_u"]
    }

    fn observe(&self, u: &[f64], _p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        out[0] = self.grid.norm(u);
        out[1] = u.iter().fold(0.0, |m, u| m.max(u.abs()));
        Ok(())
    }
}

// to rounding of the operator, 1e-16/h⁴
const SOURCE: &str = "(1 - m_k)^2 with the eigenvalues m_k of second-order differences, N = 200";

pub(crate) static ENTRY: Entry = Entry {
    name: "swift-hohenberg",
    summary: "Swift-Hohenberg equation on an interval: the first five pitchforks of u = 0",
    parameter: "lambda",
    start: -0.1,
    start_allowed: Allowed::Any,
    end: 1.0,
    parameters: &[],
    elements: Some(Elements { default: 200, least: 16, most: 20_000, what: "interior nodes" }),
    known: &[
        Known::branch_point(0.007_290_527_145_4, 2e-8, SOURCE).form("pitchfork"),
        Known::branch_point(0.151_620_023_068_8, 1e-9, SOURCE).form("pitchfork"),
        Known::branch_point(0.483_863_105_485_9, 3e-10, SOURCE).form("pitchfork"),
        Known::branch_point(0.530_839_826_487_6, 3e-10, SOURCE).form("pitchfork"),
        Known::branch_point(0.868_890_096_696_8, 3e-10, SOURCE).form("pitchfork"),
    ],
    id: Id::SwiftHohenberg,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let problem = SwiftHohenberg::new(request.elements);
    let setup = Setup::new(ENTRY.parameter, vec![0.0; problem.dim()], request);
    Ok(visitor.visit(&problem, setup))
}
