//! Branch points of stiff operators: met as far as the rounding of the Jacobian's entries allows,
//! with an estimate that says so, and a normal form.

#![allow(clippy::unwrap_used, clippy::panic)]

use continuation::linalg::{Band, Dense, Matrix, Sparse};
use continuation::{
    Branch, Detail, EvalError, EventKind, ParamId, Parameter, Problem, Settings, Shape, Stability,
    StopReason, Tracer,
};
use std::marker::PhantomData;
use std::ops::ControlFlow;

/// Where entries of a Jacobian go.
trait Entries: Matrix {
    fn of(n: usize) -> Self;
    fn put(&mut self, i: usize, j: usize, value: f64);
}

impl Entries for Dense {
    fn of(n: usize) -> Self {
        Dense::new(n)
    }
    fn put(&mut self, i: usize, j: usize, value: f64) {
        self.add(i, j, value);
    }
}

impl Entries for Band {
    fn of(n: usize) -> Self {
        Band::new(n, 2, 2)
    }
    fn put(&mut self, i: usize, j: usize, value: f64) {
        self.add(i, j, value);
    }
}

impl Entries for Sparse {
    fn of(n: usize) -> Self {
        let near = |i: usize| (i.saturating_sub(2)..(i + 3).min(n)).map(move |j| (i, j));
        Sparse::new(n, &(0..n).flat_map(near).collect::<Vec<_>>()).unwrap()
    }
    fn put(&mut self, i: usize, j: usize, value: f64) {
        self.add(i, j, value).unwrap();
    }
}

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
        &[Parameter { name: "nu", unit: "", scale: 1.0 }]
    }
    fn new_jacobian(&self) -> J {
        J::of(self.n)
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

fn trivial_branch<J: Entries>(n: usize) -> Branch {
    let problem = KuramotoSivashinsky::<J> { n, matrix: PhantomData };
    let settings = Settings { target: Some(0.03), max_step: Some(0.015), ..Settings::default() };
    Tracer::new(&problem, "nu", &vec![0.0; n], &[1.2], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

fn check<J: Entries>(n: usize) {
    let problem = KuramotoSivashinsky::<J> { n, matrix: PhantomData };
    let branch = trivial_branch::<J>(n);
    assert_eq!(branch.stopped.reason, StopReason::Target, "{n}: {:?}", branch.stopped);
    let points: Vec<_> = branch.events_of(&EventKind::BranchPoint).collect();
    let found: Vec<f64> = points.iter().map(|e| e.p).collect();
    assert_eq!(found.len(), 5, "{n}: {found:?}");
    for (k, event) in points.iter().enumerate() {
        let off = (event.p - 1.0 / problem.mu(k + 1)).abs();
        assert!(off <= event.error_estimate, "{n}, {k}: {off:e}, {:e}", event.error_estimate);
        // the fourth difference has entries of 6/h⁴
        let entries = 6.0 * event.p / problem.h().powi(4) * f64::EPSILON;
        let allowed = 1e-11 + 4.0 * entries / problem.mu(k + 1).powi(2);
        assert!(event.error_estimate <= allowed, "{n}, {k}: {:e}", event.error_estimate);
        let Detail::Crossing(crossing) = &event.detail else { panic!("{n}, {k}: no normal form") };
        assert_eq!(crossing.shape, Shape::Pitchfork, "{n}, {k}");
    }
}

#[test]
fn estimates_hold_what_the_entries_round() {
    for n in [41, 200, 800] {
        check::<Band>(n);
    }
    check::<Sparse>(100);
    check::<Dense>(41);
}
