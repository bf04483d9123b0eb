//! Branch points of a stiff operator: met as far as the rounding of the Jacobian's entries allows,
//! with an estimate that says so, a normal form and the counts on both sides.

use super::crossings::{Entries, trace_with};
use continuation::linalg::{Band, Dense, Sparse};
use continuation::{
    Detail, EvalError, EventKind, ParamId, Parameter, Problem, Settings, Shape, Stability,
    Statistics, StopReason,
};
use std::marker::PhantomData;

/// Kuramoto and Sivashinsky's equation, `ν u⁗ + u″ + u u′ = 0`, odd, on an interval of length π.
/// Branch points of `u = 0` at `ν = 1/μ_k`, `μ_k = (4/h²) sin²(kh/2)`.
struct KuramotoSivashinsky<J> {
    n: usize,
    matrix: PhantomData<fn() -> J>,
}

const SECOND: [f64; 5] = [0.0, 1.0, -2.0, 1.0, 0.0];
const FOURTH: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];

impl<J: Entries> KuramotoSivashinsky<J> {
    fn h(&self) -> f64 {
        std::f64::consts::PI / (self.n + 1) as f64
    }

    fn mu(&self, k: usize) -> f64 {
        4.0 / self.h().powi(2) * (0.5 * k as f64 * self.h()).sin().powi(2)
    }

    /// The unknown at row `i + d − 2` and its sign, by the odd continuation.
    fn neighbour(&self, i: usize, d: usize) -> Option<(usize, f64)> {
        let (k, n) = (i as isize + d as isize - 2, self.n as isize);
        match k {
            k if k == -1 || k == n => None,
            k if k < 0 => Some(((-2 - k) as usize, -1.0)),
            k if k > n => Some(((2 * n - k) as usize, -1.0)),
            k => Some((k as usize, 1.0)),
        }
    }

    fn apply(&self, stencil: &[f64; 5], u: &[f64], i: usize) -> f64 {
        let term = |(d, c): (usize, &f64)| self.neighbour(i, d).map_or(0.0, |(k, s)| c * s * u[k]);
        stencil.iter().enumerate().map(term).sum()
    }
}

impl<J: Entries> Problem for KuramotoSivashinsky<J> {
    type Jacobian = J;
    fn dim(&self) -> usize {
        self.n
    }
    fn parameters(&self) -> &[Parameter] {
        const { &[Parameter::new("nu", "", 1.0)] }
    }
    fn new_jacobian(&self) -> J {
        J::with_band(self.n, 2)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let h = self.h();
        for (i, r) in r.iter_mut().enumerate() {
            let slope = self.apply(&[0.0, -1.0, 0.0, 1.0, 0.0], u, i) / (2.0 * h);
            *r = -p[0] * self.apply(&FOURTH, u, i) / h.powi(4)
                - self.apply(&SECOND, u, i) / (h * h)
                - u[i] * slope;
        }
        Ok(())
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut J) -> Result<(), EvalError> {
        let h = self.h();
        j.set_zero();
        for i in 0..self.n {
            for d in 0..5 {
                let Some((k, sign)) = self.neighbour(i, d) else { continue };
                let advected = match d {
                    1 => u[i] / (2.0 * h),
                    3 => -u[i] / (2.0 * h),
                    _ => 0.0,
                };
                let linear = -p[0] * FOURTH[d] / h.powi(4) - SECOND[d] / (h * h);
                j.put(i, k, sign * (linear + advected));
            }
            let slope = self.apply(&[0.0, -1.0, 0.0, 1.0, 0.0], u, i) / (2.0 * h);
            j.put(i, i, -slope);
        }
        Ok(())
    }
    fn parameter_derivative(
        &self,
        u: &[f64],
        _: &[f64],
        _: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        for (i, out) in out.iter_mut().enumerate() {
            *out = -self.apply(&FOURTH, u, i) / self.h().powi(4);
        }
        Ok(())
    }
    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
}

fn check<J: Entries>(n: usize, max_step: Option<f64>) {
    let problem = KuramotoSivashinsky::<J> { n, matrix: PhantomData };
    let settings = Settings { target: Some(0.03), max_step, ..Settings::default() };
    let branch = trace_with(&problem, 1.2, settings);
    assert_eq!(branch.stopped.reason, StopReason::Target, "{n}: {:?}", branch.stopped);
    let points: Vec<_> = branch.events_of(&EventKind::BranchPoint).collect();
    let found: Vec<f64> = points.iter().map(|e| e.p).collect();
    assert_eq!(found.len(), 5, "{n}: {found:?}, {:?}", branch.stopped);
    // on the trivial branch a step costs one; the last point is located again at the target
    let Statistics { newton_iterations, accepted, rejected } = branch.statistics;
    let cost = newton_iterations - accepted - rejected;
    assert!(cost <= 60 * 6, "{n}: {cost} assemblies for five points");
    for (k, event) in points.iter().enumerate() {
        let (exact, mu) = (1.0 / problem.mu(k + 1), problem.mu(k + 1));
        let off = (event.p - exact).abs();
        // the entries of a row, 16 ν/h⁴ in sum, are rounded, the same in every row: no method finds
        // the exact place from them, but the estimate must know
        assert!(off <= event.error_estimate, "{n}, {k}: {off:e}, {:e}", event.error_estimate);
        let entries = f64::EPSILON * exact / problem.h().powi(4) / mu.powi(2);
        assert!(off < 1e-9_f64.max(8.0 * entries), "{n}, {k}: {off:e}");
        let allowed = 1e-11 + 24.0 * entries;
        assert!(event.error_estimate <= allowed, "{n}, {k}: {:e}", event.error_estimate);
        let Detail::Crossing(crossing) = &event.detail else { panic!("{n}, {k}: no normal form") };
        assert_eq!(crossing.shape, Shape::Pitchfork, "{n}, {k}");
        assert_eq!((event.unstable_before, event.unstable_after), (Some(k), Some(k + 1)), "{n}");
    }
}

#[test]
fn branch_points_in_every_storage() {
    for n in [41, 100, 200, 400, 800] {
        check::<Band>(n, None);
        check::<Sparse>(n, None);
    }
    check::<Dense>(41, None);
}

#[test]
fn branch_points_by_short_steps() {
    for n in [41, 200, 800] {
        check::<Band>(n, Some(0.015));
    }
    check::<Sparse>(100, Some(0.015));
    check::<Dense>(41, Some(0.015));
}
