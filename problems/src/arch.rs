//! A shallow arch between two hinges, snapping through under a distributed load.
//!
//! Rise `y₀ = h sin x`, load `p(sin x + e sin 2x)` downwards, `x ∈ [0, π]`; heights in units of twice
//! the section's radius of gyration. Energy and thrust
//!
//! ```text
//! E = ½(2/π)∫(y″ − y₀″)² dx + ¼S² + p(2/π)∫y(sin x + e sin 2x) dx,   S = (2/π)∫(y₀′² − y′²) dx
//! ```
//! (Timoshenko, *J. Appl. Mech.* 2 (1935) 17; Fung & Kaplan, NACA TN 2840, 1952.) With
//! `y = b sin x + a sin 2x` and `e = 0` the answers are closed: the symmetric branch
//! `p = h − b + (h² − b²)b` snaps at the folds `b² = (h² − 1)/3`, `p = h ± 2((h² − 1)/3)^{3/2}`; where
//! the thrust reaches `S = 4`, at `b² = h² − 4`, `p = h ± 3√(h² − 4)`, a pitchfork leads to the
//! asymmetric branch `p = h + 3b`, `a² = (h² − 4 − b²)/4`, which joins the two points. It comes before
//! the fold for `h² > 5.5`. With `e ≠ 0` the pitchfork unfolds.
//!
//! **Discretisation.** Second-order differences on `N` interior nodes, trapezoid rule; `∂⁴` is the
//! square of `∂²`, as the hinges allow. Sines remain eigenvectors, `−∂² → m_k = (4/h_x²)sin²(kh_x/2)`,
//! so the discrete answers are closed too: folds at `p = m₁²(h ± 2((h² − 1)/3)^{3/2})`, pitchforks at
//! `b² = h² − m₂/m₁`, `p = m₁²(h − b) + m₁m₂b`. The Hessian is a band plus the rank-one term of the
//! thrust.

use crate::grid::Grid;
use crate::visit::hand;
use crate::{Allowed, Constant, Elements, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::linalg::SymmetricBand;
use continuation::{EvalError, Matrix, Name, ParamId, Parameter, Problem, Stability, names};
use std::f64::consts::PI;

/// See the module. Parameters: load, rise, asymmetry of the load.
#[derive(Debug, Clone)]
pub struct ShallowArch {
    grid: Grid,
    /// `2h_x/π`, so that `sin x` has length 1.
    weight: f64,
    /// `sin x` and `sin 2x` at the nodes.
    sine: [Vec<f64>; 2],
    /// Eigenvalue of `−∂²` for `sin x`.
    m1: f64,
    /// `∂⁴`.
    bending: SymmetricBand,
}

static PARAMETERS: [Parameter; 3] = [
    Parameter::new("load", "", 5.0),
    Parameter::new("rise", "", 1.0),
    Parameter::new("asymmetry", "", 0.1),
];

impl ShallowArch {
    /// With `n ≥ 3` interior nodes.
    pub fn new(n: usize) -> Self {
        let grid = Grid::new(n.max(3), PI);
        let n = grid.n;
        let side = 1.0 / (grid.h * grid.h);
        let mut bending = SymmetricBand::new(n, 2);
        for i in 0..n {
            let neighbours = usize::from(i > 0) + usize::from(i + 1 < n);
            bending.add(i, i, (4.0 + neighbours as f64) * side * side);
            if i + 1 < n {
                bending.add(i + 1, i, -4.0 * side * side);
            }
            if i + 2 < n {
                bending.add(i + 2, i, side * side);
            }
        }
        let sine = [1.0, 2.0].map(|k| (0..n).map(|i| (k * grid.x(i)).sin()).collect());
        let m1 = (2.0 / grid.h * (0.5 * grid.h).sin()).powi(2);
        ShallowArch { grid, weight: 2.0 * grid.h / PI, sine, m1, bending }
    }

    /// The unloaded arch.
    pub fn unloaded(&self, rise: f64) -> Vec<f64> {
        self.sine[0].iter().map(|s| rise * s).collect()
    }

    /// `−∂²y` at node `i`.
    fn curvature(&self, y: &[f64], i: usize) -> f64 {
        -self.grid.second(y, i, 0.0)
    }

    fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        self.weight * a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>()
    }

    fn thrust(&self, y: &[f64], rise: f64) -> f64 {
        let now: f64 = (0..y.len()).map(|i| y[i] * self.curvature(y, i)).sum();
        self.m1 * rise * rise - self.weight * now
    }
}

impl Problem for ShallowArch {
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
        let [load, rise, asymmetry] = [p[0], p[1], p[2]];
        let thrust = self.thrust(u, rise);
        let [one, two] = &self.sine;
        // bending moments of three neighbouring nodes; none beyond the ends
        let n = self.grid.n;
        let moment =
            |i: usize| if i < n { self.curvature(u, i) - self.m1 * rise * one[i] } else { 0.0 };
        let (mut before, mut here) = (0.0, moment(0));
        for (i, r) in r.iter_mut().enumerate() {
            let after = moment(i + 1);
            let bend = self.grid.second_of(before, here, after);
            (before, here) = (here, after);
            let elastic = -bend - thrust * self.curvature(u, i);
            *r = self.weight * (elastic + load * (one[i] + asymmetry * two[i]));
        }
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        let thrust = self.weight * self.thrust(u, p[1]);
        let side = 1.0 / (self.grid.h * self.grid.h);
        j.set_zero();
        j.axpy(self.weight, &self.bending);
        for i in 0..self.grid.n {
            let column = j.column_mut(i);
            column[0] -= 2.0 * thrust * side;
            if let Some(below) = column.get_mut(1) {
                *below += thrust * side;
            }
        }
        let (factor, v) = j.rank_one_mut();
        *factor = 2.0 * self.weight * self.weight;
        for (i, v) in v.iter_mut().enumerate() {
            *v = self.curvature(u, i);
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
        let [one, two] = &self.sine;
        for (i, out) in out.iter_mut().enumerate() {
            let value = match which.0 {
                0 => one[i] + p[2] * two[i],
                1 => -self.m1 * (self.m1 * one[i] + 2.0 * p[1] * self.curvature(u, i)),
                _ => p[0] * two[i],
            };
            *out = self.weight * value;
        }
        Ok(())
    }

    fn metric(&self, x: &[f64], y: &mut [f64]) {
        for (y, x) in y.iter_mut().zip(x) {
            *y = self.weight * x;
        }
    }

    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }

    /// The coefficients `b` of `sin x` and `a` of `sin 2x`, the height in the middle, the thrust.
    fn observables(&self) -> &[Name] {
        names!["symmetric", "asymmetric", "crown", "thrust"]
    }

    fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        out[0] = self.dot(&self.sine[0], u);
        out[1] = self.dot(&self.sine[1], u);
        out[2] = self.grid.middle(u, 0.0);
        out[3] = self.thrust(u, p[1]);
        Ok(())
    }
}

const FOLD: &str = "m1^2 (h +- 2 ((h^2 - 1)/3)^(3/2)), 99 nodes";
const BRANCH: &str = "m1^2 (h - b) + m1 m2 b, b^2 = h^2 - m2/m1, 99 nodes";

pub(crate) static ENTRY: Entry = Entry {
    name: "shallow-arch",
    summary: "a shallow arch snaps through: two folds, and two pitchforks to asymmetric shapes",
    parameter: "load",
    axes: &[
        ("load", "load p"),
        ("symmetric", "amplitude of sin x"),
        ("asymmetric", "amplitude of sin 2x"),
        ("crown", "height of the crown"),
        ("thrust", "thrust S"),
    ],
    start: 0.0,
    start_allowed: Allowed::Any,
    end: 10.0,
    parameters: &[
        Constant { name: "rise", default: 2.5, allowed: Allowed::Above(0.0) },
        Constant { name: "asymmetry", default: 0.0, allowed: Allowed::Any },
    ],
    elements: Some(Elements { default: 99, least: 8, most: 20_000, what: "interior nodes" }),
    known: &[
        Known::branch_point(6.998_354_840_182_087, 1e-9, BRANCH).form("pitchfork"),
        Known::fold(7.128_892_032_527_913, 1e-10, FOLD),
        Known::fold(-2.129_714_438_683_358, 1e-10, FOLD),
        Known::branch_point(-1.999_177_246_337_531, 1e-9, BRANCH).form("pitchfork"),
    ],
    id: Id::ShallowArch,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let problem = ShallowArch::new(request.elements);
    let u = problem.unloaded(request.parameter(0));
    Ok(hand(visitor, &problem, Setup::new(ENTRY.parameter, u, request)))
}
